//! Protocols that come with the program.

use super::Protocol;
use crate::Registry;
use crate::error::HarnessError;

/// A built-in protocol: its name and its TOML text.
pub struct ProtocolPreset {
    /// What `--preset` takes.
    pub name: &'static str,
    /// The document, as a user would write it.
    pub text: &'static str,
}

/// All presets, smallest first.
pub const PRESETS: [ProtocolPreset; 8] = [
    ProtocolPreset { name: "smoke", text: include_str!("smoke.toml") },
    ProtocolPreset { name: "quickstart", text: include_str!("quickstart.toml") },
    ProtocolPreset { name: "reduced", text: include_str!("reduced.toml") },
    ProtocolPreset { name: "ambiguity", text: include_str!("ambiguity.toml") },
    ProtocolPreset { name: "ablation-window", text: include_str!("ablation-window.toml") },
    ProtocolPreset { name: "ablation-interplay", text: include_str!("ablation-interplay.toml") },
    ProtocolPreset { name: "ablation-polyak", text: include_str!("ablation-polyak.toml") },
    ProtocolPreset { name: "paper", text: include_str!("paper.toml") },
];

/// The preset with this name.
///
/// # Errors
/// [`HarnessError::Unknown`] with a suggestion.
pub fn find(name: &str) -> Result<&'static ProtocolPreset, HarnessError> {
    let accepted = PRESETS.iter().map(|preset| preset.name);
    PRESETS
        .iter()
        .find(|preset| preset.name == name)
        .ok_or_else(|| HarnessError::unknown("", "preset", name, accepted))
}

impl ProtocolPreset {
    /// The preset as a protocol.
    ///
    /// # Errors
    /// [`HarnessError`] if the registry lacks a curriculum that the preset names.
    pub fn protocol(&self, registry: &Registry) -> Result<Protocol, HarnessError> {
        Protocol::parse(&format!("preset {}", self.name), self.text, registry)
    }
}
