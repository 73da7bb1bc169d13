//! One run as a curve of success rates, by a model of how students learn.
//!
//! The chance of success rises along a logistic curve to a ceiling. Ceiling and midpoint vary from run to
//! run, and noise that lasts from one evaluation to the next (autoregressive, on the logit) moves the chance
//! about that curve. Each evaluation counts the successes of 20 episodes.

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

/// Evaluations of a run, that of the untrained student included.
pub(crate) const EVALUATIONS: usize = 21;
/// Episodes of an evaluation.
pub(crate) const EPISODES: u64 = 20;
/// Evaluations that the final success averages.
pub(crate) const WINDOW: usize = 5;

/// Share of training after which half of the ceiling is reached, on average.
const MIDPOINT: f64 = 0.35;
/// Steepness of the rise, per share of training.
const STEEPNESS: f64 = 10.0;
/// Standard deviation of ceilings and of midpoints over runs.
const SPREAD: f64 = 0.08;
/// Correlation of the noise between one evaluation and the next.
const PERSISTENCE: f64 = 0.9;
/// Standard deviation of the noise on the logit.
const NOISE: f64 = 0.35;
/// Share of the variance of ceilings and midpoints that runs of one seed and environment have in common, as
/// they share initial weights and goals.
const SHARED: f64 = 0.5;

/// By how much the ceiling and the midpoint of a run lie off their means, in standard deviations.
#[derive(Clone, Copy)]
pub(crate) struct Deviations {
    ceiling: f64,
    midpoint: f64,
}

impl Deviations {
    /// Those of one run, or the part that the runs of a seed share.
    pub(crate) fn draw(rng: &mut ChaCha8Rng) -> Self {
        Self { ceiling: rng.sample(StandardNormal), midpoint: rng.sample(StandardNormal) }
    }

    /// A run's own deviations and those `shared` by its seed, in the proportion of [`SHARED`].
    fn mixed(self, shared: Self) -> Self {
        let mix = |own: f64, shared: f64| (1.0 - SHARED).sqrt() * own + SHARED.sqrt() * shared;
        Self { ceiling: mix(self.ceiling, shared.ceiling), midpoint: mix(self.midpoint, shared.midpoint) }
    }
}

/// The chance of success under `noise` at an evaluation of a run whose mean ceiling is `ceiling`.
fn chance(ceiling: f64, run: Deviations, evaluation: usize, noise: f64) -> f64 {
    let progress = evaluation as f64 / (EVALUATIONS - 1) as f64;
    let top = (ceiling + SPREAD * run.ceiling).clamp(0.02, 0.995);
    let middle = MIDPOINT + SPREAD * run.midpoint;
    let smooth = top / (1.0 + (-STEEPNESS * (progress - middle)).exp());
    let odds = (smooth / (1.0 - smooth)) * (NOISE * noise).exp();
    odds / (1.0 + odds)
}

/// Success rates of a run, `[EVALUATIONS]`; `shared` is what runs of its seed have in common.
pub(crate) fn rates(ceiling: f64, shared: Deviations, rng: &mut ChaCha8Rng) -> Vec<f64> {
    let run = Deviations::draw(rng).mixed(shared);
    let mut noise: f64 = rng.sample(StandardNormal);
    let mut rates = Vec::with_capacity(EVALUATIONS);
    for evaluation in 0..EVALUATIONS {
        let chance = chance(ceiling, run, evaluation, noise);
        let successes = (0..EPISODES).filter(|_| rng.random::<f64>() < chance).count();
        rates.push(successes as f64 / EPISODES as f64);
        let fresh: f64 = rng.sample(StandardNormal);
        noise = PERSISTENCE * noise + (1.0 - PERSISTENCE * PERSISTENCE).sqrt() * fresh;
    }
    rates
}

/// Mean final success of runs by their mean ceiling, over runs and noise that are drawn once: differences
/// between two ceilings are then exact to about a thousandth.
pub(crate) struct MeanFinal {
    draws: Vec<(Deviations, f64)>,
}

impl MeanFinal {
    pub(crate) fn new() -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(20);
        let draws = (0..4_000).map(|_| (Deviations::draw(&mut rng), rng.sample(StandardNormal)));
        Self { draws: draws.collect() }
    }

    /// The mean final success at this ceiling.
    pub(crate) fn of(&self, ceiling: f64) -> f64 {
        let last = EVALUATIONS - WINDOW..EVALUATIONS;
        let sum: f64 = self
            .draws
            .iter()
            .map(|&(run, noise)| last.clone().map(|at| chance(ceiling, run, at, noise)).sum::<f64>())
            .sum();
        sum / (self.draws.len() * WINDOW) as f64
    }

    /// The ceiling at which the mean final success is `mean`, by bisection.
    pub(crate) fn ceiling(&self, mean: f64) -> f64 {
        let (mut low, mut high) = (0.0, 1.2);
        for _ in 0..30 {
            let middle = (low + high) / 2.0;
            if self.of(middle) < mean { low = middle } else { high = middle }
        }
        low
    }
}
