//! The replay buffer on disk: every episode is appended once.
//!
//! The log is a folder of segments of [`SEGMENT`] episodes each, `episodes-K.bin` for the episodes from
//! K·[`SEGMENT`] on. A segment is a header (magic, version, numbers per record, first episode) and then, per
//! episode, its record in little-endian f32 with the CRC-32 of those bytes. A student that was saved after n
//! episodes reads back the last ones before the n-th, as many as its buffer held; everything after them was
//! written later and is cut off.

use std::fs;
use std::io::{BufReader, Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

use guard::files;

use super::Replay;
use crate::error::{AgentError, LogProblem};

const MAGIC: [u8; 4] = *b"GBRL";
const VERSION: u32 = 1;
/// Bytes of a segment's header.
const HEADER: u64 = 24;
/// Episodes per segment.
const SEGMENT: u64 = 1000;

/// How far the log on disk has come.
#[derive(Clone, Debug, Default)]
pub(crate) struct Log {
    /// Episodes in the log; earlier ones may be gone already.
    written: u64,
    /// The oldest episode that the state saved last refers to.
    needed: u64,
}

impl Log {
    /// Appends what came into `replay` since the last call, and removes segments that neither this state nor
    /// the one before needs. The first call of a run begins the log anew.
    ///
    /// # Errors
    /// [`AgentError::Log`] naming the file that cannot be written.
    pub(crate) fn append(&mut self, replay: &Replay, folder: &Path) -> Result<(), AgentError> {
        fs::create_dir_all(folder).map_err(failed(folder))?;
        if self.written == 0 {
            for (path, _) in segments(folder)? {
                fs::remove_file(&path).map_err(failed(&path))?;
            }
        }
        let oldest = replay.stored - replay.len() as u64;
        let mut next = self.written.max(oldest);
        while next < replay.stored {
            let end = replay.stored.min((next / SEGMENT + 1) * SEGMENT);
            append_to_segment(replay, folder, next, end)?;
            next = end;
        }
        for (path, first) in segments(folder)? {
            if first + SEGMENT <= self.needed {
                fs::remove_file(&path).map_err(failed(&path))?;
            }
        }
        self.written = replay.stored;
        self.needed = oldest;
        Ok(())
    }

    /// Fills the empty `replay` as it was when `stored` episodes had come in, and cuts off what was written
    /// later.
    ///
    /// # Errors
    /// [`AgentError::Log`] naming the file that is missing, cut short, altered or of another task.
    pub(crate) fn load(&mut self, replay: &mut Replay, stored: u64, folder: &Path) -> Result<(), AgentError> {
        let oldest = stored.saturating_sub(replay.capacity as u64);
        replay.records.clear();
        replay
            .records
            .resize_with(usize::try_from(stored - oldest).expect("at most the capacity"), Box::default);
        let record_len = replay.record_len();
        read_all(folder, record_len, oldest..stored, |episode, record| {
            let numbers = record.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
            let slot = replay.slot(episode);
            replay.records[slot] = numbers.collect();
        })?;
        replay.stored = stored;
        cut_off(folder, stored, record_bytes(record_len))?;
        *self = Self { written: stored, needed: oldest };
        Ok(())
    }
}

/// The file of the segment that holds `episode`.
fn segment_path(folder: &Path, episode: u64) -> PathBuf {
    folder.join(format!("episodes-{}.bin", episode / SEGMENT))
}

/// The segments in `folder` with their first episodes; other files are left alone.
fn segments(folder: &Path) -> Result<Vec<(PathBuf, u64)>, AgentError> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).map_err(failed(folder))? {
        let path = entry.map_err(failed(folder))?.path();
        let name = path.file_name().and_then(|name| name.to_str());
        let index =
            name.and_then(|name| name.strip_prefix("episodes-")?.strip_suffix(".bin")?.parse::<u64>().ok());
        if let Some(first) = index.and_then(|index| index.checked_mul(SEGMENT)) {
            found.push((path, first));
        }
    }
    Ok(found)
}

/// Bytes of an episode in a segment: its record of `record_len` numbers and its checksum.
fn record_bytes(record_len: usize) -> u64 {
    4 * record_len as u64 + 4
}

/// Where `episode` begins in its segment.
fn offset(episode: u64, record_bytes: u64) -> u64 {
    HEADER + (episode % SEGMENT) * record_bytes
}

fn header(record_len: usize, episode: u64) -> Vec<u8> {
    let first = episode / SEGMENT * SEGMENT;
    [&MAGIC[..], &VERSION.to_le_bytes(), &(record_len as u64).to_le_bytes(), &first.to_le_bytes()].concat()
}

fn append_to_segment(replay: &Replay, folder: &Path, from: u64, to: u64) -> Result<(), AgentError> {
    let record_len = replay.record_len();
    let mut bytes = Vec::with_capacity(((to - from) * record_bytes(record_len)) as usize);
    for episode in from..to {
        let start = bytes.len();
        for number in &replay.records[replay.slot(episode)] {
            bytes.extend_from_slice(&number.to_le_bytes());
        }
        let crc = crc32fast::hash(&bytes[start..]);
        bytes.extend_from_slice(&crc.to_le_bytes());
    }
    let path = segment_path(folder, from);
    let write = || -> std::io::Result<()> {
        let mut file = files::update(&path)?;
        file.write_all(&header(record_len, from))?;
        file.seek(SeekFrom::Start(offset(from, record_bytes(record_len))))?;
        file.write_all(&bytes)?;
        file.sync_data()
    };
    write().map_err(failed(&path))
}

/// Hands the record of every one of `episodes`, checked, to `take`. Changes nothing.
///
/// # Errors
/// [`AgentError::Log`] naming the file that is missing, cut short, altered or of another task.
pub(crate) fn read_all(
    folder: &Path,
    record_len: usize,
    episodes: Range<u64>,
    mut take: impl FnMut(u64, &[u8]),
) -> Result<(), AgentError> {
    let mut next = episodes.start;
    while next < episodes.end {
        let end = episodes.end.min((next / SEGMENT + 1) * SEGMENT);
        read_segment(folder, record_len, next..end, &mut take)?;
        next = end;
    }
    Ok(())
}

/// The same for episodes of one segment.
fn read_segment(
    folder: &Path,
    record_len: usize,
    episodes: Range<u64>,
    take: &mut impl FnMut(u64, &[u8]),
) -> Result<(), AgentError> {
    let from = episodes.start;
    let path = segment_path(folder, from);
    let damaged = |what: String| AgentError::Log { path: path.clone(), source: LogProblem::Damaged(what) };
    let mut file = files::open(&path).map_err(failed(&path))?;
    let mut start = vec![0; HEADER as usize];
    file.read_exact(&mut start).map_err(|_| damaged("is shorter than its header".into()))?;
    if start != header(record_len, from) {
        return Err(damaged("does not begin as a segment of this task's replay log in this version".into()));
    }
    let size = record_bytes(record_len);
    file.seek(SeekFrom::Start(offset(from, size))).map_err(failed(&path))?;
    let mut file = BufReader::new(file);
    let mut bytes = vec![0; size as usize];
    for episode in episodes {
        file.read_exact(&mut bytes)
            .map_err(|_| damaged(format!("is cut off before the end of episode {episode}")))?;
        let (record, crc) = bytes.split_at(bytes.len() - 4);
        if crc32fast::hash(record).to_le_bytes() != crc {
            return Err(damaged(format!("the checksum of episode {episode} does not fit: it was altered")));
        }
        take(episode, record);
    }
    Ok(())
}

/// Removes everything from episode `stored` on.
fn cut_off(folder: &Path, stored: u64, record_bytes: u64) -> Result<(), AgentError> {
    for (path, first) in segments(folder)? {
        if first >= stored {
            fs::remove_file(&path).map_err(failed(&path))?;
        } else if stored < first + SEGMENT {
            let file = files::update(&path).map_err(failed(&path))?;
            file.set_len(offset(stored, record_bytes)).map_err(failed(&path))?;
        }
    }
    Ok(())
}

fn failed(path: &Path) -> impl FnOnce(std::io::Error) -> AgentError {
    let path = path.to_owned();
    move |error| AgentError::Log { path, source: LogProblem::Io(error) }
}

#[cfg(test)]
mod tests {
    use envs::{Defaults, Rows, Spec};

    use super::*;
    use crate::episode::Episode;

    const SPEC: Spec =
        Spec { id: "Tiny", family: "toy", state: 1, goal: 1, action: 1, horizon: 2, defaults: Defaults::TOY };

    /// A buffer of `capacity` episodes.
    fn buffer(capacity: usize) -> Replay {
        Replay::new(&SPEC, capacity * SPEC.horizon).unwrap()
    }

    fn push(replay: &mut Replay, episodes: std::ops::Range<u64>) {
        for number in episodes {
            let mut rows = Rows::new(1);
            (0..3).for_each(|step| rows.push(&[number as f64 + f64::from(step) / 4.0]));
            let mut actions = Rows::new(1);
            (0..2).for_each(|_| actions.push(&[0.5]));
            let episode = Episode {
                states: rows.clone(),
                achieved: rows,
                actions,
                goal: vec![-1.0],
                total_reward: 0.0,
                success: false,
            };
            replay.push(&episode).unwrap();
        }
    }

    fn assert_same(a: &Replay, b: &Replay) {
        assert_eq!((a.stored, &a.records), (b.stored, &b.records));
    }

    #[test]
    fn what_was_appended_is_loaded_across_segments_and_after_the_ring_wrapped() {
        for (capacity, pushes) in
            [(10, vec![3]), (10, vec![4, 9]), (1500, vec![700, 700, 900]), (5, vec![1200, 3])]
        {
            let folder = tempfile::tempdir().unwrap();
            let (mut replay, mut log) = (buffer(capacity), Log::default());
            for count in pushes {
                let stored = replay.stored;
                push(&mut replay, stored..stored + count);
                log.append(&replay, folder.path()).unwrap();
            }
            let (mut loaded, mut second) = (buffer(capacity), Log::default());
            second.load(&mut loaded, replay.stored, folder.path()).unwrap();
            assert_same(&loaded, &replay);
        }
    }

    #[test]
    fn a_state_saved_before_still_loads_after_later_appends_and_cuts_them_off() {
        let folder = tempfile::tempdir().unwrap();
        let (mut replay, mut log) = (buffer(4), Log::default());
        push(&mut replay, 0..998);
        log.append(&replay, folder.path()).unwrap();
        let before = replay.clone();
        push(&mut replay, 998..1003);
        log.append(&replay, folder.path()).unwrap();

        let (mut loaded, mut second) = (buffer(4), Log::default());
        second.load(&mut loaded, 998, folder.path()).unwrap();
        assert_same(&loaded, &before);
        assert!(!segment_path(folder.path(), 1000).exists(), "what came later is gone");
        // Going on from there writes the same log as never having stopped.
        push(&mut loaded, 998..1003);
        second.append(&loaded, folder.path()).unwrap();
        let mut again = buffer(4);
        Log::default().load(&mut again, 1003, folder.path()).unwrap();
        assert_same(&again, &replay);
    }

    #[test]
    fn segments_that_no_saved_state_needs_are_removed() {
        let folder = tempfile::tempdir().unwrap();
        let (mut replay, mut log) = (buffer(10), Log::default());
        for end in [900, 1500, 1600] {
            let stored = replay.stored;
            push(&mut replay, stored..end);
            log.append(&replay, folder.path()).unwrap();
        }
        let kept: Vec<u64> = segments(folder.path()).unwrap().into_iter().map(|(_, first)| first).collect();
        assert_eq!(kept, [1000]);
    }

    #[test]
    fn damage_is_detected_and_named() {
        let folder = tempfile::tempdir().unwrap();
        let mut replay = buffer(10);
        push(&mut replay, 0..3);
        Log::default().append(&replay, folder.path()).unwrap();
        let path = segment_path(folder.path(), 0);
        let good = fs::read(&path).unwrap();
        let load = || match Log::default().load(&mut buffer(10), 3, folder.path()) {
            Err(AgentError::Log { path: named, source }) if named == path => source,
            other => panic!("{other:?}"),
        };
        let refusal = |bytes: &[u8]| {
            fs::write(&path, bytes).unwrap();
            load().to_string()
        };
        let mut altered = good.clone();
        *altered.last_mut().unwrap() ^= 1;
        assert!(refusal(&altered).contains("checksum of episode 2"));
        assert!(refusal(&good[..good.len() - 1]).contains("cut off before the end of episode 2"));
        assert!(refusal(b"GBRL").contains("shorter than its header"));
        let mut version = good.clone();
        version[4] = 9;
        assert!(refusal(&version).contains("this version"));
        fs::remove_file(&path).unwrap();
        assert!(matches!(load(), LogProblem::Io(error) if error.kind() == std::io::ErrorKind::NotFound));
    }

    #[test]
    fn a_new_run_begins_the_log_anew() {
        let folder = tempfile::tempdir().unwrap();
        let (mut old, mut new) = (buffer(10), buffer(10));
        push(&mut old, 0..7);
        Log::default().append(&old, folder.path()).unwrap();
        push(&mut new, 50..52);
        Log::default().append(&new, folder.path()).unwrap();
        let mut loaded = buffer(10);
        Log::default().load(&mut loaded, 2, folder.path()).unwrap();
        assert_same(&loaded, &new);
    }
}
