//! Writing the records of a run, a line each, as they come.

use std::fs::{File, OpenOptions};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;

use reports::layout;
use reports::record::{Outcome, Record, Teaching, Timing};
use serde::{Deserialize, Serialize};

use super::write_json;

/// How far a run's files had come at a checkpoint.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Progress {
    records: Written,
    teaching: Written,
    timing: Written,
    wall_s: f64,
    evaluation_s: f64,
}

/// The first `bytes` of a file, with their CRC-32.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Written {
    bytes: u64,
    crc: u32,
}

/// A file that only grows, a line at a time.
struct Log {
    path: PathBuf,
    file: File,
    bytes: u64,
    crc: crc32fast::Hasher,
}

impl Log {
    /// Opens the log at `path` as it was when `written` was noted; what came later is cut off.
    fn open(path: PathBuf, written: Written) -> std::io::Result<Self> {
        let mut file = OpenOptions::new().create(true).truncate(false).read(true).write(true).open(&path)?;
        let mut kept = Vec::new();
        (&mut file).take(written.bytes).read_to_end(&mut kept)?;
        let mut crc = crc32fast::Hasher::new();
        crc.update(&kept);
        if kept.len() as u64 != written.bytes || crc.clone().finalize() != written.crc {
            let reason = format!("{} was cut off or altered after its checkpoint", path.display());
            return Err(std::io::Error::new(std::io::ErrorKind::InvalidData, reason));
        }
        file.set_len(written.bytes)?;
        Ok(Self { path, file, bytes: written.bytes, crc })
    }

    /// Appends a line in one piece.
    fn append(&mut self, value: &impl Serialize) -> std::io::Result<()> {
        let mut line = serde_json::to_vec(value)?;
        line.push(b'\n');
        self.file.write_all(&line).map_err(|error| {
            std::io::Error::new(error.kind(), format!("{}: {error}", self.path.display()))
        })?;
        self.bytes += line.len() as u64;
        self.crc.update(&line);
        Ok(())
    }

    fn written(&self) -> Written {
        Written { bytes: self.bytes, crc: self.crc.clone().finalize() }
    }
}

/// Writes a run's `records.jsonl`, `teaching.jsonl`, `timing.jsonl` and, at last, `outcome.json`.
pub struct Recorder {
    folder: PathBuf,
    records: Log,
    teaching: Log,
    timing: Log,
    /// Seconds of earlier attempts, up to the checkpoint that this one goes on from.
    wall_before: f64,
    begun: Instant,
    evaluating_since: Option<Instant>,
    evaluation_s: f64,
}

impl Recorder {
    /// Goes on after `progress`; its default begins anew. Lines written after it are cut off: the run writes them again.
    ///
    /// # Errors
    /// If the files cannot be written, or are not those that `progress` was noted of.
    pub fn open(folder: &Path, progress: &Progress) -> std::io::Result<Self> {
        Ok(Self {
            folder: folder.to_owned(),
            records: Log::open(folder.join(layout::RECORDS), progress.records)?,
            teaching: Log::open(folder.join(layout::TEACHING), progress.teaching)?,
            timing: Log::open(folder.join(layout::TIMING), progress.timing)?,
            wall_before: progress.wall_s,
            begun: Instant::now(),
            evaluating_since: None,
            evaluation_s: progress.evaluation_s,
        })
    }

    /// How far the files have come, written through to the disk.
    ///
    /// # Errors
    /// If the disk refuses.
    pub fn progress(&self) -> std::io::Result<Progress> {
        self.records.file.sync_data()?;
        self.teaching.file.sync_data()?;
        self.timing.file.sync_data()?;
        Ok(Progress {
            records: self.records.written(),
            teaching: self.teaching.written(),
            timing: self.timing.written(),
            wall_s: self.wall_s(),
            evaluation_s: self.evaluation_s,
        })
    }

    fn wall_s(&self) -> f64 {
        self.wall_before + self.begun.elapsed().as_secs_f64()
    }

    /// Notes that an evaluation begins.
    pub fn evaluating(&mut self) {
        self.evaluating_since = Some(Instant::now());
    }

    /// Appends one evaluation and what the teacher did before it.
    ///
    /// # Errors
    /// If the files cannot be written.
    pub fn record(&mut self, record: &Record, teaching: &Teaching) -> std::io::Result<()> {
        self.evaluation_s += self.evaluating_since.take().map_or(0.0, |since| since.elapsed().as_secs_f64());
        self.records.append(record)?;
        self.teaching.append(teaching)?;
        let timing = Timing {
            eval_index: record.eval_index,
            step: record.step,
            wall_s: self.wall_s(),
            evaluation_s: self.evaluation_s,
            teacher_s: None,
            learning_s: None,
        };
        self.timing.append(&timing)
    }

    /// Ends the run.
    ///
    /// # Errors
    /// If the outcome cannot be written.
    pub fn end(self, outcome: &Outcome) -> std::io::Result<()> {
        self.records.file.sync_all()?;
        self.teaching.file.sync_all()?;
        write_json(&self.folder.join(layout::OUTCOME), outcome)
    }
}
