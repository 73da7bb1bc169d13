//! Copies of protocols in results folders: what was asked for, for whoever finds the results later.

use std::fs;
use std::io::{ErrorKind, Write as _};
use std::path::Path;

use reports::store::layout;
use toml::Table;

use super::Protocol;
use crate::config::layer::{self, Origin};
use crate::error::HarnessError;
use crate::files;

/// Longest name of a copy, in bytes, without number and extension.
const LONGEST_NAME: usize = 100;

/// Leaves a copy of `protocol` in the results folder `results`: the document as it was written below comments
/// that say what was run of it, or one that runs the same where there was none. The same request leaves one
/// copy however often it is made; another one of the same name, as for more seeds, gets a number.
///
/// # Errors
/// [`HarnessError::Io`] if it cannot be written.
pub fn save(protocol: &Protocol, results: &Path) -> Result<(), HarnessError> {
    place(&layout::protocols_dir(results), &file_name(&protocol.name), &document(protocol))
}

/// Brings the copies of protocols in the results folder `source` along to the results folder `out`.
///
/// # Errors
/// [`HarnessError::Io`] if one cannot be read or written.
pub fn bring(source: &Path, out: &Path) -> Result<(), HarnessError> {
    let folder = layout::protocols_dir(source);
    let paths = guard::files::entries(&folder).map_err(HarnessError::io(&folder, "read this folder"))?;
    for path in paths.into_iter().flatten() {
        let name = path.file_stem().and_then(|name| name.to_str());
        let is_copy = path.extension().is_some_and(|extension| extension == "toml");
        if let Some(name) = name.filter(|_| is_copy) {
            let text = guard::files::read_to_string(&path);
            let text = text.map_err(HarnessError::io(&path, "read this file"))?;
            place(&layout::protocols_dir(out), name, &text)?;
        }
    }
    Ok(())
}

/// Writes `text` into `folder` under this name, or one with a number, unless it lies there already.
fn place(folder: &Path, name: &str, text: &str) -> Result<(), HarnessError> {
    fs::create_dir_all(folder).map_err(HarnessError::io(folder, "create this folder"))?;
    // What was left half-written when another command was killed.
    guard::fresh::sweep(folder);
    for number in 1.. {
        let number = if number == 1 { String::new() } else { format!("-{number}") };
        let path = folder.join(format!("{name}{number}.toml"));
        match fs::symlink_metadata(&path) {
            Ok(metadata) if metadata.is_file() => {
                let known = guard::files::read(&path).map_err(HarnessError::io(&path, "read this file"))?;
                if known == text.as_bytes() {
                    return Ok(());
                }
            }
            Ok(_) => {}
            Err(error) if error.kind() == ErrorKind::NotFound => {
                return write(&path, text).map_err(HarnessError::io(&path, "write this file"));
            }
            Err(error) => return Err(HarnessError::io(&path, "read this file")(error)),
        }
    }
    Ok(())
}

fn write(path: &Path, text: &str) -> std::io::Result<()> {
    let mut file = files::new_file(path.parent().unwrap_or(Path::new(".")))?;
    file.write_all(text.as_bytes())?;
    file.as_file().sync_all()?;
    file.persist_noclobber(path)?;
    Ok(())
}

/// The copy, as TOML.
fn document(protocol: &Protocol) -> String {
    let Protocol { environments, curricula, seeds, text, options, .. } = protocol;
    let Some(text) = text else { return generated(protocol) };
    let seeds: Vec<String> = seeds.iter().map(u64::to_string).collect();
    let options: Vec<&str> = options
        .iter()
        .map(|layer| match &layer.origin {
            Origin::Option(option) => option.as_str(),
            Origin::Document(..) => "a document",
        })
        .collect();
    let mut comments = vec![
        "A copy, made by `goalbench run`. What was run of it:".to_owned(),
        format!("environments: {}", environments.join(", ")),
        format!("curricula: {}", curricula.join(", ")),
        format!("seeds: {}", seeds.join(", ")),
    ];
    if !options.is_empty() {
        comments.push(format!("options: {}", options.join(" ")));
    }
    // A line break would end the comment, and TOML knows no other control characters in one.
    let comment = |line: String| format!("# {}\n", line.replace(char::is_control, " "));
    comments.into_iter().map(comment).collect::<String>() + "\n" + text
}

/// The document that runs the same as a protocol that has none.
fn generated(protocol: &Protocol) -> String {
    let names = |ids: &[String]| toml::Value::Array(ids.iter().map(|id| id.as_str().into()).collect());
    // Every list of seeds was checked to fit into TOML's integers.
    let seeds = protocol.seeds.iter().map(|&seed| i64::try_from(seed).unwrap_or(i64::MAX).into()).collect();
    let mut table = Table::from_iter([
        ("name".to_owned(), protocol.name.as_str().into()),
        ("description".to_owned(), protocol.description.as_str().into()),
        ("environments".to_owned(), names(&protocol.environments)),
        ("curricula".to_owned(), names(&protocol.curricula)),
        ("seeds".to_owned(), toml::Value::Array(seeds)),
    ]);
    for layer in [&protocol.base].into_iter().chain(&protocol.options) {
        layer::merge(&mut table, &layer.table);
    }
    format!("# Made by `goalbench run` from options.\n\n{table}")
}

/// A protocol's name as that of a file: letters of all languages, digits and `-_.` stay.
fn file_name(name: &str) -> String {
    let sign = |c: char| if c.is_alphanumeric() || "-_.".contains(c) { c } else { '-' };
    let mut text: String = name.chars().map(sign).collect();
    let mut end = LONGEST_NAME.min(text.len());
    while !text.is_char_boundary(end) {
        end -= 1;
    }
    text.truncate(end);
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Registry;
    use crate::config::layer::ConfigLayer;
    use crate::protocol::plan::Plan;
    use crate::protocol::presets::PRESETS;

    fn copies(results: &Path) -> Vec<String> {
        let entries = fs::read_dir(layout::protocols_dir(results)).expect("there");
        let mut names: Vec<String> =
            entries.map(|entry| entry.expect("there").file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    #[test]
    fn a_copy_of_every_preset_is_the_protocol_and_the_report_knows_it() {
        let registry = Registry::builtin();
        let results = tempfile::tempdir().expect("a folder");
        for preset in &PRESETS {
            let mut protocol = preset.protocol(&registry).expect("sound");
            let option = "--set a.b=1\nname = 'other'".to_owned();
            protocol.set(ConfigLayer { origin: Origin::Option(option), table: Table::new() });
            save(&protocol, results.path()).expect("written");
            save(&protocol, results.path()).expect("there already");
            let again = Protocol::parse("copy", &document(&protocol), &registry).expect("sound");
            assert_eq!(again.name, preset.id);
            assert_eq!(
                Plan::new(&again, &registry).expect("sound"),
                Plan::new(&protocol, &registry).expect("sound")
            );
        }
        assert_eq!(copies(results.path()).len(), PRESETS.len());
        let (found, problems) = reports::store::protocols::protocols(results.path());
        assert!(problems.is_empty(), "{problems:?}");
        let known = |preset: &crate::protocol::presets::ProtocolPreset| {
            found
                .iter()
                .any(|copy| (copy.name.as_str(), copy.description.as_str()) == (preset.id, preset.title))
        };
        assert!(PRESETS.iter().all(known), "{found:?}");
    }

    #[test]
    fn another_request_of_the_same_name_keeps_the_first() {
        let registry = Registry::builtin();
        let results = tempfile::tempdir().expect("a folder");
        let mut protocol = PRESETS[0].protocol(&registry).expect("sound");
        save(&protocol, results.path()).expect("written");
        protocol.seeds = vec![7];
        save(&protocol, results.path()).expect("written");
        assert_eq!(copies(results.path()), ["smoke-2.toml", "smoke.toml"]);
        // What a killed command has left goes with the next copy.
        let left = layout::protocols_dir(results.path()).join(".goalbench-0123456789ab.new");
        std::fs::write(&left, "name =").expect("it can be written");
        save(&protocol, results.path()).expect("there already");
        assert!(!left.exists());
        // Another machine had one of these, and one of its own.
        let (other, merged) =
            (tempfile::tempdir().expect("a folder"), tempfile::tempdir().expect("a folder"));
        save(&protocol, other.path()).expect("written");
        protocol.seeds = vec![9];
        save(&protocol, other.path()).expect("written");
        for source in [&results, &other] {
            bring(source.path(), merged.path()).expect("copied");
        }
        assert_eq!(copies(merged.path()), ["smoke-2-2.toml", "smoke-2.toml", "smoke.toml"]);
        protocol.name = "Prüfung 1/2".into();
        save(&protocol, results.path()).expect("written");
        assert!(copies(results.path()).contains(&"Prüfung-1-2.toml".to_owned()));
    }

    #[test]
    fn what_was_asked_for_by_options_can_be_run_from_its_copy() {
        let registry = Registry::builtin();
        let mut protocol = Protocol::from_options();
        protocol.environments = vec!["MazeA".into()];
        protocol.curricula = vec!["teach".into(), "her-iid".into()];
        protocol.seeds = vec![3, 4];
        for assignment in ["budget.steps=400", "student.width=8"] {
            protocol.set(ConfigLayer::from_assignment("--set", assignment).expect("sound"));
        }
        protocol.name_by_options();
        let again = Protocol::parse("copy", &document(&protocol), &registry).expect("sound");
        assert_eq!(
            Plan::new(&again, &registry).expect("sound"),
            Plan::new(&protocol, &registry).expect("sound")
        );
    }
}
