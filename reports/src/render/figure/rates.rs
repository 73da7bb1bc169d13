//! Axes of rates: from 0 to 1, or zoomed in on what there is to see.

use super::ticks;

/// An axis of rates.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RateAxis {
    /// What stands beside it; says so where it does not span 0 to 1.
    pub(super) name: String,
    /// Ends, in [0, 1].
    pub(super) low: f64,
    pub(super) high: f64,
    pub(super) ticks: Vec<f64>,
    /// Digits of a tick's label.
    pub(super) digits: usize,
}

/// Room around what is zoomed in on, as a share of it.
const ROOM: f64 = 0.05;
/// The smallest span: a flat curve needs a scale, too.
const SMALLEST_SPAN: f64 = 0.02;
/// Most intervals between ticks.
const MOST_TICKS: f64 = 5.0;

impl RateAxis {
    /// The axis `name` from 0 to 1.
    pub(super) fn whole(name: &str) -> Self {
        Self { name: name.to_owned(), low: 0.0, high: 1.0, ticks: ticks::shares(), digits: 1 }
    }

    /// The axis `name`; with `zoom` it spans `values` alone, and says so.
    pub(super) fn of(name: &str, zoom: bool, values: impl IntoIterator<Item = f64>) -> Self {
        let whole = Self::whole(name);
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in values.into_iter().map(|value| value.clamp(0.0, 1.0)) {
            (low, high) = (low.min(value), high.max(value));
        }
        if !zoom || low > high {
            return whole;
        }
        let room = ((high - low) * ROOM).max((SMALLEST_SPAN - (high - low)) / 2.0);
        (low, high) = ((low - room).max(0.0), (high + room).min(1.0));
        let (ticks, digits) = between(low, high);
        if low <= 0.0 && high >= 1.0 {
            return whole;
        }
        Self { name: format!("{name} (zoom)"), low, high, ticks, digits }
    }

    /// What a tick says.
    pub(super) fn label(&self, tick: f64) -> String {
        format!("{tick:.*}", self.digits)
    }
}

/// Multiples of 1, 2 or 5 times a power of ten from `low` to `high`, and the digits that tell them apart.
fn between(low: f64, high: f64) -> (Vec<f64>, usize) {
    let step = |decade: i32, factor: u32| f64::from(factor) * 10_f64.powi(-decade);
    let steps = (1..=6).rev().flat_map(|decade| [1, 2, 5].map(|factor| (decade, step(decade, factor))));
    let mut fitting = steps.filter(|(_, step)| (high - low) / step <= MOST_TICKS);
    let (decade, step) = fitting.next().unwrap_or((1, 0.2));
    let count = |value: f64| value / step;
    let (first, last) = ((count(low) - 1e-9).ceil() as i64, (count(high) + 1e-9).floor() as i64);
    let digits = decade.unsigned_abs() as usize;
    // Through decimal text, so that a tick is the number that it says.
    let tick =
        |index: i64| format!("{:.digits$}", index as f64 * step).parse().unwrap_or(index as f64 * step);
    ((first..=last).map(tick).collect(), digits)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_spans_what_there_is_to_see_and_says_so() {
        let axis = RateAxis::of("Success rate", true, [0.9, 0.95, 1.2]);
        assert_eq!(axis.name, "Success rate (zoom)");
        assert!((axis.low - 0.895).abs() < 1e-9 && (axis.high - 1.0).abs() < 1e-9, "{axis:?}");
        assert_eq!(axis.ticks, [0.9, 0.95, 1.0]);
        assert_eq!(axis.label(axis.ticks[0]), "0.90");
        let low = RateAxis::of("Success rate", true, [0.0, 0.013]);
        assert_eq!((low.low, low.ticks.first(), low.digits), (0.0, Some(&0.0), 3));
    }

    #[test]
    fn without_zoom_or_data_it_is_the_whole() {
        let whole = RateAxis::whole("Success rate");
        assert_eq!(RateAxis::of("Success rate", false, [0.4, 0.5]), whole);
        assert_eq!(RateAxis::of("Success rate", true, []), whole);
        assert_eq!(RateAxis::of("Success rate", true, [0.0, 1.0]), whole);
    }

    #[test]
    fn a_flat_curve_has_a_scale() {
        for rate in [0.0, 0.5, 1.0] {
            let axis = RateAxis::of("Success rate", true, [rate, rate]);
            assert!(axis.high - axis.low >= SMALLEST_SPAN / 2.0 - 1e-12, "{axis:?}");
            assert!(axis.ticks.len() > 1 && axis.low <= rate && rate <= axis.high, "{axis:?}");
        }
    }
}
