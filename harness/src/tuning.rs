//! What a search chose: from the records of its trials to the file that says which settings, and why.

use std::collections::BTreeMap;
use std::path::Path;

use guard::fresh::write_through;
use reports::analysis::complete::failed_as_zero;
use reports::analysis::options::Failures;
use reports::analysis::tuning::choose::{self, TrialRuns};
use reports::schema::{RunKey, TrialScore, TunedCurriculum, Tuning};
use reports::store::{Store, layout};
use reports::wording::counted;

use crate::error::HarnessError;
use crate::files;
use crate::protocol::search::Trials;
use crate::protocol::{DEFAULT_VARIANT, Protocol};

/// Chooses settings for every curriculum of `protocol` by the records of its `trials` in the results folder
/// `results`, all of which have ended.
///
/// # Errors
/// [`HarnessError::Store`] if they cannot be read, [`HarnessError::Damaged`] naming the first run that is not
/// what it was.
pub(crate) fn choose(protocol: &Protocol, trials: &Trials, results: &Path) -> Result<Tuning, HarnessError> {
    let folder = layout::tuning_dir(results);
    let store = Store::read(&folder)?;
    let completed = failed_as_zero(&store, Failures::Zero);
    let search = &trials.search;
    let scores =
        TrialRuns { store: &store, completed: &completed, measure: search.measure, seeds: &search.seeds };
    let unscored = |run: RunKey| {
        let problems = store.problems().iter().find(|problem| {
            let place = layout::run_dir(Path::new(""), &run);
            problem.path.starts_with(place)
        });
        let reason = problems.map_or_else(|| "has no score".to_owned(), ToString::to_string);
        HarnessError::Damaged { path: layout::run_dir(&folder, &run), reason }
    };
    let mut curricula = Vec::new();
    for curriculum in &protocol.curricula {
        let mut tried = Vec::new();
        for variant in trials.of(curriculum) {
            let place = |environment: &String| scores.place(environment, curriculum, &variant.label);
            let places = protocol.environments.iter().map(place).collect::<Result<Vec<_>, _>>();
            let places = places.map_err(unscored)?;
            let score = choose::mean(&places.iter().map(|place| place.score).collect::<Vec<_>>());
            let settings = trials.settings(curriculum, variant);
            tried.push(TrialScore { variant: variant.label.clone(), settings, score, places });
        }
        let (chosen, reason) = verdict(&tried, protocol, trials);
        let (curriculum, ranges) = (curriculum.clone(), search.ranges_of(curriculum));
        curricula.push(TunedCurriculum { curriculum, ranges, chosen, reason, tried });
    }
    Ok(Tuning {
        measure: search.measure,
        search_seed: search.seed,
        seeds: search.seeds.clone(),
        trials: search.trials as u64,
        environments: protocol.environments.clone(),
        curricula,
    })
}

/// The variant of the best of `tried`, and why that one.
fn verdict(tried: &[TrialScore], protocol: &Protocol, trials: &Trials) -> (String, String) {
    let Some((default, best)) = tried.first().zip(choose::best(tried)) else {
        return (DEFAULT_VARIANT.to_owned(), "no range is given, so nothing was searched".to_owned());
    };
    let (measure, seeds) = (trials.search.measure.in_words(), counted(trials.search.seeds.len(), "seed"));
    let over = format!("over {seeds} and {}", counted(protocol.environments.len(), "environment"));
    let (variant, score) = (&best.variant, best.score);
    let reason = if *variant == default.variant {
        let trials = counted(tried.len() - 1, "trial");
        format!("none of {trials} has a higher mean {measure} {over} than the default settings, {score:.4}")
    } else {
        let others = tried.iter().filter(|other| other.score == score).count() - 1;
        let tied = match others {
            0 => String::new(),
            others => format!("; {} has the same, and a higher number", counted(others, "other trial")),
        };
        let drawn = best.said();
        format!(
            "{variant} ({drawn}) has the highest mean {measure} {over}, {score:.4}{tied}; the default settings have {:.4}",
            default.score
        )
    };
    (variant.clone(), reason)
}

/// The variant that was chosen for each curriculum.
pub(crate) fn chosen(tuning: &Tuning) -> BTreeMap<String, String> {
    tuning.curricula.iter().map(|one| (one.curriculum.clone(), one.chosen.clone())).collect()
}

/// Writes what was chosen, whole or not at all, unless it is there already.
///
/// # Errors
/// [`HarnessError::Io`] if it cannot be written.
pub(crate) fn save(tuning: &Tuning, results: &Path) -> Result<(), HarnessError> {
    let path = layout::choice_file(results);
    let bytes = files::json(tuning).map_err(HarnessError::io(&path, "write this file"))?;
    if guard::files::read(&path).is_ok_and(|there| there == bytes) {
        return Ok(());
    }
    write_through(&path, &bytes).map_err(HarnessError::io(&path, "write this file"))
}
