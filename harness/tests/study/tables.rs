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

use goalbench::Registry;

use crate::beside::beside;
use crate::sheet::{Row, Sheet};

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
        let lines = table(kind, report(part), ids).join("\n");
        text += &format!("{BEGIN}{what} -->\n{lines}\n{END}{rest}");
    }
    text
}

/// The lines of a table of this kind. `ids` are claims, where it is about claims.
fn table(kind: &str, report: &Path, ids: &[&str]) -> Vec<String> {
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
        "beside" => besides(report, ids),
        "claims" => claims(report, ids),
        "readings" => readings(report, ids),
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

/// Methods against the first one, in single environments.
fn comparisons(report: &Path) -> Vec<String> {
    let head = ["", "against", "environment", "difference", "95 %", "pairs ahead", "p (Holm)", "detectable"];
    let sheet = Sheet::read(report, "comparisons");
    let body = sheet.rows().filter(|row| row.text("family") == "methods").map(|row| {
        vec![
            method(row),
            title(&row.text("reference_curriculum")),
            row.text("environment"),
            signed(row.number("difference")),
            interval(row, "difference_ci_low", "difference_ci_high"),
            rate(row.number("improvement")),
            p_value(row.number("p_holm")),
            rate(row.number("detectable")),
        ]
    });
    markdown(&head.map(str::to_owned), body)
}

/// Claims of the ledger: what was found, and what their test can find.
fn claims(report: &Path, ids: &[&str]) -> Vec<String> {
    let head = [
        "claim",
        "verdict",
        "effect",
        "interval",
        "level",
        "pairs ahead",
        "p (signs)",
        "pairs",
        "detectable by the mean",
    ];
    let sheet = Sheet::read(report, "ledger");
    let body = ids.iter().map(|id| {
        let row = sheet.rows().find(|row| row.text("claim") == *id).expect("a claim of the ledger");
        let value = row.text("value");
        let of = if value.is_empty() { String::new() } else { format!(", {value}") };
        let mut cells = vec![format!("`{id}`{of}"), format!("**{}**", row.text("verdict"))];
        cells.extend(effect(row));
        cells.extend([count(row.number("pairs")), rate(detectable(row))]);
        cells
    });
    markdown(&head.map(str::to_owned), body)
}

/// What stands beside the verdicts on area: the first of `curricula` against each of the others.
fn besides(report: &Path, curricula: &[&str]) -> Vec<String> {
    let [ours, others @ ..] = curricula else { panic!("the table needs a first curriculum") };
    let against = format!("{} against", title(ours));
    let head = [&against, "runs", "difference", "98.75 %", "ahead", "p (signs)", "units"];
    let mut body = Vec::new();
    for other in others {
        let (rows, correlation) = beside(report, ours, other);
        body.extend(rows.into_iter().map(|row| {
            vec![
                title(other),
                row.what.to_owned(),
                signed(Some(row.difference)),
                range(row.interval),
                rate(Some(row.ahead)),
                p_value(Some(row.p_signs)),
                row.units.to_string(),
            ]
        }));
        let empty = [const { String::new() }; 4];
        let mut cells = vec![title(other), "rank correlation of mazes".to_owned(), signed(correlation)];
        cells.extend(empty);
        body.push(cells);
    }
    markdown(&head.map(str::to_owned), body.into_iter())
}

/// Claims about baselines under every reading of the paper, and what each comes to under all of a family.
fn readings(report: &Path, ids: &[&str]) -> Vec<String> {
    let head = ["claim", "reading", "verdict", "effect", "interval", "level", "pairs ahead", "p (signs)"];
    let sheet = Sheet::read(report, "readings");
    let mut body = Vec::new();
    for id in ids {
        let here: Vec<Row<'_>> = sheet.rows().filter(|row| row.text("claim") == *id).collect();
        assert!(!here.is_empty(), "the readings have {id}");
        for family in here.chunk_by(|one, next| one.text("family") == next.text("family")) {
            let name = family[0].text("family");
            let at = if name.is_empty() { name } else { format!(" (at {name})") };
            body.extend(family.iter().map(|row| {
                let reading = format!("{}: {}{at}", count(row.number("reading")), row.text("settings"));
                let mut cells = vec![format!("`{id}`"), reading, format!("**{}**", row.text("verdict"))];
                cells.extend(effect(*row));
                cells
            }));
            let mut cells = vec![format!("`{id}`"), format!("*all{at}: {}*", family[0].text("conclusion"))];
            cells.extend([const { String::new() }; 6]);
            body.push(cells);
        }
    }
    markdown(&head.map(str::to_owned), body.into_iter())
}

/// Difference, interval, level, share of pairs ahead and the p-value of their signs.
fn effect(row: Row<'_>) -> [String; 5] {
    let level = row.number("confidence").map_or_else(String::new, |confidence| {
        let percent = format!("{:.2}", 100.0 * confidence);
        format!("{} %", percent.trim_end_matches('0').trim_end_matches('.'))
    });
    [
        signed(row.number("effect")),
        interval(row, "ci_low", "ci_high"),
        level,
        rate(row.number("improvement")),
        p_value(row.number("improvement_p")),
    ]
}

/// The smallest true mean difference that a test with the interval of `row` finds with a power of 0.8, were
/// the statistic normal: h (z(1 - α/2) + z(0.8)) / z(1 - α/2) with half the interval's width h and its level
/// α. The companion, the test of the signs, asks for somewhat more. `None` for claims about single
/// environments, whose interval is that of one of them.
fn detectable(row: Row<'_>) -> Option<f64> {
    if row.number("environments") == Some(1.0) {
        return None;
    }
    let (low, high) = (row.number("ci_low")?, row.number("ci_high")?);
    Some(detectable_by((high - low) / 2.0, row.number("confidence")?))
}

fn detectable_by(half_width: f64, confidence: f64) -> f64 {
    let critical = normal_quantile((1.0 + confidence) / 2.0);
    half_width * (critical + normal_quantile(0.8)) / critical
}

/// The standard normal's quantile for a probability above one half.
fn normal_quantile(probability: f64) -> f64 {
    use statrs::distribution::{ContinuousCDF, Normal};
    Normal::standard().inverse_cdf(probability)
}

#[test]
fn a_test_finds_more_than_half_of_its_interval() {
    // z(0.975) = 1.959964 and z(0.8) = 0.841621: (1.959964 + 0.841621) / 1.959964 = 1.429406.
    assert!((detectable_by(0.1, 0.95) - 0.142_940_6).abs() < 1e-6);
}

/// `TEACH`; `TEACH (n3)` for a variant.
fn method(row: Row<'_>) -> String {
    let (title, variant) = (title(&row.text("curriculum")), row.text("variant"));
    if variant == "default" { title } else { format!("{title} ({variant})") }
}

fn title(curriculum: &str) -> String {
    Registry::builtin().curriculum(curriculum).expect("a curriculum of the registry").title.to_owned()
}

fn interval(row: Row<'_>, low: &str, high: &str) -> String {
    range(row.number(low).zip(row.number(high)))
}

fn range(ends: Option<(f64, f64)>) -> String {
    ends.map_or_else(
        || "–".to_owned(),
        |(low, high)| format!("[{}, {}]", signed(Some(low)), signed(Some(high))),
    )
}

fn rate(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), |value| format!("{value:.3}"))
}

fn signed(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), |value| format!("{value:+.3}"))
}

fn p_value(value: Option<f64>) -> String {
    match value {
        None => "–".to_owned(),
        Some(p) if p < 0.0001 => "< 0.0001".to_owned(),
        Some(p) => format!("{p:.4}"),
    }
}

/// `15,000`.
fn count(value: Option<f64>) -> String {
    value.map_or_else(
        || "–".to_owned(),
        |value| {
            let digits = format!("{value:.0}");
            let head = digits.len() % 3;
            let groups =
                digits.as_bytes()[head..].chunks(3).map(|group| String::from_utf8_lossy(group).into_owned());
            let all: Vec<String> = [digits[..head].to_owned()].into_iter().chain(groups).collect();
            all.join(",").trim_start_matches(',').to_owned()
        },
    )
}

fn keep(list: &mut Vec<String>, item: String) {
    if !list.contains(&item) {
        list.push(item);
    }
}

fn markdown(head: &[String], body: impl Iterator<Item = Vec<String>>) -> Vec<String> {
    let line = |cells: &[String]| format!("| {} |", cells.join(" | "));
    let rule = format!("|{}", "---|".repeat(head.len()));
    [line(head), rule].into_iter().chain(body.map(|cells| line(&cells))).collect()
}
