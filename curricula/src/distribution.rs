//! A probability for every goal of a list: how teachers weigh goals, and how they draw one.

use envs::rng::Rng;
use rand::distr::Distribution as _;
use rand::distr::weighted::WeightedIndex;
use serde::{Deserialize, Serialize};

use crate::curriculum::TeacherSummary;
use crate::error::CurriculumError;

/// A probability for every goal, shape `[n]`: finite, none negative, summing to 1.
///
/// ```
/// use curricula::Distribution;
/// use envs::rng::{Purpose, stream};
///
/// let curriculum = Distribution::proportional(&[1.0, 3.0, 0.0], 0.0, "learning progress")?;
/// assert_eq!(curriculum.probabilities(), [0.25, 0.75, 0.0]);
/// // A goal of probability 0 is never drawn.
/// assert!(curriculum.draw(&mut stream(0, Purpose::Teacher)) < 2);
/// # Ok::<(), curricula::CurriculumError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<f64>", into = "Vec<f64>")]
pub struct Distribution(Vec<f64>);

impl Distribution {
    /// The same probability for each of `n` goals.
    ///
    /// # Panics
    /// If `n` is 0.
    pub fn uniform(n: usize) -> Self {
        assert!(n > 0, "a distribution needs a goal");
        Self(vec![1.0 / n as f64; n])
    }

    /// The same probability for each of `members`, 0 for the others of `n` goals.
    ///
    /// # Panics
    /// If `members` is empty, repeats a goal or names one that is not below `n`.
    pub fn uniform_over(members: &[usize], n: usize) -> Self {
        assert!(!members.is_empty(), "a distribution needs a goal");
        let mut probabilities = vec![0.0; n];
        for &member in members {
            assert!(probabilities[member] == 0.0, "goal {member} is named twice");
            probabilities[member] = 1.0 / members.len() as f64;
        }
        Self(probabilities)
    }

    /// Each group's share, spread evenly over its members. Groups may overlap. A group without members is
    /// left out, and shares need not sum to 1: they count in relation to each other.
    ///
    /// # Panics
    /// If no group with a share above 0 has a member, a share is negative, or a member is not below `n`.
    pub fn of_groups(groups: &[(f64, &[usize])], n: usize) -> Self {
        assert!(groups.iter().all(|&(share, _)| share >= 0.0), "a share is negative");
        let total: f64 =
            groups.iter().filter(|(_, members)| !members.is_empty()).map(|(share, _)| share).sum();
        assert!(total > 0.0, "a distribution needs a goal");
        let mut probabilities = vec![0.0; n];
        for &(share, members) in groups {
            for &member in members {
                probabilities[member] += share / members.len() as f64;
            }
        }
        // In the end, so that a goal that has all of the shares has exactly 1.
        probabilities.iter_mut().for_each(|p| *p /= total);
        Self(probabilities)
    }

    /// w_i / Σ w: in proportion to `weights` (none negative). Uniform where their mean is at most
    /// `negligible`, the size at which weights of this kind are rounding and say nothing about goals; 0 if
    /// all of them count.
    ///
    /// # Errors
    /// [`CurriculumError::NotFinite`], naming the quantity as `what`.
    ///
    /// # Panics
    /// If there is no weight, or one is negative.
    pub fn proportional(
        weights: &[f64],
        negligible: f64,
        what: &'static str,
    ) -> Result<Self, CurriculumError> {
        let largest = largest(weights, what)?;
        assert!(weights.iter().all(|&w| w >= 0.0), "{what}: a weight is negative");
        if largest == 0.0 {
            return Ok(Self::uniform(weights.len()));
        }
        // Relative to the largest, so that no sum can overflow.
        let mut probabilities: Vec<f64> = weights.iter().map(|w| w / largest).collect();
        let total: f64 = probabilities.iter().sum();
        if total * largest <= negligible * weights.len() as f64 {
            return Ok(Self::uniform(weights.len()));
        }
        probabilities.iter_mut().for_each(|p| *p /= total);
        Ok(Self(probabilities))
    }

    /// exp(β·x_i) / Σ exp(β·x): the softmax of `scores` with inverse temperature `beta`.
    ///
    /// # Errors
    /// [`CurriculumError::NotFinite`], naming the quantity as `what`.
    ///
    /// # Panics
    /// If there is no score.
    pub fn softmax(scores: &[f64], beta: f64, what: &'static str) -> Result<Self, CurriculumError> {
        let largest = largest(scores, what)?;
        let mut probabilities: Vec<f64> = scores.iter().map(|x| (beta * (x - largest)).exp()).collect();
        let total: f64 = probabilities.iter().sum();
        probabilities.iter_mut().for_each(|p| *p /= total);
        Ok(Self(probabilities))
    }

    /// All probability on the largest of `scores`, shared evenly where several goals are largest.
    ///
    /// # Errors
    /// [`CurriculumError::NotFinite`], naming the quantity as `what`.
    ///
    /// # Panics
    /// If there is no score.
    pub fn argmax(scores: &[f64], what: &'static str) -> Result<Self, CurriculumError> {
        let largest = largest(scores, what)?;
        let members: Vec<usize> = (0..scores.len()).filter(|&i| scores[i] == largest).collect();
        Ok(Self::uniform_over(&members, scores.len()))
    }

    /// Draws a goal's index. A goal of probability 0 is never drawn.
    pub fn draw(&self, rng: &mut Rng) -> usize {
        WeightedIndex::new(&self.0).expect("probabilities sum to 1").sample(rng)
    }

    /// The probabilities, shape `[n]`.
    pub fn probabilities(&self) -> &[f64] {
        &self.0
    }

    /// Shannon entropy −Σ p ln p in nats: ln n if uniform, 0 if one goal has it all.
    pub fn entropy(&self) -> f64 {
        // |ln p| is -ln p, and spares records a "-0".
        self.0.iter().filter(|&&p| p > 0.0).fold(0.0, |sum, p| sum + p * p.ln().abs())
    }

    /// exp(entropy): how many equally likely goals would be as hard to guess, in [1, n].
    pub fn effective_goals(&self) -> f64 {
        self.entropy().exp()
    }

    /// The probabilities as weights, with [`Distribution::entropy`] and [`Distribution::effective_goals`] by
    /// name.
    pub fn summary(&self) -> TeacherSummary<'_> {
        let statistics =
            vec![(names::ENTROPY, self.entropy()), (names::EFFECTIVE_GOALS, self.effective_goals())];
        TeacherSummary { weights: Some(&self.0), statistics }
    }
}

/// The largest of `values`, all of which must be finite.
fn largest(values: &[f64], what: &'static str) -> Result<f64, CurriculumError> {
    assert!(!values.is_empty(), "a distribution needs a goal");
    require_finite(values, what)?;
    Ok(values.iter().copied().fold(f64::NEG_INFINITY, f64::max))
}

/// Refuses NaN and infinity, naming the first goal that has it.
pub(crate) fn require_finite(values: &[f64], what: &'static str) -> Result<(), CurriculumError> {
    match values.iter().position(|value| !value.is_finite()) {
        None => Ok(()),
        Some(index) => Err(CurriculumError::NotFinite { what, index, value: values[index] }),
    }
}

impl From<Distribution> for Vec<f64> {
    fn from(distribution: Distribution) -> Self {
        distribution.0
    }
}

impl TryFrom<Vec<f64>> for Distribution {
    type Error = &'static str;

    fn try_from(probabilities: Vec<f64>) -> Result<Self, Self::Error> {
        let sum: f64 = probabilities.iter().sum();
        // Written so that a NaN fails too.
        let valid = probabilities.iter().all(|&p| p >= 0.0) && (sum - 1.0).abs() <= 1e-9;
        if valid { Ok(Self(probabilities)) } else { Err("probabilities must be non-negative and sum to 1") }
    }
}
