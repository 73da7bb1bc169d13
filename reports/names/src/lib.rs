//! Names of the numbers about teachers that goalbench records itself, beside those that methods tell.
//!
//! A crate of its own, so that a curriculum can be refused a name that is taken without knowing of records,
//! and reports can read the numbers without knowing of curricula. Of two numbers with one name, records would
//! hold the last alone.

/// Entropy of the curriculum, in nats.
pub const ENTROPY: &str = "entropy";
/// Its exponential.
pub const EFFECTIVE_GOALS: &str = "effective_goals";
/// Distinct goals of the pool that were picked since the last evaluation.
pub const PICKED_GOALS: &str = "picked_goals";
/// Exponential of the entropy of their shares.
pub const EFFECTIVE_PICKS: &str = "effective_picks";
/// Mean place of the picked goals in the sets that they were chosen from.
pub const PICK_RANK_MEAN: &str = "pick_rank_mean";
/// Correlation over episodes of the goal's score with success at it.
pub const SCORE_SUCCESS_CORRELATION: &str = "score_success_correlation";

/// What follows from a teacher's weights. A method that weighs something else than the pool may tell it of
/// that.
pub const OF_WEIGHTS: [&str; 2] = [ENTROPY, EFFECTIVE_GOALS];
/// What follows from the goals that were picked, recorded of every teacher in this order.
pub const OF_PICKS: [&str; 4] = [PICKED_GOALS, EFFECTIVE_PICKS, PICK_RANK_MEAN, SCORE_SUCCESS_CORRELATION];
