//! The top folder is a short table of contents.

use super::Finding;

const RULE: &str = "the top folder holds Cargo.toml, README.md, the crates and dotfiles";

/// The `names` that are neither dotfiles nor among those `expected`.
pub(crate) fn unexpected(names: impl Iterator<Item = String>, expected: &[&str]) -> Vec<Finding> {
    names
        .filter(|name| !name.starts_with('.') && !expected.contains(&name.as_str()))
        .map(|file| Finding { rule: RULE, file, line: 1, what: "is not one of these".to_owned() })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::unexpected;

    #[test]
    fn dotfiles_may_be_there() {
        let names = [".ci", "Cargo.toml", "notes.md"].map(str::to_owned).into_iter();
        let found = unexpected(names, &["Cargo.toml"]);
        assert_eq!(found.iter().map(|finding| finding.file.as_str()).collect::<Vec<_>>(), ["notes.md"]);
    }
}
