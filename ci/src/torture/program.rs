//! The program under torture: the commands that it is given.

use std::{
    ffi::OsStr,
    fs,
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

use super::victim::Victim;
use crate::error::{Error, Result, doing};

/// The seeds of an experiment; each of two machines has one of them.
pub(crate) const SEEDS: &str = "0,1";

/// A small experiment with much to remember: two environments, a teacher with networks of its own, a
/// checkpoint after every second episode or so.
const SWEEP: &[&str] = &[
    "--env",
    "Point,MazeA",
    "--curriculum",
    "teach,vds",
    "--steps",
    "2000",
    "--tensorboard",
    "--set",
    "evaluation.every=100",
    "--set",
    "evaluation.episodes=2",
    "--set",
    "student.batch=16",
    "--set",
    "student.width=8",
    "--set",
    "student.updates_per_cycle=4",
    "--set",
    "pool.size=20",
];

/// goalbench, and where what it says on standard error goes.
pub(crate) struct Program {
    path: PathBuf,
    said: PathBuf,
}

impl Program {
    pub(crate) fn new(path: PathBuf, said: PathBuf) -> Self {
        Self { path, said }
    }

    fn command(&self, words: &[&OsStr]) -> Command {
        let mut command = Command::new(&self.path);
        command.args(words).stdin(Stdio::null()).stdout(Stdio::null());
        command
    }

    /// The sweep with `seeds` into the folder `out`.
    pub(crate) fn sweep(&self, out: &Path, seeds: &str) -> Command {
        let mut command = self.command(&["run".as_ref(), "--out".as_ref(), out.as_os_str()]);
        command.args(SWEEP).args(["--seeds", seeds]);
        command
    }

    /// The merge of `sources` into the new folder `out`.
    pub(crate) fn merge(&self, sources: &[PathBuf], out: &Path) -> Command {
        let mut command = self.command(&["merge".as_ref(), "--out".as_ref(), out.as_os_str()]);
        command.args(sources);
        command
    }

    /// Starts `command`.
    pub(crate) fn start(&self, mut command: Command) -> Result<Victim> {
        let said = fs::File::create(&self.said).map_err(doing("write", &self.said))?;
        let child = command.stderr(said).spawn();
        Ok(Victim::new(
            child.map_err(|source| Error::Start { command: self.path.display().to_string(), source })?,
        ))
    }

    /// Carries out `command`, which must succeed.
    pub(crate) fn finish(&self, command: Command) -> Result<()> {
        let what = described(&command);
        match self.start(command)?.end()? {
            Some(status) if status.success() => Ok(()),
            Some(status) => Err(self.complaint(&what, &status.to_string())),
            None => Err(self.complaint(&what, "does not end")),
        }
    }

    /// What the trained students of the results in `folder` do in some episodes, as goalbench tells it, by
    /// run.
    pub(crate) fn behaviour(&self, folder: &Path) -> Result<Vec<serde_json::Value>> {
        let words: [&OsStr; 5] = [
            "evaluate".as_ref(),
            folder.as_os_str(),
            "--episodes".as_ref(),
            "10".as_ref(),
            "--json".as_ref(),
        ];
        let mut command = self.command(&words);
        let what = described(&command);
        let output = command
            .stdout(Stdio::piped())
            .output()
            .map_err(|source| Error::Start { command: self.path.display().to_string(), source })?;
        let no_json = |_| self.complaint(&what, "prints what is no JSON");
        if !output.status.success() {
            let said = String::from_utf8_lossy(&output.stderr).trim().to_owned();
            return Err(Error::Torture { command: what, ended: output.status.to_string(), said });
        }
        let lines = output.stdout.split(|&byte| byte == b'\n').filter(|line| !line.is_empty());
        lines
            .map(|line| {
                let mut run: serde_json::Value = serde_json::from_slice(line).map_err(no_json)?;
                run.as_object_mut().and_then(|run| run.remove("folder"));
                Ok(run)
            })
            .collect()
    }

    /// The error that `what`, which should have gone well, `ended` so; with what was said last.
    pub(crate) fn complaint(&self, what: &str, ended: &str) -> Error {
        let said = fs::read(&self.said).unwrap_or_default();
        let said = String::from_utf8_lossy(&said);
        let lines: Vec<&str> = said.lines().collect();
        let last = lines[lines.len().saturating_sub(5)..].join("\n  ");
        Error::Torture { command: what.to_owned(), ended: ended.to_owned(), said: last }
    }
}

/// A command as one would type it.
pub(crate) fn described(command: &Command) -> String {
    let words: Vec<_> = command.get_args().map(|word| word.to_string_lossy()).collect();
    format!("goalbench {}", words.join(" "))
}
