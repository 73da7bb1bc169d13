//! `goalbench list`.

use clap::ValueEnum;
use curricula::methods::process::PYTHON_HELPER;
use serde_json::{Value, json};

use super::{Exit, ExitCode, print};
use crate::Registry;
use crate::config;
use crate::protocol::{self, presets::PRESETS};

#[derive(clap::Args)]
pub(super) struct Args {
    /// What to list; everything but `config`, `schema` and `python` if left out
    what: Option<What>,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum What {
    /// Environments with their dimensions
    Environments,
    /// Named groups of environments
    Suites,
    /// Curricula with their papers
    Curricula,
    /// Built-in protocols
    Presets,
    /// Every config field with its default, as TOML
    Config,
    /// The JSON schema of protocol files, for editors
    Schema,
    /// The one-file helper for curricula in Python: put it beside yours
    Python,
}

pub(super) fn list(registry: &Registry, args: &Args) -> Exit {
    let parts = match args.what {
        Some(what) => vec![what],
        None => vec![What::Environments, What::Suites, What::Curricula, What::Presets],
    };
    if args.json {
        let value = match parts.as_slice() {
            [what] => as_json(registry, *what),
            many => many.iter().map(|what| (name(*what), as_json(registry, *what))).collect(),
        };
        print(&format!("{value:#}\n"));
    } else {
        let texts: Vec<String> = parts.iter().map(|what| as_text(registry, *what)).collect();
        print(&texts.join("\n"));
    }
    Ok(ExitCode::Success)
}

fn name(what: What) -> String {
    what.to_possible_value().expect("no variant is skipped").get_name().to_owned()
}

fn as_json(registry: &Registry, what: What) -> Value {
    match what {
        What::Environments => registry
            .environments()
            .iter()
            .map(|entry| {
                let spec = &entry.spec;
                json!({
                    "id": spec.id, "title": entry.title, "source": entry.source, "family": spec.family,
                    "state": spec.state, "goal": spec.goal, "action": spec.action, "horizon": spec.horizon,
                })
            })
            .collect(),
        What::Suites => {
            registry.suites().iter().map(|suite| (suite.id.to_owned(), json!(suite.environments))).collect()
        }
        What::Curricula => registry
            .curricula()
            .iter()
            .map(|entry| {
                json!({
                    "id": entry.id, "title": entry.title, "source": entry.source, "version": entry.version,
                    "uses_pool": entry.uses_pool, "needs": entry.needs,
                    "defaults": (entry.defaults)(),
                })
            })
            .collect(),
        What::Presets => {
            PRESETS.iter().map(|preset| json!({ "name": preset.id, "description": preset.title })).collect()
        }
        What::Config => json!(config::defaults(registry)),
        What::Schema => protocol::schema(registry),
        What::Python => json!(PYTHON_HELPER),
    }
}

fn as_text(registry: &Registry, what: What) -> String {
    match what {
        What::Environments => environments(registry),
        What::Suites => {
            let lines = registry
                .suites()
                .iter()
                .map(|suite| format!("{:<12} {}\n", suite.id, suite.environments.join(", ")));
            format!("suite        environments\n{}", lines.collect::<String>())
        }
        What::Curricula => {
            let lines = registry
                .curricula()
                .iter()
                .map(|entry| format!("{:<14} {} ({})\n", entry.id, entry.title, entry.source));
            format!("curriculum\n{}", lines.collect::<String>())
        }
        What::Presets => {
            let width = PRESETS.iter().map(|preset| preset.id.len()).max().unwrap_or_default();
            let lines = PRESETS.iter().map(|preset| format!("{:<width$} {}\n", preset.id, preset.title));
            format!("preset\n{}", lines.collect::<String>())
        }
        What::Config => config::defaults(registry).to_string(),
        What::Schema => format!("{:#}\n", protocol::schema(registry)),
        What::Python => PYTHON_HELPER.to_owned(),
    }
}

/// The dimensions as they are, with a note where the paper's Table 1 prints others.
fn environments(registry: &Registry) -> String {
    let mut text = format!(
        "{:<34} {:>5} {:>4} {:>6} {:>7}  about\n",
        "environment", "state", "goal", "action", "horizon"
    );
    let mut notes = Vec::new();
    for entry in registry.environments() {
        let spec = &entry.spec;
        let mark = entry.paper.map_or("", |paper| {
            if !notes.contains(&paper.note) {
                notes.push(paper.note);
            }
            "*"
        });
        text += &format!(
            "{:<34} {:>5} {:>4} {:>5}{mark:1} {:>7}  {}\n",
            spec.id, spec.state, spec.goal, spec.action, spec.horizon, entry.title
        );
    }
    for note in notes {
        text += &format!("* {note}\n");
    }
    text
}
