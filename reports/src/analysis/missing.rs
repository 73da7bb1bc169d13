//! What a report lacks for being complete, said in words.

use std::collections::BTreeSet;

use crate::analysis::group::{Group, GroupKey};
use crate::analysis::teaching::PICKED_GOALS;
use crate::methods;
use crate::paper;
use crate::schema::Record;
use crate::store::Run;

/// Runs that are not there or not finished, beside what was run: every environment among `groups` is expected to have
/// every method among them, and every method the seeds that any run of `all` has. `groups` come in order; those that
/// stand for their method and those that are variants of one are asked about apart, for ablations may be run in fewer
/// environments.
pub fn runs(all: &[Group<'_>], groups: &[&Group<'_>]) -> Vec<String> {
    let seeds: BTreeSet<u64> = all.iter().flat_map(|group| &group.runs).map(|run| run.key().seed).collect();
    let mut methods: Vec<&GroupKey> = groups.iter().map(|group| &group.key).collect();
    methods.sort_by(|a, b| a.cmp_method(b));
    methods.dedup_by(|a, b| a.cmp_method(b).is_eq());
    let mut missing = Vec::new();
    for environment in groups.chunk_by(|a, b| a.key.environment == b.key.environment) {
        let id = &environment[0].key.environment;
        for method in &methods {
            let name = format!("{}{}", methods::title(&method.curriculum), method.detail());
            let Some(group) = environment.iter().find(|group| group.key.cmp_method(method).is_eq()) else {
                missing.push(format!("{id}: {name} has no evaluation"));
                continue;
            };
            let has = |seed: &&u64| group.runs.iter().all(|run| run.key().seed != **seed);
            let lacking: Vec<String> = seeds.iter().filter(has).map(u64::to_string).collect();
            if !lacking.is_empty() {
                let seeds = if lacking.len() == 1 { "seed" } else { "seeds" };
                missing.push(format!("{id}: {name} lacks {seeds} {}", lacking.join(", ")));
            }
            let unfinished = group.runs.iter().filter(|run| !run.is_finished()).count();
            if unfinished > 0 {
                missing.push(format!("{id}: {name}: {unfinished} of {} runs not finished", group.runs.len()));
            }
        }
    }
    missing
}

/// How many runs of `all` do not tell the success at any step in each of their evaluations; `None` if all do.
pub fn any_success(all: &[Group<'_>]) -> Option<String> {
    older("success at any step", all, |record| record.any_success_rate.is_some())
}

/// How many runs of `all` do not tell in each of their evaluations which goals of the pool were picked; `None` if all
/// do. A teacher that picks none has the number all the same, as one that is not defined.
pub fn picks(all: &[Group<'_>]) -> Option<String> {
    older("which goals of the pool were picked", all, |record| record.teacher.contains_key(PICKED_GOALS))
}

fn older(what: &str, all: &[Group<'_>], tells: impl Fn(&Record) -> bool) -> Option<String> {
    let runs: Vec<&Run> = all.iter().flat_map(|group| group.runs.iter().copied()).collect();
    let silent = runs.iter().filter(|run| !run.records.iter().all(&tells)).count();
    (silent > 0).then(|| {
        format!("{what}: {silent} of {} runs have no record of it (older than the field)", runs.len())
    })
}

/// The paper's methods and environments that `all` has no evaluation of, in a line each.
pub fn of_the_paper(all: &[Group<'_>]) -> Vec<String> {
    let has_method = |id: &str| all.iter().any(|group| group.key.curriculum == id);
    let methods: Vec<&str> = paper::methods().filter(|id| !has_method(id)).map(methods::title).collect();
    let has_task = |names: &[&str]| all.iter().any(|group| names.contains(&group.key.environment.as_str()));
    let tasks: Vec<&str> =
        paper::TASKS.iter().filter(|names| !has_task(names)).map(|names| names[0]).collect();
    let line = |what: &str, names: Vec<&str>| {
        (!names.is_empty())
            .then(|| format!("no evaluation of these {what} of the paper: {}", names.join(", ")))
    };
    line("methods", methods).into_iter().chain(line("environments", tasks)).collect()
}
