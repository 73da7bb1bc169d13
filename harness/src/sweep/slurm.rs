//! Runs as a Slurm job array: one array task per chunk of runs, or of cohorts of runs in lockstep.
//!
//! It submits a list of run folders (`RESULTS/slurm/N/tasks.json`) and a script that starts `goalbench task
//! LIST INDEX`. A task carries out its runs one after the other in worker processes, as `goalbench run` does.
//! On SIGTERM (preemption, time limit, scancel) workers save a checkpoint; a requeued or resubmitted task
//! goes on from it.

use std::borrow::Cow;
use std::fs;
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::DirBuilderExt;
use std::path::{Path, PathBuf};
use std::process::Command;

use guard::files;
use reports::schema::Manifest;
use serde::{Deserialize, Serialize};

use super::cohort::cohorts;
use super::job::Job;
use super::local::Conduct;
use crate::error::{Cause, HarnessError};
use crate::files::write_json;
use crate::run::folder::{self, State, read_json};
use crate::run::manifest::versions;

/// What a user says about the job array.
#[derive(Clone, Debug, Default)]
pub struct Request {
    /// Name shown by `squeue`.
    pub name: String,
    /// Partition; Slurm's default if none.
    pub partition: Option<String>,
    /// Time limit of a task, in Slurm's form.
    pub time: Option<String>,
    /// Memory of a task, in Slurm's form.
    pub memory: Option<String>,
    /// Most tasks at once.
    pub at_once: Option<u32>,
    /// Cohorts per task, one after the other.
    pub chunk: usize,
    /// Runs in a cohort, at most.
    pub lanes: usize,
    /// Whether the two halves of a cohort take turns between cores and device.
    pub overlap: bool,
    /// Whether tasks need a GPU.
    pub gpu: bool,
    /// How often a run whose worker crashed is begun again from its checkpoint.
    pub retries: u32,
    /// Whether each run keeps a TensorBoard event file.
    pub tensorboard: bool,
    /// Whether each run's replay buffer is removed when it finishes.
    pub discard_replay: bool,
    /// Further options of `sbatch`, a word each.
    pub extra: Vec<String>,
}

/// The program that takes job arrays.
const SBATCH: &str = "sbatch";

/// Seconds before the time limit at which Slurm sends SIGTERM: enough to end a cycle and save.
const WARNING_S: u32 = 120;

/// Most processors that a task asks for unless `--sbatch` says otherwise: nodes with more are rare.
const MOST_CPUS: usize = 16;

/// The folder of submissions in a results folder.
pub(super) const FOLDER: &str = "slurm";

/// Name of the file that holds a submission's job id.
const JOB: &str = "job";

/// The runs of a job array, by task. Folders are relative to the results folder.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Tasks {
    results: PathBuf,
    retries: u32,
    tensorboard: bool,
    #[serde(default)]
    discard_replay: bool,
    /// Runs in lockstep, at most.
    #[serde(default = "alone")]
    lanes: usize,
    #[serde(default)]
    overlap: bool,
    tasks: Vec<Vec<PathBuf>>,
}

fn alone() -> usize {
    1
}

/// A submitted job array.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Submitted {
    /// Slurm's id of the job.
    pub job: String,
    /// Its tasks.
    pub tasks: usize,
}

/// Refuses what no job array can be made of, before anything is written: a machine without `sbatch`, or a
/// results folder that no script can name.
///
/// # Errors
/// [`HarnessError::Slurm`] or [`HarnessError::Script`].
pub fn check(results: &Path) -> Result<(), HarnessError> {
    let results = std::path::absolute(results).map_err(HarnessError::io(results, "find this folder"))?;
    script_text(&this_program()?, &results)?;
    let path = std::env::var_os("PATH").unwrap_or_default();
    if !std::env::split_paths(&path).any(|folder| folder.join(SBATCH).is_file()) {
        let reason = "there is no such program on this machine's PATH; is this a node of a Slurm cluster?";
        return Err(HarnessError::Slurm { reason: reason.to_owned() });
    }
    Ok(())
}

fn this_program() -> Result<PathBuf, HarnessError> {
    std::env::current_exe()
        .map_err(HarnessError::system("find this program (goalbench needs /proc to be mounted)"))
}

/// Submits all `jobs` that have not ended; `None` if there are none.
///
/// # Errors
/// [`HarnessError`] if folders cannot be written or `sbatch` refuses.
pub(super) fn submit(
    jobs: &[Job],
    results: &Path,
    request: &Request,
) -> Result<Option<Submitted>, HarnessError> {
    let open: Vec<&Job> = jobs.iter().filter(|job| job.is_open()).collect();
    if open.is_empty() {
        return Ok(None);
    }
    let results = fs::canonicalize(results).map_err(HarnessError::io(results, "find this folder"))?;
    for job in open.iter().filter(|job| job.state == State::New) {
        folder::create(&job.folder, &job.manifest)?;
    }
    check_queue(&results)?;
    let folder = new_submission(&results)?;
    let relative = |job: &Job| reports::store::layout::run_dir(Path::new(""), job.run());
    let cohorts: Vec<Vec<usize>> =
        cohorts(jobs, request.lanes).into_iter().filter(|cohort| jobs[cohort[0]].is_open()).collect();
    let tasks = cohorts
        .chunks(request.chunk.max(1))
        .map(|chunk| chunk.iter().flatten().map(|&index| relative(&jobs[index])).collect());
    let Request { retries, tensorboard, discard_replay, lanes, overlap, .. } = *request;
    let tasks = tasks.collect();
    let tasks = Tasks { results, retries, tensorboard, discard_replay, lanes, overlap, tasks };
    let list = folder.join("tasks.json");
    write_json(&list, &tasks).map_err(HarnessError::io(&list, "write this file"))?;
    let script = folder.join("task.sh");
    let text = script_text(&this_program()?, &list)?;
    guard::fresh::write(&script, text.as_bytes()).map_err(HarnessError::io(&script, "write this file"))?;
    let count = tasks.tasks.len();
    let job = match sbatch(&script, &folder, count, request) {
        Ok(job) => job,
        Err(error) => {
            // Nothing was submitted, so leave no trace of a submission. A folder that cannot be removed does
            // no harm.
            let _ = fs::remove_dir_all(&folder);
            return Err(error);
        }
    };
    let path = folder.join(JOB);
    guard::fresh::write(&path, job.as_bytes()).map_err(HarnessError::io(&path, "write this file"))?;
    Ok(Some(Submitted { job, tasks: count }))
}

/// Refuses to submit runs a second time while an earlier submission is still in the queue.
pub(super) fn check_queue(results: &Path) -> Result<(), HarnessError> {
    let parent = results.join(FOLDER);
    let folders = files::entries(&parent).map_err(HarnessError::io(&parent, "read this folder"))?;
    for path in folders.into_iter().flatten().map(|folder| folder.join(JOB)) {
        let id = match files::read_to_string(&path) {
            Ok(id) => id,
            // A submission that was interrupted.
            Err(error) if files::is_absent(&error) => continue,
            Err(error) => return Err(HarnessError::io(path, "read this file")(error)),
        };
        let queue = Command::new("squeue").arg("--noheader").arg(format!("--jobs={}", id.trim())).output();
        // Slurm forgets old jobs; one that it does not know is not in the queue.
        let waiting =
            queue.is_ok_and(|queue| queue.status.success() && !queue.stdout.trim_ascii().is_empty());
        if waiting {
            return Err(HarnessError::Queued { job: id.trim().to_owned() });
        }
    }
    Ok(())
}

/// The next free `RESULTS/slurm/N`.
fn new_submission(results: &Path) -> Result<PathBuf, HarnessError> {
    let parent = results.join(FOLDER);
    fs::create_dir_all(&parent).map_err(HarnessError::io(&parent, "create this folder"))?;
    for number in 1.. {
        let folder = parent.join(number.to_string());
        match fs::DirBuilder::new().mode(0o777).create(&folder) {
            Ok(()) => return Ok(folder),
            // What a submission that was killed has left half-written there.
            Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => guard::fresh::sweep(&folder),
            Err(source) => {
                return Err(HarnessError::Io { path: folder, action: "create this folder", source });
            }
        }
    }
    unreachable!("there is always a next number")
}

/// The script of every task: it replaces itself by the task, so that Slurm's signals reach it.
fn script_text(program: &Path, list: &Path) -> Result<String, HarnessError> {
    let line = |program, list| format!("exec {program} task -- {list} \"$SLURM_ARRAY_TASK_ID\"");
    Ok(format!("#!/bin/bash\n{}\n", line(quoted(program)?, quoted(list)?)))
}

/// `path` as a word of a shell.
fn quoted(path: &Path) -> Result<Cow<'_, str>, HarnessError> {
    let unfit = |source: Cause| HarnessError::Script { path: path.to_owned(), source };
    let text = str::from_utf8(path.as_os_str().as_bytes()).map_err(|error| unfit(error.into()))?;
    shlex::try_quote(text).map_err(|error| unfit(error.into()))
}

fn sbatch(script: &Path, folder: &Path, tasks: usize, request: &Request) -> Result<String, HarnessError> {
    // `%` begins a pattern in Slurm's file names.
    let log = format!("{}/%a.log", folder.display().to_string().replace('%', "%%"));
    let limit = request.at_once.map_or(String::new(), |most| format!("%{most}"));
    let mut command = Command::new(SBATCH);
    command.arg("--parsable").arg(format!("--array=0-{}{limit}", tasks - 1));
    command
        .arg(format!("--job-name={}", request.name))
        .arg(format!("--output={log}"))
        .arg("--open-mode=append");
    command
        .arg("--requeue")
        .arg(format!("--signal=B:TERM@{WARNING_S}"))
        .arg("--ntasks=1")
        .arg(format!("--cpus-per-task={}", request.lanes.clamp(1, MOST_CPUS)));
    if request.gpu {
        command.arg("--gres=gpu:1");
    }
    for (option, value) in
        [("partition", &request.partition), ("time", &request.time), ("mem", &request.memory)]
    {
        if let Some(value) = value {
            command.arg(format!("--{option}={value}"));
        }
    }
    command.args(&request.extra);
    let output = command.arg(script).output().map_err(HarnessError::io(SBATCH, "start it"))?;
    let said = |bytes: &[u8]| String::from_utf8_lossy(bytes).trim().to_owned();
    if !output.status.success() {
        return Err(HarnessError::Slurm { reason: said(&output.stderr) });
    }
    // `--parsable` prints `id` or `id;cluster`, after what a site's own plugins may say.
    let printed = said(&output.stdout);
    let last = printed.lines().next_back().unwrap_or_default();
    let id = last.split(';').next().unwrap_or_default().trim();
    if id.is_empty() || !id.bytes().all(|byte| byte.is_ascii_digit()) {
        let reason = format!(
            "printed `{printed}` where the id of a job was expected, so nothing counts as submitted; `squeue` tells \
             whether a job is waiting all the same"
        );
        return Err(HarnessError::Slurm { reason });
    }
    Ok(id.to_owned())
}

/// The share of one task of a job array.
pub(super) struct Share {
    pub(super) results: PathBuf,
    pub(super) jobs: Vec<Job>,
    /// One after the other.
    pub(super) conduct: Conduct,
}

/// The share of the task `index` of the list at `list`.
///
/// # Errors
/// [`HarnessError`] if the list or a run's folder is not what was submitted.
pub(super) fn share(list: &Path, index: usize) -> Result<Share, HarnessError> {
    let missing = |reason: String| HarnessError::Missing { path: list.to_owned(), reason };
    let Tasks { results, retries, tensorboard, discard_replay, lanes, overlap, tasks } =
        read_json(list)?.ok_or_else(|| missing("there is no such file".into()))?;
    let count = tasks.len();
    let folders =
        tasks.get(index).ok_or_else(|| missing(format!("there is no task {index}, only {count}")))?;
    let jobs = folders.iter().map(|folder| job(&results.join(folder))).collect::<Result<_, _>>()?;
    // Slurm confines a task to the processors that it was given.
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let shared = Conduct::share(cores.min(lanes), lanes);
    let conduct = Conduct { retries, tensorboard, discard_replay, overlap, ..shared };
    Ok(Share { results, jobs, conduct })
}

/// The run that `folder` was prepared for.
fn job(folder: &Path) -> Result<Job, HarnessError> {
    let (manifest, config) = folder::read_manifest(folder)?;
    let state = folder::inspect(folder, &manifest)?;
    // Submitted by another version of the program, and not begun: it becomes a run of this one.
    let is_new = state == State::New;
    let manifest = if is_new { Manifest { versions: versions(), ..manifest } } else { manifest };
    Ok(Job { manifest, config, folder: folder.to_owned(), state })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_path_is_quoted() {
        let text =
            script_text(Path::new("/a b/goalbench"), Path::new("/it's $HOME/`x`/tasks.json")).expect("UTF-8");
        let line = text.lines().nth(1).expect("two lines");
        let words = shlex::split(line).expect("quotes match");
        assert_eq!(words[..5], ["exec", "/a b/goalbench", "task", "--", "/it's $HOME/`x`/tasks.json"]);
    }
}
