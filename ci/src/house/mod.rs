//! The house rules that no compiler, formatter or lint checks. Every test below is one rule and names each
//! place that breaks it, with file and line.
//!
//! Clippy checks two more: `too_many_lines` (functions, with the threshold of `.clippy.toml`) and
//! `self_named_module_files` (a module with a folder is `foo/mod.rs`).

mod comments;
mod finding;
mod glossary;
mod length;
mod links;
mod nouns;
mod sources;
mod top;

use std::{
    fs,
    path::{Path, PathBuf},
};

use finding::Finding;
use glossary::Glossary;
use sources::{Source, sources};

/// What the top folder holds, dotfiles apart. The last two are made by builds and runs, and git ignores them.
const TOP: [&str; 11] = [
    "Cargo.lock",
    "Cargo.toml",
    "README.md",
    "agents",
    "ci",
    "curricula",
    "envs",
    "harness",
    "reports",
    "results",
    "target",
];

fn project() -> PathBuf {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    package.parent().expect("the package lies in the project folder").to_owned()
}

fn read(path: &str) -> String {
    fs::read_to_string(project().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// Fails if there is any finding, and names all of them.
fn assert_none(findings: impl IntoIterator<Item = Finding>) {
    let lines: Vec<String> = findings.into_iter().map(|finding| finding.to_string()).collect();
    assert!(lines.is_empty(), "\n{}", lines.join("\n"));
}

#[test]
fn files_are_short() {
    assert_none(sources(&project()).iter().filter_map(length::too_long));
}

#[test]
fn comments_fit_the_width() {
    let width = comments::max_width(&read(".rustfmt.toml")).expect("rustfmt's max_width");
    assert_none(sources(&project()).iter().flat_map(|source| comments::too_wide(source, width)));
}

#[test]
fn public_nouns_mean_one_thing() {
    let glossary = Glossary::read(glossary::FILE, &read(glossary::FILE));
    let nouns: Vec<_> = sources(&project()).iter().flat_map(nouns::public).collect();
    assert_none(nouns::defined_twice(&nouns, &glossary));
}

#[test]
fn the_glossary_points_at_code_that_exists() {
    let glossary = Glossary::read(glossary::FILE, &read(glossary::FILE));
    assert_none(glossary.dangling(&project(), &sources(&project())));
}

#[test]
fn every_public_trait_is_in_the_glossary() {
    let glossary = Glossary::read(glossary::FILE, &read(glossary::FILE));
    let nouns: Vec<_> = sources(&project()).iter().flat_map(nouns::public).collect();
    assert_none(glossary.missing_traits(&nouns));
}

#[test]
fn links_lead_somewhere() {
    assert_none(links::broken(&project()));
}

#[test]
fn the_top_folder_holds_nothing_else() {
    let entries = fs::read_dir(project()).expect("the project folder can be read");
    let names = entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned());
    assert_none(top::unexpected(names, &TOP));
}
