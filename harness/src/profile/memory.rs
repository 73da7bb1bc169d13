//! Memory of this process, now and once the replay buffer is full.

use std::fs;
use std::io::{Error, ErrorKind};

use agents::{Replay, StudentConfig};
use envs::Spec;

use super::costs::Memory;
use crate::error::HarnessError;

/// Where Linux tells a process about itself.
const STATUS: &str = "/proc/self/status";

/// The memory of this process, whose student has taken in `episodes` episodes.
///
/// # Errors
/// [`HarnessError::Io`] if the system does not tell.
pub(super) fn measure(student: &StudentConfig, spec: &Spec, episodes: u64) -> Result<Memory, HarnessError> {
    let silent = || Error::new(ErrorKind::InvalidData, "it has no line `VmHWM: N kB`");
    let peak = fs::read_to_string(STATUS)
        .and_then(|status| peak(&status).ok_or_else(silent))
        .map_err(HarnessError::io(STATUS, "read the peak memory"))?;
    let replay = Replay::new(spec, student.replay_capacity).expect("the student has such a buffer");
    let full_replay = replay.capacity_bytes();
    let capacity = (student.replay_capacity / spec.horizon) as u64;
    let used = full_replay / capacity * episodes.min(capacity);
    Ok(Memory { peak, peak_with_full_replay: peak - used.min(peak) + full_replay, full_replay })
}

/// The most memory held so far, in bytes, from the text of `/proc/self/status`.
fn peak(status: &str) -> Option<u64> {
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(1024 * kilobytes)
}

#[cfg(test)]
mod tests {
    use agents::StudentConfig;

    use super::{measure, peak};

    #[test]
    fn the_peak_is_read_in_bytes() {
        assert_eq!(peak("Name:\tgoalbench\nVmHWM:\t  150 kB\nVmRSS:\t 90 kB\n"), Some(153_600));
        assert_eq!(peak("VmRSS:\t 90 kB\n"), None);
    }

    /// 1,000,000 transitions of FetchPush are 20,000 episodes of 6,540 bytes.
    #[test]
    fn a_full_buffer_is_added_to_what_is_held() {
        let spec = &envs::find("FetchPush").expect("a built-in environment").spec;
        let memory = measure(&StudentConfig::default(), spec, 100).expect("Linux");
        assert_eq!(memory.full_replay, 20_000 * 6_540);
        assert_eq!(memory.peak_with_full_replay, memory.peak + 19_900 * 6_540);
    }
}
