//! From raw transitions to normalised network inputs.

use tch::{Cuda, Device, Kind, TchError, Tensor};

use crate::batch::{Batch, Dims};
use crate::device::in_reach;
use crate::error::AgentError;
use crate::networks::{Block, copy, with_slices};
use crate::normalizer::Normalizer;
use crate::pool::side_by_side;
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
    /// Where it is written: mostly in one place; in several, in turn, where what was written before may still
    /// be on its way to the device.
    hosts: Vec<Tensor>,
    /// Whether `block` is the memory of the only host: on the CPU, in single precision.
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
        let host = on_host(&size, arithmetic.device)?;
        let shared = in_reach(arithmetic.device) && arithmetic.precision == Precision::F32;
        let block = if shared {
            Block::new(host.shallow_clone())?
        } else {
            Block::zeros(members, rows, columns, arithmetic)?
        };
        Ok(Self { hosts: vec![host], shared, block })
    }

    /// Lets `write` fill the numbers, row after row, and sends them to the device.
    pub(crate) fn fill(&mut self, write: impl FnOnce(&mut [f32])) -> Result<(), TchError> {
        with_slices([&self.hosts[0]], [], |[numbers], []| write(numbers));
        if !self.shared {
            copy(&self.block.plain.whole, &self.hosts[0])?;
        }
        Ok(())
    }

    /// Makes sure that there is the place `slot`, in which zeros lie at first.
    fn reserve(&mut self, slot: usize) -> Result<(), TchError> {
        while self.hosts.len() <= slot {
            self.hosts.push(on_host(&self.block.plain.whole.size(), self.block.plain.whole.device())?);
        }
        Ok(())
    }

    /// Sends what lies in `slot` to the device, after all that the device was told before, and does not wait.
    fn send(&self, slot: usize) -> Result<(), TchError> {
        if self.shared {
            return Ok(());
        }
        let there = (Kind::Float, self.block.plain.whole.device());
        copy(&self.block.plain.whole, &self.hosts[slot].f_internal_to_copy(there, true)?)
    }
}

/// Zeros on the CPU that `device` can be sent from: a GPU copies pinned memory while the CPU does other work.
fn on_host(size: &[i64], device: Device) -> Result<Tensor, TchError> {
    let zeros = Tensor::f_zeros(size, (Kind::Float, Device::Cpu))?;
    // What `pin_memory` does, which warns of its argument on every call since libtorch 2.8; there is no other
    // here.
    if device == Device::Cpu { Ok(zeros) } else { zeros.f_internal_pin_memory(device) }
}

/// What a gradient step of E learners reads: n transitions each, normalised.
#[derive(Debug)]
pub(crate) struct TransitionInputs {
    dims: Dims,
    device: Device,
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
        Ok(Self { dims, device: arithmetic.device, n, current, next, rewards, parts })
    }

    /// Fills itself from `batch`, whose E·n transitions go to the learners in order.
    ///
    /// # Errors
    /// [`AgentError::Shape`] if there are not E·n transitions of these dimensions.
    pub(crate) fn fill(&mut self, batch: &Batch, normalizers: &Normalizers) -> Result<(), AgentError> {
        self.dims.check(batch.dims)?;
        let size = self.rewards.hosts[0].numel();
        crate::batch::check_len("a batch of transitions", size, batch.len)?;
        self.current.fill(|rows| write_side(rows, batch, normalizers, &batch.states, &batch.actions))?;
        self.next
            .fill(|rows| write_side(rows, batch, normalizers, &batch.next_states, &batch.next_actions))?;
        self.rewards.fill(|numbers| numbers.copy_from_slice(&batch.rewards))?;
        Ok(())
    }

    /// Lets `fill` write the transitions of each of `learners`, the first ones of the stack, for gradient
    /// step `step` of a cycle, and sends them. It is called for all of them side by side, while another
    /// device may still be busy with the steps before.
    pub(crate) fn fill_each<T: Send>(
        &mut self,
        step: usize,
        learners: &mut [T],
        fill: impl Fn(&mut T, &mut TransitionRows<'_>) + Sync,
    ) -> Result<(), TchError> {
        let slot = if in_reach(self.device) { 0 } else { step % MOST_SLOTS };
        if let (Device::Cuda(index), true) = (self.device, step > 0 && slot == 0) {
            Cuda::synchronize(index as i64);
        }
        let matrices = [&mut self.current, &mut self.next, &mut self.rewards];
        matrices.into_iter().try_for_each(|matrix| matrix.reserve(slot))?;
        let (rows, width) = (self.n, self.n * self.dims.critic_inputs());
        let Self { current, next, rewards, .. } = self;
        let written = [&*current, next, rewards].map(|matrix| &matrix.hosts[slot]);
        with_slices(written, [], |[current, next, rewards], []| {
            let sides = current.chunks_exact_mut(width).zip(next.chunks_exact_mut(width));
            let places = sides.zip(rewards.chunks_exact_mut(rows));
            let places = places.map(|((current, next), rewards)| TransitionRows { current, next, rewards });
            side_by_side(learners.iter_mut().zip(places).collect(), |(learner, mut rows)| {
                fill(learner, &mut rows);
            });
        });
        [&self.current, &self.next, &self.rewards].into_iter().try_for_each(|matrix| matrix.send(slot))
    }
}

/// How many batches may lie ready for a device at most, each in a place of its own. With this many, a cycle
/// of the default 40 gradient steps never waits for one of them to be free.
const MOST_SLOTS: usize = 40;

/// Where the n transitions of one learner are written.
#[derive(Debug)]
pub(crate) struct TransitionRows<'a> {
    /// (s, g, a), `[n, S + G + A]`.
    current: &'a mut [f32],
    /// (s', g, a'), `[n, S + G + A]`.
    next: &'a mut [f32],
    /// r, `[n]`.
    rewards: &'a mut [f32],
}

impl TransitionRows<'_> {
    /// Writes `batch`, which holds n transitions of this task.
    pub(crate) fn write(&mut self, batch: &Batch, normalizers: &Normalizers) {
        write_side(self.current, batch, normalizers, &batch.states, &batch.actions);
        write_side(self.next, batch, normalizers, &batch.next_states, &batch.next_actions);
        self.rewards.copy_from_slice(&batch.rewards);
    }
}

/// Writes `states` and the goals of `batch`, normalised, and `actions` side by side into `rows`.
fn write_side(rows: &mut [f32], batch: &Batch, normalizers: &Normalizers, states: &[f32], actions: &[f32]) {
    let Dims { state, goal, action } = batch.dims;
    let columns = batch.dims.critic_inputs();
    let rows = rows.chunks_exact_mut(columns).zip(states.chunks_exact(state));
    let others = batch.goals.chunks_exact(goal).zip(actions.chunks_exact(action));
    for ((row, state), (goal, action)) in rows.zip(others) {
        normalizers.write(state, goal, row);
        row[columns - action.len()..].copy_from_slice(action);
    }
}
