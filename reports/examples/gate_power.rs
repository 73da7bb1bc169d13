//! How often the regression gate finds a fall, by simulation from a recorded baseline:
//!
//! ```sh
//! cargo run --release -p reports --example gate_power -- harness/baselines/gate.json 2000
//! ```
//!
//! Each simulated check draws the seeds of the baseline, and those that run now, with replacement from the
//! recorded ones, all cells of a seed together. Of those that run now, successes of the cells that fell are
//! struck out at random, so many that their final success falls by as much as said on average; a cell whose
//! success is lower than that falls to 0.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::ExitCode;

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use reports::gate::cells::{Cell, RunSummary};
use reports::gate::compare::{Settings, judge, samples};
use reports::gate::metric::Metric;
use reports::gate::{Baseline, GateError};
use reports::stats;

/// Falls of final success that are simulated.
const FALLS: [f64; 2] = [0.05, 0.1];

#[expect(clippy::print_stdout, clippy::print_stderr, reason = "a program's output")]
fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let (path, draws) = (arguments.next(), arguments.next().map_or(Ok(1_000), |text| text.parse()));
    let (Some(path), Ok(draws)) = (path, draws) else {
        eprintln!("usage: gate_power BASELINE [CHECKS]");
        return ExitCode::FAILURE;
    };
    match Gate::read(Path::new(&path)) {
        Ok(gate) => {
            println!("{}", gate.table(draws));
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

/// A recorded baseline and how it is checked.
struct Gate {
    cells: Vec<Cell>,
    settings: Settings,
    /// Seeds that a check runs.
    now: usize,
}

impl Gate {
    fn read(path: &Path) -> Result<Self, GateError> {
        let baseline = Baseline::read(path)?;
        let cell = |(id, cell): (String, reports::gate::baseline::BaselineCell)| {
            let mut names = id.split('/').map(str::to_owned);
            let mut name = || names.next().unwrap_or_default();
            Cell {
                environment: name(),
                curriculum: name(),
                variant: name(),
                config: cell.config,
                episodes: cell.episodes,
                steps: cell.steps,
                curves: cell.curves,
            }
        };
        Ok(Self {
            cells: baseline.cells.into_iter().map(cell).collect(),
            settings: baseline.gate.settings,
            now: baseline.gate.seeds.len(),
        })
    }

    /// The table of the docs. Where a fall is in one method's cells, or in one cell, every method or cell has
    /// its turn.
    fn table(&self, draws: u64) -> String {
        let all = vec![(0..self.cells.len()).collect::<Vec<usize>>()];
        let mut by_method: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
        for (index, cell) in self.cells.iter().enumerate() {
            by_method.entry(&cell.curriculum).or_default().push(index);
        }
        let methods: Vec<Vec<usize>> = by_method.into_values().collect();
        let single: Vec<Vec<usize>> = (0..self.cells.len()).map(|index| vec![index]).collect();
        let share = |places: &[Vec<usize>], fall| {
            let found = (0..draws).into_par_iter().filter(|&draw| {
                let fallen = &places[draw as usize % places.len()];
                self.fails(fallen, fall, draw)
            });
            100.0 * found.count() as f64 / draws as f64
        };
        let mut text = format!(
            "{draws} checks each; of unchanged code {:.1} % fail.\n\n| fall of final success | in all {} cells | in one \
             method's {} | in a single cell |\n|---|---|---|---|\n",
            share(&all, 0.0),
            self.cells.len(),
            methods.first().map_or(0, Vec::len),
        );
        for fall in FALLS {
            let [all, methods, single] = [&all, &methods, &single].map(|places| share(places, fall));
            text += &format!("| {fall} | {all:.0} % | {methods:.0} % | {single:.0} % |\n");
        }
        text
    }

    /// Whether a simulated check fails after the final success of the cells `fallen` fell.
    fn fails(&self, fallen: &[usize], fall: f64, draw: u64) -> bool {
        let mut rng = ChaCha8Rng::seed_from_u64(0);
        rng.set_stream(draw);
        let seeds: Vec<u64> = self.cells[0].curves.keys().copied().collect();
        let mut drawn = |count: usize| -> Vec<u64> {
            (0..count).map(|_| seeds[rng.random_range(0..seeds.len())]).collect()
        };
        let (before, now) = (drawn(seeds.len()), drawn(self.now));
        let before: Vec<Cell> = self.cells.iter().map(|cell| resampled(cell, &before)).collect();
        let mut now: Vec<Cell> = self.cells.iter().map(|cell| resampled(cell, &now)).collect();
        for &index in fallen {
            let lost = (fall / self.final_success(index)).min(1.0);
            for curve in now[index].curves.values_mut() {
                strike_out(curve, lost, &mut rng);
            }
        }
        let samples = samples(&before, &now, self.settings.window);
        judge(&samples, self.settings).iter().any(|test| test.failed)
    }

    /// Mean final success of a recorded cell.
    fn final_success(&self, index: usize) -> f64 {
        let cell = &self.cells[index];
        let scores = cell
            .curves
            .values()
            .filter_map(|curve| Metric::FinalSuccess.of(cell, curve, self.settings.window));
        stats::mean(&scores.collect::<Vec<f64>>()).unwrap_or(0.0)
    }
}

/// `cell` with the curves of `seeds`, numbered anew.
fn resampled(cell: &Cell, seeds: &[u64]) -> Cell {
    let curves = (0..).zip(seeds).map(|(number, seed)| (number, cell.curves[seed].clone()));
    Cell { curves: curves.collect(), ..cell.clone() }
}

/// Turns each success into a failure with a chance of `lost`.
fn strike_out(curve: &mut RunSummary, lost: f64, rng: &mut ChaCha8Rng) {
    for successes in &mut curve.successes {
        *successes = (0..*successes).filter(|_| rng.random::<f64>() >= lost).count() as u64;
    }
}
