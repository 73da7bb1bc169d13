//! Students that learn side by side.

use envs::Reward;
use envs::rng::Rng;

use crate::agent::Agent;
use crate::error::AgentError;

/// A student in a cohort, with what its own [`Agent::learn`] would be given.
pub struct CohortLane<'a> {
    /// The student.
    pub student: &'a mut dyn Agent,
    /// Its task's reward, for relabelling.
    pub reward: &'a dyn Reward,
    /// Its own replay stream.
    pub rng: &'a mut Rng,
}

/// Lets students of one shape learn in lockstep. All else a student does alone: it acts, takes in episodes,
/// answers, is diagnosed, saved and loaded, and may leave or come between any two cycles. A student never
/// depends on who its neighbours are.
///
/// On the CPU every student learns as it would alone, to the byte, side by side with the others on the rayon
/// pool that the calling thread belongs to, if it belongs to one. On a GPU their matrices are multiplied in
/// batches, one product for all, while the pool draws the transitions of the coming gradient steps. There the
/// cohort has a fixed width, whoever is missing, since the width decides in what order a product adds up: a
/// student's bytes are the same in every cohort of that width.
///
/// ```
/// use agents::{CohortLane, Episode, StudentConfig};
/// use envs::Rows;
/// use envs::rng::{Purpose, stream};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// agents::prepare_thread();
/// let env = envs::make("Point", &envs::EnvOptions::default())?;
/// let spec = env.spec();
/// let config = StudentConfig { width: 16, updates_per_cycle: 2, ..StudentConfig::default() };
/// let mut students = [agents::make(&config, spec, 0)?, agents::make(&config, spec, 1)?];
/// let mut streams = [0, 1].map(|seed| stream(seed, Purpose::Replay));
/// let zeros = |rows: usize, width: usize| {
///     let mut matrix = Rows::new(width);
///     (0..rows).for_each(|_| matrix.push(&vec![0.0; width]));
///     matrix
/// };
/// for (student, rng) in students.iter_mut().zip(&mut streams) {
///     let episode = Episode {
///         states: zeros(spec.horizon + 1, spec.state),
///         achieved: zeros(spec.horizon + 1, spec.goal),
///         actions: zeros(spec.horizon, spec.action),
///         goal: vec![0.5; spec.goal],
///         total_reward: 0.0,
///         success: false,
///     };
///     student.observe(&episode, env.as_ref(), rng)?;
/// }
/// let mut cohort = agents::make_cohort(&config, students.len())?;
/// let lanes = students.iter_mut().zip(&mut streams);
/// let mut lanes: Vec<CohortLane<'_>> = lanes
///     .map(|(student, rng)| CohortLane { student: student.as_mut(), reward: env.as_ref(), rng })
///     .collect();
/// for outcome in cohort.learn(&mut lanes) {
///     outcome?;
/// }
/// assert_eq!(students.map(|student| student.gradient_steps()), [2, 2]);
/// # Ok(())
/// # }
/// ```
pub trait Cohort: Send {
    /// One cycle's learning of every lane, as [`Agent::learn`]. What became of each is told in order; one
    /// that diverged has disturbed no other; what libtorch refuses to do for all at once concerns all.
    /// Nothing waits for a GPU within the cycle.
    ///
    /// # Panics
    /// If the students are not of the kind that the cohort was made for, or differ in more than
    /// [`StudentConfig::in_lockstep`](crate::StudentConfig::in_lockstep) allows.
    fn learn(&mut self, lanes: &mut [CohortLane<'_>]) -> Vec<Result<(), AgentError>>;
}
