//! What a search over the settings of curricula was worth: the chosen settings against the default ones on
//! fresh seeds, and how much trials differ from each other.
//!
//! The runs of the search lie in a results folder of their own and no group holds them: what is read here is
//! the file of the choice.

pub mod choose;

use std::path::Path;

use crate::analysis::complete::Pair;
use crate::analysis::group::{Group, GroupKey};
use crate::analysis::groups::Groups;
use crate::analysis::options::ReportOptions;
use crate::analysis::paired::{self, PairedDifference};
use crate::schema::{TrialPlace, TrialScore, TunedCurriculum, Tuning};
use crate::stats::{self, Ddof};
use crate::store;
use crate::store::problem::StoreProblem;
use choose::measured;

/// Variant of the runs with the chosen settings.
pub const TUNED: &str = "tuned";
/// Variant of the runs with the default settings.
pub const DEFAULT: &str = "default";

/// The search of a results folder.
#[derive(Debug, Default)]
pub struct TuningFile {
    /// What it chose; `None` without one.
    pub tuning: Option<Tuning>,
    /// Whether there are trials and no choice yet.
    pub is_open: bool,
    /// What is wrong with its file.
    pub problems: Vec<StoreProblem>,
}

/// The search of one curriculum in one environment.
#[derive(Clone, Debug, PartialEq)]
pub struct TunedPlace<'a> {
    /// Environment and curriculum; the variant is the default.
    pub key: GroupKey,
    /// What was tried.
    pub tried: &'a TunedCurriculum,
    /// The default settings on fresh seeds.
    pub default: Option<FreshScores>,
    /// The chosen ones; `None` where these are the default ones, or have no runs yet.
    pub tuned: Option<FreshScores>,
    /// Chosen less default, over the seeds that both have.
    pub difference: Option<PairedDifference>,
}

/// Scores of runs that no settings were chosen by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreshScores {
    /// Runs.
    pub n: usize,
    /// The mean over seeds of the measure of the search.
    pub mean: f64,
    /// Its standard deviation over seeds; `None` for one.
    pub std: Option<f64>,
}

impl TuningFile {
    /// That of the results folder `results`.
    pub fn of(results: &Path) -> Self {
        let (tuning, problems) = store::tuning(results);
        let is_open = tuning.is_none() && problems.is_empty() && store::has_trials(results);
        Self { tuning, is_open, problems }
    }

    /// The search of every curriculum in every environment that the report is about, in the order of tables.
    pub fn places<'a>(&'a self, groups: &Groups<'_>, options: &ReportOptions) -> Vec<TunedPlace<'a>> {
        let Some(tuning) = &self.tuning else { return Vec::new() };
        let is_among = |names: &[String], id: &String| names.is_empty() || names.contains(id);
        let environments = tuning.environments.iter().filter(|id| is_among(&options.environments, id));
        let mut places: Vec<TunedPlace<'a>> = environments
            .flat_map(|environment| {
                let curricula = tuning.curricula.iter();
                curricula
                    .filter(|one| is_among(&options.curricula, &one.curriculum))
                    .map(|one| TunedPlace::of(environment, one, tuning, groups, options))
            })
            .collect();
        places.sort_by(|a, b| a.key.cmp(&b.key));
        places
    }
}

impl<'a> TunedPlace<'a> {
    fn of(
        environment: &str,
        tried: &'a TunedCurriculum,
        tuning: &Tuning,
        groups: &Groups<'_>,
        options: &ReportOptions,
    ) -> Self {
        let of = |variant: &str| {
            groups.all.iter().find(|group| {
                group.is_own()
                    && group.key.environment == environment
                    && group.key.is_of(&tried.curriculum)
                    && group.key.variant == variant
            })
        };
        let by_seed = |group: &Group<'_>| -> Vec<(u64, f64)> {
            let score = |run: &&crate::store::Run| {
                Some((run.key().seed, measured(run, tuning.measure, options.window)?))
            };
            group.runs.iter().filter_map(score).collect()
        };
        let key = GroupKey::new(&options.catalogue, environment, &tried.curriculum, DEFAULT);
        let (default, tuned) = (of(DEFAULT), of(TUNED).filter(|_| tried.chosen != DEFAULT));
        let Some((default, tuned)) = default.zip(tuned) else {
            let alone = default.map(|group| Pair::of(group, group).a);
            let default = alone.and_then(|group| FreshScores::of(&by_seed(&group)));
            return Self { key, tried, default, tuned: None, difference: None };
        };
        // Only runs of the same evaluations may be compared.
        let pair = Pair::of(tuned, default);
        let (tuned, default) = (by_seed(&pair.a), by_seed(&pair.b));
        let difference = PairedDifference::of(&paired::pairs(&tuned, &default), options);
        let (default, tuned) = (FreshScores::of(&default), FreshScores::of(&tuned));
        Self { key, tried, default, tuned, difference }
    }

    /// The default settings on the seeds of the search.
    pub fn on_search_seeds(&self) -> Option<&'a TrialPlace> {
        self.tried.untuned()?.place(&self.key.environment)
    }

    /// Scores of the drawn settings in this environment, on the seeds of the search; in order.
    pub fn drawn(&self) -> Vec<f64> {
        let place = |trial: &TrialScore| Some(trial.place(&self.key.environment)?.score);
        self.tried.drawn().iter().filter_map(place).collect()
    }

    /// The place of the chosen ones among these; `None` where they are the default ones.
    pub fn chosen(&self) -> Option<usize> {
        self.tried.drawn().iter().position(|trial| trial.variant == self.tried.chosen)
    }

    /// Lowest, median and highest score of the drawn settings; `None` of none.
    pub fn spread(&self) -> Option<[f64; 3]> {
        let drawn = self.drawn();
        let quantile = |share: f64| stats::quantile(&drawn, share);
        Some([quantile(0.0)?, quantile(0.5)?, quantile(1.0)?])
    }

    /// Share of the drawn settings with a higher score than the default ones.
    pub fn share_better(&self) -> Option<f64> {
        let default = self.on_search_seeds()?.score;
        let drawn = self.drawn();
        let better = drawn.iter().filter(|score| **score > default).count();
        (!drawn.is_empty()).then(|| better as f64 / drawn.len() as f64)
    }

    /// Steps that the search took in this environment, those of the default settings included.
    pub fn steps(&self) -> u64 {
        let here = |trial: &TrialScore| trial.place(&self.key.environment).map(|place| place.steps);
        self.tried.tried.iter().filter_map(here).sum()
    }
}

impl FreshScores {
    fn of(by_seed: &[(u64, f64)]) -> Option<Self> {
        let scores: Vec<f64> = by_seed.iter().map(|(_, score)| *score).collect();
        Some(Self {
            n: scores.len(),
            mean: stats::mean(&scores)?,
            std: stats::std_dev(&scores, Ddof::Sample),
        })
    }
}
