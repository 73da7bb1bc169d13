//! Seeded random streams, one per purpose.
//!
//! Everything random in a run comes from a stream that is a pure function of (run seed, purpose). Two runs
//! that differ only in their curriculum therefore share initial weights, start states, goal pool and
//! evaluation episodes: their comparison is paired.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use sha2::{Digest, Sha256};

/// The generator behind every stream. Its state is serialisable, and its output is the same on every machine.
pub type Rng = ChaCha8Rng;

/// What a stream is for. Each purpose has a stream of its own, so that a change in how often one purpose
/// draws never shifts the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Purpose {
    /// Initial network weights.
    Weights,
    /// Start states and native goals of the training episodes.
    Environment,
    /// Exploration noise of the behaviour policy.
    Exploration,
    /// Replay sampling, hindsight relabelling included.
    Replay,
    /// Everything the teacher draws.
    Teacher,
    /// The pool of candidate goals.
    Pool,
    /// The evaluation with this index: its start states and goals.
    Evaluation(u64),
    /// The batch on which the student is diagnosed at the evaluation with this index.
    Diagnosis(u64),
    /// Start state and exploration noise of the probe episode with this index.
    Rollout(u64),
    /// Start states of the episodes that measure every goal of the pool at the evaluation with this index.
    Frontier(u64),
    /// The seed of everything that a shadow teacher draws; the number stands for its curriculum.
    Shadow(u64),
    /// One setting of one trial of a search before training; its seed is independent of the seeds of runs,
    /// and the number stands for the curriculum, the trial and the setting.
    Trial(u64),
    /// Start states and goals of the episodes that compare trained policies after training; its seed is
    /// independent of the seeds of runs.
    FinalEvaluation,
}

impl Purpose {
    /// The purpose's name and, for families of streams, its index.
    fn label(self) -> (&'static str, u64) {
        match self {
            Self::Weights => ("weights", 0),
            Self::Environment => ("environment", 0),
            Self::Exploration => ("exploration", 0),
            Self::Replay => ("replay", 0),
            Self::Teacher => ("teacher", 0),
            Self::Pool => ("pool", 0),
            Self::Evaluation(index) => ("evaluation", index),
            Self::Diagnosis(index) => ("diagnosis", index),
            Self::Rollout(index) => ("rollout", index),
            Self::Frontier(index) => ("frontier", index),
            Self::Shadow(index) => ("shadow", index),
            Self::Trial(index) => ("trial", index),
            Self::FinalEvaluation => ("final-evaluation", 0),
        }
    }
}

/// The stream of a run's `seed` for one `purpose`: ChaCha8 keyed with SHA-256 of both.
///
/// ```
/// use envs::rng::{Purpose, stream, uniform};
///
/// let first = |seed, purpose| uniform(&mut stream(seed, purpose), 0.0, 1.0);
/// assert_eq!(first(7, Purpose::Pool), first(7, Purpose::Pool));
/// assert_ne!(first(7, Purpose::Pool), first(7, Purpose::Teacher));
/// ```
pub fn stream(seed: u64, purpose: Purpose) -> Rng {
    let (name, index) = purpose.label();
    let key = Sha256::new()
        .chain_update(b"goalbench stream 1\0")
        .chain_update(seed.to_le_bytes())
        .chain_update(name)
        .chain_update([0])
        .chain_update(index.to_le_bytes())
        .finalize();
    Rng::from_seed(key.into())
}

/// A number drawn uniformly from [`low`, `high`).
///
/// ```
/// use envs::rng::{Purpose, stream, uniform};
///
/// let mut rng = stream(0, Purpose::Teacher);
/// assert!((0..100).all(|_| (2.0..3.0).contains(&uniform(&mut rng, 2.0, 3.0))));
/// ```
pub fn uniform(rng: &mut Rng, low: f64, high: f64) -> f64 {
    rand::Rng::random_range(rng, low..high)
}

#[cfg(test)]
mod tests {
    use super::{Purpose, stream};

    /// Old and new records can be compared only as long as no stream changes. These are the first bytes of
    /// the keys for seed 3, computed from their definition with another SHA-256 (Python's hashlib).
    #[test]
    fn streams_stay_what_they_are_and_differ() {
        let keys = [
            (Purpose::Weights, 0x71a0_5e6a_6c5c_868a),
            (Purpose::Environment, 0x01a1_d769_0aca_3f87),
            (Purpose::Exploration, 0x8b28_f239_6a7a_ed19),
            (Purpose::Replay, 0x5a31_86e3_2998_6e63),
            (Purpose::Teacher, 0xa8be_5bf2_4f67_1297),
            (Purpose::Pool, 0xa091_771d_2463_3216),
            (Purpose::Evaluation(0), 0x0606_7110_e5dc_cd82),
            (Purpose::Evaluation(7), 0x4f00_87c2_6377_b535),
            (Purpose::Diagnosis(0), 0x480f_e9d3_4e59_5a17),
            (Purpose::Diagnosis(7), 0xa14f_d408_d329_f504),
            (Purpose::Rollout(0), 0xc2fe_745b_ef2a_c253),
            (Purpose::Rollout(7), 0x394f_3fd4_e9ac_fb95),
            (Purpose::Frontier(0), 0x6565_2da3_6df6_dcaf),
            (Purpose::Frontier(7), 0xd850_1606_e3e0_dd57),
            (Purpose::Shadow(0), 0x26d6_efcb_9324_a42f),
            (Purpose::Shadow(7), 0xe91e_9df1_a334_1e82),
            (Purpose::Trial(0), 0xbee7_6f2c_0ed9_1944),
            (Purpose::Trial(7), 0xdf38_e58a_52c9_2fa9),
            (Purpose::FinalEvaluation, 0x9433_8273_70ad_d441_u64),
        ];
        for (purpose, expected) in keys {
            let key = stream(3, purpose).get_seed();
            assert_eq!(key[..8], expected.to_be_bytes(), "{purpose:?}");
        }
    }
}
