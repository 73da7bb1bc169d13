//! Asking the student for its confidence in the goals of the pool, and remembering answers that can be
//! compared.

use agents::{AgentError, Critic, Network};
use envs::{Goals, Rows};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::curriculum::Lesson;
use crate::distribution::require_finite;
use crate::error::CurriculumError;
use crate::judgement::success_probability;
use crate::snapshot;
use crate::window::Window;

/// From which states confidence is measured. Eq. 7 of TEACH averages over the states of the replay buffer and
/// leaves open how many that are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum StateSource {
    /// States drawn once from the replay buffer and held, so that confidence moves only with the networks and
    /// their input normalisers. After `renewal` measurements new states are measured beside them, and then
    /// take over.
    #[default]
    Reference,
    /// Fresh draws from the replay buffer at every measurement: unbiased, but confidence then also changes
    /// with the sample.
    Replay,
    /// The start state of the coming episode. Where starts are random, confidence also changes with the
    /// start.
    Initial,
}

/// How confidence C(g) is measured: options shared by all methods that use confidence. They are fields of the
/// method's own table, so they are included with `#[serde(flatten)]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
pub struct ProbeConfig {
    /// The networks that answer.
    ///
    /// Source: TEACH, Eq. 7; `target-critic`: its section 5.4 and Figure 3.
    #[serde(rename = "confidence")]
    pub network: Network,
    /// The states that C(g) averages over.
    ///
    /// Source: TEACH, Eqs. 6 and 7; how many states those are is left open. `initial`: the code of ProCuRL.
    pub states: StateSource,
    /// M, how many states there are with `reference` and `replay`.
    ///
    /// Unit: states. Range: 1 to 1024. Source: a choice.
    pub replay_states: usize,
    /// Measurements of confidence after which `reference` begins with other states; at least as many as are
    /// compared.
    ///
    /// Unit: measurements. Range: at least 1. Source: a choice.
    pub renewal: u64,
}

impl Default for ProbeConfig {
    fn default() -> Self {
        Self { network: Network::Online, states: StateSource::Reference, replay_states: 8, renewal: 100 }
    }
}

/// The largest accepted number of replay states: every one costs a forward pass over the whole pool.
const MOST_REPLAY_STATES: usize = 1024;

impl ProbeConfig {
    /// Checks the ranges, for a probe that compares `window` evaluations.
    ///
    /// # Errors
    /// [`CurriculumError::Config`] for `replay_states` outside 1 to 1024, or a `renewal` of 0 or, for
    /// held states, below `window`: states that are renewed sooner could never fill it.
    pub fn check(&self, window: usize) -> Result<(), CurriculumError> {
        let accepted = format!("in 1..={MOST_REPLAY_STATES}");
        let ok = (1..=MOST_REPLAY_STATES).contains(&self.replay_states);
        CurriculumError::require(ok, "replay_states", &accepted, self.replay_states)?;
        let accepted = format!("at least {window}, the evaluations that are compared");
        let ok = self.states != StateSource::Reference || self.renewal >= window as u64;
        CurriculumError::require(ok, "renewal", &accepted, self.renewal)?;
        CurriculumError::require(self.renewal >= 1, "renewal", "at least 1", self.renewal)
    }
}

/// What [`Probe::ask`] did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// The window has a new evaluation, or its newest was made anew from another start.
    Recorded,
    /// Nothing was evaluated: all would be as at the last evaluation.
    Unchanged,
    /// Nothing was evaluated: replayed states are asked for, and there are none yet.
    NoStates,
}

/// Measures policy confidence C(g) (TEACH, Eq. 7) over a list of goals, once per state of the networks, and
/// remembers the last evaluations in a [`Window`].
///
/// With [`StateSource::Reference`] all evaluations in the window are from the same states. After `renewal`
/// evaluations a successor is drawn; both sets are measured until the successor's window is full, then it
/// takes over. So the window never compares different states, and its states do not grow old.
///
/// ```
/// use curricula::testing::Class;
/// use curricula::{Answer, Lesson, Probe, ProbeConfig, StateSource};
///
/// // A student whose confidence in goal i is -i, in a class with a pool of three goals.
/// let mut class = Class::new("her-iid-pool", "", 3, |goal, _steps| -(goal as f64));
/// let config = ProbeConfig { states: StateSource::Initial, ..ProbeConfig::default() };
/// let mut probe = Probe::new(10);
/// let pool = class.setting.pool.clone();
/// let mut lesson = Lesson {
///     student: &mut class.student,
///     start: &class.start,
///     goals: &mut *class.env,
///     rng: &mut class.rng,
/// };
/// assert_eq!(probe.ask(&config, &pool, &mut lesson, false)?, Answer::Recorded);
/// assert_eq!(probe.window().last(), Some(&[0.0, -1.0, -2.0][..]));
/// // The networks have not changed since.
/// assert_eq!(probe.ask(&config, &pool, &mut lesson, false)?, Answer::Unchanged);
/// # Ok::<(), curricula::CurriculumError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Probe {
    /// Gradient steps behind the networks at the last evaluation.
    asked_at: Option<u64>,
    /// The start at hand then, shape `[S]`.
    asked_from: Vec<f64>,
    evaluations: u64,
    /// Mean, smallest and largest confidence at the last evaluation.
    summary: Option<[f64; 3]>,
    current: Series,
    successor: Option<Series>,
}

/// Evaluations from one set of states.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Series {
    /// The states held, shape `[M, S]`; none before the first draw, and none where states are not held.
    states: Option<Rows>,
    /// How often they were measured.
    measured: u64,
    window: Window,
}

impl Series {
    fn new(window: usize, states: Option<Rows>) -> Self {
        Self { states, measured: 0, window: Window::new(window) }
    }
}

impl Probe {
    /// A probe that remembers `window` evaluations and has not asked yet.
    ///
    /// # Panics
    /// If `window` is 0.
    pub fn new(window: usize) -> Self {
        Self {
            asked_at: None,
            asked_from: Vec::new(),
            evaluations: 0,
            summary: None,
            current: Series::new(window, None),
            successor: None,
        }
    }

    /// The last evaluations, all comparable with each other as far as [`StateSource`] says.
    pub fn window(&self) -> &Window {
        &self.current.window
    }

    /// The newest evaluation as estimates of success, `[N]`: each value as a share of the way from `lowest`,
    /// the lowest return there is, to 0, as ProCuRL reads it. `None` before the first.
    pub fn success(&self, lowest: f64) -> Option<Vec<f64>> {
        let values = self.window().last()?;
        Some(values.iter().map(|&value| success_probability(value, lowest, 0.0)).collect())
    }

    /// Asks the student for its confidence in every goal of `pool`, if the networks have changed since the
    /// last evaluation. If they have not, but the coming episode has another start, [`StateSource::Initial`]
    /// with `anew` measures the newest evaluation again from that start.
    ///
    /// # Errors
    /// [`CurriculumError::NotFinite`] or [`CurriculumError::Student`] if the answer is not one finite value
    /// per goal.
    pub fn ask(
        &mut self,
        config: &ProbeConfig,
        pool: &Goals,
        lesson: &mut Lesson<'_>,
        anew: bool,
    ) -> Result<Answer, CurriculumError> {
        let now = lesson.student.gradient_steps();
        let moved = self.asked_at != Some(now);
        let elsewhere = config.states == StateSource::Initial && self.asked_from != lesson.start.state;
        let due = moved || (anew && elsewhere);
        if !due {
            return Ok(Answer::Unchanged);
        }
        let Some(states) = self.states(config, lesson) else { return Ok(Answer::NoStates) };
        let values = measure(lesson.student, pool, &states, config.network)?;
        self.evaluations += 1;
        if moved {
            self.current.window.push(values);
            self.current.measured += 1;
        } else {
            self.current.window.replace_last(values);
        }
        if config.states == StateSource::Reference {
            self.renew(config, pool, lesson)?;
        }
        self.summary = self.window().last().map(summarise);
        self.asked_at = Some(now);
        self.asked_from.clone_from(&lesson.start.state);
        Ok(Answer::Recorded)
    }

    /// The states to average over, if there are any.
    fn states(&mut self, config: &ProbeConfig, lesson: &mut Lesson<'_>) -> Option<Rows> {
        let states = match config.states {
            StateSource::Initial => single(&lesson.start.state),
            StateSource::Replay => lesson.student.replay_states(config.replay_states, lesson.rng),
            StateSource::Reference => match &self.current.states {
                Some(held) => held.clone(),
                None => {
                    let drawn = lesson.student.replay_states(config.replay_states, lesson.rng);
                    self.current.states = (!drawn.is_empty()).then(|| drawn.clone());
                    drawn
                }
            },
        };
        (!states.is_empty()).then_some(states)
    }

    /// Draws a successor of the held states when they have served their time, measures it, and hands over to
    /// it when its window is full.
    fn renew(
        &mut self,
        config: &ProbeConfig,
        pool: &Goals,
        lesson: &mut Lesson<'_>,
    ) -> Result<(), CurriculumError> {
        if self.current.measured <= config.renewal {
            return Ok(());
        }
        let capacity = self.current.window.capacity();
        let successor = self.successor.get_or_insert_with(|| {
            let drawn = lesson.student.replay_states(config.replay_states, lesson.rng);
            Series::new(capacity, Some(drawn))
        });
        let states = successor.states.as_ref().expect("drawn with the successor");
        successor.window.push(measure(lesson.student, pool, states, config.network)?);
        successor.measured += 1;
        if successor.window.len() == capacity {
            self.current = self.successor.take().expect("just measured");
        }
        Ok(())
    }

    /// Evaluations so far, and the mean, smallest and largest confidence at the last one (NaN before the
    /// first).
    pub fn statistics(&self) -> [(&'static str, f64); 4] {
        let [mean, min, max] = self.summary.unwrap_or([f64::NAN; 3]);
        [
            ("evaluations", self.evaluations as f64),
            ("confidence_mean", mean),
            ("confidence_min", min),
            ("confidence_max", max),
        ]
    }

    /// Refuses a loaded state that is of another pool than one of `goals`, or of a window of another length
    /// than `window`.
    ///
    /// # Errors
    /// [`CurriculumError::State`] if it is.
    pub fn check(&self, goals: usize, window: usize) -> Result<(), CurriculumError> {
        for series in std::iter::once(&self.current).chain(&self.successor) {
            series.window.check(goals, window)?;
        }
        let held = |series: &Series| series.states.as_ref().is_some_and(|states| !states.is_empty());
        if self.successor.as_ref().is_some_and(|successor| !held(successor)) {
            return Err(snapshot::refuse("a successor without states"));
        }
        Ok(())
    }
}

/// The confidence in every one of `goals`, shape `[n]`, as a mean over `states`: one finite value each.
pub(crate) fn measure(
    student: &mut dyn Critic,
    goals: &Goals,
    states: &Rows,
    network: Network,
) -> Result<Vec<f64>, CurriculumError> {
    let values = student.confidence(goals, states, network)?;
    if values.len() != goals.len() {
        return Err(AgentError::Shape { what: "confidence", expected: goals.len(), got: values.len() }.into());
    }
    require_finite(&values, "confidence")?;
    Ok(values)
}

/// One state as a matrix of one row.
pub(crate) fn single(state: &[f64]) -> Rows {
    let mut states = Rows::with_capacity(state.len(), 1);
    states.push(state);
    states
}

/// Mean, smallest and largest of `values`, of which there is at least one.
fn summarise(values: &[f64]) -> [f64; 3] {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let min = values.iter().copied().fold(f64::INFINITY, f64::min);
    let max = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    [mean, min, max]
}
