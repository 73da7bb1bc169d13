//! The student's hyper-parameters.
//!
//! Defaults are TEACH's values where the paper gives one, else those of the public HER configuration of
//! OpenAI Baselines, which VDS's official code shares.

use envs::Spec;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::auto::Auto;
use crate::checks::{MOST_EPISODES, accept, at_most, between, fraction, not_negative, positive};
use crate::device::Device;
use crate::draw::{HerStrategy, Hindsight};
use crate::error::AgentError;
use crate::noise::NoiseConfig;
use crate::normalizer::NormalizerConfig;
use crate::precision::Precision;

/// Id of the agent that a config without one means.
pub(crate) const DEFAULT_AGENT: &str = "ddpg-her";

/// Which values the fields left at "auto" take.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Preset {
    /// One student for all curricula: batch 1024, as many layers as the environment says (TEACH, section
    /// 5.2), 2 episodes per cycle.
    #[default]
    Harmonised,
    /// The settings of the compared methods' official code: batch 256, three hidden layers (VDS,
    /// `vds_config`), learning after every single episode (`baselines.ve_run`).
    Official,
}

/// When the target networks follow the trained ones.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PolyakEvery {
    /// After the gradient steps of a cycle (Baselines).
    #[default]
    Cycle,
    /// After every gradient step (DDPG, Algorithm 1, with an α of 0.999).
    Update,
}

/// What is left out of a config: it has the hash that it had before there was such a field.
#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde calls it")]
fn is_false(value: &bool) -> bool {
    !value
}

/// All hyper-parameters of the student.
///
/// ```
/// use agents::{Auto, Preset, StudentConfig};
///
/// let env = envs::make("Point", &envs::EnvOptions::default()).unwrap();
/// let config = StudentConfig::preset(Preset::Official).resolve(env.spec()).unwrap();
/// assert_eq!((config.batch, config.layers), (Auto::Value(256), Auto::Value(3)));
///
/// let error = StudentConfig { polyak: 2.0, ..StudentConfig::default() }.resolve(env.spec()).unwrap_err();
/// assert_eq!(error.to_string(), "student.polyak: 2 given, a number in [0, 1] accepted");
/// ```
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct StudentConfig {
    /// Which agent, by its id.
    ///
    /// Source: HER (Andrychowicz et al. 2017), whose student TEACH 4.2 takes.
    pub agent: String,
    /// Which values the fields left at "auto" take: `batch`, `layers`, `episodes_per_cycle`, and those of
    /// `curriculum.vds`.
    ///
    /// Source: TEACH 5.2; `official`: the compared methods' code.
    pub preset: Preset,
    /// Where the networks live.
    ///
    /// Source: a choice.
    pub device: Device,
    /// What the wide products of a gradient step are computed in: `f32` (the paper's) or `bf16`, which
    /// processors with AVX512-BF16 or AMX do faster.
    ///
    /// Source: a choice.
    pub precision: Precision,
    /// Whether a GPU may round the factors of its products of singles to TF32, numbers with the range of a
    /// single and a precision of 11 bits: faster from the Ampere generation on. Only with `device = "cuda"`.
    ///
    /// Source: a choice.
    #[serde(skip_serializing_if = "is_false")]
    pub tf32: bool,
    /// Transitions per gradient step.
    ///
    /// Unit: transitions. Range: 1 to 1,000,000. Auto: 1024; with `official` 256. Source: TEACH 5.2; VDS's
    /// code.
    pub batch: Auto<usize>,
    /// Units per hidden layer.
    ///
    /// Unit: units. Range: 1 to 16,384. Source: Baselines; TEACH does not say.
    pub width: usize,
    /// Hidden layers of each network.
    ///
    /// Unit: layers. Range: 1 to 8. Auto: what the environment says; with `official` 3. Source: TEACH 5.2;
    /// VDS's code.
    pub layers: Auto<usize>,
    /// Discount γ of future rewards.
    ///
    /// Unit: none. Range: 0 to below 1. Auto: 1 − 1/H for episodes of H steps. Source: Baselines.
    pub gamma: Auto<f64>,
    /// Adam's step size for the actor.
    ///
    /// Unit: none. Range: above 0. Source: Baselines.
    pub actor_lr: f64,
    /// Adam's step size for the critic.
    ///
    /// Unit: none. Range: above 0. Source: TEACH 5.2.
    pub critic_lr: f64,
    /// Weight α of the old target networks: target ← α·target + (1 − α)·online.
    ///
    /// Unit: none. Range: 0 to 1. Source: Baselines; TEACH, Eq. 12, gives no α.
    pub polyak: f64,
    /// When the target networks follow the trained ones.
    ///
    /// Source: Baselines.
    pub polyak_every: PolyakEvery,
    /// Training episodes per cycle: gradient steps follow after each cycle.
    ///
    /// Unit: episodes. Range: 1 to 1,000,000. Auto: 2; with `official` 1. Source: Baselines; VDS's code.
    pub episodes_per_cycle: Auto<usize>,
    /// Gradient steps per cycle.
    ///
    /// Unit: gradient steps. Range: 1 to 1,000,000. Source: Baselines.
    pub updates_per_cycle: usize,
    /// Hindsight goals k per real goal: a transition is relabelled with probability k/(k + 1), never for 0.
    ///
    /// Unit: goals. Range: 0 to 1,000,000. Source: HER.
    pub her_k: u32,
    /// Which achieved goals of its episode a transition is relabelled with.
    ///
    /// Source: Baselines; best in HER, section 4.5.
    pub her_strategy: HerStrategy,
    /// Weight of the mean squared action in the actor's loss.
    ///
    /// Unit: none. Range: at least 0. Source: Baselines.
    pub action_l2: f64,
    /// Exploration noise.
    pub noise: NoiseConfig,
    /// How many training episodes at the start take uniformly random actions. Learning begins with the first
    /// cycle that ends after them.
    ///
    /// Unit: episodes. Range: 0 to 1,000,000,000. Source: Baselines.
    pub warmup_episodes: u64,
    /// Transitions kept for replay, rounded down to whole episodes; room for one episode is the least.
    ///
    /// Unit: transitions. Range: 1 to 1,000,000,000. Source: Baselines.
    pub replay_capacity: usize,
    /// Input normalisation.
    pub normalizer: NormalizerConfig,
}

impl Default for StudentConfig {
    fn default() -> Self {
        Self {
            agent: DEFAULT_AGENT.to_owned(),
            preset: Preset::default(),
            device: Device::default(),
            precision: Precision::default(),
            tf32: false,
            batch: Auto::Auto,
            width: 256,
            layers: Auto::Auto,
            gamma: Auto::Auto,
            actor_lr: 1e-3,
            critic_lr: 1e-3,
            polyak: 0.95,
            polyak_every: PolyakEvery::default(),
            episodes_per_cycle: Auto::Auto,
            updates_per_cycle: 40,
            her_k: 4,
            her_strategy: HerStrategy::default(),
            action_l2: 1.0,
            noise: NoiseConfig::default(),
            warmup_episodes: 0,
            replay_capacity: 1_000_000,
            normalizer: NormalizerConfig::default(),
        }
    }
}

impl StudentConfig {
    /// The values of `preset`.
    pub fn preset(preset: Preset) -> Self {
        Self { preset, ..Self::default() }
    }

    /// Transitions per gradient step.
    pub fn batch(&self) -> usize {
        self.batch.value_or(|| match self.preset {
            Preset::Harmonised => 1024,
            Preset::Official => 256,
        })
    }

    /// Hidden layers for the task `spec`.
    pub fn layers(&self, spec: &Spec) -> usize {
        self.layers.value_or(|| match self.preset {
            Preset::Harmonised => spec.defaults.layers,
            Preset::Official => 3,
        })
    }

    /// Discount γ for the task `spec`.
    pub fn gamma(&self, spec: &Spec) -> f64 {
        self.gamma.value_or(|| 1.0 - 1.0 / spec.horizon as f64)
    }

    /// Episodes per cycle.
    pub fn episodes_per_cycle(&self) -> usize {
        self.episodes_per_cycle.value_or(|| match self.preset {
            Preset::Harmonised => 2,
            Preset::Official => 1,
        })
    }

    /// How transitions are relabelled.
    pub fn hindsight(&self) -> Hindsight {
        Hindsight { k: self.her_k, strategy: self.her_strategy }
    }

    /// The same student on `device`, with what only a GPU does left out on a CPU.
    #[must_use]
    pub fn on(self, device: Device) -> Self {
        Self { tf32: self.tf32 && device == Device::Cuda, device, ..self }
    }

    /// This config without what students that learn in lockstep may differ in: exploration, relabelling,
    /// warm-up, replay buffer and normalisation are each student's own. Students of one task whose resolved
    /// configs are alike otherwise can be lanes of one [`Cohort`](crate::Cohort).
    #[must_use]
    pub fn in_lockstep(&self) -> Self {
        let Self { preset, noise, her_k, her_strategy, warmup_episodes, replay_capacity, normalizer, .. } =
            Self::default();
        Self {
            preset,
            noise,
            her_k,
            her_strategy,
            warmup_episodes,
            replay_capacity,
            normalizer,
            ..self.clone()
        }
    }

    /// This config for the task `spec`: every "auto" that stands for a number is replaced by that number, and
    /// all ranges are checked.
    ///
    /// # Errors
    /// [`AgentError::Config`] naming the field and what it accepts.
    pub fn resolve(self, spec: &Spec) -> Result<Self, AgentError> {
        let resolved = Self {
            batch: Auto::Value(self.batch()),
            layers: Auto::Value(self.layers(spec)),
            gamma: Auto::Value(self.gamma(spec)),
            episodes_per_cycle: Auto::Value(self.episodes_per_cycle()),
            ..self
        };
        resolved.check(spec)?;
        Ok(resolved)
    }

    fn check(&self, spec: &Spec) -> Result<(), AgentError> {
        let known: Vec<&str> = crate::registry::AGENTS.iter().map(|row| row.id).collect();
        accept("agent", known.contains(&self.agent.as_str()), || {
            format!("unknown agent `{}`; accepted: {}", self.agent, known.join(", "))
        })?;
        accept("tf32", !self.tf32 || self.device == Device::Cuda, || {
            "true given, but it is a GPU that rounds to TF32: with student.device = \"cuda\" accepted"
                .to_owned()
        })?;
        between("batch", self.batch(), 1, 1_000_000)?;
        between("width", self.width, 1, 16_384)?;
        between("layers", self.layers(spec), 1, 8)?;
        let gamma = self.gamma(spec);
        accept("gamma", (0.0..1.0).contains(&gamma), || {
            format!("{gamma} given, a number in [0, 1) accepted")
        })?;
        positive("actor_lr", self.actor_lr)?;
        positive("critic_lr", self.critic_lr)?;
        fraction("polyak", self.polyak)?;
        between("episodes_per_cycle", self.episodes_per_cycle(), 1, 1_000_000)?;
        between("updates_per_cycle", self.updates_per_cycle, 1, 1_000_000)?;
        at_most("her_k", u64::from(self.her_k), 1_000_000)?;
        not_negative("action_l2", self.action_l2)?;
        between("replay_capacity", self.replay_capacity, spec.horizon, 1_000_000_000)?;
        self.noise.check()?;
        at_most("warmup_episodes", self.warmup_episodes, MOST_EPISODES)?;
        self.normalizer.check()
    }
}

#[cfg(test)]
mod tests {
    use super::{PolyakEvery, Preset, StudentConfig};
    use crate::auto::Auto;
    use crate::device::Device;
    use crate::draw::HerStrategy;
    use crate::noise::NoiseConfig;
    use crate::normalizer::NormalizerConfig;
    use crate::precision::Precision;

    fn read(text: &str) -> Result<StudentConfig, String> {
        toml::from_str(text).map_err(|error| error.to_string())
    }

    #[test]
    fn what_is_not_given_has_its_default() {
        assert_eq!(read(""), Ok(StudentConfig::default()));
        assert_eq!(read("preset = 'official'"), Ok(StudentConfig::preset(Preset::Official)));
        let config = read("layers = 1\nnoise = { kind = 'ornstein-uhlenbeck', theta = 0.5 }").unwrap();
        assert_eq!(config.layers, Auto::Value(1));
        assert_eq!(config.noise, NoiseConfig::ornstein_uhlenbeck(0.5, 0.2, 1.0));
        assert_eq!(read("noise = { kind = 'gaussian' }"), Ok(StudentConfig::default()));
    }

    #[test]
    fn unknown_names_are_refused_with_the_known_ones() {
        assert!(read("momentum = 0.9").unwrap_err().contains("expected one of `agent`"));
        assert!(read("precision = 'f16'").unwrap_err().contains("`f32` or `bf16`"));
        assert!(read("preset = 'best'").unwrap_err().contains("`harmonised`"));
        assert!(read("polyak_every = 'step'").unwrap_err().contains("`cycle` or `update`"));
        assert!(read("her_strategy = 'random'").unwrap_err().contains("`future`, `final`, `episode`"));
        assert!(read("noise = { kind = 'pink' }").unwrap_err().contains("`ornstein-uhlenbeck`"));
        assert!(read("noise = { kind = 'gaussian', sigma = 1.0 }").unwrap_err().contains("`random_epsilon`"));
        assert!(read("normalizer = { floor = 1.0 }").unwrap_err().contains("`std_floor`"));
    }

    #[test]
    fn tf32_is_for_gpus_and_is_written_only_where_it_is_used() {
        let env = envs::make("Point", &envs::EnvOptions::default()).unwrap();
        let resolve = |text: &str| read(text).unwrap().resolve(env.spec()).map_err(|error| error.to_string());
        let refusal = resolve("tf32 = true").unwrap_err();
        assert!(refusal.starts_with("student.tf32: true given") && refusal.contains("cuda"), "{refusal}");
        let used = resolve("tf32 = true\ndevice = 'cuda'").unwrap();
        assert_eq!(read(&toml::to_string(&used).unwrap()), Ok(used.clone()));
        let there_and_back = used.clone().on(Device::Cuda).on(Device::Cpu);
        assert_eq!(there_and_back.resolve(env.spec()).unwrap(), resolve("").unwrap());
        assert!(!toml::to_string(&StudentConfig::default()).unwrap().contains("tf32"));
    }

    #[test]
    fn toml_and_json_bring_back_what_was_written() {
        let normalizer = NormalizerConfig {
            pseudo_observations: 2,
            feed_episodes: Auto::Value(30),
            ..NormalizerConfig::default()
        };
        let (final_scale, anneal_episodes) = (0.5, 40);
        for noise in [
            NoiseConfig::Gaussian { std: 0.1, random_epsilon: 0.2, final_scale, anneal_episodes },
            NoiseConfig::OrnsteinUhlenbeck { theta: 0.1, sigma: 0.3, dt: 0.5, final_scale, anneal_episodes },
        ] {
            let config = StudentConfig {
                gamma: Auto::Value(0.9),
                polyak_every: PolyakEvery::Update,
                episodes_per_cycle: Auto::Value(3),
                her_strategy: HerStrategy::Episode,
                noise,
                warmup_episodes: 20,
                precision: Precision::Bf16,
                normalizer,
                ..StudentConfig::preset(Preset::Official)
            };
            for config in [config, StudentConfig { noise, ..StudentConfig::default() }] {
                assert_eq!(read(&toml::to_string(&config).unwrap()), Ok(config.clone()));
                let json = serde_json::to_string(&config).unwrap();
                assert_eq!(serde_json::from_str::<StudentConfig>(&json).unwrap(), config);
            }
        }
    }
}
