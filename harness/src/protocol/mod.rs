//! A protocol: which environments, curricula, variants and seeds, under which config.
//!
//! It is read from TOML, a file or a preset, then changed by the command line, and becomes a [`plan::Plan`].

pub mod copy;
pub mod plan;
pub mod presets;

use serde::Deserialize;
use toml::Table;

use crate::Registry;
use crate::config::layer::{ConfigLayer, Document, Origin};
use crate::config::strict::{self, FieldError};
use crate::config::{SECTIONS, seeds};
use crate::error::HarnessError;

/// Label of the variant of a protocol that names none.
pub const DEFAULT_VARIANT: &str = "default";

/// A protocol, names checked against the registry.
#[derive(Clone, Debug)]
pub struct Protocol {
    /// Its name, for people.
    pub name: String,
    /// What it is for, one line.
    pub description: String,
    /// The document as it was written; `None` where there is none.
    pub text: Option<String>,
    /// Environment ids, suites expanded.
    pub environments: Vec<String>,
    /// Curriculum ids.
    pub curricula: Vec<String>,
    /// Run seeds.
    pub seeds: Vec<u64>,
    /// Config for all runs.
    pub base: ConfigLayer,
    /// Config for some environments or curricula, in order.
    pub overrides: Vec<Patch>,
    /// Labelled alternatives; empty means one, [`DEFAULT_VARIANT`], that changes nothing.
    pub variants: Vec<Variant>,
    /// Config from the command line, above everything else.
    pub options: Vec<ConfigLayer>,
}

/// A layer of config with the environments and curricula that it applies to.
#[derive(Clone, Debug)]
pub struct Patch {
    /// Only these environments; empty means all.
    pub environments: Vec<String>,
    /// Only these curricula; empty means all.
    pub curricula: Vec<String>,
    /// What it sets.
    pub layer: ConfigLayer,
}

impl Patch {
    /// Whether the patch applies to this pair.
    pub fn applies(&self, environment: &str, curriculum: &str) -> bool {
        let among = |list: &[String], id: &str| list.is_empty() || list.iter().any(|name| name == id);
        among(&self.environments, environment) && among(&self.curricula, curriculum)
    }
}

/// A labelled patch, run beside the others.
#[derive(Clone, Debug)]
pub struct Variant {
    /// Names it in run ids and figures.
    pub label: String,
    /// What it changes.
    pub patch: Patch,
}

/// The keys of a protocol document that are not config.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Header {
    name: String,
    #[serde(default)]
    description: String,
    environments: Vec<String>,
    curricula: Vec<String>,
    seeds: Seeds,
    #[serde(default, rename = "override")]
    overrides: Vec<WrittenPatch>,
    #[serde(default, rename = "variant")]
    variants: Vec<WrittenVariant>,
    // Config sections stand here so that a mistyped one is answered with the accepted names. Their contents
    // are checked when the runs are planned.
    #[serde(default, rename = "budget")]
    _budget: Table,
    #[serde(default, rename = "evaluation")]
    _evaluation: Table,
    #[serde(default, rename = "physics")]
    _physics: Table,
    #[serde(default, rename = "pool")]
    _pool: Table,
    #[serde(default, rename = "seed")]
    _seed: Table,
    #[serde(default, rename = "student")]
    _student: Table,
    #[serde(default, rename = "curriculum")]
    _curriculum: Table,
}

#[derive(Deserialize)]
#[serde(untagged, expecting = "expected a list of seeds such as [0, 3], or a range such as \"0..7\"")]
enum Seeds {
    List(Vec<u64>),
    Text(String),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenPatch {
    #[serde(default)]
    environments: Vec<String>,
    #[serde(default)]
    curricula: Vec<String>,
    set: Table,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenVariant {
    label: String,
    #[serde(default)]
    environments: Vec<String>,
    #[serde(default)]
    curricula: Vec<String>,
    #[serde(default)]
    set: Table,
}

impl Protocol {
    /// Parses a protocol; `name` is what errors call the document.
    ///
    /// # Errors
    /// [`HarnessError`] naming the document and line.
    pub fn parse(name: &str, text: &str, registry: &Registry) -> Result<Self, HarnessError> {
        let (document, table) = Document::parse(name, text)?;
        let reader = Reader { document, registry };
        let header = reader.header(table.clone())?;
        let wrong_seeds = |reason| reader.config_error("seeds", reason);
        let mut overrides = Vec::new();
        for (index, written) in header.overrides.into_iter().enumerate() {
            overrides.push(reader.patch(written, "override", index)?);
        }
        let variants = reader.variants(header.variants)?;
        check_name(&header.name).map_err(|reason| reader.error(&["name"], reason))?;
        let base = table.into_iter().filter(|(key, _)| SECTIONS.contains(&key.as_str())).collect();
        let at = |key| reader.prefix(&[key]);
        let protocol = Self {
            name: header.name,
            description: header.description,
            text: Some(text.to_owned()),
            environments: registry.expand_environments(&header.environments, &at("environments"))?,
            curricula: registry.expand_curricula(&header.curricula, &at("curricula"))?,
            seeds: match header.seeds {
                Seeds::List(list) => seeds::unique(&list).map(|()| list),
                Seeds::Text(text) => seeds::parse(&text),
            }
            .map_err(wrong_seeds)?,
            base: reader.layer(vec![], base),
            overrides,
            variants,
            options: Vec::new(),
        };
        for (key, empty) in [
            ("environments", protocol.environments.is_empty()),
            ("curricula", protocol.curricula.is_empty()),
            ("seeds", protocol.seeds.is_empty()),
        ] {
            if empty {
                return Err(reader.error(&[key], format!("`{key}` is empty; name at least one")));
            }
        }
        Ok(protocol)
    }

    /// A protocol made on the command line alone, without file or preset.
    pub fn from_options() -> Self {
        Self {
            name: "command line".into(),
            description: String::new(),
            text: None,
            environments: Vec::new(),
            curricula: Vec::new(),
            seeds: vec![0],
            base: ConfigLayer { origin: Origin::Option("the command line".into()), table: Table::new() },
            overrides: Vec::new(),
            variants: Vec::new(),
            options: Vec::new(),
        }
    }

    /// Adds a command-line layer on top.
    pub fn set(&mut self, layer: ConfigLayer) {
        self.options.push(layer);
    }
}

/// Reads the parts of a protocol document; its errors name the line.
struct Reader<'a> {
    document: Document,
    registry: &'a Registry,
}

impl Reader<'_> {
    /// An error at the value with the keys `path`.
    fn error(&self, path: &[&str], reason: String) -> HarnessError {
        HarnessError::Protocol { place: self.document.place(path), reason }
    }

    /// An error of the field `path`, as in `variant[0].set`.
    fn config_error(&self, path: &str, reason: String) -> HarnessError {
        let keys = path.replace('[', ".").replace(']', "");
        let place = self.document.place(&keys.split('.').collect::<Vec<_>>());
        HarnessError::Config { place, path: path.to_owned(), reason }
    }

    /// What errors about a name at `path` begin with.
    fn prefix(&self, path: &[&str]) -> String {
        format!("{}: ", self.document.place(path))
    }

    fn header(&self, table: Table) -> Result<Header, HarnessError> {
        strict::read(table, "").map_err(|FieldError { path, reason }| {
            if path.is_empty() { self.error(&[""], reason) } else { self.config_error(&path, reason) }
        })
    }

    fn layer(&self, prefix: Vec<String>, table: Table) -> ConfigLayer {
        ConfigLayer { origin: Origin::Document(self.document.clone(), prefix), table }
    }

    /// The patch `index` of those under the key `kind`.
    fn patch(&self, written: WrittenPatch, kind: &str, index: usize) -> Result<Patch, HarnessError> {
        let index = index.to_string();
        let place = self.prefix(&[kind, &index]);
        Ok(Patch {
            environments: self.registry.expand_environments(&written.environments, &place)?,
            curricula: self.registry.expand_curricula(&written.curricula, &place)?,
            layer: self.layer(vec![kind.to_owned(), index, "set".to_owned()], written.set),
        })
    }

    fn variants(&self, written: Vec<WrittenVariant>) -> Result<Vec<Variant>, HarnessError> {
        let mut variants: Vec<Variant> = Vec::new();
        for (index, written) in written.into_iter().enumerate() {
            let WrittenVariant { label, environments, curricula, set } = written;
            let wrong = |reason| self.error(&["variant", &index.to_string()], reason);
            check_label(&label).map_err(wrong)?;
            if variants.iter().any(|other| other.label == label) {
                return Err(wrong(format!("there are two variants `{label}`")));
            }
            let patch = self.patch(WrittenPatch { environments, curricula, set }, "variant", index)?;
            variants.push(Variant { label, patch });
        }
        Ok(variants)
    }
}

/// A name becomes the folder of the results.
fn check_name(name: &str) -> Result<(), String> {
    if name.trim().is_empty() || name.starts_with('.') {
        return Err(format!("`{name}` cannot be a name; give one that can be a folder's"));
    }
    Ok(())
}

/// Labels become folder names.
fn check_label(label: &str) -> Result<(), String> {
    let fine = |c: char| c.is_ascii_alphanumeric() || "-_.=+".contains(c);
    if label.is_empty() || label.starts_with('.') || label.len() > 80 || !label.chars().all(fine) {
        return Err(format!(
            "`{label}` cannot be a label; accepted: up to 80 letters, digits and -_.=+, not starting with a dot"
        ));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_section_of_the_config_can_stand_in_a_protocol() {
        let header = "name = 'x'\nenvironments = ['Point']\ncurricula = ['teach']\nseeds = [0]\n";
        for section in SECTIONS {
            let text = format!("{header}[{section}]\n");
            let protocol = Protocol::parse("test", &text, &Registry::builtin()).expect(section);
            assert!(protocol.base.table.contains_key(section), "{section}");
        }
    }
}
