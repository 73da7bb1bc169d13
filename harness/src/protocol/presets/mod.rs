//! Protocols that come with the program.

use toml::{Table, Value};

use super::Protocol;
use crate::Registry;
use crate::config::SECTIONS;
use crate::error::HarnessError;

/// A row of the list of built-in protocols.
pub struct ProtocolPreset {
    /// Its id, which is also the document's `name`.
    pub id: &'static str,
    /// What it runs, in one line: the document's `description`.
    pub title: &'static str,
    /// The document, in TOML, as a user would write it.
    pub text: &'static str,
}

/// All presets, smallest first.
pub const PRESETS: [ProtocolPreset; 11] = [
    ProtocolPreset {
        id: "smoke",
        title: "Toy task and one maze for a few thousand steps: checks the machinery, shows no science",
        text: include_str!("smoke.toml"),
    },
    ProtocolPreset {
        id: "quickstart",
        title: "TEACH against HER-IID on a maze and on FetchReach, two seeds each",
        text: include_str!("quickstart.toml"),
    },
    ProtocolPreset {
        id: "reduced",
        title: "The paper's comparison and ablations, short: 11 environments, 3 seeds, 10k to 60k steps",
        text: include_str!("reduced.toml"),
    },
    ProtocolPreset {
        id: "ambiguity",
        title: "TEACH under the readings of the paper that are open, against HER-IID and its control, short: 4 environments, 5 seeds",
        text: include_str!("ambiguity.toml"),
    },
    ProtocolPreset {
        id: "laptop",
        title: "The laptop study: six curricula with small students on the mazes and FetchReach, 36 seeds",
        text: include_str!("laptop.toml"),
    },
    ProtocolPreset {
        id: "laptop-ablations",
        title: "The laptop study's ablations: TEACH's settings and open readings with small students on the mazes, 12 seeds",
        text: include_str!("laptop-ablations.toml"),
    },
    ProtocolPreset {
        id: "ablation-window",
        title: "TEACH with temporal windows n = 3, 5, 10, 20",
        text: include_str!("ablation-window.toml"),
    },
    ProtocolPreset {
        id: "ablation-interplay",
        title: "TEACH with interplay frequencies of 1, 2, 5, 10, 50 episodes",
        text: include_str!("ablation-interplay.toml"),
    },
    ProtocolPreset {
        id: "ablation-polyak",
        title: "TEACH with confidence from the online or from the target critic, n = 3",
        text: include_str!("ablation-polyak.toml"),
    },
    ProtocolPreset {
        id: "paper",
        title: "The paper's 11 environments, 5 curricula and 7 seeds at its budgets, and the control for the goal pool",
        text: include_str!("paper.toml"),
    },
    ProtocolPreset {
        id: "methods",
        title: "Every curriculum in the paper's 11 environments at its budgets, 7 seeds",
        text: include_str!("methods.toml"),
    },
];

/// The preset with this id.
///
/// # Errors
/// [`HarnessError::Unknown`] with a suggestion.
pub fn find(id: &str) -> Result<&'static ProtocolPreset, HarnessError> {
    let accepted = PRESETS.iter().map(|preset| preset.id);
    PRESETS
        .iter()
        .find(|preset| preset.id == id)
        .ok_or_else(|| HarnessError::unknown("", "preset", id, accepted))
}

impl ProtocolPreset {
    /// What it sets of the config, an assignment each, with where it applies.
    pub fn settings(&self) -> Vec<String> {
        let table: Table = self.text.parse().expect("built-in protocols are TOML");
        let sections = table.iter().filter(|(key, _)| SECTIONS.contains(&key.as_str()));
        let mut settings = Vec::new();
        for (section, value) in sections {
            assignments(section, value, "", &mut settings);
        }
        for list in ["override", "variant"] {
            for patch in table.get(list).and_then(Value::as_array).into_iter().flatten() {
                let names = |key| patch.get(key).and_then(Value::as_array).into_iter().flatten();
                let mut places: Vec<&str> =
                    names("environments").chain(names("curricula")).filter_map(Value::as_str).collect();
                places.extend(patch.get("label").and_then(Value::as_str));
                let place = format!(" ({})", places.join(", "));
                for (section, value) in patch.get("set").and_then(Value::as_table).into_iter().flatten() {
                    assignments(section, value, &place, &mut settings);
                }
            }
        }
        settings
    }

    /// The preset as a protocol.
    ///
    /// # Errors
    /// [`HarnessError`] if the registry lacks a curriculum that the preset names.
    pub fn protocol(&self, registry: &Registry) -> Result<Protocol, HarnessError> {
        Protocol::parse(&format!("preset {}", self.id), self.text, registry)
    }
}

/// Writes the fields of `value`, which stands at `path`, as assignments that end with `place`.
fn assignments(path: &str, value: &Value, place: &str, found: &mut Vec<String>) {
    match value {
        Value::Table(table) => {
            for (name, value) in table {
                assignments(&format!("{path}.{name}"), value, place, found);
            }
        }
        value => found.push(format!("`{path} = {value}`{place}")),
    }
}
