//! What a protocol says to no effect: parts that no run uses, and variants that differ in nothing.

use toml::{Table, Value};

use super::plan::{Plan, PlannedRun};
use super::{Patch, Protocol};
use crate::config::layer::ConfigLayer;
use crate::config::shadow;

/// A sentence for each part of a document that none of its own runs can use.
pub(super) fn of_document(protocol: &Protocol) -> Vec<String> {
    let variants =
        protocol.variants.iter().map(|variant| (format!("variant `{}`", variant.label), &variant.patch));
    let overrides = protocol.overrides.iter().map(|patch| ("this override".to_owned(), patch));
    let mut notes: Vec<String> = overrides
        .chain(variants)
        .filter_map(|(what, patch)| {
            let why = why_idle(protocol, patch)?;
            Some(format!("{}: {what} changes nothing: {why}", patch.layer.origin.place(&[])))
        })
        .collect();
    for id in options_of(&protocol.base.table).filter(|id| !is_used(protocol, id)) {
        let place = protocol.base.origin.place(&["curriculum", id]);
        notes.push(format!("{place}: curriculum.{id} changes nothing: no run has this curriculum"));
    }
    notes.extend(protocol.search.iter().flat_map(|search| search.idle(protocol)));
    notes
}

/// Why no run of `protocol` can be changed by `patch`, if none can.
fn why_idle(protocol: &Protocol, patch: &Patch) -> Option<String> {
    let missing =
        |wanted: &[String], there: &[String]| !wanted.is_empty() && !wanted.iter().any(|id| has(there, id));
    if missing(&patch.environments, &protocol.environments) {
        return Some(format!("no run has the environment {}", patch.environments.join(" or ")));
    }
    if missing(&patch.curricula, &protocol.curricula) {
        return Some(format!("no run has the curriculum {}", patch.curricula.join(" or ")));
    }
    let curricula = if patch.curricula.is_empty() { &protocol.curricula } else { &patch.curricula };
    let foreign = only_options_of(&patch.layer.table)?;
    let is_used = |id: &&str| (has(curricula, id) && has(&protocol.curricula, id)) || watches(protocol, id);
    let idle = !foreign.iter().any(is_used);
    idle.then(|| {
        format!("it sets options of {}, which is the curriculum of none of its runs", foreign.join(" and "))
    })
}

impl Protocol {
    /// A sentence for each part of it, the command line included, that changes nothing in its `plan`.
    ///
    /// What `--env` and `--curriculum` leave out of a document is no mistake in the document, so its parts
    /// are judged by its own lists.
    pub fn idle(&self, plan: &Plan) -> Vec<String> {
        let mut notes = self.idle_in_document.clone();
        for layer in &self.options {
            if let Some(ids) = only_options_of(&layer.table)
                && !ids.iter().any(|id| is_used(self, id))
            {
                let place = layer.origin.place(&[]);
                notes.push(format!(
                    "{place}: changes nothing: no run has the curriculum {}",
                    ids.join(" or ")
                ));
            }
        }
        notes.extend(replaced(&self.options));
        notes.extend(self.options.iter().chain([&self.base]).flat_map(|layer| unseen_shadows(layer, plan)));
        notes.extend(alike(plan));
        notes
    }
}

/// A sentence for each of the `options` all of whose settings are replaced by those after it. A `--set` that
/// stands before another one gives way to it as every option does that is repeated.
fn replaced(options: &[ConfigLayer]) -> Vec<String> {
    let mut notes = Vec::new();
    for (index, layer) in options.iter().enumerate() {
        let place = layer.origin.place(&[]);
        let later = &options[index + 1..];
        let replacement = |path: &Vec<&str>| later.iter().find(|later| sets(&later.table, path));
        let replacements = leaves(&layer.table).iter().map(replacement).collect::<Option<Vec<_>>>();
        if let Some([by, ..]) = replacements.as_deref()
            && !place.starts_with("--set ")
        {
            notes.push(format!("{place}: changes nothing: {} sets the same", by.origin.place(&[])));
        }
    }
    notes
}

/// The paths of all values in `table` that are no tables themselves.
fn leaves(table: &Table) -> Vec<Vec<&str>> {
    let mut found = Vec::new();
    for (name, value) in table {
        match value {
            Value::Table(below) => {
                let paths = leaves(below).into_iter();
                found.extend(paths.map(|path| [&[name.as_str()][..], &path].concat()));
            }
            _ => found.push(vec![name.as_str()]),
        }
    }
    found
}

/// Whether `table` has a value at `path`, or one that takes the place of the tables around it.
fn sets(table: &Table, path: &[&str]) -> bool {
    let Some((first, rest)) = path.split_first() else { return true };
    table.get(*first).is_some_and(|value| value.as_table().is_none_or(|table| sets(table, rest)))
}

/// A sentence for each shadow that `layer` names and no run has.
fn unseen_shadows(layer: &ConfigLayer, plan: &Plan) -> Vec<String> {
    let watches = |id: &str| plan.runs.iter().any(|run| run.config.shadow.iter().any(|shadow| shadow == id));
    let idle = shadow::named(&layer.table).filter(|id| *id != shadow::ALL && !watches(id));
    idle.map(|id| {
        let place = layer.origin.place(&[shadow::FIELD]);
        format!("{place}: the shadow `{id}` changes nothing: it acts itself, or another list of shadows takes the place")
    })
    .collect()
}

/// Whether the curriculum `id` acts or watches in some run of `protocol`.
fn is_used(protocol: &Protocol, id: &str) -> bool {
    has(&protocol.curricula, id) || watches(protocol, id)
}

/// Whether some part of `protocol` makes the curriculum `id` a shadow.
fn watches(protocol: &Protocol, id: &str) -> bool {
    let variants = protocol.variants.iter().map(|variant| &variant.patch.layer);
    let layers = protocol.overrides.iter().map(|patch| &patch.layer).chain(variants);
    layers.chain(&protocol.options).chain([&protocol.base]).any(|layer| shadow::names(&layer.table, id))
}

/// A sentence for every set of variants that have one config for a curriculum.
fn alike(plan: &Plan) -> Vec<String> {
    /// Variants that are alike, for a curriculum, on some environments.
    type Alike<'a> = (Vec<&'a str>, &'a str, Vec<&'a str>);
    let mut found: Vec<Alike<'_>> = Vec::new();
    for cell in cells(plan) {
        let key = &cell[0].key;
        let mut left: Vec<&PlannedRun> = cell.clone();
        while let Some(first) = left.first().map(|run| &run.config) {
            let (same, others): (Vec<_>, Vec<_>) = left.into_iter().partition(|run| run.config == *first);
            if same.len() > 1 {
                let labels: Vec<&str> = same.iter().map(|run| run.key.variant.as_str()).collect();
                match found.iter_mut().find(|known| known.0 == labels && known.1 == key.curriculum) {
                    Some((.., environments)) => environments.push(&key.environment),
                    None => found.push((labels, &key.curriculum, vec![&key.environment])),
                }
            }
            left = others;
        }
    }
    let sentence = |(labels, curriculum, environments): Alike<'_>| {
        format!(
            "the variants {} are the same for {curriculum} on {}: they differ in nothing that these runs use",
            labels.join(", "),
            environments.join(", ")
        )
    };
    found.into_iter().map(sentence).collect()
}

/// The runs of the plan's first seed, together where they differ in their variant alone.
fn cells(plan: &Plan) -> Vec<Vec<&PlannedRun>> {
    let mut cells: Vec<Vec<&PlannedRun>> = Vec::new();
    let first = plan.runs.first().map(|run| run.key.seed);
    for run in plan.runs.iter().filter(|run| Some(run.key.seed) == first) {
        let pair = |run: &PlannedRun| (run.key.environment.clone(), run.key.curriculum.clone());
        match cells.iter_mut().find(|cell| pair(cell[0]) == pair(run)) {
            Some(cell) => cell.push(run),
            None => cells.push(vec![run]),
        }
    }
    cells
}

/// The curricula of which `table` sets options and nothing else; `None` if it sets anything else, or nothing.
fn only_options_of(table: &Table) -> Option<Vec<&str>> {
    let ids: Vec<&str> = options_of(table).collect();
    (table.len() == 1 && !ids.is_empty()).then_some(ids)
}

/// The curricula of which `table` sets options.
fn options_of(table: &Table) -> impl Iterator<Item = &str> {
    let options = table.get("curriculum").and_then(Value::as_table);
    options.into_iter().flat_map(|options| options.keys().map(String::as_str))
}

fn has(ids: &[String], id: &str) -> bool {
    ids.iter().any(|other| other == id)
}
