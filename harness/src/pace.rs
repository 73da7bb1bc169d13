//! How fast runs are and how long they still take, by one rule wherever it is shown.

use std::time::Duration;

use reports::schema::Timing;
use reports::store::RunFolder;

/// Training steps per second of the run in `folder` as of its last evaluation: all of its steps by all of its
/// time, evaluations included, however often it was interrupted. `None` before its first steps are recorded.
pub(crate) fn recorded(folder: &RunFolder) -> Option<f64> {
    folder.last().and_then(|Timing { step, wall_s, .. }| steps_per_s(step, wall_s))
}

/// Training steps per second; `None` where nothing was done, or the time is none.
pub(crate) fn steps_per_s(steps: u64, seconds: f64) -> Option<f64> {
    let speed = steps as f64 / seconds;
    (speed.is_finite() && speed > 0.0).then_some(speed)
}

/// A speed in training steps per second: whole numbers from 10 on, one decimal below.
pub(crate) fn rounded(steps_per_s: f64) -> String {
    if steps_per_s < 9.95 { format!("{steps_per_s:.1}") } else { format!("{steps_per_s:.0}") }
}

/// `STEP/STEPS`: how far a run is. It trains in whole cycles, so its last one may take it past its budget;
/// what it took is then what there was to take.
pub(crate) fn of_steps(step: u64, budget: u64) -> String {
    format!("{step}/{}", budget.max(step))
}

/// Longest time that is written down.
const LONGEST: Duration = Duration::from_secs(100 * 365 * 24 * 3600);

/// Seconds as a duration; what is negative, not a number or beyond a century is cut off there.
pub(crate) fn seconds(seconds: f64) -> Duration {
    Duration::try_from_secs_f64(seconds.max(0.0)).map_or(LONGEST, |time| time.min(LONGEST))
}

/// `2d 03h`, `1h 05m`, `3m 20s`, `7s`.
pub(crate) fn human(duration: Duration) -> String {
    let seconds = duration.as_secs();
    match (seconds / 86_400, seconds / 3600 % 24, seconds / 60 % 60, seconds % 60) {
        (0, 0, 0, s) => format!("{s}s"),
        (0, 0, m, s) => format!("{m}m {s:02}s"),
        (0, h, m, _) => format!("{h}h {m:02}m"),
        (d, h, ..) => format!("{d}d {h:02}h"),
    }
}

/// What is left of `total` steps if they take as long as those `done` in `elapsed`; `None` before the first.
pub(crate) fn time_left(done: u64, total: u64, elapsed: Duration) -> Option<Duration> {
    (done > 0).then(|| seconds(elapsed.as_secs_f64() * total.saturating_sub(done) as f64 / done as f64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_read_naturally() {
        let human = |seconds| human(Duration::from_secs(seconds));
        assert_eq!([human(7), human(200), human(3900)], ["7s", "3m 20s", "1h 05m"]);
        assert_eq!([human(86_399), human(183_600)], ["23h 59m", "2d 03h"]);
        assert_eq!(time_left(250, 1000, Duration::from_secs(10)), Some(Duration::from_secs(30)));
        assert_eq!(time_left(0, 1000, Duration::from_secs(10)), None);
        assert_eq!(time_left(1, u64::MAX, Duration::MAX), Some(LONGEST));
        assert_eq!([seconds(f64::NAN), seconds(-1.0)], [Duration::ZERO; 2]);
    }

    #[test]
    fn speeds_are_rounded_and_a_budget_is_never_less_than_what_was_taken() {
        assert_eq!(
            [rounded(0.26), rounded(9.94), rounded(9.96), rounded(1234.56)],
            ["0.3", "9.9", "10", "1235"]
        );
        assert_eq!([of_steps(40, 400), of_steps(100, 10)], ["40/400", "100/100"]);
        assert_eq!(steps_per_s(300, 1.5), Some(200.0));
        assert_eq!([(0, 1.5), (300, 0.0), (0, 0.0)].map(|(steps, time)| steps_per_s(steps, time)), [None; 3]);
    }
}
