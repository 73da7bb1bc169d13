//! What is said of a claim under several readings.

use super::{Reading, Varied};
use crate::analysis::ledger::{LedgerEntry, Verdict};

/// `the same under all 4 readings: confirmed`, or what the verdict is under which: named by the value of a
/// single choice where that decides, otherwise by the numbers of the readings.
pub(super) fn conclusion(readings: &[Reading], judged: &[(usize, LedgerEntry)], baseline: &str) -> String {
    let verdicts: Vec<(usize, Verdict)> =
        judged.iter().map(|(number, entry)| (*number, entry.verdict)).collect();
    let lacking = match readings.len() - verdicts.len() {
        0 => String::new(),
        k => format!("; no runs of {baseline} with the same settings under {k} more"),
    };
    let first = verdicts[0].1;
    if verdicts.iter().all(|(_, verdict)| *verdict == first) {
        return format!("the same under all {} readings: {}{lacking}", verdicts.len(), first.as_str());
    }
    let under = |parts: Vec<(Verdict, String)>| {
        let part = |(verdict, names): &(Verdict, String)| format!("{} under {names}", verdict.as_str());
        let parts: Vec<String> = parts.iter().map(part).collect();
        format!("hangs on the reading: {}{lacking}", parts.join(", "))
    };
    let varied = readings.first().map_or(&[][..], |reading| &reading.varied);
    if let Some(parts) = varied.iter().find_map(|&choice| by_choice(readings, &verdicts, choice)) {
        return under(parts);
    }
    let of = |verdict: Verdict| {
        let numbers =
            verdicts.iter().filter(|(_, other)| *other == verdict).map(|(number, _)| number.to_string());
        let numbers: Vec<String> = numbers.collect();
        let what = if numbers.len() == 1 { "reading" } else { "readings" };
        (!numbers.is_empty()).then(|| (verdict, format!("{what} {}", numbers.join(", "))))
    };
    under([Verdict::Confirmed, Verdict::Refuted, Verdict::Undecided].into_iter().filter_map(of).collect())
}

/// The verdicts by the values of one choice; `None` where readings of one value have several.
fn by_choice(
    readings: &[Reading],
    verdicts: &[(usize, Verdict)],
    (choice, name): Varied,
) -> Option<Vec<(Verdict, String)>> {
    let mut values: Vec<(Option<&str>, Verdict)> = Vec::new();
    for &(number, verdict) in verdicts {
        for value in readings.get(number - 1)?.values.iter().map(|values| values[choice].as_deref()) {
            match values.iter().find(|(other, _)| *other == value) {
                Some((_, other)) if *other != verdict => return None,
                Some(_) => {}
                None => values.push((value, verdict)),
            }
        }
    }
    let of = |verdict: Verdict| {
        let same = values.iter().filter(|(_, other)| *other == verdict);
        let same: Vec<Option<&str>> = same.map(|(value, _)| *value).collect();
        (!same.is_empty()).then(|| (verdict, setting(name, &same)))
    };
    Some([Verdict::Confirmed, Verdict::Refuted, Verdict::Undecided].into_iter().filter_map(of).collect())
}

/// `states = replay`, `states = reference, replay or initial`; `not set` where a config lacks the field.
pub(super) fn setting(name: &str, values: &[Option<&str>]) -> String {
    let texts: Vec<&str> = values.iter().map(|value| value.unwrap_or("not set")).collect();
    let values = match texts.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} or {last}", rest.join(", ")),
        _ => texts.concat(),
    };
    format!("{name} = {values}")
}
