//! What every method must keep.

mod row;
mod saving;
mod teaching;

use super::{Class, LOWEST};
use crate::curriculum::Proposal;
use crate::registry::Entry;

/// Goals in the pools of these tests.
const GOALS: usize = 12;

/// Cycles after which a teacher that asks for probe rollouts by default has done so.
const ENOUGH_CYCLES: usize = 60;

/// Checks that a method keeps what the harness takes for granted:
///
/// - its row is in order: the id is lower case with hyphens, title and source are there;
/// - its default config is complete and valid; a misspelt name and a value of another type are refused, and
///   the error names the field;
/// - it refuses an empty pool if it chooses from the pool, and works without one if it does not;
/// - from a pool of one goal it chooses that one;
/// - its goals lie in the goal spaces of the point task, the mazes and FetchReach;
/// - with its default config, everything that [`contract_with`] checks.
///
/// Nothing here tests that a method sees nothing of an evaluation: the harness never hands it anything of
/// one.
///
/// # Panics
/// With what it does not keep.
///
/// ```
/// use curricula::{Entry, methods::her_iid_pool::HerIidPool, testing};
///
/// testing::contract(&Entry::of::<HerIidPool>());
/// ```
pub fn contract(entry: &Entry) {
    row::is_in_order(entry);
    row::has_complete_and_valid_defaults(entry);
    row::refuses_what_a_config_has_not(entry);
    row::says_whether_it_needs_a_pool(entry);
    teaching::chooses_the_only_goal_of_a_pool(entry);
    teaching::stays_in_the_goal_space(entry);
    contract_with(entry, "");
}

/// Checks of a method with the config that is written in `config` (TOML):
///
/// - the same seed gives the same proposals and the same state;
/// - it chooses from the pool if it says so, and only then, and it leaves the environment as the reset left
///   it;
/// - its weights are a distribution over the pool, and the numbers `entropy` and `effective_goals`, if it
///   records them, are those of its weights;
/// - what it judges are goals of the pool, with finite scores and estimates of success in [0, 1];
/// - its numbers keep their names, which are in snake case, and their order; no two share a name, and none
///   has that of a number that goalbench records of every teacher;
/// - the probe rollouts that it asks for are of goals of the task, at least one episode each;
/// - saved and loaded, it continues as one that was not, whether that is in the middle of a cycle or not, or
///   while probe rollouts are still to be played;
/// - it refuses bytes that are damaged, cut short, another method's or another pool's, and then goes on
///   undisturbed.
///
/// # Panics
/// With what it does not keep.
///
/// ```
/// use curricula::{Entry, methods::procurl::ProCurl, testing};
///
/// testing::contract_with(&Entry::of::<ProCurl>(), "selection = \"argmax\"");
/// ```
pub fn contract_with(entry: &Entry, config: &str) {
    let subject = Subject { entry, config };
    teaching::is_repeatable(subject);
    teaching::uses_the_pool_as_it_says(subject);
    teaching::leaves_the_environment_alone(subject);
    teaching::asks_for_rollouts_that_can_be_played(subject);
    teaching::tells_weights_that_are_a_distribution(subject);
    teaching::believes_something_of_goals_or_has_no_list(subject);
    teaching::tells_the_same_numbers_in_the_same_order(subject);
    // After a single episode an evaluation may be overdue; after an odd number a set's turns are under way.
    saving::continues_identically(subject, &[1]);
    saving::continues_identically(subject, &[2, 2, 2, 2, 2, 2, 3]);
    saving::continues_identically_while_rollouts_are_pending(subject);
    saving::refuses_what_it_did_not_save(subject);
    saving::refuses_the_state_of_another_pool(subject);
}

/// A method with one of its configs.
#[derive(Clone, Copy)]
struct Subject<'a> {
    entry: &'a Entry,
    config: &'a str,
}

impl Subject<'_> {
    /// A class over a pool of so many goals.
    fn class(self, goals: usize) -> Class {
        let class = Class::with(self.entry, self.config, goals, restless);
        let mut class = class.unwrap_or_else(|error| panic!("{self}: {error}"));
        class.mastery = unsteady;
        class
    }
}

impl std::fmt::Display for Subject<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { entry, config } = self;
        write!(f, "{} with {config:?}", entry.id)
    }
}

/// Confidence that moves, for each goal in its own way, and stays within the bounds.
fn restless(goal: usize, steps: u64) -> f64 {
    0.5 * LOWEST * (1.0 + (goal as f64 * 1.3 + steps as f64 * 0.7 * (1.0 + goal as f64 / 9.0)).sin())
}

/// Chances of success that change, for each goal in its own way.
fn unsteady(goal: &[f64], steps: u64) -> f64 {
    0.5 * (1.0 + (3.0 * goal.iter().sum::<f64>() + 0.4 * steps as f64).sin())
}

/// `n` cycles of two episodes each.
fn proposals(class: &mut Class, n: usize) -> Vec<Proposal> {
    (0..n).flat_map(|_| cycle(class, 2)).collect()
}

/// A cycle of some episodes.
fn cycle(class: &mut Class, episodes: usize) -> Vec<Proposal> {
    let all = (0..episodes).map(|_| class.propose().expect("a proposal")).collect();
    class.learn();
    all
}
