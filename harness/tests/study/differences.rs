//! Tables of differences that stand beside the verdicts.

use std::path::Path;

use crate::beside::{Beside, DEFAULT, Measure, beside, correlations, each, less};
use crate::cells::{markdown, p_value, range, rate, signed, title};
use crate::sheet::{Row, Sheet};

/// The head of a column of such intervals.
const INTERVAL: &str = "98.75 % interval";

/// What stands beside the verdicts on area: the first of `curricula` against each of the others.
pub(crate) fn besides(report: &Path, curricula: &[&str]) -> Vec<String> {
    let [ours, others @ ..] = curricula else { panic!("the table needs a first curriculum") };
    let records = Sheet::read(report, "records");
    let against = format!("{} against", title(ours));
    let head = [&against, "units", "difference", INTERVAL, "ahead", "p (signs)", "number of units"];
    let body = others.iter().flat_map(|other| {
        beside(&records, ours, other).into_iter().map(|(what, found)| {
            let units = found.units.to_string();
            let mut cells = vec![title(other), what.to_owned()];
            cells.extend(test(&found));
            cells.push(units);
            cells
        })
    });
    markdown(&head.map(str::to_owned), body)
}

/// Rank correlations between mazes of one seed's differences to the first of `curricula`.
pub(crate) fn correlation(report: &Path, curricula: &[&str]) -> Vec<String> {
    by_place(report, curricula, correlations, |value| signed(Some(value)))
}

/// Differences in area of the first of `curricula` to each of the others, in single environments.
pub(crate) fn by_each(report: &Path, curricula: &[&str]) -> Vec<String> {
    let cell = |found: Beside| format!("{} {}", signed(Some(found.difference)), range(found.interval));
    by_place(report, curricula, each, cell)
}

/// What was `found` of the first of `curricula` against each of the others: a column per place.
fn by_place<T>(
    report: &Path,
    curricula: &[&str],
    found: impl Fn(&Sheet, &str, &str) -> Vec<(String, T)>,
    cell: impl Fn(T) -> String,
) -> Vec<String> {
    let [ours, others @ ..] = curricula else { panic!("the table needs a first curriculum") };
    let records = Sheet::read(report, "records");
    let rows: Vec<_> = others.iter().map(|other| (title(other), found(&records, ours, other))).collect();
    let mut head = vec![format!("{} against", title(ours))];
    head.extend(rows.iter().take(1).flat_map(|(_, found)| found.iter().map(|(place, _)| place.clone())));
    let body = rows.into_iter().map(|(name, found)| {
        [name].into_iter().chain(found.into_iter().map(|(_, value)| cell(value))).collect()
    });
    markdown(&head, body)
}

/// Every two of `curricula` against each other, by area and by final success.
pub(crate) fn pairs(report: &Path, curricula: &[&str]) -> Vec<String> {
    let head = [
        "",
        "against",
        "area",
        INTERVAL,
        "ahead",
        "p (signs)",
        "final success",
        INTERVAL,
        "ahead",
        "p (signs)",
    ];
    let records = Sheet::read(report, "records");
    let mut body = Vec::new();
    for (index, one) in curricula.iter().enumerate() {
        for other in &curricula[index + 1..] {
            let mut cells = vec![title(one), title(other)];
            for measure in [Measure::Area, Measure::Final] {
                let side = |curriculum| (&records, (curriculum, DEFAULT));
                cells.extend(test(&less(measure, side(*one), side(*other))));
            }
            body.push(cells);
        }
    }
    markdown(&head.map(str::to_owned), body.into_iter())
}

/// TEACH's variants, their areas, and what these differ from the default's by.
pub(crate) fn variants(report: &Path, variants: &[&str]) -> Vec<String> {
    let [summary, settings, records] =
        ["summary", "variants", "records"].map(|name| Sheet::read(report, name));
    let of_teach = |row: &Row<'_>| row.text("curriculum") == "teach" && row.text("variant") == DEFAULT;
    let environments: Vec<String> =
        summary.rows().filter(of_teach).map(|row| row.text("environment")).collect();
    let mut head = vec!["variant".to_owned(), "settings (default)".to_owned()];
    head.extend(environments.iter().cloned());
    head.extend(["less the default", INTERVAL, "ahead", "p (signs)"].map(str::to_owned));
    let body = [DEFAULT].iter().chain(variants).map(|name| {
        let set = settings.rows().find(|row| row.text("variant") == *name);
        let set = set.map_or_else(String::new, |row| row.text("settings").replace("curriculum.teach.", ""));
        let mut cells = vec![format!("`{name}`"), set];
        cells.extend(environments.iter().map(|environment| {
            let here = |row: &Row<'_>| {
                row.text("environment") == *environment
                    && row.text("curriculum") == "teach"
                    && row.text("variant") == *name
            };
            let row = summary.rows().find(here).expect("every variant was trained everywhere");
            format!("{} ± {}", rate(row.number("auc_mean")), rate(row.number("auc_std")))
        }));
        if *name == DEFAULT {
            cells.extend([const { String::new() }; 4]);
        } else {
            let side = |variant| (&records, ("teach", variant));
            cells.extend(test(&less(Measure::Area, side(*name), side(DEFAULT))));
        }
        cells
    });
    markdown(&head, body)
}

/// TEACH's variants in one part less the default of a curriculum in another, by area on what both have.
pub(crate) fn across(report: &Path, (other, curriculum): (&Path, &str), variants: &[&str]) -> Vec<String> {
    let [ours, theirs] = [report, other].map(|report| Sheet::read(report, "records"));
    let less_other = format!("area less {}'s", title(curriculum));
    let head = ["TEACH's variant", &less_other, INTERVAL, "ahead", "p (signs)", "pairs"];
    let body = variants.iter().map(|variant| {
        let found = less(Measure::Area, (&ours, ("teach", *variant)), (&theirs, (curriculum, DEFAULT)));
        let mut cells = vec![format!("`{variant}`")];
        cells.extend(test(&found));
        cells.push(found.units.to_string());
        cells
    });
    markdown(&head.map(str::to_owned), body)
}

/// Difference, interval, share of units ahead and the p-value of their signs.
fn test(found: &Beside) -> [String; 4] {
    [
        signed(Some(found.difference)),
        range(found.interval),
        rate(Some(found.ahead)),
        p_value(Some(found.p_signs)),
    ]
}
