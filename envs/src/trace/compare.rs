//! Comparing what was recorded with what the replay gives.

use serde_json::{Map, Value};

use super::{Deviations, Divergence, Place, Problem};
use crate::registry::Verification;

/// The quantities that are compared number by number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Field {
    Observation,
    AchievedGoal,
    Qpos,
    Qvel,
    Goal,
}

impl Field {
    fn name(self) -> &'static str {
        match self {
            Self::Observation => "observation",
            Self::AchievedGoal => "achieved_goal",
            Self::Qpos => "qpos",
            Self::Qvel => "qvel",
            Self::Goal => "goal",
        }
    }

    fn slot(self, deviations: &mut Deviations) -> &mut f64 {
        match self {
            Self::Observation => &mut deviations.observation,
            Self::AchievedGoal => &mut deviations.achieved_goal,
            Self::Qpos => &mut deviations.qpos,
            Self::Qvel => &mut deviations.qvel,
            Self::Goal => &mut deviations.goal,
        }
    }
}

/// Collects deviations over a file.
#[derive(Debug, Default)]
pub(super) struct Differences {
    pub(super) deviations: Deviations,
    pub(super) reward_mismatches: usize,
    pub(super) success_mismatches: usize,
    pub(super) first_failure: Option<Divergence>,
}

impl Differences {
    /// Compares two vectors number by number.
    ///
    /// # Errors
    /// [`Problem::Length`] if the recorded one has another length than ours.
    pub(super) fn numbers(
        &mut self,
        place: &Place,
        field: Field,
        recorded: &[f64],
        ours: &[f64],
        tolerance: f64,
    ) -> Result<(), Box<Problem>> {
        check_length(place, field.name(), recorded.len(), ours.len())?;
        for (index, (&expected, &got)) in recorded.iter().zip(ours).enumerate() {
            let slot = field.slot(&mut self.deviations);
            *slot = slot.max((expected - got).abs());
            if !agree(expected, got, tolerance) {
                self.fail(place, field.name(), Some(index), expected.into(), got.into());
            }
        }
        Ok(())
    }

    /// Compares a step's reward and success exactly.
    pub(super) fn outcome(&mut self, place: &Place, recorded: (f64, f64), ours: (f64, bool)) {
        if recorded.0 != ours.0 {
            self.reward_mismatches += 1;
            self.fail(place, "reward", None, recorded.0.into(), ours.0.into());
        }
        let success = f64::from(u8::from(ours.1));
        if recorded.1 != success {
            self.success_mismatches += 1;
            self.fail(place, "is_success", None, recorded.1.into(), success.into());
        }
    }

    /// Compares the constants of the environment with `meta`. Returns the names in `meta` that were not asked
    /// for.
    ///
    /// # Errors
    /// [`Problem::Missing`] if a constant is not in `meta`.
    pub(super) fn constants(
        &mut self,
        recorded: &Map<String, Value>,
        ours: &Map<String, Value>,
    ) -> Result<Vec<String>, Box<Problem>> {
        for (name, got) in ours {
            let expected = recorded.get(name).ok_or_else(|| Problem::Missing { field: name.clone() })?;
            self.constant(name, expected, got);
        }
        Ok(recorded.keys().filter(|name| !ours.contains_key(*name)).cloned().collect())
    }

    /// Numbers within the tolerance, lists entry by entry, everything else exactly.
    fn constant(&mut self, name: &str, expected: &Value, got: &Value) {
        if let (Some(expected), Some(got)) = (expected.as_array(), got.as_array())
            && expected.len() == got.len()
        {
            for (index, (expected, got)) in expected.iter().zip(got).enumerate() {
                self.constant(&format!("{name}[{index}]"), expected, got);
            }
            return;
        }
        let same = match (expected.as_f64(), got.as_f64()) {
            (Some(a), Some(b)) => {
                self.deviations.constants = self.deviations.constants.max((a - b).abs());
                agree(a, b, Verification::ROUNDING)
            }
            _ => expected == got,
        };
        if !same {
            self.fail(&Place::Meta, name, None, expected.clone(), got.clone());
        }
    }

    fn fail(&mut self, place: &Place, field: &str, index: Option<usize>, expected: Value, got: Value) {
        self.first_failure.get_or_insert_with(|| Divergence {
            place: place.clone(),
            field: field.to_owned(),
            index,
            expected,
            got,
        });
    }
}

/// Checks a recorded length.
///
/// # Errors
/// [`Problem::Length`] if it is not the one needed.
pub(super) fn check_length(
    place: &Place,
    field: &'static str,
    got: usize,
    expected: usize,
) -> Result<(), Box<Problem>> {
    if got == expected {
        return Ok(());
    }
    Err(Problem::Length { place: place.clone(), field, expected, got }.into())
}

/// False for NaN too.
fn agree(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance
}
