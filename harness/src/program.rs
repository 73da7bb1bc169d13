//! Which program carries out runs: so that what another one did does not pass for its own.

use std::fs::File;
use std::path::Path;
use std::sync::OnceLock;

use sha2::{Digest, Sha256};

/// A program, by the names that were built into it; [`program!`](crate::program!) makes it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Program {
    /// Its name.
    pub name: &'static str,
    /// Its version.
    pub version: &'static str,
}

/// The [`Program`] in whose source this stands: the name of the binary and the version of its package, as in
/// `Registry::builtin().of_program(goalbench::program!())`.
#[macro_export]
macro_rules! program {
    () => {
        $crate::Program { name: env!("CARGO_CRATE_NAME"), version: env!("CARGO_PKG_VERSION") }
    };
}

/// The file of the program that runs, even if another one has been built in its place since.
const EXECUTABLE: &str = "/proc/self/exe";

/// `NAME VERSION`. Of a program that does not say, the name of its file.
pub(crate) fn described(program: Option<Program>) -> String {
    match program {
        Some(Program { name, version }) => format!("{name} {version}"),
        None => {
            let path = std::env::current_exe().unwrap_or_default();
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            // What Linux appends once the file was replaced.
            name.trim_end_matches(" (deleted)").to_owned()
        }
    }
}

/// SHA-256 of the file of the program that runs, in hex; `None` where the system does not show it.
pub(crate) fn executable_digest() -> Option<&'static str> {
    static DIGEST: OnceLock<Option<String>> = OnceLock::new();
    DIGEST.get_or_init(|| digest(Path::new(EXECUTABLE)).ok()).as_deref()
}

fn digest(path: &Path) -> std::io::Result<String> {
    let mut hasher = Sha256::new();
    std::io::copy(&mut File::open(path)?, &mut hasher)?;
    Ok(hasher.finalize().iter().map(|byte| format!("{byte:02x}")).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_program_is_named_and_its_file_digested() {
        assert_eq!(described(Some(Program { name: "mine", version: "0.2.0" })), "mine 0.2.0");
        assert!(described(None).starts_with("goalbench"), "the file of these tests");
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), "abc").unwrap();
        assert!(digest(file.path()).unwrap().starts_with("ba7816bf8f01cfea414140de5dae2223b00361a3"));
        assert_eq!(executable_digest().map(str::len), Some(64));
    }
}
