//! The simplest episode.

use agents::Episode;
use envs::{GoalEnv, Rows, Spec};

/// An episode in which nothing moves, from the start at hand and towards its goal. It ends without success.
///
/// ```
/// let env = envs::make("Point", &envs::EnvOptions::default())?;
/// let episode = curricula::testing::standing_still(env.as_ref());
/// assert_eq!((episode.states.len(), episode.actions.len(), episode.success), (21, 20, false));
/// # Ok::<(), envs::EnvError>(())
/// ```
pub fn standing_still(env: &dyn GoalEnv) -> Episode {
    let Spec { state, goal, action, horizon, .. } = *env.spec();
    let rows = |row: &[f64], n: usize, width: usize| {
        let mut rows = Rows::with_capacity(width, n);
        (0..n).for_each(|_| rows.push(row));
        rows
    };
    Episode {
        states: rows(&env.observation().state, horizon + 1, state),
        achieved: rows(&env.observation().achieved, horizon + 1, goal),
        actions: rows(&vec![0.0; action], horizon, action),
        goal: env.goal().to_vec(),
        total_reward: env.reward(&env.observation().achieved, env.goal()) * horizon as f64,
        success: false,
    }
}
