//! How long a plan would take on this machine: a few cycles of every kind of cohort, measured now. A run
//! alone is a cohort of one.

mod measure;

use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

use serde::{Deserialize, Serialize};

use crate::config::RunConfig;
use crate::error::HarnessError;
use crate::protocol::plan::PlannedRun;
use crate::run::manifest::manifest;
use crate::sweep::errand::{self, Errand};
use measure::{Measurement, Subject};

pub use measure::measure_runs;

/// What a run takes of its worker's clock: alone all of it, in a cohort its share.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Speed {
    /// Seconds per training step: physics, student and teacher.
    pub per_step: f64,
    /// Seconds per evaluation episode.
    pub per_episode: f64,
}

impl Speed {
    /// Seconds that a run takes: its training steps, and the episodes of its evaluations, of which one comes
    /// before training, and of its measures of the frontier.
    pub fn of_run(&self, config: &RunConfig) -> f64 {
        let RunConfig { budget, evaluation, frontier, pool, .. } = config;
        let evaluations = budget.steps.div_ceil(evaluation.every.max(1));
        let episodes = (1 + evaluations) * evaluation.episodes;
        let measured = frontier.all_episodes(evaluations, pool.size as u64);
        self.per_step * budget.steps as f64 + self.per_episode * (episodes as f64 + measured as f64)
    }

    /// The mean of several; `None` of none.
    fn mean(speeds: &[Self]) -> Option<Self> {
        let count = speeds.len() as f64;
        let of = |field: fn(&Self) -> f64| speeds.iter().map(field).sum::<f64>() / count;
        (count > 0.0)
            .then(|| Self { per_step: of(|one| one.per_step), per_episode: of(|one| one.per_episode) })
    }
}

/// Which cohorts are as fast as each other: those whose lanes are of one environment and have the same
/// curricula and students. A curriculum's own options hardly change what it costs.
type Kind = (String, String, String);

fn kind(cohort: &[PlannedRun]) -> Kind {
    let student =
        |run: &PlannedRun| serde_json::to_string(&run.config.student).expect("a config is plain data");
    let mut curricula: Vec<&str> = cohort.iter().map(|run| run.key.curriculum.as_str()).collect();
    curricula.sort_unstable();
    let students: BTreeSet<String> = cohort.iter().map(student).collect();
    let environment = cohort.first().map_or_else(String::new, |run| run.key.environment.clone());
    (environment, curricula.join(" "), students.into_iter().collect())
}

/// How cohorts are measured: as a sweep would carry them out.
#[derive(Clone, Copy, Debug)]
pub struct Pace {
    /// Cohorts side by side.
    pub workers: usize,
    /// Threads of each, at most.
    pub threads: usize,
    /// How long that may take.
    pub patience: Duration,
}

/// Estimates of cohorts, from the speed of their kinds.
pub struct Estimates(BTreeMap<Kind, Speed>);

impl Estimates {
    /// Number of kinds among `cohorts`.
    pub fn kinds(cohorts: &[Vec<PlannedRun>]) -> usize {
        in_order(cohorts).len()
    }

    /// Measures the kinds among `cohorts`: all of them, or as many as come through in time.
    ///
    /// # Errors
    /// [`HarnessError::Trial`] naming a run that cannot be carried out here, [`HarnessError::Io`] if this
    /// program cannot be started a second time.
    pub fn measure(cohorts: &[Vec<PlannedRun>], pace: Pace) -> Result<Self, HarnessError> {
        let kinds = in_order(cohorts);
        let subjects: Vec<Subject> = kinds
            .iter()
            .enumerate()
            .map(|(index, (_, runs))| Subject { index, manifests: runs.iter().map(manifest).collect() })
            .collect();
        let Pace { workers, threads, patience } = pace;
        let arguments = ["measure-runs".to_owned(), workers.to_string(), threads.to_string()];
        let Errand { answers, .. } = errand::ask::<Measurement>(&arguments, &subjects, patience)?;
        let measured = answers.into_iter().map(|Measurement { index, speed }| {
            let speed = speed.map_err(|reason| HarnessError::Trial { reason })?;
            Ok((kinds[index].0.clone(), speed))
        });
        measured.collect::<Result<_, _>>().map(Self)
    }

    /// Number of kinds that were measured.
    pub fn measured(&self) -> usize {
        self.0.len()
    }

    /// Seconds that `cohort` takes from its beginning, by the clock of its worker. If its kind was not
    /// measured, it counts as fast as those most like it: of the same environment and curricula, of either,
    /// or all. `None` if none was measured.
    pub fn seconds(&self, cohort: &[PlannedRun]) -> Option<f64> {
        let wanted = kind(cohort);
        let like = |is_like: &dyn Fn(&Kind) -> bool| {
            let speeds: Vec<Speed> =
                self.0.iter().filter(|(kind, _)| is_like(kind)).map(|(_, speed)| *speed).collect();
            Speed::mean(&speeds)
        };
        let same_environment = |kind: &Kind| kind.0 == wanted.0;
        let same_curricula = |kind: &Kind| kind.1 == wanted.1;
        let speed = (self.0.get(&wanted).copied())
            .or_else(|| like(&|kind| same_environment(kind) && same_curricula(kind)))
            .or_else(|| like(&same_environment))
            .or_else(|| like(&same_curricula))
            .or_else(|| like(&|_| true))?;
        Some(cohort.iter().map(|run| speed.of_run(&run.config)).sum())
    }
}

/// The kinds among `cohorts`, with the first cohort of each: one of every environment and its curricula
/// first, then a second of each, and so on, so that those measured first stand for all.
fn in_order(cohorts: &[Vec<PlannedRun>]) -> Vec<(Kind, &[PlannedRun])> {
    let mut kinds: BTreeMap<Kind, &[PlannedRun]> = BTreeMap::new();
    for cohort in cohorts {
        kinds.entry(kind(cohort)).or_insert(cohort);
    }
    let mut seen: BTreeMap<(String, String), usize> = BTreeMap::new();
    let mut ranked: Vec<(usize, (Kind, &[PlannedRun]))> = kinds
        .into_iter()
        .map(|(kind, cohort)| {
            let before = seen.entry((kind.0.clone(), kind.1.clone())).or_default();
            *before += 1;
            (*before, (kind, cohort))
        })
        .collect();
    ranked.sort_by_key(|(rank, _)| *rank);
    ranked.into_iter().map(|(_, kind)| kind).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::frontier::FrontierOptions;

    /// A run of an environment and a curriculum with a student of this width.
    fn planned(environment: &str, curriculum: &str, width: usize) -> PlannedRun {
        let registry = crate::Registry::builtin();
        let mut protocol = crate::protocol::Protocol::from_options();
        protocol.environments = vec![environment.into()];
        protocol.curricula = vec![curriculum.into()];
        let layer =
            crate::config::layer::ConfigLayer::from_assignment("--set", &format!("student.width={width}"));
        protocol.set(layer.expect("sound"));
        crate::protocol::plan::Plan::new(&protocol, &registry).expect("sound").runs.remove(0)
    }

    #[test]
    fn those_measured_first_stand_for_all() {
        let runs = [
            planned("Point", "teach", 8),
            planned("Point", "teach", 16),
            planned("Point", "teach", 16),
            planned("MazeA", "teach", 8),
            planned("Point", "vds", 8),
        ]
        .map(|run| vec![run]);
        assert_eq!(in_order(&runs).len(), 4);
        let first: std::collections::BTreeSet<(String, String)> =
            in_order(&runs)[..3].iter().map(|(kind, _)| (kind.0.clone(), kind.1.clone())).collect();
        assert_eq!(first.len(), 3, "each environment and curriculum once");
    }

    #[test]
    fn what_was_not_measured_is_as_fast_as_what_is_most_like_it() {
        let speed = |per_step| Speed { per_step, per_episode: 0.0 };
        let measured =
            [(("Point", "teach", 8), 1.0), (("Point", "vds", 8), 3.0), (("MazeA", "space", 8), 10.0)];
        let measured = measured.map(|((environment, curriculum, width), per_step)| {
            (kind(&[planned(environment, curriculum, width)]), speed(per_step))
        });
        let estimates = Estimates(measured.into_iter().collect());
        let per_step = |environment, curriculum, width| {
            let run = planned(environment, curriculum, width);
            let steps = run.config.budget.steps as f64;
            estimates.seconds(&[run]).expect("some were measured") / steps
        };
        for (found, expected) in [
            (per_step("Point", "teach", 8), 1.0),
            (per_step("Point", "teach", 16), 1.0),
            (per_step("Point", "her-iid", 8), 2.0),
            (per_step("MazeB", "space", 8), 10.0),
            (per_step("MazeB", "her-iid", 8), 14.0 / 3.0),
        ] {
            assert!((found - expected).abs() < 1e-9, "{found} {expected}");
        }
        assert_eq!(Estimates(BTreeMap::new()).seconds(&[planned("Point", "teach", 8)]), None);
    }

    #[test]
    fn a_cohort_is_of_its_lanes_kind_and_takes_what_they_take() {
        let [teach, vds] = ["teach", "vds"].map(|curriculum| planned("Point", curriculum, 8));
        let two = |one: &PlannedRun, other: &PlannedRun| vec![one.clone(), other.clone()];
        assert_eq!(kind(&two(&teach, &vds)), kind(&two(&vds, &teach)));
        assert_ne!(kind(&two(&teach, &vds)), kind(&two(&teach, &teach)));
        assert_ne!(kind(&two(&teach, &teach)), kind(std::slice::from_ref(&teach)));
        let mut short = vds.clone();
        short.config.budget.steps = teach.config.budget.steps / 2;
        let speed = Speed { per_step: 0.5, per_episode: 0.0 };
        let estimates = Estimates([(kind(&two(&teach, &vds)), speed)].into_iter().collect());
        let expected = 0.75 * teach.config.budget.steps as f64;
        assert_eq!(estimates.seconds(&two(&short, &teach)), Some(expected));
    }

    #[test]
    fn a_run_costs_its_steps_and_its_evaluations() {
        let speed = Speed { per_step: 0.001, per_episode: 0.1 };
        let mut config = planned("Point", "teach", 8).config;
        config.budget.steps = 1000;
        config.evaluation.every = 300;
        config.evaluation.episodes = 20;
        // 1000 steps: 1 s. Evaluated at 0, 300, 600, 900 and at the end, 20 episodes each: 5 · 20 · 0.1 = 10
        // s.
        assert!((speed.of_run(&config) - 11.0).abs() < 1e-12);
        // Three episodes for each of 50 goals, measured at 0, 900 and the end: 3 · 50 · 3 · 0.1 = 45 s.
        config.pool.size = 50;
        config.frontier = FrontierOptions { every: 3, episodes: 3 };
        assert!((speed.of_run(&config) - 56.0).abs() < 1e-12);
        // The last evaluation falls on the end: 0, 500, 1000.
        config.frontier = FrontierOptions::default();
        config.evaluation.every = 500;
        assert!((speed.of_run(&config) - 7.0).abs() < 1e-12);
    }
}
