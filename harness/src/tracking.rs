//! TensorBoard event files, written on request beside a run's records.
//!
//! But for the time at which the run began, the file holds only what the records hold: it is written anew
//! from them whenever a worker begins, then grows with every evaluation. Its format is TensorFlow's: framed
//! records ([TFRecord]), each an `Event` message of `event.proto`.
//!
//! [TFRecord]: https://www.tensorflow.org/tutorials/load_data/tfrecord

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use protobuf::CodedOutputStream;
use reports::schema::{Record, Teaching, Timing};
pub use reports::store::layout::EVENTS;
use reports::store::{RunFolder, StoreError};

use crate::files::new_file;

/// A run's event file, open for more.
pub struct EventFile {
    path: PathBuf,
    file: File,
    /// When the run began, in seconds since 1970. The run's first event file fixes it: the time at which that
    /// is written, less the time that the run had taken until then.
    begun: f64,
}

impl EventFile {
    /// Writes the file anew from the run's records in `folder`, whole or not at all.
    ///
    /// # Errors
    /// If the records cannot be read or the file cannot be written.
    pub fn rewrite(folder: &Path) -> std::io::Result<Self> {
        let run = RunFolder::new(folder);
        let (records, teaching, timing) = (run.records()?, run.teaching()?, run.timings()?);
        let noted = run.bytes(EVENTS)?.as_deref().and_then(noted_beginning);
        let begun = noted.unwrap_or_else(|| now() - timing.last().map_or(0.0, |timing| timing.wall_s));

        let mut file = new_file(folder)?;
        file.write_all(&framed(&version_event(begun)))?;
        for ((record, teaching), timing) in records.iter().zip(&teaching).zip(&timing) {
            file.write_all(&framed(&scalars_event(begun, record, teaching, timing)))?;
        }
        let path = run.file(EVENTS);
        let file = guard::fresh::put(file, &path)?;
        Ok(Self { path, file, begun })
    }

    /// Appends an evaluation.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn append(&mut self, record: &Record, teaching: &Teaching, timing: &Timing) -> std::io::Result<()> {
        let event = framed(&scalars_event(self.begun, record, teaching, timing));
        self.file.write_all(&event).map_err(StoreError::io(&self.path, "append to this file"))?;
        Ok(())
    }
}

/// What is shown of an evaluation, by tag. Numbers that are not defined yet are left out.
fn scalars(record: &Record, teaching: &Teaching, timing: &Timing) -> Vec<(String, f64)> {
    let mut scalars = vec![
        ("evaluation/success_rate".to_owned(), record.success_rate),
        ("evaluation/mean_return".to_owned(), record.mean_return),
        ("student/gradient_steps".to_owned(), record.gradient_steps as f64),
        ("time/wall_s".to_owned(), timing.wall_s),
        ("time/evaluation_s".to_owned(), timing.evaluation_s),
    ];
    scalars.extend(record.any_success_rate.map(|rate| ("evaluation/any_success_rate".to_owned(), rate)));
    if !teaching.successes.is_empty() {
        let successes = teaching.successes.iter().filter(|&&success| success).count();
        let rate = successes as f64 / teaching.successes.len() as f64;
        scalars.push(("training/success_rate".to_owned(), rate));
    }
    let teacher = record.teacher.iter().filter_map(|(name, value)| Some((name, value.as_f64()?)));
    scalars.extend(teacher.map(|(name, value)| (format!("teacher/{name}"), value)));
    scalars
}

// Field numbers of event.proto and summary.proto.
const EVENT_WALL_TIME: u32 = 1;
const EVENT_STEP: u32 = 2;
const EVENT_FILE_VERSION: u32 = 3;
const EVENT_SUMMARY: u32 = 5;
const SUMMARY_VALUE: u32 = 1;
const VALUE_TAG: u32 = 1;
const VALUE_SIMPLE: u32 = 2;

/// The event that every file begins with.
fn version_event(begun: f64) -> Vec<u8> {
    message(|out| {
        out.write_double(EVENT_WALL_TIME, begun)?;
        out.write_string(EVENT_FILE_VERSION, "brain.Event:2")
    })
}

/// When the run of an event file began, from the file's first event.
fn noted_beginning(file: &[u8]) -> Option<f64> {
    // Length, its checksum, the field's tag.
    const PLACE: usize = 8 + 4 + 1;
    let begun = f64::from_le_bytes(file.get(PLACE..PLACE + 8)?.try_into().ok()?);
    file.starts_with(&framed(&version_event(begun))).then_some(begun)
}

/// Seconds since 1970.
fn now() -> f64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0.0, |since| since.as_secs_f64())
}

fn scalars_event(begun: f64, record: &Record, teaching: &Teaching, timing: &Timing) -> Vec<u8> {
    let summary = message(|out| {
        for (tag, value) in scalars(record, teaching, timing) {
            let value = message(|out| {
                out.write_string(VALUE_TAG, &tag)?;
                out.write_float(VALUE_SIMPLE, value as f32)
            });
            out.write_bytes(SUMMARY_VALUE, &value)?;
        }
        Ok(())
    });
    message(|out| {
        out.write_double(EVENT_WALL_TIME, begun + timing.wall_s)?;
        out.write_int64(EVENT_STEP, i64::try_from(record.step).unwrap_or(i64::MAX))?;
        out.write_bytes(EVENT_SUMMARY, &summary)
    })
}

fn message(write: impl FnOnce(&mut CodedOutputStream<'_>) -> protobuf::Result<()>) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut out = CodedOutputStream::vec(&mut bytes);
    write(&mut out).and_then(|()| out.flush()).expect("writing to memory does not fail");
    drop(out);
    bytes
}

const CRC32C: crc::Crc<u32> = crc::Crc::<u32>::new(&crc::CRC_32_ISCSI);

/// CRC-32C, rotated right by 15 bits plus a constant, as TFRecord stores it.
fn masked_crc(bytes: &[u8]) -> u32 {
    CRC32C.checksum(bytes).rotate_right(15).wrapping_add(0xa282_ead8)
}

/// A TFRecord: length, its checksum, the bytes, their checksum; little-endian.
fn framed(bytes: &[u8]) -> Vec<u8> {
    let length = (bytes.len() as u64).to_le_bytes();
    let mut record = Vec::with_capacity(bytes.len() + 16);
    record.extend(length);
    record.extend(masked_crc(&length).to_le_bytes());
    record.extend(bytes);
    record.extend(masked_crc(bytes).to_le_bytes());
    record
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The bytes of TensorBoard 2.21's own `RecordWriter` for `Event(wall_time=1,
    /// file_version="brain.Event:2")`.
    #[test]
    fn the_first_event_has_tensorboards_bytes() {
        let expected = "1800000000000000a37f4b2209000000000000f03f1a0d627261696e2e4576656e743a3286bf577a";
        let written: String = framed(&version_event(1.0)).iter().map(|byte| format!("{byte:02x}")).collect();
        assert_eq!(written, expected);
    }

    #[test]
    fn a_file_tells_when_its_run_began() {
        let mut file = framed(&version_event(1.7e9));
        assert_eq!(noted_beginning(&file), Some(1.7e9));
        file[14] ^= 1;
        assert_eq!(noted_beginning(&file), None, "its checksum is wrong");
        assert_eq!(noted_beginning(&file[..10]), None);
    }
}
