//! Exploration noise of the behaviour policy.

use envs::rng::Rng;
use rand::Rng as _;
use rand_distr::StandardNormal;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::checks::{MOST_EPISODES, at_most, fraction, not_negative, positive};
use crate::error::AgentError;

/// Kind and strength of the exploration noise.
///
/// Either kind can be annealed: its strength (`std` and `random_epsilon`, or `sigma`) is multiplied by a
/// factor that moves linearly from 1 to `final_scale` over the first `anneal_episodes` training episodes,
/// including those of a warm-up, and then stays there.
#[derive(Clone, Copy, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum NoiseConfig {
    /// With probability `random_epsilon` a uniform action, else the policy's plus N(0, `std`²), clipped
    /// (Baselines).
    Gaussian {
        /// Standard deviation.
        ///
        /// Unit: share of the action's range. Range: at least 0. Source: Baselines.
        #[serde(default = "gaussian_std")]
        std: f64,
        /// Probability of a uniform action.
        ///
        /// Unit: none. Range: 0 to 1. Source: Baselines.
        #[serde(default = "gaussian_epsilon")]
        random_epsilon: f64,
        /// Share of the strength that is left after annealing.
        ///
        /// Unit: none. Range: 0 to 1. Source: a choice.
        #[serde(default = "unchanged")]
        final_scale: f64,
        /// Training episodes that annealing takes. With 0 the strength is constant, whatever `final_scale`
        /// says.
        ///
        /// Unit: episodes. Range: 0 to 1,000,000,000. Source: Baselines, which does not anneal.
        #[serde(default)]
        anneal_episodes: u64,
    },
    /// The policy's action plus an Ornstein-Uhlenbeck process that starts at 0 in every episode, clipped
    /// (TEACH 4.2 names it as an example; parameters: DDPG, Lillicrap et al. 2016, section 7).
    OrnsteinUhlenbeck {
        /// Rate of return to 0.
        ///
        /// Unit: 1/time. Range: at least 0. Source: DDPG.
        #[serde(default = "ou_theta")]
        theta: f64,
        /// Volatility.
        ///
        /// Unit: share of the action's range per √time. Range: at least 0. Source: DDPG.
        #[serde(default = "ou_sigma")]
        sigma: f64,
        /// Time per environment step.
        ///
        /// Unit: time. Range: above 0. Source: DDPG.
        #[serde(default = "ou_dt")]
        dt: f64,
        /// Share of the strength that is left after annealing.
        ///
        /// Unit: none. Range: 0 to 1. Source: a choice.
        #[serde(default = "unchanged")]
        final_scale: f64,
        /// Training episodes that annealing takes. With 0 the strength is constant, whatever `final_scale`
        /// says.
        ///
        /// Unit: episodes. Range: 0 to 1,000,000,000. Source: Baselines, which does not anneal.
        #[serde(default)]
        anneal_episodes: u64,
    },
}

fn gaussian_std() -> f64 {
    0.2
}
fn gaussian_epsilon() -> f64 {
    0.3
}
fn ou_theta() -> f64 {
    0.15
}
fn ou_sigma() -> f64 {
    0.2
}
fn ou_dt() -> f64 {
    1.0
}
fn unchanged() -> f64 {
    1.0
}

impl Default for NoiseConfig {
    fn default() -> Self {
        Self::gaussian(gaussian_std(), gaussian_epsilon())
    }
}

impl NoiseConfig {
    /// Uncorrelated noise of constant strength.
    pub fn gaussian(std: f64, random_epsilon: f64) -> Self {
        Self::Gaussian { std, random_epsilon, final_scale: unchanged(), anneal_episodes: 0 }
    }

    /// Correlated noise of constant strength.
    pub fn ornstein_uhlenbeck(theta: f64, sigma: f64, dt: f64) -> Self {
        Self::OrnsteinUhlenbeck { theta, sigma, dt, final_scale: unchanged(), anneal_episodes: 0 }
    }

    /// Checks the ranges.
    pub(crate) fn check(&self) -> Result<(), AgentError> {
        match *self {
            Self::Gaussian { std, random_epsilon, .. } => {
                not_negative("noise.std", std)?;
                fraction("noise.random_epsilon", random_epsilon)?;
            }
            Self::OrnsteinUhlenbeck { theta, sigma, dt, .. } => {
                not_negative("noise.theta", theta)?;
                not_negative("noise.sigma", sigma)?;
                positive("noise.dt", dt)?;
            }
        }
        let (final_scale, anneal_episodes) = self.annealing();
        fraction("noise.final_scale", final_scale)?;
        at_most("noise.anneal_episodes", anneal_episodes, MOST_EPISODES)
    }

    /// `final_scale` and `anneal_episodes`.
    fn annealing(&self) -> (f64, u64) {
        match *self {
            Self::Gaussian { final_scale, anneal_episodes, .. }
            | Self::OrnsteinUhlenbeck { final_scale, anneal_episodes, .. } => (final_scale, anneal_episodes),
        }
    }
}

/// The noise process of one student.
#[derive(Clone, Debug)]
pub(crate) struct Noise {
    config: NoiseConfig,
    /// State of the correlated process, shape `[A]`; unused by uncorrelated noise.
    process: Vec<f64>,
}

impl Noise {
    pub(crate) fn new(config: NoiseConfig, actions: usize) -> Self {
        Self { config, process: vec![0.0; actions] }
    }

    /// Starts an episode.
    pub(crate) fn begin_episode(&mut self) {
        self.process.fill(0.0);
    }

    /// Turns the policy's `action` (`[A]`) into an exploring one in [-1, 1]. `before` is the number of
    /// training episodes before this one.
    pub(crate) fn apply(&mut self, action: &mut [f64], before: u64, rng: &mut Rng) {
        let (final_scale, anneal_episodes) = self.config.annealing();
        let scale = annealed(before, anneal_episodes, final_scale);
        match self.config {
            NoiseConfig::Gaussian { std, random_epsilon, .. } => {
                if rng.random_bool(scale * random_epsilon) {
                    uniform(action, rng);
                } else {
                    let std = scale * std;
                    for component in action {
                        *component += std * rng.sample::<f64, _>(StandardNormal);
                        *component = component.clamp(-1.0, 1.0);
                    }
                }
            }
            NoiseConfig::OrnsteinUhlenbeck { theta, sigma, dt, .. } => {
                let sigma = scale * sigma;
                for (component, x) in action.iter_mut().zip(&mut self.process) {
                    *x = ornstein_uhlenbeck(*x, theta, sigma, dt, rng.sample(StandardNormal));
                    *component = (*component + *x).clamp(-1.0, 1.0);
                }
            }
        }
    }

    /// The process's state, for saving.
    pub(crate) fn process(&self) -> &[f64] {
        &self.process
    }

    /// Takes back a saved state of the same length.
    pub(crate) fn set_process(&mut self, process: &[f64]) {
        self.process.copy_from_slice(process);
    }
}

/// Fills `action` with numbers drawn uniformly from [-1, 1].
pub(crate) fn uniform(action: &mut [f64], rng: &mut Rng) {
    action.fill_with(|| rng.random_range(-1.0..=1.0));
}

/// (1 − p) + p·`final_scale` with p = min(`before`/`episodes`, 1): the factor of the noise's strength after
/// `before` episodes. 1 if `episodes` is 0.
fn annealed(before: u64, episodes: u64, final_scale: f64) -> f64 {
    if episodes == 0 {
        return 1.0;
    }
    let progress = (before as f64 / episodes as f64).min(1.0);
    (1.0 - progress) + progress * final_scale
}

/// One Euler-Maruyama step of dx = −θ·x·dt + σ·dW from `x`, with the standard normal draw `normal`
/// (Uhlenbeck and Ornstein 1930; DDPG, section 7).
fn ornstein_uhlenbeck(x: f64, theta: f64, sigma: f64, dt: f64, normal: f64) -> f64 {
    x - theta * x * dt + sigma * dt.sqrt() * normal
}

#[cfg(test)]
mod tests {
    use envs::rng::{Purpose, stream};

    use super::{Noise, NoiseConfig, annealed, ornstein_uhlenbeck};

    #[test]
    fn ornstein_uhlenbeck_step_by_hand() {
        // 2 - 0.5*2*0.25 + 0.4*0.5*(-1) = 2 - 0.25 - 0.2
        assert!((ornstein_uhlenbeck(2.0, 0.5, 0.4, 0.25, -1.0) - 1.55).abs() < 1e-15);
    }

    #[test]
    fn annealing_by_hand() {
        // From 1 to 0.2 over 8 episodes: 0.1 less with each.
        for (before, factor) in [(0, 1.0), (2, 0.8), (4, 0.6), (7, 0.3), (8, 0.2), (9, 0.2), (u64::MAX, 0.2)]
        {
            assert!((annealed(before, 8, 0.2) - factor).abs() < 1e-15, "{before}");
        }
        for before in [0, 1, 100] {
            assert_eq!(annealed(before, 0, 0.2), 1.0, "constant");
            assert_eq!(annealed(before, 7, 1.0), 1.0, "to what it was");
        }
    }

    /// Half-way through annealing, the noise equals constant noise of that strength bit by bit.
    #[test]
    fn annealing_scales_the_strength_and_nothing_else() {
        let (final_scale, anneal_episodes) = (0.5, 10);
        for (annealing, constant) in [
            (
                NoiseConfig::Gaussian { std: 0.4, random_epsilon: 0.5, final_scale, anneal_episodes },
                NoiseConfig::gaussian(0.75 * 0.4, 0.75 * 0.5),
            ),
            (
                NoiseConfig::OrnsteinUhlenbeck {
                    theta: 0.15,
                    sigma: 0.4,
                    dt: 1.0,
                    final_scale,
                    anneal_episodes,
                },
                NoiseConfig::ornstein_uhlenbeck(0.15, 0.75 * 0.4, 1.0),
            ),
        ] {
            let explore = |config, before| {
                let (mut noise, mut rng) = (Noise::new(config, 2), stream(7, Purpose::Exploration));
                let mut actions = [[0.1, -0.2]; 50];
                actions.iter_mut().for_each(|action| noise.apply(action, before, &mut rng));
                (actions, rng)
            };
            assert_eq!(explore(annealing, 5), explore(constant, 0));
            assert_ne!(explore(annealing, 4).0, explore(constant, 0).0);
            assert_eq!(explore(annealing, 10), explore(annealing, 1000));
        }
    }

    /// Mean and standard deviation of the first component over many exploring actions around `centre`.
    fn moments(config: NoiseConfig, centre: f64) -> (f64, f64) {
        let mut rng = stream(7, Purpose::Exploration);
        let mut noise = Noise::new(config, 2);
        let n = 20_000;
        let draws: Vec<f64> = (0..n)
            .map(|_| {
                let mut action = [centre, 0.0];
                noise.apply(&mut action, 0, &mut rng);
                assert!(action.iter().all(|a| a.abs() <= 1.0));
                action[0]
            })
            .collect();
        let mean = draws.iter().sum::<f64>() / n as f64;
        let variance = draws.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n as f64;
        (mean, variance.sqrt())
    }

    #[test]
    fn gaussian_noise_has_the_standard_deviation_asked_for() {
        let (mean, std) = moments(NoiseConfig::gaussian(0.2, 0.0), 0.1);
        assert!((mean - 0.1).abs() < 0.01 && (std - 0.2).abs() < 0.01, "{mean} {std}");
    }

    /// Around an action at the bound, half of the draws would lie beyond it.
    #[test]
    fn exploring_actions_are_clipped_in_every_component() {
        for config in [NoiseConfig::gaussian(0.5, 0.0), NoiseConfig::ornstein_uhlenbeck(0.15, 0.5, 1.0)] {
            let mut noise = Noise::new(config, 2);
            let mut rng = stream(7, Purpose::Exploration);
            let draws: Vec<[f64; 2]> = (0..1000)
                .map(|_| {
                    let mut action = [1.0, -1.0];
                    noise.apply(&mut action, 0, &mut rng);
                    action
                })
                .collect();
            for (component, bound) in [(0, 1.0), (1, -1.0)] {
                let clipped = draws.iter().filter(|action| action[component] == bound).count();
                assert!((300..700).contains(&clipped), "{config:?}, component {component}: {clipped}");
                assert!(draws.iter().all(|action| action[component].abs() <= 1.0), "{config:?}");
            }
        }
    }

    #[test]
    fn random_actions_are_uniform_whatever_the_policy_says() {
        let (mean, std) = moments(NoiseConfig::gaussian(0.2, 1.0), 0.9);
        assert!(mean.abs() < 0.02 && (std - 1.0 / 3f64.sqrt()).abs() < 0.01, "{mean} {std}");
    }

    #[test]
    fn ornstein_uhlenbeck_noise_is_correlated_and_starts_anew_with_the_episode() {
        let config = NoiseConfig::ornstein_uhlenbeck(0.15, 0.05, 1.0);
        // Stationary variance of the discrete process: sigma^2 / (1 - (1 - theta)^2).
        let expected = 0.05 / (1.0 - 0.85f64.powi(2)).sqrt();
        let (_, std) = moments(config, 0.0);
        assert!((std - expected).abs() < 0.05 * expected, "{std} against {expected}");

        let mut noise = Noise::new(config, 1);
        noise.apply(&mut [0.0], 0, &mut stream(7, Purpose::Exploration));
        assert_ne!(noise.process(), [0.0]);
        noise.begin_episode();
        assert_eq!(noise.process(), [0.0]);
    }
}
