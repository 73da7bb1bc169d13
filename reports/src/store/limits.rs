//! What a run's config says of the numbers that it can record.

use serde_json::Value;

use crate::schema::{Manifest, Record};

/// Bounds from a config; `None` where it does not tell, as in made-up results.
pub(super) struct Limits {
    /// Training steps of the whole run; the last cycle may take a few more.
    pub(super) budget: Option<u64>,
    /// Episodes of every evaluation.
    pub(super) episodes: Option<u64>,
    /// Goals in the pool.
    pub(super) goals: Option<u64>,
    /// Episodes towards each goal in a measure of the frontier.
    pub(super) frontier_episodes: Option<u64>,
    /// Ids of the shadows, in order.
    pub(super) shadows: Option<Vec<String>>,
    /// Gradient steps of a cycle, which is one training step at least.
    updates: Option<u64>,
}

impl Limits {
    pub(super) fn of(manifest: &Manifest) -> Self {
        let number = |pointer| manifest.config.pointer(pointer).and_then(Value::as_u64);
        let shadows = manifest.config.get("shadow").and_then(Value::as_array);
        let ids = |list: &Vec<Value>| list.iter().filter_map(Value::as_str).map(str::to_owned).collect();
        Self {
            shadows: shadows.map(ids),
            budget: manifest.budget(),
            episodes: number("/evaluation/episodes"),
            goals: number("/pool/size"),
            frontier_episodes: number("/frontier/episodes"),
            updates: number("/student/updates_per_cycle"),
        }
    }

    /// The most gradient steps after `step` training steps.
    pub(super) fn gradient_steps(&self, step: u64) -> Option<u64> {
        self.updates.map(|updates| updates.saturating_mul(step))
    }

    /// The most training steps that a run can take whose first evaluation after training is at step `first`:
    /// a cycle is no longer than that, and none begins once the budget is used up.
    pub(super) fn last_step(&self, first: u64) -> Option<u64> {
        self.budget.map(|budget| budget.saturating_add(first).saturating_sub(1))
    }
}

/// The training steps up to the first of `records` after training has begun: at least those of a cycle, and
/// so of an episode. `None` if there is none.
pub(super) fn first_step<'a>(records: impl Iterator<Item = &'a Record>) -> Option<u64> {
    records.map(|record| record.step).filter(|&step| step > 0).min()
}
