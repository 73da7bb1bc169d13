//! `goalbench help`.

use super::{Exit, ExitCode, print};
use crate::Registry;
use crate::config::reference;
use crate::error::HarnessError;

/// The page about the JSON that commands print.
const JSON: &str = include_str!("../../docs/json.md");
/// How to write a curriculum in Python.
const PYTHON: &str = include_str!("../../docs/python.md");
/// The nouns.
const GLOSSARY: &str = include_str!("../../docs/glossary.md");

#[derive(clap::Args)]
pub(super) struct Args {
    /// A command such as `run`, or a page: `config` (a path after it shows a part, as in `config
    /// student.noise`), `python`, `json` or `glossary`
    subject: Vec<String>,
}

pub(super) fn help(registry: &Registry, mut program: clap::Command, args: &Args) -> Exit {
    let subject: Vec<&str> = args.subject.iter().map(String::as_str).collect();
    let text = match subject.as_slice() {
        ["config"] => reference::page(registry),
        ["config", path] => reference::part(registry, path).ok_or_else(|| {
            let fields = reference::fields(registry.config_schema());
            HarnessError::unknown("", "config field", path, fields.iter().map(|field| field.path.as_str()))
        })?,
        ["json"] => JSON.to_owned(),
        ["python"] => PYTHON.to_owned(),
        ["glossary"] => GLOSSARY.to_owned(),
        names => {
            program.build();
            let mut command = &mut program;
            for name in names {
                let known: Vec<String> = command
                    .get_subcommands()
                    .filter(|command| !command.is_hide_set())
                    .map(|command| command.get_name().to_owned())
                    .chain(["config", "python", "json", "glossary"].map(str::to_owned))
                    .collect();
                if command.find_subcommand(name).is_none() {
                    return Err(HarnessError::unknown("", "command", name, known.iter().map(String::as_str)));
                }
                command = command.find_subcommand_mut(name).expect("it was found");
            }
            format!("{}\n", command.render_long_help())
        }
    };
    print(&text);
    Ok(ExitCode::Success)
}
