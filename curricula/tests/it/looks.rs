//! Methods that bring a look can be told apart in a figure, also where it is printed in grey.

use curricula::CURRICULA;
use looks::{Look, Rgb};

/// The grey of a colour, by the weights of ITU-R BT.601.
fn luma((red, green, blue): Rgb) -> f64 {
    0.299 * f64::from(red) + 0.587 * f64::from(green) + 0.114 * f64::from(blue)
}

#[test]
fn methods_differ_in_colour_and_in_two_of_dash_marker_and_grey() {
    let looks: Vec<(&str, Look)> =
        CURRICULA.iter().filter_map(|entry| Some((entry.id, entry.look?))).collect();
    // A program of the user's own looks as the report chooses.
    let methods = CURRICULA.iter().filter(|entry| entry.needs.is_none()).count();
    assert_eq!(looks.len(), methods, "every method here has a look");
    for (i, (a, of_a)) in looks.iter().enumerate() {
        for (b, of_b) in &looks[i + 1..] {
            let [ours, theirs] = [of_a, of_b].map(|look| <[u8; 3]>::from(look.colour));
            let is_other = ours.iter().zip(theirs).any(|(x, y)| x.abs_diff(y) >= 40);
            assert!(is_other, "{a} and {b} have nearly the same colour");
            let gap = (luma(of_a.colour) - luma(of_b.colour)).abs();
            let told_apart = [of_a.dash != of_b.dash, of_a.marker != of_b.marker, gap >= 15.0];
            let ways = told_apart.into_iter().filter(|way| *way).count();
            assert!(ways >= 2, "{a} and {b}: dash, marker and grey (by {gap} of 255) differ in {ways} only");
        }
    }
}

#[test]
fn methods_stand_out_from_paper_and_grid() {
    // Contrast with white as WCAG 2.2 defines it, whose criterion 1.4.11 asks for 3:1 of what must be seen.
    let linear = |channel: u8| {
        let share = f64::from(channel) / 255.0;
        if share <= 0.040_45 { share / 12.92 } else { ((share + 0.055) / 1.055).powf(2.4) }
    };
    for (method, look) in CURRICULA.iter().filter_map(|method| Some((method, method.look?))) {
        let (r, g, b) = look.colour;
        let luminance = 0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b);
        let contrast = 1.05 / (luminance + 0.05);
        assert!(contrast >= 3.0, "{} has a contrast of {contrast:.2} to 1", method.id);
    }
}
