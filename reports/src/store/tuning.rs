//! What a search over settings chose. Read apart from the runs, which mean the same without it.

use std::path::Path;

use super::error::StoreError;
use super::problem::{Fault, StoreProblem};
use super::{Results, layout, read_json};
use crate::schema::{TrialScore, TunedCurriculum, Tuning};

/// What belongs into the file.
const EXPECTED: &str = "choice of a search";

/// What the search of the results folder `results` chose, and what is wrong with the file; nothing where
/// there was no search, or its trials have not ended yet.
pub fn tuning(results: &Path) -> (Option<Tuning>, Vec<StoreProblem>) {
    let path = layout::choice_file(results);
    let malformed = |reason: String| Fault::Malformed { expected: EXPECTED, reason };
    let fault = match read_json::<Tuning>(&path) {
        Ok(Some(tuning)) => match tuning.curricula.iter().find_map(|one| misfit(&tuning, one)) {
            None => return (Some(tuning), Vec::new()),
            Some(reason) => malformed(reason),
        },
        Ok(None) => return (None, Vec::new()),
        Err(StoreError::Io { source, .. }) => Fault::Unreadable { reason: source.to_string() },
        Err(StoreError::Json { source, .. }) => malformed(source.to_string()),
        Err(error) => malformed(error.to_string()),
    };
    let path = path.strip_prefix(results).unwrap_or(&path).to_owned();
    (None, vec![StoreProblem { path, line: None, fault }])
}

/// Whether trials of a search lie in the results folder `results`.
pub fn has_trials(results: &Path) -> bool {
    Results::new(layout::tuning_dir(results)).survey().is_ok_and(|survey| !survey.runs.is_empty())
}

/// What of a curriculum cannot be.
fn misfit(tuning: &Tuning, one: &TunedCurriculum) -> Option<String> {
    let name = &one.curriculum;
    if !one.tried.is_empty() && one.best().is_none() {
        return Some(format!("{name}: `{}` was chosen and not tried", one.chosen));
    }
    let is_rate = |score: &f64| (0.0..=1.0).contains(score);
    let wrong = |trial: &&TrialScore| {
        !is_rate(&trial.score)
            || trial.places.iter().any(|place| {
                !is_rate(&place.score)
                    || !place.by_seed.iter().all(is_rate)
                    || place.by_seed.len() != tuning.seeds.len()
            })
            || !tuning.environments.iter().all(|id| trial.place(id).is_some())
    };
    let trial = one.tried.iter().find(wrong)?;
    Some(format!(
        "{name}: the scores of `{}` are not numbers in [0, 1], one for every seed and environment",
        trial.variant
    ))
}
