//! `DATA.md` of an archive: what the data set is, for people and for the sites that host it.

use std::collections::{BTreeMap, BTreeSet};

use reports::store::Run;
use reports::store::protocols::ProtocolCopy;
use reports::wording::counted;

use super::SUMS;

/// What a card tells.
pub(super) struct Card<'a> {
    /// Its heading.
    pub(super) title: &'a str,
    /// Under which licence the data are given away, as an SPDX id.
    pub(super) licence: &'a str,
    /// All runs, by rising key.
    pub(super) runs: &'a [Run],
    pub(super) protocols: &'a [ProtocolCopy],
    /// Runs whose policies are there.
    pub(super) policies: usize,
    /// Files of every run that stayed behind.
    pub(super) without: &'a [&'static str],
    /// What the columns mean, as Markdown.
    pub(super) columns: &'a str,
}

impl Card<'_> {
    /// The page: YAML front matter, then Markdown.
    pub(super) fn text(&self) -> String {
        let evaluations: usize = self.runs.iter().map(|run| run.records.len()).sum();
        let head = format!(
            "---\nlicense: {}\npretty_name: {}\ntags: [reinforcement-learning, goal-conditioned, curriculum-learning]\n\
             configs:\n- config_name: records\n  data_files: records.parquet\n- config_name: runs\n  data_files: runs.parquet\n---\n\n",
            yaml(&self.licence.to_lowercase()),
            yaml(self.title),
        );
        let policies = match self.policies {
            0 => "No policy is among them".to_owned(),
            count => format!(
                "The final {} of {} are among them",
                if count == 1 { "policy" } else { "policies" },
                counted(count, "run")
            ),
        };
        format!(
            "{head}# {}\n\nLearning curves of automatic curricula for goal-conditioned reinforcement learning: {} of {}, \
             recorded by goalbench. {policies}. Licence: {}.\n\n{}{}{}## Files\n\n{FILES}{}\
             \nCheck them with `sha256sum -c {SUMS}`. Draw the runs beside your own with \
             `goalbench report RESULTS --with ARCHIVE`.\n{}",
            plain(self.title),
            counted(evaluations, "evaluation"),
            counted(self.runs.len(), "run"),
            plain(self.licence),
            self.said_protocols(),
            self.table(),
            self.versions(),
            self.left_out(),
            self.columns,
        )
    }

    fn left_out(&self) -> String {
        if self.without.is_empty() {
            return String::new();
        }
        let names: Vec<String> = self.without.iter().map(|name| format!("`{name}`")).collect();
        format!("- left out of every run: {}\n", names.join(", "))
    }

    /// What was run of what: a row per environment, curriculum and variant.
    fn table(&self) -> String {
        let mut cells: BTreeMap<[&str; 3], Vec<&Run>> = BTreeMap::new();
        for run in self.runs {
            let key = run.key();
            cells.entry([&key.environment, &key.curriculum, &key.variant]).or_default().push(run);
        }
        let row = |([environment, curriculum, variant], runs): ([&str; 3], Vec<&Run>)| {
            let seeds: Vec<String> = runs.iter().map(|run| run.key().seed.to_string()).collect();
            let failed = runs.iter().filter(|run| !run.is_finished()).count();
            let steps = runs.iter().filter_map(|run| run.records.last()).map(|record| record.step).max();
            format!(
                "| {} | {} | {} | {} | {failed} | {} |\n",
                plain(environment),
                plain(curriculum),
                plain(variant),
                seeds.join(", "),
                steps.unwrap_or(0),
            )
        };
        let rows: String = cells.into_iter().map(row).collect();
        format!(
            "## Runs\n\n| environment | curriculum | variant | seeds | failed | training steps |\n|---|---|---|---|---:|---:|\n{rows}\n"
        )
    }

    fn said_protocols(&self) -> String {
        let line = |protocol: &ProtocolCopy| match protocol.description.trim() {
            "" => format!("- {}\n", plain(&protocol.name)),
            description => format!("- {}: {}\n", plain(&protocol.name), plain(description)),
        };
        let lines: String = self.protocols.iter().map(line).collect();
        if lines.is_empty() { lines } else { format!("## Protocols\n\n{lines}\n") }
    }

    fn versions(&self) -> String {
        let all = self.runs.iter().flat_map(|run| &run.manifest.versions);
        let told: BTreeSet<_> =
            all.filter(|(name, _)| !["commit", "executable"].contains(&name.as_str())).collect();
        let lines: String =
            told.iter().map(|(name, version)| format!("- {} {}\n", plain(name), plain(version))).collect();
        format!("## Versions\n\n{lines}\n")
    }
}

const FILES: &str = "\
- `records.parquet`, `runs.parquet`: tidy data, described below
- `runs/ENVIRONMENT/CURRICULUM/VARIANT/seed-N/`: the records as they were written, with the complete config \
(`manifest.json`) and how the run ended (`outcome.json`)
- `protocols/`: what was asked for
- `policies/ENVIRONMENT/CURRICULUM/VARIANT/seed-N/`: `policy.safetensors` with the numbers of a trained policy and \
`policy.json`, which says what they are
";

/// A string as YAML has it: JSON's notation is part of YAML.
fn yaml(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

/// Text within a line of Markdown.
fn plain(text: &str) -> String {
    reports::render::table::markdown_escape(&guard::text::in_line(text))
}
