//! Students in lockstep as a GPU would have them: in one stack. What is compared is a student's saved state.

use envs::rng::{Purpose, Rng, stream};
use envs::{GoalEnv, Rows};

use super::wiring_tests::{episode, small};
use super::{Ddpg, DdpgCohort, state};
use crate::agent::{Agent, Critic, Mode};
use crate::cohort::{Cohort, CohortLane};
use crate::config::StudentConfig;
use crate::device::{far_away, under_test};
use crate::episode::Episode;
use crate::error::AgentError;
use crate::precision::Precision;

/// A student with its task and its streams.
struct Run {
    student: Ddpg,
    env: Box<dyn GoalEnv>,
    replay: Rng,
    exploration: Rng,
}

impl Run {
    fn new(config: &StudentConfig, seed: u64) -> Self {
        crate::prepare_thread();
        let env = envs::make("Point", &envs::EnvOptions::default()).unwrap();
        let student = Ddpg::new(config, env.spec(), seed).unwrap();
        let [replay, exploration] = [Purpose::Replay, Purpose::Exploration].map(|of| stream(seed, of));
        Self { student, env, replay, exploration }
    }

    /// Takes in an episode in which the policy's own actions tell it from others.
    fn experience(&mut self, number: u16) {
        let mut episode = episode(number);
        self.env.reset(&mut self.exploration).unwrap();
        let mut action = [0.0; 2];
        let goal = [0.3, -0.3];
        self.student.act(self.env.observation(), &goal, Mode::Greedy, &mut action).unwrap();
        episode.goal = action.to_vec();
        self.student.observe(&episode, self.env.as_ref(), &mut self.replay).unwrap();
    }

    /// Takes in an episode that is no numbers.
    fn poison(&mut self) {
        let mut states = Rows::new(2);
        (0..=20).for_each(|_| states.push(&[f64::NAN; 2]));
        let nan = Episode { states, ..episode(1) };
        self.student.observe(&nan, self.env.as_ref(), &mut self.replay).unwrap();
    }

    fn lane(&mut self) -> CohortLane<'_> {
        CohortLane { student: &mut self.student, reward: self.env.as_ref(), rng: &mut self.replay }
    }

    fn state(&self) -> Vec<u8> {
        state::encode(&self.student).unwrap()
    }
}

/// A cycle of all `runs`, with an episode before it.
fn cycle(cohort: &mut DdpgCohort, runs: &mut [&mut Run]) -> Vec<Result<(), AgentError>> {
    for run in &mut *runs {
        run.experience(run.student.gradient_steps() as u16);
    }
    learn(cohort, runs)
}

fn learn(cohort: &mut DdpgCohort, runs: &mut [&mut Run]) -> Vec<Result<(), AgentError>> {
    let mut lanes: Vec<CohortLane<'_>> = runs.iter_mut().map(|run| run.lane()).collect();
    cohort.learn(&mut lanes)
}

/// Student 3 after four cycles, with the neighbours that each of them has.
fn beside(config: &StudentConfig, neighbours: [&[u64]; 4]) -> Vec<u8> {
    let mut cohort = DdpgCohort::new(4);
    let mut run = Run::new(config, 3);
    let mut others: Vec<Run> = (10..16).map(|seed| Run::new(config, seed)).collect();
    for present in neighbours {
        let there = others.iter_mut().enumerate().filter(|(i, _)| present.contains(&(*i as u64)));
        let mut runs: Vec<&mut Run> = there.map(|(_, run)| run).collect();
        // Its place among them changes, too.
        runs.insert(present.len() / 2, &mut run);
        cycle(&mut cohort, &mut runs).into_iter().for_each(|outcome| outcome.unwrap());
    }
    run.state()
}

#[test]
fn in_a_stack_a_student_does_not_depend_on_its_neighbours() {
    for precision in Precision::ALL {
        let config = StudentConfig { device: under_test(), precision, ..small() };
        far_away(|| {
            let alone = beside(&config, [&[], &[], &[], &[]]);
            assert!(alone == beside(&config, [&[0, 1, 2], &[0, 1, 2], &[0, 1, 2], &[0, 1, 2]]));
            assert!(alone == beside(&config, [&[0], &[4, 5], &[5, 1, 3], &[]]), "who come and go");
        });
    }
}

/// A stack's students learn what students alone learn, up to the order of sums.
#[test]
fn a_student_of_a_stack_learns_what_one_on_the_cpu_learns() {
    let config = small();
    let numbers = |far: bool| {
        let work = || {
            let mut runs = [0, 1, 2].map(|seed| Run::new(&config, seed));
            let mut cohort = DdpgCohort::new(3);
            for _ in 0..3 {
                let [a, b, c] = &mut runs;
                cycle(&mut cohort, &mut [a, b, c]).into_iter().for_each(|outcome| outcome.unwrap());
            }
            runs.map(|run| {
                run.student.networks.actor.network(crate::networks::Parameters::Target).numbers().unwrap()
            })
        };
        if far { far_away(work) } else { work() }
    };
    for (far, near) in numbers(true).iter().zip(numbers(false)) {
        for (far, near) in far.iter().zip(near) {
            assert!((far - near).abs() < 1e-4, "{far}, not {near}");
        }
    }
}

/// Its replay buffer holds NaN; it is told which step of its own that was, and the others do not notice.
#[test]
fn one_that_diverges_disturbs_no_other() {
    let trained = |poisoned: bool| {
        let config = small();
        let [mut a, mut b, mut c] = [0, 1, 2].map(|seed| Run::new(&config, seed));
        let mut cohort = DdpgCohort::new(3);
        cycle(&mut cohort, &mut [&mut a, &mut b, &mut c]).into_iter().for_each(|outcome| outcome.unwrap());
        if poisoned {
            b.poison();
        }
        let told = learn(&mut cohort, &mut [&mut a, &mut b, &mut c]);
        cycle(&mut cohort, &mut [&mut a, &mut c]).into_iter().for_each(|outcome| outcome.unwrap());
        ([a.state(), c.state()], told)
    };
    for far in [false, true] {
        let both = || (trained(true), trained(false));
        let ((disturbed, told), (undisturbed, _)) = if far { far_away(both) } else { both() };
        assert!(disturbed == undisturbed, "far: {far}");
        let diverged =
            matches!(told[..], [Ok(()), Err(AgentError::Diverged { gradient_steps: 4, .. }), Ok(())]);
        assert!(diverged, "{told:?}");
    }
}

/// Warm-ups of 0, 2 and 5 episodes: each learns from the cycle on that ends its own, and one without
/// experience is told so.
#[test]
fn those_that_do_not_learn_yet_are_left_out() {
    let steps = || {
        let config = |warmup_episodes| StudentConfig { warmup_episodes, ..small() };
        let mut runs = [0, 2, 5].map(|warmup| Run::new(&config(warmup), 1));
        let mut cohort = DdpgCohort::new(3);
        let mut steps = Vec::new();
        for _ in 0..3 {
            let [a, b, c] = &mut runs;
            cycle(&mut cohort, &mut [a, b, c]).into_iter().for_each(|outcome| outcome.unwrap());
            steps.push(runs.each_ref().map(|run| run.student.gradient_steps()));
        }
        let outcome = learn(&mut cohort, &mut [&mut Run::new(&config(0), 1)]).pop();
        assert!(matches!(outcome, Some(Err(AgentError::EmptyReplay))), "{outcome:?}");
        steps
    };
    let expected = vec![[3, 0, 0], [6, 3, 0], [9, 6, 0]];
    assert_eq!(steps(), expected);
    assert_eq!(far_away(steps), expected);
}

#[test]
fn a_state_loaded_into_a_stack_is_learned_from_and_acted_by() {
    far_away(|| {
        let config = StudentConfig { device: under_test(), ..small() };
        let folder = tempfile::tempdir().unwrap();
        let mut runs = [7, 8].map(|seed| Run::new(&config, seed));
        let mut cohort = DdpgCohort::new(2);
        let [a, b] = &mut runs;
        cycle(&mut cohort, &mut [a, b]).into_iter().for_each(|outcome| outcome.unwrap());
        let saved = runs[0].student.save(folder.path()).unwrap();
        let (replay, exploration) = (runs[0].replay.clone(), runs[0].exploration.clone());
        let [a, b] = &mut runs;
        cycle(&mut cohort, &mut [a, b]).into_iter().for_each(|outcome| outcome.unwrap());
        let expected = runs[0].state();
        // Back to the save, in place.
        runs[0].student.load(&saved, folder.path()).unwrap();
        (runs[0].replay, runs[0].exploration) = (replay, exploration);
        let [a, b] = &mut runs;
        cycle(&mut cohort, &mut [a, b]).into_iter().for_each(|outcome| outcome.unwrap());
        assert!(runs[0].state() == expected);
    });
}

#[test]
#[should_panic(expected = "gradient steps are alike")]
fn students_that_cannot_keep_step_are_refused() {
    let mut runs = [small(), StudentConfig { actor_lr: 5e-3, ..small() }].map(|config| Run::new(&config, 0));
    let [a, b] = &mut runs;
    cycle(&mut DdpgCohort::new(2), &mut [a, b]);
}
