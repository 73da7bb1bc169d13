//! Which look each curve of a report gets.

use crate::analysis::group::GroupKey;
use looks::colours::{GREY, ORANGE, SKY_BLUE};
use looks::{Dash, Look, Marker, Rgb};

/// Looks of curricula without one of their own, taken in the order of legends and reused from the start when
/// used up.
pub static FALLBACK: &[Look] = &[
    Look::new(ORANGE, Dash::Solid, Marker::Square),
    Look::new(SKY_BLUE, Dash::Long, Marker::Triangle),
    Look::new(ORANGE, Dash::Dotted, Marker::Diamond),
    Look::new(SKY_BLUE, Dash::Short, Marker::Circle),
    Look::new(GREY, Dash::Solid, Marker::Cross),
];

/// Dash patterns in the order in which variants of one curriculum take them.
const DASHES: [Dash; 4] = [Dash::Solid, Dash::Long, Dash::Short, Dash::Dotted];
/// Markers in the order in which variants of one curriculum take them.
const MARKERS: [Marker; 6] =
    [Marker::Circle, Marker::Square, Marker::Triangle, Marker::Diamond, Marker::Cross, Marker::Wedge];
/// Share of black mixed into the first variant's colour, and of white into the last one's.
const DARKEST: f64 = 0.45;
const LIGHTEST: f64 = 0.45;

/// The looks of all curves of a report: one hue per curriculum, and for its variants shades from dark to
/// light with dashes and markers of their own.
#[derive(Debug)]
pub(super) struct Palette<'a> {
    /// One key for each curriculum and variant, in their order; the environment means nothing here.
    methods: Vec<&'a GroupKey>,
    /// The variant that has the plain look of its curriculum.
    plain: &'a str,
}

impl<'a> Palette<'a> {
    /// A palette for curves with these keys.
    pub(super) fn new(keys: impl IntoIterator<Item = &'a GroupKey>) -> Self {
        Self::around(keys, "default")
    }

    /// A palette in which the variant `plain` has the look that the table gives its curriculum, and no other
    /// has.
    pub(super) fn around(keys: impl IntoIterator<Item = &'a GroupKey>, plain: &'a str) -> Self {
        let mut methods: Vec<&GroupKey> = keys.into_iter().collect();
        methods.sort_by(|a, b| a.cmp_method(b));
        methods.dedup_by(|a, b| a.cmp_method(b).is_eq());
        Self { methods, plain }
    }

    /// The look of a curve.
    pub(super) fn look(&self, key: &GroupKey) -> Look {
        let base = key.curriculum.look.unwrap_or_else(|| self.fallback(key));
        if key.variant == self.plain {
            return base;
        }
        let same = |other: &&&GroupKey| other.curriculum == key.curriculum && other.variant != self.plain;
        let variants: Vec<&&GroupKey> = self.methods.iter().filter(same).collect();
        let has_default =
            variants.len() < self.methods.iter().filter(|o| o.curriculum == key.curriculum).count();
        match variants.iter().position(|other| other.variant == key.variant) {
            Some(index) if variants.len() > 1 || has_default => {
                varied(base, index, variants.len(), has_default)
            }
            _ => base,
        }
    }

    /// The look of a curriculum that has none of its own.
    fn fallback(&self, key: &GroupKey) -> Look {
        let mut free: Vec<_> = self.methods.iter().map(|other| &other.curriculum).collect();
        free.retain(|method| method.look.is_none());
        free.dedup();
        let index = free.iter().position(|method| **method == key.curriculum).unwrap_or(0);
        FALLBACK[index % FALLBACK.len()]
    }
}

/// The look of variant `index` of `count`, `beside` the plain look of the default or on their own.
fn varied(base: Look, index: usize, count: usize, beside: bool) -> Look {
    // An even number of tones, none of which is the plain one in the middle: that is the default's alone.
    let tones = count.next_multiple_of(2);
    let position = index as f64 / (tones - 1) as f64;
    let tone = (DARKEST + LIGHTEST) * position - DARKEST;
    let colour =
        if tone < 0.0 { mix(base.colour, (0, 0, 0), -tone) } else { mix(base.colour, (255, 255, 255), tone) };
    let index = index + usize::from(beside);
    let dash = DASHES[index % DASHES.len()];
    let marker = MARKERS[index % MARKERS.len()];
    Look { colour, dash, marker }
}

/// `a (1 - share) + b share`, per channel.
fn mix(a: Rgb, b: Rgb, share: f64) -> Rgb {
    let channel = |a: u8, b: u8| (f64::from(a) + (f64::from(b) - f64::from(a)) * share).round() as u8;
    (channel(a.0, b.0), channel(a.1, b.1), channel(a.2, b.2))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::catalogue::{Catalogue, MethodInfo};

    const LOOK: Look = Look::new((213, 94, 0), Dash::Solid, Marker::Circle);

    fn key(environment: &str, curriculum: &str, variant: &str) -> GroupKey {
        let catalogue = Catalogue::of([MethodInfo::new("nova", "NOVA", Some(LOOK))]);
        GroupKey::new(&catalogue, environment, curriculum, variant)
    }

    #[test]
    fn a_curriculum_looks_the_same_in_every_environment() {
        let keys = [key("A", "zeta", "default"), key("B", "alpha", "default"), key("B", "zeta", "default")];
        let palette = Palette::new(&keys);
        assert_eq!(palette.look(&keys[0]), palette.look(&keys[2]));
        assert_ne!(palette.look(&keys[0]), palette.look(&keys[1]));
    }

    #[test]
    fn a_single_variant_has_the_look_of_the_table() {
        let only = key("A", "nova", "n=3");
        assert_eq!(Palette::new([&only]).look(&only), LOOK);
    }

    #[test]
    fn variants_get_shades_from_dark_to_light() {
        let keys = ["n=3", "n=20", "n=5", "n=10"].map(|variant| key("A", "nova", variant));
        let palette = Palette::new(&keys);
        let red = |index: usize| palette.look(&keys[index]).colour.0;
        assert!(red(0) < red(2) && red(2) < red(3) && red(3) < red(1));
    }

    #[test]
    fn the_default_keeps_the_look_of_the_table_beside_its_variants() {
        let keys = ["default", "n=3", "n=5", "n=20"].map(|variant| key("A", "nova", variant));
        let palette = Palette::new(&keys);
        let looks = keys.each_ref().map(|key| palette.look(key));
        assert_eq!(looks[0], LOOK);
        assert!(
            looks[1..].iter().all(|look| look.colour != looks[0].colour && look.marker != looks[0].marker)
        );
    }

    #[test]
    fn the_plain_look_is_the_default_settings_alone() {
        let keys = ["Δ = 1", "Δ = 2", "Δ = 5", "Δ = 10"].map(|variant| key("A", "nova", variant));
        let colours = |palette: &Palette<'_>| keys.each_ref().map(|key| palette.look(key).colour);
        let palette = Palette::around(&keys, "Δ = 1");
        assert_eq!(palette.look(&keys[0]), LOOK);
        assert!(colours(&palette)[1..].iter().all(|colour| *colour != LOOK.colour));
        // Nor does a level have it where the default was not run.
        let without = Palette::around(&keys[1..], "Δ = 1");
        assert!(keys[1..].iter().all(|key| without.look(key).colour != LOOK.colour));
    }

    #[test]
    fn mixing_by_hand() {
        assert_eq!(mix((0, 100, 200), (100, 200, 0), 0.25), (25, 125, 150));
    }
}
