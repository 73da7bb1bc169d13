//! The training loop of several runs in lockstep. A run alone is a cohort of one.
//!
//! All lanes play their episodes, then all students learn, then all teachers do and whatever is due follows:
//! evaluations, records, checkpoints. Lanes share the clock of cycles and the pool of threads, nothing else:
//! what a run computes does not depend on who goes through the cycles beside it.
//!
//! Two halves of a cohort may also take turns: one is on the cores while the other learns on the device.

use std::ops::ControlFlow;
use std::panic::resume_unwind;
use std::sync::{Mutex, MutexGuard};
use std::thread;
use std::time::Instant;

use agents::CohortLane;
use rayon::ThreadPool;

use super::error::RunError;
use super::observer::Observer;
use super::train::{Before, End, Trainer};

/// A run of a cohort, with whoever hears of it.
pub trait Lane: Send {
    /// The run, and who hears of it.
    fn parts(&mut self) -> (&mut Trainer, &mut (dyn Observer + Send));
}

/// A run with an observer of its own.
pub struct Observed<O> {
    /// The run.
    pub trainer: Trainer,
    /// Who hears of it.
    pub observer: O,
}

impl<O: Observer + Send> Lane for Observed<O> {
    fn parts(&mut self) -> (&mut Trainer, &mut (dyn Observer + Send)) {
        (&mut self.trainer, &mut self.observer)
    }
}

impl<O: Observer + Send> Observed<O> {
    /// [`train`] of all `lanes` to the ends of their budgets. Gives what observed them, in the order in which
    /// they ended.
    ///
    /// # Errors
    /// The first of those that broke down.
    pub fn train(lanes: Vec<Self>, means: Means<'_>) -> Result<Vec<O>, RunError> {
        let (mut observers, mut broken) = (Vec::new(), None);
        train(lanes, means, |lane, result| match result {
            Ok(_) => observers.push(lane.observer),
            Err(error) => {
                broken.get_or_insert(error);
            }
        });
        broken.map_or(Ok(observers), Err)
    }
}

/// A run that somebody else owns.
pub(super) struct Borrowed<'a>(pub(super) &'a mut Trainer, pub(super) &'a mut (dyn Observer + Send));

impl Lane for Borrowed<'_> {
    fn parts(&mut self) -> (&mut Trainer, &mut (dyn Observer + Send)) {
        (self.0, self.1)
    }
}

/// What a cohort, or half of one, is trained with.
#[derive(Clone, Copy)]
pub struct Means<'a> {
    /// Threads that do the work; the calling thread alone where there are none.
    pub pool: Option<&'a ThreadPool>,
    /// Lanes that a GPU's products are made for, however many there are ([`agents::Cohort`]).
    pub width: usize,
    /// What it shares with the other half of its cohort, if there is one.
    pub turns: Option<&'a Turns>,
}

/// What two halves of a cohort take in turns. A half holds one of the two at a time.
#[derive(Debug, Default)]
pub struct Turns {
    /// For episodes, teachers, evaluations, records and checkpoints.
    cores: Mutex<()>,
    /// For the students' learning.
    device: Mutex<()>,
}

impl<'a> Means<'a> {
    /// Waits for this half's turn on the cores.
    fn cores(&self) -> Option<MutexGuard<'a, ()>> {
        self.turns.map(|turns| held(&turns.cores))
    }

    /// The same for the device.
    fn device(&self) -> Option<MutexGuard<'a, ()>> {
        self.turns.map(|turns| held(&turns.device))
    }

    fn work<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        match self.pool {
            Some(pool) => pool.install(work),
            None => work(),
        }
    }
}

/// Waits for what two halves share. Where one has panicked, the other ends the same way, without a word of
/// its own: the panic has been told of.
fn held<T>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(|_| resume_unwind(Box::new("the other half of the cohort panicked")))
}

/// [`train`] of `lanes` in two halves, each with one of `pools`, which may be the same: while one half is on
/// the cores, the other learns on the device. Every lane keeps its own order of events. A GPU's products are
/// made for half of `width`.
///
/// # Panics
/// As [`train`]; and if a half panics, once the other has come to the end of its turn.
pub fn train_in_turns<L: Lane>(
    lanes: Vec<L>,
    pools: [&ThreadPool; 2],
    width: usize,
    ended: impl FnMut(L, Result<End, RunError>) + Send,
) {
    let (turns, ended) = (Turns::default(), Mutex::new(ended));
    let mut halves = [Vec::new(), Vec::new()];
    // Lanes come in the order of the plan, neighbours are alike: so are the halves then.
    for (index, lane) in lanes.into_iter().enumerate() {
        halves[index % 2].push(lane);
    }
    let means = |pool| Means { pool: Some(pool), width: width.div_ceil(2), turns: Some(&turns) };
    let ended = &ended;
    thread::scope(|scope| {
        let [first, second] = [0, 1].map(|half| {
            let (lanes, means) = (std::mem::take(&mut halves[half]), means(pools[half]));
            scope.spawn(move || train(lanes, means, |lane, result| held(ended)(lane, result)))
        });
        for half in [first.join(), second.join()] {
            half.unwrap_or_else(|panic| resume_unwind(panic));
        }
    });
}

/// Trains all `lanes` to the ends of their budgets, or until their observers' checkpointers wish to stop.
/// Each leaves with `ended` as soon as it comes to its end or breaks down, and the others go on. `ended` is
/// called on the calling thread.
///
/// # Panics
/// If the students cannot learn in lockstep ([`agents::StudentConfig::in_lockstep`]).
pub fn train<L: Lane>(lanes: Vec<L>, means: Means<'_>, mut ended: impl FnMut(L, Result<End, RunError>)) {
    let lanes = lanes.into_iter().map(|lane| (lane, ())).collect();
    let mut turn = means.cores();
    let mut lanes = side_by_side(means, lanes, |trainer, observer, ()| trainer.begin(observer), &mut ended);
    let Some((first, ())) = lanes.first_mut() else { return };
    let mut cohort = first.parts().0.cohort(means.width);
    while !lanes.is_empty() {
        let play = |trainer: &mut Trainer, observer: &mut dyn Observer, ()| trainer.play(observer);
        let mut played = side_by_side(means, lanes, play, &mut ended);
        drop(turn);

        turn = means.device();
        let begun = Instant::now();
        let mut students: Vec<CohortLane<'_>> =
            played.iter_mut().map(|(lane, _)| lane.parts().0.learning()).collect();
        let outcomes = means.work(|| cohort.learn(&mut students));
        drop(students);
        let share = begun.elapsed() / u32::try_from(played.len().max(1)).unwrap_or(u32::MAX);
        drop(turn);

        turn = means.cores();
        let learned = played.into_iter().zip(outcomes).map(|((lane, before), outcome)| {
            (lane, outcome.map(|()| ControlFlow::Continue(before)).map_err(RunError::from))
        });
        let learned = going_on(learned, &mut ended);
        let finish = |trainer: &mut Trainer, observer: &mut dyn Observer, before: Before| {
            trainer.finish(&before, share, observer)
        };
        lanes = side_by_side(means, learned, finish, &mut ended);
    }
}

/// What a lane's part of a cycle came to: something to go on with, or the run's end.
type Outcome<T> = Result<ControlFlow<End, T>, RunError>;

/// Lets all lanes do `work`, each with what it brought along. Gives those that go on, with what they got.
fn side_by_side<L: Lane, T: Send, U: Send>(
    means: Means<'_>,
    lanes: Vec<(L, T)>,
    work: impl Fn(&mut Trainer, &mut dyn Observer, T) -> Outcome<U> + Sync + Send,
    ended: &mut impl FnMut(L, Result<End, RunError>),
) -> Vec<(L, U)> {
    let done = means.work(|| {
        agents::side_by_side(lanes, |(mut lane, brought)| {
            // This thread may be any of a pool.
            agents::prepare_thread();
            let (trainer, observer) = lane.parts();
            let outcome = work(trainer, observer, brought);
            (lane, outcome)
        })
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

#[cfg(test)]
mod tests {
    use std::panic::{AssertUnwindSafe, catch_unwind};

    use super::*;
    use crate::Registry;
    use crate::config::layer::ConfigLayer;
    use crate::protocol::Protocol;
    use crate::protocol::plan::Plan;

    /// A run far from its end, which panics when its turn has come so often.
    struct Fragile {
        trainer: Trainer,
        observer: (),
        turns: u32,
    }

    impl Lane for Fragile {
        fn parts(&mut self) -> (&mut Trainer, &mut (dyn Observer + Send)) {
            assert!(self.turns > 0, "a lane breaks");
            self.turns -= 1;
            (&mut self.trainer, &mut self.observer)
        }
    }

    #[test]
    fn a_half_that_panics_ends_the_other() {
        let registry = Registry::builtin();
        let mut protocol = Protocol::from_options();
        protocol.environments = vec!["Point".into()];
        protocol.curricula = vec!["her-iid".into()];
        protocol.seeds = vec![0, 1];
        for setting in ["student.width=8", "student.batch=8", "student.updates_per_cycle=1"] {
            protocol.set(ConfigLayer::from_assignment("--set", setting).expect("sound"));
        }
        let runs = Plan::new(&protocol, &registry).expect("sound").runs;
        for turns in [[20, u32::MAX], [u32::MAX, 20]] {
            let lanes = runs.iter().zip(turns).map(|(run, turns)| Fragile {
                trainer: Trainer::new(&registry, run.key.clone(), run.config.clone()).expect("sound"),
                observer: (),
                turns,
            });
            let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("threads");
            let train = || train_in_turns(lanes.collect(), [&pool, &pool], 2, |_, _| panic!("a lane ended"));
            let panic = catch_unwind(AssertUnwindSafe(train)).expect_err("a lane breaks");
            let text = panic.downcast_ref::<&str>().expect("a text");
            assert!(["a lane breaks", "the other half of the cohort panicked"].contains(text), "{text}");
        }
    }
}
