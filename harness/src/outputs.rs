//! Places to write to, checked before work begins: hours of training must not end at a folder that is not
//! there.

use std::fs;
use std::path::{Path, PathBuf};

use reports::store::layout;

use crate::error::HarnessError;

/// Checks that the file that `option` names can be written: what stands there is a regular file or nothing,
/// its folder can be written in or made, and it is none of `inputs`. Leaves nothing behind.
///
/// # Errors
/// [`HarnessError::Argument`] or [`HarnessError::Flag`] naming the option and what is in the way.
pub fn file(option: &'static str, path: &Path, inputs: &[&Path]) -> Result<(), HarnessError> {
    check_inputs(option, path, inputs)?;
    match fs::metadata(path) {
        Ok(found) if found.is_dir() => return wrong(option, path, "is a folder; name a file"),
        Ok(found) if !found.is_file() => return wrong(option, path, "is no regular file; name one"),
        _ => {}
    }
    if path.as_os_str().as_encoded_bytes().ends_with(b"/") {
        return wrong(option, path, "is the name of a folder; name a file");
    }
    check_folder(option, folder_of(path))
}

/// Checks the same of a folder that is to be written in: it is one, or it can be made.
///
/// # Errors
/// [`HarnessError::Argument`] or [`HarnessError::Flag`] naming the option and what is in the way.
pub fn folder(option: &'static str, path: &Path, inputs: &[&Path]) -> Result<(), HarnessError> {
    check_inputs(option, path, inputs)?;
    check_folder(option, path)
}

/// Checks that the new folder that `option` names would lie in none of `inputs`, which are only read.
///
/// # Errors
/// [`HarnessError::Argument`] naming the option and that folder.
pub fn outside(option: &'static str, path: &Path, inputs: &[PathBuf]) -> Result<(), HarnessError> {
    let absolute = std::path::absolute(path).map_err(|error| unwritable(option, path, error))?;
    // What is not there yet lies in the nearest folder that is.
    let Some(there) = absolute.ancestors().find_map(|above| above.canonicalize().ok()) else { return Ok(()) };
    let around = inputs.iter().find(|input| input.canonicalize().is_ok_and(|input| there.starts_with(input)));
    around.map_or(Ok(()), |input| {
        let what = format!("lies in {}, which is only read; name a place outside", input.display());
        wrong(option, path, &what)
    })
}

/// The same of what is written beside reading the folder of a run: it would not lie among the runs of its
/// results.
///
/// # Errors
/// As [`outside`].
pub fn outside_runs(option: &'static str, path: &Path, run: &Path) -> Result<(), HarnessError> {
    let run = run.canonicalize().unwrap_or_else(|_| run.to_owned());
    let runs = run.ancestors().nth(layout::DEPTH).filter(|above| {
        layout::key_at(&run).is_some()
            && above.parent().is_some_and(|results| layout::runs_dir(results) == **above)
    });
    outside(option, path, &[runs.unwrap_or(&run).to_owned()])
}

/// The folder in which the file at `path` lies.
pub fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// `path`, written so that no program takes it for an option: `-x` becomes `./-x`.
pub fn unlike_an_option(path: PathBuf) -> PathBuf {
    let is_like = path.as_os_str().as_encoded_bytes().starts_with(b"-");
    if is_like { Path::new(".").join(path) } else { path }
}

fn wrong(option: &'static str, path: &Path, what: &str) -> Result<(), HarnessError> {
    Err(HarnessError::Argument { option, reason: format!("{} {what}", path.display()) })
}

fn check_inputs(option: &'static str, path: &Path, inputs: &[&Path]) -> Result<(), HarnessError> {
    if path.as_os_str().is_empty() {
        return Err(HarnessError::Argument { option, reason: "the path is empty".to_owned() });
    }
    if let Some(runs) = runs_around(path) {
        let what = format!(
            "lies in {}, which holds the runs of a results folder; name a place outside",
            runs.display()
        );
        return wrong(option, path, &what);
    }
    let Ok(place) = path.canonicalize() else { return Ok(()) };
    if inputs.iter().any(|input| input.canonicalize().is_ok_and(|input| input == place)) {
        return wrong(option, path, "is read by this command and would be overwritten; name another place");
    }
    Ok(())
}

/// The folder of runs that `path` is or would lie in, if there is one: only sweeps write there.
fn runs_around(path: &Path) -> Option<PathBuf> {
    let absolute = std::path::absolute(path).ok()?;
    let there = absolute.ancestors().find(|above| above.exists())?;
    let whole = there.canonicalize().ok()?.join(absolute.strip_prefix(there).ok()?);
    let is_runs = |above: &&Path| {
        above.parent().is_some_and(|results| layout::runs_dir(results) == **above)
            && holds_runs(above, layout::DEPTH)
    };
    whole.ancestors().find(is_runs).map(Path::to_owned)
}

/// Whether a manifest lies `depth` folders below `folder`.
fn holds_runs(folder: &Path, depth: usize) -> bool {
    if depth == 0 {
        return folder.join(layout::MANIFEST).exists();
    }
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    entries.filter(|entry| entry.path().is_dir()).any(|entry| holds_runs(&entry.path(), depth - 1))
}

/// Checks that two places which one command makes do not lie in each other.
///
/// # Errors
/// [`HarnessError::Argument`] naming the first option.
pub fn apart(one: (&'static str, &Path), other: (&'static str, &Path)) -> Result<(), HarnessError> {
    let [a, b] = [one.1, other.1].map(|path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned()));
    if a.starts_with(&b) || b.starts_with(&a) {
        let what = format!("and {} {} lie in each other; name two places", other.0, other.1.display());
        return wrong(one.0, one.1, &what);
    }
    Ok(())
}

/// Tries to write in `path`, or in the nearest folder above it that is there. Whether a folder can be written
/// in depends on more than its permissions: the file system may be full or read-only.
fn check_folder(option: &'static str, path: &Path) -> Result<(), HarnessError> {
    let absolute = std::path::absolute(path).map_err(|error| unwritable(option, path, error))?;
    for place in absolute.ancestors() {
        match fs::metadata(place) {
            Ok(found) if !found.is_dir() => return wrong(option, place, "is no folder"),
            Ok(_) => {
                let tried = tempfile::Builder::new().prefix(".goalbench-").tempfile_in(place);
                return tried.map(drop).map_err(|error| unwritable(option, place, error));
            }
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                if fs::symlink_metadata(place).is_ok() {
                    return wrong(option, place, "is a link that leads nowhere");
                }
            }
            Err(error) if error.kind() == std::io::ErrorKind::NotADirectory => {}
            Err(error) => return Err(unwritable(option, place, error)),
        }
    }
    Ok(())
}

fn unwritable(option: &'static str, path: &Path, error: std::io::Error) -> HarnessError {
    HarnessError::flag(option)(HarnessError::io(path, "write in this folder")(error))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::chain;

    #[test]
    fn nothing_is_written_among_runs_and_no_two_outputs_lie_in_each_other() {
        let folder_guard = tempfile::tempdir().expect("a temporary folder");
        let results = folder_guard.path().join("results");
        let run = results.join("runs/MazeA/teach/default/seed-0");
        fs::create_dir_all(&run).expect("it can be made");
        for free in [results.join("runs"), results.join("runs/x.json"), results.join("report")] {
            folder("--out", &free, &[]).expect("there is no run yet");
        }
        fs::write(run.join(layout::MANIFEST), "{}").expect("it can be written");
        for taken in [results.join("runs"), run.join("records.jsonl"), results.join("runs/MazeA/new/b.json")]
        {
            let told = chain(&file("--out", &taken, &[]).expect_err("it is refused"));
            assert!(
                told.contains("holds the runs of a results folder") || told.contains("is a folder"),
                "{told}"
            );
            folder("--out", &taken, &[]).expect_err("it is refused");
        }
        file("--out", &results.join("report/b.json"), &[]).expect("there are no runs in it");

        let (a, b) = (Path::new("x/a"), Path::new("x/a/b"));
        apart(("--out", a), ("--keep", b)).expect_err("one lies in the other");
        apart(("--out", b), ("--keep", a)).expect_err("one lies in the other");
        apart(("--out", a), ("--keep", a)).expect_err("they are the same");
        apart(("--out", a), ("--keep", Path::new("x/ab"))).expect("they are two");
    }

    #[test]
    fn what_is_in_the_way_is_told_and_nothing_is_left() {
        let folder_guard = tempfile::tempdir().expect("a temporary folder");
        let root = folder_guard.path();
        fs::write(root.join("input"), "x").expect("it can be written");
        fs::create_dir(root.join("there")).expect("it can be made");
        std::os::unix::fs::symlink("nowhere", root.join("link")).expect("a link");
        let inputs = [root.join("input")];
        let inputs: Vec<&Path> = inputs.iter().map(PathBuf::as_path).collect();
        let told = |result: Result<(), HarnessError>| chain(&result.expect_err("it is refused"));
        let refuses = |result, part: &str| {
            let text = told(result);
            assert!(text.starts_with("--out: ") && text.contains(part), "{text}");
        };
        refuses(file("--out", &root.join("there"), &inputs), "is a folder");
        refuses(file("--out", &root.join("new/"), &inputs), "is the name of a folder");
        refuses(file("--out", &root.join("input"), &inputs), "would be overwritten");
        refuses(file("--out", &root.join("there/../input"), &inputs), "would be overwritten");
        refuses(file("--out", &root.join("input/x"), &inputs), "input is no folder");
        refuses(file("--out", Path::new("/dev/null"), &inputs), "no regular file");
        refuses(file("--out", Path::new(""), &inputs), "empty");
        refuses(folder("--out", &root.join("input/x/y"), &inputs), "input is no folder");
        refuses(folder("--out", &root.join("link/x"), &inputs), "leads nowhere");
        refuses(folder("--out", Path::new("/proc/goalbench"), &inputs), "/proc: cannot write in this folder");
        for good in [root.join("there"), root.join("new/one"), root.join("new")] {
            folder("--out", &good, &inputs).expect("it can be made");
        }
        file("--out", &root.join("new/x.json"), &inputs).expect("it can be written");
        assert_eq!(fs::read_dir(root).expect("a folder").count(), 3);
    }
}
