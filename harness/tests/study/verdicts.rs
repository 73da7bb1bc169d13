//! Tables of the ledger's verdicts.

use std::path::Path;

use crate::cells::{count, interval, markdown, p_value, rate, signed};
use crate::sheet::{Row, Sheet};

/// Claims of the ledger: what was found, and what their test can find.
pub(crate) fn claims(report: &Path, ids: &[&str]) -> Vec<String> {
    let head = [
        "claim",
        "verdict",
        "effect",
        "interval",
        "confidence",
        "p (means)",
        "pairs ahead",
        "p (signs)",
        "pairs",
        "detectable by the mean",
    ];
    let sheet = Sheet::read(report, "ledger");
    let body = ids.iter().map(|id| {
        let row = sheet.rows().find(|row| row.text("claim") == *id).expect("a claim of the ledger");
        let value = row.text("value");
        let of = if value.is_empty() { value } else { format!(" ({value})") };
        let statement = row.text("statement");
        let mut cells = vec![format!("`{id}`: {statement}{of}"), format!("**{}**", row.text("verdict"))];
        cells.extend(effect(row));
        cells.extend([count(row.number("pairs")), rate(detectable(row))]);
        cells
    });
    markdown(&head.map(str::to_owned), body)
}

/// Claims about baselines under every reading of the paper: a row per reading, a column per claim. Below them
/// stands what a claim comes to under all of them.
pub(crate) fn readings(report: &Path, ids: &[&str]) -> Vec<String> {
    let sheet = Sheet::read(report, "readings");
    let mut head = vec!["reading".to_owned(), "confidence".to_owned()];
    head.extend(ids.iter().map(|id| format!("`{id}`")));
    let mut body = Vec::new();
    let of_first: Vec<Row<'_>> = sheet.rows().filter(|row| row.text("claim") == ids[0]).collect();
    for family in of_first.chunk_by(|one, next| one.text("family") == next.text("family")) {
        let name = family[0].text("family");
        let at = if name.is_empty() { String::new() } else { format!(" (at {name})") };
        let cell = |id: &str, reading: &Row<'_>| {
            let same = ["family", "settings"];
            let row = sheet.rows().find(|row| {
                row.text("claim") == id && same.iter().all(|column| row.text(column) == reading.text(column))
            });
            row.expect("every reading of a claim")
        };
        for reading in family {
            let number = count(reading.number("reading"));
            let [_, _, confidence, ..] = effect(*reading);
            let mut cells = vec![format!("{number}: {}{at}", reading.text("settings")), confidence];
            cells.extend(ids.iter().map(|id| {
                let row = cell(id, reading);
                let [difference, interval, _, _, _, signs] = effect(row);
                format!("**{}** {difference} {interval}, signs {signs}", row.text("verdict"))
            }));
            body.push(cells);
        }
        let mut cells = vec![format!("all{at}"), String::new()];
        cells.extend(ids.iter().map(|id| cell(id, &family[0]).text("conclusion")));
        body.push(cells);
    }
    markdown(&head, body.into_iter())
}

/// Difference, its interval and the interval's confidence, the p-value of the means, the share of pairs ahead
/// and the p-value of their signs.
fn effect(row: Row<'_>) -> [String; 6] {
    let confidence = row.number("confidence").map_or_else(String::new, |confidence| {
        let percent = format!("{:.2}", 100.0 * confidence);
        format!("{} %", percent.trim_end_matches('0').trim_end_matches('.'))
    });
    [
        signed(row.number("effect")),
        interval(row, "ci_low", "ci_high"),
        confidence,
        p_value(row.number("p")),
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
