//! Measuring a student.

use agents::{Critic, Diagnosis, DryStep, Network};
use envs::rng::Rng;
use envs::{GoalEnv, Goals, Rows};
use rand::Rng as _;
use reports::schema::Learning;

use super::error::RunError;

/// Episodes that are played in lockstep, at most: the policy then answers for all of them at once.
///
/// Twenty instances cost little: 0.1 MB and 0.04 ms to make for a maze, 3 MB and 5 ms for a Hand task, 4 MB
/// for a Fetch task (whose set-up is simulated once per process), and their steps are as fast as those of one
/// instance. Asking for one action at a time would cost 15 µs per step on the CPU, and on a GPU every call
/// waits for the device.
pub const LOCKSTEP: u64 = 20;

/// What an evaluation found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Score {
    /// Share of episodes that were successful at their last step.
    pub success_rate: f64,
    /// Share of episodes that were successful after at least one of their steps.
    pub any_success_rate: f64,
    /// Mean over episodes of the sum of rewards.
    pub mean_return: f64,
}

/// What episodes came to, counted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tally {
    /// Episodes played.
    pub episodes: u64,
    /// Those that were successful at their last step.
    pub successes: u64,
    /// Those that were successful after at least one of their steps.
    pub any_successes: u64,
    /// Sum of all rewards.
    pub total_return: f64,
}

impl Tally {
    /// Counts further episodes.
    fn add(&mut self, PlayedGroup { now, ever, total_return }: &PlayedGroup) {
        let count = |flags: &[bool]| flags.iter().filter(|&&flag| flag).count() as u64;
        self.successes += count(now);
        self.any_successes += count(ever);
        self.episodes += now.len() as u64;
        self.total_return += total_return;
    }

    /// The same per episode; there must be at least one.
    pub fn score(&self) -> Score {
        let episodes = self.episodes as f64;
        Score {
            success_rate: self.successes as f64 / episodes,
            any_success_rate: self.any_successes as f64 / episodes,
            mean_return: self.total_return / episodes,
        }
    }
}

/// The score of [`tally`].
///
/// # Errors
/// [`RunError`] if physics or student break down.
///
/// # Panics
/// If `envs` is empty.
pub fn evaluate(
    envs: &mut [Box<dyn GoalEnv>],
    student: &mut dyn Critic,
    pool: Option<&Goals>,
    episodes: u64,
    rng: &mut Rng,
) -> Result<Score, RunError> {
    Ok(tally(envs, student, pool, episodes, rng, &mut |_| {})?.score())
}

/// Plays `episodes` greedy episodes and counts their successes. Starts come from the environment's own
/// distribution; goals do as well, or are drawn evenly from `pool` if there is one. All are drawn from `rng`,
/// episode by episode. As many episodes as `envs` has instances are played in lockstep, and `played` is told
/// how many after each such group.
///
/// The number of instances changes neither starts nor goals. It may change actions in their last digits: a
/// matrix product of several rows adds up in another order than one of a single row.
///
/// # Errors
/// [`RunError`] if physics or student break down.
///
/// # Panics
/// If `envs` is empty, or `pool` is.
pub fn tally(
    envs: &mut [Box<dyn GoalEnv>],
    student: &mut dyn Critic,
    pool: Option<&Goals>,
    episodes: u64,
    rng: &mut Rng,
    played: &mut dyn FnMut(u64),
) -> Result<Tally, RunError> {
    assert!(!envs.is_empty(), "an evaluation needs an environment");
    let mut tally = Tally::default();
    // Picks have a stream of their own, so that starts do not depend on where goals come from.
    let mut picks = rng.clone();
    picks.set_stream(1);
    while tally.episodes < episodes {
        let group = (episodes - tally.episodes).min(envs.len() as u64);
        let playing = &mut envs[..group as usize];
        for env in &mut *playing {
            env.reset(rng)?;
            if let Some(pool) = pool {
                env.set_goal(pool.row(picks.random_range(0..pool.len())))?;
            }
        }
        tally.add(&play(playing, student)?);
        played(group);
    }
    Ok(tally)
}

/// What episodes that were played in lockstep came to.
pub(super) struct PlayedGroup {
    /// Whether each was successful at its last step, `[episodes]`.
    pub(super) now: Vec<bool>,
    /// Whether each was successful after at least one of its steps, `[episodes]`.
    ever: Vec<bool>,
    /// Sum of all rewards.
    total_return: f64,
}

/// Plays one greedy episode on each of `envs` in lockstep, from their starts to their goals.
///
/// # Errors
/// [`RunError`] if physics or student break down.
///
/// # Panics
/// If `envs` is empty.
pub(super) fn play(envs: &mut [Box<dyn GoalEnv>], student: &mut dyn Critic) -> Result<PlayedGroup, RunError> {
    let spec = envs[0].spec().clone();
    let (mut states, mut goals) = (Rows::new(spec.state), Rows::new(spec.goal));
    envs.iter().for_each(|env| goals.push(env.goal()));
    let (mut now, mut ever) = (vec![false; envs.len()], vec![false; envs.len()]);
    let mut total_return = 0.0;
    for _ in 0..spec.horizon {
        states.clear();
        envs.iter().for_each(|env| states.push(&env.observation().state));
        let actions = student.policy(&states, &goals, Network::Online)?;
        for (index, (env, action)) in envs.iter_mut().zip(actions.iter()).enumerate() {
            env.step(action)?;
            let achieved = &env.observation().achieved;
            total_return += env.reward(achieved, env.goal());
            now[index] = env.success(achieved, env.goal());
            ever[index] |= now[index];
        }
    }
    Ok(PlayedGroup { now, ever, total_return })
}

/// What a student's diagnosis leaves in the records of the evaluation `eval_index`, at this training step.
pub(super) fn learning(found: &Diagnosis, eval_index: u64, step: u64) -> Learning {
    // JSON has no form for numbers that are not finite.
    let number = |of: fn(&DryStep) -> f64| found.dry_step.as_ref().map(of).filter(|x| x.is_finite());
    Learning {
        eval_index,
        step,
        critic_loss: number(|found| found.critic_loss),
        actor_loss: number(|found| found.actor_loss),
        mean_q: number(|found| found.mean_q),
        critic_gradient_norm: number(|found| found.critic_gradient_norm),
        actor_gradient_norm: number(|found| found.actor_gradient_norm),
        replay_episodes: found.replay_episodes,
        replay_transitions: found.replay_transitions,
    }
}

#[cfg(test)]
mod tests {
    use agents::{Agent, Mode, StudentConfig};
    use envs::rng::{Purpose, Rng, stream};
    use envs::{GoalEnv, Goals};

    use super::{Score, evaluate};

    fn instances(id: &str, count: usize) -> Vec<Box<dyn GoalEnv>> {
        let make = |_| envs::make(id, &envs::EnvOptions::default()).expect("a built-in environment");
        (0..count).map(make).collect()
    }

    fn student(env: &dyn GoalEnv) -> Box<dyn Agent> {
        agents::prepare_thread();
        agents::make(&StudentConfig::default(), env.spec(), 1).expect("the default student")
    }

    /// One episode after the other, one action at a time.
    fn one_by_one(env: &mut dyn GoalEnv, agent: &mut dyn Agent, episodes: u64, rng: &mut Rng) -> Score {
        let (mut successes, mut any_successes, mut total_return) = (0, 0, 0.0);
        let mut action = vec![0.0; env.spec().action];
        for _ in 0..episodes {
            env.reset(rng).expect("a stable start");
            let mut ever = false;
            for _ in 0..env.spec().horizon {
                let mode = Mode::Greedy;
                agent.act(env.observation(), env.goal(), mode, &mut action).expect("finite actions");
                env.step(&action).expect("a stable step");
                total_return += env.reward(&env.observation().achieved, env.goal());
                ever |= env.success(&env.observation().achieved, env.goal());
            }
            any_successes += u32::from(ever);
            successes += u32::from(env.success(&env.observation().achieved, env.goal()));
        }
        let episodes = episodes as f64;
        Score {
            success_rate: f64::from(successes) / episodes,
            any_success_rate: f64::from(any_successes) / episodes,
            mean_return: total_return / episodes,
        }
    }

    /// Groups of every size, whole and not. The untrained student passes goals now and then, so that scores
    /// tell starts and goals apart.
    #[test]
    fn lockstep_scores_as_one_episode_after_the_other_does() {
        const EPISODES: u64 = 507;
        let mut envs = instances("Point", 20);
        let mut agent = student(envs[0].as_ref());
        let draws = |index| stream(2, Purpose::Evaluation(index));
        let mut alone = |index| one_by_one(envs[0].as_mut(), agent.as_mut(), EPISODES, &mut draws(index));
        let (expected, other) = (alone(0), alone(1));
        assert!(expected.success_rate > 0.0 && expected != other, "{expected:?}, {other:?}");
        assert!(expected.any_success_rate > expected.success_rate, "passing a goal is not staying there");
        for count in [1, 6, 20] {
            let score = evaluate(&mut envs[..count], agent.as_mut(), None, EPISODES, &mut draws(0));
            assert_eq!(score.expect("a healthy evaluation"), expected, "{count} instances");
        }
    }

    #[test]
    fn goals_come_from_the_pool_where_there_is_one() {
        let mut envs = instances("Point", 3);
        let mut agent = student(envs[0].as_ref());
        let mut score = |pool: &[[f64; 2]]| {
            let mut goals = Goals::new(2);
            pool.iter().for_each(|goal| goals.push(goal));
            let mut rng = stream(2, Purpose::Evaluation(0));
            let score = evaluate(&mut envs, agent.as_mut(), Some(&goals), 30, &mut rng);
            let asked: Vec<Vec<f64>> = envs.iter().map(|env| env.goal().to_vec()).collect();
            assert!(asked.iter().all(|goal| pool.iter().any(|one| one == &goal[..])), "{asked:?}");
            score.expect("a healthy evaluation")
        };
        let one = score(&[[0.9, -0.9]]);
        let both = score(&[[0.9, -0.9], [0.0, 0.1]]);
        assert_ne!(one.mean_return, both.mean_return, "the second goal is asked for, too");
    }
}
