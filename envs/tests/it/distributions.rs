//! The environments' own draws: bounds, means, shares.
//!
//! Streams are fixed, so nothing here fails by chance; tolerances are four to five standard errors.

use std::f64::consts::PI;

use envs::rng::{Purpose, Rng, stream};
use envs::{EnvOptions, GoalEnv, Goals, draw_pool, make};

const DRAWS: usize = 4000;

fn build(id: &str) -> Box<dyn GoalEnv> {
    make(id, &EnvOptions::default()).unwrap()
}

fn rng() -> Rng {
    stream(0, Purpose::Pool)
}

fn pool(id: &str) -> Goals {
    draw_pool(build(id).as_mut(), DRAWS, &mut rng()).unwrap()
}

fn column(rows: &Goals, index: usize) -> Vec<f64> {
    rows.iter().map(|row| row[index]).collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Whether `values` look uniform on `low`..`high`: inside, near both ends, mean and variance right.
#[track_caller]
fn assert_uniform(values: &[f64], low: f64, high: f64) {
    let (n, width) = (values.len() as f64, high - low);
    let smallest = values.iter().copied().fold(f64::INFINITY, f64::min);
    let largest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    assert!(smallest >= low && largest <= high, "{smallest}..{largest} is not in {low}..{high}");
    assert!(smallest - low < 10.0 * width / n && high - largest < 10.0 * width / n, "{smallest}..{largest}");
    let centre = mean(values);
    assert!((centre - (low + high) / 2.0).abs() < 4.0 * width / (12.0 * n).sqrt(), "mean {centre}");
    let variance = mean(&values.iter().map(|v| (v - centre).powi(2)).collect::<Vec<_>>());
    // The variance of (v − mean)² is width⁴/180.
    let error = 4.0 * width.powi(2) / (180.0 * n).sqrt();
    assert!((variance - width.powi(2) / 12.0).abs() < error, "variance {variance}");
}

/// Whether a share is `expected`, within four standard errors.
#[track_caller]
fn assert_share(hits: usize, of: usize, expected: f64) {
    let share = hits as f64 / of as f64;
    let error = 4.0 * (expected * (1.0 - expected) / of as f64).sqrt();
    assert!((share - expected).abs() < error, "share {share}, expected {expected}");
}

#[test]
fn reach_goals_surround_the_gripper() {
    let goals = pool("FetchReach");
    let grip = [1.341_835, 0.749_101, 0.534_724];
    for (axis, centre) in grip.into_iter().enumerate() {
        assert_uniform(&column(&goals, axis), centre - 0.15 - 1e-6, centre + 0.15 + 1e-6);
    }
}

#[test]
fn push_and_slide_goals_lie_on_the_table() {
    for (id, [x, y, z], range) in [
        ("FetchPush", [1.345_54, 0.749_02, 0.424_70], 0.15),
        ("FetchSlide", [0.992_73 + 0.4, 0.749_04, 0.414_02], 0.3),
    ] {
        let goals = pool(id);
        assert_uniform(&column(&goals, 0), x - range - 1e-5, x + range + 1e-5);
        assert_uniform(&column(&goals, 1), y - range - 1e-5, y + range + 1e-5);
        let heights = column(&goals, 2);
        assert!(heights.iter().all(|height| *height == heights[0] && (height - z).abs() < 1e-5), "{id}");
    }
}

#[test]
fn half_of_the_pick_and_place_goals_are_in_the_air() {
    let heights = column(&pool("FetchPickAndPlace"), 2);
    let table = heights.iter().copied().fold(f64::INFINITY, f64::min);
    assert!((table - 0.424_70).abs() < 1e-5);
    let air: Vec<f64> = heights.into_iter().filter(|height| *height > table).collect();
    assert_share(air.len(), DRAWS, 0.5);
    assert_uniform(&air, table, table + 0.45);
}

#[test]
fn objects_start_around_the_gripper_but_clear_of_it() {
    for (id, range) in [("FetchPush", 0.15), ("FetchSlide", 0.1), ("FetchPickAndPlace", 0.15)] {
        let (mut env, mut rng) = (build(id), rng());
        let mut right = 0;
        for _ in 0..DRAWS {
            env.reset(&mut rng).unwrap();
            // Observation 6 and 7: object − gripper, both where they came to after the set-up.
            let [x, y] = [env.observation().state[6], env.observation().state[7]];
            assert!(x.abs() < range + 1e-4 && y.abs() < range + 1e-4, "{id}: {x} {y}");
            assert!(x.hypot(y) > 0.1 - 1e-4, "{id}: {x} {y}");
            right += usize::from(x > 0.0);
        }
        assert_share(right, DRAWS, 0.5);
    }
}

#[test]
fn a_tenth_of_the_hand_reach_goals_are_the_initial_tips() {
    let mut env = build("HandReach");
    env.reset(&mut rng()).unwrap();
    let start = env.observation().achieved.clone();
    let goals = pool("HandReach");
    let at_rest = goals.iter().filter(|goal| *goal == start).count();
    assert_share(at_rest, DRAWS, 0.1);
    let moved = |goal: &[f64], tip: usize| goal[3 * tip..3 * tip + 3] != start[3 * tip..3 * tip + 3];
    for finger in 0..4 {
        assert_share(goals.iter().filter(|goal| moved(goal, finger)).count(), DRAWS, 0.9 / 4.0);
    }
    for goal in goals.iter().filter(|goal| *goal != start) {
        let finger = (0..4).find(|&finger| moved(goal, finger)).unwrap();
        let gap: f64 = (0..3).map(|axis| (goal[3 * finger + axis] - goal[12 + axis]).powi(2)).sum();
        assert!(moved(goal, 4) && gap.sqrt() <= 0.01, "both stop 5 mm before one point: {}", gap.sqrt());
    }
}

/// Goals for one start, and where the object lay then.
fn goals_of_one_start(id: &str) -> (Goals, Vec<f64>) {
    let (mut env, mut rng) = (build(id), rng());
    env.reset(&mut rng).unwrap();
    let (mut goals, mut goal) = (Goals::new(7), vec![0.0; 7]);
    for _ in 0..DRAWS {
        env.sample_goal(&mut rng, &mut goal);
        goals.push(&goal);
    }
    (goals, env.observation().achieved[..3].to_vec())
}

#[test]
fn manipulation_goals_ask_for_a_position_only_where_the_task_does() {
    for id in ["HandManipulateBlock", "HandManipulatePen", "HandManipulateEgg"] {
        let (goals, settled) = goals_of_one_start(id);
        for (axis, (low, high)) in [(-0.04, 0.04), (-0.06, 0.02), (0.0, 0.06)].into_iter().enumerate() {
            assert_uniform(&column(&goals, axis), settled[axis] + low - 1e-12, settled[axis] + high + 1e-12);
        }
    }
    for id in ["HandManipulateBlockRotateZ", "HandManipulatePenRotate", "HandManipulateEggRotate"] {
        let (goals, settled) = goals_of_one_start(id);
        assert!(goals.iter().all(|goal| goal[..3] == settled), "{id}");
    }
}

#[test]
fn rotation_goals_are_drawn_as_the_task_says() {
    let (about_z, _) = goals_of_one_start("HandManipulateBlockRotateZ");
    let angles: Vec<f64> = about_z.iter().map(|goal| 2.0 * goal[6].atan2(goal[3])).collect();
    assert!(about_z.iter().all(|goal| goal[4] == 0.0 && goal[5] == 0.0));
    assert_uniform(&angles, -PI, PI);

    let (parallel, _) = goals_of_one_start("HandManipulateBlockRotateParallel");
    // The block's own z axis, seen in the world, is ± vertical for 8 of 24 rotations and horizontal for 16.
    let upright = |goal: &[f64]| 1.0 - 2.0 * (goal[4].powi(2) + goal[5].powi(2));
    let vertical = parallel.iter().filter(|goal| upright(goal).abs() > 0.99).count();
    let horizontal = parallel.iter().filter(|goal| upright(goal).abs() < 0.01).count();
    assert_eq!(vertical + horizontal, DRAWS);
    assert_share(vertical, DRAWS, 8.0 / 24.0);

    let (any, _) = goals_of_one_start("HandManipulateEggRotate");
    let angles: Vec<f64> = any.iter().map(|goal| 2.0 * goal[3].acos()).collect();
    assert_uniform(&angles, 0.0, PI);
    for part in 4..7 {
        let parts = column(&any, part);
        assert!(mean(&parts).abs() < 0.03, "the axis prefers no side: {}", mean(&parts));
    }
}

#[test]
fn manipulation_starts_scatter_by_half_a_centimetre() {
    let (mut env, mut rng) = (build("HandManipulateEgg"), rng());
    let starts: Vec<f64> = (0..150)
        .map(|_| {
            env.reset(&mut rng).unwrap();
            assert!(env.observation().achieved[2] > 0.04, "on the palm");
            env.observation().achieved[0]
        })
        .collect();
    let centre = mean(&starts);
    let deviation = mean(&starts.iter().map(|x| (x - centre).powi(2)).collect::<Vec<_>>()).sqrt();
    assert!((0.003..0.02).contains(&deviation), "{deviation}");
}
