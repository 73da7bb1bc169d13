//! Cells: the runs of one environment, curriculum and variant. A cell has one config, and its runs differ in
//! their seeds alone. Otherwise their mean would be one of nothing in particular.

use std::collections::BTreeMap;

use serde_json::Value;

use crate::schema::RunKey;

/// A run as its cell sees it.
#[derive(Clone, Copy, Debug)]
pub struct CellMember<'a> {
    /// Which run.
    pub run: &'a RunKey,
    /// Its complete config, as in its manifest.
    pub config: &'a Value,
    /// Whether it has recorded anything. Runs that have not do not decide which config the cell has.
    pub has_begun: bool,
}

/// A run that is not configured as its cell is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OddOne {
    /// The run.
    pub run: RunKey,
    /// The first run of its cell that has the cell's config.
    pub other: RunKey,
    /// JSON pointer (RFC 6901) to the first difference between the two.
    pub pointer: String,
}

/// Which cell a run belongs to: environment, curriculum and variant.
fn cell(run: &RunKey) -> [&str; 3] {
    [&run.environment, &run.curriculum, &run.variant]
}

/// Every one of `runs` that is not configured as its cell is, by key. A cell has the config of most of its
/// runs that have begun; where two configs have equally many, that of the lowest seed.
///
/// ```
/// use reports::schema::RunKey;
/// use reports::store::cells::{CellMember, odd_ones};
/// use serde_json::json;
///
/// let names = ["MazeA", "teach", "default"].map(String::from);
/// let run = |seed| {
///     let [environment, curriculum, variant] = names.clone();
///     RunKey { environment, curriculum, variant, seed }
/// };
/// let (keys, configs) = ([0, 1, 2].map(run), [8, 32, 32].map(|width| json!({ "width": width })));
/// let runs = keys.iter().zip(&configs).map(|(run, config)| CellMember { run, config, has_begun: true });
/// let odd = odd_ones(runs);
/// assert_eq!((odd.len(), &odd[0].run, &odd[0].other), (1, &keys[0], &keys[1]));
/// assert_eq!(odd[0].pointer, "/width");
/// ```
pub fn odd_ones<'a>(runs: impl IntoIterator<Item = CellMember<'a>>) -> Vec<OddOne> {
    let mut cells: BTreeMap<[&str; 3], Vec<CellMember<'_>>> = BTreeMap::new();
    for member in runs {
        cells.entry(cell(member.run)).or_default().push(member);
    }
    let mut odd = Vec::new();
    for mut members in cells.into_values() {
        members.sort_by_key(|member| member.run);
        let alike =
            |config: &Value| members.iter().filter(|other| other.has_begun && other.config == config).count();
        // Of several largest, `max_by_key` takes the last: from the end, that is the lowest seed.
        let Some(rule) = members.iter().rev().max_by_key(|member| alike(member.config)) else { continue };
        for member in &members {
            if let Some(pointer) = first_difference(rule.config, member.config) {
                odd.push(OddOne { run: member.run.clone(), other: rule.run.clone(), pointer });
            }
        }
    }
    odd
}

/// JSON pointer (RFC 6901) to the first place where `a` and `b` differ; fields of objects in the order of
/// `a`.
pub(crate) fn first_difference(a: &Value, b: &Value) -> Option<String> {
    let escaped = |name: &str| name.replace('~', "~0").replace('/', "~1");
    match (a, b) {
        (Value::Object(a), Value::Object(b)) => {
            for (name, left) in a {
                let below = match b.get(name) {
                    Some(right) => first_difference(left, right),
                    None => Some(String::new()),
                };
                if let Some(below) = below {
                    return Some(format!("/{}{below}", escaped(name)));
                }
            }
            b.keys().find(|name| !a.contains_key(*name)).map(|name| format!("/{}", escaped(name)))
        }
        (a, b) => (a != b).then(String::new),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn run(variant: &str, seed: u64) -> RunKey {
        let [environment, curriculum] = ["MazeA", "teach"].map(String::from);
        RunKey { environment, curriculum, variant: variant.to_owned(), seed }
    }

    /// The seeds of the odd ones among runs of one cell, given as seed, width and whether they have begun.
    fn odd_seeds(runs: &[(u64, u64, bool)]) -> Vec<u64> {
        let keys: Vec<RunKey> = runs.iter().map(|&(seed, ..)| run("default", seed)).collect();
        let configs: Vec<Value> = runs.iter().map(|&(_, width, _)| json!({ "width": width })).collect();
        let members = keys.iter().zip(&configs).zip(runs);
        let members = members.map(|((run, config), &(.., has_begun))| CellMember { run, config, has_begun });
        odd_ones(members).iter().map(|odd| odd.run.seed).collect()
    }

    #[test]
    fn most_runs_decide_then_the_lowest_seed() {
        assert_eq!(odd_seeds(&[(0, 8, true), (1, 8, true)]), [0; 0]);
        assert_eq!(odd_seeds(&[(0, 8, true), (1, 32, true), (2, 32, true)]), [0]);
        assert_eq!(odd_seeds(&[(3, 8, true), (2, 8, true), (1, 32, true), (0, 32, true)]), [2, 3]);
        assert_eq!(odd_seeds(&[(0, 8, false), (1, 8, false), (2, 32, true)]), [0, 1]);
    }

    #[test]
    fn variants_are_cells_of_their_own() {
        let (a, b, config) = (run("a", 0), run("b", 0), [json!({ "k": 0 }), json!({ "k": 4 })]);
        let member = |run, config| CellMember { run, config, has_begun: true };
        assert_eq!(odd_ones([member(&a, &config[0]), member(&b, &config[1])]), []);
    }

    #[test]
    fn differences_are_pointed_at() {
        let pointer = |a: Value, b: Value| first_difference(&a, &b);
        assert_eq!(
            pointer(json!({ "a": { "b/c": 1 } }), json!({ "a": { "b/c": 2 } })).as_deref(),
            Some("/a/b~1c")
        );
        assert_eq!(pointer(json!({ "a": 1 }), json!({ "a": 1, "d": 2 })).as_deref(), Some("/d"));
        assert_eq!(pointer(json!({ "a": 1 }), json!({})).as_deref(), Some("/a"));
        assert_eq!(pointer(json!([1]), json!([1])), None);
    }
}
