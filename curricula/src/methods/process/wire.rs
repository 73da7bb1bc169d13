//! The messages that pass between goalbench and a program: one JSON object on one line each.

use agents::Network;
use envs::Spec;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

/// Version of the messages. It is raised whenever a program of the old version would not do any more.
pub(super) const PROTOCOL: u64 = 1;

/// What goalbench says. Each message has exactly one answer, or a question that has to be answered first.
#[derive(Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub(super) enum Message<'a> {
    /// The first one. Answer: [`Answer::Ready`].
    Hello {
        protocol: u64,
        spec: Dimensions,
        /// Shape `[N, G]`.
        pool: Vec<&'a [f64]>,
        seed: u64,
        /// The key of the teacher's own stream, 32 bytes in hex.
        stream: String,
    },
    /// An episode is about to begin. Answer: [`Answer::Goal`]; an [`Answer::Ask`] may come before it.
    Propose {
        gradient_steps: u64,
        /// The start, shape `[S]`.
        state: &'a [f64],
        /// What is achieved there, shape `[G]`.
        achieved: &'a [f64],
    },
    /// An episode is over. Answer: [`Answer::Heard`].
    Episode {
        /// Shape `[G]`.
        goal: &'a [f64],
        /// Its index, if it is one of the pool.
        pool: Option<usize>,
        success: bool,
        #[serde(rename = "return")]
        total_reward: f64,
        /// What was achieved in the end, shape `[G]`.
        achieved: &'a [f64],
    },
    /// Answer: [`Answer::Saved`].
    Save {},
    /// Answer: [`Answer::Loaded`].
    Load { state: &'a str },
    /// What was asked, shape `[n]`.
    Confidence { values: Vec<f64> },
    /// What was asked, shape `[count, G]`.
    FreshGoals { goals: Vec<Vec<f64>> },
    /// What was asked, shape `[count, S]`; no row before the first episode.
    ReplayStates { states: Vec<Vec<f64>> },
    /// What was asked, shape `[count, G]`; no row before the first episode.
    ReplayAchieved { goals: Vec<Vec<f64>> },
    /// What was asked, shape `[N]` both.
    History { tries: Vec<u64>, successes: Vec<u64> },
}

impl Message<'_> {
    /// What errors call it.
    pub(super) fn name(&self) -> &'static str {
        match self {
            Self::Hello { .. } => "hello",
            Self::Propose { .. } => "propose",
            Self::Episode { .. } => "episode",
            Self::Save {} => "save",
            Self::Load { .. } => "load",
            Self::Confidence { .. } => "confidence",
            Self::FreshGoals { .. } => "fresh_goals",
            Self::ReplayStates { .. } => "replay_states",
            Self::ReplayAchieved { .. } => "replay_achieved",
            Self::History { .. } => "history",
        }
    }
}

/// The dimensions of the task.
#[derive(Serialize)]
pub(super) struct Dimensions {
    environment: &'static str,
    state: usize,
    goal: usize,
    action: usize,
    horizon: usize,
}

impl From<&Spec> for Dimensions {
    fn from(spec: &Spec) -> Self {
        let Spec { id, state, goal, action, horizon, .. } = *spec;
        Self { environment: id, state, goal, action, horizon }
    }
}

/// What a program says.
#[derive(Deserialize)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub(super) enum Answer {
    Ready {
        protocol: u64,
        /// Shape `[N]`, if it weighs the pool.
        #[serde(default)]
        weights: Option<Vec<f64>>,
        #[serde(default)]
        statistics: Map<String, Value>,
    },
    Goal {
        /// An index into the pool, "native", or a goal, shape `[G]`.
        goal: Value,
        #[serde(default)]
        score: Option<f64>,
        #[serde(default)]
        rank: Option<(usize, usize)>,
        /// Shape `[N]`; left out if they are what they were.
        #[serde(default)]
        weights: Option<Vec<f64>>,
        /// Left out if they are what they were.
        #[serde(default)]
        statistics: Option<Map<String, Value>>,
    },
    Heard {
        #[serde(default)]
        weights: Option<Vec<f64>>,
        #[serde(default)]
        statistics: Option<Map<String, Value>>,
    },
    Saved {
        state: String,
    },
    Loaded {},
    Ask(Ask),
}

impl Answer {
    /// What errors call it.
    pub(super) fn name(&self) -> &'static str {
        match self {
            Self::Ready { .. } => "ready",
            Self::Goal { .. } => "goal",
            Self::Heard { .. } => "heard",
            Self::Saved { .. } => "saved",
            Self::Loaded {} => "loaded",
            Self::Ask(_) => "ask",
        }
    }
}

/// What a program may ask before it answers `propose`.
#[derive(Deserialize)]
#[serde(tag = "what", rename_all = "snake_case", deny_unknown_fields)]
pub(super) enum Ask {
    /// The student's confidence in goals (those of the pool by default), the mean over states (the coming
    /// start by default).
    Confidence {
        /// Shape `[n, G]`.
        #[serde(default)]
        goals: Option<Vec<Vec<f64>>>,
        /// Shape `[m, S]`.
        #[serde(default)]
        states: Option<Vec<Vec<f64>>>,
        #[serde(default)]
        network: Network,
    },
    /// Goals that the environment could ask for at the coming start.
    FreshGoals { count: usize },
    /// States from the student's replay buffer.
    ReplayStates { count: usize },
    /// Achieved goals from the student's replay buffer.
    ReplayAchieved { count: usize },
    /// Episodes and successes of every goal of the pool so far.
    History {},
}
