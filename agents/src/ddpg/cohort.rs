//! DDPG students that learn in lockstep.

use std::any::Any;

use envs::Reward;
use envs::rng::Rng;
use tch::TchError;

use super::Ddpg;
use super::cycle::cycle;
use super::update::{Learner, Networks};
use crate::batch::Dims;
use crate::cohort::{Cohort, CohortLane};
use crate::device::in_reach;
use crate::error::AgentError;
use crate::pool::side_by_side;

/// See [`Cohort`].
#[derive(Debug)]
pub(crate) struct DdpgCohort {
    width: usize,
    /// Where gradient steps are taken on another device; made for the students that came last.
    stack: Option<Stacked>,
}

/// The networks of several students in one stack, and what takes their gradient steps.
#[derive(Debug)]
struct Stacked {
    networks: Networks,
    learner: Learner,
    /// The first networks are students'. The others are zeros, for nobody.
    students: usize,
}

/// A student with its task's reward and its stream.
type Pupil<'a> = (&'a mut Ddpg, &'a dyn Reward, &'a mut Rng);

impl DdpgCohort {
    pub(crate) fn new(width: usize) -> Self {
        Self { width, stack: None }
    }
}

impl Cohort for DdpgCohort {
    fn learn(&mut self, lanes: &mut [CohortLane<'_>]) -> Vec<Result<(), AgentError>> {
        let pupils: Vec<Pupil<'_>> = lanes.iter_mut().map(pupil).collect();
        check_alike(&pupils);
        let Some((first, ..)) = pupils.first() else { return Vec::new() };
        if in_reach(first.arithmetic.device) {
            // Numbers of several students at once would only compete for the core's cache.
            return side_by_side(pupils, alone);
        }
        let mut outcomes = Vec::new();
        let mut learning = Vec::new();
        for pupil in pupils {
            let is_learning = pupil.0.is_learning();
            if matches!(is_learning, Ok(true)) {
                learning.push((outcomes.len(), pupil));
            }
            outcomes.push(is_learning.map(|_| ()));
        }
        let (places, mut learning): (Vec<usize>, Vec<Pupil<'_>>) = learning.into_iter().unzip();
        let stacked = self.learn_stacked(&mut learning).unwrap_or_else(|error| {
            let text = std::error::Error::source(&error).map_or(error.to_string(), ToString::to_string);
            places.iter().map(|_| Err(TchError::Torch(text.clone()).into())).collect()
        });
        for (place, outcome) in places.into_iter().zip(stacked) {
            outcomes[place] = outcome;
        }
        outcomes
    }
}

impl DdpgCohort {
    /// A cycle of those who learn, in one stack.
    ///
    /// # Errors
    /// [`AgentError::Torch`].
    fn learn_stacked(&mut self, pupils: &mut [Pupil<'_>]) -> Result<Vec<Result<(), AgentError>>, AgentError> {
        if pupils.is_empty() {
            return Ok(Vec::new());
        }
        let stack = match self.stack.take() {
            Some(stack) if stack.holds(pupils) => stack,
            _ => Stacked::gather(pupils, self.width)?,
        };
        let Stacked { networks, learner, .. } = self.stack.insert(stack);
        for (index, (student, ..)) in pupils.iter_mut().enumerate() {
            move_steps(&student.networks, 0, networks, index);
        }
        let config = pupils[0].0.config.clone();
        let mut drawing: Vec<_> = pupils
            .iter_mut()
            .map(|(student, reward, rng)| {
                let (_, _, lane, _) = student.in_training(*reward, rng);
                lane
            })
            .collect();
        let outcomes = cycle(learner, networks, &mut drawing, &config)?;
        for (index, (student, ..)) in pupils.iter_mut().enumerate() {
            move_steps(networks, index, &mut student.networks, 0);
        }
        Ok(outcomes)
    }
}

impl Stacked {
    /// Puts the networks of `pupils` into one stack of at least `width` members, of which they are views from
    /// then on.
    fn gather(pupils: &mut [Pupil<'_>], width: usize) -> Result<Self, AgentError> {
        let Ddpg { config, spec, discount, shapes, arithmetic, .. } = &*pupils[0].0;
        let (dims, members) = (Dims::of(spec), width.max(pupils.len()));
        let networks = Networks::zeros(dims, *shapes, members, *arithmetic)?;
        let learner = Learner::new(config, *discount, dims, *shapes, members, *arithmetic)?;
        for (index, (student, ..)) in pupils.iter_mut().enumerate() {
            let mut member = networks.member(index, dims)?;
            for (to, from) in member.both().into_iter().zip(student.networks.both()) {
                to.copy_from(from)?;
            }
            student.networks = member;
        }
        Ok(Self { networks, learner, students: pupils.len() })
    }

    /// Whether the students' networks are this stack's, in order, and no one else's are.
    fn holds(&self, pupils: &[Pupil<'_>]) -> bool {
        self.students == pupils.len()
            && pupils.iter().enumerate().all(|(index, (student, ..))| {
                student.networks.actor.is_member(&self.networks.actor, index)
                    && student.networks.critic.is_member(&self.networks.critic, index)
            })
    }
}

/// Counts the steps of `to` as those of `from`: both see the same networks.
fn move_steps(from: &Networks, index: usize, to: &mut Networks, place: usize) {
    to.actor.set_steps(place, from.actor.steps()[index]);
    to.critic.set_steps(place, from.critic.steps()[index]);
}

fn pupil<'a>(lane: &'a mut CohortLane<'_>) -> Pupil<'a> {
    let student: &mut dyn Any = lane.student;
    let student = student.downcast_mut().expect("a student of the cohort's kind");
    (student, lane.reward, lane.rng)
}

fn alone((student, reward, rng): Pupil<'_>) -> Result<(), AgentError> {
    // This thread may be any of a pool.
    crate::prepare_thread();
    crate::Agent::learn(student, reward, rng)
}

/// Refuses students that cannot keep step with each other.
fn check_alike(pupils: &[Pupil<'_>]) {
    let Some(((first, ..), others)) = pupils.split_first() else { return };
    let config = first.config.in_lockstep();
    let alike =
        |(student, ..): &Pupil<'_>| student.spec == first.spec && student.config.in_lockstep() == config;
    assert!(others.iter().all(alike), "students of one task whose gradient steps are alike");
}
