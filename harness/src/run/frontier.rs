//! Frontier truth: the success that the student really has at every goal of the pool.
//!
//! The episodes have instances of the environment and random streams of their own. Nobody learns from them,
//! and neither budget nor teacher hears of them.

use std::sync::Arc;

use agents::Critic;
use curricula::Judgement;
use envs::rng::Rng;
use envs::{EnvError, GoalEnv, Goals};
use reports::schema::{Beliefs, Frontier};

use super::error::RunError;
use super::evaluate::{LOCKSTEP, play};
use crate::config::frontier::FrontierOptions;

/// What is recorded of a teacher's judgement of a pool of `size` goals: each list that has an entry for every
/// goal and tells of at least one, and that single precision can hold. Nothing of a teacher that tells
/// neither.
pub(super) fn beliefs(judgement: &Judgement, size: usize) -> Option<Beliefs> {
    let narrow = |values: &Vec<Option<f64>>| {
        let values: Vec<Option<f32>> = values.iter().map(|value| value.map(|value| value as f32)).collect();
        let mut told = values.iter().flatten().peekable();
        let fits = values.len() == size && told.peek().is_some() && told.all(|value| value.is_finite());
        fits.then_some(values)
    };
    let success = judgement.success.as_ref().and_then(narrow);
    let success = success.filter(|values| values.iter().flatten().all(|value| (0.0..=1.0).contains(value)));
    let scores = judgement.scores.as_ref().and_then(narrow);
    (success.is_some() || scores.is_some()).then_some(Beliefs { success, scores })
}

/// Measures every goal of a pool.
pub(super) struct FrontierTruth {
    envs: Vec<Box<dyn GoalEnv>>,
    goals: Arc<Goals>,
    options: FrontierOptions,
}

impl FrontierTruth {
    /// For the pool `goals`, with instances that `make` makes.
    ///
    /// # Errors
    /// [`EnvError`] if one cannot be made.
    pub(super) fn new(
        goals: Arc<Goals>,
        options: FrontierOptions,
        make: impl Fn() -> Result<Box<dyn GoalEnv>, EnvError>,
    ) -> Result<Self, EnvError> {
        let most = options.episodes.saturating_mul(goals.len() as u64).min(LOCKSTEP);
        let envs = (0..most).map(|_| make()).collect::<Result<_, _>>()?;
        Ok(Self { envs, goals, options })
    }

    /// The goals of the pool in single precision, `[N][G]`.
    pub(super) fn goals(&self) -> Vec<Vec<f32>> {
        self.goals.iter().map(|goal| goal.iter().map(|&x| x as f32).collect()).collect()
    }

    /// Whether the evaluation `eval_index`, which may be the `last` of the run, is one that measures.
    pub(super) fn is_due(&self, eval_index: u64, last: bool) -> bool {
        self.options.is_due(eval_index, last)
    }

    /// Plays the episodes of all goals, goal by goal, as many in lockstep as there are instances; their
    /// starts are drawn from `rng` in this order. Gives the measure without its place in the run, its goals
    /// and the teacher's weights.
    ///
    /// # Errors
    /// [`RunError`] if physics or student break down.
    pub(super) fn measure(&mut self, student: &mut dyn Critic, rng: &mut Rng) -> Result<Frontier, RunError> {
        let episodes = self.options.episodes;
        let mut successes = vec![0; self.goals.len()];
        let all = (self.goals.len() as u64).saturating_mul(episodes);
        let mut played = 0;
        while played < all {
            let group = (all - played).min(self.envs.len() as u64);
            let goals: Vec<usize> =
                (played..played + group).map(|index| (index / episodes) as usize).collect();
            let envs = &mut self.envs[..group as usize];
            for (env, &goal) in envs.iter_mut().zip(&goals) {
                env.reset(rng)?;
                env.set_goal(self.goals.row(goal))?;
            }
            for (goal, success) in goals.into_iter().zip(play(envs, student)?.now) {
                successes[goal] += u64::from(success);
            }
            played += group;
        }
        Ok(Frontier { episodes, successes, ..Frontier::default() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_whole_lists_of_sound_numbers_are_recorded() {
        let judged = |success: &[f64], scores: &[f64]| {
            beliefs(&Judgement::of_all(Some(success.to_vec()), Some(scores.to_vec())), 2)
        };
        let [success, scores] = [[0.0, 1.0], [-3.0, 0.5]].map(|values| Some(values.map(Some).to_vec()));
        let both = Beliefs { success: success.clone(), scores: scores.clone() };
        assert_eq!(judged(&[0.0, 1.0], &[-3.0, 0.5]), Some(both));
        let only_scores = Some(Beliefs { success: None, scores });
        assert_eq!(judged(&[0.0, 1.5], &[-3.0, 0.5]), only_scores);
        assert_eq!(judged(&[0.0], &[-3.0, 0.5]), only_scores);
        assert_eq!(judged(&[0.0, 1.0], &[f64::NAN, 1e300]), Some(Beliefs { success, scores: None }));
        assert_eq!(judged(&[f64::NAN, 1.0], &[]), None);
        assert_eq!(beliefs(&Judgement::default(), 2), None);
        // Of some goals nothing is known, of all of them nothing is told.
        let known = |scores: [Option<f64>; 2]| Judgement { success: None, scores: Some(scores.to_vec()) };
        let told = Some(Beliefs { success: None, scores: Some(vec![None, Some(0.5)]) });
        assert_eq!(beliefs(&known([None, Some(0.5)]), 2), told);
        assert_eq!(beliefs(&known([None, None]), 2), None);
    }
}
