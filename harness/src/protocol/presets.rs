//! Protocols that come with the program.

use super::Protocol;
use crate::Registry;
use crate::error::HarnessError;

/// A built-in protocol: its name and its TOML text.
pub struct Preset {
    /// What `--preset` takes.
    pub name: &'static str,
    /// The document, as a user would write it.
    pub text: &'static str,
}

/// All presets, smallest first.
pub const PRESETS: [Preset; 8] = [
    Preset { name: "smoke", text: include_str!("presets/smoke.toml") },
    Preset { name: "quickstart", text: include_str!("presets/quickstart.toml") },
    Preset { name: "reduced", text: include_str!("presets/reduced.toml") },
    Preset { name: "ambiguity", text: include_str!("presets/ambiguity.toml") },
    Preset { name: "ablation-window", text: include_str!("presets/ablation-window.toml") },
    Preset { name: "ablation-interplay", text: include_str!("presets/ablation-interplay.toml") },
    Preset { name: "ablation-polyak", text: include_str!("presets/ablation-polyak.toml") },
    Preset { name: "paper", text: include_str!("presets/paper.toml") },
];

/// The preset with this name.
///
/// # Errors
/// [`HarnessError::Unknown`] with a suggestion.
pub fn find(name: &str) -> Result<&'static Preset, HarnessError> {
    let accepted = PRESETS.iter().map(|preset| preset.name);
    PRESETS
        .iter()
        .find(|preset| preset.name == name)
        .ok_or_else(|| HarnessError::unknown("", "preset", name, accepted))
}

impl Preset {
    /// The preset as a protocol.
    ///
    /// # Errors
    /// [`HarnessError`] if the registry lacks a curriculum that the preset names.
    pub fn protocol(&self, registry: &Registry) -> Result<Protocol, HarnessError> {
        Protocol::parse(&format!("preset {}", self.name), self.text, registry)
    }
}
