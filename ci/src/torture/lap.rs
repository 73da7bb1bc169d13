//! One experiment from its beginning to its comparison, under kills.

use std::{
    fs,
    path::{Path, PathBuf},
    thread,
    time::Duration,
};

use super::{
    Limit, compare,
    moments::Moments,
    program::{Program, SEEDS, described},
    strike::{ROUNDS, Strike},
    tally::Tally,
    victim::is_left_alone,
};
use crate::error::{Result, doing};

/// Fewest and most rounds that the two machines have before they are merged.
const APART: std::ops::Range<u64> = 4..10;
/// Merges that are killed before one may end.
const MERGES: u32 = 4;
/// The longest life of a merge that is killed, in milliseconds.
const MERGE: u64 = 120;

/// A lap in a folder of its own.
pub(crate) struct Lap<'a> {
    program: &'a Program,
    home: PathBuf,
    limit: Limit,
}

impl<'a> Lap<'a> {
    pub(crate) fn new(program: &'a Program, home: PathBuf, limit: Limit) -> Result<Self> {
        fs::create_dir(&home).map_err(doing("create", &home))?;
        Ok(Self { program, home, limit })
    }

    /// The whole lap; returns what differs from the folder `expected`. If nothing does, its files are
    /// removed.
    pub(crate) fn carry_out(
        self,
        moments: &mut Moments,
        tally: &mut Tally,
        expected: &Path,
    ) -> Result<Vec<String>> {
        let machines: Vec<PathBuf> =
            SEEDS.split(',').map(|seed| self.home.join(format!("seed-{seed}"))).collect();
        let merged = self.home.join("merged");
        let rounds = APART.start + moments.below(APART.end - APART.start);
        let mut round = 0;
        while round < rounds || !machines.iter().all(|machine| has_begun(machine)) {
            for (machine, seed) in machines.iter().zip(SEEDS.split(',')) {
                self.round(machine, seed, moments, tally)?;
                round += 1;
            }
        }
        self.settle()?;
        self.merge(&machines, &merged, moments, tally)?;
        let mut done = false;
        while !done && !self.limit.is_reached(tally) {
            done = self.round(&merged, SEEDS, moments, tally)?;
        }
        self.settle()?;
        self.program.finish(self.program.sweep(&merged, SEEDS))?;

        let mut faults = compare::differences(&merged, expected)?;
        if self.program.behaviour(&merged)? != self.program.behaviour(expected)? {
            faults.push("trained students behave differently (goalbench evaluate)".to_owned());
        }
        faults.extend(self.beside(&machines, &merged)?);
        if faults.is_empty() {
            fs::remove_dir_all(&self.home).map_err(doing("remove", &self.home))?;
        }
        Ok(faults)
    }

    /// Begins the sweep of `seeds` in `folder` and strikes it until it ends; true if it ended by itself, all
    /// runs done.
    fn round(&self, folder: &Path, seeds: &str, moments: &mut Moments, tally: &mut Tally) -> Result<bool> {
        let command = self.program.sweep(folder, seeds);
        let what = described(&command);
        let mut victim = self.program.start(command)?;
        for &strike in moments.one_of(&ROUNDS).unwrap_or_default() {
            moments.wait(&mut victim, folder)?;
            if let Some(status) = victim.ended()? {
                return if status.success() {
                    Ok(true)
                } else {
                    Err(self.program.complaint(&what, &status.to_string()))
                };
            }
            if strike.carry_out(&victim, moments) {
                tally.count(strike);
            }
            if strike.is_survived() {
                continue;
            }
            match victim.end()? {
                Some(status) if strike.explains(status) => {}
                Some(status) => {
                    return Err(self.program.complaint(&what, &format!("{status} after {strike:?}")));
                }
                None => return Err(self.program.complaint(&what, &format!("does not end after {strike:?}"))),
            }
        }
        // Often the sweep is begun again while the old workers still save.
        if moments.below(2) == 0 {
            self.settle()?;
        }
        Ok(false)
    }

    /// Waits for workers that outlive their sweep.
    fn settle(&self) -> Result<()> {
        if is_left_alone(&self.home) {
            return Ok(());
        }
        Err(self.program.complaint("goalbench worker", "does not end without its parent"))
    }

    /// Merges the machines' results; some merges are killed first.
    fn merge(
        &self,
        machines: &[PathBuf],
        merged: &Path,
        moments: &mut Moments,
        tally: &mut Tally,
    ) -> Result<()> {
        for _ in 0..MERGES {
            let mut victim = self.program.start(self.program.merge(machines, merged))?;
            thread::sleep(Duration::from_millis(moments.below(MERGE)));
            if victim.ended()?.is_none() {
                tally.count(Strike::Merge);
                Strike::Merge.carry_out(&victim, moments);
            }
            victim.end()?;
            // It was done before the kill.
            if merged.exists() {
                fs::remove_dir_all(merged).map_err(doing("remove", merged))?;
            }
        }
        self.program.finish(self.program.merge(machines, merged))
    }

    /// What lies beside the results folders: nothing should.
    fn beside(&self, machines: &[PathBuf], merged: &Path) -> Result<Vec<String>> {
        let entries = fs::read_dir(&self.home).map_err(doing("read", &self.home))?;
        let paths = entries.filter_map(|entry| Some(entry.ok()?.path()));
        let strange = paths.filter(|path| path != merged && !machines.contains(path));
        Ok(strange.map(|path| format!("{}: left behind", path.display())).collect())
    }
}

/// Whether there is a run to merge.
fn has_begun(machine: &Path) -> bool {
    compare::run_folders(machine).iter().any(|run| run.join("manifest.json").exists())
}
