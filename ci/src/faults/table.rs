//! The faults: each a change of a few characters that a reviewer can miss, and that a gate should not.

/// A fault to plant.
#[derive(Debug)]
pub(crate) struct Fault {
    /// What the command line calls it.
    pub(crate) name: &'static str,
    /// What is wrong with the faulty program.
    pub(crate) title: &'static str,
    /// The committed baseline that has what it touches.
    pub(crate) baseline: &'static str,
    /// The file, from the project folder.
    pub(crate) file: &'static str,
    /// The text that it replaces, which occurs there exactly once.
    pub(crate) original: &'static str,
    /// The text that replaces it.
    pub(crate) faulty: &'static str,
    /// Whether it shows in success rates or teachers at the budget of the committed baseline. A fault that
    /// does not show still changes bytes, which `--exact` sees.
    pub(crate) shows: bool,
}

/// The student and the paper's own curricula.
const GATE: &str = "gate.json";
/// The further curricula.
const METHODS: &str = "gate-methods.json";

/// All faults.
pub(crate) static FAULTS: &[Fault] = &[
    Fault {
        name: "her-off",
        title: "HER never relabels",
        baseline: GATE,
        file: "agents/src/draw.rs",
        original: "    k / (k + 1.0)\n",
        faulty: "    0.0 * k\n",
        shows: true,
    },
    Fault {
        name: "reward-sign",
        title: "the reward of relabelled transitions has the wrong sign",
        baseline: GATE,
        file: "agents/src/replay/mod.rs",
        original: "batch.rewards[row] = reward.reward(achieved, wanted) as f32;",
        faulty: "let reward = reward.reward(achieved, wanted) as f32;\n            \
                 batch.rewards[row] = if draw.relabel.is_some() { -reward } else { reward };",
        shows: true,
    },
    Fault {
        name: "target-frozen",
        title: "target networks are never updated",
        baseline: GATE,
        file: "agents/src/ddpg/update.rs",
        original: "        self.both().into_iter().try_for_each(|networks| networks.follow(polyak))\n",
        faulty: "        self.both().into_iter().try_for_each(|_| { let _ = polyak; Ok(()) })\n",
        shows: true,
    },
    Fault {
        name: "clip-removed",
        title: "the Bellman target is not clipped",
        baseline: GATE,
        file: "agents/src/losses.rs",
        original: "    (reward + gamma * next_value).clamp(lowest, 0.0)\n",
        faulty: "    let _ = lowest;\n    reward + gamma * next_value\n",
        shows: false,
    },
    Fault {
        name: "clip-wrong-end",
        title: "the Bellman target is clipped to [0, 1/(1 - gamma)]",
        baseline: GATE,
        file: "agents/src/losses.rs",
        original: "    (reward + gamma * next_value).clamp(lowest, 0.0)\n",
        faulty: "    (reward + gamma * next_value).clamp(0.0, -lowest)\n",
        shows: true,
    },
    Fault {
        name: "normaliser-frozen",
        title: "input normalisers never take up what they are fed",
        baseline: GATE,
        file: "agents/src/normalizer.rs",
        original: "        self.moments.count += (rows.len() / width) as u64;\n        self.refresh();\n",
        faulty: "        self.moments.count += (rows.len() / width) as u64;\n",
        shows: true,
    },
    Fault {
        name: "noise-zero",
        title: "no exploration noise",
        baseline: GATE,
        file: "agents/src/ddpg/mod.rs",
        original: "            Mode::Explore(rng) => self.noise.apply(action, self.replay.stored(), rng),\n",
        faulty: "            Mode::Explore(_) => {}\n",
        shows: true,
    },
    Fault {
        name: "no-pseudo-observation",
        title: "input normalisers start with nothing",
        baseline: GATE,
        file: "agents/src/normalizer.rs",
        original: "Moments::of_zeros(config.pseudo_observations, width)",
        faulty: "Moments::of_zeros(0, width)",
        shows: false,
    },
    Fault {
        name: "space-turns",
        title: "SPaCE counts turns over all episodes, modulo a set that grows",
        baseline: GATE,
        file: "curricula/src/methods/space.rs",
        original: "        let place = next_turn(state.turn, state.set.len());\n        state.turn = Some(place);\n",
        faulty: "        let count = state.turn.map_or(0, |turn| turn + 1);\n        state.turn = Some(count);\n        \
                 let place = count % state.set.len();\n",
        shows: true,
    },
    Fault {
        name: "teach-redrawn",
        title: "the states that confidence is compared over are drawn anew every time",
        baseline: GATE,
        file: "curricula/src/probe.rs",
        original: "                Some(held) => held.clone(),\n",
        faulty: "                Some(_) => lesson.student.replay_states(config.replay_states, lesson.rng),\n",
        shows: true,
    },
    Fault {
        name: "teach-inverted",
        title: "TEACH weighs goals by how little they change",
        baseline: GATE,
        file: "curricula/src/methods/teach.rs",
        original: "            Self::Variance => window.variance(),\n",
        faulty: "            Self::Variance => {\n                \
                 let variance = window.variance();\n                \
                 let most = variance.iter().copied().fold(0.0, f64::max);\n                \
                 variance.iter().map(|one| most - one).collect()\n            }\n",
        shows: true,
    },
    Fault {
        name: "sfl-easy",
        title: "SFL keeps the goals that are reached most often",
        baseline: METHODS,
        file: "curricula/src/methods/sfl.rs",
        original: "rates.iter().copied().map(learnability).collect();",
        faulty: "rates.iter().map(|p| p - learnability(*p)).collect();",
        shows: false,
    },
    Fault {
        name: "plr-rank",
        title: "PLR ranks goals from the smallest error up",
        baseline: METHODS,
        file: "curricula/src/methods/plr.rs",
        original: "order.sort_by(|&a, &b| scores[b].total_cmp(&scores[a]));",
        faulty: "order.sort_by(|&a, &b| scores[a].total_cmp(&scores[b]));",
        shows: false,
    },
    Fault {
        name: "goid-mastered",
        title: "GOID takes mastered goals for goals of intermediate difficulty",
        baseline: METHODS,
        file: "curricula/src/methods/goid.rs",
        original: "is_some_and(|rate| is_of_intermediate_difficulty(rate, lowest, highest))",
        faulty: "is_some_and(|rate| is_of_intermediate_difficulty(rate, lowest, highest.max(1.0)))",
        shows: false,
    },
    Fault {
        name: "lp-stagnant",
        title: "LP prefers regions of little progress",
        baseline: METHODS,
        file: "curricula/src/methods/lp.rs",
        original: "(1.0 - epsilon) * lp / total)",
        faulty: "(1.0 - epsilon) * (1.0 - lp / total) / (n - 1.0))",
        shows: true,
    },
    Fault {
        name: "mega-dense",
        title: "MEGA chooses the densest of the goals that pass",
        baseline: METHODS,
        file: "curricula/src/methods/mega.rs",
        original: "let least = densities.min_by(",
        faulty: "let least = densities.max_by(",
        shows: true,
    },
    Fault {
        name: "omega-keeps",
        title: "OMEGA keeps the environment's goal however far achieved goals are from it",
        baseline: METHODS,
        file: "curricula/src/methods/omega.rs",
        original: "    1.0 / (b + divergence).max(1.0)\n",
        faulty: "    1.0 / (b - divergence).max(1.0)\n",
        shows: false,
    },
    Fault {
        name: "actor-sign",
        title: "the actor descends the critic's value",
        baseline: GATE,
        file: "agents/src/losses.rs",
        original: "slope.fill(-1.0 / n as f32));\n",
        faulty: "slope.fill(1.0 / n as f32));\n",
        shows: true,
    },
];

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::FAULTS;

    #[test]
    fn every_fault_can_be_planted_in_one_place_alone() {
        let project = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
        for fault in FAULTS {
            let text = std::fs::read_to_string(project.join(fault.file)).unwrap();
            assert_eq!(text.matches(fault.original).count(), 1, "{} in {}", fault.name, fault.file);
            assert_ne!(fault.original, fault.faulty);
        }
    }

    #[test]
    fn every_fault_has_a_committed_baseline() {
        let baselines = Path::new(env!("CARGO_MANIFEST_DIR")).join("../harness/baselines");
        assert!(FAULTS.iter().all(|fault| baselines.join(fault.baseline).is_file()));
    }

    #[test]
    fn names_are_unique() {
        let mut names: Vec<&str> = FAULTS.iter().map(|fault| fault.name).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), FAULTS.len());
    }
}
