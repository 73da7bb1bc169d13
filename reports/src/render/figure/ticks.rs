//! Tick positions and labels that people would choose.

/// Multiples of 1, 2 or 5 times a power of ten from 0 up to `max`, at most `most` + 1 of them.
pub(super) fn steps(max: u64, most: u64) -> Vec<f64> {
    let most = most.max(1);
    let mut decade = 1_u64;
    loop {
        for factor in [1, 2, 5] {
            let step = decade.saturating_mul(factor);
            if max / step <= most {
                return (0..=max / step).map(|i| (i * step) as f64).collect();
            }
        }
        decade = decade.saturating_mul(10);
    }
}

/// As [`steps`], for an axis of real numbers, `max` > 0.
pub(super) fn reals(max: f64, most: u64) -> Vec<f64> {
    // The smallest tick is worth about a millionth of the axis; everything else is counted in it.
    let unit = 10_f64.powf(max.log10().floor() - 6.0);
    let scaled = |tick: f64| {
        // Through decimal text, which has no rounding error to show in a label.
        format!("{:.6e}", tick * unit).parse().unwrap_or(tick * unit)
    };
    steps((max / unit + 1e-6) as u64, most).into_iter().map(scaled).collect()
}

/// Round numbers from `low` to `high`, at most `most` + 1 of them, for an axis that need not begin at 0.
pub(super) fn between(low: f64, high: f64, most: u64) -> Vec<f64> {
    let rough = (high - low) / most.max(1) as f64;
    if !(rough.is_finite() && rough > 0.0) {
        return vec![low];
    }
    let decade = 10_f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * decade).into_iter().find(|step| *step >= rough);
    let step = step.unwrap_or(10.0 * decade);
    let (first, last) = ((low / step).ceil() as i64, (high / step).floor() as i64);
    // As many digits as tell neighbours apart.
    let digits = ((low.abs().max(high.abs()) / step).log10().ceil() as usize).clamp(6, 15);
    // Through decimal text, which has no rounding error to show in a label.
    let tick = |i: i64| format!("{:.digits$e}", i as f64 * step).parse().unwrap_or(i as f64 * step);
    (first..=last).map(tick).collect()
}

/// `0`, `0.05`, `-12`, `1.5e-6`, `20k`, `3M`, `4e12`.
pub(super) fn number(value: f64) -> String {
    let size = value.abs();
    match size {
        0.0 => "0".to_owned(),
        _ if !(1e-3..1e10).contains(&size) => format!("{value:e}"),
        _ if size >= 1e4 => format!("{}{}", if value < 0.0 { "-" } else { "" }, label(size)),
        _ => value.to_string(),
    }
}

/// `0`, `500`, `5k`, `12.5k`, `1M`.
pub(super) fn label(steps: f64) -> String {
    match steps {
        s if s >= 1e6 => format!("{}M", s / 1e6),
        s if s >= 1e3 => format!("{}k", s / 1e3),
        s => format!("{s}"),
    }
}

/// Ticks of an axis of shares.
pub(super) fn shares() -> Vec<f64> {
    vec![0.0, 0.2, 0.4, 0.6, 0.8, 1.0]
}

/// `0.2`.
pub(super) fn share_label(share: f64) -> String {
    format!("{share:.1}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        assert_eq!(steps(10_000, 5), [0.0, 2_000.0, 4_000.0, 6_000.0, 8_000.0, 10_000.0]);
        assert_eq!(steps(400_000, 4), [0.0, 100_000.0, 200_000.0, 300_000.0, 400_000.0]);
        assert_eq!(steps(30, 4), [0.0, 10.0, 20.0, 30.0]);
        assert_eq!(steps(0, 4), [0.0]);
        assert_eq!(steps(1, 4), [0.0, 1.0]);
    }

    #[test]
    fn ticks_of_reals_are_round_and_inside() {
        assert_eq!(reals(2.78, 4), [0.0, 1.0, 2.0]);
        assert_eq!(reals(0.05, 5), [0.0, 0.01, 0.02, 0.03, 0.04, 0.05]);
        assert_eq!(reals(13.0, 4), [0.0, 5.0, 10.0]);
    }

    #[test]
    fn ticks_between_any_two_numbers_are_round_and_inside() {
        assert_eq!(between(-3.2, 9.1, 4), [0.0, 5.0]);
        assert_eq!(between(0.013, 0.052, 4), [0.02, 0.03, 0.04, 0.05]);
        assert_eq!(between(-0.2, 0.2, 4), [-0.2, -0.1, 0.0, 0.1, 0.2]);
        assert_eq!(between(1.0, 1.0, 4), [1.0]);
        assert_eq!(between(1e8, 1e8 + 10.0, 4), [1e8, 1e8 + 5.0, 1e8 + 10.0]);
        assert_eq!(between(-3.4e38, 3.4e38, 4), [-2e38, 0.0, 2e38]);
        let labels = [0.0, -5.0, 0.05, 2e-6, 20_000.0, -1.5e6, 1e12].map(number);
        assert_eq!(labels, ["0", "-5", "0.05", "2e-6", "20k", "-1.5M", "1e12"]);
    }

    #[test]
    fn ticks_of_the_largest_count_end() {
        assert!(steps(u64::MAX, 5).len() <= 6);
    }

    #[test]
    fn labels_are_short() {
        let labels: Vec<String> = [0.0, 500.0, 5_000.0, 12_500.0, 1e6, 2.5e6].map(label).to_vec();
        assert_eq!(labels, ["0", "500", "5k", "12.5k", "1M", "2.5M"]);
    }
}
