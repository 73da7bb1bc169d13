//! What a search chose: from the records of its trials to the file that says which settings, and why. A
//! choice is made once: what was run with it stands beside it.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use guard::fresh::write_through;
use reports::analysis::complete::failed_as_zero;
use reports::analysis::options::Failures;
use reports::analysis::tuning::TUNED;
use reports::analysis::tuning::choose::{self, TrialRuns};
use reports::schema::{RunKey, TrialScore, TunedCurriculum, Tuning};
use reports::store::{self, Results, Store, layout};
use reports::wording::counted;

use crate::error::HarnessError;
use crate::files;
use crate::protocol::search::Trials;
use crate::protocol::{DEFAULT_VARIANT, Protocol};
use crate::run::folder::has_begun;

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
            others => format!("; {} with a higher number did as well", counted(others, "trial")),
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

/// What an earlier command chose in `results`, unless this one would choose by something else.
///
/// # Errors
/// [`HarnessError::Damaged`] if the choice there is none, [`HarnessError::Protocol`] naming what it was made
/// by and what this search goes by.
pub(crate) fn stored(
    protocol: &Protocol,
    trials: &Trials,
    results: &Path,
) -> Result<Option<Tuning>, HarnessError> {
    let Some(found) = read(results)? else { return Ok(None) };
    let search = &trials.search;
    let sorted = |ids: &[String]| {
        let mut ids = ids.to_vec();
        ids.sort();
        ids.join(", ")
    };
    let seeds = |seeds: &[u64]| seeds.iter().map(u64::to_string).collect::<Vec<_>>().join(", ");
    let is_whole = found.curricula.iter().all(|one| protocol.curricula.contains(&one.curriculum));
    // More trials are welcome, but for all curricula that were chosen for.
    let trials = if is_whole { found.trials.max(search.trials as u64) } else { found.trials };
    let rows = [
        ("measure", found.measure.in_words().to_owned(), search.measure.in_words().to_owned()),
        ("environments", sorted(&found.environments), sorted(&protocol.environments)),
        ("seeds of trials", seeds(&found.seeds), seeds(&search.seeds)),
        ("seed of draws", found.search_seed.to_string(), search.seed.to_string()),
        ("number of trials", trials.to_string(), search.trials.to_string()),
    ];
    match rows.into_iter().find(|(_, there, here)| there != here) {
        None => Ok(Some(found)),
        Some((what, there, here)) => {
            let file = layout::choice_file(results);
            let reason = format!(
                "the choice in {} was made with another {what}: {there} there, {here} here; give what it was made with, or \
                 another --out",
                file.display()
            );
            Err(HarnessError::Protocol { place: search.place.clone(), reason })
        }
    }
}

fn read(results: &Path) -> Result<Option<Tuning>, HarnessError> {
    let (found, problems) = store::tuning(results);
    match problems.first() {
        None => Ok(found),
        Some(problem) => {
            let path = layout::choice_file(results);
            let reason = format!("{}; remove it, and the same command makes it again", problem.fault);
            Err(HarnessError::Damaged { path, reason })
        }
    }
}

/// `choice`, beside what was `stored` for curricula that it is not about.
pub(crate) fn beside(stored: Option<Tuning>, choice: Tuning) -> Tuning {
    let Some(stored) = stored else { return choice };
    let Tuning { curricula: chosen, .. } = choice;
    let mut curricula = stored.curricula;
    for one in chosen {
        match curricula.iter_mut().find(|known| known.curriculum == one.curriculum) {
            Some(known) => *known = one,
            None => curricula.push(one),
        }
    }
    Tuning { curricula, ..choice }
}

/// Refuses a choice of default settings where runs with others have begun: a report would show them as the
/// chosen ones. (Runs with other settings than those chosen now are refused as such.)
///
/// # Errors
/// [`HarnessError::Damaged`] naming the first such run.
pub(crate) fn refuse_other_runs(choice: &Tuning, results: &Path) -> Result<(), HarnessError> {
    if !layout::runs_dir(results).is_dir() {
        return Ok(());
    }
    let survey = Results::new(results).survey()?;
    for run in survey.runs.iter().chain(&survey.lost) {
        let Some(key) = run.key().filter(|key| key.variant == TUNED) else { continue };
        let is_of = |one: &&TunedCurriculum| one.curriculum == key.curriculum;
        let has_none = choice.curricula.iter().find(is_of).is_some_and(|one| one.chosen == DEFAULT_VARIANT);
        if has_none && has_begun(run)? {
            let reason = format!(
                "this run has settings that are not chosen: no trial of {} is better than the default settings. The choice \
                 stays what it was; choose another --out, or delete that folder",
                key.curriculum
            );
            return Err(HarnessError::Damaged { path: run.path().to_owned(), reason });
        }
    }
    Ok(())
}

/// The choices of several results folders as one; `None` without any.
///
/// # Errors
/// [`HarnessError::Damaged`] if one of them is none, [`HarnessError::Conflict`] naming two that differ.
pub(crate) fn joined(sources: &[PathBuf]) -> Result<Option<Tuning>, HarnessError> {
    let mut joined: Option<(&PathBuf, Tuning)> = None;
    for source in sources {
        let Some(found) = read(source)? else { continue };
        joined = Some(match joined {
            None => (source, found),
            Some((first, known)) if are_one(&known, &found) => (first, beside(Some(known), found)),
            Some((first, _)) => {
                let [a, b] = [first, source].map(|source| layout::choice_file(source));
                let runs = format!("{} and {} chose differently", a.display(), b.display());
                return Err(HarnessError::Conflict { runs });
            }
        });
    }
    Ok(joined.map(|(_, tuning)| tuning))
}

/// Whether two choices were made in one way, and agree on the curricula that both are about.
fn are_one(a: &Tuning, b: &Tuning) -> bool {
    let by = |tuning: &Tuning| Tuning { curricula: Vec::new(), ..tuning.clone() };
    let agree = |one: &TunedCurriculum| {
        a.curricula.iter().all(|other| other.curriculum != one.curriculum || other == one)
    };
    by(a) == by(b) && b.curricula.iter().all(agree)
}

/// Writes what was chosen, whole or not at all, unless it is there already.
///
/// # Errors
/// [`HarnessError::Io`] if it cannot be written.
pub(crate) fn save(tuning: &Tuning, results: &Path) -> Result<(), HarnessError> {
    let path = layout::choice_file(results);
    let bytes = bytes(tuning, &path)?;
    if guard::files::read(&path).is_ok_and(|there| there == bytes) {
        return Ok(());
    }
    write_through(&path, &bytes).map_err(HarnessError::io(&path, "write this file"))
}

/// The file's bytes.
///
/// # Errors
/// [`HarnessError::Io`] naming `path` if they cannot be made.
pub(crate) fn bytes(tuning: &Tuning, path: &Path) -> Result<Vec<u8>, HarnessError> {
    files::json(tuning).map_err(HarnessError::io(path, "write this file"))
}
