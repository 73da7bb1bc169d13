//! Reading a run leniently: what is sound is used, everything else is named.

use super::error::StoreError;
use super::problem::{Fault, StoreProblem};
use super::results::Results;
use super::run_folder::{JsonLine, RunFolder};
use super::{Run, check, checksums, layout, lines};
use crate::schema::{Crash, Manifest, Outcome, Record, SCHEMA, Timing};

/// A run's folder and what was found wrong in it so far.
pub(super) struct Loader<'a> {
    results: &'a Results,
    folder: &'a RunFolder,
    problems: Vec<StoreProblem>,
}

impl<'a> Loader<'a> {
    pub(super) fn new(results: &'a Results, folder: &'a RunFolder) -> Self {
        Self { results, folder, problems: Vec::new() }
    }

    /// What was found wrong.
    pub(super) fn into_problems(self) -> Vec<StoreProblem> {
        self.problems
    }

    /// Notes that something is wrong with a file.
    pub(super) fn fault(&mut self, file: &str, line: Option<usize>, fault: Fault) {
        let path = self.results.relative(&self.folder.file(file)).to_owned();
        self.problems.push(StoreProblem { path, line, fault });
    }

    /// What a strict reading gives; an error becomes a problem with the file.
    fn take<T>(
        &mut self,
        file: &str,
        expected: &'static str,
        read: Result<Option<T>, StoreError>,
    ) -> Option<T> {
        read.unwrap_or_else(|error| {
            let fault = match error {
                StoreError::Io { source, .. } => Fault::Unreadable { reason: source.to_string() },
                StoreError::Json { source, .. } => Fault::Malformed { expected, reason: source.to_string() },
                error => Fault::Malformed { expected, reason: error.to_string() },
            };
            self.fault(file, None, fault);
            None
        })
    }

    /// The sound lines of the file of `T`, with their numbers.
    pub(super) fn lines<T: JsonLine>(&mut self) -> Vec<(usize, T)> {
        let bytes = self.take(T::FILE, T::NAME, self.folder.bytes(T::FILE)).unwrap_or_default();
        let mut sound = Vec::new();
        for (line, value) in lines::parse(&bytes) {
            match value {
                Ok(value) => sound.push((line, value)),
                Err(bad) => self.fault(T::FILE, Some(line), bad.fault(T::NAME)),
            }
        }
        sound
    }

    /// There is no run without a manifest of this folder and of this schema.
    fn manifest(&mut self) -> Option<Manifest> {
        let manifest = self.take(layout::MANIFEST, "manifest", self.folder.manifest())?;
        let fault = if manifest.schema != SCHEMA {
            Fault::Schema { found: manifest.schema, expected: SCHEMA }
        } else if self.folder.check_place(&manifest).is_err() {
            Fault::Misplaced { found: manifest.run }
        } else if manifest.run.to_string().contains(char::is_control) {
            Fault::Unprintable
        } else {
            return Some(manifest);
        };
        self.fault(layout::MANIFEST, None, fault);
        None
    }

    /// Whether the files of the run are those that it ended with. A manifest that does not fit its hash is
    /// named and no more: the records that it stands beside may be sound.
    fn is_as_it_was(&mut self, manifest: &Manifest, outcome: Option<&Outcome>) -> bool {
        if checksums::check_manifest(self.folder, manifest).is_err() {
            self.fault(layout::MANIFEST, None, Fault::OtherConfig);
        }
        if outcome.is_none() {
            return true;
        }
        let Err(error) = checksums::check_files(self.folder, manifest) else { return true };
        let file = error.path().file_name().and_then(|name| name.to_str()).unwrap_or_default().to_owned();
        self.fault(&file, None, Fault::Altered { reason: reason(error) });
        false
    }

    /// The timings of the evaluations; none where they are not those that the run ended with.
    fn timings(&mut self, manifest: &Manifest, records: &[Record], has_ended: bool) -> Vec<Timing> {
        let checked = if has_ended { checksums::check_timings(self.folder) } else { Ok(()) };
        match checked {
            Ok(()) => check::timings(self, manifest, records, has_ended),
            Err(error) => {
                self.fault(layout::TIMING, None, Fault::Untimed { reason: reason(error) });
                Vec::new()
            }
        }
    }

    /// The run, as far as it can be used; `None` if it was altered.
    pub(super) fn run(&mut self) -> Option<Run> {
        let manifest = self.manifest()?;
        let outcome = self.take(layout::OUTCOME, "outcome", self.folder.outcome());
        if !self.is_as_it_was(&manifest, outcome.as_ref()) {
            return None;
        }
        let before = self.problems.len();
        let records = check::records(self, &manifest);
        // Where an evaluation is not used, it may be the one that the outcome fits.
        let all_used = self.problems.len() == before;
        let timings = self.timings(&manifest, &records, outcome.is_some());
        match &outcome {
            Some(outcome) => {
                let misfit = check::misfit(outcome, &manifest, &records).filter(|_| all_used);
                if let Some(reason) = misfit {
                    self.fault(layout::OUTCOME, None, Fault::Outcome { reason });
                }
                if let Outcome::Failed { step, reason } = outcome {
                    let fault = Fault::Failed { step: *step, reason: reason.clone() };
                    self.fault(layout::OUTCOME, None, fault);
                }
            }
            None => {
                for (line, Crash { attempt, reason, .. }) in self.lines() {
                    self.fault(layout::CRASHES, Some(line), Fault::Crashed { attempt, reason });
                }
            }
        }
        Some(Run { manifest, records, timings, outcome })
    }
}

/// What is wrong with a file, without its path.
fn reason(error: StoreError) -> String {
    match error {
        StoreError::Altered { reason, .. } => reason,
        StoreError::Io { action, source, .. } => format!("cannot {action}: {source}"),
        error => error.to_string(),
    }
}
