//! The replay buffer: whole episodes, sampled with hindsight.
//!
//! Every episode is one block of f32: for each of its H + 1 steps the state, the achieved goal and the action
//! side by side (the last action is unused), then the goal that was asked for. A transition thus reads two
//! neighbouring steps, and states are stored once. That is 4·((H + 1)(S + G + A) + G) bytes per episode; for
//! 1,000,000 transitions mazes take 25 MB, FetchReach 70 MB, the other Fetch tasks 131 MB, HandReach 401 MB
//! and HandManipulate* 356 MB ([`Replay::capacity_bytes`]). Memory is taken as episodes come in.

mod log;

use envs::rng::Rng;
use envs::{Reward, Rows, Spec};
use rand::Rng as _;

use crate::batch::{Batch, Dims, check_len};
use crate::checks::at_least;
use crate::draw::{Draw, Hindsight};
use crate::episode::{Episode, Trajectory};
use crate::error::AgentError;

pub(crate) use log::{Log, read_all};

/// Which part of the buffer to sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// Every episode in it.
    All,
    /// The episode that came in last.
    Newest,
}

/// A ring of whole episodes: once full, a new episode takes the place of the oldest.
///
/// ```
/// use agents::{Batch, Episode, Replay, Source, StudentConfig};
/// use envs::Rows;
/// use envs::rng::{Purpose, stream};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let env = envs::make("Point", &envs::EnvOptions::default())?;
/// let spec = env.spec();
/// let zeros = |rows: usize, width: usize| {
///     let mut matrix = Rows::new(width);
///     (0..rows).for_each(|_| matrix.push(&vec![0.0; width]));
///     matrix
/// };
/// let mut replay = Replay::new(spec, 1000)?;
/// replay.push(&Episode {
///     states: zeros(spec.horizon + 1, spec.state),
///     achieved: zeros(spec.horizon + 1, spec.goal),
///     actions: zeros(spec.horizon, spec.action),
///     goal: vec![0.5; spec.goal],
///     total_reward: 0.0,
///     success: false,
/// })?;
///
/// let mut batch = Batch::new(spec, 64);
/// let hindsight = StudentConfig::default().hindsight();
/// replay.sample(Source::All, hindsight, env.as_ref(), &mut stream(0, Purpose::Replay), &mut batch)?;
/// // The goal asked for was never reached; transitions that hindsight gave an achieved goal are successes.
/// assert!(batch.rewards.contains(&0.0) && batch.rewards.contains(&-1.0));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Replay {
    dims: Dims,
    horizon: usize,
    /// Episodes it can hold.
    capacity: usize,
    /// One record per episode; the episode with number i (from 0) lies at index i modulo `capacity`.
    records: Vec<Box<[f32]>>,
    /// Episodes ever taken in.
    stored: u64,
}

impl Replay {
    /// An empty buffer for episodes of the task `spec` that holds `transitions` transitions, rounded down to
    /// whole episodes.
    ///
    /// # Errors
    /// [`AgentError::Config`] if not even one episode fits.
    pub fn new(spec: &Spec, transitions: usize) -> Result<Self, AgentError> {
        at_least("replay_capacity", transitions, spec.horizon)?;
        let capacity = transitions / spec.horizon;
        Ok(Self { dims: Dims::of(spec), horizon: spec.horizon, capacity, records: Vec::new(), stored: 0 })
    }

    /// Bytes that its numbers take once it is full.
    pub fn capacity_bytes(&self) -> u64 {
        (self.capacity * self.record_len() * size_of::<f32>()) as u64
    }

    /// Episodes in the buffer.
    pub fn len(&self) -> usize {
        self.records.len()
    }

    /// Whether no episode has come in.
    pub fn is_empty(&self) -> bool {
        self.records.is_empty()
    }

    /// Transitions in the buffer.
    pub fn transitions(&self) -> usize {
        self.len() * self.horizon
    }

    /// Episodes ever taken in.
    pub fn stored(&self) -> u64 {
        self.stored
    }

    /// Takes in an episode.
    ///
    /// # Errors
    /// [`AgentError::Shape`] if it is not of this task; the buffer then stays as it was.
    pub fn push(&mut self, episode: &Episode) -> Result<(), AgentError> {
        let Dims { state, goal, action } = self.dims;
        check_len("an episode's states", (self.horizon + 1) * state, episode.states.as_slice().len())?;
        check_len(
            "an episode's achieved goals",
            (self.horizon + 1) * goal,
            episode.achieved.as_slice().len(),
        )?;
        check_len("an episode's actions", self.horizon * action, episode.actions.as_slice().len())?;
        check_len("a goal", goal, episode.goal.len())?;
        let record = self.next_record();
        let mut place = record.iter_mut();
        let mut write = |numbers: &[f64]| {
            // Numbers on the left: a zip takes from its left side before it finds out that its right side has
            // ended, and would lose a place.
            for (&number, place) in numbers.iter().zip(place.by_ref()) {
                *place = number as f32;
            }
        };
        let no_action = vec![0.0; action];
        for step in 0..=episode.actions.len() {
            write(episode.states.row(step));
            write(episode.achieved.row(step));
            write(if step < episode.actions.len() { episode.actions.row(step) } else { &no_action });
        }
        write(&episode.goal);
        self.stored += 1;
        Ok(())
    }

    /// The record that the next episode goes to.
    fn next_record(&mut self) -> &mut [f32] {
        let slot = self.slot(self.stored);
        if slot == self.records.len() {
            self.records.push(vec![0.0; self.record_len()].into_boxed_slice());
        }
        &mut self.records[slot]
    }

    fn slot(&self, episode: u64) -> usize {
        (episode % self.capacity as u64) as usize
    }

    /// Numbers per step: S + G + A.
    fn step_len(&self) -> usize {
        self.dims.critic_inputs()
    }

    /// Numbers per episode.
    fn record_len(&self) -> usize {
        self.dims.episode_len(self.horizon)
    }

    /// Fills `batch` with transitions drawn uniformly, with replacement, from `source`.
    ///
    /// With probability k/(k + 1) a transition's goal is one that was achieved in its episode, chosen by the
    /// strategy (HER), else the goal that was asked for. `reward` judges the goal achieved after the
    /// transition. The next actions stay as they are. Nothing is allocated.
    ///
    /// # Errors
    /// [`AgentError::EmptyReplay`], or [`AgentError::Shape`] if `batch` is of another task.
    pub fn sample(
        &self,
        source: Source,
        hindsight: Hindsight,
        reward: &dyn Reward,
        rng: &mut Rng,
        batch: &mut Batch,
    ) -> Result<(), AgentError> {
        self.dims.check(batch.dims)?;
        if self.is_empty() {
            return Err(AgentError::EmptyReplay);
        }
        // All draws come first, so that the processor fetches the memory of several transitions at once.
        batch.draws.clear();
        for _ in 0..batch.len {
            let record = match source {
                Source::All => rng.random_range(0..self.records.len()),
                Source::Newest => self.slot(self.stored - 1),
            };
            batch.draws.push(Draw::new(record, self.horizon, hindsight, rng));
        }
        for row in 0..batch.len {
            let draw = batch.draws[row];
            let record = &self.records[draw.record];
            self.gather(record, draw, row, batch);
            let [achieved, wanted] = &mut batch.goal_pair;
            widen(self.achieved(record, draw.step + 1), achieved);
            widen(&batch.goals[row * self.dims.goal..][..self.dims.goal], wanted);
            batch.rewards[row] = reward.reward(achieved, wanted) as f32;
        }
        Ok(())
    }

    /// Copies the drawn transition, except its reward, into row `row` of `batch`.
    fn gather(&self, record: &[f32], draw: Draw, row: usize, batch: &mut Batch) {
        let Dims { state, goal, action } = self.dims;
        let step = &record[draw.step * self.step_len()..];
        batch.states[row * state..][..state].copy_from_slice(&step[..state]);
        batch.actions[row * action..][..action].copy_from_slice(&step[state + goal..][..action]);
        batch.next_states[row * state..][..state].copy_from_slice(&step[self.step_len()..][..state]);
        let asked = &record[self.record_len() - goal..];
        let wanted = draw.relabel.map_or(asked, |index| self.achieved(record, index));
        batch.goals[row * goal..][..goal].copy_from_slice(wanted);
    }

    /// The goal achieved at `step`, shape `[G]`.
    fn achieved<'a>(&self, record: &'a [f32], step: usize) -> &'a [f32] {
        &record[step * self.step_len() + self.dims.state..][..self.dims.goal]
    }

    /// The episode that came in as the last but `age`, if it is still there.
    pub fn trajectory(&self, age: usize) -> Option<Trajectory> {
        let number = self.stored.checked_sub(1)?.checked_sub(age as u64).filter(|_| age < self.len())?;
        let record = &self.records[self.slot(number)];
        let Dims { state, goal, action } = self.dims;
        let rows = |width| Rows::with_capacity(width, self.horizon + 1);
        let (mut states, mut achieved, mut actions) = (rows(state), rows(goal), rows(action));
        let mut wide = vec![0.0; self.step_len()];
        for (index, step) in record.chunks_exact(self.step_len()).take(self.horizon + 1).enumerate() {
            widen(step, &mut wide);
            states.push(&wide[..state]);
            achieved.push(&wide[state..][..goal]);
            if index < self.horizon {
                actions.push(&wide[state + goal..]);
            }
        }
        let goal = record[self.record_len() - goal..].iter().map(|&x| f64::from(x)).collect();
        Some(Trajectory { states, achieved, actions, goal })
    }

    /// Writes into `achieved` (`[G]`) the goal achieved after a transition drawn uniformly from the buffer.
    ///
    /// # Errors
    /// [`AgentError::EmptyReplay`].
    pub fn sample_achieved(&self, rng: &mut Rng, achieved: &mut [f64]) -> Result<(), AgentError> {
        check_len("a goal", self.dims.goal, achieved.len())?;
        let (record, step) = self.draw(rng)?;
        widen(self.achieved(record, step + 1), achieved);
        Ok(())
    }

    /// The episode and the step of a transition drawn uniformly from the buffer.
    fn draw(&self, rng: &mut Rng) -> Result<(&[f32], usize), AgentError> {
        if self.is_empty() {
            return Err(AgentError::EmptyReplay);
        }
        let record = &self.records[rng.random_range(0..self.records.len())];
        Ok((record, rng.random_range(0..self.horizon)))
    }

    /// Writes into `state` (`[S]`) the state before a transition drawn uniformly from the buffer.
    ///
    /// # Errors
    /// [`AgentError::EmptyReplay`].
    pub fn sample_state(&self, rng: &mut Rng, state: &mut [f64]) -> Result<(), AgentError> {
        check_len("a state", self.dims.state, state.len())?;
        let (record, step) = self.draw(rng)?;
        widen(&record[step * self.step_len()..][..self.dims.state], state);
        Ok(())
    }
}

/// f32 to f64.
fn widen(from: &[f32], to: &mut [f64]) {
    for (to, &from) in to.iter_mut().zip(from) {
        *to = f64::from(from);
    }
}

#[cfg(test)]
mod tests;
