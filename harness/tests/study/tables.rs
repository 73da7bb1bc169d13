//! The tables of the study's page, made from the tables of a report.
//!
//! In the page a table stands between two comments, the first of which says what it is:
//!
//! ```text
//! <!-- table: area laptop -->
//! ...
//! <!-- end of table -->
//! ```

use std::path::Path;

use crate::cells::{count, keep, markdown, method, p_value, range, rate, signed, title};
use crate::differences::{across, besides, by_each, correlation, pairs, variants};
use crate::sheet::{Row, Sheet};
use crate::verdicts::{claims, readings};

pub(crate) const BEGIN: &str = "<!-- table: ";
const END: &str = "<!-- end of table -->";

/// `page` with every table made from the report of the part that it names; `report` gives the folder of that
/// part's report.
pub(crate) fn remade<'a>(page: &str, report: impl Fn(&str) -> &'a Path) -> String {
    let mut parts = page.split(BEGIN);
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (what, rest) = part.split_once(" -->\n").expect("a comment says what the table is");
        let (_, rest) = rest.split_once(END).expect("a comment ends the table");
        let words: Vec<&str> = what.split(' ').collect();
        let [kind, part, ids @ ..] = words.as_slice() else { panic!("`{what}` names a kind and a part") };
        let lines = table(kind, part, ids, &report).join("\n");
        text += &format!("{BEGIN}{what} -->\n{lines}\n{END}{rest}");
    }
    text
}

/// The lines of a table of this kind about `part`; `words` say what it is about.
fn table<'a>(kind: &str, part: &str, words: &[&str], report_of: &impl Fn(&str) -> &'a Path) -> Vec<String> {
    let report = report_of(part);
    match kind {
        "area" => spreads(report, "auc"),
        "final" => spreads(report, "final"),
        "steps" => by_environment(report, "summary", |row| {
            format!("{} / {}", count(row.number("steps_to_50")), count(row.number("steps_to_80")))
        }),
        "choice" => by_environment(report, "teaching", |row| {
            let goals = row.number("effective_goals").map(|goals| format!("{goals:.0}"));
            goals.unwrap_or_else(|| "–".to_owned())
        }),
        "mastery" => {
            by_environment(report, "teaching", |row| signed(row.number("score_success_correlation")))
        }
        "price" => by_environment(report, "costs", |row| {
            let share = row.number("teacher_hours").zip(row.number("wall_hours"));
            share.map_or_else(|| "–".to_owned(), |(teacher, wall)| format!("{:.0} %", 100.0 * teacher / wall))
        }),
        "single" => single(report),
        "comparisons" => comparisons(report),
        "beside" => besides(report, words),
        "correlations" => correlation(report, words),
        "each" => by_each(report, words),
        "pairs" => pairs(report, words),
        "variants" => variants(report, words),
        "across" => {
            let [other, curriculum, variants @ ..] = words else { panic!("`across` names another part") };
            across(report, (report_of(other), curriculum), variants)
        }
        "claims" => claims(report, words),
        "readings" => readings(report, words),
        _ => panic!("no table is called {kind}"),
    }
}

/// Mean and standard deviation of `measure` over seeds, and the mean of the means over environments.
fn spreads(report: &Path, measure: &str) -> Vec<String> {
    let (mean, std) = (format!("{measure}_mean"), format!("{measure}_std"));
    let cell = |row: Row<'_>| format!("{} ± {}", rate(row.number(&mean)), rate(row.number(&std)));
    grid(&Sheet::read(report, "summary"), cell, Some(&mean))
}

fn by_environment(report: &Path, sheet: &str, cell: impl Fn(Row<'_>) -> String) -> Vec<String> {
    grid(&Sheet::read(report, sheet), cell, None)
}

/// A row per method, a column per environment, and one for the mean of `average` over them.
fn grid(sheet: &Sheet, cell: impl Fn(Row<'_>) -> String, average: Option<&str>) -> Vec<String> {
    let (mut environments, mut methods) = (Vec::new(), Vec::new());
    for row in sheet.rows() {
        keep(&mut environments, row.text("environment"));
        keep(&mut methods, method(row));
    }
    let mut head = vec!["".to_owned()];
    head.extend(environments.iter().cloned());
    head.extend(average.map(|_| "mean".to_owned()));
    let body = methods.iter().map(|name| {
        let here: Vec<Row<'_>> = sheet.rows().filter(|row| method(*row) == *name).collect();
        let mut cells = vec![name.clone()];
        cells.extend(environments.iter().map(|environment| {
            let row = here.iter().find(|row| row.text("environment") == *environment);
            row.map_or_else(|| "–".to_owned(), |row| cell(*row))
        }));
        cells.extend(average.map(|column| {
            let values: Vec<f64> = here.iter().filter_map(|row| row.number(column)).collect();
            if values.len() == environments.len() {
                rate(reports::stats::mean(&values))
            } else {
                "–".to_owned()
            }
        }));
        cells
    });
    markdown(&head, body)
}

/// One run of each method: numbers without a spread.
fn single(report: &Path) -> Vec<String> {
    let head = ["", "training steps", "area", "final success", "steps to 50 %", "steps to 80 %"];
    let sheet = Sheet::read(report, "runs");
    let body = sheet.rows().map(|row| {
        vec![
            method(row),
            count(row.number("step")),
            rate(row.number("auc")),
            rate(row.number("final_success")),
            count(row.number("steps_to_50")),
            count(row.number("steps_to_80")),
        ]
    });
    markdown(&head.map(str::to_owned), body)
}

/// The first method against the others in single environments, by final success.
fn comparisons(report: &Path) -> Vec<String> {
    let sheet = Sheet::read(report, "comparisons");
    let rows: Vec<Row<'_>> = sheet.rows().filter(|row| row.text("family") == "methods").collect();
    let first = rows.first().map_or_else(String::new, |row| title(&row.text("reference_curriculum")));
    let against = format!("{first} against");
    let head = [&against, "environment", "difference", "95 % interval", "p (Holm)", "detectable"];
    let body = rows.iter().map(|row| {
        // The report has them the other way round.
        let number = |column| row.number(column).map(|value| -value);
        vec![
            method(*row),
            row.text("environment"),
            signed(number("difference")),
            range(number("difference_ci_high").zip(number("difference_ci_low"))),
            p_value(row.number("p_holm")),
            rate(row.number("detectable")),
        ]
    });
    markdown(&head.map(str::to_owned), body)
}
