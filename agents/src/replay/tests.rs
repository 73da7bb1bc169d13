use std::collections::BTreeMap;

use envs::rng::{Purpose, Rng, stream};
use envs::{Defaults, EnvError, GoalEnv, GoalSource, Observation, Reward, Rows, Spec};

use super::{Replay, Source};
use crate::batch::Batch;
use crate::draw::{HerStrategy, Hindsight};
use crate::episode::{Episode, Trajectory};
use crate::error::AgentError;

const H: usize = 4;
const SPEC: Spec =
    Spec { id: "Tiny", family: "toy", state: 2, goal: 1, action: 1, horizon: H, defaults: Defaults::TOY };

/// A task that is only asked for rewards: 0 if achieved and goal are equal, else −1.
struct Equal;

impl Reward for Equal {
    fn reward(&self, achieved: &[f64], goal: &[f64]) -> f64 {
        if achieved == goal { 0.0 } else { -1.0 }
    }
    fn success(&self, achieved: &[f64], goal: &[f64]) -> bool {
        achieved == goal
    }
}

impl GoalSource for Equal {
    fn sample_goal(&mut self, _rng: &mut Rng, _goal: &mut [f64]) {
        unreachable!("only rewards are asked for")
    }
}

impl GoalEnv for Equal {
    fn spec(&self) -> &Spec {
        &SPEC
    }
    fn reset(&mut self, _rng: &mut Rng) -> Result<(), EnvError> {
        unreachable!("only rewards are asked for")
    }
    fn set_goal(&mut self, _goal: &[f64]) -> Result<(), EnvError> {
        unreachable!("only rewards are asked for")
    }
    fn step(&mut self, _action: &[f64]) -> Result<(), EnvError> {
        unreachable!("only rewards are asked for")
    }
    fn observation(&self) -> &Observation {
        unreachable!("only rewards are asked for")
    }
    fn goal(&self) -> &[f64] {
        unreachable!("only rewards are asked for")
    }
}

/// Episode number e in numbers that say where they belong: at step t the state is (e, t), the achieved goal
/// 10·e + t, the action e + t/8; the goal asked for is −e.
fn episode(number: usize) -> Episode {
    let e = number as f64;
    let (mut states, mut achieved, mut actions) = (Rows::new(2), Rows::new(1), Rows::new(1));
    for t in 0..=H {
        let t = t as f64;
        states.push(&[e, t]);
        achieved.push(&[10.0 * e + t]);
        if actions.len() < H {
            actions.push(&[e + t / 8.0]);
        }
    }
    Episode { states, achieved, actions, goal: vec![-e], total_reward: 0.0, success: false }
}

/// A buffer of room for `capacity` episodes that has taken in the episodes 1 to `episodes`.
fn filled(capacity: usize, episodes: usize) -> Replay {
    let mut replay = Replay::new(&SPEC, capacity * H).unwrap();
    (1..=episodes).for_each(|number| replay.push(&episode(number)).unwrap());
    replay
}

/// Draws many transitions, checks that each is one of an episode, and counts (episode, step, goal).
fn sample(
    replay: &Replay,
    source: Source,
    hindsight: Hindsight,
    n: usize,
) -> BTreeMap<(usize, usize, i32), usize> {
    let mut batch = Batch::new(&SPEC, n);
    replay.sample(source, hindsight, &Equal, &mut stream(0, Purpose::Replay), &mut batch).unwrap();
    let mut counts = BTreeMap::new();
    for row in 0..n {
        let [e, t] = [batch.states[2 * row], batch.states[2 * row + 1]];
        assert_eq!(batch.next_states[2 * row..][..2], [e, t + 1.0]);
        assert_eq!(batch.actions[row], e + t / 8.0);
        let reached = batch.goals[row] == 10.0 * e + t + 1.0;
        assert_eq!(batch.rewards[row], if reached { 0.0 } else { -1.0 });
        *counts.entry((e as usize, t as usize, batch.goals[row] as i32)).or_default() += 1;
    }
    counts
}

#[test]
fn without_hindsight_every_transition_comes_with_the_goal_asked_for() {
    let counts = sample(&filled(3, 3), Source::All, Hindsight::NONE, 12_000);
    assert_eq!(counts.len(), 3 * H, "every transition of every episode");
    for ((e, _, goal), count) in counts {
        assert_eq!(goal, -(e as i32));
        assert!((800..1200).contains(&count), "1000 expected of each, {count} came");
    }
}

/// Checks the share, among the relabelled transitions that start at step t, of the goals achieved at index i.
fn check_goals(strategy: HerStrategy, expected: impl Fn(usize, usize) -> f64) {
    let n = 40_000;
    let counts = sample(&filled(1, 1), Source::All, Hindsight { k: 4, strategy }, n);
    let share = |t: usize, goal: i32| counts.get(&(1, t, goal)).copied().unwrap_or(0) as f64 / n as f64;
    for t in 0..H {
        // One in five keeps the goal asked for.
        assert!((share(t, -1) - 0.2 / H as f64).abs() < 0.01, "step {t}");
        for index in 0..=H {
            let (expected, got) = (0.8 / H as f64 * expected(t, index), share(t, 10 + index as i32));
            assert!((got - expected).abs() < 0.01, "step {t}, goal of {index}: {got} for {expected}");
            assert!(expected > 0.0 || got == 0.0, "step {t}, goal of {index}");
        }
    }
}

#[test]
fn future_goals_are_achieved_later_in_the_same_episode() {
    check_goals(HerStrategy::Future, |t, index| if index > t { 1.0 / (H - t) as f64 } else { 0.0 });
}

#[test]
fn final_goals_are_achieved_at_the_end_of_the_same_episode() {
    check_goals(HerStrategy::Final, |_, index| if index == H { 1.0 } else { 0.0 });
}

#[test]
fn episode_goals_are_achieved_by_any_transition_of_the_same_episode() {
    check_goals(HerStrategy::Episode, |_, index| if index > 0 { 1.0 / H as f64 } else { 0.0 });
}

#[test]
fn a_full_buffer_forgets_the_oldest_episode() {
    let replay = filled(3, 5);
    assert_eq!((replay.len(), replay.transitions(), replay.stored()), (3, 12, 5));
    let episodes: Vec<usize> =
        sample(&replay, Source::All, Hindsight::NONE, 500).into_keys().map(|key| key.0).collect();
    assert_eq!([episodes.first(), episodes.last()], [Some(&3), Some(&5)]);
    assert!(sample(&replay, Source::Newest, Hindsight::NONE, 100).into_keys().all(|(e, _, _)| e == 5));
}

#[test]
fn capacity_is_rounded_down_to_whole_episodes() {
    let mut replay = Replay::new(&SPEC, 2 * H + 3).unwrap();
    (1..=3).for_each(|number| replay.push(&episode(number)).unwrap());
    assert_eq!(replay.len(), 2);
    assert!(matches!(Replay::new(&SPEC, H - 1), Err(AgentError::Config { field: "replay_capacity", .. })));
}

/// The paper's environments at the default capacity, from 4·((H + 1)(S + G + A) + G) bytes per episode.
#[test]
fn memory_is_what_the_documentation_says() {
    for (ids, megabytes) in [
        (&["MazeA", "MazeB", "MazeC"][..], 25),
        (&["FetchReach"], 70),
        (&["FetchPush", "FetchSlide", "FetchPickAndPlace"], 131),
        (&["HandReach"], 401),
        (&["HandManipulateBlockRotateZ", "HandManipulatePenRotate", "HandManipulateEggRotate"], 356),
    ] {
        for id in ids {
            let replay = Replay::new(&envs::find(id).unwrap().spec, 1_000_000).unwrap();
            assert_eq!((replay.capacity_bytes() as f64 / 1e6).round() as u64, megabytes, "{id}");
        }
    }
    // Room for 3 episodes of 5·4 + 1 numbers of 4 bytes; what the full buffer really holds is as much.
    let replay = filled(3, 5);
    let held: usize = replay.records.iter().map(|record| 4 * record.len()).sum();
    assert_eq!((replay.capacity_bytes(), held), (3 * 84, 3 * 84));
}

#[test]
fn states_are_those_that_transitions_start_from() {
    let (replay, mut rng) = (filled(2, 2), stream(0, Purpose::Teacher));
    let mut seen = BTreeMap::new();
    for _ in 0..8000 {
        let mut state = [0.0; 2];
        replay.sample_state(&mut rng, &mut state).unwrap();
        *seen.entry(state.map(|x| x as usize)).or_insert(0usize) += 1;
    }
    assert_eq!(seen.len(), 2 * H);
    assert!(seen.values().all(|count| (850..1150).contains(count)), "{seen:?}");
}

#[test]
fn nothing_can_be_drawn_from_an_empty_buffer() {
    let (empty, mut rng) = (filled(1, 0), stream(0, Purpose::Replay));
    let drawn = empty.sample(Source::All, Hindsight::NONE, &Equal, &mut rng, &mut Batch::new(&SPEC, 1));
    assert!(matches!(drawn, Err(AgentError::EmptyReplay)));
    assert!(matches!(empty.sample_state(&mut rng, &mut [0.0; 2]), Err(AgentError::EmptyReplay)));
}

#[test]
fn episodes_are_remembered_whole_the_newest_first() {
    // Room for 3 of 5 episodes: 1 and 2 have been replaced.
    let replay = filled(3, 5);
    for (age, number) in [(0, 5), (1, 4), (2, 3)] {
        let Episode { states, achieved, actions, goal, .. } = episode(number);
        assert_eq!(replay.trajectory(age), Some(Trajectory { states, achieved, actions, goal }), "{age}");
    }
    assert_eq!((replay.trajectory(3), filled(3, 0).trajectory(0)), (None, None));
}

#[test]
fn achieved_goals_are_drawn_from_all_that_were_achieved_by_an_action() {
    let (replay, mut rng) = (filled(2, 3), stream(0, Purpose::Replay));
    let mut counts = BTreeMap::new();
    for _ in 0..8_000 {
        let mut goal = [0.0];
        replay.sample_achieved(&mut rng, &mut goal).unwrap();
        *counts.entry(goal[0] as usize).or_insert(0) += 1;
    }
    let expected: Vec<usize> = [2, 3].into_iter().flat_map(|e| (1..=H).map(move |t| 10 * e + t)).collect();
    assert_eq!(counts.keys().copied().collect::<Vec<_>>(), expected, "of the two episodes left");
    assert!(counts.values().all(|count| (880..1120).contains(count)), "1000 expected of each: {counts:?}");
    let nothing = filled(2, 0).sample_achieved(&mut rng, &mut [0.0]);
    assert!(matches!(nothing, Err(AgentError::EmptyReplay)));
}
