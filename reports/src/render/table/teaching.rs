//! What teachers picked.

use polars::prelude::DataFrame;

use super::cells::{UNDEFINED, decimal, or_undefined};
use super::{Table, column};
use crate::analysis::teaching::{NUMBERS, Row};
use crate::error::ReportError;
use crate::methods;

/// The rows as a data frame, unrounded; null where no seed has a number.
///
/// # Errors
/// [`ReportError::Frame`] if polars cannot hold the rows.
pub fn teaching_frame(rows: &[Row]) -> Result<DataFrame, ReportError> {
    let mut columns = vec![
        column("environment", rows, |row| row.key.environment.as_str()),
        column("curriculum", rows, |row| row.key.curriculum.as_str()),
        column("variant", rows, |row| row.key.variant.as_str()),
        column("n_seeds", rows, |row| row.n_seeds as u64),
    ];
    let means = NUMBERS.iter().enumerate().map(|(index, name)| column(name, rows, |row| row.means[index]));
    columns.extend(means);
    Ok(DataFrame::new(rows.len(), columns)?)
}

const HEADER: [&str; 8] = [
    "Environment",
    "Curriculum",
    "Variant",
    "Goals picked",
    "Effective picks",
    "Effective goals",
    "Rank of picks",
    "Score and success",
];

/// The rows as a table to read.
pub fn teaching_table(rows: &[Row]) -> Table {
    let cells = |row: &Row| {
        let [picked, effective_picks, effective_goals, rank, correlation] = row.means;
        let number = |mean| or_undefined(mean, decimal);
        let count = |mean| or_undefined(mean, |mean: f64| format!("{mean:.1}"));
        [
            row.key.environment.clone(),
            methods::title(&row.key.curriculum).to_owned(),
            row.key.variant.clone(),
            count(picked),
            count(effective_picks),
            count(effective_goals),
            number(rank),
            number(correlation),
        ]
    };
    let caption = format!(
        "What teachers picked between one evaluation and the next: means over evaluations, the untrained student's left \
         out, then over seeds; {UNDEFINED} where a teacher records no such number, or it was never defined. Goals picked: \
         distinct goals of the pool in the training episodes, at most as many as there were episodes; a teacher that \
         goes through its pool comes near that, one that is stuck on a few goals stays near 1. Effective picks: \
         exponential of the entropy of the goals' shares of those episodes, from 1 to the goals picked, which it is where \
         they have equal shares; far below them a few goals have most of the turns. Effective goals: exponential of the \
         entropy of the curriculum itself, from 1 (always the same goal) to the size of the pool, which it is where the \
         teacher makes no difference between goals, as HER-IID-pool; one that chooses lies clearly below that and well \
         above 1. Rank of picks: mean over episodes of the goal's rank among those that the teacher chose from, 0 for \
         the first, over the highest rank there is; 0.5 where every rank has its fair share of turns, as it should with \
         SPaCE, whose goals take turns; below where the teacher prefers what it ranks first. Score and success: \
         correlation over episodes of the teacher's score of the goal with success at it; near 1 the teacher scores \
         what the student has mastered highest, near -1 what is out of reach, near 0 its score says nothing of either; \
         none of these is wrong in itself, but a teacher of goals of medium difficulty should be far from both ends."
    );
    Table::new(caption, 3, HEADER, rows.iter().map(cells))
}
