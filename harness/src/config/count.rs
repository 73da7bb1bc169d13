//! Counts as people write them: `100000`, `100_000`, `1e5`, `100k`, `1.5M`.

/// The largest count that a float holds exactly, as every smaller one.
const EXACT: f64 = 9_007_199_254_740_992.0;

/// What is accepted where a count is asked for.
pub const ACCEPTED: &str = "a whole number such as 100000, 1e5 or 100k";

/// The count that `text` stands for: digits with `_` between them, an exponent, or one of the endings `k`
/// (thousand) and `M` (million), with blanks around. `None` for anything else, for what is not whole, and for
/// what is too large for a count.
pub fn parse(text: &str) -> Option<u64> {
    let plain = text.trim().replace('_', "");
    if !plain.starts_with(|c: char| c.is_ascii_digit()) {
        return None;
    }
    if let Ok(count) = plain.parse() {
        return Some(count);
    }
    let (digits, unit) = match plain.char_indices().last() {
        Some((end, 'k' | 'K')) => (&plain[..end], 1e3),
        Some((end, 'm' | 'M')) => (&plain[..end], 1e6),
        _ => (plain.as_str(), 1.0),
    };
    let is_decimal = digits.chars().all(|c| c.is_ascii_digit() || ".eE+".contains(c));
    let number: f64 = digits.parse().ok()?;
    if is_decimal { whole(number * unit) } else { None }
}

/// A float as the count that it is, if it is one.
pub fn whole(number: f64) -> Option<u64> {
    let is_count = number >= 0.0 && number.fract() == 0.0 && number <= EXACT;
    is_count.then_some(number as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_read_as_people_write_them() {
        for (text, count) in [
            ("0", 0),
            ("100000", 100_000),
            ("100_000", 100_000),
            ("1e5", 100_000),
            ("1E5", 100_000),
            ("2.5e3", 2_500),
            ("1e+3", 1_000),
            ("100k", 100_000),
            ("0.5k", 500),
            ("1.5M", 1_500_000),
            (" 7 ", 7),
            ("18446744073709551615", u64::MAX),
        ] {
            assert_eq!(parse(text), Some(count), "{text}");
        }
    }

    #[test]
    fn what_is_no_count_is_refused() {
        for text in [
            "", "k", "-1", "+1", "1.5", "1e-3", "1e400", "1e17", "nan", "inf", "x", "5x", "1 000", "1kk",
            "0x10",
        ] {
            assert_eq!(parse(text), None, "{text}");
        }
    }
}
