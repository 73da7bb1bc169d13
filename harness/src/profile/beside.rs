//! Runs side by side: how much of a single run's speed each keeps.

use std::fmt::Write as _;
use std::process::{Command, Stdio};

use serde_json::{Value, json};

use crate::error::HarnessError;

/// Training steps per second of profiled processes, alone and beside each other, a number per round.
#[derive(Clone, Debug, PartialEq)]
pub struct Beside {
    /// Processes at once.
    pub runs: u16,
    /// Of one process alone.
    pub alone: Vec<f64>,
    /// Of all at once, added up.
    pub together: Vec<f64>,
}

impl Beside {
    /// Speed of all together over that of one alone, round by round. The two of a round are measured one
    /// right after the other, so that other work on the machine slows both alike.
    fn gains(&self) -> Vec<f64> {
        self.together.iter().zip(&self.alone).map(|(together, alone)| together / alone).collect()
    }

    /// The median of the rounds' gains, which a single disturbed round does not spoil.
    pub fn gain(&self) -> f64 {
        reports::stats::median(&self.gains()).expect("at least one round")
    }

    /// All numbers.
    pub fn as_json(&self) -> Value {
        json!({
            "runs": self.runs,
            "alone_steps_per_second": self.alone,
            "together_steps_per_second": self.together,
            "gain": self.gain(),
        })
    }

    /// A line per round for people.
    pub fn as_text(&self) -> String {
        let mut text = String::from("training steps/s    alone  together   gain\n");
        let speeds = self.alone.iter().zip(&self.together).zip(self.gains());
        for (round, ((alone, together), gain)) in speeds.enumerate() {
            let _ = writeln!(text, "round {:<12} {alone:>7.1} {together:>9.1} {gain:>6.2}", round + 1);
        }
        let _ = writeln!(
            text,
            "\n{} runs side by side are {:.3} times as fast as one (median of the rounds)",
            self.runs,
            self.gain()
        );
        text
    }
}

/// Starts this program with `arguments`, which must make it print a profile as JSON: alone, then `runs` times
/// at once, and so on for `rounds` rounds.
///
/// # Errors
/// [`HarnessError::Io`] if a process cannot be started, [`HarnessError::NoProfile`] if one fails.
pub fn beside(arguments: &[String], runs: u16, rounds: u16) -> Result<Beside, HarnessError> {
    let mut found = Beside { runs, alone: Vec::new(), together: Vec::new() };
    for _ in 0..rounds {
        found.alone.push(at_once(arguments, 1)?);
        found.together.push(at_once(arguments, runs)?);
    }
    Ok(found)
}

/// The sum of the speeds of `runs` processes.
fn at_once(arguments: &[String], runs: u16) -> Result<f64, HarnessError> {
    let program = std::env::current_exe().map_err(HarnessError::system("find this program"))?;
    let start = |_| {
        let mut command = Command::new(&program);
        command.args(arguments).stdout(Stdio::piped()).spawn()
    };
    let started: Vec<_> = (0..runs).map(start).collect();
    // Wait for all of them even if one fails.
    let ended: Vec<_> = started.into_iter().map(|child| child?.wait_with_output()).collect();
    let mut sum = 0.0;
    for output in ended {
        let output = output.map_err(HarnessError::io(&program, "run this program"))?;
        let speed = serde_json::from_slice::<Value>(&output.stdout)
            .ok()
            .and_then(|profile| profile["steps_per_second"].as_f64());
        sum += speed.ok_or_else(|| HarnessError::NoProfile {
            arguments: arguments.join(" "),
            status: output.status,
        })?;
    }
    Ok(sum)
}

#[cfg(test)]
mod tests {
    use super::Beside;

    #[test]
    fn the_gain_is_the_median_of_the_rounds() {
        let mut found =
            Beside { runs: 2, alone: vec![80.0, 100.0, 50.0], together: vec![160.0, 120.0, 95.0] };
        assert_eq!(found.gain(), 1.9, "of 2, 1.2 and 1.9");
        assert!(found.as_text().contains("1.900 times"));
        found.alone.pop();
        assert_eq!(found.gain(), 1.6, "of 2 and 1.2");
    }
}
