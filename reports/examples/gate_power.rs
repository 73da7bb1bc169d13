//! How often the regression gate finds a fall, by simulation from a recorded baseline:
//!
//! ```sh
//! cargo run --release -p reports --example gate_power -- harness/baselines/gate.json 2000
//! ```
//!
//! Scores of the seeds of a check, and of a baseline to compare them with, are drawn from the normal
//! distribution that has the means of the recorded seeds' scores and their covariances between cells and
//! metrics. In cells that fell, the final success of all seeds is lower by as much as said, and the area
//! under the curve by the same share of its mean; a cell cannot fall below 0.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::ExitCode;

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use rayon::prelude::*;
use reports::gate::baseline::BaselineCell;
use reports::gate::cells::Cell;
use reports::gate::compare::{Sample, Settings, judge, samples};
use reports::gate::group::{CellGroup, groups};
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
    groups: Vec<CellGroup>,
    /// Recorded scores of all tests, as those of `now`.
    recorded: Vec<Sample>,
    settings: Settings,
    /// Seeds that a check runs.
    seeds: usize,
}

impl Gate {
    fn read(path: &Path) -> Result<Self, GateError> {
        let baseline = Baseline::read(path)?;
        let cell = |(id, cell): (String, BaselineCell)| {
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
        let cells: Vec<Cell> = baseline.cells.into_iter().map(cell).collect();
        let settings = baseline.gate.settings;
        Ok(Self {
            groups: groups(&cells),
            recorded: samples(&cells, &cells, settings.window),
            settings,
            seeds: baseline.gate.seeds.len(),
            cells,
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
            let falls: Vec<Vec<f64>> = places.iter().map(|fallen| self.falls(fallen, fall)).collect();
            let fails = |draw: &u64| self.fails(&falls[*draw as usize % falls.len()], *draw);
            100.0 * (0..draws).into_par_iter().filter(fails).count() as f64 / draws as f64
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

    /// By how much each test's mean score falls where the final success of the cells `fallen` falls by
    /// `fall`. Shape: one number per test.
    fn falls(&self, fallen: &[usize], fall: f64) -> Vec<f64> {
        let of_cell = |index: usize, metric: Metric| {
            let share = (fall / self.mean(index, Metric::FinalSuccess)).min(1.0);
            let falls = metric.is_success() && fallen.contains(&index);
            if falls { share * self.mean(index, metric) } else { 0.0 }
        };
        let of_test = |sample: &Sample| {
            let group = self.groups.iter().find(|group| group.scope == sample.scope);
            let cells = group.map_or(&[][..], |group| &group.cells);
            stats::mean(&cells.iter().map(|&index| of_cell(index, sample.metric)).collect::<Vec<f64>>())
        };
        self.recorded.iter().map(|sample| of_test(sample).unwrap_or(0.0)).collect()
    }

    /// Mean recorded score of a cell.
    fn mean(&self, index: usize, metric: Metric) -> f64 {
        let cell = &self.cells[index];
        let scores = cell.curves.values().filter_map(|curve| metric.of(cell, curve, self.settings.window));
        stats::mean(&scores.collect::<Vec<f64>>()).unwrap_or(0.0)
    }

    /// Whether a simulated check fails whose tests' scores fell by `falls`.
    fn fails(&self, falls: &[f64], draw: u64) -> bool {
        let mut rng = ChaCha8Rng::seed_from_u64(0);
        rng.set_stream(draw);
        let recorded = self.recorded.first().map_or(0, |sample| sample.now.len());
        // A seed's scores lie off their means by the recorded deviations, each times a weight that is the
        // same for all tests. With weights of variance 1 / (n - 1) the covariances are those of the records.
        let mut weights = |seeds: usize| -> Vec<Vec<f64>> {
            let scale = ((recorded - 1) as f64).sqrt();
            let of_seed = |_| (0..recorded).map(|_| rng.sample::<f64, _>(StandardNormal) / scale).collect();
            (0..seeds).map(of_seed).collect()
        };
        let (before, now) = (weights(recorded), weights(self.seeds));
        let simulated = self.recorded.iter().zip(falls).map(|(sample, fall)| Sample {
            scope: sample.scope.clone(),
            metric: sample.metric,
            before: scores(&sample.now, &before, 0.0),
            now: scores(&sample.now, &now, *fall),
        });
        judge(&simulated.collect::<Vec<_>>(), self.settings).iter().any(|test| test.failed)
    }
}

/// Scores of simulated seeds, one per row of `weights` (`[seeds][recorded]`), lower by `fall`.
fn scores(recorded: &[f64], weights: &[Vec<f64>], fall: f64) -> Vec<f64> {
    let mean = stats::mean(recorded).unwrap_or(0.0);
    let deviation = |weights: &Vec<f64>| -> f64 {
        recorded.iter().zip(weights).map(|(score, weight)| weight * (score - mean)).sum()
    };
    weights.iter().map(|weights| mean - fall + deviation(weights)).collect()
}
