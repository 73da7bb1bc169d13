//! The command that starts a program.

use std::path::Path;

use sha2::{Digest, Sha256};

/// What is accepted as a command.
pub(super) const ACCEPTED: &str = "a command such as \"python my_teacher.py\", with quotes that close";

/// Hex digits of a file's digest that a version shows.
const DIGITS: usize = 12;

/// The words of a command; `None` if a quote does not close.
pub(super) fn words(command: &str) -> Option<Vec<String>> {
    shlex::split(command)
}

/// The `version` of what goalbench does, and the beginning of the SHA-256 of every file that the command
/// names: a program that was edited is another one, and its runs are never taken for those of the old one.
pub(super) fn version(version: &str, command: &str) -> String {
    let words = words(command).unwrap_or_default();
    let files = words.iter().filter_map(|word| {
        let path = Path::new(word);
        let name = path.file_name()?.to_string_lossy();
        path.is_file().then(|| {
            let digest = std::fs::read(path).map(|bytes| hex::encode(Sha256::digest(bytes)));
            format!(", {name} {}", digest.as_deref().map_or("unreadable", |hex| &hex[..DIGITS]))
        })
    });
    files.fold(version.to_owned(), |text, file| text + &file)
}
