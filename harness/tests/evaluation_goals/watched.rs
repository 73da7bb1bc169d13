//! A teacher under watch: every number that it is handed is noted.

use std::cell::Cell;

use agents::{AgentError, Batch, Critic, Episode, Network, Trajectory};
use curricula::{
    Configured, Curriculum, CurriculumError, Entry, Judgement, Lesson, Proposal, RolloutRequest, Rollouts,
    Setting, TeacherSummary,
};
use envs::rng::Rng;
use envs::{GoalSource, Reward, Rows, Spec};
use toml::Table;

/// How often a teacher was handed something, and the largest number in it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Handed {
    pub(crate) times: u64,
    pub(crate) largest: f64,
}

thread_local! {
    static HANDED: Cell<Handed> = Cell::default();
    /// The teacher to build next: a table's row holds no closure.
    static NEXT: Cell<Option<&'static Entry>> = const { Cell::new(None) };
}

fn note(numbers: impl IntoIterator<Item = f64>) {
    let Handed { times, largest } = HANDED.get();
    HANDED
        .set(Handed { times: times + 1, largest: numbers.into_iter().fold(largest, |a, b| a.max(b.abs())) });
}

fn note_all(numbers: &[f64]) {
    note(numbers.iter().copied());
}

/// What teachers of this thread were handed since the last call.
pub(crate) fn take_handed() -> Handed {
    HANDED.take()
}

/// The row `watched`: the teacher of `entry`, under watch. One at a time in a thread.
pub(crate) fn watched(entry: &'static Entry) -> Entry {
    NEXT.set(Some(entry));
    Entry { id: "watched", configure, ..*entry }
}

fn configure(written: Table) -> Result<Box<dyn Configured>, CurriculumError> {
    let entry = NEXT.get().expect("`watched` comes first");
    Ok(Box::new(WatchedConfig((entry.configure)(written)?)))
}

struct WatchedConfig(Box<dyn Configured>);

impl Configured for WatchedConfig {
    fn table(&self) -> Table {
        self.0.table()
    }

    fn version(&self) -> String {
        self.0.version()
    }

    fn build(self: Box<Self>, setting: &Setting) -> Result<Box<dyn Curriculum>, CurriculumError> {
        note_all(setting.pool.as_slice());
        Ok(Box::new(Watched(self.0.build(setting)?)))
    }
}

struct Watched(Box<dyn Curriculum>);

impl Curriculum for Watched {
    fn propose(&mut self, lesson: &mut Lesson<'_>) -> Result<Proposal, CurriculumError> {
        note_all(&lesson.start.state);
        note_all(&lesson.start.achieved);
        self.0.propose(&mut Lesson {
            student: &mut WatchedStudent(lesson.student),
            start: lesson.start,
            goals: &mut WatchedGoals(lesson.goals),
            rng: lesson.rng,
        })
    }

    fn judge(&self, student: &dyn Critic) -> Judgement {
        self.0.judge(student)
    }

    fn observe(&mut self, episode: &Episode) -> Result<(), CurriculumError> {
        note_all(episode.states.as_slice());
        note_all(episode.achieved.as_slice());
        note_all(&episode.goal);
        self.0.observe(episode)
    }

    fn learn(
        &mut self,
        student: &mut dyn Critic,
        reward: &dyn Reward,
        rng: &mut Rng,
    ) -> Result<(), CurriculumError> {
        self.0.learn(&mut WatchedStudent(student), reward, rng)
    }

    fn request_rollouts(
        &mut self,
        goals: &mut dyn GoalSource,
        rng: &mut Rng,
    ) -> Result<Option<RolloutRequest>, CurriculumError> {
        self.0.request_rollouts(&mut WatchedGoals(goals), rng)
    }

    fn hear_rollouts(&mut self, rollouts: &Rollouts) -> Result<(), CurriculumError> {
        note_all(rollouts.goals.as_slice());
        self.0.hear_rollouts(rollouts)
    }

    fn summary(&self) -> TeacherSummary<'_> {
        self.0.summary()
    }

    fn save(&self) -> Result<Vec<u8>, CurriculumError> {
        self.0.save()
    }

    fn load(&mut self, bytes: &[u8]) -> Result<(), CurriculumError> {
        self.0.load(bytes)
    }
}

/// A student whose memories are noted.
struct WatchedStudent<'a>(&'a mut dyn Critic);

impl Critic for WatchedStudent<'_> {
    fn spec(&self) -> &Spec {
        self.0.spec()
    }

    fn gradient_steps(&self) -> u64 {
        self.0.gradient_steps()
    }

    fn lowest_value(&self) -> f64 {
        self.0.lowest_value()
    }

    fn confidence(&mut self, goals: &Rows, states: &Rows, network: Network) -> Result<Vec<f64>, AgentError> {
        self.0.confidence(goals, states, network)
    }

    fn policy(&mut self, states: &Rows, goals: &Rows, network: Network) -> Result<Rows, AgentError> {
        self.0.policy(states, goals, network)
    }

    fn replay_states(&mut self, m: usize, rng: &mut Rng) -> Rows {
        let states = self.0.replay_states(m, rng);
        note_all(states.as_slice());
        states
    }

    fn replay_achieved(&mut self, m: usize, rng: &mut Rng) -> Rows {
        let goals = self.0.replay_achieved(m, rng);
        note_all(goals.as_slice());
        goals
    }

    fn replay_episodes(&self) -> usize {
        self.0.replay_episodes()
    }

    fn replay_trajectory(&self, age: usize) -> Option<Trajectory> {
        let trajectory = self.0.replay_trajectory(age);
        if let Some(Trajectory { states, achieved, goal, .. }) = &trajectory {
            [states.as_slice(), achieved.as_slice(), goal].into_iter().for_each(note_all);
        }
        trajectory
    }

    fn td_errors(&mut self, trajectory: &Trajectory, reward: &dyn Reward) -> Result<Vec<f64>, AgentError> {
        self.0.td_errors(trajectory, reward)
    }

    fn replay_batch(&self, reward: &dyn Reward, rng: &mut Rng, batch: &mut Batch) -> Result<(), AgentError> {
        self.0.replay_batch(reward, rng, batch)?;
        for numbers in [&batch.states, &batch.next_states, &batch.goals] {
            note(numbers.iter().map(|&x| f64::from(x)));
        }
        Ok(())
    }

    fn label_next_actions(&mut self, batch: &mut Batch, network: Network) -> Result<(), AgentError> {
        self.0.label_next_actions(batch, network)
    }
}

/// A goal source whose goals are noted.
struct WatchedGoals<'a>(&'a mut dyn GoalSource);

impl GoalSource for WatchedGoals<'_> {
    fn sample_goal(&mut self, rng: &mut Rng, goal: &mut [f64]) {
        self.0.sample_goal(rng, goal);
        note_all(goal);
    }
}
