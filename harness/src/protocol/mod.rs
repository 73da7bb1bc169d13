//! A protocol: which environments, curricula, variants and seeds, under which config.
//!
//! It is read from TOML, a file or a preset, then changed by the command line, and becomes a [`plan::Plan`].

pub mod copy;
mod header;
mod idle;
mod name;
pub mod plan;
pub mod presets;
pub mod search;

use guard::text::short;
use toml::Table;

use crate::Registry;
use crate::config::layer::{ConfigLayer, Document, Origin, merge};
use crate::config::strict::FieldError;
use crate::config::{SECTIONS, seeds};
use crate::error::HarnessError;
use header::{Header, Seeds, WrittenPatch, WrittenVariant};
use search::Search;

pub use header::schema;

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
    /// The search over settings that comes before.
    pub(crate) search: Option<Search>,
    /// Config from the command line, above everything else.
    pub options: Vec<ConfigLayer>,
    /// What in its document changes nothing, a sentence each.
    idle_in_document: Vec<String>,
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

impl Protocol {
    /// Parses a protocol; `name` is what errors call the document.
    ///
    /// # Errors
    /// [`HarnessError`] naming the document and line.
    pub fn parse(name: &str, text: &str, registry: &Registry) -> Result<Self, HarnessError> {
        let (document, table) = Document::parse(name, text)?;
        let reader = Reader { document, registry };
        let (base, keys): (Table, Table) =
            table.into_iter().partition(|(key, _)| SECTIONS.contains(&key.as_str()));
        let header = reader.header(keys)?;
        let wrong_seeds = |reason| reader.config_error("seeds", reason);
        let mut overrides = Vec::new();
        for (index, written) in header.overrides.into_iter().enumerate() {
            overrides.push(reader.patch(written, "override", index)?);
        }
        let variants = reader.variants(header.variants)?;
        let search = header.search.map(|written| reader.search(written)).transpose()?;
        if search.is_some() && !variants.is_empty() {
            let reason = "a protocol with a search has no variants of its own: it compares default and chosen settings";
            return Err(reader.error(&["variant"], reason.to_owned()));
        }
        name::check(&header.name).map_err(|reason| reader.error(&["name"], reason))?;
        let at = |key| reader.prefix(&[key]);
        let mut protocol = Self {
            name: header.name,
            description: header.description,
            text: Some(text.to_owned()),
            environments: registry.expand_environments(&header.environments, &at("environments"))?,
            curricula: registry.expand_curricula(&header.curricula, &at("curricula"))?,
            seeds: seeds_of(header.seeds).map_err(wrong_seeds)?,
            base: reader.layer(vec![], base),
            overrides,
            variants,
            search,
            options: Vec::new(),
            idle_in_document: Vec::new(),
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
        protocol.idle_in_document = idle::of_document(&protocol);
        Ok(protocol)
    }

    /// A protocol made on the command line alone, without file or preset. Its name comes last, with
    /// [`name_by_options`](Self::name_by_options).
    pub fn from_options() -> Self {
        Self {
            name: String::new(),
            description: String::new(),
            text: None,
            environments: Vec::new(),
            curricula: Vec::new(),
            seeds: vec![0],
            base: ConfigLayer { origin: Origin::Option("the command line".into()), table: Table::new() },
            overrides: Vec::new(),
            variants: Vec::new(),
            search: None,
            options: Vec::new(),
            idle_in_document: Vec::new(),
        }
    }

    /// Names a protocol by what it asks for: environments, curricula and the layers set on top. Seeds are no
    /// part of the name: other seeds of the same command belong to the same results.
    pub fn name_by_options(&mut self) {
        let mut set = Table::new();
        self.options.iter().for_each(|layer| merge(&mut set, &layer.table));
        self.name = name::of_options(&self.environments, &self.curricula, &set);
    }

    /// Adds a command-line layer on top.
    pub fn set(&mut self, layer: ConfigLayer) {
        self.options.push(layer);
    }

    /// The same with a layer that names shadows: these may use what no run would use without them.
    pub fn watch(&mut self, layer: ConfigLayer) {
        self.set(layer);
        self.idle_in_document = idle::of_document(self);
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
        Header::read(table).map_err(|FieldError { path, reason }| {
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

/// The seeds that are written.
fn seeds_of(written: Seeds) -> Result<Vec<u64>, String> {
    match written {
        Seeds::List(list) => seeds::unique(&list).map(|()| list),
        Seeds::Text(text) => seeds::parse(&text),
    }
}

/// Labels become folder names.
fn check_label(label: &str) -> Result<(), String> {
    let fine = |c: char| c.is_ascii_alphanumeric() || "-_.=+".contains(c);
    if label.is_empty() || label.starts_with('.') || label.len() > 80 || !label.chars().all(fine) {
        return Err(format!(
            "`{}` cannot be a label; accepted: up to 80 letters, digits and -_.=+, not starting with a dot",
            short(label)
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
