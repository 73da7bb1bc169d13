//! Methods that bring a look can be told apart in a figure, also where it is printed in grey.

use curricula::CURRICULA;
use looks::{Look, Rgb};

/// The grey of a colour, by the weights of ITU-R BT.601.
fn luma((red, green, blue): Rgb) -> f64 {
    0.299 * f64::from(red) + 0.587 * f64::from(green) + 0.114 * f64::from(blue)
}

#[test]
fn methods_differ_in_colour_dash_marker_and_grey() {
    let looks: Vec<(&str, Look)> =
        CURRICULA.iter().filter_map(|entry| Some((entry.id, entry.look?))).collect();
    for (i, (a, of_a)) in looks.iter().enumerate() {
        for (b, of_b) in &looks[i + 1..] {
            assert_ne!(of_a.colour, of_b.colour, "{a} and {b}");
            assert_ne!(of_a.dash, of_b.dash, "{a} and {b}");
            assert_ne!(of_a.marker, of_b.marker, "{a} and {b}");
            let gap = (luma(of_a.colour) - luma(of_b.colour)).abs();
            assert!(gap >= 15.0, "{a} and {b} differ by {gap} of 255 in grey");
        }
    }
}
