//! Writing the records of a run, a line each, as they come.

use std::fs::File;
use std::io::{Error, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use reports::schema::{Frontier, Learning, Outcome, Record, Shadowing, Teaching, Timing};
use reports::store::checksums::Checksums;
use reports::store::{RunFolder, StoreError, layout};
use serde::{Deserialize, Serialize};

use crate::error::HarnessError;
use crate::files::{json, write_json};
use crate::run::observer::Stage;
use crate::tracking::{Evaluated, EventFile};

/// How far a run's files had come at a checkpoint.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Extent {
    measured: MeasuredExtent,
    /// Only some runs have this file.
    shadow: Prefix,
    /// Seconds since the run began that were spent in shadows; `None` in runs without any.
    shadow_s: Option<f64>,
}

/// The same without shadows: what checkpoints kept before there were any.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MeasuredExtent {
    every_run: CommonExtent,
    /// Only some runs have this file.
    frontier: Prefix,
}

/// The same of the files that every run has: what checkpoints kept before there were others.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CommonExtent {
    records: Prefix,
    teaching: Prefix,
    student: Prefix,
    timing: Prefix,
    wall_s: f64,
    spent: Spent,
}

/// Seconds since the run began, by [`Stage`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Spent {
    teacher: f64,
    learning: f64,
    evaluation: f64,
}

/// The first `bytes` of a file, with their CRC-32.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Prefix {
    bytes: u64,
    crc: u32,
}

impl From<CommonExtent> for Extent {
    fn from(every_run: CommonExtent) -> Self {
        MeasuredExtent { every_run, frontier: Prefix::default() }.into()
    }
}

impl From<MeasuredExtent> for Extent {
    fn from(measured: MeasuredExtent) -> Self {
        Self { measured, shadow: Prefix::default(), shadow_s: None }
    }
}

impl Extent {
    /// Checks that the files of `run` still begin as they were, and changes nothing.
    ///
    /// # Errors
    /// [`HarnessError::Damaged`] naming the file that does not; [`HarnessError::Io`].
    pub fn check(&self, run: &RunFolder) -> Result<(), HarnessError> {
        let MeasuredExtent { every_run, frontier } = &self.measured;
        let parts = [
            (layout::RECORDS, every_run.records),
            (layout::TEACHING, every_run.teaching),
            (layout::STUDENT, every_run.student),
            (layout::TIMING, every_run.timing),
            (layout::FRONTIER, *frontier),
            (layout::SHADOW, self.shadow),
        ];
        for (name, prefix) in parts {
            let path = run.file(name);
            let bytes = run.bytes(name)?.unwrap_or_default();
            let kept = usize::try_from(prefix.bytes).ok().and_then(|length| bytes.get(..length));
            if kept.is_none_or(|kept| crc32fast::hash(kept) != prefix.crc) {
                let reason =
                    "was cut off or altered after its checkpoint; delete this run's folder to train it anew";
                return Err(HarnessError::Damaged { path, reason: reason.into() });
            }
        }
        Ok(())
    }
}

/// A file that only grows, a line at a time.
struct Log {
    path: PathBuf,
    file: File,
    bytes: u64,
    crc: crc32fast::Hasher,
}

impl Log {
    /// Opens the log at `path`, which must begin as it was when `prefix` was noted, and changes nothing.
    fn open(path: PathBuf, prefix: Prefix) -> std::io::Result<Self> {
        let damaged =
            |reason: &str| Error::new(ErrorKind::InvalidData, format!("{} {reason}", path.display()));
        // Where something was noted, a file that is missing stays missing: it is named, not begun anew.
        if prefix.bytes > 0 && path.symlink_metadata().is_err() {
            return Err(damaged("is missing, though its checkpoint goes on from it"));
        }
        let mut file = guard::files::update(&path)?;
        let mut kept = Vec::new();
        (&mut file).take(prefix.bytes).read_to_end(&mut kept)?;
        let mut crc = crc32fast::Hasher::new();
        crc.update(&kept);
        if kept.len() as u64 != prefix.bytes || crc.clone().finalize() != prefix.crc {
            return Err(damaged("was cut off or altered after its checkpoint"));
        }
        Ok(Self { path, file, bytes: prefix.bytes, crc })
    }

    /// Appends a line in one piece.
    fn append(&mut self, value: &impl Serialize) -> std::io::Result<()> {
        let mut line = serde_json::to_vec(value)?;
        line.push(b'\n');
        self.file.write_all(&line).map_err(StoreError::io(&self.path, "append to this file"))?;
        self.bytes += line.len() as u64;
        self.crc.update(&line);
        Ok(())
    }

    fn prefix(&self) -> Prefix {
        Prefix { bytes: self.bytes, crc: self.crc.clone().finalize() }
    }
}

/// Writes a run's `records.jsonl`, `teaching.jsonl`, `student.jsonl`, `timing.jsonl`, `frontier.jsonl` and
/// `shadow.jsonl` where there is anything to write into them and, at last, `checksums.json` and
/// `outcome.json`.
pub struct Recorder {
    folder: RunFolder,
    records: Log,
    teaching: Log,
    student: Log,
    timing: Log,
    /// Begun with its first line.
    frontier: Option<Log>,
    /// Likewise.
    shadow: Option<Log>,
    events: Option<EventFile>,
    /// Seconds of earlier attempts, up to the checkpoint that this one goes on from.
    wall_before: f64,
    begun: Instant,
    spent: Spent,
    shadow_s: Option<f64>,
}

impl Recorder {
    /// Goes on from `extent`, whose default is the beginning. Later lines are cut off: the run writes them
    /// again. It keeps an event file if `tensorboard` asks for one or one is there already.
    ///
    /// # Errors
    /// If the files cannot be written, or are not those that `extent` describes.
    pub fn open(folder: &Path, extent: &Extent, tensorboard: bool) -> std::io::Result<Self> {
        let run = RunFolder::new(folder);
        let Extent { measured: MeasuredExtent { every_run, frontier }, shadow, shadow_s } = extent;
        let records = Log::open(run.file(layout::RECORDS), every_run.records)?;
        let teaching = Log::open(run.file(layout::TEACHING), every_run.teaching)?;
        let student = Log::open(run.file(layout::STUDENT), every_run.student)?;
        let timing = Log::open(run.file(layout::TIMING), every_run.timing)?;
        let if_there = |name: &str, prefix: Prefix| {
            let is_there = prefix.bytes > 0 || run.has(name)?;
            is_there.then(|| Log::open(run.file(name), prefix)).transpose()
        };
        let frontier = if_there(layout::FRONTIER, *frontier)?;
        let shadow = if_there(layout::SHADOW, *shadow)?;
        // All are sound: only now is anything cut off.
        for log in [&records, &teaching, &student, &timing].into_iter().chain(&frontier).chain(&shadow) {
            log.file.set_len(log.bytes)?;
        }
        // Only now: it follows the logs, which have been cut back to the checkpoint.
        let wanted = tensorboard || run.has(layout::EVENTS)?;
        let events = wanted.then(|| EventFile::open(folder)).transpose()?;
        Ok(Self {
            folder: run,
            records,
            teaching,
            student,
            timing,
            frontier,
            shadow,
            events,
            wall_before: every_run.wall_s,
            begun: Instant::now(),
            spent: every_run.spent,
            shadow_s: *shadow_s,
        })
    }

    /// How far the files have come, written through to the disk.
    ///
    /// # Errors
    /// If the disk refuses.
    pub fn extent(&self) -> std::io::Result<Extent> {
        self.sync()?;
        let every_run = CommonExtent {
            records: self.records.prefix(),
            teaching: self.teaching.prefix(),
            student: self.student.prefix(),
            timing: self.timing.prefix(),
            wall_s: self.wall_s(),
            spent: self.spent,
        };
        let prefix = |log: &Option<Log>| log.as_ref().map(Log::prefix).unwrap_or_default();
        let measured = MeasuredExtent { every_run, frontier: prefix(&self.frontier) };
        Ok(Extent { measured, shadow: prefix(&self.shadow), shadow_s: self.shadow_s })
    }

    fn sync(&self) -> std::io::Result<()> {
        let Self { records, teaching, student, timing, frontier, shadow, .. } = self;
        [records, teaching, student, timing].into_iter().chain(frontier).chain(shadow).try_for_each(|log| {
            let synced = log.file.sync_data();
            Ok(synced.map_err(StoreError::io(&log.path, "write this file through to the disk"))?)
        })
    }

    fn wall_s(&self) -> f64 {
        self.wall_before + self.begun.elapsed().as_secs_f64()
    }

    /// Notes that the run spent `time` in `stage`, if that is recorded.
    pub fn spent(&mut self, stage: Stage, time: Duration) {
        let sum = match stage {
            Stage::Teaching | Stage::Probing => &mut self.spent.teacher,
            Stage::Learning => &mut self.spent.learning,
            Stage::Evaluating => &mut self.spent.evaluation,
            Stage::Shadowing => self.shadow_s.get_or_insert_default(),
            _ => return,
        };
        *sum += time.as_secs_f64();
    }

    /// Appends one evaluation, what the teacher did before it and how the student's learning stands.
    ///
    /// # Errors
    /// If the files cannot be written.
    pub fn record(
        &mut self,
        record: &Record,
        teaching: &Teaching,
        learning: &Learning,
    ) -> std::io::Result<()> {
        self.records.append(record)?;
        self.teaching.append(teaching)?;
        self.student.append(learning)?;
        let timing = Timing {
            eval_index: record.eval_index,
            step: record.step,
            wall_s: self.wall_s(),
            evaluation_s: self.spent.evaluation,
            teacher_s: Some(self.spent.teacher),
            learning_s: Some(self.spent.learning),
            shadow_s: self.shadow_s,
        };
        self.timing.append(&timing)?;
        match &mut self.events {
            Some(events) => events.append(&Evaluated {
                record,
                teaching: Some(teaching),
                learning: Some(learning),
                timing: Some(&timing),
            }),
            None => Ok(()),
        }
    }

    /// Appends a measure of the frontier.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn measured(&mut self, frontier: &Frontier) -> std::io::Result<()> {
        let log = match &mut self.frontier {
            Some(log) => log,
            none => none.insert(Log::open(self.folder.file(layout::FRONTIER), Prefix::default())?),
        };
        log.append(frontier)
    }

    /// Appends what the shadows did.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn shadowed(&mut self, shadowing: &Shadowing) -> std::io::Result<()> {
        let log = match &mut self.shadow {
            Some(log) => log,
            none => none.insert(Log::open(self.folder.file(layout::SHADOW), Prefix::default())?),
        };
        log.append(shadowing)
    }

    /// Ends the run with manifest hash `run`. Its checksums come first, that of the outcome among them: once
    /// there is an outcome, nothing about it can change unnoticed. A kill in between leaves a run that has
    /// not ended, whose next worker writes both again.
    ///
    /// # Errors
    /// If the outcome cannot be written.
    pub fn end(self, run: &str, outcome: &Outcome) -> std::io::Result<()> {
        self.sync()?;
        let outcome = json(outcome)?;
        let sums = Checksums::of(&self.folder, run)?.with_outcome(&outcome);
        write_json(&self.folder.file(layout::CHECKSUMS), &sums)?;
        guard::fresh::write_through(&self.folder.file(layout::OUTCOME), &outcome)
    }
}
