//! What a report lacks for being complete, said in words.

use std::collections::BTreeSet;

use crate::analysis::catalogue::{Catalogue, PaperProtocol};
use crate::analysis::comparison::Comparison;
use crate::analysis::complete;
use crate::analysis::cost;
use crate::analysis::goal_map;
use crate::analysis::group::{Group, GroupKey};
use crate::analysis::teachers::teachers;
use crate::analysis::tuning::{DEFAULT, TunedPlace};
use crate::analysis::whole::Analysis;
use crate::schema::{Outcome, Record};
use crate::store::Run;
use crate::wording::counted;

/// Everything that a report lacks.
pub fn all(analysis: &Analysis<'_>) -> Vec<String> {
    let groups = analysis.groups;
    let waiting = waiting(analysis);
    // Archives owe these results nothing.
    let own: Vec<Group<'_>> = groups.all.iter().filter(|group| group.is_own()).cloned().collect();
    let of_own = |mut groups: Vec<&Group<'_>>| {
        groups.retain(|group| group.is_own());
        runs(&own, &waiting, &groups)
    };
    let mut lacking = of_own(groups.compared_groups());
    lacking.extend(of_own(groups.variant_groups()));
    lacking.extend(without_a_group(&own, &waiting));
    lacking.extend(pairs(analysis));
    lacking.extend(sums(analysis));
    lacking.extend(of_the_paper(analysis));
    for id in groups.environments() {
        if analysis.catalogue().environments.iter().all(|info| info.id != id) {
            lacking.push(format!("{id}: dimensions not known to this report"));
        }
    }
    lacking.extend(heat_maps(analysis));
    lacking.extend(goal_maps(analysis));
    lacking.extend(diagnoses(analysis));
    lacking.extend(measures(analysis));
    lacking.extend(shadows(analysis));
    lacking.extend(search(analysis));
    lacking.extend(any_success(&own));
    lacking.extend(picks(&own));
    lacking.extend(timings(analysis));
    lacking
}

/// Comparisons with runs of archives that were made otherwise.
fn pairs(analysis: &Analysis<'_>) -> Vec<String> {
    let said = |comparison: &Comparison<'_>| {
        let (method, reference) = (comparison.method.name(), comparison.reference.name());
        let reason = comparison.unpaired.as_ref()?;
        Some(format!("{}: {method} and {reference} are not paired: {reason}", comparison.method.environment))
    };
    analysis.comparisons.iter().filter_map(said).collect()
}

/// What sums over environments leave out.
fn sums(analysis: &Analysis<'_>) -> Vec<String> {
    let mut lacking = Vec::new();
    if analysis.across.environments.is_empty() {
        lacking.push("sums over environments: no two methods share two environments".to_owned());
    }
    for key in &analysis.across.left_out {
        let name = key.name();
        lacking.push(format!("sums over environments leave out {name}, which lacks too many of them"));
    }
    match analysis.groups.left_out() {
        0 => {}
        k => lacking.push(format!(
            "comparisons, ledger and sums over environments rest on finished runs of the same evaluations; left \
             out of all runs of methods: {k}"
        )),
    }
    match analysis.groups.failed() {
        0 => {}
        k => lacking.push(format!(
            "comparisons, ledger and sums over environments count failed runs as 0 from their failure on; runs of \
             methods that failed: {k}"
        )),
    }
    lacking
}

/// Methods that were run in a maze without a record of what their teacher did.
fn heat_maps(analysis: &Analysis<'_>) -> Vec<String> {
    let drawn: Vec<&GroupKey> =
        analysis.heat.mazes.iter().flat_map(|heat| &heat.maps).map(|map| &map.key).collect();
    let mazes = &analysis.catalogue().mazes;
    without_a_map(analysis, &drawn, "heat map", |id| mazes.iter().any(|maze| maze.id == id))
}

/// Methods that were run in a task whose goals are points in space without a record of what their teacher
/// did.
fn goal_maps(analysis: &Analysis<'_>) -> Vec<String> {
    let drawn: Vec<&GroupKey> =
        analysis.goals.environments.iter().flat_map(|maps| &maps.maps).map(|map| &map.key).collect();
    let in_space = |id: &str| {
        let environments = &analysis.catalogue().environments;
        environments.iter().any(|info| info.id == id && info.goal == goal_map::COORDINATES)
    };
    without_a_map(analysis, &drawn, "goal map", in_space)
}

/// Methods that were run in one of the environments that have maps, and are not among those `drawn`: a line
/// per environment.
fn without_a_map(
    analysis: &Analysis<'_>,
    drawn: &[&GroupKey],
    map: &str,
    has_maps: impl Fn(&str) -> bool,
) -> Vec<String> {
    let own = analysis.groups.compared_groups().into_iter().filter(|group| group.is_own());
    let silent = own.map(|group| &group.key).filter(|key| has_maps(&key.environment) && !drawn.contains(key));
    let silent: Vec<&GroupKey> = silent.collect();
    let line = |keys: &[&GroupKey]| {
        let names: Vec<String> = keys.iter().map(|key| key.name()).collect();
        let (id, names) = (&keys[0].environment, names.join(", "));
        format!("{id}: no {map} of {names}: there is no record of what their teachers did")
    };
    silent.chunk_by(|a, b| a.environment == b.environment).map(line).collect()
}

/// Runs without a diagnosis of their student, where the report was asked for them.
fn diagnoses(analysis: &Analysis<'_>) -> Option<String> {
    let own = analysis.store.runs().iter().filter(|run| analysis.store.is_own(run));
    let runs: Vec<&Run> = own.collect();
    let silent = runs.iter().filter(|run| analysis.student.of_run(run).is_empty()).count();
    (analysis.options.diagnostics && silent > 0).then(|| {
        format!(
            "how students learned: {silent} of {} without a record of it (student.jsonl)",
            counted(runs.len(), "run")
        )
    })
}

/// Methods and variants without a measure of the frontier, where others have some.
fn measures(analysis: &Analysis<'_>) -> Vec<String> {
    if analysis.frontier.measures.is_empty() {
        return Vec::new();
    }
    let is_silent =
        |group: &&Group<'_>| group.runs.iter().all(|run| analysis.frontier.of_run(run).is_empty());
    let own = analysis.groups.all.iter().filter(|group| group.is_own());
    own.filter(is_silent)
        .map(|group| format!("{}: {}: no measure of the frontier", group.key.environment, group.key.name()))
        .collect()
}

/// A search without a choice, and choices without runs.
fn search(analysis: &Analysis<'_>) -> Vec<String> {
    if analysis.tuning.is_open {
        return vec![
            "the search over settings: its trials have not all ended, so nothing is chosen".to_owned(),
        ];
    }
    let places = analysis.tuning.places(analysis.groups, analysis.options);
    let without = places.iter().filter(|place| place.tried.chosen != DEFAULT && place.tuned.is_none());
    let said = |place: &TunedPlace<'_>| {
        let (environment, title) = (&place.key.environment, &place.key.curriculum.title);
        format!("{environment}: {title}: no finished runs with the chosen settings beside the default ones")
    };
    without.map(said).collect()
}

/// Shadows that fell silent, and the first reason.
fn shadows(analysis: &Analysis<'_>) -> Vec<String> {
    let mut lacking = Vec::new();
    for group in &analysis.groups.all {
        let watched: Vec<_> = group.runs.iter().filter_map(|run| analysis.shadow.of_run(run)).collect();
        let teachers = teachers(group, &analysis.shadow, analysis.catalogue());
        let failed: BTreeSet<&String> = watched.iter().flat_map(|run| run.failed.keys()).collect();
        for id in failed {
            let reasons: Vec<&String> = watched.iter().filter_map(|run| run.failed.get(id)).collect();
            let (place, name) = (&group.key.environment, group.key.name());
            let known = teachers.iter().find(|teacher| teacher.id == *id);
            let (shadow, count) = (known.map_or(id, |teacher| &teacher.title), reasons.len());
            let all = counted(watched.len(), "run");
            let reason = reasons[0];
            lacking
                .push(format!("{place}: {name}: shadow {shadow} fell silent in {count} of {all} ({reason})"));
        }
    }
    lacking
}

/// What timings do not tell.
fn timings(analysis: &Analysis<'_>) -> Vec<String> {
    let mut lacking = Vec::new();
    let silent = analysis.summaries.iter().filter(|row| {
        row.cost.wall_hours.is_some()
            && (row.cost.teacher_hours.is_none() || row.cost.learning_hours.is_none())
    });
    let silent = silent.count();
    if silent > 0 {
        let all = analysis.summaries.len();
        lacking.push(format!(
            "the teacher's and the student's share of time: timings of {silent} of {all} methods do not tell"
        ));
    }
    for group in &analysis.groups.all {
        let seeds: Vec<String> = group
            .runs
            .iter()
            .filter(|run| !cost::is_timed(run))
            .map(|run| run.key().seed.to_string())
            .collect();
        if !seeds.is_empty() {
            lacking.push(format!(
                "{}: {}: timings (timing.jsonl) of {} {}: times are those of the other seeds",
                group.key.environment,
                group.key.name(),
                if seeds.len() == 1 { "seed" } else { "seeds" },
                seeds.join(", "),
            ));
        }
    }
    lacking
}

/// Runs that are not there or not finished, beside what was run: every environment among `groups` is expected
/// to have every method among them, and every method the seeds that any run of `all` has. `groups` come in
/// order; those that stand for their method and those that are variants of one are asked about apart, for
/// ablations may be run in fewer environments.
fn runs(all: &[Group<'_>], waiting: &[Group<'_>], groups: &[&Group<'_>]) -> Vec<String> {
    let seeds = all.iter().chain(waiting).flat_map(|group| &group.runs).map(|run| run.key().seed);
    let seeds: BTreeSet<u64> = seeds.collect();
    let mut methods: Vec<&GroupKey> = groups.iter().map(|group| &group.key).collect();
    methods.sort_by(|a, b| a.cmp_method(b));
    methods.dedup_by(|a, b| a.cmp_method(b).is_eq());
    let mut missing = Vec::new();
    for environment in groups.chunk_by(|a, b| a.key.environment == b.key.environment) {
        let id = &environment[0].key.environment;
        for method in &methods {
            let name = method.name();
            let Some(group) = environment.iter().find(|group| group.key.cmp_method(method).is_eq()) else {
                missing.push(format!("{id}: {name} has no evaluation"));
                continue;
            };
            let waiting = waiting.iter().find(|other| other.key == group.key);
            let waiting: &[&Run] = waiting.map_or(&[], |waiting| &waiting.runs);
            let all = || group.runs.iter().chain(waiting);
            let has = |seed: &&u64| all().all(|run| run.key().seed != **seed);
            let lacking: Vec<String> = seeds.iter().filter(has).map(u64::to_string).collect();
            if !lacking.is_empty() {
                let seeds = if lacking.len() == 1 { "seed" } else { "seeds" };
                missing.push(format!("{id}: {name} lacks {seeds} {}", lacking.join(", ")));
            }
            let count = |of_it: fn(&Run) -> bool| all().filter(|run| of_it(run)).count();
            let failed = |run: &Run| matches!(run.outcome, Some(Outcome::Failed { .. }));
            for (count, what) in
                [(count(|run| run.outcome.is_none()), "not finished"), (count(failed), "failed")]
            {
                if count > 0 {
                    missing
                        .push(format!("{id}: {name}: {count} of {} {what}", counted(all().count(), "run")));
                }
            }
            if !waiting.is_empty() {
                let seeds: Vec<String> = waiting.iter().map(|run| run.key().seed.to_string()).collect();
                missing.push(format!("{id}: {name}: no evaluation yet of seeds {}", seeds.join(", ")));
            }
        }
    }
    missing
}

/// Runs that were planned and have no evaluation yet, grouped as those that have one.
fn waiting<'a>(analysis: &Analysis<'a>) -> Vec<Group<'a>> {
    let mut groups: Vec<Group<'a>> = Vec::new();
    let store = analysis.store;
    for run in store.runs().iter().filter(|run| run.records.is_empty() && store.is_own(run)) {
        let key = GroupKey::of(analysis.catalogue(), run);
        match groups.iter_mut().find(|group| group.key == key) {
            Some(group) => group.runs.push(run),
            None => groups.push(Group { key, runs: vec![run] }),
        }
    }
    groups
}

/// Groups of runs without an evaluation whose environment or method has none anywhere.
fn without_a_group(all: &[Group<'_>], waiting: &[Group<'_>]) -> Vec<String> {
    let is_asked_for = |key: &GroupKey| {
        all.iter().any(|group| group.key.environment == key.environment)
            && all.iter().any(|group| group.key.cmp_method(key).is_eq())
    };
    let silent = waiting.iter().map(|group| &group.key).filter(|key| !is_asked_for(key));
    silent.map(|key| format!("{}: {} has no evaluation", key.environment, key.name())).collect()
}

/// How many runs of `all` do not tell the success at any step in each of their evaluations; `None` if all do.
fn any_success(all: &[Group<'_>]) -> Option<String> {
    older("success at any step", all, |record| record.any_success_rate.is_some())
}

/// How many runs of `all` do not tell in each of their evaluations which goals of the pool were picked;
/// `None` if all do. A teacher that picks none has the number all the same, as one that is not defined.
fn picks(all: &[Group<'_>]) -> Option<String> {
    older("which goals of the pool were picked", all, |record| {
        record.teacher.contains_key(names::PICKED_GOALS)
    })
}

fn older(what: &str, all: &[Group<'_>], tells: impl Fn(&Record) -> bool) -> Option<String> {
    let runs: Vec<&Run> = all.iter().flat_map(|group| group.runs.iter().copied()).collect();
    let silent = runs.iter().filter(|run| !complete::recorded(run).iter().all(&tells)).count();
    (silent > 0).then(|| {
        format!(
            "{what}: {silent} of {} without a record of it (older than the field)",
            counted(runs.len(), "run")
        )
    })
}

/// What results of the paper's own protocols lack for being the paper's: its methods and environments without
/// an evaluation, in a line each, and its ablations. Nothing of results of other protocols, which owe the
/// paper nothing, nor of a part of results.
fn of_the_paper(analysis: &Analysis<'_>) -> Vec<String> {
    let options = analysis.options;
    if !options.environments.is_empty() || !options.curricula.is_empty() {
        return Vec::new();
    }
    let was_run =
        |protocol: &&PaperProtocol| analysis.protocols.iter().any(|copy| copy.name == protocol.name);
    let of_it: Vec<&PaperProtocol> = analysis.paper().protocols.iter().filter(was_run).collect();
    let mut lacking = Vec::new();
    if of_it.iter().any(|protocol| protocol.comparison) {
        lacking.extend(comparison(&analysis.groups.all, analysis.catalogue()));
    }
    for (axis, ablations) in analysis.paper().axes.iter().zip(&analysis.ablations) {
        if ablations.is_empty() && of_it.iter().any(|protocol| protocol.axes.contains(&axis.id)) {
            let field = axis.pointer.trim_start_matches('/').replace('/', ".");
            lacking.push(format!("{} of the paper: no variants differ in {field} alone", axis.source));
        }
    }
    lacking
}

/// The paper's methods and environments that `all` has no evaluation of, in a line each.
fn comparison(all: &[Group<'_>], catalogue: &Catalogue) -> Vec<String> {
    let paper = &catalogue.paper;
    let has_method = |id: &str| all.iter().any(|group| group.key.is_of(id));
    let methods = paper.methods().filter(|id| !has_method(id)).map(|id| catalogue.title(id)).collect();
    let has_task = |names: &[String]| all.iter().any(|group| names.contains(&group.key.environment));
    let lacking = paper.tasks.iter().filter(|names| !has_task(names));
    let tasks = lacking.filter_map(|names| names.first().cloned()).collect();
    let line = |what: &str, names: Vec<String>| {
        (!names.is_empty())
            .then(|| format!("no evaluation of these {what} of the paper: {}", names.join(", ")))
    };
    line("methods", methods).into_iter().chain(line("environments", tasks)).collect()
}
