//! What teachers did. Read apart from everything else, and for one run at a time: it is large, and only heat maps
//! need it. So a report reads, and checks, these files in mazes alone.

use std::collections::BTreeMap;
use std::path::Path;

use super::{Run, scan};
use crate::schema::Teaching;
use crate::store::layout;
use crate::store::problem::{Fault, Problem};

/// What the teacher of a run did, by rising evaluation, and what is wrong with the file. Results of old versions have
/// no such file: nothing, and no problem.
pub fn teaching(results: &Path, run: &Run) -> (Vec<Teaching>, Vec<Problem>) {
    let path = layout::run_dir(results, run.key()).join(layout::TEACHING);
    let mut problems = Vec::new();
    let lines: Vec<(usize, Teaching)> = scan::load_lines(results, &path, "teaching", &mut problems);
    let relative = scan::relative(results, &path);
    let mut by_index: BTreeMap<u64, (usize, Teaching)> = BTreeMap::new();
    for (line, teaching) in lines {
        let eval_index = teaching.eval_index;
        let fault = match by_index.get(&eval_index) {
            Some((first, _)) => Some(Fault::Duplicate { eval_index, first: *first }),
            None => misfit(&teaching),
        };
        match fault {
            Some(fault) => problems.push(Problem { path: relative.to_owned(), line: Some(line), fault }),
            None => {
                by_index.insert(eval_index, (line, teaching));
            }
        }
    }
    (by_index.into_values().map(|(_, teaching)| teaching).collect(), problems)
}

/// The first thing about a line that rules it out.
fn misfit(teaching: &Teaching) -> Option<Fault> {
    let range = |field: &str, value: String, accepted| {
        Some(Fault::Range { field: field.to_owned(), value, accepted })
    };
    let Teaching { goals, successes, weights, picks, scores, ranks, .. } = teaching;
    let lengths = [
        ("successes", Some(successes.len())),
        ("picks", picks.as_ref().map(Vec::len)),
        ("scores", scores.as_ref().map(Vec::len)),
        ("ranks", ranks.as_ref().map(Vec::len)),
    ];
    let mut given = lengths.into_iter().filter_map(|(field, length)| Some((field, length?)));
    if let Some((field, length)) = given.find(|(_, length)| *length != goals.len()) {
        return range(field, format!("{length} long"), "as many entries as goals");
    }
    if let Some(goal) =
        goals.iter().find(|goal| goal.len() != goals[0].len() || goal.iter().any(|x| !x.is_finite()))
    {
        return range("goals", format!("{goal:?}"), "goals of finite numbers, all of one length");
    }
    let weights = weights.as_deref()?;
    if let Some(weight) = weights.iter().find(|weight| !(0.0..=1.0).contains(*weight)) {
        return range("weights", weight.to_string(), "numbers in [0, 1]");
    }
    let beyond = |pick: &&u32| **pick as usize >= weights.len();
    let pick = picks.iter().flatten().flatten().find(beyond)?;
    range("picks", pick.to_string(), "indices below the number of weights")
}
