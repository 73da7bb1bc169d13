//! TensorBoard event files, written on request beside a run's records.
//!
//! But for the time at which the run began, the file holds only what the records hold. It is never replaced:
//! a worker that begins cuts it back to the events that its checkpoint vouches for and appends the others, so
//! that a TensorBoard that has it open goes on reading. Its format is TensorFlow's: framed records
//! ([TFRecord]), each an `Event` message of `event.proto`.
//!
//! [TFRecord]: https://www.tensorflow.org/tutorials/load_data/tfrecord

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use protobuf::CodedOutputStream;
use reports::schema::{Learning, Record, Teaching, Timing};
pub use reports::store::layout::EVENTS;
use reports::store::{RunFolder, StoreError, checksums, layout};
use reports::wording::counted;

use crate::error::chain;

/// All that is known of one evaluation.
#[derive(Clone, Copy, Debug)]
pub struct Evaluated<'a> {
    /// The evaluation.
    pub record: &'a Record,
    /// What the teacher did before it.
    pub teaching: Option<&'a Teaching>,
    /// How the student's learning stood.
    pub learning: Option<&'a Learning>,
    /// The time taken by then.
    pub timing: Option<&'a Timing>,
}

/// A run's event file, open for more.
pub struct EventFile {
    path: PathBuf,
    file: File,
    /// The run's clock, in seconds since 1970. The run's first event file fixes when the run began: the time
    /// at which that is written, less the time that the run had taken until then.
    clock: Clock,
}

impl EventFile {
    /// Opens the file of the run in `folder`, which is created if it is missing, and brings it in line with
    /// the run's records: what stands in it after the last event that fits them is cut off, and events that
    /// it lacks are appended.
    ///
    /// # Errors
    /// If the records cannot be read or the file cannot be written.
    pub fn open(folder: &Path) -> std::io::Result<Self> {
        let run = RunFolder::new(folder);
        let timings = run.timings()?;
        Self::over(&run, &timings)
    }

    fn over(run: &RunFolder, timings: &[Timing]) -> std::io::Result<Self> {
        let (records, teaching, learning) = (run.records()?, run.teaching()?, run.learning()?);
        let teaching = by_evaluation(&teaching, |line| line.eval_index);
        let learning = by_evaluation(&learning, |line| line.eval_index);
        let timing = by_evaluation(timings, |line| line.eval_index);

        let path = run.file(EVENTS);
        let mut file = guard::files::update(&path).map_err(StoreError::io(&path, "open this file"))?;
        let mut found = Vec::new();
        file.read_to_end(&mut found).map_err(StoreError::io(&path, "read this file"))?;
        let noted = noted_beginning(&found);
        let begun = noted.unwrap_or_else(|| now() - timings.last().map_or(0.0, |timing| timing.wall_s));
        let mut clock = Clock { begun, last: begun };

        let mut events = vec![framed(&version_event(begun))];
        events.extend(records.iter().map(|record| {
            let index = record.eval_index;
            framed(&scalars_event(
                &mut clock,
                &Evaluated {
                    record,
                    teaching: teaching.get(&index).copied(),
                    learning: learning.get(&index).copied(),
                    timing: timing.get(&index).copied(),
                },
            ))
        }));
        let kept = fitting(&found, &events);
        let written = file
            .set_len(kept as u64)
            .and_then(|()| file.seek(SeekFrom::End(0)))
            .and_then(|_| file.write_all(&events.concat()[kept..]));
        written.map_err(StoreError::io(&path, "write this file"))?;
        Ok(Self { path, file, clock })
    }

    /// Appends an evaluation.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn append(&mut self, evaluated: &Evaluated<'_>) -> std::io::Result<()> {
        let event = framed(&scalars_event(&mut self.clock, evaluated));
        self.file.write_all(&event).map_err(StoreError::io(&self.path, "append to this file"))?;
        Ok(())
    }
}

/// Writes the event file of the ended run in `folder`, or brings it up to date. Gives a word on the times
/// that it lacks, where the run's timings were altered or lost; an event file that is there already is then
/// left as it is, since it may know more.
///
/// # Errors
/// As [`EventFile::open`].
pub fn catch_up(folder: &Path) -> std::io::Result<Option<String>> {
    let run = RunFolder::new(folder);
    let (timings, lack) = sound_timings(&run);
    if lack.is_none() || !run.has(EVENTS)? {
        EventFile::over(&run, &timings)?;
    }
    Ok(lack)
}

/// The timings of an ended run, as far as they can be trusted, and what is wrong with them.
fn sound_timings(run: &RunFolder) -> (Vec<Timing>, Option<String>) {
    match checksums::check_timings(run).and_then(|()| Ok((run.timings()?, run.records()?))) {
        Ok((timings, records)) => {
            let known = by_evaluation(&timings, |timing| timing.eval_index);
            let lacking = records.iter().filter(|record| !known.contains_key(&record.eval_index)).count();
            let lack = (lacking > 0).then(|| {
                let (path, all) = (run.file(layout::TIMING), records.len());
                format!(
                    "{}: lacks {lacking} of {}; the event file lacks their times",
                    path.display(),
                    counted(all, "evaluation")
                )
            });
            (timings, lack)
        }
        Err(error) => (Vec::new(), Some(format!("{}; the event file lacks times", chain(&error)))),
    }
}

fn by_evaluation<T>(lines: &[T], index: impl Fn(&T) -> u64) -> BTreeMap<u64, &T> {
    lines.iter().map(|line| (index(line), line)).collect()
}

/// How many bytes of `found` are those of `events` in turn, all of an event or none of it.
fn fitting(found: &[u8], events: &[Vec<u8>]) -> usize {
    let mut kept = 0;
    for event in events {
        if !found[kept..].starts_with(event) {
            break;
        }
        kept += event.len();
    }
    kept
}

/// When things happened, in seconds since 1970.
#[derive(Clone, Copy, Debug)]
struct Clock {
    begun: f64,
    /// When the last event was.
    last: f64,
}

impl Clock {
    /// When an evaluation was; that of the event before it, where nothing is known.
    fn at(&mut self, timing: Option<&Timing>) -> f64 {
        self.last = timing.map_or(self.last, |timing| self.begun + timing.wall_s);
        self.last
    }
}

/// What is shown of an evaluation, by tag. Numbers that are not defined yet are left out.
fn scalars(evaluated: &Evaluated<'_>) -> Vec<(String, f64)> {
    let Evaluated { record, teaching, learning, timing } = *evaluated;
    let mut scalars = vec![
        ("evaluation/success_rate".to_owned(), record.success_rate),
        ("evaluation/mean_return".to_owned(), record.mean_return),
        ("student/gradient_steps".to_owned(), record.gradient_steps as f64),
    ];
    scalars.extend(record.any_success_rate.map(|rate| ("evaluation/any_success_rate".to_owned(), rate)));
    let diagnosis = learning.into_iter().flat_map(Learning::numbers);
    scalars.extend(diagnosis.filter_map(|(name, value)| Some((format!("student/{name}"), value?))));
    if let Some(Timing { wall_s, evaluation_s, .. }) = timing {
        scalars.push(("time/wall_s".to_owned(), *wall_s));
        scalars.push(("time/evaluation_s".to_owned(), *evaluation_s));
    }
    if let Some(successes) = teaching.map(|teaching| &teaching.successes).filter(|all| !all.is_empty()) {
        let rate = successes.iter().filter(|&&success| success).count() as f64 / successes.len() as f64;
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

fn scalars_event(clock: &mut Clock, evaluated: &Evaluated<'_>) -> Vec<u8> {
    let summary = message(|out| {
        for (tag, value) in scalars(evaluated) {
            let value = message(|out| {
                out.write_string(VALUE_TAG, &tag)?;
                out.write_float(VALUE_SIMPLE, value as f32)
            });
            out.write_bytes(SUMMARY_VALUE, &value)?;
        }
        Ok(())
    });
    message(|out| {
        out.write_double(EVENT_WALL_TIME, clock.at(evaluated.timing))?;
        out.write_int64(EVENT_STEP, i64::try_from(evaluated.record.step).unwrap_or(i64::MAX))?;
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

    #[test]
    fn what_fits_the_records_stays_where_it_is() {
        let events = [b"one".to_vec(), b"two".to_vec(), b"three".to_vec()];
        for (found, kept) in [
            (&b""[..], 0),
            (b"onetwothree", 11),
            (b"onetwothreefour", 11),
            (b"onetwothr", 6),
            (b"onetoo", 3),
            (b"two", 0),
        ] {
            assert_eq!(fitting(found, &events), kept, "{}", String::from_utf8_lossy(found));
        }
    }
}
