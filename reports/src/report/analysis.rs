//! What figures, tables and the page are made of, computed once.

use std::path::Path;

use rayon::prelude::*;

use super::Options;
use crate::ablation::{self, AXES, Ablation};
use crate::aggregate::{Aggregate, Profile, Shared};
use crate::comparison::{self, Comparison};
use crate::curves::Curve;
use crate::efficiency::{self, Efficiency};
use crate::environment::MazeInfo;
use crate::finals::Finals;
use crate::group::{self, Group, GroupKey};
use crate::heat::HeatMap;
use crate::improvement::{self, Improvement};
use crate::ledger::{self, Entry};
use crate::problem::Problem;
use crate::store::{self, Store};
use crate::summary::Row;

/// Methods are summed up over environments where there are at least this many.
const FEWEST_SHARED: usize = 2;

/// Which groups there are, and which of them stand for their method. Everything else borrows from it.
pub(super) struct Groups<'a> {
    pub(super) all: Vec<Group<'a>>,
    /// One answer per group: [`group::compared`].
    pub(super) compared: Vec<bool>,
    /// Final scores of every group.
    pub(super) finals: Vec<Finals>,
    pub(super) curves: Vec<Curve>,
}

impl<'a> Groups<'a> {
    pub(super) fn of(store: &'a Store, options: &Options) -> Self {
        let all = group::groups(store);
        let keys: Vec<&GroupKey> = all.iter().map(|group| &group.key).collect();
        let compared = group::compared(&keys);
        Self {
            compared,
            finals: all.iter().map(|group| Finals::of(group, options.window)).collect(),
            curves: all.iter().map(Curve::of).collect(),
            all,
        }
    }

    /// Those of `items`, one per group, whose group stands for its method.
    fn chosen<'b, T>(&self, items: &'b [T]) -> Vec<&'b T> {
        items.iter().zip(&self.compared).filter(|(_, compared)| **compared).map(|(item, _)| item).collect()
    }

    /// Final scores of every group but those that repeat the runs of the first of their environment.
    fn distinct_finals(&self) -> Vec<&Finals> {
        let environments = self.all.chunk_by(|a, b| a.key.environment == b.key.environment);
        let is_distinct = environments.flat_map(|groups| {
            groups
                .iter()
                .enumerate()
                .map(|(index, group)| index == 0 || !group::is_repeated(group, &groups[0]))
        });
        self.finals
            .iter()
            .zip(is_distinct)
            .filter(|(_, distinct)| *distinct)
            .map(|(finals, _)| finals)
            .collect()
    }

    pub(super) fn compared_groups(&self) -> Vec<&Group<'a>> {
        self.chosen(&self.all)
    }

    pub(super) fn compared_curves(&self) -> Vec<&Curve> {
        self.chosen(&self.curves)
    }

    /// Keys of all groups, which settle the looks of figures.
    pub(super) fn keys(&self) -> impl Iterator<Item = &GroupKey> {
        self.all.iter().map(|group| &group.key)
    }

    /// Environment ids, in order.
    pub(super) fn environments(&self) -> Vec<&str> {
        let mut ids: Vec<&str> = self.keys().map(|key| key.environment.as_str()).collect();
        ids.dedup();
        ids
    }
}

/// Methods over the environments that all of them share; empty where these are too few.
pub(super) struct Across<'a> {
    pub(super) environments: Vec<&'a str>,
    pub(super) aggregates: Vec<Aggregate<'a>>,
    pub(super) profiles: Vec<Profile<'a>>,
    pub(super) improvements: Vec<Improvement<'a>>,
    pub(super) efficiency: Vec<Efficiency<'a>>,
}

impl<'a> Across<'a> {
    fn of(groups: &'a Groups<'_>, options: &Options) -> Self {
        let shared = Shared::of(groups.chosen(&groups.finals));
        if shared.environments.len() < FEWEST_SHARED {
            return Self {
                environments: Vec::new(),
                aggregates: Vec::new(),
                profiles: Vec::new(),
                improvements: Vec::new(),
                efficiency: Vec::new(),
            };
        }
        let Options { window, resampling, .. } = *options;
        let compared = groups.compared_groups();
        Self {
            aggregates: shared.aggregates(resampling),
            profiles: shared.profiles(resampling),
            improvements: improvement::improvements(&shared, resampling),
            efficiency: efficiency::curves(&compared, &shared.environments, window, resampling),
            environments: shared.environments,
        }
    }
}

/// Heat maps of one maze.
pub(super) struct MazeHeat<'a> {
    pub(super) maze: &'a MazeInfo,
    pub(super) maps: Vec<HeatMap>,
}

/// All results of all computations.
pub(super) struct Analysis<'a> {
    pub(super) rows: Vec<Row>,
    pub(super) across: Across<'a>,
    pub(super) comparisons: Vec<Comparison<'a>>,
    /// Ablations of every axis of [`AXES`], in its order.
    pub(super) ablations: Vec<Vec<Ablation<'a>>>,
    pub(super) ledger: Vec<Entry>,
    /// Mazes with at least one heat map.
    pub(super) heat: Vec<MazeHeat<'a>>,
    /// What is wrong with the files that heat maps are made of.
    pub(super) heat_problems: Vec<Problem>,
}

impl<'a> Analysis<'a> {
    pub(super) fn of(results: &Path, groups: &'a Groups<'_>, options: &'a Options) -> Self {
        let Options { window, resampling, .. } = *options;
        let rows = groups.all.par_iter().filter_map(|group| Row::of(group, window, resampling)).collect();
        let (heat, heat_problems) = heat(results, groups, options);
        Self {
            rows,
            across: Across::of(groups, options),
            comparisons: comparison::comparisons(&groups.distinct_finals(), resampling),
            ablations: AXES.iter().map(|axis| ablation::ablations(&groups.all, axis)).collect(),
            ledger: ledger::ledger(&groups.all, window, resampling),
            heat,
            heat_problems,
        }
    }
}

/// Heat maps of the compared groups of every maze. What teachers did is read here, run by run, and counted at once:
/// all of it together would not be small.
fn heat<'a>(results: &Path, groups: &Groups<'_>, options: &'a Options) -> (Vec<MazeHeat<'a>>, Vec<Problem>) {
    let mut problems = Vec::new();
    let mut heats = Vec::new();
    for maze in &options.mazes {
        let mut maps = Vec::new();
        for group in groups.compared_groups() {
            if group.key.environment != maze.id {
                continue;
            }
            let read: Vec<_> = group.runs.par_iter().map(|run| store::teaching(results, run)).collect();
            let last = group.runs.iter().filter_map(|run| run.records.last()).map(|record| record.step).max();
            let lines = read.iter().flat_map(|(lines, _)| lines);
            maps.extend(HeatMap::of(&group.key, maze, last.unwrap_or(0), lines));
            problems.extend(read.into_iter().flat_map(|(_, problems)| problems));
        }
        if !maps.is_empty() {
            heats.push(MazeHeat { maze, maps });
        }
    }
    (heats, problems)
}
