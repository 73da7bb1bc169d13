//! From raw transitions to normalised network inputs.

use tch::{Device, Kind, TchError, Tensor};

use crate::batch::{Batch, Dims};
use crate::device::in_reach;
use crate::error::AgentError;
use crate::networks::{Block, copy, with_slices};
use crate::normalizer::Normalizer;
use crate::precision::{Arithmetic, Precision};

/// The normalisers of what networks see besides actions.
#[derive(Clone, Debug)]
pub(crate) struct Normalizers {
    pub(crate) state: Normalizer,
    pub(crate) goal: Normalizer,
}

impl Normalizers {
    /// Writes the normalised state and goal side by side into `out`, shape `[S + G]` or longer.
    pub(crate) fn write(&self, state: &[f32], goal: &[f32], out: &mut [f32]) {
        let (state_out, rest) = out.split_at_mut(state.len());
        self.state.normalize(state, state_out);
        self.goal.normalize(goal, &mut rest[..goal.len()]);
    }

    /// [`Normalizers::write`] for numbers of double precision.
    pub(crate) fn write_wide(&self, state: &[f64], goal: &[f64], out: &mut [f32]) {
        let (state_out, rest) = out.split_at_mut(state.len());
        self.state.normalize_wide(state, state_out);
        self.goal.normalize_wide(goal, &mut rest[..goal.len()]);
    }
}

/// A matrix of network inputs that is written on the CPU and read where the networks live.
#[derive(Debug)]
pub(crate) struct InputMatrix {
    host: Tensor,
    /// Whether `block` is the memory of `host`: on the CPU, in single precision.
    shared: bool,
    pub(crate) block: Block,
}

impl InputMatrix {
    /// Zeros, `[E, n, columns]`.
    pub(crate) fn new(
        members: usize,
        rows: usize,
        columns: usize,
        arithmetic: Arithmetic,
    ) -> Result<Self, TchError> {
        let size = [members as i64, rows as i64, columns as i64];
        let host = Tensor::f_zeros(size, (Kind::Float, Device::Cpu))?;
        let shared = in_reach(arithmetic.device) && arithmetic.precision == Precision::F32;
        let block = if shared {
            Block::new(host.shallow_clone())?
        } else {
            Block::zeros(members, rows, columns, arithmetic)?
        };
        Ok(Self { host, shared, block })
    }

    /// Lets `write` fill the numbers, row after row, and sends them to the device.
    pub(crate) fn fill(&mut self, write: impl FnOnce(&mut [f32])) -> Result<(), TchError> {
        with_slices([&self.host], [], |[numbers], []| write(numbers));
        if !self.shared {
            copy(&self.block.plain.whole, &self.host)?;
        }
        Ok(())
    }
}

/// What a gradient step of E learners reads: n transitions each, normalised.
#[derive(Debug)]
pub(crate) struct TransitionInputs {
    dims: Dims,
    /// Transitions per learner n.
    pub(crate) n: usize,
    /// (s, g, a), `[E, n, S + G + A]`.
    current: InputMatrix,
    /// (s', g, a'), `[E, n, S + G + A]`.
    next: InputMatrix,
    /// r, `[E, n, 1]`.
    rewards: InputMatrix,
    /// The transitions in parts of equal size, to be learned from one after the other.
    pub(crate) parts: Vec<Part>,
}

/// Some rows of [`TransitionInputs`], the same number for every learner.
#[derive(Debug)]
pub(crate) struct Part {
    pub(crate) current: PartSide,
    pub(crate) next: PartSide,
    /// r, `[E, rows, 1]`.
    pub(crate) rewards: Block,
}

/// Network inputs before or after the transition.
#[derive(Debug)]
pub(crate) struct PartSide {
    /// What a critic sees, `[E, rows, S + G + A]`.
    pub(crate) all: Block,
    /// What an actor sees of it, `[E, rows, S + G]`.
    pub(crate) observed: Block,
    /// The action, `[E, rows, A]`.
    pub(crate) actions: Block,
}

/// The most rows per part on the CPU. The buffers of 512 rows stay in the core's cache (512 rows of 256 units
/// are 512 KiB); those of a whole batch of 1024 overflow a cache of 2 MiB, which cost 7 % of an update's
/// time.
const ROWS_PER_PART: usize = 512;

/// The largest divisor of `n` between a quarter of the most rows and the most, which are [`ROWS_PER_PART`],
/// or twice as many where a number takes half the memory; `n` itself if there is none.
pub(crate) fn rows_per_part(n: usize, arithmetic: Arithmetic) -> usize {
    let most = match arithmetic.precision {
        _ if !in_reach(arithmetic.device) => return n,
        Precision::F32 => ROWS_PER_PART,
        Precision::Bf16 => 2 * ROWS_PER_PART,
    };
    let fitting = (most / 4..=most).rev().find(|rows| n.is_multiple_of(*rows));
    fitting.unwrap_or(n)
}

impl Part {
    fn new(inputs: [&Block; 3], first: usize, rows: usize, dims: Dims) -> Result<Self, TchError> {
        let side = |block: &Block| {
            let all = block.rows(first, rows)?;
            let observed = all.columns(0, dims.actor_inputs())?;
            let actions = all.columns(dims.actor_inputs(), dims.action)?;
            Ok::<_, TchError>(PartSide { all, observed, actions })
        };
        let [current, next, rewards] = inputs;
        Ok(Self { current: side(current)?, next: side(next)?, rewards: rewards.rows(first, rows)? })
    }
}

impl TransitionInputs {
    pub(crate) fn new(
        dims: Dims,
        members: usize,
        n: usize,
        arithmetic: Arithmetic,
    ) -> Result<Self, TchError> {
        let matrix = |columns| InputMatrix::new(members, n, columns, arithmetic);
        let (current, next) = (matrix(dims.critic_inputs())?, matrix(dims.critic_inputs())?);
        let rewards = InputMatrix::new(members, n, 1, Arithmetic::single(arithmetic.device))?;
        let rows = rows_per_part(n, arithmetic);
        let blocks = [&current.block, &next.block, &rewards.block];
        let parts = (0..n)
            .step_by(rows)
            .map(|first| Part::new(blocks, first, rows, dims))
            .collect::<Result<_, _>>()?;
        Ok(Self { dims, n, current, next, rewards, parts })
    }

    /// Fills itself from `batch`, whose E·n transitions go to the learners in order.
    ///
    /// # Errors
    /// [`AgentError::Shape`] if there are not E·n transitions of these dimensions.
    pub(crate) fn fill(&mut self, batch: &Batch, normalizers: &Normalizers) -> Result<(), AgentError> {
        self.dims.check(batch.dims)?;
        let size = self.rewards.host.numel();
        crate::batch::check_len("a batch of transitions", size, batch.len)?;
        let Dims { state, goal, action } = self.dims;
        let columns = self.dims.critic_inputs();
        let side = |matrix: &mut InputMatrix, states: &[f32], actions: &[f32]| {
            matrix.fill(|numbers| {
                let rows = numbers.chunks_exact_mut(columns).zip(states.chunks_exact(state));
                let others = batch.goals.chunks_exact(goal).zip(actions.chunks_exact(action));
                for ((row, state), (goal, action)) in rows.zip(others) {
                    normalizers.write(state, goal, row);
                    row[columns - action.len()..].copy_from_slice(action);
                }
            })
        };
        side(&mut self.current, &batch.states, &batch.actions)?;
        side(&mut self.next, &batch.next_states, &batch.next_actions)?;
        self.rewards.fill(|numbers| numbers.copy_from_slice(&batch.rewards))?;
        Ok(())
    }
}
