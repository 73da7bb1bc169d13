//! Cells of tables to read.

/// A cell without a number.
pub(crate) const UNDEFINED: &str = "–";

/// What captions say of bootstrap intervals over few seeds (measured by
/// `bootstrap_intervals_of_few_seeds_cover_less`).
pub(crate) const BOOTSTRAP_COVERAGE: &str = "such an interval of a mean of 2 seeds covers about 51 % at a nominal 95 %, of 3 seeds 77 %, of 5 seeds 83 %, of \
     7 seeds 88 %";

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
    decimals(value, 2)
}

fn decimals(value: f64, digits: usize) -> String {
    let text = format!("{value:.digits$}");
    if text.trim_start_matches(['-', '0', '.']).is_empty() {
        text.trim_start_matches('-').into()
    } else {
        text
    }
}

/// `1.25 h`, `12 min`, `3.4 s`: hours in the unit that fits them.
pub(crate) fn duration(hours: f64) -> String {
    let (value, unit) = match hours * 3600.0 {
        seconds if seconds < 100.0 => (seconds, "s"),
        seconds if seconds < 6000.0 => (seconds / 60.0, "min"),
        _ => (hours, "h"),
    };
    let digits = if value == 0.0 || value >= 100.0 {
        0
    } else if value >= 10.0 {
        1
    } else {
        2
    };
    format!("{value:.digits$} {unit}")
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
    in_brackets(value, interval, 2)
}

/// `-0.023 [-0.034, -0.012]`: of differences, which are small where methods are alike.
pub(crate) fn with_fine_interval(value: f64, interval: Option<(f64, f64)>) -> String {
    in_brackets(value, interval, 3)
}

fn in_brackets(value: f64, interval: Option<(f64, f64)>, digits: usize) -> String {
    let brackets = |(low, high)| format!(" [{}, {}]", decimals(low, digits), decimals(high, digits));
    decimals(value, digits) + &interval.map_or(String::new(), brackets)
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
    fn times_have_units_that_fit() {
        let said = [0.0, 0.5, 34.25, 99.0, 120.0, 754.0, 5_400.0, 9_000.0, 86_400.0, 720_000.0]
            .map(|seconds| duration(seconds / 3600.0));
        let expected = [
            "0 s", "0.50 s", "34.2 s", "99.0 s", "2.00 min", "12.6 min", "90.0 min", "2.50 h", "24.0 h",
            "200 h",
        ];
        assert_eq!(said, expected);
    }

    #[test]
    fn a_rounded_zero_has_no_sign() {
        assert_eq!(with_interval(-1e-17, Some((-0.2, 0.204))), "0.00 [-0.20, 0.20]");
        let fine = with_fine_interval(-0.0004, Some((-0.0006, 0.0101)));
        assert_eq!(fine, "0.000 [-0.001, 0.010]", "an end that is not 0 is not written as 0");
    }
}
