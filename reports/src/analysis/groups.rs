//! The groups of a report, and which of them stand for their method.

use crate::analysis::complete;
use crate::analysis::curves::Curve;
use crate::analysis::finals::Finals;
use crate::analysis::group::{self, Group, GroupKey};
use crate::analysis::options::ReportOptions;
use crate::store::{Run, Store};

/// Which groups there are, and which of them stand for their method. Everything else borrows from it.
#[derive(Debug)]
pub struct Groups<'a> {
    /// All of them, in order.
    pub all: Vec<Group<'a>>,
    /// One answer per group: [`group::compared`].
    pub compared: Vec<bool>,
    /// Of those that stand for their method, the runs that may be compared with each other.
    pub comparable: Vec<Group<'a>>,
    /// Their final scores.
    pub finals: Vec<Finals>,
    /// Learning curves of all groups.
    pub curves: Vec<Curve>,
}

impl<'a> Groups<'a> {
    /// The groups of all runs; those of `completed`, which failed, as they count
    /// ([`complete::failed_as_zero`]).
    pub fn of(store: &'a Store, completed: &'a [Run], options: &ReportOptions) -> Self {
        let all = group::counted(store, completed, &options.catalogue);
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

    /// The groups that stand for their method.
    pub fn compared_groups(&self) -> Vec<&Group<'a>> {
        self.chosen(&self.all)
    }

    /// The groups that are variants of a method: ablations of it.
    pub fn variant_groups(&self) -> Vec<&Group<'a>> {
        self.all
            .iter()
            .zip(&self.compared)
            .filter(|(_, compared)| !**compared)
            .map(|(group, _)| group)
            .collect()
    }

    /// Runs that stand for their method and may not be compared.
    pub fn left_out(&self) -> usize {
        let count = |groups: &[&Group<'_>]| groups.iter().map(|group| group.runs.len()).sum::<usize>();
        count(&self.compared_groups()) - count(&self.comparable.iter().collect::<Vec<_>>())
    }

    /// Runs that stand for their method, failed, and count 0 from their failure on.
    pub fn failed(&self) -> usize {
        self.comparable.iter().map(Group::failed).sum()
    }

    /// The learning curves of these.
    pub fn compared_curves(&self) -> Vec<&Curve> {
        self.chosen(&self.curves)
    }

    /// Keys of all groups, which settle the looks of figures.
    pub fn keys(&self) -> impl Iterator<Item = &GroupKey> {
        self.all.iter().map(|group| &group.key)
    }

    /// Environment ids, in order.
    pub fn environments(&self) -> Vec<&str> {
        let mut ids: Vec<&str> = self.keys().map(|key| key.environment.as_str()).collect();
        ids.dedup();
        ids
    }
}
