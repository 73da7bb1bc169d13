//! Scores of trials, and which of them is best.

use crate::analysis::scores;
use crate::schema::{RunKey, TrialPlace, TrialScore, TuningMeasure};
use crate::stats;
use crate::store::{Run, Store};

/// Evaluations at the end of a run that its final success averages, as in a report without options.
const WINDOW: usize = 5;

/// The runs of a search, and what counts of them.
pub struct TrialRuns<'a> {
    /// The runs.
    pub store: &'a Store,
    /// Those that failed, as they count ([`failed_as_zero`](crate::analysis::complete::failed_as_zero)).
    pub completed: &'a [Run],
    /// What counts.
    pub measure: TuningMeasure,
    /// Seeds of the runs.
    pub seeds: &'a [u64],
}

/// The number of a run that counts; `None` where it has too few evaluations.
pub fn measured(run: &Run, measure: TuningMeasure, window: usize) -> Option<f64> {
    match measure {
        TuningMeasure::Area => scores::area_under_curve(&run.records),
        TuningMeasure::Final => scores::final_score(&run.records, window),
    }
}

impl TrialRuns<'_> {
    /// What came of the runs of a curriculum and variant in one environment.
    ///
    /// # Errors
    /// The first run that is not there, has not ended, or has no score.
    pub fn place(&self, environment: &str, curriculum: &str, variant: &str) -> Result<TrialPlace, RunKey> {
        let [environment, curriculum, variant] = [environment, curriculum, variant].map(String::from);
        let mut place = TrialPlace { environment, score: 0.0, by_seed: Vec::new(), failed: 0, steps: 0 };
        for &seed in self.seeds {
            let (environment, curriculum) = (place.environment.clone(), curriculum.clone());
            let key = RunKey { environment, curriculum, variant: variant.clone(), seed };
            let run = self.store.runs().iter().find(|run| *run.key() == key && run.outcome.is_some());
            let run = run.ok_or_else(|| key.clone())?;
            place.steps += run.records.last().map_or(0, |record| record.all_steps());
            let score = if run.is_finished() {
                measured(run, self.measure, WINDOW).ok_or(key)?
            } else {
                place.failed += 1;
                let completed = self.completed.iter().find(|other| *other.key() == key);
                // Where no run of the environment finished, nobody knows how far it was from the end.
                completed.and_then(|run| measured(run, self.measure, WINDOW)).unwrap_or(0.0)
            };
            place.by_seed.push(score);
        }
        place.score = mean(&place.by_seed);
        Ok(place)
    }
}

/// The mean, [rounded](stats::rounded): equal runs tie.
pub fn mean(scores: &[f64]) -> f64 {
    stats::mean(scores).map_or(0.0, stats::rounded)
}

/// The best of what was `tried`, the default settings first: of equal ones the first. `None` of none.
pub fn best(tried: &[TrialScore]) -> Option<&TrialScore> {
    // `max_by` takes the last of equals.
    tried.iter().rev().max_by(|a, b| a.score.total_cmp(&b.score))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::complete::failed_as_zero;
    use crate::analysis::options::Failures;
    use crate::schema::Outcome;
    use crate::testing;

    /// A run with these rates, 10 steps apart; one that failed after the last of them, or finished.
    fn run(variant: &str, seed: u64, rates: &[f64], failed: bool) -> Run {
        let step = 10 * (rates.len() as u64).saturating_sub(1);
        let outcome =
            if failed { Outcome::Failed { step, reason: "NaN".into() } } else { Outcome::Finished { step } };
        testing::run(variant, seed, rates, outcome)
    }

    #[test]
    fn scores_by_hand_where_a_failed_run_counts_0_from_its_failure_on() {
        let store = Store::of(vec![
            run("trial-01", 7, &[0.0, 0.5, 1.0], false),
            run("trial-01", 8, &[0.0, 1.0], true),
        ]);
        let completed = failed_as_zero(&store, Failures::Zero);
        let place = |measure| {
            let trials = TrialRuns { store: &store, completed: &completed, measure, seeds: &[7, 8] };
            trials.place("E", "c", "trial-01").expect("both have ended")
        };
        // Areas: (0.25 + 0.75) / 2, and (0.5 + 0.5) / 2 with 0 after the failure.
        let area = place(TuningMeasure::Area);
        assert_eq!((area.by_seed.as_slice(), area.score, area.failed), (&[0.5, 0.5][..], 0.5, 1));
        // 20 + 4 steps, and 10 + 2 up to the failure.
        assert_eq!(area.steps, 36);
        // The untrained student's evaluation is no final one: (0.5 + 1) / 2, and (1 + 0) / 2.
        assert_eq!(place(TuningMeasure::Final).by_seed, [0.75, 0.5]);
    }

    #[test]
    fn where_all_failed_they_count_0_and_what_has_not_ended_has_no_score() {
        let mut open = run("trial-02", 7, &[0.0, 0.5], false);
        open.outcome = None;
        let store = Store::of(vec![run("trial-01", 7, &[0.0, 1.0], true), open]);
        let completed = failed_as_zero(&store, Failures::Zero);
        let measure = TuningMeasure::Area;
        let trials = TrialRuns { store: &store, completed: &completed, measure, seeds: &[7] };
        assert_eq!(trials.place("E", "c", "trial-01").expect("it has ended").by_seed, [0.0]);
        for variant in ["trial-02", "trial-03"] {
            let open = trials.place("E", "c", variant).expect_err("it has not ended");
            assert_eq!(open.to_string(), format!("E/c/{variant}/seed-7"));
        }
    }

    #[test]
    fn of_equal_trials_the_lowest_number_is_best_and_the_default_before_all() {
        let trial = |variant: &str, score: f64| TrialScore {
            variant: variant.into(),
            settings: serde_json::Map::new(),
            score,
            places: Vec::new(),
        };
        let named = |scores: &[f64]| {
            let names = ["default", "trial-01", "trial-02"];
            let tried: Vec<TrialScore> =
                names.iter().zip(scores).map(|(name, &score)| trial(name, score)).collect();
            best(&tried).map(|trial| trial.variant.clone())
        };
        assert_eq!(named(&[0.1, 0.5, 0.5]).as_deref(), Some("trial-01"));
        assert_eq!(named(&[0.5, 0.5, 0.4]).as_deref(), Some("default"));
        assert_eq!(named(&[0.5, 0.2, 0.6]).as_deref(), Some("trial-02"));
        assert_eq!(named(&[]), None);
        // 0.1 + 0.2 + 0.3 is not 0.3 + 0.2 + 0.1 in floating point.
        assert_eq!(mean(&[0.1, 0.2, 0.3]).to_bits(), mean(&[0.3, 0.2, 0.1]).to_bits());
    }
}
