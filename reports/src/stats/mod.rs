//! Statistics: pure functions of slices. Undefined answers are `None`, never NaN.
//!
//! Inputs are finite numbers; the [store](crate::store) lets no others in. Scores of several environments
//! come as strata: one slice of scores, one score per seed, for each environment.

mod bootstrap;
mod calibration;
mod moments;
mod order;
mod permutation;
mod power;
mod proportion;
mod rank;
mod rates;
mod roc;
mod sign_flip;
mod standard_error;
mod tail;
mod welch;

pub use bootstrap::{Resampling, paired_interval, stratified_interval, stratified_intervals};
pub use calibration::{ReliabilityBin, calibration_error, reliability};
pub use moments::{Ddof, mean, rounded, std_dev};
pub use order::{iqm, median, quantile};
pub use permutation::{Permutation, permutation, permutations};
pub use power::{detectable_effect, effect_size, power};
pub use proportion::wilson_interval;
pub use rank::{RankOrder, spearman, top_overlap};
pub use rates::{optimality_gap, performance_profile, probability_of_improvement};
pub use roc::auc;
pub use sign_flip::{MOST_ENUMERATED, SignFlip, lowest_sign_flip_p, sign_flip};
pub use standard_error::{standard_error, t_interval_half_width};
pub use tail::cvar;
pub use welch::{Welch, fisher, hochberg, holm, welch};
