//! The density of the goals that a student has achieved.

use envs::Goals;

use crate::curriculum::Lesson;
use crate::density::KernelDensity;
use crate::scaling::Scaling;

/// Goals from the student's replay buffer, on a scale of their own, and how dense they lie.
pub(crate) struct Achieved {
    scaling: Scaling,
    density: KernelDensity,
}

impl Achieved {
    /// That of `n` achieved goals, drawn with replacement, with kernels of deviation `bandwidth` where the
    /// goals' own is 1. None if nothing is in the replay buffer.
    pub(crate) fn draw(n: usize, bandwidth: f64, lesson: &mut Lesson<'_>) -> Option<Self> {
        let goals = lesson.student.replay_achieved(n, lesson.rng);
        if goals.is_empty() {
            return None;
        }
        let scaling = Scaling::of(&goals);
        let density = KernelDensity::new(&scaling.rows(&goals), bandwidth);
        Some(Self { scaling, density })
    }

    /// ln p of `goal`, shape `[G]`, with p per unit of the scale.
    pub(crate) fn log_density(&mut self, goal: &[f64]) -> f64 {
        self.density.log_at(&self.scaling.row(goal))
    }

    /// ln p of every one of `goals`, shape `[n, G]`.
    pub(crate) fn log_densities(&mut self, goals: &Goals) -> Vec<f64> {
        goals.iter().map(|goal| self.log_density(goal)).collect()
    }

    /// The density of other `goals`, shape `[n, G]`, on the scale of these.
    pub(crate) fn beside(&self, goals: &Goals, bandwidth: f64) -> Self {
        let density = KernelDensity::new(&self.scaling.rows(goals), bandwidth);
        Self { scaling: self.scaling.clone(), density }
    }
}
