//! What teachers picked.

use super::{Artefact, Repeated, Section, columns};
use crate::analysis::teaching::{PICKED_GOALS, PickSummary};
use crate::analysis::whole::Analysis;
use crate::error::ReportError;
use crate::render::table::cells::{UNDEFINED, decimal, or_undefined};
use crate::render::table::{Column, Sheet};

const SECTION: Section = Section::Named { id: "teaching", title: "What teachers picked" };

pub(super) const ROW: Artefact =
    Artefact::table("teaching", SECTION, "environment, curriculum and variant", sheet)
        .repeated(Repeated::Open);

fn sheet(analysis: &Analysis<'_>) -> Result<Sheet, ReportError> {
    Sheet::of(caption(analysis), &analysis.picks, &columns())
}

fn columns() -> [Column<'static, PickSummary>; 9] {
    let tenth = |mean: f64| format!("{mean:.1}");
    [
        columns::environment(|row| &row.key),
        columns::curriculum(|row| &row.key),
        columns::variant(|row| &row.key),
        Column::count(
            "n_counted",
            "seeds that the following are of: those whose run has ended, or all where none has",
            |row: &PickSummary| row.n_seeds as u64,
        ),
        number(
            PICKED_GOALS,
            "distinct goals of the pool picked since the evaluation before, mean over evaluations and seeds; empty, as are \
             the following, where no teacher records it",
        )
        .shown("Goals picked", shown(PICKED_GOALS, tenth)),
        number("effective_picks", "exponential of the entropy of the picks since then; likewise")
            .shown("Effective picks", shown("effective_picks", tenth)),
        number("effective_goals", "exponential of the entropy of the curriculum; likewise")
            .shown("Effective goals", shown("effective_goals", tenth)),
        number(
            "pick_rank_mean",
            "mean over episodes of the goal's rank (0 for the first) over the highest rank, 0.5 for fair turns; likewise",
        )
        .shown("Rank of picks", shown("pick_rank_mean", decimal)),
        number(
            "score_success_correlation",
            "correlation over episodes of the teacher's score of the goal with success at it; likewise",
        )
        .shown("Score and success", shown("score_success_correlation", decimal)),
    ]
}

/// A number of teachers.
fn number(name: &'static str, meaning: &'static str) -> Column<'static, PickSummary> {
    Column::real(name, meaning, move |row: &PickSummary| row.mean(name))
}

fn shown(name: &'static str, text: fn(f64) -> String) -> impl Fn(&PickSummary) -> String {
    move |row| or_undefined(row.mean(name), text)
}

fn caption(analysis: &Analysis<'_>) -> String {
    let control = analysis.paper().control.as_ref();
    let control = control.map_or_else(String::new, |id| format!(", as {}", analysis.catalogue().title(id)));
    format!(
        "What teachers picked between one evaluation and the next: means over evaluations, the untrained student's left \
         out, then over the seeds whose run has ended (where none has, over all); {UNDEFINED} where a teacher records no such number, or it was never defined. Goals picked: \
         distinct goals of the pool in the training episodes, at most as many as there were episodes; a teacher that \
         goes through its pool comes near that, one that is stuck on a few goals stays near 1. Effective picks: \
         exponential of the entropy of the goals' shares of those episodes, from 1 to the goals picked, which it is where \
         they have equal shares; far below them a few goals have most of the turns. Effective goals: exponential of the \
         entropy of the curriculum itself, from 1 (always the same goal) to the size of the pool, which it is where the \
         teacher makes no difference between goals{control}; one that chooses lies clearly below that and well \
         above 1. Rank of picks: mean over episodes of the goal's rank among those that the teacher chose from, 0 for \
         the first, over the highest rank there is; 0.5 where every rank has its fair share of turns, as it \
         should where goals take turns; below where the teacher prefers what it ranks first. Score and success: \
         correlation over episodes of the teacher's score of the goal with success at it; near 1 the teacher scores \
         what the student has mastered highest, near -1 what is out of reach, near 0 its score says nothing of either; \
         none of these is wrong in itself, but a teacher of goals of medium difficulty should be far from both ends."
    )
}
