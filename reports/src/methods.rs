//! The curricula that figures and tables know by name: their titles, order and looks.
//!
//! The table is the single place that ties a curriculum to a colour, so a method looks the same in every figure.
//! A curriculum that is not in it is shown by its id, after the known ones, in one of the [`FALLBACK`] looks.

use std::cmp::Ordering;

use looks::colours::{BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, SKY_BLUE, VERMILION};
use looks::{Dash, Look, Marker};

/// A row of [`METHODS`].
#[derive(Clone, Copy, Debug)]
pub struct Method {
    /// Curriculum id, as in records.
    pub id: &'static str,
    /// Name in figures and tables.
    pub title: &'static str,
    /// How its curves are drawn.
    pub look: Look,
}

/// Every known curriculum, in the order of legends and tables.
pub static METHODS: &[Method] = &[
    Method { id: "teach", title: "TEACH", look: Look::new(VERMILION, Dash::Solid, Marker::Circle) },
    Method { id: "vds", title: "VDS", look: Look::new(BLUE, Dash::Long, Marker::Square) },
    Method { id: "procurl", title: "ProCuRL", look: Look::new(GREEN, Dash::Short, Marker::Triangle) },
    Method { id: "space", title: "SPaCE", look: Look::new(PURPLE, Dash::DashDot, Marker::Diamond) },
    Method { id: "her-iid", title: "HER-IID", look: Look::new(BLACK, Dash::Dotted, Marker::Cross) },
    Method { id: "her-iid-pool", title: "HER-IID-pool", look: Look::new(GREY, Dash::Sparse, Marker::Wedge) },
];

/// Looks of curricula without a row, taken in the order of their ids and reused from the start when used up.
pub static FALLBACK: &[Look] = &[
    Look::new(ORANGE, Dash::Solid, Marker::Square),
    Look::new(SKY_BLUE, Dash::Long, Marker::Triangle),
    Look::new(ORANGE, Dash::Dotted, Marker::Diamond),
    Look::new(SKY_BLUE, Dash::Short, Marker::Circle),
    Look::new(GREY, Dash::Solid, Marker::Cross),
];

/// The row of a curriculum, if it has one.
pub fn method(id: &str) -> Option<&'static Method> {
    METHODS.iter().find(|method| method.id == id)
}

/// Name of a curriculum in figures and tables.
pub fn title(id: &str) -> &str {
    method(id).map_or(id, |method| method.title)
}

/// Order of curricula: rows of the table first, then the others by id.
pub fn order(a: &str, b: &str) -> Ordering {
    let rank = |id: &str| METHODS.iter().position(|method| method.id == id).unwrap_or(METHODS.len());
    rank(a).cmp(&rank(b)).then_with(|| natural_order(a, b))
}

/// Order in which `n=3` comes before `n=10`: runs of digits compare as numbers, everything else byte by byte.
pub fn natural_order(a: &str, b: &str) -> Ordering {
    let (mut left, mut right) = (a, b);
    while let (Some(x), Some(y)) = (left.chars().next(), right.chars().next()) {
        if x.is_ascii_digit() && y.is_ascii_digit() {
            let (x, rest_x) = split_number(left);
            let (y, rest_y) = split_number(right);
            // Without leading zeros, the longer number is the larger one.
            let order = x.len().cmp(&y.len()).then_with(|| x.cmp(y));
            if order != Ordering::Equal {
                return order;
            }
            (left, right) = (rest_x, rest_y);
        } else if x != y {
            return x.cmp(&y);
        } else {
            (left, right) = (&left[x.len_utf8()..], &right[y.len_utf8()..]);
        }
    }
    // `01` and `1` are equal as numbers but are different names.
    left.len().cmp(&right.len()).then_with(|| a.cmp(b))
}

/// The digits at the start, without leading zeros, and what follows them.
fn split_number(text: &str) -> (&str, &str) {
    let end = text.find(|c: char| !c.is_ascii_digit()).unwrap_or(text.len());
    (text[..end].trim_start_matches('0'), &text[end..])
}

#[cfg(test)]
mod tests {
    use looks::Rgb;

    use super::*;

    /// The grey of a colour, by the weights of ITU-R BT.601.
    fn luma((red, green, blue): Rgb) -> f64 {
        0.299 * f64::from(red) + 0.587 * f64::from(green) + 0.114 * f64::from(blue)
    }

    #[test]
    fn known_methods_differ_in_colour_and_in_grey() {
        for (i, a) in METHODS.iter().enumerate() {
            for b in &METHODS[i + 1..] {
                assert_ne!(a.id, b.id);
                assert_ne!(a.look.colour, b.look.colour, "{} and {}", a.id, b.id);
                assert_ne!(a.look.marker, b.look.marker, "{} and {}", a.id, b.id);
                assert_ne!(a.look.dash, b.look.dash, "{} and {}", a.id, b.id);
                let gap = (luma(a.look.colour) - luma(b.look.colour)).abs();
                assert!(gap >= 15.0, "{} and {} differ by {gap} of 255 in grey", a.id, b.id);
            }
        }
    }

    #[test]
    fn fallback_looks_are_not_those_of_known_methods() {
        for (i, look) in FALLBACK.iter().enumerate() {
            assert!(METHODS.iter().all(|method| method.look != *look));
            assert!(!FALLBACK[..i].contains(look));
        }
    }

    #[test]
    fn numbers_in_names_compare_as_numbers() {
        let mut names = ["n=20", "n=3", "n=10", "n=3b", "n", "m=5"];
        names.sort_by(|a, b| natural_order(a, b));
        assert_eq!(names, ["m=5", "n", "n=3", "n=3b", "n=10", "n=20"]);
        assert_ne!(natural_order("n=01", "n=1"), Ordering::Equal);
    }

    #[test]
    fn unknown_curricula_come_last() {
        let mut ids = ["zeta", "her-iid", "alpha", "teach"];
        ids.sort_by(|a, b| order(a, b));
        assert_eq!(ids, ["teach", "her-iid", "alpha", "zeta"]);
        assert_eq!(title("alpha"), "alpha");
    }
}
