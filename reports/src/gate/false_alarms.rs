//! How often unchanged code fails: checks simulated by splitting recorded runs at random.

use rand::SeedableRng;
use rand::seq::index;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use serde::Serialize;

use super::cells::Cell;
use super::compare::{Sample, Settings, check_seeds, judge, samples};
use super::error::GateError;
use crate::stats;

/// How to simulate.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Simulation {
    /// Seeds of each simulated check.
    pub now: usize,
    /// Other seeds that it is compared with.
    pub before: usize,
    /// Simulated checks.
    pub draws: u64,
    /// Seed of the draws.
    pub seed: u64,
}

/// What the simulated checks did.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FalseAlarms {
    /// Checks that failed.
    pub failed: u64,
    /// All checks.
    pub draws: u64,
    /// Wilson's 95 % interval of the share that fails.
    pub interval: (f64, f64),
}

impl FalseAlarms {
    /// Share of checks that failed.
    pub fn rate(&self) -> f64 {
        self.failed as f64 / self.draws as f64
    }
}

/// Draws two disjoint groups of seeds of `cells`, again and again, and compares one with the other.
///
/// # Errors
/// [`GateError::Draws`] if there are not so many seeds, [`GateError::TooFewSeeds`] if no check could fail.
pub fn simulate(
    cells: &[Cell],
    simulation: Simulation,
    settings: Settings,
) -> Result<FalseAlarms, GateError> {
    let Simulation { now, before, draws, seed } = simulation;
    let all = samples(cells, cells, settings.window);
    let recorded = all.first().map_or(0, |sample| sample.now.len());
    if now + before > recorded || draws == 0 {
        return Err(GateError::Draws { draws, now, before, recorded });
    }
    check_seeds(now, before, all.len(), settings.alpha)?;
    let fails = |draw: &u64| {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(*draw);
        let chosen = index::sample(&mut rng, recorded, now + before).into_vec();
        let split: Vec<Sample> = all.iter().map(|sample| split(sample, &chosen, now)).collect();
        judge(&split, settings).iter().any(|test| test.failed)
    };
    let failed = (0..draws).into_par_iter().filter(fails).count() as u64;
    let interval = stats::wilson_interval(failed, draws, 0.95).expect("there are draws");
    Ok(FalseAlarms { failed, draws, interval })
}

/// The first `now` of the `chosen` seeds against the others.
fn split(sample: &Sample, chosen: &[usize], now: usize) -> Sample {
    let take = |chosen: &[usize]| chosen.iter().map(|&index| sample.now[index]).collect();
    Sample {
        scope: sample.scope.clone(),
        metric: sample.metric,
        now: take(&chosen[..now]),
        before: take(&chosen[now..]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gate::testing::cell;

    /// One cell with a run for each of `last`, of which so many of 10 episodes are successful in the end.
    fn cells(last: impl Iterator<Item = u64>) -> [Cell; 1] {
        [cell("A", "x", &last.collect::<Vec<_>>())]
    }

    #[test]
    fn equal_runs_never_fail_and_scattered_ones_at_most_as_often_as_alpha_says() {
        let simulation = Simulation { now: 3, before: 7, draws: 2_000, seed: 0 };
        let settings = Settings { alpha: 0.05, smallest_effect: 0.0, window: 1 };
        let none = simulate(&cells((0..12).map(|_| 5)), simulation, settings).expect("enough seeds");
        assert_eq!(none.failed, 0);
        // Half of the runs fail, half succeed, as where learning takes off early or late: no test may alarm
        // too often.
        let some =
            simulate(&cells((0..12).map(|i| 10 * (i % 2))), simulation, settings).expect("enough seeds");
        assert!(some.rate() <= 0.05, "{some:?}");
        // Eleven different runs: the lowest three of eleven are drawn in 1 of 165 checks, the next two sets
        // count as well.
        let ranks =
            simulate(&cells(0..=10), Simulation { before: 8, ..simulation }, settings).expect("enough seeds");
        assert!(ranks.failed > 0 && ranks.interval.0 <= 0.05, "{ranks:?}");
        assert_eq!(
            simulate(&cells(0..=10), Simulation { before: 8, ..simulation }, settings).expect("again"),
            ranks
        );
    }

    #[test]
    fn seeds_that_are_not_there_cannot_be_drawn() {
        let simulation = Simulation { now: 3, before: 10, draws: 10, seed: 0 };
        let error = simulate(&cells(0..=10), simulation, Settings::default()).expect_err("13 of 11");
        assert!(error.to_string().contains("the baseline has 11"), "{error}");
    }
}
