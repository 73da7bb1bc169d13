//! The resolved protocol and the versions of all runs, as tables.

use serde_json::Value;

use crate::analysis::catalogue::natural_order;
use crate::render::table::{Align, Table};
use crate::store::Run;
use crate::wording::counted;

/// Every setting of the runs' complete configs with the values it has, and in how many runs where there are
/// several.
pub fn settings(runs: &[Run]) -> Table {
    let mut counts = Counts::default();
    for run in runs {
        leaves("", &run.manifest.config, &mut |path, value| counts.add(path, value));
    }
    counts.table(["Setting", "Value"], "Complete settings of all runs, defaults included.", runs.len())
}

/// Every version that the runs name.
pub fn versions(runs: &[Run]) -> Table {
    let mut counts = Counts::default();
    for run in runs {
        for (name, version) in &run.manifest.versions {
            counts.add(name.clone(), version.clone());
        }
    }
    counts.table(["Component", "Version"], "Versions that the runs were made with.", runs.len())
}

/// Names with the runs that have each value, in order of first appearance.
#[derive(Default)]
struct Counts(Vec<(String, Vec<(String, usize)>)>);

impl Counts {
    fn add(&mut self, name: String, value: String) {
        let index = self.0.iter().position(|(other, _)| *other == name).unwrap_or_else(|| {
            self.0.push((name, Vec::new()));
            self.0.len() - 1
        });
        let values = &mut self.0[index].1;
        match values.iter_mut().find(|(other, _)| *other == value) {
            Some((_, count)) => *count += 1,
            None => values.push((value, 1)),
        }
    }

    fn table(self, header: [&'static str; 2], caption: &str, runs: usize) -> Table {
        let row = |(name, mut values): (String, Vec<(String, usize)>)| {
            values.sort_by(|(a, _), (b, _)| natural_order(a, b));
            let text = |(value, count): &(String, usize)| {
                if *count == runs {
                    value.clone()
                } else {
                    format!("{value} ({count} of {})", counted(runs, "run"))
                }
            };
            vec![name, values.iter().map(text).collect::<Vec<_>>().join(", ")]
        };
        Table {
            caption: caption.to_owned(),
            columns: header.map(|title| (title, Align::Text)).to_vec(),
            rows: self.0.into_iter().map(row).collect(),
        }
    }
}

/// Calls `visit` with the dotted path and the text of every value below `value` that is no object.
fn leaves(path: &str, value: &Value, visit: &mut impl FnMut(String, String)) {
    match value {
        Value::Object(fields) => {
            for (name, field) in fields {
                let path = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
                leaves(&path, field, visit);
            }
        }
        Value::String(text) => visit(path.to_owned(), text.clone()),
        other => visit(path.to_owned(), other.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_counted_by_hand() {
        let mut counts = Counts::default();
        for steps in [10, 9, 10] {
            let config = serde_json::json!({"budget": {"steps": steps}, "device": "cpu"});
            leaves("", &config, &mut |path, value| counts.add(path, value));
        }
        let rows = counts.table(["Setting", "Value"], "", 3).rows;
        assert_eq!(rows, [["budget.steps", "9 (1 of 3 runs), 10 (2 of 3 runs)"], ["device", "cpu"]]);
    }
}
