//! Recorded numbers over training, other than success rates: mean and standard deviation over seeds at every
//! evaluation.

use std::collections::BTreeMap;

use crate::analysis::complete;
use crate::analysis::curves::DDOF;
use crate::analysis::group::{Group, GroupKey};
use crate::analysis::groups::Groups;
use crate::schema::RunKey;
use crate::stats;
use crate::store::Run;

/// A number at one evaluation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NumberPoint {
    /// Mean training steps of the seeds that have it.
    pub step: f64,
    /// Seeds that have it.
    pub n: usize,
    /// Its mean over those seeds.
    pub mean: f64,
    /// Its standard deviation over those seeds ([`DDOF`]); `None` for one seed.
    pub std: Option<f64>,
}

/// A number of one group over training.
#[derive(Clone, Debug, PartialEq)]
pub struct NumberCurve {
    /// Which group.
    pub key: GroupKey,
    /// One point per evaluation at which any seed has the number, by rising evaluation; never empty.
    pub points: Vec<NumberPoint>,
}

/// The curves of one number in one environment.
#[derive(Clone, Debug, PartialEq)]
pub struct NumberPlot {
    /// Name of the number.
    pub name: String,
    /// One curve per group that has it, in the order of groups.
    pub curves: Vec<NumberCurve>,
}

/// The numbers of one environment.
#[derive(Clone, Debug, PartialEq)]
pub struct NumberPlots {
    /// Environment id.
    pub environment: String,
    /// One plot per number that any group has.
    pub plots: Vec<NumberPlot>,
}

/// What is known of a run at one evaluation: its index, its step, and numbers by name.
pub struct Numbered {
    /// Which evaluation.
    pub eval_index: u64,
    /// Training steps.
    pub step: u64,
    /// The numbers; `None` where one is not defined.
    pub numbers: Vec<(String, Option<f64>)>,
}

/// The numbers of teachers, as records have them, in every environment; plots by name.
pub fn of_teachers(groups: &Groups<'_>) -> Vec<NumberPlots> {
    plots(groups, |run| {
        let records = complete::recorded(run).iter();
        let numbered = records.map(|record| Numbered {
            eval_index: record.eval_index,
            step: record.step,
            numbers: record.teacher.iter().map(|(name, value)| (name.clone(), value.as_f64())).collect(),
        });
        numbered.collect()
    })
}

/// The numbers of `numbered` of the groups that stand for their method, in every environment. Numbers come in
/// the order in which the first group has them, then the others.
pub fn plots(groups: &Groups<'_>, numbered: impl Fn(&Run) -> Vec<Numbered>) -> Vec<NumberPlots> {
    let groups = groups.compared_groups();
    let mut all = Vec::new();
    for same in groups.chunk_by(|a, b| a.key.environment == b.key.environment) {
        let read: Vec<(&Group<'_>, BTreeMap<RunKey, Vec<Numbered>>)> = same
            .iter()
            .map(|group| {
                let runs = group.runs.iter().map(|run| (run.key().clone(), numbered(run)));
                (*group, runs.collect())
            })
            .collect();
        let mut names: Vec<&str> = Vec::new();
        let known = read.iter().flat_map(|(_, runs)| runs.values()).flatten().flat_map(|one| &one.numbers);
        for (name, _) in known {
            if !names.contains(&name.as_str()) {
                names.push(name);
            }
        }
        let plot = |name: &&str| NumberPlot {
            name: (*name).to_owned(),
            curves: read.iter().filter_map(|(group, runs)| curve(&group.key, runs.values(), name)).collect(),
        };
        let plots: Vec<NumberPlot> = names.iter().map(plot).filter(|plot| !plot.curves.is_empty()).collect();
        if !plots.is_empty() {
            all.push(NumberPlots { environment: same[0].key.environment.clone(), plots });
        }
    }
    all
}

/// Nothing larger is drawn: sums and axes of such numbers overflow.
const LARGEST: f64 = f32::MAX as f64;

/// The curve of the number `name`; `None` where no run has it.
fn curve<'a>(
    key: &GroupKey,
    runs: impl Iterator<Item = &'a Vec<Numbered>>,
    name: &str,
) -> Option<NumberCurve> {
    let mut found: BTreeMap<u64, (Vec<f64>, Vec<f64>)> = BTreeMap::new();
    for one in runs.flatten() {
        let defined = one.numbers.iter().filter(|(other, _)| other == name).filter_map(|(_, value)| *value);
        for value in defined {
            let (steps, values) = found.entry(one.eval_index).or_default();
            steps.push(one.step as f64);
            values.push(value);
        }
    }
    let point = |(steps, values): &(Vec<f64>, Vec<f64>)| {
        Some(NumberPoint {
            step: stats::mean(steps)?,
            n: values.len(),
            mean: stats::mean(values).filter(|mean| mean.abs() <= LARGEST)?,
            std: stats::std_dev(values, DDOF).filter(|std| *std <= LARGEST),
        })
    };
    let points: Vec<NumberPoint> = found.values().filter_map(point).collect();
    (!points.is_empty()).then(|| NumberCurve { key: key.clone(), points })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::catalogue::Catalogue;

    #[test]
    fn a_curve_by_hand() {
        let at = |eval_index, step, loss: Option<f64>| Numbered {
            eval_index,
            step,
            numbers: vec![("loss".to_owned(), loss)],
        };
        let runs = [
            vec![at(0, 0, None), at(1, 100, Some(3.0)), at(2, 200, Some(1.0))],
            vec![at(0, 0, None), at(1, 102, Some(5.0))],
        ];
        let key = GroupKey::new(&Catalogue::default(), "E", "nova", "default");
        let curve = |name| curve(&key, runs.iter(), name);
        // Mean of 3 and 5; their standard deviation is √((1 + 1)/1).
        let expected = [
            NumberPoint { step: 101.0, n: 2, mean: 4.0, std: Some(2f64.sqrt()) },
            NumberPoint { step: 200.0, n: 1, mean: 1.0, std: None },
        ];
        assert_eq!(curve("loss").map(|curve| curve.points), Some(expected.to_vec()));
        assert_eq!(curve("other"), None);
    }

    #[test]
    fn numbers_that_overflow_are_left_out() {
        let at = |eval_index, number| {
            vec![Numbered { eval_index, step: eval_index, numbers: vec![("x".to_owned(), Some(number))] }]
        };
        let key = GroupKey::new(&Catalogue::default(), "E", "nova", "default");
        let runs = [at(1, f64::MAX), at(1, f64::MAX), at(2, 3e38), at(2, -3e38), at(3, f64::MIN)];
        let points = curve(&key, runs.iter(), "x").expect("one point").points;
        assert_eq!(points, [NumberPoint { step: 2.0, n: 2, mean: 0.0, std: None }], "√2 · 3e38 is too large");
        assert_eq!(curve(&key, runs[..2].iter(), "x"), None);
    }
}
