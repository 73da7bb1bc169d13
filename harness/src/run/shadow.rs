//! Shadows: teachers that watch a run's student and propose a goal for every episode, while another one acts.
//!
//! A shadow hears of every episode and of every update as the teacher that acts does, with the student of
//! that moment as its critic. What it draws comes from streams of its own, and the probe rollouts that it
//! asks for are played at once, on an instance of the environment of its own, and charged to nobody. One that
//! fails is silent from then on. Where the machine fails it, the run fails as it does for the teacher that
//! acts: another attempt may go better, and a shadow that fell silent would stay so.

use std::collections::BTreeMap;
use std::sync::Arc;

use agents::{Agent, Critic, Episode};
use curricula::{Curriculum, Lesson, ProposedGoal, Setting, nearest_goal};
use envs::rng::{Purpose, Rng, stream};
use envs::{EnvError, GoalEnv, Goals, Observation, Reward, Spec};
use rand::RngCore;
use reports::schema::{RunKey, ShadowNote, Shadowing};
use reports::store::digest;
use serde::{Deserialize, Serialize};

use super::error::RunError;
use super::frontier::beliefs;
use super::probing::{Probing, ProbingState};
use crate::Registry;
use crate::config::RunConfig;
use crate::config::streams::StreamSeeds;
use crate::error::chain;

/// All shadows of a run.
pub(super) struct Shadows {
    shadows: Vec<Shadow>,
    /// The run's pool, also of teachers that do not choose from it, in single precision: every proposal is
    /// counted for one of its goals.
    pool: Goals,
    /// Training episodes since the last evaluation.
    episodes: u64,
}

/// One that watches.
struct Shadow {
    id: String,
    /// The teacher, or why it has fallen silent.
    teacher: Result<Box<dyn Curriculum>, String>,
    /// Goals of the pool that it may choose from.
    choice: usize,
    rng: Rng,
    probing: Probing,
    proposed: Proposed,
}

/// What was proposed since the last evaluation.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Proposed {
    /// Episodes by the pool goal that was proposed, or was nearest to what was.
    picks: BTreeMap<u32, u32>,
    /// Proposals that were not of the pool.
    elsewhere: u64,
}

/// What a checkpoint keeps of them.
#[derive(Clone, Default, Serialize, Deserialize)]
pub(super) struct ShadowsState {
    shadows: Vec<ShadowState>,
    episodes: u64,
}

#[derive(Clone, Serialize, Deserialize)]
struct ShadowState {
    id: String,
    teacher: Result<Vec<u8>, String>,
    rng: Rng,
    probing: ProbingState,
    proposed: Proposed,
}

/// Why a shadow's answer cannot be used.
#[derive(Debug, thiserror::Error)]
enum Unusable {
    #[error("it proposed pool goal {index}, but the pool holds {size}")]
    OutsidePool { index: usize, size: usize },
    #[error(
        "it proposed a goal of {found} numbers, some of which may not be finite; the task's have {expected}"
    )]
    OddGoal { found: usize, expected: usize },
    #[error("it told {found} weights, some of which may not lie in [0, 1]; the pool holds {expected} goals")]
    OddWeights { found: usize, expected: usize },
}

impl Shadows {
    /// Those that the config of the run `key` names, for a task of `spec` and a `pool`; `make` makes
    /// instances of it.
    ///
    /// # Errors
    /// [`RunError`] if an instance cannot be made, or libtorch fails. A teacher that cannot be built for
    /// another reason is silent from the beginning.
    ///
    /// # Panics
    /// If `registry` lacks one of them: configs are checked when they are resolved.
    pub(super) fn new(
        registry: &Registry,
        key: &RunKey,
        config: &RunConfig,
        (spec, pool): (&Spec, &Arc<Goals>),
        make: impl Fn() -> Result<Box<dyn GoalEnv>, EnvError>,
    ) -> Result<Self, RunError> {
        let shadow = |id: &String| {
            let entry = registry.curriculum(id).expect("a resolved config only holds known names");
            let seed = seed_of(id, key.seed, &config.seed);
            let pool = if entry.uses_pool { Arc::clone(pool) } else { Arc::new(Goals::new(spec.goal)) };
            let choice = pool.len();
            let setting = Setting { spec: spec.clone(), pool, seed, student: config.student.clone() };
            let own = config.curriculum.get(id).and_then(toml::Value::as_table).cloned().unwrap_or_default();
            Ok(Shadow {
                id: id.clone(),
                teacher: or_reason(0, entry.build(own, &setting).map_err(RunError::from))?,
                choice,
                rng: stream(seed, Purpose::Teacher),
                probing: Probing::new(make()?, seed, StreamSeeds::default()),
                proposed: Proposed::default(),
            })
        };
        let shadows = config.shadow.iter().map(shadow).collect::<Result<_, RunError>>()?;
        let mut counted = Goals::new(spec.goal);
        pool.iter().for_each(|goal| counted.push(&single(goal)));
        Ok(Self { shadows, pool: counted, episodes: 0 })
    }

    pub(super) fn is_empty(&self) -> bool {
        self.shadows.is_empty()
    }

    /// All propose a goal for the episode that begins in `start`. `env` has drawn a goal of its own for it,
    /// and the run is at `step`.
    ///
    /// # Errors
    /// Here and below, [`RunError`] if libtorch fails.
    pub(super) fn propose(
        &mut self,
        step: u64,
        student: &mut dyn Critic,
        start: &Observation,
        env: &mut dyn GoalEnv,
    ) -> Result<(), RunError> {
        self.episodes += 1;
        let pool = &self.pool;
        for shadow in &mut self.shadows {
            let choice = shadow.choice;
            let proposal = shadow.attempt(step, |teacher, rng| {
                let goals = &mut *env;
                let proposal = teacher.propose(&mut Lesson { student: &mut *student, start, goals, rng })?;
                match proposal.goal {
                    ProposedGoal::Pool(index) if index < choice => Ok((index, true)),
                    ProposedGoal::Pool(index) => Err(Unusable::OutsidePool { index, size: choice }.into()),
                    ProposedGoal::Native => Ok((nearest_goal(pool, &single(env.goal())), false)),
                    ProposedGoal::Other(goal) => {
                        let expected = env.spec().goal;
                        if goal.len() == expected && goal.iter().all(|x| x.is_finite()) {
                            return Ok((nearest_goal(pool, &single(&goal)), false));
                        }
                        Err(Unusable::OddGoal { found: goal.len(), expected }.into())
                    }
                }
            })?;
            if let Some((index, of_pool)) = proposal {
                let index = u32::try_from(index).unwrap_or(u32::MAX);
                *shadow.proposed.picks.entry(index).or_default() += 1;
                shadow.proposed.elsewhere += u64::from(!of_pool);
            }
        }
        Ok(())
    }

    /// All hear of an episode, after which the run is at `step`.
    pub(super) fn observe(&mut self, step: u64, episode: &Episode) -> Result<(), RunError> {
        for shadow in &mut self.shadows {
            shadow.attempt(step, |teacher, _| Ok(teacher.observe(episode)?))?;
        }
        Ok(())
    }

    /// All learn, if the student has learned.
    pub(super) fn learn(
        &mut self,
        step: u64,
        student: &mut dyn Critic,
        reward: &dyn Reward,
    ) -> Result<(), RunError> {
        for shadow in &mut self.shadows {
            shadow.attempt(step, |teacher, rng| Ok(teacher.learn(&mut *student, reward, rng)?))?;
        }
        Ok(())
    }

    /// All that want probe rollouts get them, where these are `played`.
    pub(super) fn probe(
        &mut self,
        step: u64,
        agent: &mut dyn Agent,
        env: &mut dyn GoalEnv,
        played: bool,
    ) -> Result<(), RunError> {
        for shadow in &mut self.shadows {
            let asked = shadow.attempt(step, |teacher, rng| Ok(teacher.request_rollouts(&mut *env, rng)?))?;
            let Some(request) = asked.flatten().filter(|_| played) else { continue };
            let all = request.all_episodes();
            shadow.probing.ask(request);
            let outcome = shadow.probing.play(&mut *agent, all);
            shadow.attempt(step, |teacher, _| {
                if let Some(rollouts) = outcome?.complete {
                    teacher.hear_rollouts(&rollouts)?;
                }
                Ok(())
            })?;
        }
        Ok(())
    }

    /// What they did up to the evaluation `eval_index`, from which on they count anew; where the student was
    /// `measured`, also what they believe of it.
    pub(super) fn note(
        &mut self,
        eval_index: u64,
        step: u64,
        measured: Option<&dyn Critic>,
    ) -> Result<Shadowing, RunError> {
        let size = self.pool.len();
        let notes = self.shadows.iter_mut().map(|shadow| shadow.note(step, size, measured));
        let shadows = notes.collect::<Result<_, RunError>>()?;
        Ok(Shadowing { eval_index, step, episodes: std::mem::take(&mut self.episodes), shadows })
    }

    pub(super) fn state(&mut self, step: u64) -> Result<ShadowsState, RunError> {
        let states = self.shadows.iter_mut().map(|shadow| shadow.state(step));
        Ok(ShadowsState { shadows: states.collect::<Result<_, RunError>>()?, episodes: self.episodes })
    }

    /// Takes up the state that [`Shadows::state`] gave at `step`.
    ///
    /// # Errors
    /// [`RunError::OtherShadows`] if it is that of others.
    pub(super) fn resume(&mut self, step: u64, state: &ShadowsState) -> Result<(), RunError> {
        let own: Vec<&str> = self.shadows.iter().map(|shadow| shadow.id.as_str()).collect();
        let found: Vec<&str> = state.shadows.iter().map(|shadow| shadow.id.as_str()).collect();
        if own != found {
            return Err(RunError::OtherShadows { found: found.join(", "), own: own.join(", ") });
        }
        self.episodes = state.episodes;
        for (shadow, state) in self.shadows.iter_mut().zip(&state.shadows) {
            match (&mut shadow.teacher, &state.teacher) {
                (_, Err(reason)) => shadow.teacher = Err(reason.clone()),
                // It watched until now, and could not be built again.
                (Err(reason), Ok(_)) => *reason = reason.replacen(&at(0), &at(step), 1),
                (Ok(_), Ok(bytes)) => drop(shadow.attempt(step, |teacher, _| Ok(teacher.load(bytes)?))?),
            }
            shadow.rng = state.rng.clone();
            shadow.probing.resume(state.probing.clone());
            shadow.proposed = state.proposed.clone();
        }
        Ok(())
    }
}

impl Shadow {
    /// What `work` makes of the teacher and its stream; nothing from one that is silent. The first error
    /// silences it, unless it is the machine's.
    fn attempt<T>(
        &mut self,
        step: u64,
        work: impl FnOnce(&mut dyn Curriculum, &mut Rng) -> Result<T, RunError>,
    ) -> Result<Option<T>, RunError> {
        let Ok(teacher) = &mut self.teacher else { return Ok(None) };
        match or_reason(step, work(teacher.as_mut(), &mut self.rng))? {
            Ok(done) => Ok(Some(done)),
            Err(reason) => {
                self.teacher = Err(reason);
                Ok(None)
            }
        }
    }

    /// What it did since the last note, its weights over a pool of `size` goals, and what it believes of the
    /// student that was `measured`.
    fn note(
        &mut self,
        step: u64,
        size: usize,
        measured: Option<&dyn Critic>,
    ) -> Result<ShadowNote, RunError> {
        let weights = self.attempt(step, |teacher, _| {
            let Some(weights) = teacher.summary().weights else { return Ok(None) };
            if weights.len() == size && weights.iter().all(|weight| (0.0..=1.0).contains(weight)) {
                return Ok(Some(weights.iter().map(|&weight| weight as f32).collect()));
            }
            Err(Unusable::OddWeights { found: weights.len(), expected: size }.into())
        })?;
        let judgement = measured.zip(self.teacher.as_ref().ok()).map(|(student, own)| own.judge(student));
        let Proposed { picks, elsewhere } = std::mem::take(&mut self.proposed);
        Ok(ShadowNote {
            id: self.id.clone(),
            weights: weights.flatten(),
            picks: picks.into_iter().collect(),
            elsewhere,
            beliefs: judgement.and_then(|judgement| beliefs(&judgement, size)),
            failed: self.teacher.as_ref().err().cloned(),
        })
    }

    fn state(&mut self, step: u64) -> Result<ShadowState, RunError> {
        let saved = self.attempt(step, |teacher, _| Ok(teacher.save()?))?;
        let silent = || self.teacher.as_ref().err().cloned().unwrap_or_default();
        Ok(ShadowState {
            id: self.id.clone(),
            teacher: saved.ok_or_else(silent),
            rng: self.rng.clone(),
            probing: self.probing.state().clone(),
            proposed: self.proposed.clone(),
        })
    }
}

impl From<Unusable> for RunError {
    fn from(unusable: Unusable) -> Self {
        Self::Shadow(Box::new(unusable))
    }
}

/// What came of a shadow's work at `step`, or why that silences it. A fault of the machine is none of its
/// own: it is passed on.
fn or_reason<T>(step: u64, result: Result<T, RunError>) -> Result<Result<T, String>, RunError> {
    match result {
        Err(error) if error.is_libtorch() => Err(error),
        Err(error) => Ok(Err(format!("{}{}", at(step), chain(&error)))),
        Ok(done) => Ok(Ok(done)),
    }
}

/// What begins the reason of a shadow that falls silent at `step`.
fn at(step: u64) -> String {
    format!("step {step}: ")
}

/// `goal` as records have it, in single precision. Reports count what the teacher that acts proposes by
/// these.
fn single(goal: &[f64]) -> Vec<f64> {
    goal.iter().map(|&x| f64::from(x as f32)).collect()
}

/// The seed of all that the shadow `id` draws in the run with seed `run`: its own, whoever else watches.
fn seed_of(id: &str, run: u64, seeds: &StreamSeeds) -> u64 {
    let number = u64::from_str_radix(&digest::sha256(id.as_bytes())[..16], 16).expect("a hash is in hex");
    seeds.stream(run, Purpose::Shadow(number)).next_u64()
}

#[cfg(test)]
mod tests {
    use agents::{AgentError, TorchError};
    use curricula::CurriculumError;

    use super::*;

    #[test]
    fn faults_of_the_machine_silence_nobody() {
        let failed = |error: AgentError| or_reason::<()>(7, Err(CurriculumError::Student(error).into()));
        let own = failed(AgentError::EmptyReplay).expect("its own fault");
        assert!(own.is_err_and(|reason| reason.starts_with("step 7: ")));
        let of_machine = AgentError::Torch(TorchError(tch::TchError::Kind("out of memory".into())));
        assert!(failed(of_machine).expect_err("the machine's").is_libtorch());
    }

    /// In double precision the second goal is the nearer one; whoever reads records cannot tell.
    #[test]
    fn proposals_are_counted_by_the_numbers_that_records_hold() {
        let mut pool = Goals::new(1);
        [1.0 + 1e-12, -1.0].iter().for_each(|x| pool.push(&single(&[*x])));
        assert_eq!(nearest_goal(&pool, &single(&[0.0])), 0);
    }

    #[test]
    fn every_shadow_has_a_seed_of_its_own() {
        let seeds = StreamSeeds::default();
        let seeds: Vec<u64> = ["teach", "vds"]
            .iter()
            .flat_map(|id| [0, 1].map(|run| seed_of(id, run, &seeds)))
            .chain([0, 1])
            .collect();
        for (index, seed) in seeds.iter().enumerate() {
            assert!(!seeds[..index].contains(seed), "{seeds:?}");
        }
        let held = StreamSeeds { teacher: agents::Auto::Value(1), ..StreamSeeds::default() };
        assert_eq!(seed_of("vds", 0, &held), seed_of("vds", 1, &StreamSeeds::default()));
    }
}
