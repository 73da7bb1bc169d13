//! Kills sweeps and merges at random moments, again and again, and checks that nothing comes of it: what lies
//! in the results folder at the end equals, byte for byte, what a sweep leaves that was never disturbed.
//!
//! A lap is the life of one experiment. Two folders, as of two machines, share its seeds; their sweeps are
//! killed and begun again. They are merged, which is killed as well, and the merged folder goes on under
//! kills until all runs are done. Then it is compared.

mod compare;
mod lap;
mod moments;
mod program;
mod strike;
mod tally;
mod victim;

use std::{
    env, fs,
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use crate::{
    cargo::{self, Code},
    console::step,
    error::{Error, Result, doing},
};
use lap::Lap;
use moments::Moments;
use program::{Program, SEEDS};
use tally::Tally;

/// Kills where the options say nothing.
const KILLS: u32 = 20;

/// How long to go on, and with what.
#[derive(clap::Args)]
pub(crate) struct Options {
    /// Stop after this many kills [default: 20; with --minutes, any number].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    kills: Option<u32>,
    /// Stop after this many minutes.
    #[arg(long, value_name = "M", value_parser = clap::value_parser!(u32).range(1..))]
    minutes: Option<u32>,
    /// Seed of the moments and victims that chance chooses.
    #[arg(long, value_name = "S", default_value_t = 0)]
    seed: u64,
    /// The goalbench to kill [default: that of this project, built if need be].
    #[arg(long, value_name = "FILE")]
    program: Option<PathBuf>,
}

/// When enough was killed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limit {
    kills: Option<u32>,
    end: Option<Instant>,
}

impl Limit {
    fn of(options: &Options) -> Self {
        let end = options.minutes.map(|minutes| Instant::now() + Duration::from_secs(60) * minutes);
        let kills = if end.is_some() { options.kills } else { options.kills.or(Some(KILLS)) };
        Self { kills, end }
    }

    pub(crate) fn is_reached(&self, tally: &Tally) -> bool {
        self.kills.is_some_and(|kills| tally.kills() >= kills)
            || self.end.is_some_and(|end| Instant::now() >= end)
    }
}

/// Carries out laps until the limit is reached. The code is 0 if no lap found a difference, else 1; the
/// folders that differ are then kept.
pub(crate) fn torture(project: &Path, options: &Options) -> Result<Code> {
    let path = match &options.program {
        Some(path) => fs::canonicalize(path).map_err(doing("find", path))?,
        None => {
            let code = cargo::build(project)?;
            if code != 0 {
                return Ok(code);
            }
            let built = env::var_os("CARGO_TARGET_DIR").map_or_else(|| project.join("target"), PathBuf::from);
            built.join("release/goalbench")
        }
    };
    let begun = Instant::now();
    let home = tempfile::Builder::new()
        .prefix("goalbench-torture-")
        .tempdir()
        .map_err(doing("create a folder in", &env::temp_dir()))?;
    let program = Program::new(path, home.path().join("said"));
    step("torture", "a sweep that nobody disturbs, to compare with");
    let expected = home.path().join("undisturbed");
    program.finish(program.sweep(&expected, SEEDS))?;

    let limit = Limit::of(options);
    let mut moments = Moments::new(options.seed);
    let mut tally = Tally::default();
    let mut faults = Vec::new();
    while faults.is_empty() && !limit.is_reached(&tally) {
        let lap = Lap::new(&program, home.path().join(format!("lap-{}", tally.laps)), limit)?;
        match lap.carry_out(&mut moments, &mut tally, &expected) {
            Ok(found) => faults = found,
            // What a program says that should not have failed is the finding.
            Err(error @ Error::Torture { .. }) => faults.push(error.to_string()),
            Err(error) => return Err(error),
        }
        tally.laps += 1;
        step("torture", &tally.line(begun.elapsed()));
    }
    if faults.is_empty() {
        step("torture", "everything equals what the undisturbed sweep left");
        return Ok(0);
    }
    for fault in &faults {
        step("torture", &format!("FAULT: {fault}"));
    }
    step("torture", &format!("kept in {}; --seed {} was given", home.keep().display(), options.seed));
    Ok(1)
}

#[cfg(test)]
mod tests {
    use super::{Limit, Options, Tally};

    #[test]
    fn kills_have_a_default_unless_the_clock_decides() {
        let kills = |kills, minutes| Limit::of(&Options { kills, minutes, seed: 0, program: None }).kills;
        assert_eq!(kills(None, None), Some(super::KILLS));
        assert_eq!(kills(Some(100), None), Some(100));
        assert_eq!(kills(None, Some(1)), None);
        let limit = Limit { kills: Some(0), end: None };
        assert!(limit.is_reached(&Tally::default()));
    }
}
