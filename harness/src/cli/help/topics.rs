//! The pages that `goalbench help` prints: those that people write, and those that are made from the code.
//! The book has the same pages.

use super::{commands, paper, records};
use crate::Registry;
use crate::config::reference;

/// A page.
pub(super) struct Topic {
    /// What to ask for; `harness/docs/ID.md` is the page.
    pub(super) id: &'static str,
    /// What it is about.
    about: &'static str,
    text: Text,
}

/// Where a page comes from.
enum Text {
    /// Somebody wrote it.
    Written(&'static str),
    /// It is made from the code.
    Made(fn(&Registry, &clap::Command) -> String),
}

impl Topic {
    const fn written(id: &'static str, about: &'static str, text: &'static str) -> Self {
        Self { id, about, text: Text::Written(text) }
    }

    const fn made(
        id: &'static str,
        about: &'static str,
        text: fn(&Registry, &clap::Command) -> String,
    ) -> Self {
        Self { id, about, text: Text::Made(text) }
    }

    /// The page, in Markdown, with the environments and curricula of `registry` and the commands of
    /// `program`.
    pub(super) fn page(&self, registry: &Registry, program: &clap::Command) -> String {
        match self.text {
            Text::Written(text) => text.to_owned(),
            Text::Made(text) => text(registry, program),
        }
    }
}

macro_rules! written {
    ($id:literal, $about:literal) => {
        Topic::written($id, $about, include_str!(concat!("../../../docs/", $id, ".md")))
    };
}

/// All pages.
pub(super) static TOPICS: &[Topic] = &[
    written!("tutorial", "from nothing to a figure of a curriculum of your own"),
    written!("reproduce", "the paper's figures: commands, hours, and what to conclude"),
    written!("protocols", "describing experiments; results, interruption, clusters, evaluations"),
    written!("environments", "the tasks, and adding one"),
    written!("student", "networks, losses and the cycle that all curricula share"),
    written!("curricula", "the teachers, what they record, and adding one in Rust"),
    written!("python", "a curriculum in Python, or any other language"),
    written!("reports", "figures, tables, statistics, and the ledger of the paper's claims"),
    written!("instruments", "what every curriculum would do, and what the student can really do"),
    written!("sharing", "policies for other programs, results as one file, a wheel"),
    written!("regression", "finding out whether a change makes a method learn worse"),
    written!("cohorts", "many runs in lockstep, for a GPU"),
    Topic::made("commands", "every command and option", |_, program| commands::page(program)),
    Topic::made("config", "every config field", |registry, _| reference::page(registry)),
    Topic::made("records", "every field of the files of a run", |_, _| records::page()),
    written!("json", "what commands print with --json"),
    Topic::made("paper", "what the paper claims, and what it leaves open", |registry, _| {
        paper::page(registry)
    }),
    written!("troubleshooting", "when something goes wrong"),
    written!("glossary", "the nouns"),
];

/// The pages in a line each, to stand below a help text.
pub(super) fn listed() -> String {
    let width = TOPICS.iter().map(|topic| topic.id.len()).max().unwrap_or_default();
    let lines: Vec<String> =
        TOPICS.iter().map(|topic| format!("  {:width$}  {}", topic.id, topic.about)).collect();
    format!("Pages:\n{}", lines.join("\n"))
}
