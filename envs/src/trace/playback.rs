//! Repeating a recording on this crate's environments.

use std::path::Path;

use super::compare::{Differences, Field, check_length};
use super::format::{Recording, Reset, Trace};
use super::{FileReport, Place, Problem};
use crate::draws::RecordedDraws;
use crate::env::GoalEnv;
use crate::mujoco::Physics;
use crate::playback::{Playback, PlaybackError, Start};
use crate::registry::{self, EnvOptions, Verification};

/// Plays back everything in `recording`.
pub(super) fn play_back(file: &Path, recording: &Recording) -> Result<FileReport, Box<Problem>> {
    let Recording { meta, resets, traces } = recording;
    if resets.is_empty() && traces.is_empty() {
        return Err(Problem::Empty.into());
    }
    let physics = meta.physics();
    let native_ccd = physics == Some(Physics::NativeCcd);
    let row = registry::find(meta.environment()).map_err(Problem::Environment)?;
    let env = row.make(&EnvOptions { native_ccd }).map_err(Problem::Environment)?;
    let tolerance = row.verification.tolerance(physics);
    let mut verifier = Verifier { env, tolerance, differences: Differences::default() };
    let ours = verifier.playback()?.constants();
    let not_compared = verifier.differences.constants(&meta.constants, &ours)?;
    for (index, reset) in resets.iter().enumerate() {
        verifier.reset(&Place::Reset(index), reset)?;
    }
    for (index, trace) in traces.iter().enumerate() {
        verifier.trace(index, trace)?;
    }
    let Verifier { env, differences, .. } = verifier;
    Ok(FileReport {
        file: file.to_owned(),
        environment: env.spec().id,
        physics,
        tolerance,
        traces: traces.len(),
        steps: traces.iter().map(|trace| trace.actions.len()).sum(),
        resets: resets.len(),
        deviations: differences.deviations,
        reward_mismatches: differences.reward_mismatches,
        success_mismatches: differences.success_mismatches,
        first_failure: differences.first_failure,
        not_compared,
    })
}

struct Verifier {
    env: Box<dyn GoalEnv>,
    tolerance: f64,
    differences: Differences,
}

/// What a recording shows of one moment: observation, achieved goal, qpos and qvel.
struct Shown<'r> {
    observation: &'r [f64],
    achieved: &'r [f64],
    qpos: &'r [f64],
    qvel: &'r [f64],
}

impl Verifier {
    fn playback(&mut self) -> Result<&mut dyn Playback, Box<Problem>> {
        let id = self.env.spec().id;
        Ok(self.env.playback().ok_or(Problem::NotRecorded { id })?)
    }

    fn reset(&mut self, place: &Place, reset: &Reset) -> Result<(), Box<Problem>> {
        let mut draws = RecordedDraws::new(&reset.draws);
        let outcome = self.playback()?.reset_recorded(&mut draws);
        outcome.map_err(|error| refused(place, error))?;
        self.differences.numbers(place, Field::Goal, &reset.goal, self.env.goal(), self.tolerance)?;
        let shown = Shown {
            observation: &reset.observation,
            achieved: &reset.achieved_goal,
            qpos: reset.qpos.as_deref().unwrap_or_default(),
            qvel: reset.qvel.as_deref().unwrap_or_default(),
        };
        self.compare(place, &shown, self.tolerance)
    }

    fn trace(&mut self, index: usize, trace: &Trace) -> Result<(), Box<Problem>> {
        let place = |step| Place::Trace { trace: index, seed: trace.seed.clone(), step };
        self.check_lengths(&place(0), trace)?;
        let begun = self.playback()?.begin(&trace.start);
        begun.map_err(|error| refused(&place(0), error))?;
        self.env.set_goal(&trace.goal).map_err(|error| refused(&place(0), error.into()))?;
        self.compare(&place(0), &trace.shown_at_start(), Verification::ROUNDING)?;
        for (step, action) in trace.actions.iter().enumerate() {
            let place = place(step + 1);
            check_length(&place, "actions", action.len(), self.env.spec().action)?;
            self.env.step(action).map_err(|error| refused(&place, error.into()))?;
            self.compare(&place, &trace.shown_after(step), self.tolerance)?;
            let (achieved, goal) = (&self.env.observation().achieved, self.env.goal());
            let ours = (self.env.reward(achieved, goal), self.env.success(achieved, goal));
            self.differences.outcome(&place, (trace.reward[step], trace.is_success[step]), ours);
        }
        Ok(())
    }

    /// The goal has the environment's length, and every list one entry per action.
    fn check_lengths(&self, place: &Place, trace: &Trace) -> Result<(), Box<Problem>> {
        let steps = trace.actions.len();
        let lists = [
            ("observation", Some(trace.observation.len())),
            ("achieved_goal", Some(trace.achieved_goal.len())),
            ("reward", Some(trace.reward.len())),
            ("is_success", Some(trace.is_success.len())),
            ("qpos", trace.qpos.as_ref().map(Vec::len)),
            ("qvel", trace.qvel.as_ref().map(Vec::len)),
        ];
        for (name, length) in lists {
            check_length(place, name, length.unwrap_or(steps), steps)?;
        }
        check_length(place, "goal", trace.goal.len(), self.env.spec().goal)
    }

    fn compare(&mut self, place: &Place, shown: &Shown<'_>, tolerance: f64) -> Result<(), Box<Problem>> {
        let state = self.playback()?.capture();
        let (qpos, qvel) = positions_and_velocities(&state);
        let (differences, ours) = (&mut self.differences, self.env.observation());
        for (field, recorded, ours) in [
            (Field::Observation, shown.observation, ours.state.as_slice()),
            (Field::AchievedGoal, shown.achieved, &ours.achieved),
            (Field::Qpos, shown.qpos, qpos),
            (Field::Qvel, shown.qvel, qvel),
        ] {
            differences.numbers(place, field, recorded, ours, tolerance)?;
        }
        Ok(())
    }
}

/// `qpos` and `qvel` of a simulation. A maze has neither, so its recording must hold none.
fn positions_and_velocities(state: &Start) -> (&[f64], &[f64]) {
    match state {
        Start::Simulation(state) => (&state.qpos, &state.qvel),
        Start::Position(_) => (&[], &[]),
    }
}

fn refused(place: &Place, source: PlaybackError) -> Box<Problem> {
    Problem::Playback { place: place.clone(), source }.into()
}

impl Trace {
    fn shown_at_start(&self) -> Shown<'_> {
        let (qpos, qvel) = positions_and_velocities(&self.start);
        Shown { observation: &self.obs0, achieved: &self.ag0, qpos, qvel }
    }

    fn shown_after(&self, step: usize) -> Shown<'_> {
        Shown {
            observation: &self.observation[step],
            achieved: &self.achieved_goal[step],
            qpos: self.qpos.as_ref().map_or(&[], |steps| steps[step].as_slice()),
            qvel: self.qvel.as_ref().map_or(&[], |steps| steps[step].as_slice()),
        }
    }
}
