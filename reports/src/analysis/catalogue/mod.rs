//! What a report is told: on its own it knows no method, no environment and no claim.
//!
//! Whoever asks for a report hands in a [`Catalogue`]. Results can hold more than it names: a method that is
//! not in it is shown by its id, and environments without an entry are drawn all the same.

mod environment;
mod methods;
mod paper;

use std::sync::Arc;

use serde_json::Value;

use crate::schema::Manifest;

pub use environment::{EnvironmentInfo, MazeInfo};
pub use methods::{MethodInfo, natural_order};
pub use paper::{
    Axis, Claim, ClaimKind, ClaimScope, Deviation, Measure, Paper, PaperProtocol, ReadingChoice, Rule,
};

/// Everything that a report is told about methods, environments and the paper that it sets results against.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Catalogue {
    methods: Vec<Arc<MethodInfo>>,
    /// Dimensions for the table of environments; those that were not run are left out.
    pub environments: Vec<EnvironmentInfo>,
    /// Mazes to draw heat maps of; those that were not run are left out.
    pub mazes: Vec<MazeInfo>,
    /// The paper; the default one compares nothing and claims nothing.
    pub paper: Paper,
    /// What to cite, in order.
    pub citations: Vec<Citation>,
}

/// A work that results rest on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Citation {
    /// What for, in a few words.
    pub of: String,
    /// The curriculum whose runs rest on it, by id; `None`: all results.
    pub curriculum: Option<String>,
    /// Authors, title, where and when.
    pub text: String,
}

impl Catalogue {
    /// A catalogue of `methods`, in the order of legends and tables, that knows nothing else yet.
    pub fn of(methods: impl IntoIterator<Item = MethodInfo>) -> Self {
        let ranked = methods.into_iter().enumerate().map(|(rank, method)| Arc::new(method.ranked(rank)));
        Self { methods: ranked.collect(), ..Self::default() }
    }

    /// Adds the method of the curriculum id `known` once more, as the archive `origin` has it: under `id`.
    pub(crate) fn add_guest(&mut self, known: &str, id: &str, origin: &str) {
        let method = self.method(known).of_guest(id, origin);
        self.methods.push(Arc::new(method));
    }

    /// All methods, in order.
    pub fn methods(&self) -> &[Arc<MethodInfo>] {
        &self.methods
    }

    /// The method of a curriculum id; one that goes by its id, after all others, where the catalogue has
    /// none.
    pub fn method(&self, id: &str) -> Arc<MethodInfo> {
        let known = self.methods.iter().find(|method| method.id == id);
        known.map_or_else(|| Arc::new(MethodInfo::new(id, id, None)), Arc::clone)
    }

    /// The method of a run: [`Catalogue::method_in`] of its curriculum.
    pub fn method_of(&self, manifest: &Manifest) -> Arc<MethodInfo> {
        self.method_in(manifest, &manifest.run.curriculum)
    }

    /// The method of a curriculum id in a run, where it acts or watches: as [`Catalogue::method`] has it,
    /// unless the run's config gives this curriculum a `title`. Two variants with titles of their own are two
    /// methods.
    pub fn method_in(&self, manifest: &Manifest, id: &str) -> Arc<MethodInfo> {
        let method = self.method(id);
        let own = manifest.config.get("curriculum").and_then(|tables| tables.get(method.own_id()));
        match own.and_then(|table| table.get("title")).and_then(Value::as_str) {
            Some(title) if !title.is_empty() => Arc::new(method.titled(title)),
            _ => method,
        }
    }

    /// Name of a curriculum in figures and tables.
    pub fn title(&self, id: &str) -> String {
        self.method(id).title.clone()
    }
}
