//! Numbers with their nouns, for every message.

/// `1 run`, `2 runs`: a number with its noun, which is given in the singular.
///
/// ```
/// use reports::wording::counted;
///
/// assert_eq!([0, 1, 2].map(|runs| counted(runs, "open run")), ["0 open runs", "1 open run", "2 open runs"]);
/// assert_eq!([1, 2].map(|crashes| counted(crashes, "crash")), ["1 crash", "2 crashes"]);
/// ```
pub fn counted(number: usize, noun: &str) -> String {
    counted_u64(number as u64, noun)
}

/// The same for 64-bit counts, such as training steps.
pub fn counted_u64(number: u64, noun: &str) -> String {
    let ending = match noun {
        _ if number == 1 => "",
        noun if ["s", "sh", "ch", "x"].iter().any(|end| noun.ends_with(end)) => "es",
        _ => "s",
    };
    format!("{number} {noun}{ending}")
}

/// The verb after a number: `is` after 1, `are` after any other.
pub fn is_or_are(number: usize) -> &'static str {
    if number == 1 { "is" } else { "are" }
}
