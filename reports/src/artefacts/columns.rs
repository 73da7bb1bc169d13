//! Columns and captions that several tables share.

use std::borrow::Cow;

use crate::analysis::group::GroupKey;
use crate::analysis::ledger::{Effect, LedgerEntry};
use crate::analysis::parts::{ByThirdMeans, MeanStd};
use crate::analysis::summary::GroupSummary;
use crate::analysis::teachers::GroupTeacher;
use crate::render::table::Column;
use crate::render::table::cells::with_spread;
use crate::schema::RunKey;

pub(super) const ENVIRONMENT: (&str, &str) = ("environment", "environment id");
pub(super) const CURRICULUM: (&str, &str) = ("curriculum", "curriculum id");
pub(super) const VARIANT: (&str, &str) =
    ("variant", "label of the protocol's variant, `default` where it has none");
pub(super) const SEED: (&str, &str) =
    ("seed", "run seed; runs of one environment and seed share initial weights and evaluation goals");

/// The environment's id.
pub(super) fn environment<'c, R: 'c>(key: fn(&R) -> &GroupKey) -> Column<'c, R> {
    let id = move |row: &R| key(row).environment.clone();
    Column::text(ENVIRONMENT.0, ENVIRONMENT.1, id).named("Environment", id)
}

/// The curriculum's id; to read, its name.
pub(super) fn curriculum<'c, R: 'c>(key: fn(&R) -> &GroupKey) -> Column<'c, R> {
    Column::text(CURRICULUM.0, CURRICULUM.1, move |row| key(row).curriculum.id.clone())
        .named("Curriculum", move |row| key(row).curriculum.title.clone())
}

/// The variant's label.
pub(super) fn variant<'c, R: 'c>(key: fn(&R) -> &GroupKey) -> Column<'c, R> {
    let label = move |row: &R| key(row).variant.clone();
    Column::text(VARIANT.0, VARIANT.1, label).named("Variant", label)
}

/// Which run: environment, curriculum, variant and seed.
pub(super) fn run<'c, R: 'c>(key: fn(&R) -> &RunKey) -> [Column<'c, R>; 4] {
    [
        Column::text(ENVIRONMENT.0, ENVIRONMENT.1, move |row| key(row).environment.clone()),
        Column::text(CURRICULUM.0, CURRICULUM.1, move |row| key(row).curriculum.clone()),
        Column::text(VARIANT.0, VARIANT.1, move |row| key(row).variant.clone()),
        Column::count(SEED.0, SEED.1, move |row| key(row).seed),
    ]
}

/// Which group of runs, and which of the teachers that saw their students: its id; to read, if it `is_shown`,
/// its name and whether it watched.
pub(super) fn of_teacher<'c, R: 'c>(
    meaning: &str,
    is_shown: bool,
    key: fn(&R) -> &GroupKey,
    of: fn(&R) -> &GroupTeacher,
) -> Vec<Column<'c, R>> {
    let meaning = format!("{meaning}: `curriculum`, which acted, or a shadow");
    let id = Column::text("teacher", meaning, move |row: &R| of(row).method.id.clone());
    let name = move |row: &R| {
        let title = &of(row).method.title;
        if of(row).is_shadow() { format!("{title} (watched)") } else { title.clone() }
    };
    vec![
        environment(key),
        curriculum(key),
        variant(key),
        if is_shown { id.named("Teacher", name) } else { id },
    ]
}

/// `column`, shown below `title` unless that is empty.
pub(super) fn titled<'c, R>(
    column: Column<'c, R>,
    title: &'static str,
    text: impl Fn(&R) -> String + 'c,
) -> Column<'c, R> {
    if title.is_empty() { column } else { column.shown(title, text) }
}

/// A mean over seeds, shown below `title` unless that is empty, and its standard deviation.
pub(super) fn mean_std<'c, R: 'c>(
    name: String,
    title: &'static str,
    meaning: impl Into<Cow<'static, str>>,
    of: impl Fn(&R) -> MeanStd + Copy + 'c,
) -> [Column<'c, R>; 2] {
    let std = Column::real(
        format!("{name}_std"),
        "its standard deviation over seeds; empty for fewer than two",
        move |row: &R| of(row).1,
    );
    let mean = Column::real(name, meaning, move |row: &R| of(row).0);
    [titled(mean, title, move |row| with_spread(of(row).0, of(row).1)), std]
}

/// [`mean_std`] of a number over all of a run, then over each third.
pub(super) fn by_part<'c, R: 'c>(
    name: &str,
    titles: [&'static str; 4],
    meaning: &'static str,
    of: impl Fn(&R) -> ByThirdMeans + Copy + 'c,
) -> Vec<Column<'c, R>> {
    const PARTS: [&str; 4] = ["all of it", "the first third", "the second third", "the last third"];
    let columns = titles.into_iter().enumerate().flat_map(|(part, title)| {
        let (name, meaning) = match part {
            0 => (name.to_owned(), meaning.to_owned()),
            _ => (format!("{name}_{part}"), format!("the same of {}", PARTS[part])),
        };
        mean_std(name, title, meaning, move |row: &R| of(row).part(part))
    });
    columns.collect()
}

/// Seeds with at least one evaluation.
pub(super) fn seeds<'c, R: 'c>(count: fn(&R) -> usize) -> Column<'c, R> {
    Column::count("n_seeds", "seeds with at least one evaluation", move |row| count(row) as u64)
}

/// Seeds whose run used up its budget.
pub(super) fn finished<'c>() -> Column<'c, GroupSummary> {
    let meaning =
        "seeds whose run used up its budget; where there are none, numbers are those of unfinished runs";
    Column::count("n_finished", meaning, |row: &GroupSummary| row.n_finished as u64)
}

/// Seeds whose run failed.
pub(super) fn failed<'c>() -> Column<'c, GroupSummary> {
    let meaning = "seeds whose run failed, and counts 0 from its failure on";
    Column::count("n_failed", meaning, |row: &GroupSummary| row.n_failed as u64)
}

/// `95`: a share as whole or broken per cent.
pub(super) fn percent(share: f64) -> f64 {
    share * 100.0
}

/// The effect that a verdict rests on: difference, test and what it was made of.
pub(super) fn effect<'c, R: 'c>(
    entry: fn(&R) -> Option<&LedgerEntry>,
    difference: &'static str,
    confidence: &'static str,
) -> Vec<Column<'c, R>> {
    let real = move |value: fn(&LedgerEntry) -> Option<f64>| move |row: &R| entry(row).and_then(value);
    let count =
        move |value: fn(&Effect) -> usize| move |row: &R| entry(row).map(|entry| value(&entry.effect) as u64);
    vec![
        Column::real("effect", difference, real(|entry| entry.effect.difference)),
        Column::real(
            "ci_low",
            "lower end of the interval that the sign-flip test does not refuse; empty for too few pairs",
            real(|entry| entry.effect.interval.map(|ci| ci.0)),
        ),
        Column::real("ci_high", "its upper end", real(|entry| entry.effect.interval.map(|ci| ci.1))),
        Column::real("confidence", confidence, real(|entry| Some(entry.confidence))),
        Column::real(
            "p",
            "two-sided p-value of the sign-flip test of no difference, uncorrected",
            real(|entry| entry.effect.p),
        ),
        Column::real(
            "improvement",
            "share of pairs in which the first side is ahead, ties one half, mean over environments",
            real(|entry| entry.effect.improvement),
        ),
        Column::real(
            "improvement_p",
            "two-sided p-value of the sign-flip test of the signs of the pairs, uncorrected",
            real(|entry| entry.effect.improvement_p),
        ),
        Column::count("environments", "environments with a pair", count(|effect| effect.places.len())),
        Column::count(
            "environments_ahead",
            "those of them where the mean difference is above 0",
            count(Effect::ahead),
        ),
        Column::count("environments_behind", "those of them where it is below 0", count(Effect::behind)),
        Column::count("pairs", "pairs of runs with the same seed in them", count(|effect| effect.pairs)),
        Column::count(
            "runs_left_out",
            "runs that are not finished or were evaluated at other steps",
            count(|effect| effect.left_out),
        ),
        Column::count(
            "runs_failed",
            "runs of the compared ones that failed, and count 0 from their failure on",
            count(|effect| effect.failed),
        ),
    ]
}
