//! DDPG with hindsight experience replay.
//!
//! References: Lillicrap et al. 2016 ("Continuous control with deep reinforcement learning"), Andrychowicz et
//! al. 2017 ("Hindsight Experience Replay"), and the HER configuration of OpenAI Baselines, whose choices
//! this follows where the papers are silent.
//!
//! # Deviations and choices
//! Baselines is `openai/baselines` (commit ea25b9e, `baselines/her/`).
//!
//! - TEACH's Algorithm 2 updates the student after every environment step. Here it learns once per cycle, 40
//!   gradient steps after two episodes, or 0.4 per environment step where H = 50 (Baselines' config).
//! - A cycle's two episodes are played one after the other by one worker. Baselines plays them side by side
//!   (one, unless `num_env` says 2), and its published results add up the gradients of 19 such workers.
//! - Actor and critic gradients of one step are taken at the same parameters, then both are applied
//!   (Baselines).
//! - Target networks follow once per cycle (Baselines), or after every gradient step as in DDPG's paper
//!   (`polyak_every`). TEACH's Eq. 12 has the rule, but neither its coefficient nor when it is applied.
//! - An episode gives all of its H transitions, and success is judged after its last step. Baselines drops
//!   the last step: it keeps H − 1 transitions and judges success one step earlier.
//! - Normalisers start with a pseudo-observation of 0, as those of Baselines do
//!   (`normalizer.pseudo_observations`), and pass inputs through unchanged until the first episode feeds
//!   them.
//! - As soon as an episode ends, normalisers take in H of its transitions, drawn with replacement and
//!   relabelled, so they have already moved when a cycle's second episode begins. Baselines draws from both
//!   episodes of a cycle together, after the second.
//! - Once the buffer is full, a new episode replaces the oldest one; in Baselines, one drawn at random.
//!   Within the paper's budgets nothing is ever replaced.
//! - Adam adds its ε after the bias correction (Kingma and Ba, algorithm 1), Baselines before it.
//! - Learning starts with the first cycle (Baselines), unless a warm-up of random actions is asked for
//!   (`warmup_episodes`). Until it is over, networks and targets stay as they are; normalisers move.

mod cohort;
#[cfg(test)]
mod cohort_tests;
mod cycle;
mod infer;
#[cfg(test)]
mod reference_tests;
mod state;
#[cfg(test)]
mod td_tests;
mod update;
#[cfg(test)]
mod wiring_tests;

use std::path::Path;
use std::time::Duration;

use envs::rng::{Purpose, Rng, stream};
use envs::{Observation, Reward, Rows, Spec};

use crate::actor::PolicyWeights;
use crate::agent::{Agent, Critic, Mode, Network};
use crate::batch::{Batch, Dims, check_len};
use crate::config::StudentConfig;
use crate::diagnosis::Diagnosis;
use crate::draw::Hindsight;
use crate::episode::{Episode, Trajectory};
use crate::error::AgentError;
use crate::inputs::Normalizers;
use crate::losses::Discount;
use crate::networks::{Output, Parameters, Shape};
use crate::noise::{Noise, uniform};
use crate::normalizer::Normalizer;
use crate::precision::Arithmetic;
use crate::replay::{Log, Replay, Source};

pub(crate) use cohort::DdpgCohort;
use cycle::{Lane, cycle};
use infer::Inference;
pub use infer::ROWS_ASKED_AFAR;
pub(crate) use state::check_replay;
use update::{Learner, Networks};

/// The DDPG + HER student.
#[derive(Debug)]
pub(crate) struct Ddpg {
    spec: Spec,
    config: StudentConfig,
    discount: Discount,
    shapes: [Shape; 2],
    arithmetic: Arithmetic,
    networks: Networks,
    learner: Learner,
    inference: Inference,
    normalizers: Normalizers,
    replay: Replay,
    log: Log,
    noise: Noise,
    /// Transitions of a gradient step.
    batch: Batch,
    /// As many transitions as an episode has, for feeding the normalisers.
    fresh: Batch,
    /// Time spent drawing batches.
    sampling: Duration,
}

impl Ddpg {
    /// A student for the task `spec` whose initial weights come from the run's `seed`.
    pub(crate) fn new(config: &StudentConfig, spec: &Spec, seed: u64) -> Result<Self, AgentError> {
        let config = config.clone().resolve(spec)?;
        let arithmetic = Arithmetic::of(&config)?;
        let dims = Dims::of(spec);
        let layers = config.layers(spec);
        let shape = |inputs, outputs, output| Shape { inputs, layers, width: config.width, outputs, output };
        let shapes = [
            shape(dims.actor_inputs(), dims.action, Output::Tanh),
            shape(dims.critic_inputs(), 1, Output::Linear),
        ];
        let discount = Discount { gamma: config.gamma(spec) };
        let rng = &mut stream(seed, Purpose::Weights);
        let normalizer = |width| Normalizer::new(config.normalizer, width);
        Ok(Self {
            networks: Networks::new(dims, shapes, arithmetic, rng)?,
            learner: Learner::new(&config, discount, dims, shapes, 1, arithmetic)?,
            inference: Inference::new(dims, shapes, arithmetic.device)?,
            normalizers: Normalizers { state: normalizer(dims.state), goal: normalizer(dims.goal) },
            replay: Replay::new(spec, config.replay_capacity)?,
            log: Log::default(),
            noise: Noise::new(config.noise, dims.action),
            batch: Batch::new(spec, config.batch()),
            fresh: Batch::new(spec, spec.horizon),
            sampling: Duration::ZERO,
            spec: spec.clone(),
            discount,
            shapes,
            arithmetic,
            config,
        })
    }

    /// Whether some episodes of the warm-up have yet to come in.
    fn is_warming_up(&self) -> bool {
        self.replay.stored() < self.config.warmup_episodes
    }

    /// Whether the coming cycle has gradient steps.
    ///
    /// # Errors
    /// [`AgentError::EmptyReplay`] if it should have and there is nothing to learn from.
    fn is_learning(&self) -> Result<bool, AgentError> {
        match (self.is_warming_up(), self.replay.is_empty()) {
            (true, _) => Ok(false),
            (false, true) => Err(AgentError::EmptyReplay),
            (false, false) => Ok(true),
        }
    }

    /// What takes its gradient steps, and where their transitions come from.
    fn in_training<'a>(
        &'a mut self,
        reward: &'a dyn Reward,
        rng: &'a mut Rng,
    ) -> (&'a mut Learner, &'a mut Networks, Lane<'a>, &'a StudentConfig) {
        let Self { learner, networks, replay, normalizers, batch, sampling, config, .. } = self;
        let hindsight = config.hindsight();
        (learner, networks, Lane { replay, hindsight, normalizers, reward, rng, batch, sampling }, config)
    }
}

impl Critic for Ddpg {
    fn spec(&self) -> &Spec {
        &self.spec
    }

    fn gradient_steps(&self) -> u64 {
        self.networks.steps(0)
    }

    fn lowest_value(&self) -> f64 {
        self.discount.lowest_value()
    }

    fn confidence(&mut self, goals: &Rows, states: &Rows, network: Network) -> Result<Vec<f64>, AgentError> {
        self.inference.confidence(&self.networks, &self.normalizers, network, goals, states)
    }

    fn policy(&mut self, states: &Rows, goals: &Rows, network: Network) -> Result<Rows, AgentError> {
        check_len("a state", self.spec.state, states.width())?;
        check_len("a goal", self.spec.goal, goals.width())?;
        check_len("the goals of a policy query", states.len(), goals.len())?;
        let mut actions = Rows::with_capacity(self.spec.action, states.len());
        let pairs = states.iter().zip(goals.iter());
        self.inference.policy(&self.networks, &self.normalizers, network, pairs, |row| actions.push(row))?;
        Ok(actions)
    }

    fn replay_states(&mut self, m: usize, rng: &mut Rng) -> Rows {
        let mut states = Rows::with_capacity(self.spec.state, m);
        let mut state = vec![0.0; self.spec.state];
        for _ in 0..m {
            // The only error is an empty buffer, which gives no row.
            if self.replay.sample_state(rng, &mut state).is_err() {
                break;
            }
            states.push(&state);
        }
        states
    }

    fn replay_achieved(&mut self, m: usize, rng: &mut Rng) -> Rows {
        let mut goals = Rows::with_capacity(self.spec.goal, m);
        let mut goal = vec![0.0; self.spec.goal];
        for _ in 0..m {
            // The only error is an empty buffer, which gives no row.
            if self.replay.sample_achieved(rng, &mut goal).is_err() {
                break;
            }
            goals.push(&goal);
        }
        goals
    }

    fn replay_episodes(&self) -> usize {
        self.replay.len()
    }

    fn replay_trajectory(&self, age: usize) -> Option<Trajectory> {
        self.replay.trajectory(age)
    }

    fn td_errors(&mut self, trajectory: &Trajectory, reward: &dyn Reward) -> Result<Vec<f64>, AgentError> {
        self.inference.td_errors(&self.networks, &self.normalizers, self.discount, trajectory, reward)
    }

    fn replay_batch(&self, reward: &dyn Reward, rng: &mut Rng, batch: &mut Batch) -> Result<(), AgentError> {
        self.replay.sample(Source::All, Hindsight::NONE, reward, rng, batch)
    }

    fn label_next_actions(&mut self, batch: &mut Batch, network: Network) -> Result<(), AgentError> {
        Dims::of(&self.spec).check(batch.dims)?;
        self.inference.label_next_actions(&self.networks, &self.normalizers, network, batch)
    }
}

impl Agent for Ddpg {
    fn act(
        &mut self,
        observation: &Observation,
        goal: &[f64],
        mode: Mode<'_>,
        action: &mut [f64],
    ) -> Result<(), AgentError> {
        check_len("a state", self.spec.state, observation.state.len())?;
        check_len("a goal", self.spec.goal, goal.len())?;
        check_len("an action", self.spec.action, action.len())?;
        self.inference.act(&self.networks, &self.normalizers, &observation.state, goal, action)?;
        match mode {
            Mode::Greedy => {}
            Mode::Explore(rng) if self.is_warming_up() => uniform(action, rng),
            Mode::Explore(rng) => self.noise.apply(action, self.replay.stored(), rng),
        }
        Ok(())
    }

    fn begin_episode(&mut self) {
        self.noise.begin_episode();
    }

    fn observe(&mut self, episode: &Episode, reward: &dyn Reward, rng: &mut Rng) -> Result<(), AgentError> {
        self.replay.push(episode)?;
        // Drawn even if they are not fed, so that later batches do not depend on whether they were.
        self.replay.sample(Source::Newest, self.config.hindsight(), reward, rng, &mut self.fresh)?;
        if self.config.normalizer.feeds(self.replay.stored() - 1) {
            self.normalizers.state.update(&self.fresh.states);
            self.normalizers.goal.update(&self.fresh.goals);
        }
        Ok(())
    }

    fn episodes_per_cycle(&self) -> usize {
        self.config.episodes_per_cycle()
    }

    fn learn(&mut self, reward: &dyn Reward, rng: &mut Rng) -> Result<(), AgentError> {
        if !self.is_learning()? {
            return Ok(());
        }
        let (learner, networks, lane, config) = self.in_training(reward, rng);
        cycle(learner, networks, &mut [lane], config)?.pop().expect("a verdict for every lane")
    }

    fn sampling_time(&self) -> Option<Duration> {
        Some(self.sampling)
    }

    fn diagnose(&mut self, reward: &dyn Reward, rng: &mut Rng) -> Result<Diagnosis, AgentError> {
        let dry_step = if self.replay.is_empty() {
            None
        } else {
            // Batch and gradients are scratch memory: every gradient step begins by filling them anew.
            self.replay.sample(Source::All, self.config.hindsight(), reward, rng, &mut self.batch)?;
            Some(self.learner.dry_step(&mut self.networks, &self.batch, &self.normalizers)?)
        };
        Ok(Diagnosis {
            replay_episodes: self.replay.len() as u64,
            replay_transitions: self.replay.transitions() as u64,
            dry_step,
        })
    }

    fn weights(&self) -> Result<PolicyWeights, AgentError> {
        Ok(PolicyWeights {
            state: self.normalizers.state.scaling(),
            goal: self.normalizers.goal.scaling(),
            layers: self.networks.actor.network(Parameters::Online).dense()?,
        })
    }

    fn save(&mut self, replay: &Path) -> Result<Vec<u8>, AgentError> {
        self.log.append(&self.replay, replay)?;
        state::encode(self)
    }

    fn load(&mut self, state: &[u8], replay: &Path) -> Result<(), AgentError> {
        let episodes = state::decode(self, state)?;
        self.log.load(&mut self.replay, episodes, replay)
    }

    fn load_policy(&mut self, state: &[u8]) -> Result<(), AgentError> {
        state::decode(self, state).map(|_| ())
    }
}
