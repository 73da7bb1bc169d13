//! The teachers of a group's runs, the one that acted and those that watched, and what each of them told at a
//! measure of the student.

use std::sync::Arc;

use crate::analysis::catalogue::{Catalogue, MethodInfo};
use crate::analysis::group::{Group, GroupKey};
use crate::analysis::shadow::{ShadowFiles, WatchedRun};
use crate::analysis::whole::Analysis;
use crate::schema::{Beliefs, Frontier};

/// A teacher that saw the students of a group of runs.
#[derive(Clone, Debug, PartialEq)]
pub struct GroupTeacher {
    /// Which group.
    pub key: GroupKey,
    /// The one that acted in these runs, or one that watched.
    pub method: Arc<MethodInfo>,
}

impl GroupTeacher {
    /// Those of a group, in their places: the one that acted first.
    pub fn all(group: &Group<'_>, analysis: &Analysis<'_>) -> Vec<Self> {
        let methods = teachers(group, &analysis.shadow, analysis.catalogue()).into_iter();
        methods.map(|method| Self { key: group.key.clone(), method }).collect()
    }

    /// Whether it watched while another one acted.
    pub fn is_shadow(&self) -> bool {
        self.method.id != self.key.curriculum.id
    }
}

/// The teachers of a group's runs in their places: the one that acted first, then those that watched.
pub fn teachers(group: &Group<'_>, files: &ShadowFiles, catalogue: &Catalogue) -> Vec<Arc<MethodInfo>> {
    let watched = group.runs.iter().find_map(|run| Some((run, files.of_run(run)?)));
    let shadows = watched.into_iter().flat_map(|(run, watched)| {
        watched.teachers[1..].iter().map(|id| catalogue.method_in(&run.manifest, id))
    });
    [Arc::clone(&group.key.curriculum)].into_iter().chain(shadows).collect()
}

/// What a teacher told at a measure of its student.
#[derive(Clone, Copy, Debug, Default)]
pub struct Testimony<'a> {
    /// Its probability of every goal of the pool, `[N]`.
    pub weights: Option<&'a [f32]>,
    /// Goals of the pool that it proposed since the evaluation before, and how often; none where no shadow
    /// watched.
    pub picks: &'a [(u32, u32)],
    /// What it believed of every goal of the pool.
    pub beliefs: Option<&'a Beliefs>,
}

impl<'a> Testimony<'a> {
    /// What the teacher in this place told at `measure` of a run, which others may have `watched`.
    pub fn at(measure: &'a Frontier, watched: Option<&'a WatchedRun>, place: usize) -> Self {
        let wanted = watched.and_then(|watched| watched.measured.get(&measure.eval_index)?.get(place));
        let picks = wanted.map_or(&[][..], |wanted| &wanted.picks);
        if place == 0 {
            return Self { weights: measure.weights.as_deref(), picks, beliefs: measure.beliefs.as_ref() };
        }
        let weights = wanted.and_then(|wanted| wanted.weights.as_deref());
        Self { weights, picks, beliefs: wanted.and_then(|wanted| wanted.beliefs.as_ref()) }
    }

    /// Its estimate of success at every goal of the pool, `[N]`.
    pub fn estimates(&self) -> Option<&'a [Option<f32>]> {
        self.beliefs?.success.as_deref()
    }

    /// Its score of every goal of the pool, `[N]`.
    pub fn scores(&self) -> Option<&'a [Option<f32>]> {
        self.beliefs?.scores.as_deref()
    }
}

/// The `values`, `[N]`, that there are, and what `others`, `[N]`, hold at their places.
pub fn known<T: Copy>(values: &[Option<f64>], others: &[T]) -> (Vec<f64>, Vec<T>) {
    values.iter().zip(others).filter_map(|(value, other)| Some(((*value)?, *other))).unzip()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::shadow::Wanted;

    #[test]
    fn the_measure_tells_of_the_teacher_that_acted_and_the_record_of_shadows_of_all_proposals() {
        let scored = |score| Some(Beliefs { success: None, scores: Some(vec![score]) });
        let measure = Frontier {
            eval_index: 2,
            weights: Some(vec![1.0]),
            beliefs: scored(Some(0.5)),
            ..Frontier::default()
        };
        let own = Wanted { picks: vec![(0, 3)], ..Wanted::default() };
        let shadow = Wanted { picks: vec![(0, 1)], beliefs: scored(None), ..Wanted::default() };
        let watched = WatchedRun { measured: [(2, vec![own, shadow])].into(), ..WatchedRun::default() };
        let told = |place| {
            let told = Testimony::at(&measure, Some(&watched), place);
            (told.weights, told.picks, told.scores())
        };
        assert_eq!(told(0), (Some(&[1.0][..]), &[(0, 3)][..], Some(&[Some(0.5)][..])));
        assert_eq!(told(1), (None, &[(0, 1)][..], Some(&[None][..])));
        let alone = Testimony::at(&measure, None, 0);
        assert_eq!((alone.weights, alone.picks, alone.estimates()), (Some(&[1.0][..]), &[][..], None));
    }

    #[test]
    fn what_is_not_known_is_left_out() {
        assert_eq!(known(&[Some(0.5), None, Some(0.0)], &['a', 'b', 'c']), (vec![0.5, 0.0], vec!['a', 'c']));
    }
}
