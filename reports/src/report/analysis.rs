//! What figures, tables and the page are made of, computed once.

use std::path::Path;

use rayon::prelude::*;

use super::Options;
use crate::analysis::ablation::{self, AXES, Ablation};
use crate::analysis::aggregate::{Aggregate, FEWEST_SHARED, Profile, Shared};
use crate::analysis::comparison::{self, Comparison};
use crate::analysis::complete;
use crate::analysis::curves::Curve;
use crate::analysis::efficiency::{self, Efficiency};
use crate::analysis::finals::Finals;
use crate::analysis::group::{self, Group, GroupKey};
use crate::analysis::heat::HeatMap;
use crate::analysis::improvement::{self, Improvement};
use crate::analysis::ledger::{self, Entry};
use crate::analysis::readings::Readings;
use crate::analysis::summary::Row;
use crate::analysis::teaching;
use crate::environment::MazeInfo;
use crate::store::problem::Problem;
use crate::store::{self, Store};

/// Which groups there are, and which of them stand for their method. Everything else borrows from it.
pub(super) struct Groups<'a> {
    pub(super) all: Vec<Group<'a>>,
    /// One answer per group: [`group::compared`].
    pub(super) compared: Vec<bool>,
    /// Of those that stand for their method, the runs that may be compared with each other.
    pub(super) comparable: Vec<Group<'a>>,
    /// Their final scores.
    pub(super) finals: Vec<Finals>,
    pub(super) curves: Vec<Curve>,
}

impl<'a> Groups<'a> {
    pub(super) fn of(store: &'a Store, options: &Options) -> Self {
        let all = group::groups(store);
        let keys: Vec<&GroupKey> = all.iter().map(|group| &group.key).collect();
        let compared = group::compared(&keys);
        let chosen: Vec<&Group<'_>> =
            all.iter().zip(&compared).filter(|(_, compared)| **compared).map(|(group, _)| group).collect();
        let comparable = complete::comparable(&chosen);
        Self {
            compared,
            finals: comparable.iter().map(|group| Finals::of(group, options.window)).collect(),
            comparable,
            curves: all.iter().map(Curve::of).collect(),
            all,
        }
    }

    /// Those of `items`, one per group, whose group stands for its method.
    fn chosen<'b, T>(&self, items: &'b [T]) -> Vec<&'b T> {
        items.iter().zip(&self.compared).filter(|(_, compared)| **compared).map(|(item, _)| item).collect()
    }

    pub(super) fn compared_groups(&self) -> Vec<&Group<'a>> {
        self.chosen(&self.all)
    }

    /// The groups that are variants of a method: ablations of it.
    pub(super) fn variant_groups(&self) -> Vec<&Group<'a>> {
        self.all
            .iter()
            .zip(&self.compared)
            .filter(|(_, compared)| !**compared)
            .map(|(group, _)| group)
            .collect()
    }

    /// Runs that stand for their method and may not be compared.
    pub(super) fn left_out(&self) -> usize {
        let count = |groups: &[&Group<'_>]| groups.iter().map(|group| group.runs.len()).sum::<usize>();
        count(&self.compared_groups()) - count(&self.comparable.iter().collect::<Vec<_>>())
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
#[derive(Default)]
pub(super) struct Across<'a> {
    pub(super) environments: Vec<&'a str>,
    /// Methods that lack too many environments.
    pub(super) left_out: Vec<&'a GroupKey>,
    pub(super) aggregates: Vec<Aggregate<'a>>,
    pub(super) profiles: Vec<Profile<'a>>,
    pub(super) improvements: Vec<Improvement<'a>>,
    pub(super) efficiency: Vec<Efficiency<'a>>,
}

impl<'a> Across<'a> {
    fn of(groups: &'a Groups<'_>, options: &Options) -> Self {
        let shared = Shared::of(&groups.finals);
        if shared.environments.len() < FEWEST_SHARED {
            return Self::default();
        }
        let Options { window, resampling, .. } = *options;
        let is_kept = |group: &&Group<'_>| {
            shared.methods().iter().any(|(method, _)| method.cmp_method(&group.key).is_eq())
        };
        let kept: Vec<_> = groups.comparable.iter().filter(is_kept).collect();
        Self {
            aggregates: shared.aggregates(resampling),
            profiles: shared.profiles(resampling),
            improvements: improvement::improvements(&groups.finals.iter().collect::<Vec<_>>(), resampling),
            efficiency: efficiency::curves(&kept, &shared.environments, window, resampling),
            environments: shared.environments,
            left_out: shared.left_out,
        }
    }
}

/// What the files of what teachers did say: they are read in mazes alone.
#[derive(Default)]
pub(super) struct Heat<'a> {
    /// Mazes with at least one heat map.
    pub(super) mazes: Vec<MazeHeat<'a>>,
    /// What is wrong with these files.
    pub(super) problems: Vec<Problem>,
}

/// Heat maps of one maze.
pub(super) struct MazeHeat<'a> {
    pub(super) maze: &'a MazeInfo,
    pub(super) maps: Vec<HeatMap>,
}

/// All results of all computations.
pub(super) struct Analysis<'a> {
    pub(super) rows: Vec<Row>,
    /// What teachers picked, for every group; empty where none of them tells.
    pub(super) teaching: Vec<teaching::Row>,
    pub(super) across: Across<'a>,
    pub(super) comparisons: Vec<Comparison<'a>>,
    /// Ablations of every axis of [`AXES`], in its order.
    pub(super) ablations: Vec<Vec<Ablation<'a>>>,
    pub(super) ledger: Vec<Entry>,
    /// The ledger's claims about baselines under every reading of the paper; empty without a family of two.
    pub(super) readings: Readings,
    pub(super) heat: Heat<'a>,
}

impl<'a> Analysis<'a> {
    pub(super) fn of(results: &Path, groups: &'a Groups<'_>, options: &'a Options) -> Self {
        let Options { window, resampling, .. } = *options;
        let rows = groups.all.par_iter().filter_map(|group| Row::of(group, window, resampling)).collect();
        let mut teaching: Vec<_> = groups.all.iter().map(teaching::Row::of).collect();
        if !teaching.iter().any(teaching::Row::tells) {
            teaching.clear();
        }
        Self {
            rows,
            teaching,
            across: Across::of(groups, options),
            comparisons: comparison::comparisons(&groups.all, &groups.compared, window, resampling),
            ablations: AXES.iter().map(|axis| ablation::ablations(&groups.all, axis)).collect(),
            ledger: ledger::ledger(&groups.all, window, resampling),
            readings: Readings::of(&groups.all, window, resampling),
            heat: heat(results, groups, options),
        }
    }
}

/// Heat maps of the compared groups of every maze. What teachers did is read here, run by run, and counted at once:
/// all of it together would not be small.
fn heat<'a>(results: &Path, groups: &Groups<'_>, options: &'a Options) -> Heat<'a> {
    let mut heat = Heat::default();
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
            heat.problems.extend(read.into_iter().flat_map(|(_, problems)| problems));
        }
        if !maps.is_empty() {
            heat.mazes.push(MazeHeat { maze, maps });
        }
    }
    heat
}
