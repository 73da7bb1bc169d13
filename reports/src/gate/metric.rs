//! What is compared: one number per run.

use serde::Serialize;

use super::cells::{Cell, RunSummary};
use crate::analysis::scores;
use crate::stats;

/// A number that sums up one run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Metric {
    /// Area under the success rate: how soon and how well it learned. Worse where lower.
    Area,
    /// Final success: how well it did in the end. Worse where lower.
    FinalSuccess,
    /// Mean over evaluations of the teacher's effective number of goals, exp(entropy): how widely it spread
    /// them. Neither more nor fewer is better; a change says that the teacher is another one.
    EffectiveGoals,
    /// The same of the goals that it really picked from the pool between two evaluations: a teacher that does
    /// not do as its weights say is another one, too.
    EffectivePicks,
    /// Mean over evaluations of the picked goals' mean place in the set that the teacher ranks, 0 for the
    /// first to 1 for the last: whether all of the set has its turns. Neither end is better.
    PickRank,
}

/// All metrics, in the order of tables.
pub const METRICS: [Metric; 5] =
    [Metric::Area, Metric::FinalSuccess, Metric::EffectiveGoals, Metric::EffectivePicks, Metric::PickRank];

impl Metric {
    /// Name in tables.
    pub fn title(self) -> &'static str {
        match self {
            Self::Area => "area under the curve",
            Self::FinalSuccess => "final success",
            Self::EffectiveGoals => "effective goals",
            Self::EffectivePicks => "effective picks",
            Self::PickRank => "place of picks",
        }
    }

    /// Whether lower is worse; otherwise any change counts.
    pub fn is_success(self) -> bool {
        matches!(self, Self::Area | Self::FinalSuccess)
    }

    /// The metric of one run; `None` where its teacher has no such number.
    pub fn of(self, cell: &Cell, curve: &RunSummary, window: usize) -> Option<f64> {
        match self {
            Self::Area => area(&cell.steps, &curve.rates(cell.episodes)),
            Self::FinalSuccess => final_success(&curve.rates(cell.episodes), window),
            Self::EffectiveGoals => curve.effective_goals,
            Self::EffectivePicks => curve.effective_picks,
            Self::PickRank => curve.pick_rank,
        }
    }

    /// By how much `now` differs from `before`: success rates as they are, what tells of teachers as a share
    /// of `before`.
    pub fn change(self, before: f64, now: f64) -> f64 {
        if self.is_success() { now - before } else { now / before - 1.0 }
    }
}

/// [`scores::area`] under `rates` over `steps` (`[evaluations]` both): a mean success rate in [0, 1].
fn area(steps: &[u64], rates: &[f64]) -> Option<f64> {
    scores::area(steps.iter().copied().zip(rates.iter().copied()))
}

/// Mean of the last `window` of `rates`, or of all where there are fewer; `None` if there is none.
fn final_success(rates: &[f64], window: usize) -> Option<f64> {
    stats::mean(&rates[rates.len().saturating_sub(window)..])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn metrics_by_hand() {
        // Uneven steps: (10 * 0.25 + 30 * 0.75) / 40.
        assert_eq!(area(&[0, 10, 40], &[0.0, 0.5, 1.0]), Some(0.625));
        assert_eq!(final_success(&[0.0, 0.5, 1.0], 2), Some(0.75));
        assert_eq!(final_success(&[0.0, 0.5, 1.0], 9), Some(0.5));
    }

    #[test]
    fn success_falls_in_points_and_goals_move_in_shares() {
        assert_eq!(Metric::FinalSuccess.change(0.75, 0.5), -0.25);
        assert_eq!(Metric::EffectiveGoals.change(200.0, 250.0), 0.25);
    }
}
