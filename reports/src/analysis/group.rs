//! Runs that differ only in their seed.

use std::cmp::Ordering;
use std::sync::Arc;

use crate::analysis::catalogue::{Catalogue, MethodInfo, natural_order};
use crate::analysis::complete;
use crate::schema::{Record, RunKey};
use crate::store::{Run, Store};

/// What the runs of a group have in common.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GroupKey {
    /// Environment id.
    pub environment: String,
    /// The method.
    pub curriculum: Arc<MethodInfo>,
    /// Variant label.
    pub variant: String,
}

impl GroupKey {
    /// The key of these runs, with the method as `catalogue` has it.
    pub fn new(catalogue: &Catalogue, environment: &str, curriculum: &str, variant: &str) -> Self {
        Self {
            environment: environment.to_owned(),
            curriculum: catalogue.method(curriculum),
            variant: variant.to_owned(),
        }
    }

    /// The key of the group that `run` is in.
    pub fn of(catalogue: &Catalogue, run: &Run) -> Self {
        let RunKey { environment, variant, .. } = run.key();
        let (environment, variant) = (environment.clone(), variant.clone());
        Self { environment, curriculum: catalogue.method_of(&run.manifest), variant }
    }

    /// Whether it has the method with this curriculum id.
    pub fn is_of(&self, curriculum: &str) -> bool {
        self.curriculum.id == curriculum
    }

    /// `NOVA (n=3)`: the curriculum's name, and what tells its variants apart.
    pub fn name(&self) -> String {
        format!("{}{}", self.curriculum.title, self.detail())
    }

    /// What follows the curriculum's name where curves are told apart: the variant in brackets, or nothing
    /// for `default`.
    pub fn detail(&self) -> String {
        if self.variant == "default" { String::new() } else { format!(" ({})", self.variant) }
    }

    /// Order of curves within one environment: by curriculum as in the [`Catalogue`], then by variant
    /// (`default` first, `n=3` before `n=10`).
    pub fn cmp_method(&self, other: &Self) -> Ordering {
        let is_special = |key: &Self| key.variant != "default";
        self.curriculum
            .cmp(&other.curriculum)
            .then_with(|| is_special(self).cmp(&is_special(other)))
            .then_with(|| natural_order(&self.variant, &other.variant))
    }
}

/// Order of groups everywhere: by environment, then as [`GroupKey::cmp_method`].
impl Ord for GroupKey {
    fn cmp(&self, other: &Self) -> Ordering {
        natural_order(&self.environment, &other.environment).then_with(|| self.cmp_method(other))
    }
}

impl PartialOrd for GroupKey {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// The runs of one environment, curriculum and variant: one per seed.
#[derive(Clone, Debug)]
pub struct Group<'a> {
    /// What they have in common.
    pub key: GroupKey,
    /// Runs with at least one evaluation, by rising seed; empty only where
    /// [`complete::comparable`] cut all of them.
    pub runs: Vec<&'a Run>,
}

/// Whether `a` and `b` are the same runs under two labels: the same evaluations for every seed that both
/// have, which is at least one; success at any step counts where both tell it. Two settings that come to the
/// same in the method (such as two Δ within one cycle of learning) give such groups.
pub fn is_repeated(a: &Group<'_>, b: &Group<'_>) -> bool {
    let any = |record: &Record, other: &Record| {
        record.any_success_rate.filter(|_| other.any_success_rate.is_some())
    };
    let same_evaluation = |(a, b): (&Record, &Record)| {
        (a.step, a.success_rate, a.mean_return, a.gradient_steps, any(a, b))
            == (b.step, b.success_rate, b.mean_return, b.gradient_steps, any(b, a))
    };
    let same_run = |(a, b): (&Run, &Run)| {
        a.records.len() == b.records.len() && a.records.iter().zip(&b.records).all(same_evaluation)
    };
    let mut pairs = shared_seeds(a, b).peekable();
    pairs.peek().is_some() && pairs.all(same_run)
}

/// The runs (of `a`, of `b`) of every seed that both have.
pub fn shared_seeds<'a>(a: &Group<'a>, b: &Group<'a>) -> impl Iterator<Item = (&'a Run, &'a Run)> {
    a.runs.iter().filter_map(|run| {
        let other = b.runs.iter().find(|other| other.key().seed == run.key().seed)?;
        Some((*run, *other))
    })
}

/// The scores (in `a`, in `b`) of every seed that both have, as far as both have a score.
pub fn paired(a: &Group<'_>, b: &Group<'_>, score: impl Fn(&Run) -> Option<f64>) -> Vec<(f64, f64)> {
    shared_seeds(a, b).filter_map(|(a, b)| Some((score(a)?, score(b)?))).collect()
}

/// Which `keys`, sorted, stand for their curriculum where curricula are compared. A variant that a single
/// curriculum has, in an environment where that curriculum has a `default` too, is an ablation of it and does
/// not. Shape: one answer per key.
pub fn compared(keys: &[&GroupKey]) -> Vec<bool> {
    let has_default = |key: &GroupKey| {
        let same = |other: &&&GroupKey| {
            (&other.environment, &other.curriculum) == (&key.environment, &key.curriculum)
        };
        keys.iter().filter(same).any(|other| other.variant == "default")
    };
    let is_common = |key: &GroupKey| {
        keys.iter().any(|other| {
            other.variant == key.variant
                && other.curriculum != key.curriculum
                && other.curriculum.origin == key.curriculum.origin
        })
    };
    keys.iter().map(|key| key.variant == "default" || is_common(key) || !has_default(key)).collect()
}

/// All groups with at least one evaluation, in order.
pub fn groups<'a>(store: &'a Store, catalogue: &Catalogue) -> Vec<Group<'a>> {
    counted(store, &[], catalogue)
}

/// As [`groups`], where the runs of `completed` ([`complete::failed_as_zero`]) take the place of those of the
/// store with their keys.
pub fn counted<'a>(store: &'a Store, completed: &'a [Run], catalogue: &Catalogue) -> Vec<Group<'a>> {
    let mut groups: Vec<Group<'_>> = Vec::new();
    let as_it_counts = |run: &'a Run| completed.iter().find(|other| other.key() == run.key()).unwrap_or(run);
    // The store's runs come by key, so that those of one group follow each other, by seed.
    for run in store.runs().iter().map(as_it_counts).filter(|run| !run.records.is_empty()) {
        let key = GroupKey::of(catalogue, run);
        match groups.last_mut() {
            Some(group) if group.key == key => group.runs.push(run),
            _ => groups.push(Group { key, runs: vec![run] }),
        }
    }
    groups.sort_by(|a, b| a.key.cmp(&b.key));
    groups
}

impl<'a> Group<'a> {
    /// The group with those of its runs that `keep` accepts.
    pub fn filtered(&self, keep: impl Fn(&Run) -> bool) -> Self {
        let kept = |run: &&'a Run| keep(run);
        Self { key: self.key.clone(), runs: self.runs.iter().copied().filter(kept).collect() }
    }

    /// The group with the runs that its numbers are of: those that have ended, by finishing or by a failure
    /// from which on they count 0. Where none has, all of them, as far as they got.
    pub fn settled(&self) -> Self {
        let ended = self.filtered(|run| run.is_finished() || complete::is_completed(run));
        if ended.runs.is_empty() { self.clone() } else { ended }
    }

    /// Whether its runs lie in the results folder, and not in an archive.
    pub fn is_own(&self) -> bool {
        self.key.curriculum.origin.is_none()
    }

    /// Runs of it that failed and count 0 from their failure on.
    pub fn failed(&self) -> usize {
        self.runs.iter().filter(|run| complete::is_completed(run)).count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ablations_are_not_compared() {
        let key = |environment: &str, curriculum: &str, variant: &str| {
            GroupKey::new(&Catalogue::default(), environment, curriculum, variant)
        };
        let keys = [
            key("A", "nova", "default"),
            key("A", "nova", "n=3"),
            key("A", "nova", "wide"),
            key("A", "wren", "wide"),
            key("B", "nova", "n=3"),
        ];
        assert_eq!(compared(&keys.iter().collect::<Vec<_>>()), [true, false, true, true, true]);
    }
}
