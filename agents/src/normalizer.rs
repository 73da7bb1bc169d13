//! Running normalisation of network inputs (the HER configuration of OpenAI Baselines).

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::actor::InputScaling;
use crate::auto::Auto;
use crate::checks::{MOST_EPISODES, at_most, positive};
use crate::error::AgentError;

/// How inputs are normalised: clip((clip(x, ±`clip_before`) − mean) / max(std, `std_floor`), ±`clip_after`).
#[derive(Clone, Copy, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct NormalizerConfig {
    /// Lower bound of the standard deviation in the division.
    ///
    /// Unit: that of the input. Range: above 0. Source: Baselines.
    pub std_floor: f64,
    /// Bound on raw inputs.
    ///
    /// Unit: that of the input. Range: above 0. Source: Baselines.
    pub clip_before: f64,
    /// Bound on normalised inputs.
    ///
    /// Unit: standard deviations. Range: above 0. Source: Baselines.
    pub clip_after: f64,
    /// How many zeros count as seen before the first input; with 0 the moments are those of the inputs alone.
    ///
    /// Unit: inputs. Range: 0 to 1,000,000. Source: Baselines, whose `Normalizer` starts with count 1, sum 0
    /// and sum of squares 0.
    pub pseudo_observations: u64,
    /// How many episodes, from the first one on, feed mean and standard deviation, which then stay as they
    /// are. With 0 inputs are never normalised (mean 0, standard deviation 1) but still clipped.
    ///
    /// Unit: episodes. Range: 0 to 1,000,000,000. Auto: all episodes. Source: Baselines.
    pub feed_episodes: Auto<u64>,
}

impl Default for NormalizerConfig {
    fn default() -> Self {
        Self {
            std_floor: 0.01,
            clip_before: 200.0,
            clip_after: 5.0,
            pseudo_observations: 1,
            feed_episodes: Auto::Auto,
        }
    }
}

/// The most pseudo-observations: a million transitions, as many as the default replay buffer holds.
const MOST_PSEUDO_OBSERVATIONS: u64 = 1_000_000;

impl NormalizerConfig {
    /// Checks the ranges.
    pub(crate) fn check(&self) -> Result<(), AgentError> {
        positive("normalizer.std_floor", self.std_floor)?;
        positive("normalizer.clip_before", self.clip_before)?;
        positive("normalizer.clip_after", self.clip_after)?;
        at_most("normalizer.pseudo_observations", self.pseudo_observations, MOST_PSEUDO_OBSERVATIONS)?;
        at_most("normalizer.feed_episodes", self.feed_episodes.value_or(|| 0), MOST_EPISODES)
    }

    /// Whether an episode that follows `before` others feeds the normalisers.
    pub(crate) fn feeds(&self, before: u64) -> bool {
        match self.feed_episodes {
            Auto::Auto => true,
            Auto::Value(episodes) => before < episodes,
        }
    }
}

/// What a normaliser has seen, including pseudo-observations: all of it that must be saved.
///
/// The count includes pseudo-observations, so loading never adds any to moments that were saved without.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Moments {
    count: u64,
    sum: Vec<f64>,
    sum_of_squares: Vec<f64>,
}

impl Moments {
    /// Those of `pseudo_observations` zeros.
    fn of_zeros(pseudo_observations: u64, width: usize) -> Self {
        Self { count: pseudo_observations, sum: vec![0.0; width], sum_of_squares: vec![0.0; width] }
    }

    /// Numbers of a vector.
    pub(crate) fn width(&self) -> usize {
        self.sum.len()
    }

    /// Whether they hold no input, only at most `pseudo_observations` zeros.
    fn are_of_zeros(&self, pseudo_observations: u64) -> bool {
        self.count <= pseudo_observations && self.sum_of_squares.iter().all(|&sum| sum == 0.0)
    }
}

/// Normalises vectors of one kind (states or goals) by the mean and standard deviation of those it was fed.
///
/// Until it is fed, it assumes mean 0 and standard deviation 1 for every component, whatever its
/// pseudo-observations: pseudo-observations alone have zero deviation. Baselines does the same until it first
/// computes the two.
///
/// ```
/// use agents::{Normalizer, NormalizerConfig};
///
/// let config = NormalizerConfig { pseudo_observations: 0, ..NormalizerConfig::default() };
/// let mut normalizer = Normalizer::new(config, 1);
/// normalizer.update(&[1.0, 3.0]);
/// let mut out = [0.0];
/// normalizer.normalize(&[3.0], &mut out);
/// assert_eq!(out, [1.0]);
/// ```
#[derive(Clone, Debug)]
pub struct Normalizer {
    config: NormalizerConfig,
    moments: Moments,
    /// Means and inverse floored standard deviations, rounded once for the hot path.
    mean: Vec<f32>,
    scale: Vec<f32>,
}

impl Normalizer {
    /// A normaliser of vectors of `width` numbers, fed nothing yet.
    pub fn new(config: NormalizerConfig, width: usize) -> Self {
        let moments = Moments::of_zeros(config.pseudo_observations, width);
        Self { config, moments, mean: vec![0.0; width], scale: vec![1.0; width] }
    }

    /// Length of the vectors.
    pub fn width(&self) -> usize {
        self.mean.len()
    }

    /// Feeds `rows`, a flat matrix of `width` columns, and brings mean and standard deviation up to date.
    ///
    /// # Panics
    /// If `rows` is no whole number of rows.
    pub fn update(&mut self, rows: &[f32]) {
        let width = self.width();
        assert_eq!(rows.len() % width, 0, "whole rows of {width} numbers");
        let bound = self.config.clip_before;
        for row in rows.chunks_exact(width) {
            for (i, &x) in row.iter().enumerate() {
                let x = f64::from(x).clamp(-bound, bound);
                self.moments.sum[i] += x;
                self.moments.sum_of_squares[i] += x * x;
            }
        }
        self.moments.count += (rows.len() / width) as u64;
        self.refresh();
    }

    fn refresh(&mut self) {
        if self.moments.are_of_zeros(self.config.pseudo_observations) {
            self.mean.fill(0.0);
            self.scale.fill(1.0);
            return;
        }
        let Moments { count, sum, sum_of_squares } = &self.moments;
        for i in 0..sum.len() {
            let (mean, std) = mean_and_std(*count as f64, sum[i], sum_of_squares[i]);
            self.mean[i] = mean as f32;
            self.scale[i] = (1.0 / std.max(self.config.std_floor)) as f32;
        }
    }

    /// Writes `row`, shape `[width]`, normalised into `out`, shape `[width]`.
    #[inline]
    pub fn normalize(&self, row: &[f32], out: &mut [f32]) {
        self.normalize_each(row.iter().copied(), out);
    }

    /// [`Normalizer::normalize`] for numbers of double precision, rounded first.
    #[inline]
    pub fn normalize_wide(&self, row: &[f64], out: &mut [f32]) {
        self.normalize_each(row.iter().map(|&x| x as f32), out);
    }

    #[inline]
    fn normalize_each(&self, row: impl Iterator<Item = f32>, out: &mut [f32]) {
        let before = self.config.clip_before as f32;
        let after = self.config.clip_after as f32;
        for (((out, x), &mean), &scale) in out.iter_mut().zip(row).zip(&self.mean).zip(&self.scale) {
            *out = ((x.clamp(-before, before) - mean) * scale).clamp(-after, after);
        }
    }

    /// What [`Normalizer::normalize`] does, in numbers.
    pub(crate) fn scaling(&self) -> InputScaling {
        InputScaling {
            mean: self.mean.clone(),
            scale: self.scale.clone(),
            clip_before: self.config.clip_before as f32,
            clip_after: self.config.clip_after as f32,
        }
    }

    /// What it has seen, for saving.
    pub fn moments(&self) -> &Moments {
        &self.moments
    }

    /// Takes back what [`Normalizer::moments`] gave.
    ///
    /// # Errors
    /// [`AgentError::State`] if the moments are of another width.
    pub fn set_moments(&mut self, moments: Moments) -> Result<(), AgentError> {
        let widths = (moments.sum.len(), moments.sum_of_squares.len());
        if widths != (self.width(), self.width()) {
            let reason = format!("a normaliser of {} numbers where {} are expected", widths.0, self.width());
            return Err(AgentError::misfit(reason));
        }
        self.moments = moments;
        self.refresh();
        Ok(())
    }
}

/// Mean and population standard deviation from a count, a sum and a sum of squares. Rounding can make the
/// variance a little negative, which counts as 0.
fn mean_and_std(count: f64, sum: f64, sum_of_squares: f64) -> (f64, f64) {
    let mean = sum / count;
    let variance = sum_of_squares / count - mean * mean;
    (mean, variance.max(0.0).sqrt())
}

#[cfg(test)]
mod tests {
    use crate::auto::Auto;

    use super::{Moments, Normalizer, NormalizerConfig, mean_and_std};

    fn normalized(normalizer: &Normalizer, row: &[f32]) -> Vec<f32> {
        let mut out = vec![0.0; row.len()];
        normalizer.normalize(row, &mut out);
        out
    }

    #[test]
    fn mean_and_std_by_hand() {
        // 1, 3, 5, 7: mean 4, variance (9 + 1 + 1 + 9)/4 = 5.
        let (mean, std) = mean_and_std(4.0, 16.0, 84.0);
        assert_eq!(mean, 4.0);
        assert_eq!(std, 5f64.sqrt());
    }

    /// A normaliser of the inputs alone.
    fn of_inputs_alone(width: usize) -> Normalizer {
        Normalizer::new(with(0), width)
    }

    fn with(pseudo_observations: u64) -> NormalizerConfig {
        NormalizerConfig { pseudo_observations, ..NormalizerConfig::default() }
    }

    #[test]
    fn mean_and_std_with_a_pseudo_observation_by_hand() {
        // 0, 1, 3: mean 4/3, variance (0 + 1 + 9)/3 - 16/9 = 14/9.
        let mut normalizer = Normalizer::new(with(1), 1);
        normalizer.update(&[1.0, 3.0]);
        assert_eq!(*normalizer.moments(), Moments { count: 3, sum: vec![4.0], sum_of_squares: vec![10.0] });
        let (mean, std) = (4.0f32 / 3.0, (10f32 / 3.0 - 16.0 / 9.0).sqrt());
        let out = normalized(&normalizer, &[2.0]);
        assert!((out[0] - (2.0 - mean) / std).abs() < 1e-6, "{out:?}");
    }

    #[test]
    fn pseudo_observations_are_inputs_of_zero() {
        let (mut pseudo, mut fed) = (Normalizer::new(with(4), 2), of_inputs_alone(2));
        fed.update(&[0.0; 8]);
        assert_eq!(pseudo.moments(), fed.moments());
        for normalizer in [&mut pseudo, &mut fed] {
            normalizer.update(&[0.1, 0.7, 0.3, -0.9]);
        }
        assert_eq!(pseudo.moments(), fed.moments());
        assert_eq!(normalized(&pseudo, &[0.2, 0.2]), normalized(&fed, &[0.2, 0.2]));
    }

    /// The deviation of zeros alone is the floor, which would multiply inputs by 100.
    #[test]
    fn pseudo_observations_alone_leave_inputs_as_they_are_also_after_loading() {
        for pseudo_observations in [0, 1, 7] {
            let unfed = Normalizer::new(with(pseudo_observations), 2);
            let mut restored = Normalizer::new(with(pseudo_observations), 2);
            restored.set_moments(unfed.moments().clone()).unwrap();
            for normalizer in [unfed, restored] {
                assert_eq!(normalizer.moments().count, pseudo_observations);
                assert_eq!(normalized(&normalizer, &[0.5, -9.0]), [0.5, -5.0]);
            }
        }
        // Fed zeros, it has seen that nothing varies.
        let mut fed = Normalizer::new(with(1), 1);
        fed.update(&[0.0; 3]);
        assert_eq!(normalized(&fed, &[0.02]), [2.0]);
    }

    /// Moments from before there were pseudo-observations.
    #[test]
    fn moments_of_inputs_alone_keep_their_mean_and_deviation() {
        let mut before = of_inputs_alone(1);
        before.update(&[1.0, 3.0, 5.0, 7.0]);
        let mut loaded = Normalizer::new(with(1), 1);
        loaded.set_moments(before.moments().clone()).unwrap();
        assert_eq!(normalized(&loaded, &[5.0]), normalized(&before, &[5.0]));
        loaded.set_moments(of_inputs_alone(1).moments().clone()).unwrap();
        assert_eq!(normalized(&loaded, &[0.5]), [0.5]);
    }

    #[test]
    fn the_first_episodes_feed_and_no_others() {
        let feeds = |feed_episodes| {
            let config = NormalizerConfig { feed_episodes, ..NormalizerConfig::default() };
            [0, 1, 2, 3].map(|before| config.feeds(before))
        };
        assert_eq!(feeds(Auto::Auto), [true; 4]);
        assert_eq!(feeds(Auto::Value(2)), [true, true, false, false]);
        assert_eq!(feeds(Auto::Value(0)), [false; 4]);
    }

    #[test]
    fn normalises_by_all_it_was_fed() {
        let mut normalizer = of_inputs_alone(2);
        assert_eq!(normalized(&normalizer, &[0.5, -2.0]), [0.5, -2.0]);
        normalizer.update(&[1.0, 0.0, 3.0, 10.0]);
        normalizer.update(&[5.0, 0.0, 7.0, 10.0]);
        let out = normalized(&normalizer, &[5.0, 10.0]);
        assert!((out[0] - 1.0 / 5f32.sqrt()).abs() < 1e-6, "{out:?}");
        assert!((out[1] - 1.0).abs() < 1e-6, "{out:?}");
    }

    #[test]
    fn floors_the_deviation_and_clips_on_both_sides() {
        let mut normalizer = of_inputs_alone(2);
        // A constant component, and one whose raw value is clipped to 200 before it is counted.
        normalizer.update(&[3.0, 1e6, 3.0, 200.0]);
        let out = normalized(&normalizer, &[3.02, 1e6]);
        assert!((out[0] - 2.0).abs() < 1e-4, "(3.02 - 3)/0.01 = 2, got {out:?}");
        assert_eq!(out[1], 0.0, "clipped to 200, the mean");
        assert_eq!(normalized(&normalizer, &[4.0, 0.0]), [5.0, -5.0]);

        // -1e6 counts as -200, so that the mean is 0 and the deviation 200; -1e6 then is -1.
        let mut normalizer = of_inputs_alone(1);
        normalizer.update(&[-1e6, 200.0]);
        assert_eq!(normalized(&normalizer, &[-1e6]), [-1.0]);
    }

    #[test]
    fn moments_restore_it_exactly_and_only_at_the_same_width() {
        let mut fed = Normalizer::new(NormalizerConfig::default(), 2);
        fed.update(&[0.1, 0.7, 0.3, -0.9]);
        let mut restored = Normalizer::new(NormalizerConfig::default(), 2);
        restored.set_moments(fed.moments().clone()).unwrap();
        assert_eq!(normalized(&restored, &[0.2, 0.2]), normalized(&fed, &[0.2, 0.2]));
        let mut other = Normalizer::new(NormalizerConfig::default(), 3);
        assert!(other.set_moments(fed.moments().clone()).is_err());
    }
}
