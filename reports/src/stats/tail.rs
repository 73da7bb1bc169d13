//! The worst part of a distribution.

/// Conditional value at risk: the mean of the lowest share `alpha` of the values, in (0, 1]. The value at the
/// border counts with the part of it that belongs to that share, so that the answer is continuous in `alpha`
/// (Rockafellar and Uryasev 2002). `None` for no values or an `alpha` outside its range.
///
/// ```
/// // A quarter of six values are one and a half of them: (0.1 + 0.5 · 0.4) / 1.5.
/// let cvar = reports::stats::cvar(&[0.9, 0.1, 0.8, 0.4, 1.0, 0.7], 0.25);
/// assert!((cvar.expect("six values") - 0.2).abs() < 1e-12);
/// ```
pub fn cvar(values: &[f64], alpha: f64) -> Option<f64> {
    if values.is_empty() || !(alpha > 0.0 && alpha <= 1.0) {
        return None;
    }
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let share = alpha * sorted.len() as f64;
    let weighted =
        (0..).zip(&sorted).map(|(index, value)| value * (share - f64::from(index)).clamp(0.0, 1.0));
    Some(weighted.sum::<f64>() / share)
}

#[cfg(test)]
mod tests {
    use super::cvar;

    #[test]
    fn tails_by_hand() {
        let values = [0.5, 0.0, 1.0, 0.25];
        let close = |alpha, expected: f64| {
            let found = cvar(&values, alpha).expect("four values");
            assert!((found - expected).abs() < 1e-12, "{alpha}: {found}");
        };
        close(0.25, 0.0);
        close(0.5, 0.125);
        // One and a half values: (0 + 0.5 · 0.25) / 1.5.
        close(0.375, 1.0 / 12.0);
        close(1.0, 0.4375);
        // Less than one value is the lowest.
        close(0.1, 0.0);
        assert_eq!(cvar(&[0.3], 0.1), Some(0.3));
    }

    #[test]
    fn nothing_has_no_tail() {
        assert_eq!(cvar(&[], 0.5), None);
        assert_eq!([0.0, 1.5, f64::NAN].map(|alpha| cvar(&[0.5], alpha)), [None; 3]);
    }
}
