//! The training loop: episodes towards the teacher's goals, learning after each cycle, evaluations in between.

use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use agents::{Agent, AgentError, Episode, Mode};
use curricula::{Curriculum, CurriculumError, Lesson, Proposal, Setting};
use envs::rng::Purpose;
use envs::{EnvError, GoalEnv, Goals, Rows, draw_pool};
use reports::schema::{Record, RunKey, Teaching};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::evaluate::{LOCKSTEP, evaluate};
use super::picks::{self, Ranks};
use crate::Registry;
use crate::config::streams::Streams;
use crate::config::{EvaluationGoals, RunConfig};

/// Why a run cannot go on.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// The physics.
    #[error(transparent)]
    Environment(#[from] EnvError),
    /// The student.
    #[error(transparent)]
    Student(#[from] AgentError),
    /// The teacher.
    #[error(transparent)]
    Teacher(#[from] CurriculumError),
    /// The teacher asked for a goal that the pool does not hold.
    #[error("the curriculum proposed pool goal {index}, but the pool holds {size}")]
    NoSuchGoal {
        /// What it asked for.
        index: usize,
        /// N.
        size: usize,
    },
    /// Recording failed; the run itself is well.
    #[error("cannot record: {0}")]
    Recording(#[from] std::io::Error),
}

/// What the watcher wants after a cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wish {
    /// Train on.
    GoOn,
    /// Save a checkpoint, then train on.
    Save,
    /// Save a checkpoint and stop.
    SaveAndStop,
}

/// How [`Trainer::run`] came to its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// The budget is used up.
    Finished,
    /// The watcher wished to stop; a checkpoint is saved.
    Stopped,
}

/// Where a run's time goes, as far as it is told apart; the rest is physics, acting and bookkeeping of training episodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// The teacher proposes goals, observes episodes and learns: the price of the curriculum.
    Teacher,
    /// The student takes its gradient steps.
    Learning,
    /// The student is evaluated.
    Evaluation,
}

/// Who hears of a run's progress. The loop computes; watchers record, display and decide when to save.
pub trait Watcher {
    /// The run spent `time` in `phase`.
    fn spent(&mut self, phase: Phase, time: Duration);

    /// An evaluation is over.
    ///
    /// # Errors
    /// If it cannot be recorded; the run then ends.
    fn record(&mut self, record: &Record, teaching: &Teaching) -> std::io::Result<()>;

    /// A cycle is over, with its evaluation if one was due (`evaluated`).
    ///
    /// # Errors
    /// If the watcher is gone; the run then ends.
    fn cycle(&mut self, step: u64, evaluated: bool) -> std::io::Result<Wish>;

    /// Where the student's replay log lies.
    fn replay_folder(&self) -> &Path;

    /// Keeps a checkpoint.
    ///
    /// # Errors
    /// If it cannot be written; the run then ends.
    fn save(&mut self, state: TrainerState) -> std::io::Result<()>;
}

/// A run between two cycles, the student's replay log apart. Environments need no state: a reset forgets all.
#[derive(Serialize, Deserialize)]
pub struct TrainerState {
    step: u64,
    evaluations: u64,
    streams: Streams,
    teaching: Teaching,
    ranks: Ranks,
    #[serde(with = "serde_bytes")]
    student: Vec<u8>,
    #[serde(with = "serde_bytes")]
    teacher: Vec<u8>,
}

impl TrainerState {
    /// The student, as [`Agent::save`] gave it.
    pub fn student(&self) -> &[u8] {
        &self.student
    }

    /// Training steps taken.
    pub fn step(&self) -> u64 {
        self.step
    }
}

/// A run in progress.
pub struct Trainer {
    key: RunKey,
    config: RunConfig,
    env: Box<dyn GoalEnv>,
    /// Further instances, so that evaluations leave the training environment alone.
    evaluation_envs: Vec<Box<dyn GoalEnv>>,
    agent: Box<dyn Agent>,
    curriculum: Box<dyn Curriculum>,
    /// The goals that the teacher chooses from, if it is of that kind.
    pool: Arc<Goals>,
    /// The goals of evaluations, where they come from a pool.
    evaluation_pool: Option<Arc<Goals>>,
    streams: Streams,
    step: u64,
    evaluations: u64,
    /// Training episodes since the last evaluation.
    teaching: Teaching,
    ranks: Ranks,
}

impl Trainer {
    /// Builds everything that the run of `key` needs.
    ///
    /// # Errors
    /// [`RunError`] if the environment cannot be made or a config does not fit it.
    ///
    /// # Panics
    /// If `registry` lacks the run's environment or curriculum: plans only hold known ones.
    pub fn new(registry: &Registry, key: RunKey, config: RunConfig) -> Result<Self, RunError> {
        let known = "a plan only holds known names";
        let entry = registry.environment(&key.environment).expect(known);
        let options = envs::EnvOptions { native_ccd: config.physics.native_ccd };
        let env = entry.make(&options)?;
        let instances = config.evaluation.episodes.min(LOCKSTEP);
        let mut evaluation_envs =
            (0..instances).map(|_| entry.make(&options)).collect::<Result<Vec<_>, _>>()?;
        let spec = env.spec().clone();

        let method = registry.curriculum(&key.curriculum).expect(known);
        let seeds = config.seed;
        let in_evaluations = config.evaluation.goals == EvaluationGoals::Pool;
        // The same for all methods of a seed, whatever they use it for.
        let drawn = if method.uses_pool || in_evaluations {
            let mut rng = seeds.stream(key.seed, Purpose::Pool);
            Arc::new(draw_pool(evaluation_envs[0].as_mut(), config.pool.size, &mut rng)?)
        } else {
            Arc::new(Goals::new(spec.goal))
        };
        let pool = if method.uses_pool { Arc::clone(&drawn) } else { Arc::new(Goals::new(spec.goal)) };
        let setting = Setting {
            spec: spec.clone(),
            pool: Arc::clone(&pool),
            seed: seeds.of(key.seed, Purpose::Teacher),
            student: config.student.clone(),
        };
        let own =
            config.curriculum.get(method.id).and_then(toml::Value::as_table).cloned().unwrap_or_default();
        Ok(Self {
            agent: agents::registry::make(&config.student, &spec, seeds.of(key.seed, Purpose::Weights))?,
            curriculum: (method.build)(&own, &setting)?,
            streams: Streams::new(&seeds, key.seed),
            env,
            evaluation_envs,
            pool,
            evaluation_pool: in_evaluations.then_some(drawn),
            key,
            config,
            step: 0,
            evaluations: 0,
            teaching: picks::no_episodes(),
            ranks: Ranks::default(),
        })
    }

    /// Puts decorators around the training environment and the student, to watch them at work. They must pass on everything
    /// that they are asked.
    #[must_use]
    pub fn decorated(
        self,
        env: impl FnOnce(Box<dyn GoalEnv>) -> Box<dyn GoalEnv>,
        agent: impl FnOnce(Box<dyn Agent>) -> Box<dyn Agent>,
    ) -> Self {
        Self { env: env(self.env), agent: agent(self.agent), ..self }
    }

    /// Training steps taken so far.
    pub fn step(&self) -> u64 {
        self.step
    }

    /// Becomes the run that `state` was taken of; going on gives the same bytes as never having stopped.
    ///
    /// # Errors
    /// [`RunError`] if student or teacher refuse their state.
    pub fn resume(&mut self, state: &TrainerState, replay: &Path) -> Result<(), RunError> {
        self.agent.load(&state.student, replay)?;
        self.curriculum.load(&state.teacher)?;
        self.streams = state.streams.clone();
        self.step = state.step;
        self.evaluations = state.evaluations;
        self.teaching = state.teaching.clone();
        self.ranks = state.ranks;
        Ok(())
    }

    fn state(&mut self, replay: &Path) -> Result<TrainerState, RunError> {
        Ok(TrainerState {
            step: self.step,
            evaluations: self.evaluations,
            streams: self.streams.clone(),
            teaching: self.teaching.clone(),
            ranks: self.ranks,
            // A log that cannot be written says nothing against the run: another attempt may have the space.
            student: self.agent.save(replay).map_err(|error| match error {
                AgentError::Log { .. } => RunError::Recording(std::io::Error::other(error)),
                error => error.into(),
            })?,
            teacher: self.curriculum.save()?,
        })
    }

    /// Trains to the end of the budget. The untrained student is evaluated first, the final one last.
    ///
    /// # Errors
    /// [`RunError`] with what broke down.
    pub fn run(&mut self, watcher: &mut dyn Watcher) -> Result<End, RunError> {
        if self.evaluations == 0 {
            self.evaluate(watcher)?;
        }
        while self.step < self.config.budget.steps {
            let reached = self.step / self.config.evaluation.every;
            self.cycle(watcher)?;
            let due =
                self.step / self.config.evaluation.every > reached || self.step >= self.config.budget.steps;
            if due {
                self.evaluate(watcher)?;
            }
            let wish = watcher.cycle(self.step, due)?;
            if wish != Wish::GoOn {
                let state = self.state(watcher.replay_folder())?;
                watcher.save(state)?;
            }
            if wish == Wish::SaveAndStop {
                return Ok(End::Stopped);
            }
        }
        Ok(End::Finished)
    }

    /// A cycle: some episodes, then student and teacher learn.
    fn cycle(&mut self, watcher: &mut dyn Watcher) -> Result<(), RunError> {
        for _ in 0..self.agent.episodes_per_cycle() {
            let episode = self.episode(watcher)?;
            self.agent.observe(&episode, self.env.as_ref(), &mut self.streams.replay)?;
            let begun = Instant::now();
            self.curriculum.observe(&episode)?;
            watcher.spent(Phase::Teacher, begun.elapsed());
            self.teaching.goals.push(episode.goal.iter().map(|&x| x as f32).collect());
            self.teaching.successes.push(episode.success);
        }
        let begun = Instant::now();
        let before = self.agent.gradient_steps();
        self.agent.learn(self.env.as_ref(), &mut self.streams.replay)?;
        let learned = Instant::now();
        // In a warm-up nobody learns.
        if self.agent.gradient_steps() > before {
            self.curriculum.learn(self.agent.as_mut(), self.env.as_ref(), &mut self.streams.teacher)?;
        }
        watcher.spent(Phase::Learning, learned - begun);
        watcher.spent(Phase::Teacher, learned.elapsed());
        Ok(())
    }

    /// One training episode towards the goal that the teacher chooses.
    fn episode(&mut self, watcher: &mut dyn Watcher) -> Result<Episode, RunError> {
        let env = self.env.as_mut();
        let horizon = env.spec().horizon;
        env.reset(&mut self.streams.environment)?;
        let start = env.observation().clone();
        let begun = Instant::now();
        let proposal = self.curriculum.propose(&mut Lesson {
            student: self.agent.as_mut(),
            start: &start,
            goals: &mut *env,
            rng: &mut self.streams.teacher,
        })?;
        watcher.spent(Phase::Teacher, begun.elapsed());
        let pick = if let Proposal::Pool(index) = proposal { Some(index) } else { None };
        picks::note(&mut self.teaching, &mut self.ranks, pick, self.curriculum.choice());
        match proposal {
            Proposal::Native => {}
            Proposal::Pool(index) if index < self.pool.len() => env.set_goal(self.pool.row(index))?,
            Proposal::Pool(index) => return Err(RunError::NoSuchGoal { index, size: self.pool.len() }),
            Proposal::Goal(goal) => env.set_goal(&goal)?,
        }
        self.agent.begin_episode();

        let mut states = Rows::with_capacity(env.spec().state, horizon + 1);
        let mut achieved = Rows::with_capacity(env.spec().goal, horizon + 1);
        let mut actions = Rows::with_capacity(env.spec().action, horizon);
        let mut action = vec![0.0; env.spec().action];
        states.push(&start.state);
        achieved.push(&start.achieved);
        for _ in 0..horizon {
            let mode = Mode::Explore(&mut self.streams.exploration);
            self.agent.act(env.observation(), env.goal(), mode, &mut action)?;
            env.step(&action)?;
            states.push(&env.observation().state);
            achieved.push(&env.observation().achieved);
            actions.push(&action);
        }
        self.step += horizon as u64;
        let success = env.success(&env.observation().achieved, env.goal());
        Ok(Episode { states, achieved, actions, goal: env.goal().to_vec(), success })
    }

    fn evaluate(&mut self, watcher: &mut dyn Watcher) -> Result<(), RunError> {
        let begun = Instant::now();
        let episodes = self.config.evaluation.episodes;
        let mut rng = self.config.seed.stream(self.key.seed, Purpose::Evaluation(self.evaluations));
        let pool = self.evaluation_pool.as_deref();
        let score = evaluate(&mut self.evaluation_envs, self.agent.as_mut(), pool, episodes, &mut rng)?;
        watcher.spent(Phase::Evaluation, begun.elapsed());
        let ranks = std::mem::take(&mut self.ranks);
        let statistics =
            self.curriculum.statistics().into_iter().chain(picks::statistics(&self.teaching, ranks));
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
            // A number that is not finite has no JSON form and becomes null: "not defined yet".
            teacher: statistics
                .map(|(name, value)| (name.to_owned(), Value::from(value)))
                .collect::<Map<_, _>>(),
        };
        let weights = self.curriculum.weights().map(|weights| weights.iter().map(|&w| w as f32).collect());
        let taught = std::mem::replace(&mut self.teaching, picks::no_episodes());
        let teaching = Teaching { eval_index: self.evaluations, step: self.step, weights, ..taught };
        watcher.record(&record, &teaching)?;
        self.evaluations += 1;
        Ok(())
    }
}
