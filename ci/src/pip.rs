//! Fetches wheels with the user's own pip, and so with the user's own index, proxy and certificates.

use std::{
    fs::{self, File},
    path::Path,
    process::{Command, Stdio},
    thread,
    time::Duration,
};

use crate::{
    console,
    error::{Error, Result, doing, why_not_started},
    pins::{PLATFORMS, PYTHON_VERSION, Part, Wheel},
};

/// Fails when there is no Python or no pip for it.
pub(crate) fn require() -> Result<()> {
    let output = Command::new("python3")
        .args(["-m", "pip", "--version"])
        .output()
        .map_err(|error| Error::Python { reason: why_not_started(&error) })?;
    if output.status.success() {
        return Ok(());
    }
    Err(Error::Pip { reason: summary(&String::from_utf8_lossy(&output.stderr)) })
}

/// Fetches the wheels of `part` into the folder `wheels`. pip's temporary files lie below `scratch`.
///
/// # Errors
/// When pip fails, with its reason in one line.
pub(crate) fn download(part: &Part, wheels: &Path, scratch: &Path) -> Result<()> {
    let list = scratch.join("requirements.txt");
    fs::write(&list, requirements(part.wheels)).map_err(doing("write", &list))?;
    let own = scratch.join("pip");
    fs::create_dir(&own).map_err(doing("create", &own))?;
    let log = scratch.join("pip.log");
    let log_file = File::create(&log).map_err(doing("create", &log))?;

    let mut command = Command::new("python3");
    command
        .args([
            "-m",
            "pip",
            "download",
            "--quiet",
            "--no-input",
            "--disable-pip-version-check",
            "--no-cache-dir",
        ])
        .args(["--no-deps", "--require-hashes", "--only-binary=:all:"])
        .args(["--implementation", "cp", "--python-version", PYTHON_VERSION])
        .args(PLATFORMS.iter().flat_map(|platform| ["--platform", platform]))
        .arg("--dest")
        .arg(wheels)
        .arg("--requirement")
        .arg(&list)
        .env("TMPDIR", &own)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(log_file);
    let mut pip = command.spawn().map_err(|error| Error::Python { reason: why_not_started(&error) })?;
    let mut seen = 0;
    let status = loop {
        if let Some(status) = pip.try_wait().map_err(doing("wait for pip in", scratch))? {
            break status;
        }
        // pip removes its copies before it ends.
        seen = seen.max(size_of(&own));
        console::progress(seen, part.download_bytes());
        thread::sleep(Duration::from_millis(200));
    };
    console::end_progress();
    if status.success() {
        return Ok(());
    }
    let said = fs::read(&log).map_err(doing("read", &log))?;
    Err(Error::Download { title: part.title, reason: summary(&String::from_utf8_lossy(&said)) })
}

/// The wheels in the form of pip's requirements files, each with its hash.
fn requirements(wheels: &[Wheel]) -> String {
    wheels
        .iter()
        .map(|wheel| format!("{}=={} --hash=sha256:{}\n", wheel.project, wheel.version, wheel.sha256))
        .collect()
}

/// Why pip failed, in one line: that it could not reach the index, or else its last error, or else its last
/// line.
fn summary(stderr: &str) -> String {
    let lines = || stderr.lines().map(str::trim).filter(|line| !line.is_empty());
    let unreachable = lines().filter_map(|line| line.split_once("connection broken by '")).next_back();
    if let Some((_, rest)) = unreachable {
        // "...Error('<connection object at 0x7f>: Failed to ...: [Errno 111] Connection refused')': /torch/"
        let rest = rest.rsplit_once("': /").map_or(rest, |(reason, _)| reason);
        let reason = rest.rsplit_once(">: ").map_or(rest, |(_, reason)| reason);
        return format!("no connection to the package index ({})", reason.trim_end_matches([')', '\'', '"']));
    }
    // "No matching distribution" follows an error that says more.
    let mut errors = lines().filter_map(|line| line.strip_prefix("ERROR: "));
    errors
        .rfind(|line| !line.starts_with("No matching distribution found"))
        .or_else(|| lines().rfind(|line| !line.starts_with("[notice]")))
        .unwrap_or("it said nothing")
        .to_owned()
}

/// Bytes of the files below a folder. Files that vanish meanwhile count as nothing.
fn size_of(folder: &Path) -> u64 {
    let Ok(entries) = fs::read_dir(folder) else { return 0 };
    entries
        .flatten()
        .map(|entry| match entry.metadata() {
            Ok(found) if found.is_dir() => size_of(&entry.path()),
            Ok(found) => found.len(),
            Err(_) => 0,
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pins::PARTS;

    #[test]
    fn requirements_pin_every_wheel_by_hash() {
        let text = requirements(PARTS[0].wheels);
        assert_eq!(text.lines().count(), 3);
        let torch =
            "torch==2.11.0 --hash=sha256:7aa2f9bbc6d4595ba72138026b2074be1233186150e9292865e04b7a63b8c67a";
        assert_eq!(text.lines().next(), Some(torch));
    }

    #[test]
    fn a_missing_network_is_named() {
        let said = "WARNING: Retrying (Retry(total=0, connect=None)) after connection broken by \
            'NewConnectionError('<pip._vendor.HTTPConnection object at 0x7f4b>: Failed to establish a new connection: \
            [Errno 111] Connection refused')': /mujoco/\n\
            ERROR: Could not find a version that satisfies the requirement mujoco==3.3.7 (from versions: none)\n\
            ERROR: No matching distribution found for mujoco==3.3.7\n";
        assert_eq!(
            summary(said),
            "no connection to the package index (Failed to establish a new connection: [Errno 111] Connection refused)"
        );
    }

    #[test]
    fn the_last_error_that_says_why_is_kept() {
        let said = "WARNING: something\n\
            ERROR: Could not find a version that satisfies the requirement mujoco==3.3.77 (from versions: 3.3.5)\n\
            ERROR: No matching distribution found for mujoco==3.3.77\n[notice] A new release of pip is available\n";
        assert_eq!(
            summary(said),
            "Could not find a version that satisfies the requirement mujoco==3.3.77 (from versions: 3.3.5)"
        );
    }

    #[test]
    fn without_an_error_line_the_last_line_is_kept() {
        assert_eq!(
            summary("/usr/bin/python3: No module named pip\n\n"),
            "/usr/bin/python3: No module named pip"
        );
        assert_eq!(summary(""), "it said nothing");
    }
}
