//! Everything that the figures and tables of a report are made of, computed once.

use std::path::Path;

use rayon::prelude::*;

use crate::analysis::ablation::{self, Ablation};
use crate::analysis::aggregate::{Aggregate, FEWEST_SHARED, Profile, Shared};
use crate::analysis::catalogue::{Catalogue, Paper};
use crate::analysis::comparison::{self, Comparison};
use crate::analysis::efficiency::{self, Efficiency};
use crate::analysis::film::Films;
use crate::analysis::frontier::FrontierFiles;
use crate::analysis::goal_map::GoalSpaces;
use crate::analysis::group::{Group, GroupKey};
use crate::analysis::groups::Groups;
use crate::analysis::heat::Heat;
use crate::analysis::improvement::{self, Improvement};
use crate::analysis::ledger::{self, LedgerEntry};
use crate::analysis::options::ReportOptions;
use crate::analysis::ranks::{self, RankMap};
use crate::analysis::readings::Readings;
use crate::analysis::shadow::ShadowFiles;
use crate::analysis::student::StudentFiles;
use crate::analysis::summary::GroupSummary;
use crate::analysis::teaching::PickSummary;
use crate::analysis::tuning::TuningFile;
use crate::store::Store;
use crate::store::problem::StoreProblem;
use crate::store::protocols::ProtocolCopy;

/// The results, and all that is computed from them for more than one figure or table.
#[derive(Debug)]
pub struct Analysis<'a> {
    /// The results.
    pub store: &'a Store,
    /// The protocols that they were made by, as far as they are known.
    pub protocols: &'a [ProtocolCopy],
    /// How the report is made.
    pub options: &'a ReportOptions,
    /// The runs by what they have in common.
    pub groups: &'a Groups<'a>,
    /// The numbers of every group.
    pub summaries: Vec<GroupSummary>,
    /// What teachers picked, for every group; empty where none of them tells.
    pub picks: Vec<PickSummary>,
    /// Sums over environments.
    pub across: Across<'a>,
    /// Methods and variants against their references.
    pub comparisons: Vec<Comparison<'a>>,
    /// Ablations of every axis of the paper, in its order.
    pub ablations: Vec<Vec<Ablation<'a>>>,
    /// The paper's claims, on its tasks.
    pub ledger: Vec<LedgerEntry>,
    /// The same claims on other environments, where there are any.
    pub ledger_elsewhere: Vec<LedgerEntry>,
    /// The ledger's claims about baselines under every reading of the paper; empty without a family of two.
    pub readings: Readings,
    /// What teachers did in mazes.
    pub heat: Heat<'a>,
    /// Where teachers sent students in tasks whose goals are points in space.
    pub goals: GoalSpaces,
    /// The same of single runs, slice by slice.
    pub films: Films<'a>,
    /// Which places of their orderings teachers trained on there.
    pub ranks: Vec<RankMap>,
    /// How students learned.
    pub student: StudentFiles,
    /// What students could do at every goal of their pools, where that was measured.
    pub frontier: FrontierFiles,
    /// What teachers that watched would have done.
    pub shadow: ShadowFiles,
    /// What a search over settings chose.
    pub tuning: TuningFile,
}

impl<'a> Analysis<'a> {
    /// The analysis of the results folder `results`, which `store` holds and `groups` are of, made by
    /// `protocols`.
    pub fn of(
        results: &Path,
        (store, protocols): (&'a Store, &'a [ProtocolCopy]),
        groups: &'a Groups<'a>,
        options: &'a ReportOptions,
    ) -> Self {
        let ReportOptions { window, resampling, ref catalogue, .. } = *options;
        let summary = |group: &Group<'_>| GroupSummary::of(group, window, resampling);
        let mut picks: Vec<_> = groups.all.iter().map(PickSummary::of).collect();
        if !picks.iter().any(PickSummary::tells) {
            picks.clear();
        }
        let axes = &catalogue.paper.axes;
        let frontier = FrontierFiles::of(results, store);
        let goals = GoalSpaces::of(results, groups, &catalogue.environments);
        let mazes = catalogue.mazes.iter().map(|maze| maze.id.as_str());
        let spaces = goals.environments.iter().map(|space| space.environment.as_str());
        let worlds: Vec<&str> = mazes.chain(spaces).collect();
        Self {
            store,
            protocols,
            options,
            groups,
            summaries: groups.all.par_iter().filter_map(summary).collect(),
            picks,
            across: Across::of(groups, options),
            comparisons: comparison::comparisons(&groups.all, &groups.compared, options),
            ablations: axes.iter().map(|axis| ablation::ablations(&groups.all, axis)).collect(),
            ledger: ledger::ledger(&groups.all, options),
            ledger_elsewhere: ledger::ledger_elsewhere(&groups.all, options),
            readings: Readings::of(&groups.all, options),
            heat: Heat::of(results, groups, &catalogue.mazes),
            films: Films::of(results, groups, catalogue, (&goals, &frontier)),
            ranks: ranks::maps(results, groups, &worlds),
            goals,
            student: StudentFiles::of(results, store),
            shadow: ShadowFiles::of(results, store, &frontier),
            frontier,
            tuning: TuningFile::of(results),
        }
    }

    /// What is wrong with files beside the records, as far as they were read.
    pub fn problems(&self) -> impl Iterator<Item = &StoreProblem> {
        let read = [
            &self.heat.problems,
            &self.goals.problems,
            &self.student.problems,
            &self.frontier.problems,
            &self.shadow.problems,
            &self.tuning.problems,
        ];
        read.into_iter().flatten()
    }

    /// What is known of methods and environments.
    pub fn catalogue(&self) -> &'a Catalogue {
        &self.options.catalogue
    }

    /// The paper that the results are set against.
    pub fn paper(&self) -> &'a Paper {
        &self.options.catalogue.paper
    }
}

/// Methods over the environments that all of them share; empty where these are too few.
#[derive(Debug, Default)]
pub struct Across<'a> {
    /// These environments, by id.
    pub environments: Vec<&'a str>,
    /// Which seeds of them count, in words ([`Shared::said`]).
    pub seeds: String,
    /// Fewest runs of a method in one of them.
    pub fewest_runs: usize,
    /// Runs of all methods that count although they failed.
    pub failed: usize,
    /// Methods that lack too many environments.
    pub left_out: Vec<&'a GroupKey>,
    /// Sums of final scores.
    pub aggregates: Vec<Aggregate<'a>>,
    /// Performance profiles.
    pub profiles: Vec<Profile<'a>>,
    /// The first method against each other one.
    pub improvements: Vec<Improvement<'a>>,
    /// Sample efficiency.
    pub efficiency: Vec<Efficiency<'a>>,
}

impl<'a> Across<'a> {
    fn of(groups: &'a Groups<'_>, options: &ReportOptions) -> Self {
        let shared = Shared::of(&groups.finals);
        if shared.environments.len() < FEWEST_SHARED {
            return Self::default();
        }
        let resampling = options.resampling;
        let groups_of_methods: Vec<&Group<'_>> = groups.comparable.iter().collect();
        Self {
            seeds: shared.said(),
            fewest_runs: shared.fewest_runs(),
            failed: shared.failed(),
            aggregates: shared.aggregates(resampling),
            profiles: shared.profiles(resampling),
            improvements: improvement::improvements(&groups.finals.iter().collect::<Vec<_>>(), resampling),
            efficiency: efficiency::curves(&groups_of_methods, &shared, resampling),
            environments: shared.environments,
            left_out: shared.left_out,
        }
    }
}
