//! What lies between turns: the student is evaluated, diagnosed and, on request, measured at every goal of
//! the pool. None of it changes what the run does next.

use agents::Critic;
use curricula::TeacherSummary;
use envs::rng::Purpose;
use reports::schema::{Frontier, Learning, Record, Teaching};
use serde_json::{Map, Value};

use super::Trainer;
use crate::run::error::RunError;
use crate::run::evaluate::{evaluate, learning};
use crate::run::frontier::beliefs;
use crate::run::observer::{Laps, Observer, Stage};
use crate::run::picks;

impl Trainer {
    pub(super) fn evaluate(&mut self, observer: &mut dyn Observer) -> Result<(), RunError> {
        let mut laps = Laps::begin();
        let episodes = self.config.evaluation.episodes;
        let mut rng = self.config.seed.stream(self.key.seed, Purpose::Evaluation(self.evaluations));
        let pool = self.evaluation_pool.as_deref();
        let score = evaluate(&mut self.evaluation_envs, self.agent.as_mut(), pool, episodes, &mut rng)?;
        let learning = self.diagnose()?;
        let frontier = self.measure_frontier()?;
        observer.spent(Stage::Evaluating, laps.lap());
        let ranks = std::mem::take(&mut self.ranks);
        let TeacherSummary { weights, statistics } = self.curriculum.summary();
        let statistics = statistics.into_iter().chain(picks::statistics(&self.teaching, ranks));
        let record = Record {
            environment: self.key.environment.clone(),
            curriculum: self.key.curriculum.clone(),
            variant: self.key.variant.clone(),
            seed: self.key.seed,
            step: self.step,
            eval_index: self.evaluations,
            episodes,
            success_rate: score.success_rate,
            any_success_rate: Some(score.any_success_rate),
            mean_return: score.mean_return,
            gradient_steps: self.agent.gradient_steps(),
            probe_steps: self.probing.state().steps,
            uncharged_steps: self.probing.state().uncharged,
            // JSON has no form for numbers that are not finite. They become null, which means "not defined
            // yet".
            teacher: statistics
                .map(|(name, value)| (name.to_owned(), Value::from(value)))
                .collect::<Map<_, _>>(),
        };
        let weights = weights.map(|weights| weights.iter().map(|&w| w as f32).collect());
        let taught = std::mem::replace(&mut self.teaching, picks::no_episodes());
        let teaching = Teaching { eval_index: self.evaluations, step: self.step, weights, ..taught };
        observer.record(&record, &teaching, &learning)?;
        let is_measured = frontier.is_some();
        if let Some(frontier) = frontier {
            observer.measured(&frontier)?;
        }
        if !self.shadows.is_empty() {
            let student = is_measured.then_some(&*self.agent as &dyn Critic);
            observer.shadowed(&self.shadows.note(self.evaluations, self.step, student)?)?;
        }
        self.evaluations += 1;
        Ok(())
    }

    /// The success at every goal of the pool, if this evaluation is one that measures it. Starts come from a
    /// stream of this evaluation's own.
    fn measure_frontier(&mut self) -> Result<Option<Frontier>, RunError> {
        let last = self.or_finished().is_break();
        let Some(frontier) = &mut self.frontier else { return Ok(None) };
        if !frontier.is_due(self.evaluations, last) {
            return Ok(None);
        }
        let mut rng = self.config.seed.stream(self.key.seed, Purpose::Frontier(self.evaluations));
        let measured = frontier.measure(self.agent.as_mut(), &mut rng)?;
        // They stay the same.
        let goals = (self.evaluations == 0).then(|| frontier.goals());
        let weights = self.curriculum.summary().weights;
        let weights = weights.map(|weights| weights.iter().map(|&w| w as f32).collect());
        let judgement = self.curriculum.judge(self.agent.as_ref());
        let beliefs = beliefs(&judgement, measured.successes.len());
        let (eval_index, step) = (self.evaluations, self.step);
        Ok(Some(Frontier { eval_index, step, goals, weights, beliefs, ..measured }))
    }

    /// How the student's learning stands. Its batch comes from a stream of this evaluation's own, so that
    /// nothing else depends on whether it is drawn.
    fn diagnose(&mut self) -> Result<Learning, RunError> {
        let mut rng = self.config.seed.stream(self.key.seed, Purpose::Diagnosis(self.evaluations));
        let found = self.agent.diagnose(self.env.as_ref(), &mut rng)?;
        Ok(learning(&found, self.evaluations, self.step))
    }
}
