//! The training loop of several runs in lockstep. A run alone is a cohort of one.
//!
//! All lanes play their episodes, then all students learn, then all teachers do and whatever is due follows:
//! evaluations, records, checkpoints. Lanes share the clock of cycles and the pool of threads, nothing else:
//! what a run computes does not depend on who goes through the cycles beside it.

use std::ops::ControlFlow;
use std::time::Instant;

use agents::CohortLane;

use super::error::RunError;
use super::observer::Observer;
use super::train::{Before, End, Trainer};

/// A run of a cohort, with whoever hears of it.
pub trait Lane: Send {
    /// Both.
    fn parts(&mut self) -> (&mut Trainer, &mut (dyn Observer + Send));
}

/// A run that somebody else owns.
pub(super) struct Borrowed<'a>(pub(super) &'a mut Trainer, pub(super) &'a mut (dyn Observer + Send));

impl Lane for Borrowed<'_> {
    fn parts(&mut self) -> (&mut Trainer, &mut (dyn Observer + Send)) {
        (self.0, self.1)
    }
}

/// Trains all `lanes` to the ends of their budgets, or until their observers' checkpointers wish to stop.
/// Each leaves with `ended` as soon as it comes to its end or breaks down, and the others go on. The rayon
/// pool that the calling thread belongs to does the work, or the calling thread alone if it belongs to none;
/// `ended` is called on the calling thread.
///
/// On a GPU the products of students are as wide as `width`, however many lanes are left
/// ([`agents::Cohort`]).
///
/// # Panics
/// If the students cannot learn in lockstep ([`agents::StudentConfig::in_lockstep`]).
pub fn train<L: Lane>(lanes: Vec<L>, width: usize, mut ended: impl FnMut(L, Result<End, RunError>)) {
    let lanes = lanes.into_iter().map(|lane| (lane, ())).collect();
    let mut lanes = side_by_side(lanes, |trainer, observer, ()| trainer.begin(observer), &mut ended);
    let Some((first, ())) = lanes.first_mut() else { return };
    let mut cohort = first.parts().0.cohort(width);
    while !lanes.is_empty() {
        let play = |trainer: &mut Trainer, observer: &mut dyn Observer, ()| trainer.play(observer);
        let mut played = side_by_side(lanes, play, &mut ended);

        let begun = Instant::now();
        let mut students: Vec<CohortLane<'_>> =
            played.iter_mut().map(|(lane, _)| lane.parts().0.learning()).collect();
        let outcomes = cohort.learn(&mut students);
        drop(students);
        let share = begun.elapsed() / u32::try_from(played.len().max(1)).unwrap_or(u32::MAX);
        let learned = played.into_iter().zip(outcomes).map(|((lane, before), outcome)| {
            (lane, outcome.map(|()| ControlFlow::Continue(before)).map_err(RunError::from))
        });
        let learned = going_on(learned, &mut ended);

        let finish = |trainer: &mut Trainer, observer: &mut dyn Observer, before: Before| {
            trainer.finish(&before, share, observer)
        };
        lanes = side_by_side(learned, finish, &mut ended);
    }
}

/// What a lane's part of a cycle came to: something to go on with, or the run's end.
type Outcome<T> = Result<ControlFlow<End, T>, RunError>;

/// Lets all lanes do `work`, each with what it brought along. Gives those that go on, with what they got.
fn side_by_side<L: Lane, T: Send, U: Send>(
    lanes: Vec<(L, T)>,
    work: impl Fn(&mut Trainer, &mut dyn Observer, T) -> Outcome<U> + Sync,
    ended: &mut impl FnMut(L, Result<End, RunError>),
) -> Vec<(L, U)> {
    let done = agents::side_by_side(lanes, |(mut lane, brought)| {
        // This thread may be any of a pool.
        agents::prepare_thread();
        let (trainer, observer) = lane.parts();
        let outcome = work(trainer, observer, brought);
        (lane, outcome)
    });
    going_on(done, ended)
}

/// Those lanes that have not come to their end; the others leave.
fn going_on<L, T>(
    done: impl IntoIterator<Item = (L, Outcome<T>)>,
    ended: &mut impl FnMut(L, Result<End, RunError>),
) -> Vec<(L, T)> {
    let mut going = Vec::new();
    for (lane, outcome) in done {
        match outcome {
            Ok(ControlFlow::Continue(got)) => going.push((lane, got)),
            Ok(ControlFlow::Break(end)) => ended(lane, Ok(end)),
            Err(error) => ended(lane, Err(error)),
        }
    }
    going
}
