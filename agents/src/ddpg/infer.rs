//! Asking the networks: actions and values without learning.

use envs::{Reward, Rows};
use tch::{Device, TchError, Tensor};

use crate::agent::Network;
use crate::batch::{Batch, Dims, check_len};
use crate::device::in_reach;
use crate::episode::Trajectory;
use crate::error::AgentError;
use crate::inputs::{InputMatrix, Normalizers};
use crate::losses::Discount;
use crate::networks::{Block, Parameters, Passes, Shape, Stack, copy, read};
use crate::precision::Arithmetic;

use super::update::Networks;

/// Rows that go through the networks at once on a CPU, whose cache has to hold their activations.
const ROWS_IN_REACH: usize = 1024;

/// The same on another device, where every pass is waited for. Seen on an H100: with 1024 rows TEACH's
/// questions of 35 lanes, eight passes each, took 39 % of a cohort's clock.
pub const ROWS_ASKED_AFAR: usize = 8192;

/// Rows for which asking the CPU beats waiting for another device: a row through the policy takes 10 µs, a
/// wait 20 to 100 µs. Episodes played in lockstep ask for fewer.
const FEW: usize = 32;

/// Scratch buffers for questions of few rows and of many.
#[derive(Debug)]
pub(super) struct Inference {
    /// On the CPU.
    few: Query,
    /// Where the networks live.
    many: Query,
    acting: Acting,
}

/// The online policy on the CPU. Where it lives elsewhere, this is a copy, made once per cycle.
#[derive(Debug)]
enum Acting {
    Itself,
    Copy {
        policy: Stack,
        /// Gradient steps that were behind the policy when it was copied.
        steps: Option<u64>,
    },
}

impl Acting {
    fn new(actor: Shape, device: Device) -> Result<Self, TchError> {
        if in_reach(device) {
            return Ok(Self::Itself);
        }
        Ok(Self::Copy { policy: Stack::zeros(actor, 1, Arithmetic::single(Device::Cpu))?, steps: None })
    }

    /// The online policy of `networks`, as of now.
    fn policy<'a>(&'a mut self, networks: &'a Networks) -> Result<&'a Stack, TchError> {
        let online = networks.actor.network(Parameters::Online);
        match self {
            Self::Itself => Ok(online),
            Self::Copy { policy, steps } => {
                let now = Some(networks.steps(0));
                if *steps != now {
                    policy.copy_from(online)?;
                    *steps = now;
                }
                Ok(policy)
            }
        }
    }
}

/// Buffers for up to `capacity` pairs of a state and a goal.
#[derive(Debug)]
struct Query {
    dims: Dims,
    capacity: usize,
    /// (s, g, a), `[1, capacity, S + G + A]`.
    inputs: InputMatrix,
    views: QueryViews,
    actor: Passes,
    critic: Passes,
    /// The policy's answers, row after row: at most capacity · A numbers.
    answers: Vec<f32>,
}

/// The rows in use.
#[derive(Debug)]
struct QueryViews {
    rows: usize,
    /// (s, g, a).
    all: Block,
    /// (s, g).
    observed: Block,
    /// a.
    actions: Block,
}

impl QueryViews {
    fn new(inputs: &Block, rows: usize, dims: Dims) -> Result<Self, TchError> {
        let all = inputs.rows(0, rows)?;
        let observed = all.columns(0, dims.actor_inputs())?;
        let actions = all.columns(dims.actor_inputs(), dims.action)?;
        Ok(Self { rows, all, observed, actions })
    }
}

impl Query {
    fn new(dims: Dims, [actor, critic]: [Shape; 2], rows: usize, device: Device) -> Result<Self, TchError> {
        let inputs = InputMatrix::new(1, rows, dims.critic_inputs(), Arithmetic::single(device))?;
        let views = QueryViews::new(&inputs.block, rows, dims)?;
        let passes = |shape| Passes::new(shape, 1, rows, Arithmetic::single(device));
        let answers = Vec::with_capacity(rows * dims.action);
        Ok(Self {
            dims,
            capacity: rows,
            views,
            inputs,
            actor: passes(actor)?,
            critic: passes(critic)?,
            answers,
        })
    }

    /// Uses the first `rows` rows.
    fn set_rows(&mut self, rows: usize) -> Result<(), TchError> {
        if rows != self.views.rows {
            self.views = QueryViews::new(&self.inputs.block, rows, self.dims)?;
        }
        self.actor.set_rows(rows)?;
        self.critic.set_rows(rows)
    }

    /// Calls `work` with π(s, g) of the rows in use, shape `[rows · A]`.
    fn actions<T>(
        &mut self,
        policy: &Stack,
        gradient_steps: u64,
        work: impl FnOnce(&[f32]) -> T,
    ) -> Result<T, AgentError> {
        self.actor.forward(policy, &self.views.observed)?;
        let (rows, answers) = (self.views.rows, &mut self.answers);
        read_finite(&self.actor.output().transposed.whole, "policy's action", gradient_steps, |by_columns| {
            answers.clear();
            answers.extend((0..rows).flat_map(|row| by_columns[row..].iter().step_by(rows)));
            work(answers)
        })
    }

    /// Calls `work` with Q(s, g, π(s, g)) of the rows in use, shape `[rows]`.
    fn values(
        &mut self,
        networks: &Networks,
        network: Network,
        work: impl FnOnce(&[f32]),
    ) -> Result<(), AgentError> {
        self.actor.forward(networks.actor.network(network.actor()), &self.views.observed)?;
        copy(&self.views.actions.plain.whole, &self.actor.output().plain.whole)?;
        self.judge(networks, network.critic(), work)
    }

    /// Calls `work` with Q(s, g, a) of the rows in use, whose actions are in place, shape `[rows]`.
    fn judge(
        &mut self,
        networks: &Networks,
        critic: Parameters,
        work: impl FnOnce(&[f32]),
    ) -> Result<(), AgentError> {
        self.critic.forward(networks.critic.network(critic), &self.views.all)?;
        read_finite(&self.critic.output().plain.whole, "critic's value", networks.steps(0), work)
    }
}

/// Calls `work` with the numbers of a contiguous tensor, or fails if one of them is not finite.
fn read_finite<T>(
    tensor: &Tensor,
    what: &'static str,
    gradient_steps: u64,
    work: impl FnOnce(&[f32]) -> T,
) -> Result<T, AgentError> {
    read(tensor, |numbers| {
        if numbers.iter().all(|x| x.is_finite()) {
            Ok(work(numbers))
        } else {
            Err(AgentError::NotFinite { what, gradient_steps })
        }
    })?
}

impl Inference {
    pub(super) fn new(dims: Dims, shapes: [Shape; 2], device: Device) -> Result<Self, TchError> {
        let rows = if in_reach(device) { ROWS_IN_REACH } else { ROWS_ASKED_AFAR };
        Ok(Self {
            few: Query::new(dims, shapes, FEW, Device::Cpu)?,
            many: Query::new(dims, shapes, rows, device)?,
            acting: Acting::new(shapes[0], device)?,
        })
    }

    /// Forgets what it knows of the networks: they have become others.
    pub(super) fn forget(&mut self) {
        if let Acting::Copy { steps, .. } = &mut self.acting {
            *steps = None;
        }
    }

    /// Writes the online policy's action for one state and goal into `action`, shape `[A]`.
    pub(super) fn act(
        &mut self,
        networks: &Networks,
        normalizers: &Normalizers,
        state: &[f64],
        goal: &[f64],
        action: &mut [f64],
    ) -> Result<(), AgentError> {
        let Self { few, acting, .. } = self;
        few.set_rows(1)?;
        few.inputs.fill(|numbers| normalizers.write_wide(state, goal, numbers))?;
        few.actions(acting.policy(networks)?, networks.steps(0), |numbers| {
            for (action, &number) in action.iter_mut().zip(numbers) {
                *action = f64::from(number);
            }
        })
    }

    /// Calls `take` with the action (`[A]`) for every pair of a state and a goal, in order.
    pub(super) fn policy<'a>(
        &mut self,
        networks: &Networks,
        normalizers: &Normalizers,
        network: Network,
        pairs: impl ExactSizeIterator<Item = (&'a [f64], &'a [f64])>,
        mut take: impl FnMut(&[f64]),
    ) -> Result<(), AgentError> {
        let Self { few, many, acting } = self;
        let asked = network.actor();
        let (query, policy) = if asked == Parameters::Online && pairs.len() <= FEW {
            (few, acting.policy(networks)?)
        } else {
            (many, networks.actor.network(asked))
        };
        let actions = query.dims.action;
        let mut wide = vec![0.0; actions];
        query.in_chunks(normalizers, pairs, |query| {
            query.actions(policy, networks.steps(0), |numbers| {
                for row in numbers.chunks_exact(actions) {
                    for (wide, &number) in wide.iter_mut().zip(row) {
                        *wide = f64::from(number);
                    }
                    take(&wide);
                }
            })
        })
    }

    /// See [`crate::Critic::confidence`].
    pub(super) fn confidence(
        &mut self,
        networks: &Networks,
        normalizers: &Normalizers,
        network: Network,
        goals: &Rows,
        states: &Rows,
    ) -> Result<Vec<f64>, AgentError> {
        check_len("a state", self.many.dims.state, states.width())?;
        check_len("a goal", self.many.dims.goal, goals.width())?;
        if states.is_empty() {
            return Err(AgentError::Shape { what: "the set of states to average over", expected: 1, got: 0 });
        }
        let mut sums = vec![0.0; goals.len()];
        let mut pair = 0;
        let n = goals.len();
        let pairs = (0..states.len() * n).map(|i| (states.row(i / n), goals.row(i % n)));
        self.many.in_chunks(normalizers, pairs, |query| {
            query.values(networks, network, |values| {
                for &value in values {
                    sums[pair % n] += f64::from(value);
                    pair += 1;
                }
            })
        })?;
        for sum in &mut sums {
            *sum /= states.len() as f64;
        }
        Ok(sums)
    }

    /// See [`crate::Critic::td_errors`].
    pub(super) fn td_errors(
        &mut self,
        networks: &Networks,
        normalizers: &Normalizers,
        discount: Discount,
        trajectory: &Trajectory,
        reward: &dyn Reward,
    ) -> Result<Vec<f64>, AgentError> {
        let Dims { state, goal, action } = self.many.dims;
        let Trajectory { states, achieved, actions, goal: wanted } = trajectory;
        for (what, expected, got) in [
            ("a state", state, states.width()),
            ("a goal", goal, wanted.len()),
            ("an achieved goal", goal, achieved.width()),
            ("an action", action, actions.width()),
            ("a trajectory's states", actions.len() + 1, states.len()),
            ("a trajectory's achieved goals", actions.len() + 1, achieved.len()),
        ] {
            check_len(what, expected, got)?;
        }
        let mut targets = Vec::with_capacity(actions.len());
        let next = (1..states.len()).map(|step| (states.row(step), wanted.as_slice()));
        self.many.in_chunks(normalizers, next, |query| {
            query.values(networks, Network::Target, |values| {
                for &value in values {
                    let reward = reward.reward(achieved.row(targets.len() + 1), wanted) as f32;
                    targets.push(discount.target(reward, value));
                }
            })
        })?;
        let (columns, capacity) = (self.many.dims.critic_inputs(), self.many.capacity);
        let mut errors = Vec::with_capacity(targets.len());
        for first in (0..actions.len()).step_by(capacity) {
            let rows = capacity.min(actions.len() - first);
            self.many.set_rows(rows)?;
            self.many.inputs.fill(|numbers| {
                for (step, row) in (first..first + rows).zip(numbers.chunks_exact_mut(columns)) {
                    normalizers.write_wide(states.row(step), wanted, row);
                    for (place, &number) in row[state + goal..].iter_mut().zip(actions.row(step)) {
                        *place = number as f32;
                    }
                }
            })?;
            self.many.judge(networks, Parameters::Online, |values| {
                let pairs = values.iter().zip(&targets[first..]);
                errors.extend(pairs.map(|(&value, &target)| f64::from(target) - f64::from(value)));
            })?;
        }
        Ok(errors)
    }

    /// See [`crate::Critic::label_next_actions`].
    pub(super) fn label_next_actions(
        &mut self,
        networks: &Networks,
        normalizers: &Normalizers,
        network: Network,
        batch: &mut Batch,
    ) -> Result<(), AgentError> {
        let Dims { state, goal, action } = self.many.dims;
        let (columns, capacity) = (self.many.dims.critic_inputs(), self.many.capacity);
        for first in (0..batch.len).step_by(capacity) {
            let rows = capacity.min(batch.len - first);
            self.many.set_rows(rows)?;
            self.many.inputs.fill(|numbers| {
                let states = batch.next_states[first * state..].chunks_exact(state);
                let goals = batch.goals[first * goal..].chunks_exact(goal);
                let pairs = numbers.chunks_exact_mut(columns).take(rows).zip(states.zip(goals));
                for (row, (state, goal)) in pairs {
                    normalizers.write(state, goal, row);
                }
            })?;
            let labels = &mut batch.next_actions[first * action..][..rows * action];
            let policy = networks.actor.network(network.actor());
            self.many.actions(policy, networks.steps(0), |numbers| labels.copy_from_slice(numbers))?;
        }
        Ok(())
    }
}

impl Query {
    /// Puts `pairs` into the inputs, a chunk at a time, and calls `ask` on each chunk.
    fn in_chunks<'a>(
        &mut self,
        normalizers: &Normalizers,
        mut pairs: impl ExactSizeIterator<Item = (&'a [f64], &'a [f64])>,
        mut ask: impl FnMut(&mut Query) -> Result<(), AgentError>,
    ) -> Result<(), AgentError> {
        let columns = self.dims.critic_inputs();
        while pairs.len() > 0 {
            let rows = self.capacity.min(pairs.len());
            self.set_rows(rows)?;
            self.inputs.fill(|numbers| {
                for (row, (state, goal)) in numbers.chunks_exact_mut(columns).zip(pairs.by_ref().take(rows)) {
                    normalizers.write_wide(state, goal, row);
                }
            })?;
            ask(self)?;
        }
        Ok(())
    }
}
