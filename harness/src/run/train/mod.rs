//! What a run does in a turn: a cycle of episodes towards the teacher's goals and the learning from them, or
//! some of the probe rollouts that the teacher asked for. Evaluations lie between turns.
//! [`cohort`] goes through the cycles.

mod measure;

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use agents::{Agent, AgentError, Cohort, CohortLane, Device, Episode, Mode};
use curricula::{Curriculum, Lesson, ProposedGoal, Setting};
use envs::rng::Purpose;
use envs::{GoalEnv, Goals, Rows, draw_pool};
use reports::schema::{RunKey, Teaching};

use super::cohort;
use super::error::RunError;
use super::evaluate::LOCKSTEP;
use super::frontier::FrontierTruth;
use super::observer::{Laps, Observer, Stage, Wish};
use super::picks::{self, Ranks};
use super::probing::{Played, Probing};
use super::shadow::Shadows;
use super::state::{ProbedState, TrainerState, TrainingState};
use crate::Registry;
use crate::config::streams::Streams;
use crate::config::{EvaluationGoals, RunConfig};

/// How [`Trainer::run`] came to its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// The budget is used up.
    Finished,
    /// The checkpointer wished to stop; a checkpoint is saved.
    Stopped,
}

/// How far a run was before a cycle.
pub(super) struct Before {
    step: u64,
    gradient_steps: u64,
    sampling: Option<Duration>,
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
    /// The goals that the teacher chooses from; empty for teachers without a pool.
    pool: Arc<Goals>,
    /// The goals of evaluations, where they come from a pool.
    evaluation_pool: Option<Arc<Goals>>,
    /// Measures every goal of the pool, where that is asked for.
    frontier: Option<FrontierTruth>,
    /// Teachers that watch while this one acts.
    shadows: Shadows,
    streams: Streams,
    probing: Probing,
    /// Whether the probe rollouts that the teacher asks for are played.
    plays_rollouts: bool,
    /// Steps of the budget that were taken.
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
        // All methods of a seed draw the same pool, whether they choose from it or are evaluated, measured or
        // watched on it.
        let is_watched = !config.shadow.is_empty();
        let drawn = if method.uses_pool || in_evaluations || config.frontier.is_on() || is_watched {
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
        let measured = config.frontier.is_on().then(|| Arc::clone(&drawn));
        let measured =
            measured.map(|goals| FrontierTruth::new(goals, config.frontier, || entry.make(&options)));
        let own =
            config.curriculum.get(method.id).and_then(toml::Value::as_table).cloned().unwrap_or_default();
        Ok(Self {
            agent: agents::registry::make(&config.student, &spec, seeds.of(key.seed, Purpose::Weights))?,
            curriculum: method.build(own, &setting)?,
            streams: Streams::new(&seeds, key.seed),
            probing: Probing::new(entry.make(&options)?, key.seed, seeds),
            plays_rollouts: true,
            env,
            evaluation_envs,
            pool,
            evaluation_pool: in_evaluations.then(|| Arc::clone(&drawn)),
            frontier: measured.transpose()?,
            shadows: Shadows::new(registry, &key, &config, (&spec, &drawn), || entry.make(&options))?,
            key,
            config,
            step: 0,
            evaluations: 0,
            teaching: picks::no_episodes(),
            ranks: Ranks::default(),
        })
    }

    /// Steps of the budget that were taken so far.
    pub fn step(&self) -> u64 {
        self.step
    }

    /// The same run without the probe rollouts that its teacher asks for: what a cycle of training takes.
    #[must_use]
    pub fn without_rollouts(self) -> Self {
        Self { plays_rollouts: false, ..self }
    }

    /// Takes up the state of an earlier process. Going on from there gives the same bytes as never having
    /// stopped.
    ///
    /// # Errors
    /// [`RunError`] if student or teacher refuse their state.
    pub fn resume(&mut self, state: &TrainerState, replay: &Path) -> Result<(), RunError> {
        let TrainerState { probed: ProbedState { training, probing }, shadows } = state;
        self.agent.load(&training.student, replay)?;
        self.curriculum.load(&training.teacher)?;
        self.streams = training.streams.clone();
        self.step = training.step;
        self.evaluations = training.evaluations;
        self.teaching = training.teaching.clone();
        self.ranks = training.ranks;
        self.probing.resume(probing.clone());
        self.shadows.resume(training.step, shadows)
    }

    fn state(&mut self, replay: &Path) -> Result<TrainerState, RunError> {
        let training = TrainingState {
            step: self.step,
            evaluations: self.evaluations,
            streams: self.streams.clone(),
            teaching: self.teaching.clone(),
            ranks: self.ranks,
            // A log that cannot be written is no fault of the run: another attempt may find the disk space.
            student: self.agent.save(replay).map_err(|error| match error {
                AgentError::Log { .. } => RunError::Unsaved(error),
                error => error.into(),
            })?,
            teacher: self.curriculum.save()?,
        };
        let probed = ProbedState { training, probing: self.probing.state().clone() };
        Ok(TrainerState { probed, shadows: self.shadows.state(self.step)? })
    }

    /// Trains to the end of the budget, or until the observer's checkpointer wishes to stop. The untrained
    /// student is evaluated first, the final one last. See [`cohort::train`] for several runs at once.
    ///
    /// # Errors
    /// [`RunError`] with what broke down.
    pub fn run(&mut self, observer: &mut (dyn Observer + Send)) -> Result<End, RunError> {
        let mut end = None;
        let means = cohort::Means { pool: None, width: 1, turns: None };
        cohort::train(vec![cohort::Borrowed(self, observer)], means, |_, result| end = Some(result));
        end.expect("every lane comes to an end")
    }

    /// Where its student learns.
    pub fn device(&self) -> Device {
        self.config.student.device
    }

    /// What its student learns in beside `width` - 1 others.
    pub(super) fn cohort(&self, width: usize) -> Box<dyn Cohort> {
        agents::make_cohort(&self.config.student, width).expect("its student was made")
    }

    /// Evaluates the untrained student of a run that has not begun. Breaks off where nothing is left to do.
    pub(super) fn begin(&mut self, observer: &mut dyn Observer) -> Result<ControlFlow<End>, RunError> {
        if self.evaluations == 0 {
            self.evaluate(observer)?;
        }
        Ok(self.or_finished())
    }

    fn or_finished(&self) -> ControlFlow<End> {
        if self.step < self.config.budget.steps {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(End::Finished)
        }
    }

    /// Lets the observer's checkpointer, if there is one, decide after a turn, and gives it what it wishes
    /// to save.
    fn save_if_wished(&mut self, observer: &mut dyn Observer, evaluated: bool) -> Result<Wish, RunError> {
        let Some(checkpointer) = observer.checkpointer() else { return Ok(Wish::GoOn) };
        let wish = checkpointer.wish(evaluated);
        if wish != Wish::GoOn {
            let mut laps = Laps::begin();
            let state = self.state(checkpointer.replay_folder())?;
            checkpointer.save(state)?;
            observer.spent(Stage::Saving, laps.lap());
        }
        Ok(wish)
    }

    /// The probe rollouts that are pending, in turns of their own, and then the episodes of a cycle. Gives
    /// what [`Trainer::finish`] must know of the time before these.
    pub(super) fn play(&mut self, observer: &mut dyn Observer) -> Result<ControlFlow<End, Before>, RunError> {
        while self.probing.is_pending() {
            let before = self.step;
            self.probe(observer)?;
            if let ControlFlow::Break(end) = self.end_turn(before, observer)? {
                return Ok(ControlFlow::Break(end));
            }
        }
        let before = Before {
            step: self.step,
            gradient_steps: self.agent.gradient_steps(),
            sampling: self.agent.sampling_time(),
        };
        for _ in 0..self.agent.episodes_per_cycle() {
            let episode = self.episode(observer)?;
            let mut laps = Laps::begin();
            self.agent.observe(&episode, self.env.as_ref(), &mut self.streams.replay)?;
            observer.spent(Stage::Storing, laps.lap());
            self.curriculum.observe(&episode)?;
            observer.spent(Stage::Teaching, laps.lap());
            if !self.shadows.is_empty() {
                self.shadows.observe(self.step, &episode)?;
                observer.spent(Stage::Shadowing, laps.lap());
            }
            self.teaching.goals.push(episode.goal.iter().map(|&x| x as f32).collect());
            self.teaching.successes.push(episode.success);
        }
        Ok(ControlFlow::Continue(before))
    }

    /// As many of the probe rollouts that are pending as a cycle has episodes, so that evaluations lie on the
    /// same steps as those of other curricula.
    fn probe(&mut self, observer: &mut dyn Observer) -> Result<(), RunError> {
        let mut laps = Laps::begin();
        let episodes = self.agent.episodes_per_cycle();
        let Played { charged, complete } = self.probing.play(self.agent.as_mut(), episodes)?;
        self.step += charged;
        if let Some(rollouts) = complete {
            self.curriculum.hear_rollouts(&rollouts)?;
        }
        observer.spent(Stage::Probing, laps.lap());
        Ok(())
    }

    /// What lets its student learn after the episodes of a cycle.
    pub(super) fn learning(&mut self) -> CohortLane<'_> {
        CohortLane { student: self.agent.as_mut(), reward: self.env.as_ref(), rng: &mut self.streams.replay }
    }

    /// What follows when its student has learned: its teacher learns, and whatever is due then. `time` is the
    /// student's share of the learning.
    pub(super) fn finish(
        &mut self,
        before: &Before,
        time: Duration,
        observer: &mut dyn Observer,
    ) -> Result<ControlFlow<End>, RunError> {
        observer.spent(Stage::Learning, time);
        let mut laps = Laps::begin();
        // In a warm-up nobody learns.
        let has_learned = self.agent.gradient_steps() > before.gradient_steps;
        if has_learned {
            self.curriculum.learn(self.agent.as_mut(), self.env.as_ref(), &mut self.streams.teacher)?;
        }
        let request = self.curriculum.request_rollouts(self.env.as_mut(), &mut self.streams.teacher)?;
        if let Some(request) = request.filter(|_| self.plays_rollouts) {
            self.probing.ask(request);
        }
        observer.spent(Stage::Teaching, laps.lap());
        if !self.shadows.is_empty() {
            let (step, plays) = (self.step, self.plays_rollouts);
            if has_learned {
                self.shadows.learn(step, self.agent.as_mut(), self.env.as_ref())?;
            }
            self.shadows.probe(step, self.agent.as_mut(), self.env.as_mut(), plays)?;
            observer.spent(Stage::Shadowing, laps.lap());
        }
        if let (Some(before), Some(after)) = (before.sampling, self.agent.sampling_time()) {
            observer.spent(Stage::Sampling, after - before);
        }
        self.end_turn(before.step, observer)
    }

    /// What is due after a turn that began at the step `before`.
    fn end_turn(&mut self, before: u64, observer: &mut dyn Observer) -> Result<ControlFlow<End>, RunError> {
        let every = self.config.evaluation.every;
        let due = self.step / every > before / every || self.or_finished().is_break();
        if due {
            self.evaluate(observer)?;
        }
        observer.cycle(self.step)?;
        if self.save_if_wished(observer, due)? == Wish::SaveAndStop {
            return Ok(ControlFlow::Break(End::Stopped));
        }
        Ok(self.or_finished())
    }

    /// One training episode towards the goal that the teacher chooses.
    fn episode(&mut self, observer: &mut dyn Observer) -> Result<Episode, RunError> {
        let env = self.env.as_mut();
        let horizon = env.spec().horizon;
        let mut laps = Laps::begin();
        env.reset(&mut self.streams.environment)?;
        observer.spent(Stage::Resetting, laps.lap());
        let start = env.observation().clone();
        let proposal = self.curriculum.propose(&mut Lesson {
            student: self.agent.as_mut(),
            start: &start,
            goals: &mut *env,
            rng: &mut self.streams.teacher,
        })?;
        observer.spent(Stage::Teaching, laps.lap());
        if !self.shadows.is_empty() {
            self.shadows.propose(self.step, self.agent.as_mut(), &start, env)?;
            observer.spent(Stage::Shadowing, laps.lap());
        }
        picks::note(&mut self.teaching, &mut self.ranks, &proposal);
        match proposal.goal {
            ProposedGoal::Native => {}
            ProposedGoal::Pool(index) if index < self.pool.len() => env.set_goal(self.pool.row(index))?,
            ProposedGoal::Pool(index) => return Err(RunError::NoSuchGoal { index, size: self.pool.len() }),
            ProposedGoal::Other(goal) => env.set_goal(&goal)?,
        }
        self.agent.begin_episode();

        let mut states = Rows::with_capacity(env.spec().state, horizon + 1);
        let mut achieved = Rows::with_capacity(env.spec().goal, horizon + 1);
        let mut actions = Rows::with_capacity(env.spec().action, horizon);
        let mut action = vec![0.0; env.spec().action];
        states.push(&start.state);
        achieved.push(&start.achieved);
        let (mut acting, mut stepping) = (Duration::ZERO, Duration::ZERO);
        let mut total_reward = 0.0;
        for _ in 0..horizon {
            let mode = Mode::Explore(&mut self.streams.exploration);
            let mut laps = Laps::begin();
            self.agent.act(env.observation(), env.goal(), mode, &mut action)?;
            acting += laps.lap();
            env.step(&action)?;
            stepping += laps.lap();
            states.push(&env.observation().state);
            achieved.push(&env.observation().achieved);
            actions.push(&action);
            total_reward += env.reward(&env.observation().achieved, env.goal());
        }
        observer.spent(Stage::Acting, acting);
        observer.spent(Stage::Stepping, stepping);
        self.step += horizon as u64;
        let success = env.success(&env.observation().achieved, env.goal());
        Ok(Episode { states, achieved, actions, goal: env.goal().to_vec(), total_reward, success })
    }
}
