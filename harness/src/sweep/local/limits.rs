//! How many files this process may have open, which workers side by side need.

use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};

use crate::error::HarnessError;

/// Files that a sweep has open besides those of its workers, with room to spare.
const OWN: u64 = 25;
/// Files that one worker takes while it is started: its three streams on both sides, and the system's own.
const PER_WORKER: u64 = 7;

/// Makes room for `parallel` workers side by side, and refuses them where the system does not let it.
///
/// # Errors
/// [`HarnessError::System`] saying how many there is room for.
pub fn make_room(parallel: usize) -> Result<(), HarnessError> {
    let limit = getrlimit(Resource::Nofile);
    let needed = needed(parallel);
    if limit.current.is_none_or(|current| current >= needed) {
        return Ok(());
    }
    if limit.maximum.is_none_or(|most| most >= needed) {
        let raised = Rlimit { current: Some(needed), ..limit };
        return setrlimit(Resource::Nofile, raised)
            .map_err(|error| HarnessError::system("open more files at once")(std::io::Error::from(error)));
    }
    Err(HarnessError::system("start the workers")(refusal(parallel, limit.maximum.unwrap_or(u64::MAX))))
}

/// Files that `parallel` workers side by side need.
fn needed(parallel: usize) -> u64 {
    OWN + PER_WORKER * parallel as u64
}

fn refusal(parallel: usize, most: u64) -> String {
    let room = most.saturating_sub(OWN) / PER_WORKER;
    let advice = match room {
        0 => format!("raise it to {} or more", needed(parallel)),
        _ => format!("raise it to {} or more, or give --jobs {room}", needed(parallel)),
    };
    format!("this process may have {most} files open (ulimit -n); {advice}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_there_is_room_for_is_told() {
        let text = refusal(1, 10);
        assert_eq!(text, "this process may have 10 files open (ulimit -n); raise it to 32 or more");
        let text = refusal(1000, 1024);
        assert_eq!(
            text,
            "this process may have 1024 files open (ulimit -n); raise it to 7025 or more, or give --jobs 142"
        );
        assert!(needed(142) <= 1024 && needed(143) > 1024);
    }
}
