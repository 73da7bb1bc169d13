//! The contract of environments.

use crate::env::{GoalEnv, Observation};
use crate::error::EnvError;
use crate::registry::{EnvOptions, Environment, Verification};
use crate::render::{RenderError, Renderer};
use crate::rng::{Purpose, Rng, stream, uniform};

/// Why a rule is broken.
type Broken = String;
/// A check of one rule.
type Rule = fn(&Environment) -> Result<(), Broken>;

/// The rules, and what checks each.
const RULES: &[(&str, Rule)] = &[
    ("the row says what there is to know", row_is_complete),
    ("dimensions are those of the spec, numbers are finite for a whole episode", dimensions_hold),
    ("an episode depends on its stream alone, not on earlier episodes", episodes_depend_on_their_stream),
    ("instances stepped in turn do not disturb each other", instances_are_apart),
    ("a goal is taken whole or refused, and then the old one stays", goals_are_taken_or_refused),
    ("a bad action is refused and changes nothing", bad_actions_are_refused),
    ("an action beyond the bounds equals the clipped one", actions_are_clipped),
    ("sampling a goal leaves the episode alone", sampling_leaves_the_episode_alone),
    ("sampled goals belong to the start of the episode, not to the moment", goals_belong_to_the_start),
    ("the reward is 0 exactly where there is success, else -1", reward_agrees_with_success),
    ("it can be drawn, if it has a scene, and does not notice", drawing_changes_nothing),
];

/// Checks everything that curricula, students and reports rely on in an environment. Write one test for each
/// of yours:
///
/// ```
/// envs::testing::contract(envs::find("Point")?);
/// # Ok::<(), envs::EnvError>(())
/// ```
///
/// In this order:
/// - the row has id, title and source, and its defaults can be trained with; a row that is verified by
///   recordings can play them back;
/// - the environment has the spec of its row; observation, achieved goal and goal have the spec's lengths and
///   stay finite through a whole episode of random actions, which no step ends early;
/// - the same stream gives the same episode, whatever was played, asked for or set before, and a different
///   stream a different one;
/// - two instances that are stepped in turn show what each shows alone;
/// - `set_goal` refuses a goal of another length ([`EnvError::GoalLength`]) or with a number that is not
///   finite ([`EnvError::NotFinite`]) and keeps the old one; it takes a good one as it is;
/// - `step` refuses an action of another length ([`EnvError::ActionLength`]) or with a number that is not
///   finite, and the episode goes on as if nothing had happened; actions beyond [-1, 1] equal clipped ones;
/// - `sample_goal` draws finite goals that are not all alike, disturbs neither goal nor observation nor the
///   steps to come, and draws the same at the start and later in an episode;
/// - the reward is 0 where there is success and -1 elsewhere, for goals from the achieved one to those that
///   the environment asks for; what is achieved succeeds as its own goal, and not every goal is achieved from
///   the beginning;
/// - with a scene it is drawn at the size asked for and is the same afterwards (for simulations only on
///   machines with OpenGL).
///
/// Whether a step allocates memory, and whether its draws have the distribution that they should, is left to
/// other tests.
///
/// # Panics
/// Naming the environment, every rule that it breaks, and how.
pub fn contract(row: &Environment) {
    let broken: Vec<String> = RULES
        .iter()
        .filter_map(|(rule, check)| check(row).err().map(|why| format!("- {rule}: {why}")))
        .collect();
    assert!(broken.is_empty(), "{} breaks the contract of environments:\n{}", row.id(), broken.join("\n"));
}

fn ensure(holds: bool, why: impl FnOnce() -> String) -> Result<(), Broken> {
    if holds { Ok(()) } else { Err(why()) }
}

fn make(row: &Environment) -> Result<Box<dyn GoalEnv>, Broken> {
    row.make(&EnvOptions::default()).map_err(|error| format!("it cannot be made: {error}"))
}

/// An environment at the start of the episode of `seed`.
fn started(row: &Environment, seed: u64) -> Result<Box<dyn GoalEnv>, Broken> {
    let mut env = make(row)?;
    reset(env.as_mut(), seed)?;
    Ok(env)
}

fn reset(env: &mut dyn GoalEnv, seed: u64) -> Result<(), Broken> {
    env.reset(&mut stream(seed, Purpose::Environment)).map_err(|error| format!("reset: {error}"))
}

fn step(env: &mut dyn GoalEnv, action: &[f64]) -> Result<(), Broken> {
    env.step(action).map_err(|error| format!("step: {error}"))
}

fn random_action(env: &dyn GoalEnv, rng: &mut Rng) -> Vec<f64> {
    (0..env.spec().action).map(|_| uniform(rng, -1.0, 1.0)).collect()
}

/// Goal and observation now.
fn shown(env: &dyn GoalEnv) -> (Vec<f64>, Observation) {
    (env.goal().to_vec(), env.observation().clone())
}

/// Everything that the first `steps` steps of the episode of `seed` show, with random actions.
fn episode(env: &mut dyn GoalEnv, seed: u64, steps: usize) -> Result<Vec<(Vec<f64>, Observation)>, Broken> {
    reset(env, seed)?;
    let mut seen = vec![shown(env)];
    let mut rng = stream(seed, Purpose::Exploration);
    for _ in 0..steps {
        let action = random_action(env, &mut rng);
        step(env, &action)?;
        seen.push(shown(env));
    }
    Ok(seen)
}

fn row_is_complete(row: &Environment) -> Result<(), Broken> {
    let texts = [("id", row.id()), ("title", row.title), ("source", row.source)];
    if let Some((name, _)) = texts.iter().find(|(_, text)| text.is_empty()) {
        return Err(format!("its {name} is empty"));
    }
    // Ids become names of folders and lists of them are separated by commas.
    let plain = row.id().chars().all(|c| c.is_ascii_alphanumeric() || "-_".contains(c));
    ensure(plain, || format!("the id `{}` holds more than letters, digits, - and _", row.id()))?;
    let (spec, defaults) = (&row.spec, row.spec.defaults);
    let sizes = [spec.state, spec.goal, spec.action, spec.horizon];
    ensure(sizes.iter().all(|&size| size > 0), || format!("a dimension or the horizon is 0: {spec:?}"))?;
    let trainable = defaults.evaluate_every >= spec.horizon as u64
        && defaults.steps >= defaults.evaluate_every
        && (1..=8).contains(&defaults.layers);
    ensure(trainable, || format!("nothing can be trained with these defaults: {defaults:?}"))?;
    let plays = row.verification == Verification::Analytic || make(row)?.playback().is_some();
    ensure(plays, || "it is verified by recordings that it cannot play back".to_owned())
}

fn dimensions_hold(row: &Environment) -> Result<(), Broken> {
    let check = |env: &dyn GoalEnv, moment: &str| -> Result<(), Broken> {
        let (goal, Observation { state, achieved }) = shown(env);
        for (name, list, expected) in [
            ("state", state, row.spec.state),
            ("achieved goal", achieved, row.spec.goal),
            ("goal", goal, row.spec.goal),
        ] {
            ensure(list.len() == expected, || {
                format!("{moment} the {name} holds {} numbers, the spec says {expected}", list.len())
            })?;
            ensure(list.iter().all(|x| x.is_finite()), || format!("{moment} the {name} is {list:?}"))?;
        }
        Ok(())
    };
    let mut env = make(row)?;
    ensure(env.spec() == &row.spec, || format!("it says {:?}, its row {:?}", env.spec(), row.spec))?;
    check(env.as_ref(), "when made")?;
    reset(env.as_mut(), 0)?;
    check(env.as_ref(), "after a reset")?;
    let mut rng = stream(0, Purpose::Exploration);
    for number in 1..=row.spec.horizon {
        let action = random_action(env.as_ref(), &mut rng);
        step(env.as_mut(), &action)?;
        check(env.as_ref(), &format!("after step {number}"))?;
    }
    Ok(())
}

fn episodes_depend_on_their_stream(row: &Environment) -> Result<(), Broken> {
    let mut used = make(row)?;
    episode(used.as_mut(), 1, 12)?;
    used.set_goal(&vec![0.25; row.spec.goal]).map_err(|error| format!("set_goal: {error}"))?;
    used.sample_goal(&mut stream(9, Purpose::Teacher), &mut vec![0.0; row.spec.goal]);
    let again = episode(used.as_mut(), 2, 8)?;
    ensure(again == episode(make(row)?.as_mut(), 2, 8)?, || {
        "after another episode it is not what a fresh environment shows".to_owned()
    })?;
    ensure(again != episode(used.as_mut(), 3, 8)?, || "two streams give the same episode".to_owned())
}

fn instances_are_apart(row: &Environment) -> Result<(), Broken> {
    let seeds = [4, 5];
    let mut pair = [started(row, seeds[0])?, started(row, seeds[1])?];
    let mut rngs = seeds.map(|seed| stream(seed, Purpose::Exploration));
    for _ in 0..8 {
        for (env, rng) in pair.iter_mut().zip(&mut rngs) {
            let action = random_action(env.as_ref(), rng);
            step(env.as_mut(), &action)?;
        }
    }
    for (env, seed) in pair.iter().zip(seeds) {
        let alone = episode(make(row)?.as_mut(), seed, 8)?;
        ensure(alone.last() == Some(&shown(env.as_ref())), || "one shows other numbers alone".to_owned())?;
    }
    Ok(())
}

fn goals_are_taken_or_refused(row: &Environment) -> Result<(), Broken> {
    let width = row.spec.goal;
    let mut env = started(row, 0)?;
    let before = env.goal().to_vec();
    for length in [width - 1, width + 1] {
        match env.set_goal(&vec![0.5; length]) {
            Err(EnvError::GoalLength { expected, got, .. }) if (expected, got) == (width, length) => {}
            other => return Err(format!("a goal of {length} numbers gave {other:?}")),
        }
    }
    for bad in [f64::NAN, f64::INFINITY] {
        let mut goal = vec![0.5; width];
        goal[width - 1] = bad;
        match env.set_goal(&goal) {
            Err(EnvError::NotFinite { index, .. }) if index == width - 1 => {}
            other => return Err(format!("a goal with {bad} gave {other:?}")),
        }
    }
    ensure(env.goal() == before, || "a refused goal replaced the old one".to_owned())?;
    env.set_goal(&vec![0.5; width]).map_err(|error| format!("a good goal was refused: {error}"))?;
    ensure(env.goal() == vec![0.5; width], || format!("0.5 everywhere became {:?}", env.goal()))
}

fn bad_actions_are_refused(row: &Environment) -> Result<(), Broken> {
    let width = row.spec.action;
    let (mut env, mut twin) = (started(row, 0)?, started(row, 0)?);
    for length in [width - 1, width + 1] {
        match env.step(&vec![0.0; length]) {
            Err(EnvError::ActionLength { expected, got, .. }) if (expected, got) == (width, length) => {}
            other => return Err(format!("an action of {length} numbers gave {other:?}")),
        }
    }
    for bad in [f64::NAN, f64::INFINITY] {
        let mut action = vec![0.0; width];
        action[width - 1] = bad;
        match env.step(&action) {
            Err(EnvError::NotFinite { index, .. }) if index == width - 1 => {}
            other => return Err(format!("an action with {bad} gave {other:?}")),
        }
    }
    for env in [&mut env, &mut twin] {
        step(env.as_mut(), &vec![0.3; width])?;
    }
    ensure(shown(env.as_ref()) == shown(twin.as_ref()), || "the next step went elsewhere".to_owned())
}

fn actions_are_clipped(row: &Environment) -> Result<(), Broken> {
    for (seed, scale) in [(0, 1.5), (1, 30.0), (2, 1e6)] {
        let (mut env, mut twin) = (started(row, seed)?, started(row, seed)?);
        let mut rng = stream(seed, Purpose::Exploration);
        for _ in 0..3 {
            let action: Vec<f64> =
                random_action(env.as_ref(), &mut rng).iter().map(|part| part * scale).collect();
            let clipped: Vec<f64> = action.iter().map(|part| part.clamp(-1.0, 1.0)).collect();
            step(env.as_mut(), &action)?;
            step(twin.as_mut(), &clipped)?;
            ensure(shown(env.as_ref()) == shown(twin.as_ref()), || format!("not for {action:?}"))?;
        }
    }
    Ok(())
}

/// Twenty goals as `env` samples them now.
fn sampled(env: &mut dyn GoalEnv) -> Vec<Vec<f64>> {
    let mut rng = stream(5, Purpose::Teacher);
    let mut goal = vec![f64::NAN; env.spec().goal];
    let mut one = || {
        env.sample_goal(&mut rng, &mut goal);
        goal.clone()
    };
    (0..20).map(|_| one()).collect()
}

fn sampling_leaves_the_episode_alone(row: &Environment) -> Result<(), Broken> {
    let (mut env, mut twin) = (started(row, 4)?, started(row, 4)?);
    let goals = sampled(env.as_mut());
    ensure(goals.iter().flatten().all(|part| part.is_finite()), || format!("not all finite: {goals:?}"))?;
    ensure(goals.iter().any(|goal| *goal != goals[0]), || format!("twenty times {:?}", goals[0]))?;
    ensure(shown(env.as_ref()) == shown(twin.as_ref()), || "goal or observation changed".to_owned())?;
    for env in [&mut env, &mut twin] {
        step(env.as_mut(), &vec![0.3; row.spec.action])?;
    }
    ensure(shown(env.as_ref()) == shown(twin.as_ref()), || "the next step went elsewhere".to_owned())
}

fn goals_belong_to_the_start(row: &Environment) -> Result<(), Broken> {
    let mut env = started(row, 4)?;
    let at_the_start = sampled(env.as_mut());
    for _ in 0..3 {
        step(env.as_mut(), &vec![1.0; row.spec.action])?;
    }
    ensure(sampled(env.as_mut()) == at_the_start, || "three steps later they are others".to_owned())
}

fn reward_agrees_with_success(row: &Environment) -> Result<(), Broken> {
    let mut env = started(row, 0)?;
    let goals = sampled(env.as_mut());
    let achieved = env.observation().achieved.clone();
    ensure(!goals.iter().all(|goal| env.success(&achieved, goal)), || {
        "the start achieves every goal".to_owned()
    })?;
    step(env.as_mut(), &vec![0.2; row.spec.action])?;
    let achieved = env.observation().achieved.clone();
    ensure(env.success(&achieved, &achieved), || "what is achieved fails as its own goal".to_owned())?;
    for goal in &goals {
        for tenths in 0..=10 {
            let part = f64::from(tenths) / 10.0;
            let between: Vec<f64> = achieved.iter().zip(goal).map(|(a, g)| a + (g - a) * part).collect();
            let (success, reward) = (env.success(&achieved, &between), env.reward(&achieved, &between));
            ensure(reward == if success { 0.0 } else { -1.0 }, || {
                format!("{reward} with success {success}, achieved {achieved:?}, goal {between:?}")
            })?;
        }
    }
    Ok(())
}

fn drawing_changes_nothing(row: &Environment) -> Result<(), Broken> {
    let (mut env, mut twin) = (started(row, 0)?, started(row, 0)?);
    if env.scene().is_none() {
        return Ok(());
    }
    let (width, height) = (40, 30);
    let mut renderer = match Renderer::new(env.as_ref(), width, height) {
        Err(RenderError::NoGraphics { .. }) => return Ok(()),
        other => other.map_err(|error| error.to_string())?,
    };
    for _ in 0..3 {
        let image = renderer.frame(env.as_ref()).map_err(|error| error.to_string())?;
        let size = (image.width(), image.height());
        ensure(size == (width, height), || format!("a picture of {size:?}"))?;
        for env in [&mut env, &mut twin] {
            step(env.as_mut(), &vec![0.5; row.spec.action])?;
        }
    }
    ensure(shown(env.as_ref()) == shown(twin.as_ref()), || "pictures changed the episode".to_owned())
}
