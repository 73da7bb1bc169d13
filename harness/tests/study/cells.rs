//! Cells of the tables, and tables as Markdown.

use goalbench::Registry;

use crate::sheet::Row;

/// `TEACH`; `TEACH (n3)` for a variant.
pub(crate) fn method(row: Row<'_>) -> String {
    let (title, variant) = (title(&row.text("curriculum")), row.text("variant"));
    if variant == "default" { title } else { format!("{title} ({variant})") }
}

pub(crate) fn title(curriculum: &str) -> String {
    Registry::builtin().curriculum(curriculum).expect("a curriculum of the registry").title.to_owned()
}

pub(crate) fn interval(row: Row<'_>, low: &str, high: &str) -> String {
    range(row.number(low).zip(row.number(high)))
}

pub(crate) fn range(ends: Option<(f64, f64)>) -> String {
    ends.map_or_else(
        || "–".to_owned(),
        |(low, high)| format!("[{}, {}]", signed(Some(low)), signed(Some(high))),
    )
}

pub(crate) fn rate(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), |value| format!("{value:.3}"))
}

pub(crate) fn signed(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), |value| format!("{value:+.3}"))
}

pub(crate) fn p_value(value: Option<f64>) -> String {
    match value {
        None => "–".to_owned(),
        Some(p) if p < 0.0001 => "< 0.0001".to_owned(),
        Some(p) => format!("{p:.4}"),
    }
}

/// `15,000`.
pub(crate) fn count(value: Option<f64>) -> String {
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

pub(crate) fn keep(list: &mut Vec<String>, item: String) {
    if !list.contains(&item) {
        list.push(item);
    }
}

pub(crate) fn markdown(head: &[String], body: impl Iterator<Item = Vec<String>>) -> Vec<String> {
    let line = |cells: &[String]| format!("| {} |", cells.join(" | "));
    let rule = format!("|{}", "---|".repeat(head.len()));
    [line(head), rule].into_iter().chain(body.map(|cells| line(&cells))).collect()
}
