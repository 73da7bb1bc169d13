//! TEACH: train on the goals whose value is moving (Chaudhary and Behera, "TEACH: Temporal Variance-Driven
//! Curriculum for Reinforcement Learning", arXiv 2512.22824, Algorithm 2).
//!
//! While the student learns to reach a goal, the critic's value of that goal changes; for goals it has mastered
//! and goals out of its reach the value stands still. So the teacher evaluates the policy confidence C(g) of
//! every goal of the pool now and then (Eq. 7, [`Probe`](crate::Probe)), remembers the last n evaluations ([`Window`]), takes
//! each goal's variance over time δ_i (Eq. 8-9), and draws goals from the curriculum K(g_i) = δ_i / Σδ
//! (Eq. 10-11, [`Distribution::proportional`]).
//!
//! # Deviations and choices
//! - "One timestep" of the window is one evaluation. The paper does not say what it is.
//! - An evaluation falls due every Δ episodes, and is left out if the networks have not changed since the last
//!   one: all it could add is what differs between starts and normalisers. With the student's cycle of two
//!   episodes, Δ = 1 therefore comes to one evaluation per cycle, and Δ = 2 to the very same ones.
//! - With `states = "replay"` an evaluation that falls due before there are any states is made as soon as there are.
//! - Where starts are random (Fetch with an object, HandManipulate*), the variance with `initial` states includes
//!   that of the starts, and always that of the input normalisers.
//! - The variance is taken over the evaluations there are, also while the window still fills up. With fewer than
//!   two, or when no value moves beyond rounding, the curriculum is uniform.
//! - C(g) averages over s ~ D, which the paper leaves open: here the start state of the coming episode, or
//!   replayed states (`states`).
//! - Equations say "in proportion to K", section 5.2 says "the goal with the highest variance": `selection`.
//!   With `argmax`, ties are drawn evenly.
//! - Goals of the pool are set at other starts than they were drawn for: for HandManipulate* see
//!   [`her_iid_pool`](super::her_iid_pool).

use std::sync::Arc;

use agents::Network;
use envs::Goals;
use serde::{Deserialize, Serialize};

use crate::curriculum::{Curriculum, Lesson, Proposal, Setting, Statistics};
use crate::distribution::Distribution;
use crate::error::CurriculumError;
use crate::pool_state::PoolState;
use crate::probe::{Answer, ProbeConfig, StateSource};
use crate::registry::Method;
use crate::snapshot;
use crate::variance::rounding;
use crate::window::Window;

/// Version of [`State`] in saved bytes.
const VERSION: u32 = 2;

/// TEACH's options.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TeachConfig {
    /// n, evaluations in the window; at least 2. Paper: 10, and 3 in Figure 3.
    pub window: usize,
    /// Δ, episodes between evaluations; at least 1. Paper: 1.
    pub interplay: u64,
    /// Networks that answer: `online` (paper) or `target` (Figure 3).
    pub confidence: Network,
    /// States that C(g) averages over: `initial` (choice) or `replay`.
    pub states: StateSource,
    /// M, number of states with `states = "replay"`; 1 to 1024. Choice: 8.
    pub replay_states: usize,
    /// `proportional` (Eq. 11) or `argmax` (section 5.2).
    pub selection: Selection,
}

/// How TEACH turns the curriculum K into a goal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Selection {
    /// A draw from K.
    #[default]
    Proportional,
    /// The goal with the largest K.
    Argmax,
}

impl Default for TeachConfig {
    fn default() -> Self {
        Self {
            window: 10,
            interplay: 1,
            confidence: Network::Online,
            states: StateSource::Initial,
            replay_states: 8,
            selection: Selection::Proportional,
        }
    }
}

impl TeachConfig {
    fn probe(&self) -> ProbeConfig {
        ProbeConfig { network: self.confidence, states: self.states, replay_states: self.replay_states }
    }
}

/// The TEACH teacher.
pub struct Teach {
    config: TeachConfig,
    pool: Arc<Goals>,
    state: State,
}

/// Everything that changes while teaching.
#[derive(Serialize, Deserialize)]
struct State {
    /// Goals proposed so far.
    episodes: u64,
    /// Whether an evaluation has fallen due that could not be made yet.
    due: bool,
    window: Window,
    common: PoolState,
}

impl Method for Teach {
    type Config = TeachConfig;
    const ID: &'static str = "teach";
    const TITLE: &'static str = "TEACH";
    const SOURCE: &'static str = "Chaudhary and Behera, TEACH, arXiv 2512.22824";
    const USES_POOL: bool = true;

    fn check(config: &TeachConfig) -> Result<(), CurriculumError> {
        CurriculumError::require(config.window >= 2, "window", "at least 2", config.window)?;
        CurriculumError::require(config.interplay >= 1, "interplay", "at least 1", config.interplay)?;
        config.probe().check()
    }

    fn build(config: TeachConfig, setting: &Setting) -> Result<Box<dyn Curriculum>, CurriculumError> {
        let pool = Arc::clone(&setting.pool);
        let state = State {
            episodes: 0,
            due: false,
            window: Window::new(config.window),
            common: PoolState::new(Distribution::uniform(pool.len())),
        };
        Ok(Box::new(Self { config, pool, state }))
    }
}

/// K: in proportion to each goal's variance over the window, or all on the largest. `lowest` is −1/(1−γ).
fn curriculum(window: &Window, selection: Selection, lowest: f64) -> Result<Distribution, CurriculumError> {
    let negligible = rounding(lowest).powi(2);
    let proportional = Distribution::proportional(&window.variance(), negligible, "temporal variance")?;
    match selection {
        Selection::Proportional => Ok(proportional),
        Selection::Argmax => Distribution::argmax(proportional.probabilities(), "curriculum"),
    }
}

impl Curriculum for Teach {
    fn propose(&mut self, lesson: &mut Lesson<'_>) -> Result<Proposal, CurriculumError> {
        let state = &mut self.state;
        state.due |= state.episodes.is_multiple_of(self.config.interplay);
        state.episodes += 1;
        if state.due {
            let answer = state.common.probe.ask(&self.config.probe(), &self.pool, lesson)?;
            state.due = answer == Answer::NoStates;
            if let Answer::Confidence(confidence) = answer {
                state.window.push(confidence);
                let lowest = lesson.student.lowest_value();
                state.common.curriculum = curriculum(&state.window, self.config.selection, lowest)?;
            }
        }
        Ok(Proposal::Pool(state.common.curriculum.draw(lesson.rng)))
    }

    fn weights(&self) -> Option<&[f64]> {
        Some(self.state.common.curriculum.probabilities())
    }

    fn statistics(&self) -> Statistics {
        self.state.common.statistics()
    }

    fn save(&self) -> Result<Vec<u8>, CurriculumError> {
        Ok(snapshot::save(Self::ID, VERSION, &self.state))
    }

    fn load(&mut self, bytes: &[u8]) -> Result<(), CurriculumError> {
        let state: State = snapshot::load(Self::ID, VERSION, bytes)?;
        state.common.check(self.pool.len())?;
        for evaluation in state.window.iter() {
            snapshot::require_goals(evaluation.len(), self.pool.len())?;
        }
        let (written, held, own) = (state.window.capacity(), state.window.len(), self.config.window);
        if written != own || held > own {
            let reason = format!("{held} evaluations in a window of {written}; its config says {own}");
            return Err(snapshot::refuse(reason));
        }
        self.state = state;
        Ok(())
    }
}
