//! A student that answers from a script, and a class in which it meets a teacher.

use std::cell::RefCell;
use std::sync::Arc;

use agents::{AgentError, Auto, Batch, Critic, Episode, Network, StudentConfig};
use curricula::{CURRICULA, Curriculum, CurriculumError, Entry, Lesson, Proposal, Setting};
use envs::rng::{Purpose, Rng, stream, uniform};
use envs::{GoalEnv, Goals, Observation, Reward, Rows, Spec, draw_pool};

/// −1/(1−γ) of the scripted student.
pub(crate) const LOWEST: f64 = -50.0;

/// Confidence by goal index and gradient steps.
pub(crate) type Script = fn(usize, u64) -> f64;

/// A question about confidence.
#[derive(Debug, PartialEq)]
pub(crate) struct Question {
    pub(crate) network: Network,
    pub(crate) goals: Goals,
    pub(crate) states: Rows,
}

/// A student whose confidence is scripted and whose actions tell state, goal and network apart.
pub(crate) struct Scripted {
    spec: Spec,
    script: Script,
    /// How much the sum of a state's numbers adds to confidence in every second goal.
    pub(crate) by_state: f64,
    /// Gradient steps taken.
    pub(crate) steps: u64,
    /// Whether there is anything in the replay buffer.
    pub(crate) has_replay: bool,
    /// Goals at the end of a question that get no answer.
    pub(crate) unanswered: usize,
    /// The questions asked.
    pub(crate) asked: Vec<Question>,
    /// The states handed out as replayed ones, in order.
    pub(crate) replayed: Vec<Rows>,
    /// In the first third of a replayed batch, goals whose first component has this sign are always reached; all
    /// others never are. So the first of three members learns other values there than its fellows.
    pub(crate) frontier: f32,
    /// Transitions in each batch drawn.
    pub(crate) batches: RefCell<Vec<usize>>,
}

/// The scripted student's action: another one for every state, goal and network.
pub(crate) fn action(state: &[f64], goal: &[f64], network: Network, width: usize) -> Vec<f64> {
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

impl Critic for Scripted {
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
            actions.push(&action(state, goal, network, self.spec.action));
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
            for (place, x) in next.iter_mut().zip(action(&wide(state), &wide(goal), network, width)) {
                *place = x as f32;
            }
        }
        Ok(())
    }
}

/// What teachers with networks of their own go by: small networks and batches, so that tests are fast.
pub(crate) fn small_student() -> StudentConfig {
    StudentConfig { width: 16, batch: Auto::Value(8), gamma: Auto::Value(0.5), ..StudentConfig::default() }
}

/// The row of the teacher `id`.
pub(crate) fn entry(id: &str) -> &'static Entry {
    CURRICULA.iter().find(|entry| entry.id == id).expect("a registered teacher")
}

/// A teacher, its scripted student, and everything a lesson needs.
pub(crate) struct Class {
    pub(crate) teacher: Box<dyn Curriculum>,
    pub(crate) student: Scripted,
    pub(crate) setting: Setting,
    pub(crate) env: Box<dyn GoalEnv>,
    starts: Rng,
    /// The start of the last episode.
    pub(crate) start: Observation,
    pub(crate) rng: Rng,
}

impl Class {
    /// The teacher `id` with `config` (TOML) over a pool of `goals`, on the point task.
    pub(crate) fn new(id: &str, config: &str, goals: usize, script: Script) -> Self {
        Self::with(entry(id), config, goals, script).expect("a valid config")
    }

    pub(crate) fn with(
        entry: &Entry,
        config: &str,
        goals: usize,
        script: Script,
    ) -> Result<Self, CurriculumError> {
        Self::on("Point", entry, config, goals, script)
    }

    /// The same on any environment.
    pub(crate) fn on(
        environment: &str,
        entry: &Entry,
        config: &str,
        goals: usize,
        script: Script,
    ) -> Result<Self, CurriculumError> {
        let mut env = envs::make(environment, &envs::EnvOptions::default()).expect("an environment");
        let pool = draw_pool(&mut *env, goals, &mut stream(0, Purpose::Pool)).expect("a pool");
        let student = small_student().resolve(env.spec()).expect("valid defaults");
        let setting = Setting { spec: env.spec().clone(), pool: Arc::new(pool), seed: 0, student };
        let config = (entry.resolve)(config.parse().expect("TOML"))?;
        let teacher = (entry.build)(&config, &setting)?;
        let student = Scripted {
            spec: env.spec().clone(),
            script,
            by_state: 0.0,
            steps: 0,
            has_replay: false,
            unanswered: 0,
            asked: Vec::new(),
            replayed: Vec::new(),
            frontier: 1.0,
            batches: RefCell::default(),
        };
        let (starts, rng) = (stream(0, Purpose::Environment), stream(0, Purpose::Teacher));
        Ok(Self { teacher, student, setting, start: env.observation().clone(), env, starts, rng })
    }

    /// An episode's beginning, before anything is proposed.
    pub(crate) fn reset(&mut self) {
        self.env.reset(&mut self.starts).expect("a start");
        self.start = self.env.observation().clone();
    }

    /// One episode: the teacher's proposal, after which it hears of an episode of standing still.
    pub(crate) fn propose(&mut self) -> Result<Proposal, CurriculumError> {
        self.reset();
        let Self { teacher, student, start, env, rng, .. } = self;
        let proposal = teacher.propose(&mut Lesson { student, start, goals: &mut **env, rng })?;
        teacher.observe(&standing_still(&**env))?;
        Ok(proposal)
    }

    /// One episode's proposal, which must be from the pool.
    pub(crate) fn propose_index(&mut self) -> usize {
        match self.propose().expect("a proposal") {
            Proposal::Pool(index) => index,
            other => panic!("{other:?} is not from the pool"),
        }
    }

    /// One episode's goal, whoever drew it.
    pub(crate) fn propose_goal(&mut self) -> Vec<f64> {
        match self.propose().expect("a proposal") {
            Proposal::Native => self.env.goal().to_vec(),
            Proposal::Pool(index) => self.setting.pool.row(index).to_vec(),
            Proposal::Goal(goal) => goal,
        }
    }

    /// The student's and the teacher's learning at the end of a cycle.
    pub(crate) fn learn(&mut self) {
        self.student.steps += 1;
        self.student.has_replay = true;
        let Self { teacher, student, env, rng, .. } = self;
        teacher.learn(student, &**env, rng).expect("learns");
    }

    /// `n` cycles of one episode each: the indices proposed.
    pub(crate) fn cycles(&mut self, n: usize) -> Vec<usize> {
        let cycle = |_| {
            let index = self.propose_index();
            self.learn();
            index
        };
        (0..n).map(cycle).collect()
    }

    pub(crate) fn weights(&self) -> Vec<f64> {
        self.teacher.weights().expect("a teacher with weights").to_vec()
    }

    pub(crate) fn statistic(&self, name: &str) -> f64 {
        let found = self.teacher.statistics().into_iter().find(|(known, _)| *known == name);
        found.unwrap_or_else(|| panic!("no statistic `{name}`")).1
    }
}

/// An episode in which nothing moves, from the start at hand.
fn standing_still(env: &dyn GoalEnv) -> Episode {
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
        success: false,
    }
}

/// Whether two lists agree to within rounding.
pub(crate) fn close(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12)
}
