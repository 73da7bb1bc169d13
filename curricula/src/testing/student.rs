//! A student that answers from a script.

use std::cell::RefCell;

use agents::{AgentError, Batch, Critic, Network, Trajectory};
use envs::rng::{Rng, uniform};
use envs::{Goals, Reward, Rows, Spec};
use rand::Rng as _;

/// −1/(1−γ) of the scripted student.
pub const LOWEST: f64 = -50.0;

/// Confidence by goal index and gradient steps.
pub type Script = fn(usize, u64) -> f64;

/// The size of the temporal-difference errors in an episode, by its goal (`[G]`) and gradient steps.
pub type Surprise = fn(&[f64], u64) -> f64;

/// A question about confidence.
#[derive(Debug, PartialEq)]
pub struct Question {
    /// The networks that were to answer.
    pub network: Network,
    /// The goals, shape `[N, G]`.
    pub goals: Goals,
    /// The states to average over, shape `[M, S]`.
    pub states: Rows,
}

/// A student whose confidence is scripted and whose actions tell state, goal and network apart.
pub struct ScriptedStudent {
    spec: Spec,
    script: Script,
    /// How much the sum of a state's numbers adds to confidence in every second goal.
    pub by_state: f64,
    /// Gradient steps taken.
    pub steps: u64,
    /// Whether there are states and transitions in the replay buffer.
    pub has_replay: bool,
    /// The episodes in the replay buffer, the oldest first.
    pub remembered: Vec<Trajectory>,
    /// How far off its values are: temporal-difference errors take turns in having this sign and the other.
    pub surprise: Surprise,
    /// Goals at the end of a question that get no answer.
    pub unanswered: usize,
    /// The questions asked.
    pub asked: Vec<Question>,
    /// The states handed out as replayed ones, in order.
    pub replayed: Vec<Rows>,
    /// In the first third of a replayed batch, goals whose first component has this sign are always reached;
    /// all others never are. The first of three members therefore learns other values there than the others.
    pub frontier: f32,
    /// Transitions in each batch drawn.
    pub batches: RefCell<Vec<usize>>,
}

/// The scripted student's action, shape `[width]`: a different one for every state, goal and network.
///
/// ```
/// use agents::Network;
/// use curricula::testing::scripted_action;
///
/// let action = |goal: f64| scripted_action(&[0.5], &[goal], Network::Online, 2);
/// assert_eq!(action(0.25), action(0.25));
/// assert_ne!(action(0.25), action(0.75));
/// ```
pub fn scripted_action(state: &[f64], goal: &[f64], network: Network, width: usize) -> Vec<f64> {
    let phase = match network {
        Network::Online | Network::TargetCritic => 0.0,
        Network::Target => 2.0,
    };
    let weighed = |numbers: &[f64], by: f64| -> f64 {
        numbers.iter().enumerate().map(|(i, x)| by * (i + 1) as f64 * x).sum()
    };
    let base = phase + weighed(state, 1.0) + weighed(goal, -1.7);
    (0..width).map(|i| (base + i as f64).sin()).collect()
}

impl ScriptedStudent {
    /// A student of the task with these dimensions that has not learned and has nothing in its replay buffer.
    pub fn new(spec: Spec, script: Script) -> Self {
        Self {
            spec,
            script,
            by_state: 0.0,
            steps: 0,
            has_replay: false,
            remembered: Vec::new(),
            surprise: |goal, steps| (goal.iter().sum::<f64>() + steps as f64).sin(),
            unanswered: 0,
            asked: Vec::new(),
            replayed: Vec::new(),
            frontier: 1.0,
            batches: RefCell::default(),
        }
    }
}

impl Critic for ScriptedStudent {
    fn spec(&self) -> &Spec {
        &self.spec
    }

    fn gradient_steps(&self) -> u64 {
        self.steps
    }

    fn lowest_value(&self) -> f64 {
        LOWEST
    }

    fn confidence(&mut self, goals: &Rows, states: &Rows, network: Network) -> Result<Vec<f64>, AgentError> {
        self.asked.push(Question { network, goals: goals.clone(), states: states.clone() });
        let mean = states.iter().flatten().sum::<f64>() / states.len() as f64;
        let by_state = |goal: usize| if goal.is_multiple_of(2) { self.by_state * mean } else { 0.0 };
        let value = |goal| (self.script)(goal, self.steps) + by_state(goal);
        Ok((0..goals.len() - self.unanswered).map(value).collect())
    }

    fn policy(&mut self, states: &Rows, goals: &Rows, network: Network) -> Result<Rows, AgentError> {
        let mut actions = Rows::new(self.spec.action);
        for (state, goal) in states.iter().zip(goals.iter()) {
            actions.push(&scripted_action(state, goal, network, self.spec.action));
        }
        Ok(actions)
    }

    fn replay_states(&mut self, m: usize, rng: &mut Rng) -> Rows {
        let mut states = Rows::new(self.spec.state);
        for _ in 0..if self.has_replay { m } else { 0 } {
            let state: Vec<f64> = (0..self.spec.state).map(|_| uniform(rng, -1.0, 1.0)).collect();
            states.push(&state);
        }
        self.replayed.push(states.clone());
        states
    }

    fn replay_achieved(&mut self, m: usize, rng: &mut Rng) -> Rows {
        let mut goals = Rows::new(self.spec.goal);
        for _ in 0..if self.remembered.is_empty() { 0 } else { m } {
            let achieved = &self.remembered[rng.random_range(0..self.remembered.len())].achieved;
            goals.push(achieved.row(rng.random_range(1..achieved.len())));
        }
        goals
    }

    fn replay_episodes(&self) -> usize {
        self.remembered.len()
    }

    fn replay_trajectory(&self, age: usize) -> Option<Trajectory> {
        self.remembered.iter().rev().nth(age).cloned()
    }

    fn td_errors(&mut self, trajectory: &Trajectory, _reward: &dyn Reward) -> Result<Vec<f64>, AgentError> {
        let size = (self.surprise)(&trajectory.goal, self.steps);
        let sign = |step: usize| if step.is_multiple_of(2) { size } else { -size };
        Ok((0..trajectory.actions.len()).map(sign).collect())
    }

    /// The next actions are not to be used before they are labelled, so they are not numbers.
    fn replay_batch(&self, _reward: &dyn Reward, rng: &mut Rng, batch: &mut Batch) -> Result<(), AgentError> {
        if !self.has_replay {
            return Err(AgentError::EmptyReplay);
        }
        self.batches.borrow_mut().push(batch.len());
        for fill in [&mut batch.states, &mut batch.next_states, &mut batch.goals, &mut batch.actions] {
            fill.iter_mut().for_each(|x| *x = uniform(rng, -1.0, 1.0) as f32);
        }
        batch.next_actions.fill(f32::NAN);
        let first_third = batch.len() / 3;
        for (i, goal) in batch.goals.chunks(self.spec.goal).enumerate() {
            let reached = i < first_third && goal[0] * self.frontier > 0.0;
            batch.rewards[i] = if reached { 0.0 } else { -1.0 };
        }
        Ok(())
    }

    fn label_next_actions(&mut self, batch: &mut Batch, network: Network) -> Result<(), AgentError> {
        let wide = |numbers: &[f32]| numbers.iter().map(|&x| f64::from(x)).collect::<Vec<f64>>();
        let Spec { state, goal, action: width, .. } = self.spec;
        let pairs = batch.next_states.chunks(state).zip(batch.goals.chunks(goal));
        for ((state, goal), next) in pairs.zip(batch.next_actions.chunks_mut(width)) {
            for (place, x) in next.iter_mut().zip(scripted_action(&wide(state), &wide(goal), network, width))
            {
                *place = x as f32;
            }
        }
        Ok(())
    }
}
