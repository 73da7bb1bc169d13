//! Cells of tables to read.

/// A cell without a number.
pub(crate) const UNDEFINED: &str = "–";

/// What captions say of bootstrap intervals over few seeds (measured by
/// `bootstrap_intervals_of_few_seeds_cover_less`).
pub(crate) const BOOTSTRAP_COVERAGE: &str =
    "such an interval of a mean of 5 seeds covers about 83 % at a nominal 95 %, of 7 seeds 88 %";

/// A value as text, or a cell without a number.
pub(crate) fn or_undefined<T>(value: Option<T>, text: impl FnOnce(T) -> String) -> String {
    value.map_or(UNDEFINED.into(), text)
}

/// A range of steps, or the step where both ends are equal.
pub(crate) fn span((low, high): (u64, u64)) -> String {
    if low == high { thousands(low) } else { format!("{} to {}", thousands(low), thousands(high)) }
}

/// Two decimals, without the sign of a rounded zero.
pub(crate) fn decimal(value: f64) -> String {
    let text = format!("{value:.2}");
    if text == "-0.00" { "0.00".into() } else { text }
}

/// Three digits, or how small it is at least.
pub(crate) fn p_value(p: f64) -> String {
    if p < 0.001 { "< 0.001".into() } else { format!("{p:.3}") }
}

/// `0.50 ± 0.10`; the mean alone where it has no standard deviation.
pub(crate) fn with_spread(mean: Option<f64>, std: Option<f64>) -> String {
    let spread = |std| format!(" ± {}", decimal(std));
    or_undefined(mean, |mean| decimal(mean) + &std.map_or(String::new(), spread))
}

/// `0.50 [0.40, 0.60]`; the value alone where it has no interval.
pub(crate) fn with_interval(value: f64, interval: Option<(f64, f64)>) -> String {
    let brackets = |(low, high)| format!(" [{}, {}]", decimal(low), decimal(high));
    decimal(value) + &interval.map_or(String::new(), brackets)
}

/// `1,000,000`.
pub(crate) fn thousands(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::with_capacity(digits.len() * 4 / 3);
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_grouped() {
        assert_eq!([0, 999, 1_000, 1_234_567].map(thousands), ["0", "999", "1,000", "1,234,567"]);
    }

    #[test]
    fn a_rounded_zero_has_no_sign() {
        assert_eq!(with_interval(-1e-17, Some((-0.2, 0.204))), "0.00 [-0.20, 0.20]");
    }
}
