//! An ensemble of action-value functions, for teachers that learn values of their own.

use std::borrow::Cow;

use envs::rng::Rng;
use envs::{Rows, Spec};
use serde::{Deserialize, Serialize};
use tch::TchError;

use crate::batch::{Batch, Dims, check_len};
use crate::checks::{at_least, fraction, positive};
use crate::config::StudentConfig;
use crate::episode::Episode;
use crate::error::{AgentError, StateProblem};
use crate::inputs::{InputMatrix, Normalizers, TransitionInputs};
use crate::losses::Discount;
use crate::networks::{Output, Parameters, Passes, SavedStack, Shape, Trained, read};
use crate::normalizer::{Moments, Normalizer, NormalizerConfig};
use crate::precision::Arithmetic;
use crate::value::ValueLearner;

/// Rows that go through the networks at once when values are asked for.
const CHUNK: usize = 1024;

/// The settings of an ensemble that differ from the student's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnsembleConfig {
    /// Number of value functions E, at least 1.
    pub members: usize,
    /// Transitions per member and gradient step n, at least 1.
    pub batch: usize,
    /// Adam's step size, positive.
    pub lr: f64,
    /// Weight of the old target networks, in [0, 1], when they follow.
    pub polyak: f64,
}

/// E functions Q_e(s, g, a) with the student's critic as their architecture, each with its own initial
/// weights, target network, optimiser and batches; they share one pair of normalisers.
///
/// A gradient step moves every member against its own mean (Q_e(s, g, a) − y_e)² with
/// y_e = clip(r + γ·Q'_e(s', g, a'), −1/(1 − γ), 0). The caller fills in the next actions a'
/// ([`crate::Critic::label_next_actions`]).
///
/// ```
/// use agents::{Batch, Ensemble, EnsembleConfig, StudentConfig};
/// use envs::Rows;
/// use envs::rng::{Purpose, stream};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// agents::prepare_thread();
/// let env = envs::make("Point", &envs::EnvOptions::default())?;
/// let spec = env.spec();
/// let student = StudentConfig { width: 16, ..StudentConfig::default() };
/// let config = EnsembleConfig { members: 3, batch: 8, lr: 1e-3, polyak: 0.95 };
/// let mut ensemble = Ensemble::new(config, &student, spec, &mut stream(0, Purpose::Teacher))?;
///
/// // A teacher fills the batch from its student's replay buffer; here all of it is zeros.
/// ensemble.update(&Batch::new(spec, ensemble.batch_len()))?;
/// ensemble.follow()?;
///
/// let zeros = |width: usize| {
///     let mut row = Rows::new(width);
///     row.push(&vec![0.0; width]);
///     row
/// };
/// let values = ensemble.values(&zeros(spec.state), &zeros(spec.goal), &zeros(spec.action))?;
/// assert_eq!((values.len(), values.width()), (3, 1));
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Ensemble {
    config: EnsembleConfig,
    dims: Dims,
    discount: Discount,
    normalizers: Normalizers,
    networks: Trained,
    learner: ValueLearner,
    inputs: TransitionInputs,
    query: Query,
    steps: u64,
    /// The student's config of its normalisers, valid for these too.
    normalizer: NormalizerConfig,
    /// Episodes that were offered to the normalisers.
    episodes: u64,
}

/// Buffers for asking all members about the same states, goals and actions.
#[derive(Debug)]
struct Query {
    /// (s, g, a), `[1, CHUNK, S + G + A]`.
    inputs: InputMatrix,
    passes: Passes,
}

/// Everything that an ensemble must remember.
#[derive(Serialize, Deserialize)]
struct Saved<'a> {
    networks: SavedStack,
    state: Cow<'a, Moments>,
    goal: Cow<'a, Moments>,
    steps: u64,
    episodes: u64,
}

impl Ensemble {
    /// New value functions for the task `spec`, with width, depth, discount, normalisation and device of the
    /// student that `student` describes, and initial weights from `rng`.
    ///
    /// # Errors
    /// [`AgentError::Config`] or [`AgentError::Device`].
    pub fn new(
        config: EnsembleConfig,
        student: &StudentConfig,
        spec: &Spec,
        rng: &mut Rng,
    ) -> Result<Self, AgentError> {
        at_least("ensemble.members", config.members, 1)?;
        at_least("ensemble.batch", config.batch, 1)?;
        positive("ensemble.lr", config.lr)?;
        fraction("ensemble.polyak", config.polyak)?;
        let student = student.clone().resolve(spec)?;
        let arithmetic = Arithmetic::of(&student)?;
        let dims = Dims::of(spec);
        let discount = Discount { gamma: student.gamma(spec) };
        let (layers, width) = (student.layers(spec), student.width);
        let shape = Shape { inputs: dims.critic_inputs(), layers, width, outputs: 1, output: Output::Linear };
        let normalizer = |width| Normalizer::new(student.normalizer, width);
        let EnsembleConfig { members, batch, .. } = config;
        Ok(Self {
            config,
            dims,
            discount,
            normalizers: Normalizers { state: normalizer(dims.state), goal: normalizer(dims.goal) },
            networks: Trained::new(shape, members, arithmetic, rng)?,
            learner: ValueLearner::new(shape, members, batch, discount, arithmetic)?,
            inputs: TransitionInputs::new(dims, members, batch, arithmetic)?,
            query: Query::new(shape, members, Arithmetic::single(arithmetic.device))?,
            steps: 0,
            normalizer: student.normalizer,
            episodes: 0,
        })
    }

    /// Number of value functions E.
    pub fn members(&self) -> usize {
        self.config.members
    }

    /// Transitions that a gradient step takes, E·n.
    pub fn batch_len(&self) -> usize {
        self.config.members * self.config.batch
    }

    /// Gradient steps taken.
    pub fn gradient_steps(&self) -> u64 {
        self.steps
    }

    /// Feeds the normalisers with the states and the goal of every transition of `episode`, if it is one of
    /// the episodes that feed the student's normalisers too ([`NormalizerConfig::feed_episodes`]).
    ///
    /// # Errors
    /// [`AgentError::Shape`] if the episode is of another task.
    pub fn observe(&mut self, episode: &Episode) -> Result<(), AgentError> {
        check_len("a state", self.dims.state, episode.states.width())?;
        check_len("a goal", self.dims.goal, episode.goal.len())?;
        check_len("an episode's states", episode.actions.len() + 1, episode.states.len())?;
        self.episodes += 1;
        if !self.normalizer.feeds(self.episodes - 1) {
            return Ok(());
        }
        let narrow = |numbers: &[f64]| numbers.iter().map(|&x| x as f32).collect::<Vec<f32>>();
        let steps = episode.actions.len();
        let states = &episode.states.as_slice()[..steps * self.dims.state];
        self.normalizers.state.update(&narrow(states));
        self.normalizers.goal.update(&narrow(&episode.goal).repeat(steps));
        Ok(())
    }

    /// One Adam step of every member: member e learns from transitions e·n to (e + 1)·n of `batch`, next
    /// actions included. Returns the members' mean loss.
    ///
    /// # Errors
    /// [`AgentError::Shape`] unless `batch` holds [`Ensemble::batch_len`] transitions of this task,
    /// [`AgentError::Diverged`] if the loss is not finite.
    pub fn update(&mut self, batch: &Batch) -> Result<f64, AgentError> {
        self.inputs.fill(batch, &self.normalizers)?;
        self.networks.zero_gradient()?;
        let mut loss = 0.0;
        for part in &self.inputs.parts {
            loss += self.learner.add_gradient(&mut self.networks, part, self.inputs.n)?.total()?;
        }
        self.networks.step(self.config.lr)?;
        self.steps += 1;
        if loss.is_finite() {
            Ok(loss / self.config.members as f64)
        } else {
            Err(AgentError::Diverged { what: "ensemble's loss", gradient_steps: self.steps })
        }
    }

    /// Moves the target networks towards the trained ones; to be called at the end of a cycle.
    ///
    /// # Errors
    /// [`AgentError::Diverged`] if a parameter is not finite.
    pub fn follow(&mut self) -> Result<(), AgentError> {
        self.networks.follow(self.config.polyak)?;
        if self.networks.are_finite()?.into_iter().all(|finite| finite) {
            Ok(())
        } else {
            Err(AgentError::Diverged { what: "ensemble", gradient_steps: self.steps })
        }
    }

    /// The online members' values, each clipped to `[−1/(1 − γ), 0]`: shape `[E, n]` for `states` (`[n, S]`),
    /// `goals` (`[n, G]`) and `actions` (`[n, A]`), n at least 1.
    ///
    /// # Errors
    /// [`AgentError::Shape`], or [`AgentError::NotFinite`] if a value is NaN.
    pub fn values(&mut self, states: &Rows, goals: &Rows, actions: &Rows) -> Result<Rows, AgentError> {
        let Dims { state, goal, action } = self.dims;
        check_len("a state", state, states.width())?;
        check_len("a goal", goal, goals.width())?;
        check_len("an action", action, actions.width())?;
        let n = states.len();
        check_len("the goals of a value query", n, goals.len())?;
        check_len("the actions of a value query", n, actions.len())?;
        if n == 0 {
            return Err(AgentError::Shape { what: "a value query", expected: 1, got: 0 });
        }
        let mut values = vec![vec![0.0; n]; self.config.members];
        for first in (0..n).step_by(CHUNK) {
            let rows = CHUNK.min(n - first);
            let triples = (first..first + rows).map(|i| [states.row(i), goals.row(i), actions.row(i)]);
            self.ask(triples, rows, first, &mut values)?;
        }
        let mut all = Rows::with_capacity(n, self.config.members);
        values.iter().for_each(|member| all.push(member));
        Ok(all)
    }

    /// Writes the values of `rows` triples of a state, a goal and an action to `values` (`[E][n]`) from
    /// `first` on.
    fn ask<'a>(
        &mut self,
        triples: impl Iterator<Item = [&'a [f64]; 3]>,
        rows: usize,
        first: usize,
        values: &mut [Vec<f64>],
    ) -> Result<(), AgentError> {
        let Query { inputs, passes } = &mut self.query;
        let (dims, normalizers) = (self.dims, &self.normalizers);
        inputs.fill(|numbers| {
            for (row, [state, goal, action]) in numbers.chunks_exact_mut(dims.critic_inputs()).zip(triples) {
                normalizers.write_wide(state, goal, row);
                for (place, &component) in row[dims.actor_inputs()..].iter_mut().zip(action) {
                    *place = component as f32;
                }
            }
        })?;
        passes.set_rows(rows)?;
        let shared = inputs.block.rows(0, rows)?.repeated(self.config.members)?;
        passes.forward(self.networks.network(Parameters::Online), &shared)?;
        let lowest = self.discount.lowest_value();
        read(&passes.output().plain.whole, |numbers| {
            if numbers.iter().any(|q| !q.is_finite()) {
                return Err(AgentError::NotFinite { what: "ensemble's value", gradient_steps: self.steps });
            }
            for (values, numbers) in values.iter_mut().zip(numbers.chunks_exact(rows)) {
                for (value, &q) in values[first..].iter_mut().zip(numbers) {
                    *value = f64::from(q).clamp(lowest, 0.0);
                }
            }
            Ok(())
        })?
    }

    /// Everything it has learned, as bytes.
    ///
    /// # Errors
    /// [`AgentError::Torch`] if the parameters cannot be read.
    pub fn save(&self) -> Result<Vec<u8>, AgentError> {
        let saved = Saved {
            networks: self.networks.save()?,
            state: Cow::Borrowed(self.normalizers.state.moments()),
            goal: Cow::Borrowed(self.normalizers.goal.moments()),
            steps: self.steps,
            episodes: self.episodes,
        };
        Ok(postcard::to_stdvec(&saved).expect("plain data in memory always serialises"))
    }

    /// Takes back what [`Ensemble::save`] gave: training on from here gives the same bytes as never having
    /// stopped. The bytes hold no checksum; the caller, who saves more than this, adds one over all of it.
    ///
    /// # Errors
    /// [`AgentError::State`] if the bytes are not those of an ensemble of this shape.
    pub fn load(&mut self, bytes: &[u8]) -> Result<(), AgentError> {
        let saved: Saved<'_> = postcard::from_bytes(bytes)
            .map_err(|error| AgentError::State { source: StateProblem::Ensemble(error) })?;
        self.networks.load(&saved.networks)?;
        self.normalizers.state.set_moments(saved.state.into_owned())?;
        self.normalizers.goal.set_moments(saved.goal.into_owned())?;
        self.steps = saved.steps;
        self.episodes = saved.episodes;
        Ok(())
    }
}

impl Query {
    fn new(shape: Shape, members: usize, arithmetic: Arithmetic) -> Result<Self, TchError> {
        let inputs = InputMatrix::new(1, CHUNK, shape.inputs, arithmetic)?;
        Ok(Self { inputs, passes: Passes::new(shape, members, CHUNK, arithmetic)? })
    }
}

#[cfg(test)]
mod tests;
