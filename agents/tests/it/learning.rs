//! A working student solves the toy task; one with a broken part does not.
//!
//! Success over 50 episodes, measured for seeds 0 to 9:
//!
//! | student | cycles | success |
//! |---|---|---|
//! | default α = 0.95 | 260 | 1.00 for all (160 cycles: 0.84 to 1.00) |
//! | quick, α = 0.5 | 60 | 1.00 for all (as at 40 cycles) |
//! | quick, α = 0: targets are copies | 60 | 1.00 for all: on this task lagging behind is not needed |
//! | quick, Ornstein-Uhlenbeck noise | 60 | 1.00 for all |
//! | quick, no hindsight | 60 | 0.28 for one, else up to 0.04 |
//! | quick, α = 1: targets never move | 60 | 0.06 to 0.24 |

use agents::StudentConfig;

use crate::toy::{Run, small};

const EPISODES: usize = 50;

/// Targets that follow in large steps learn the toy task in a fifth of the cycles.
fn quick() -> StudentConfig {
    StudentConfig { polyak: 0.5, ..small() }
}

fn success(config: &StudentConfig, seed: u64, cycles: usize) -> f64 {
    Run::trained(config, seed, cycles).success_rate(EPISODES)
}

#[test]
fn default_settings_solve_the_toy_task() {
    assert_eq!(success(&small(), 0, 260), 1.0);
}

#[test]
fn targets_that_follow_quickly_solve_it_sooner() {
    for seed in [1, 2] {
        assert_eq!(success(&quick(), seed, 60), 1.0, "seed {seed}");
    }
}

fn assert_not_solved(broken: &StudentConfig) {
    for seed in [1, 2] {
        let success = success(broken, seed, 60);
        assert!(success < 0.5, "seed {seed}: {success}");
    }
}

#[test]
fn without_hindsight_it_is_not_solved() {
    assert_not_solved(&StudentConfig { her_k: 0, ..quick() });
}

#[test]
fn with_frozen_targets_it_is_not_solved() {
    assert_not_solved(&StudentConfig { polyak: 1.0, ..quick() });
}

/// Exploring actions reach the goals that hindsight learns from, but the untrained policy itself reaches few.
#[test]
fn an_untrained_student_fails() {
    let success = success(&quick(), 1, 0);
    assert!(success < 0.3, "{success}");
}
