//! What is left of a method when a run is interrupted.

use super::{ENOUGH_CYCLES, GOALS, Subject, cycle, proposals};
use crate::error::CurriculumError;
use crate::snapshot;
use crate::testing::Class;

fn saved(class: &Class) -> Vec<u8> {
    class.teacher.save().expect("plain data and networks")
}

/// Saved after cycles of so many episodes each.
pub(super) fn continues_identically(subject: Subject<'_>, before: &[usize]) {
    let name = format!("{subject}, saved after {before:?}");
    let taught = || {
        let mut class = subject.class(GOALS);
        before.iter().for_each(|&episodes| drop(cycle(&mut class, episodes)));
        class
    };
    // Everything but the teacher's own state is the caller's to restore.
    let (mut straight, mut resumed) = (taught(), taught());
    resumed.teacher = subject.class(GOALS).teacher;
    resumed.teacher.load(&saved(&straight)).unwrap_or_else(|error| panic!("{name}: {error}"));
    assert_records_the_same(&resumed, &straight, &name);
    for _ in 0..8 {
        for _ in 0..2 {
            let proposal = |class: &mut Class| class.propose().expect("a proposal");
            assert_eq!(proposal(&mut resumed), proposal(&mut straight), "{name}");
            assert_records_the_same(&resumed, &straight, &name);
        }
        [&mut resumed, &mut straight].into_iter().for_each(Class::learn);
    }
    assert!(saved(&resumed) == saved(&straight), "{name}: the state is another");
}

/// What there is to record of the teachers of both.
fn assert_records_the_same(resumed: &Class, straight: &Class, name: &str) {
    let numbers = |class: &Class| {
        let bits = |(name, value): (&str, f64)| (name.to_owned(), value.to_bits());
        class.teacher.summary().statistics.into_iter().map(bits).collect::<Vec<_>>()
    };
    assert_eq!(numbers(resumed), numbers(straight), "{name}");
    assert_eq!(resumed.teacher.summary().weights, straight.teacher.summary().weights, "{name}");
}

/// Saved once it has asked for probe rollouts, before it hears of them; as long as it asks for none, it is
/// not tested here.
pub(super) fn continues_identically_while_rollouts_are_pending(subject: Subject<'_>) {
    let asked = || {
        let mut class = subject.class(GOALS);
        for _ in 0..ENOUGH_CYCLES {
            (0..2).for_each(|_| drop(class.propose().expect("a proposal")));
            class.learn_alone();
            if let Some(request) = class.request() {
                return Some((class, request));
            }
        }
        None
    };
    let (Some((mut straight, request)), Some((mut resumed, same))) = (asked(), asked()) else { return };
    assert_eq!(request, same, "{subject}: the same seed");
    resumed.teacher = subject.class(GOALS).teacher;
    resumed.teacher.load(&saved(&straight)).unwrap_or_else(|error| panic!("{subject}: {error}"));
    [&mut straight, &mut resumed].into_iter().for_each(|class| class.play(&request));
    assert_eq!(proposals(&mut resumed, 8), proposals(&mut straight, 8), "{subject}, with rollouts pending");
    assert!(saved(&resumed) == saved(&straight), "{subject}, with rollouts pending: the state is another");
}

pub(super) fn refuses_what_it_did_not_save(subject: Subject<'_>) {
    let mut taught = subject.class(GOALS);
    proposals(&mut taught, 3);
    let bytes = saved(&taught);
    let mut refuse = |what: &str, foreign: &[u8]| {
        let result = taught.teacher.load(foreign);
        assert!(matches!(result, Err(CurriculumError::State { .. })), "{subject}: {what}: {result:?}");
    };
    refuse("noise", &[0xA5; 64]);
    refuse("another method", &snapshot::save("another", 1, &0u8));
    if !bytes.is_empty() {
        refuse("nothing", &[]);
        refuse("all but one byte", &bytes[..bytes.len() - 1]);
        refuse("half", &bytes[..bytes.len() / 2]);
    }
    assert!(saved(&taught) == bytes, "{subject}: what it refused has changed it");
}

pub(super) fn refuses_the_state_of_another_pool(subject: Subject<'_>) {
    let mut taught = subject.class(GOALS);
    proposals(&mut taught, 3);
    let bytes = saved(&taught);
    if bytes.is_empty() || taught.teacher.summary().weights.is_none() {
        return;
    }
    let error = subject.class(GOALS + 1).teacher.load(&bytes).expect_err("another pool").to_string();
    assert!(error.contains("written for 12 goals; the pool has 13"), "{subject}: {error}");
}
