//! What a search over settings chose, and why.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

/// What a search over the settings of curricula chose, and what it chose by: `tuning/choice.json` of a
/// results folder. Nothing in it depends on the clock.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tuning {
    /// The number of a run that counts: `area` under its curve, or `final` success.
    pub measure: TuningMeasure,
    /// The seed that settings were drawn with.
    pub search_seed: u64,
    /// The seeds of the runs that it was chosen by.
    pub seeds: Vec<u64>,
    /// Draws of settings for each curriculum with ranges; the default settings are not counted among them.
    pub trials: u64,
    /// Environment ids.
    pub environments: Vec<String>,
    /// What was chosen for each curriculum.
    pub curricula: Vec<TunedCurriculum>,
}

/// What a search goes by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TuningMeasure {
    /// The area under the curve of success rates, divided by the steps it spans: how soon and how well a run
    /// learned.
    #[default]
    Area,
    /// The success rate averaged over the last 5 evaluations.
    Final,
}

/// The settings of one curriculum.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TunedCurriculum {
    /// Curriculum id.
    pub curriculum: String,
    /// What each setting was drawn from, in words; empty for a curriculum without ranges.
    pub ranges: Vec<String>,
    /// The variant of the best trial: `trial-07`, or `default` where no trial was better.
    pub chosen: String,
    /// Why that one, in words.
    pub reason: String,
    /// What was tried: the default settings, then every trial; empty for a curriculum without ranges.
    pub tried: Vec<TrialScore>,
}

/// Settings that were tried, and what came of them.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrialScore {
    /// Variant of its runs.
    pub variant: String,
    /// The drawn settings by config path; empty for the default ones.
    pub settings: Map<String, Value>,
    /// The mean over environments of the means over seeds of the measure, in [0, 1].
    pub score: f64,
    /// The same in each environment.
    pub places: Vec<TrialPlace>,
}

/// The runs of a trial in one environment.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrialPlace {
    /// Environment id.
    pub environment: String,
    /// The mean over seeds of the measure, in [0, 1].
    pub score: f64,
    /// The measure of the run of each seed, in the order of the seeds. A run that failed counts 0 from its
    /// failure on.
    pub by_seed: Vec<f64>,
    /// Runs that failed.
    pub failed: u64,
    /// Steps that the runs took together, probe rollouts included.
    pub steps: u64,
}

impl TuningMeasure {
    /// As in protocols: `area`, `final`.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Area => "area",
            Self::Final => "final",
        }
    }

    /// For people.
    pub const fn in_words(self) -> &'static str {
        match self {
            Self::Area => "area under the curve",
            Self::Final => "final success",
        }
    }
}

impl TunedCurriculum {
    /// The default settings among those that were tried.
    pub fn untuned(&self) -> Option<&TrialScore> {
        self.tried.first()
    }

    /// The drawn ones.
    pub fn drawn(&self) -> &[TrialScore] {
        self.tried.get(1..).unwrap_or_default()
    }

    /// The chosen one; `None` for a curriculum without ranges.
    pub fn best(&self) -> Option<&TrialScore> {
        self.tried.iter().find(|trial| trial.variant == self.chosen)
    }
}

impl TrialScore {
    /// `curriculum.teach.window = 5; student.polyak = 0.9`; `the default ones` without any.
    pub fn said(&self) -> String {
        let said = |(path, value): (&String, &Value)| {
            let value = value.as_str().map_or_else(|| value.to_string(), str::to_owned);
            format!("{path} = {value}")
        };
        let parts: Vec<String> = self.settings.iter().map(said).collect();
        if parts.is_empty() { "the default ones".to_owned() } else { parts.join("; ") }
    }

    /// Its runs in this environment.
    pub fn place(&self, environment: &str) -> Option<&TrialPlace> {
        self.places.iter().find(|place| place.environment == environment)
    }
}
