//! Methods that bring a look can be told apart in a figure, also where it is printed in grey.

use curricula::CURRICULA;
use looks::{Look, Rgb};

/// The grey of a colour, by the weights of ITU-R BT.601.
fn luma((red, green, blue): Rgb) -> f64 {
    0.299 * f64::from(red) + 0.587 * f64::from(green) + 0.114 * f64::from(blue)
}

/// The methods whose id `is` one of those asked for, with their looks.
fn looks(is: impl Fn(&str) -> bool) -> Vec<(&'static str, Look)> {
    CURRICULA.iter().filter(|entry| is(entry.id)).filter_map(|entry| Some((entry.id, entry.look?))).collect()
}

#[test]
fn no_two_methods_look_alike() {
    let looks = looks(|_| true);
    for (i, (a, of_a)) in looks.iter().enumerate() {
        for (b, of_b) in &looks[i + 1..] {
            let differ = [of_a.colour != of_b.colour, of_a.dash != of_b.dash, of_a.marker != of_b.marker];
            let differences = differ.iter().filter(|&&differ| differ).count();
            assert!(differences >= 2, "{a} and {b} differ in less than two of colour, dash and marker");
        }
    }
}

/// Those of TEACH's comparison, which share a figure most often, and the control.
#[test]
fn methods_of_the_paper_differ_in_colour_dash_marker_and_grey() {
    let of_it = ["teach", "vds", "space", "procurl", "her-iid", "her-iid-pool"];
    let looks = looks(|id| of_it.contains(&id));
    assert_eq!(looks.len(), of_it.len());
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
