//! Trying a property on many inputs, with a bound on time and memory.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::sync::{Mutex, Once};
use std::time::{Duration, Instant};

use proptest::strategy::Strategy;
use proptest::test_runner::{Config, FileFailurePersistence, TestRunner};

/// The longest time for one input, on a busy machine.
const PATIENCE: Duration = Duration::from_secs(120);
/// The most memory that this process may hold at any time, in KiB: twice what its libraries and the largest
/// valid input take.
const MEMORY: u64 = 1 << 20;

/// The inputs that are being tried, by target, since when.
static TRIED: Mutex<BTreeMap<&str, Instant>> = Mutex::new(BTreeMap::new());
static WATCH: Once = Once::new();

/// Checks `property` on `per_256` of 256 inputs, or as many as `PROPTEST_CASES` makes of them.
pub(crate) fn fuzz<S: Strategy>(target: &'static str, per_256: u32, inputs: &S, property: impl Fn(S::Value)) {
    WATCH.call_once(|| drop(std::thread::spawn(watch)));
    let failures = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/fuzz/failures");
    // Kept for as long as the process lives, as the library wants it.
    let file: &'static str = Box::leak(format!("{failures}/{target}.txt").into_boxed_str());
    let default = Config::default();
    let config = Config {
        cases: default.cases.saturating_mul(per_256).div_ceil(256),
        max_shrink_time: 60_000,
        failure_persistence: Some(Box::new(FileFailurePersistence::Direct(file))),
        ..default
    };
    let tried = TestRunner::new(config).run(inputs, |input| {
        let begun = |since: Option<Instant>| {
            let mut tried = TRIED.lock().expect("no holder of this lock panics");
            match since {
                Some(since) => drop(tried.insert(target, since)),
                None => drop(tried.remove(target)),
            }
        };
        begun(Some(Instant::now()));
        property(input);
        begun(None);
        Ok(())
    });
    tried.unwrap_or_else(|failure| panic!("{target}: {failure}"));
    let peak = peak();
    assert!(peak < MEMORY, "{target}: {} MiB were in use", peak >> 10);
}

/// Ends the process, with the target's name, if an input takes too long: a test cannot be stopped from
/// outside.
fn watch() {
    loop {
        std::thread::sleep(Duration::from_secs(1));
        let tried = TRIED.lock().expect("no holder of this lock panics").clone();
        for (target, since) in tried {
            if since.elapsed() > PATIENCE {
                use std::io::Write;
                drop(writeln!(std::io::stderr(), "{target}: an input takes more than {PATIENCE:?}"));
                std::process::abort();
            }
        }
    }
}

/// The most memory that this process has held, in KiB.
fn peak() -> u64 {
    let status = fs::read_to_string("/proc/self/status").expect("Linux tells");
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).expect("the peak");
    line.trim().trim_end_matches(" kB").parse().expect("a number")
}

/// Checks that an error says which file it is about.
pub(crate) fn assert_names(error: &dyn std::error::Error, path: &Path) {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        text = format!("{text}: {error}");
        cause = error.source();
    }
    let name = path.file_name().expect("a file").to_string_lossy();
    assert!(text.contains(name.as_ref()), "{name} is not named in: {text}");
}
