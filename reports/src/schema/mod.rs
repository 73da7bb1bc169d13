//! The record schema: what a run writes and every report reads.

mod tuning;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

pub use tuning::{TrialPlace, TrialScore, TunedCurriculum, Tuning, TuningMeasure};

/// Version of the schema, raised whenever a field changes its meaning.
pub const SCHEMA: u32 = 1;

/// What identifies a run. Its id reads `environment/curriculum/variant/seed-N`.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunKey {
    /// Environment id.
    pub environment: String,
    /// Curriculum id.
    pub curriculum: String,
    /// Label of the protocol's variant; `default` where it has none.
    pub variant: String,
    /// Run seed.
    pub seed: u64,
}

impl std::fmt::Display for RunKey {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}/{}/{}/seed-{}", self.environment, self.curriculum, self.variant, self.seed)
    }
}

/// One evaluation: a line of `records.jsonl`. Nothing in it depends on the clock.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Record {
    /// Environment id.
    pub environment: String,
    /// Curriculum id.
    pub curriculum: String,
    /// Variant label.
    pub variant: String,
    /// Run seed.
    pub seed: u64,
    /// Steps of the budget that were taken: training steps, and those of probe rollouts that are charged
    /// (evaluation steps are not counted).
    pub step: u64,
    /// Index of the evaluation; 0 is the untrained student.
    pub eval_index: u64,
    /// Episodes in this evaluation.
    pub episodes: u64,
    /// Share of them that ended in success, in [0, 1].
    pub success_rate: f64,
    /// Share of them that were successful after at least one of their actions, from
    /// [`success_rate`](Self::success_rate) to 1; absent in files older than the field.
    #[serde(default)]
    pub any_success_rate: Option<f64>,
    /// Mean over episodes of the sum of rewards, in [-H, 0].
    pub mean_return: f64,
    /// Gradient steps taken by the student.
    pub gradient_steps: u64,
    /// Steps taken in probe rollouts that the teacher asked for; absent from the file where there are none.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub probe_steps: u64,
    /// Those of them that are not charged to the budget, so that [`step`](Self::step) does not count them;
    /// likewise.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub uncharged_steps: u64,
    /// Numbers about the teacher, by name; `null` where a number is not defined yet.
    pub teacher: Map<String, Value>,
}

impl Record {
    /// All steps taken in the environment, training and probe rollouts, charged or not; those of evaluations
    /// are not counted.
    pub fn all_steps(&self) -> u64 {
        self.step + self.uncharged_steps
    }
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_zero(number: &u64) -> bool {
    *number == 0
}

/// What the teacher did since the evaluation before: a line of `teaching.jsonl`. Nothing in it depends on the
/// clock.
#[derive(Clone, Debug, Default, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Teaching {
    /// The evaluation that it leads up to.
    pub eval_index: u64,
    /// Steps of the budget so far, as in `records.jsonl`.
    pub step: u64,
    /// The goal of every training episode in order, `[episodes, G]`, in single precision.
    pub goals: Vec<Vec<f32>>,
    /// Whether each of those episodes ended in success (with exploration noise), `[episodes]`.
    pub successes: Vec<bool>,
    /// For pool teachers the probability of every pool goal now, `[N]`, in single precision.
    pub weights: Option<Vec<f32>>,
    /// The index in the pool of every episode's goal, `[episodes]`; `null` for a goal from elsewhere.
    /// Absent in files older than the field.
    #[serde(default)]
    pub picks: Option<Vec<Option<u32>>>,
    /// The teacher's score of every episode's goal when it was chosen, `[episodes]`, in the teacher's own
    /// unit and in single precision; `null` for a goal without one. `null` for teachers that score no goals,
    /// and in files older than the field.
    #[serde(default)]
    pub scores: Option<Vec<Option<f32>>>,
    /// The rank of every episode's goal among those that the teacher chose from, `[episodes]`: 0 for the
    /// first; `null` for a goal without one. `null` for teachers that rank no goals, and in files older than
    /// the field.
    #[serde(default)]
    pub ranks: Option<Vec<Option<u32>>>,
}

/// How the student's learning stood: a line of `student.jsonl`. Nothing in it depends on the clock.
///
/// Losses, values and gradients are those that a gradient step would find on one batch, drawn and relabelled
/// as all batches are; `null` before the first episode, or where a number is not finite.
#[derive(Clone, Debug, Default, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Learning {
    /// The evaluation beside which it was taken.
    pub eval_index: u64,
    /// Steps of the budget so far, as in `records.jsonl`.
    pub step: u64,
    /// The critic's loss, mean (Q(s, g, a) − y)².
    pub critic_loss: Option<f64>,
    /// The actor's loss, −mean Q(s, g, π(s, g)) + λ·mean π².
    pub actor_loss: Option<f64>,
    /// Mean of Q(s, g, a).
    pub mean_q: Option<f64>,
    /// Euclidean norm of the critic's gradient.
    pub critic_gradient_norm: Option<f64>,
    /// Euclidean norm of the actor's gradient.
    pub actor_gradient_norm: Option<f64>,
    /// Episodes in the replay buffer.
    pub replay_episodes: u64,
    /// Transitions in the replay buffer.
    pub replay_transitions: u64,
}

impl Learning {
    /// Its numbers by name, always in the same order.
    pub fn numbers(&self) -> [(&'static str, Option<f64>); 7] {
        [
            ("critic_loss", self.critic_loss),
            ("actor_loss", self.actor_loss),
            ("mean_q", self.mean_q),
            ("critic_gradient_norm", self.critic_gradient_norm),
            ("actor_gradient_norm", self.actor_gradient_norm),
            ("replay_episodes", Some(self.replay_episodes as f64)),
            ("replay_transitions", Some(self.replay_transitions as f64)),
        ]
    }
}

/// The success that the student had at every goal of the pool: a line of `frontier.jsonl`, which runs have
/// that were asked to measure it. Nothing in it depends on the clock.
#[derive(Clone, Debug, Default, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Frontier {
    /// The evaluation beside which it was measured.
    pub eval_index: u64,
    /// Steps of the budget so far, as in `records.jsonl`.
    pub step: u64,
    /// Greedy episodes towards each goal.
    pub episodes: u64,
    /// How many of them ended in success, for every goal of the pool, `[N]`.
    pub successes: Vec<u64>,
    /// The goals of the pool, `[N][G]`, in single precision; in the first line alone, for they stay the same.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub goals: Option<Vec<Vec<f32>>>,
    /// The teacher's probability of every goal of the pool then, `[N]`, in single precision; `null` for
    /// teachers that do not weigh the pool.
    pub weights: Option<Vec<f32>>,
    /// What the teacher believed of every goal of the pool then; absent for a teacher that reports nothing,
    /// and in files older than the field.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub beliefs: Option<Beliefs>,
}

/// What a teacher believed of every goal of the pool; one that asks the student had done so when it last
/// proposed. Nothing of it is measured.
#[derive(Clone, Debug, Default, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Beliefs {
    /// How likely the teacher thought success at each goal was, `[N]`, in [0, 1] and single precision; `null`
    /// for a goal of which it had no estimate, and for a teacher that had none of any.
    pub success: Option<Vec<Option<f32>>>,
    /// How it scored each goal, `[N]`, in its own unit and in single precision: the larger, the more it
    /// wanted the goal; `null` for a goal without a score, and for a teacher that scored none.
    pub scores: Option<Vec<Option<f32>>>,
}

impl Frontier {
    /// The share of episodes that ended in success, for every goal of the pool, `[N]`.
    pub fn rates(&self) -> Vec<f64> {
        self.successes.iter().map(|&successes| successes as f64 / self.episodes as f64).collect()
    }
}

/// What the shadows of a run would have done since the evaluation before: a line of `shadow.jsonl`, which
/// runs have whose student other teachers watched. Nothing in it depends on the clock.
#[derive(Clone, Debug, Default, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Shadowing {
    /// The evaluation that it leads up to.
    pub eval_index: u64,
    /// Steps of the budget so far, as in `records.jsonl`.
    pub step: u64,
    /// Training episodes since the evaluation before.
    pub episodes: u64,
    /// The shadows, always the same in the same order.
    pub shadows: Vec<ShadowNote>,
}

/// What one shadow did.
#[derive(Clone, Debug, Default, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ShadowNote {
    /// Curriculum id.
    pub id: String,
    /// Its probability of every goal of the pool now, `[N]`, in single precision; `null` for teachers that do
    /// not weigh the pool, and for one that has failed.
    pub weights: Option<Vec<f32>>,
    /// Which goals of the pool it proposed, by rising index, and for how many of the episodes; a goal from
    /// elsewhere counts for the one of the pool that is nearest.
    pub picks: Vec<(u32, u32)>,
    /// How many of its proposals were goals from elsewhere.
    pub elsewhere: u64,
    /// What it believed of every goal of the pool, where the student was measured at these goals; absent
    /// elsewhere, for a teacher that reports nothing, and in files older than the field.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub beliefs: Option<Beliefs>,
    /// Why it has fallen silent; absent from the file of one that has not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failed: Option<String>,
}

/// Time taken: a line of `timing.jsonl`, kept apart because it differs between machines.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Timing {
    /// The evaluation it belongs to.
    pub eval_index: u64,
    /// Steps of the budget so far, as in `records.jsonl`.
    pub step: u64,
    /// Seconds of wall-clock time since the run began, evaluations included.
    pub wall_s: f64,
    /// Seconds of it spent in evaluations.
    pub evaluation_s: f64,
    /// Seconds of it spent in the teacher: proposing, observing and learning, and the probe rollouts that it
    /// asked for; absent in files older than the field.
    #[serde(default)]
    pub teacher_s: Option<f64>,
    /// Seconds of it spent in the student's gradient steps; absent in files older than the field.
    #[serde(default)]
    pub learning_s: Option<f64>,
    /// Seconds of it spent in shadows; absent from the file of a run without any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shadow_s: Option<f64>,
}

/// The name, among a manifest's versions, of the program that carries out the run: `NAME VERSION`. Runs of a
/// cell come from one.
pub const PROGRAM: &str = "program";
/// Likewise, of the version of the run's curriculum.
pub const CURRICULUM: &str = "curriculum";

/// `manifest.json`: what a run is, written before its first record.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// Version of the schema, [`SCHEMA`].
    pub schema: u32,
    /// Which run this is.
    pub run: RunKey,
    /// The complete resolved config: every field, defaults included.
    pub config: Value,
    /// SHA-256 of schema, run and config, in hex.
    pub hash: String,
    /// Versions by name: of goalbench, its commit and its native libraries, of the program that carries out
    /// the run (`program`) and of its curriculum (`curriculum`).
    pub versions: std::collections::BTreeMap<String, String>,
    /// Training steps of the budgets that were used up before the run was trained on, in order; absent from
    /// the file of a run that never was.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub earlier_budgets: Vec<u64>,
}

impl Manifest {
    /// Training steps of the whole run; `None` of a config that does not say, as of made-up results.
    pub fn budget(&self) -> Option<u64> {
        self.config.pointer("/budget/steps").and_then(Value::as_u64)
    }
}

/// How a run ended: `outcome.json`, written last.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(tag = "status", rename_all = "lowercase", deny_unknown_fields)]
pub enum Outcome {
    /// The budget is used up.
    Finished {
        /// Training steps taken.
        step: u64,
    },
    /// The run ended early: diverged learning, unstable physics.
    Failed {
        /// Training steps taken.
        step: u64,
        /// Why.
        reason: String,
    },
}

/// A worker process that went away without an outcome: a line of `crashes.jsonl`.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Crash {
    /// 0 for the first attempt of a sweep.
    pub attempt: u32,
    /// Training steps at the last evaluation before it; absent in files older than the field.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub step: Option<u64>,
    /// What is known of it.
    pub reason: String,
}
