//! Methods against the first method of each environment.

use super::{Artefact, Repeated, Section, columns};
use crate::analysis::comparison::{ALPHA, Comparison, TARGET_POWER};
use crate::analysis::whole::Analysis;
use crate::error::ReportError;
use crate::render::table::cells::{
    BOOTSTRAP_COVERAGE, decimal, or_undefined, p_value, thousands, with_fine_interval,
};
use crate::render::table::{Column, Sheet};
use crate::stats::{MOST_ENUMERATED, Resampling};

const SECTION: Section = Section::Named { id: "comparisons", title: "Comparisons" };

pub(super) const ROW: Artefact =
    Artefact::table("comparisons", SECTION, "method and its reference", sheet).repeated(Repeated::Open);

fn sheet(analysis: &Analysis<'_>) -> Result<Sheet, ReportError> {
    Sheet::of(caption(analysis.options.resampling), &analysis.comparisons, &columns())
}

/// What is compared, over how many runs, and by how much.
fn columns<'a>() -> Vec<Column<'a, Comparison<'a>>> {
    let mut columns = vec![
        Column::text(
            "family",
            "`methods` or `variants`: the comparisons that p_holm corrects for together",
            |row: &Comparison<'_>| row.family.as_str().to_owned(),
        ),
        columns::environment(|row: &Comparison<'_>| row.method),
        columns::curriculum(|row: &Comparison<'_>| row.method).named("Method", |row| row.method.name()),
        Column::text(columns::VARIANT.0, columns::VARIANT.1, |row: &Comparison<'_>| {
            row.method.variant.clone()
        }),
        Column::text("reference_curriculum", "curriculum id of the reference", |row: &Comparison<'_>| {
            row.reference.curriculum.id.clone()
        })
        .named("Reference", |row| row.reference.name()),
        Column::text("reference_variant", "variant of the reference", |row: &Comparison<'_>| {
            row.reference.variant.clone()
        }),
        Column::count("n_seeds", "finished runs of the same evaluations", |row: &Comparison<'_>| {
            row.n.0 as u64
        }),
        Column::count("n_reference", "the same for the reference", |row: &Comparison<'_>| row.n.1 as u64),
        Column::count(
            "runs_left_out",
            "runs of both that are not finished or were evaluated at other steps",
            |row: &Comparison<'_>| row.left_out as u64,
        ),
        Column::count(
            "runs_failed",
            "runs of both that failed, and count 0 from their failure on",
            |row: &Comparison<'_>| row.failed as u64,
        ),
        Column::count("n_pairs", "seeds that both have", |row: &Comparison<'_>| row.pairs as u64).shown(
            "Pairs",
            |row| match row.failed {
                0 => row.pairs.to_string(),
                failed => format!("{} ({failed} failed)", row.pairs),
            },
        ),
    ];
    columns.extend(difference(
        "difference",
        "Difference",
        "mean over pairs of the difference of final success, method minus reference",
        |row| Some((row.difference?, row.difference_ci)),
    ));
    columns.extend(of_pairs());
    columns.extend(of_all_runs());
    columns.extend(of_areas());
    columns.push(
        Column::text("note", "what the tests cannot say, and why", |row: &Comparison<'_>| row.said())
            .named("Note", |row| row.said().unwrap_or_default()),
    );
    columns
}

/// A mean difference over pairs with its interval; `None` where there is none.
type Difference = Option<(f64, Option<(f64, f64)>)>;

/// The difference `name`, shown below `title`, and the ends of its interval.
fn difference<'a>(
    name: &str,
    title: &'static str,
    meaning: &'static str,
    of: fn(&Comparison<'_>) -> Difference,
) -> [Column<'a, Comparison<'a>>; 3] {
    [
        Column::real(name.to_owned(), meaning, move |row: &Comparison<'_>| Some(of(row)?.0))
            .shown(title, move |row| {
                or_undefined(of(row), |(mean, interval)| with_fine_interval(mean, interval))
            }),
        Column::real(
            format!("{name}_ci_low"),
            "lower end of its paired bootstrap interval",
            move |row: &Comparison<'_>| Some(of(row)?.1?.0),
        ),
        Column::real(format!("{name}_ci_high"), "its upper end", move |row: &Comparison<'_>| {
            Some(of(row)?.1?.1)
        }),
    ]
}

/// The tests that use the pairs.
fn of_pairs<'a>() -> Vec<Column<'a, Comparison<'a>>> {
    vec![
        Column::real(
            "sign_flip_p",
            "two-sided p-value of the sign-flip test of these pairs, uncorrected; not below 2^(1 - n_pairs)",
            |row: &Comparison<'_>| row.sign_flip.map(|test| test.p),
        )
        .shown("p (sign flips)", |row| or_undefined(row.sign_flip, |test| p_value(test.p))),
        Column::real(
            "improvement",
            "share of these pairs in which the method is ahead, ties one half",
            |row: &Comparison<'_>| row.improvement,
        )
        .shown("Pairs ahead", |row| or_undefined(row.improvement, decimal)),
        Column::real(
            "improvement_p",
            "two-sided p-value of the sign-flip test of the signs of these pairs, uncorrected",
            |row: &Comparison<'_>| row.improvement_p,
        )
        .shown("p (signs)", |row| or_undefined(row.improvement_p, p_value)),
    ]
}

/// The tests that take all runs of both sides.
fn of_all_runs<'a>() -> Vec<Column<'a, Comparison<'a>>> {
    vec![
        Column::real(
            "probability_of_improvement",
            "P(run of the method > run of the reference), ties one half",
            |row: &Comparison<'_>| row.probability_of_improvement,
        )
        .shown("P(improvement)", |row| or_undefined(row.probability_of_improvement, decimal)),
        Column::real(
            "welch_t",
            "t of Welch's test of equal means; empty where neither side varies",
            |row: &Comparison<'_>| row.welch.map(|test| test.t),
        ),
        Column::real("welch_df", "its degrees of freedom", |row: &Comparison<'_>| row.welch.map(|test| test.df)),
        Column::real("welch_p", "its two-sided p-value, uncorrected", |row: &Comparison<'_>| {
            row.welch.map(|test| test.p)
        }),
        Column::real(
            "p_holm",
            "the p-value corrected by Holm's method for all comparisons of its family; 1 where all scores are equal; of the exact \
             permutation test where neither side varies",
            |row: &Comparison<'_>| row.p_holm,
        )
        .shown("p (Holm)", |row| or_undefined(row.p_holm, p_value)),
        Column::real("effect_size", "Cohen's d", |row: &Comparison<'_>| row.effect_size),
        Column::real(
            "level",
            "0.05 over the tests of the family: the strictest level that Holm's method asks for",
            |row: &Comparison<'_>| row.level,
        ),
        Column::real(
            "detectable",
            "smallest true difference of success rates that Welch's test finds at that level with a power of 0.8, given \
             the fewer seeds of both sides and their spread; above 1: none",
            |row: &Comparison<'_>| row.p_holm.and(row.detectable),
        )
        .shown("Detectable", |row| or_undefined(row.p_holm.and(row.detectable), decimal)),
    ]
}

/// The differences of areas under learning curves.
fn of_areas<'a>() -> Vec<Column<'a, Comparison<'a>>> {
    let mut columns = Vec::from(difference(
        "area_difference",
        "AUC difference",
        "mean over pairs of the difference of the area under the curve, method minus reference",
        |row| row.area.map(|area| (area.mean, area.interval)),
    ));
    columns.push(Column::real(
        "area_sign_flip_p",
        "two-sided p-value of the sign-flip test of these differences, uncorrected",
        |row: &Comparison<'_>| Some(row.area?.sign_flip?.p),
    ));
    columns
}

fn caption(resampling: Resampling) -> String {
    format!(
        "Final success of each method against the first method of its environment, and of each variant of a method \
         against its default, from finished runs of the same evaluations. A variant that several methods have is set \
         against the same variant of the first method, where that has it. Difference: method minus reference, mean over \
         the seeds that both have, with its {} % paired bootstrap interval: {BOOTSTRAP_COVERAGE}. p (sign flips): test \
         of these pairs, uncorrected, whose null is that the two runs of a pair are exchangeable: exact up to \
         {MOST_ENUMERATED} pairs, of more from {} random flips; it cannot fall below 0.016 for 7 pairs. Pairs ahead: share \
         of the pairs in which the method is ahead, ties one half; p (signs): the same test of these signs alone, which a \
         few collapsed runs cannot decide. P(improvement): probability that a random run of the method scores above one of \
         the reference. p (Holm): Welch's two-sided t-test, which does not use the pairs, corrected by Holm's method for \
         all comparisons of methods, and for all of variants; 1 where all scores are equal; where neither side varies and \
         they differ, the exact permutation test of all runs stands in its place. In brackets behind the pairs: runs of \
         both that failed, and count 0 from their failure on. Variants whose runs are those \
         of the reference evaluation by evaluation are left out. Detectable: the smallest true difference of success rates \
         that this test finds with a power of {TARGET_POWER}, given the seeds at hand and their spread, at the strictest \
         level of that correction ({ALPHA} over the number of tests). AUC difference: the same mean with its \
         interval, over the same pairs, of the area under the learning curve; no p of the table is about it.",
        columns::percent(resampling.confidence),
        thousands(resampling.resamples as u64),
    )
}
