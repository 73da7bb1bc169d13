//! Bringing results of several machines together.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use reports::schema::{Outcome, RunKey, Tuning};
use reports::store::cells::{CellMember, odd_ones};
use reports::store::problem::StoreProblem;
use reports::store::{Results, RunFolder, StoreError, Survey, checksums, layout};

use crate::archive;
use crate::error::{HarnessError, chain};
use crate::export::ExportedPolicy;
use crate::fresh_folder::{FolderKind, FreshFolder, refuse_existing};
use crate::outputs;
use crate::protocol::copy;
use crate::run::folder::{self, Sound};
use crate::run::lock::is_locked;
use crate::tuning;

/// What a merge did.
#[derive(Debug, Default)]
pub struct Merged {
    /// Runs in the new folder.
    pub runs: usize,
    /// Runs that several sources had, with the same bytes as far as both go.
    pub shared: usize,
    /// Damaged copies of runs that another source had whole, in a line each.
    pub damaged: Vec<String>,
    /// What lay in the sources and is no run, in a line each.
    pub strays: Vec<String>,
}

/// A sound run in one of the sources.
struct Candidate {
    folder: RunFolder,
    sound: Sound,
    records: Vec<u8>,
    teaching: Vec<u8>,
    /// Evaluations that have timings. Their bytes would not do: a time with more digits is no better.
    timed: usize,
}

/// The copies of a run that the sources hold.
#[derive(Default)]
struct Copies {
    sound: Vec<Candidate>,
    /// What is wrong with the others.
    damaged: Vec<String>,
}

/// Copies the runs of all `sources` into the new folder `out`, which appears complete or not at all.
///
/// Every copy of a run is checked as it is before the run goes on. Sound copies must have the same config,
/// and their records must agree as far as both go; the one that has come further is taken, of equal ones that
/// with a checkpoint and more timings. Policies that came with an archive come along where the run has no
/// checkpoint.
///
/// # Errors
/// [`HarnessError::Unsound`] naming every run that no source has whole, [`HarnessError::Conflict`] naming
/// every conflicting run or policy, [`HarnessError::Missing`] if a source is named twice,
/// [`HarnessError::Unusable`] if not all of it can be read, [`HarnessError::Exists`] if `out` does,
/// [`HarnessError::Argument`] if it would lie in a source, [`HarnessError::Locked`] if a process is carrying
/// out a run, and whatever keeps files from being read or written.
pub fn merge(sources: &[PathBuf], out: &Path) -> Result<Merged, HarnessError> {
    refuse_existing(out)?;
    outputs::outside("--out", out, sources)?;
    check_sources(sources)?;
    let (chosen, mut merged) = gather(sources)?;
    // Trials of a search lie in results folders of their own, and so do they afterwards.
    let of_trials: Vec<PathBuf> =
        sources.iter().map(|source| layout::tuning_dir(source)).filter(|folder| folder.is_dir()).collect();
    let (trials, also) = if of_trials.is_empty() { Default::default() } else { gather(&of_trials)? };
    merged.runs += also.runs;
    merged.shared += also.shared;
    merged.damaged.extend(also.damaged);
    merged.strays.extend(also.strays);
    let choice = tuning::joined(sources)?;
    let policies = policies(&chosen, sources)?;
    let parts = [(Path::new(""), chosen), (Path::new(layout::TUNING), trials)];
    copy_all(&parts, &policies, choice, sources, out)?;
    Ok(merged)
}

/// The copy of every run that the `sources` hold which goes into the new folder, and what was found.
fn gather(sources: &[PathBuf]) -> Result<(Vec<Candidate>, Merged), HarnessError> {
    let mut merged = Merged::default();
    let mut found: BTreeMap<RunKey, Copies> = BTreeMap::new();
    for source in sources {
        let Survey { runs, lost, strays } = match Results::new(source).survey() {
            // A search whose experiment has not begun; its trials are gathered apart.
            Err(StoreError::OnlyTrials { .. }) => continue,
            found => found?,
        };
        if let Some(hidden) = strays.iter().find(|stray| stray.hides_runs()) {
            let whole = HarnessError::unusable(source.display(), "read all runs of this results folder");
            return Err(whole(hidden.to_string()));
        }
        if runs.is_empty() && lost.is_empty() {
            let path = layout::runs_dir(source);
            return Err(HarnessError::Missing { path, reason: "holds no runs".into() });
        }
        let named = |stray: &StoreProblem| format!("{}: {stray}", source.display());
        merged.strays.extend(strays.iter().map(named));
        for folder in runs.into_iter().chain(lost) {
            let Some(key) = folder.key() else { continue };
            let copies = found.entry(key).or_default();
            match read(folder) {
                Ok(candidate) => copies.sound.push(candidate),
                Err(error @ HarnessError::Locked { .. }) => return Err(error),
                Err(error) => copies.damaged.push(chain(&error)),
            }
        }
    }
    merged.shared = found.values().map(|copies| (copies.sound.len()).saturating_sub(1)).sum();
    merged.damaged = found.values().flat_map(|copies| copies.damaged.clone()).collect();
    let chosen = choose(found)?;
    merged.runs = chosen.len();
    Ok((chosen, merged))
}

/// Refuses a folder that is given twice, under one name or two: none of its runs was found more than once.
fn check_sources(sources: &[PathBuf]) -> Result<(), HarnessError> {
    let mut places: BTreeMap<PathBuf, &PathBuf> = BTreeMap::new();
    for source in sources {
        let place = source.canonicalize().map_err(HarnessError::io(source, "find this folder"))?;
        if let Some(first) = places.insert(place, source) {
            let reason = format!("is the same folder as {}; name each once", first.display());
            return Err(HarnessError::Missing { path: source.clone(), reason });
        }
    }
    Ok(())
}

fn read(folder: RunFolder) -> Result<Candidate, HarnessError> {
    if is_locked(folder.path())? {
        // Its worker would change the files while they are copied.
        return Err(HarnessError::Locked { folder: folder.path().to_owned() });
    }
    let sound = folder::check(folder.path())?;
    let bytes = |name| folder.bytes(name).map(Option::unwrap_or_default);
    let (records, teaching) = (bytes(layout::RECORDS)?, bytes(layout::TEACHING)?);
    // Timings that are not what the run ended with count as none.
    let has_lost_timings = sound.outcome.is_some() && checksums::check_timings(&folder).is_err();
    let lines = |bytes: Vec<u8>| bytes.iter().filter(|&&byte| byte == b'\n').count();
    let timed = if has_lost_timings { 0 } else { lines(bytes(layout::TIMING)?) };
    Ok(Candidate { folder, sound, records, teaching, timed })
}

/// The copy of each run that goes into the new folder.
fn choose(found: BTreeMap<RunKey, Copies>) -> Result<Vec<Candidate>, HarnessError> {
    let (mut chosen, mut unsound, mut conflicts) = (Vec::new(), Vec::new(), Vec::new());
    for (key, copies) in found {
        for (index, a) in copies.sound.iter().enumerate() {
            let reasons = copies.sound[..index].iter().filter_map(|b| conflict(b, a));
            conflicts.extend(reasons.map(|reason| format!("{key}: {reason}")));
        }
        // Of equally good ones the first: `max_by_key` takes the last.
        match copies.sound.into_iter().rev().max_by_key(rank) {
            Some(best) => chosen.push(best),
            None => unsound.extend(copies.damaged),
        }
    }
    if !unsound.is_empty() {
        return Err(HarnessError::Unsound { runs: unsound.join("\n  ") });
    }
    let members = chosen.iter().map(|one: &Candidate| CellMember {
        run: &one.sound.manifest.run,
        config: &one.sound.manifest.config,
        has_begun: !one.records.is_empty() || one.sound.outcome.is_some(),
    });
    conflicts.extend(odd_ones(members).into_iter().map(|odd| {
        let (run, other, pointer) = (odd.run, odd.other, odd.pointer);
        format!("{run}: config differs from that of {other} at `{pointer}`; seeds of a method differ in nothing else")
    }));
    if conflicts.is_empty() {
        Ok(chosen)
    } else {
        Err(HarnessError::Conflict { runs: conflicts.join("\n  ") })
    }
}

fn conflict(a: &Candidate, b: &Candidate) -> Option<String> {
    let both = format!("{} and {}", a.folder.path().display(), b.folder.path().display());
    if a.sound.manifest.hash != b.sound.manifest.hash {
        return Some(format!("{both} have different configs"));
    }
    if a.sound.outcome.is_some() && b.sound.outcome.is_some() && a.sound.outcome != b.sound.outcome {
        return Some(format!("{both} ended differently"));
    }
    let differ = |a: &[u8], b: &[u8]| {
        let common = a.len().min(b.len());
        a[..common] != b[..common]
    };
    let name = if differ(&a.records, &b.records) {
        "records"
    } else if differ(&a.teaching, &b.teaching) {
        layout::TEACHING
    } else {
        return None;
    };
    Some(format!("{both} have the same config and different {name}"))
}

/// How far a run has come: a finished one is furthest, then one with more records, then one that has failed;
/// a checkpoint, then more timings decide between equals.
fn rank(one: &Candidate) -> (bool, usize, bool, bool, usize) {
    let Sound { outcome, has_checkpoint, .. } = &one.sound;
    let is_finished = matches!(outcome, Some(Outcome::Finished { .. }));
    (is_finished, one.records.len(), outcome.is_some(), *has_checkpoint, one.timed)
}

/// The policies that came with an archive, of those `runs` whose checkpoints did not.
fn policies(runs: &[Candidate], sources: &[PathBuf]) -> Result<Vec<(RunKey, ExportedPolicy)>, HarnessError> {
    let (mut found, mut conflicts) = (Vec::new(), Vec::new());
    for Sound { manifest, .. } in runs.iter().map(|one| &one.sound).filter(|sound| !sound.has_checkpoint) {
        let mut first: Option<(&Path, ExportedPolicy)> = None;
        for source in sources {
            let Some(policy) = archive::unpacked_policy(source, manifest)? else { continue };
            match &first {
                Some((other, known)) if known.numbers != policy.numbers => conflicts.push(format!(
                    "{}: {} and {} have the same config and different policies",
                    manifest.run,
                    archive::policy_dir(other, &manifest.run).display(),
                    archive::policy_dir(source, &manifest.run).display(),
                )),
                Some(_) => {}
                None => first = Some((source, policy)),
            }
        }
        found.extend(first.map(|(_, policy)| (manifest.run.clone(), policy)));
    }
    if conflicts.is_empty() {
        Ok(found)
    } else {
        Err(HarnessError::Conflict { runs: conflicts.join("\n  ") })
    }
}

const KIND: FolderKind = FolderKind {
    prefix: ".goalbench-merge-",
    holds: &["runs", "protocols", layout::TUNING, archive::POLICIES],
};

/// Copies into a temporary neighbour of `out`, checks what was copied, then renames it. `parts` are runs by
/// the results folder below it that they go to.
fn copy_all(
    parts: &[(&Path, Vec<Candidate>)],
    policies: &[(RunKey, ExportedPolicy)],
    choice: Option<Tuning>,
    sources: &[PathBuf],
    out: &Path,
) -> Result<(), HarnessError> {
    let fresh = FreshFolder::beside(out, &KIND)?;
    for (run, policy) in policies {
        policy.write(&archive::policy_dir(fresh.path(), run))?;
    }
    for (part, one) in parts.iter().flat_map(|(part, runs)| runs.iter().map(move |one| (part, one))) {
        let to = layout::run_dir(&fresh.path().join(part), &one.sound.manifest.run);
        one.folder.copy_to(&to)?;
        // Somebody may have gone on with the run, or changed it, since it was checked.
        folder::check(&to).map_err(HarnessError::unusable(one.folder.path().display(), "copy this run"))?;
    }
    if let Some(choice) = choice {
        let path = layout::choice_file(fresh.path());
        let bytes = tuning::bytes(&choice, &path)?;
        let folder = outputs::folder_of(&path);
        fs::create_dir_all(folder).map_err(HarnessError::io(folder, "create this folder"))?;
        guard::fresh::write(&path, &bytes).map_err(HarnessError::io(&path, "write this file"))?;
    }
    for source in sources {
        copy::bring(source, fresh.path())?;
    }
    fresh.put(out)
}
