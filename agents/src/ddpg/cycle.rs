//! One cycle of gradient steps, for one student or for several at once.

use std::time::{Duration, Instant};

use envs::Reward;
use envs::rng::Rng;

use super::update::{Learner, Networks};
use crate::batch::Batch;
use crate::config::{PolyakEvery, StudentConfig};
use crate::draw::Hindsight;
use crate::error::AgentError;
use crate::inputs::Normalizers;
use crate::losses::Loss;
use crate::replay::{Replay, Source};

/// Where the transitions of one student come from.
pub(super) struct Lane<'a> {
    pub(super) replay: &'a Replay,
    pub(super) hindsight: Hindsight,
    pub(super) normalizers: &'a Normalizers,
    pub(super) reward: &'a dyn Reward,
    pub(super) rng: &'a mut Rng,
    /// Scratch memory of the drawing.
    pub(super) batch: &'a mut Batch,
    /// Time spent drawing batches.
    pub(super) sampling: &'a mut Duration,
}

/// What became of the students of a cycle, in order.
pub(super) type Verdicts = Vec<Result<(), AgentError>>;

/// Takes a cycle's gradient steps with the students of `lanes`, the first of `networks`: all of them take a
/// step, then all take the next. A device is waited for at the end alone, so a student that diverges is found
/// out there and takes its remaining steps in vain; it disturbs no other.
///
/// `config` stands for all: they share whatever a gradient step depends on. Every replay buffer holds at
/// least one episode.
///
/// # Errors
/// If libtorch refuses, which concerns all of them.
///
/// # Panics
/// If there are more lanes than networks.
pub(super) fn cycle(
    learner: &mut Learner,
    networks: &mut Networks,
    lanes: &mut [Lane<'_>],
    config: &StudentConfig,
) -> Result<Verdicts, AgentError> {
    let before: Vec<u64> = (0..lanes.len()).map(|lane| networks.steps(lane)).collect();
    learner.plan(networks, config.updates_per_cycle)?;
    let mut losses = Vec::new();
    for step in 0..config.updates_per_cycle {
        learner.inputs.fill_each(step, lanes, |lane, rows| {
            let begun = Instant::now();
            lane.replay
                .sample(Source::All, lane.hindsight, lane.reward, lane.rng, lane.batch)
                .expect("a batch of this task from a buffer that is not empty");
            *lane.sampling += begun.elapsed();
            rows.write(lane.batch, lane.normalizers);
        })?;
        losses.extend(learner.update(networks)?);
        if config.polyak_every == PolyakEvery::Update {
            networks.follow(config.polyak)?;
        }
    }
    if config.polyak_every == PolyakEvery::Cycle {
        networks.follow(config.polyak)?;
    }
    verdicts(networks, &before, &losses)
}

/// Who has diverged: the first loss that is not finite tells, or else a parameter after the last step.
///
/// `losses` are those of critics and actors in turn, `before` the gradient steps before the cycle.
fn verdicts(networks: &Networks, before: &[u64], losses: &[Loss]) -> Result<Verdicts, AgentError> {
    let losses = Loss::read(losses)?;
    let finite = [networks.actor.are_finite()?, networks.critic.are_finite()?];
    let of_lane = |lane: usize| {
        if let Some(place) = losses.iter().position(|loss| !loss[lane].is_finite()) {
            let what = ["critic's loss", "actor's loss"][place % 2];
            let gradient_steps = before[lane] + place as u64 / 2 + 1;
            return Err(AgentError::Diverged { what, gradient_steps });
        }
        for (what, finite) in [("actor", finite[0][lane]), ("critic", finite[1][lane])] {
            if !finite {
                return Err(AgentError::Diverged { what, gradient_steps: networks.steps(lane) });
            }
        }
        Ok(())
    };
    Ok((0..before.len()).map(of_lane).collect())
}
