//! Which look each curve of a report gets.

use crate::analysis::group::GroupKey;
use looks::{Dash, Look, Marker, Rgb};

use crate::methods::{self, FALLBACK};

/// Dash patterns in the order in which variants of one curriculum take them.
const DASHES: [Dash; 4] = [Dash::Solid, Dash::Long, Dash::Short, Dash::Dotted];
/// Markers in the order in which variants of one curriculum take them.
const MARKERS: [Marker; 6] =
    [Marker::Circle, Marker::Square, Marker::Triangle, Marker::Diamond, Marker::Cross, Marker::Wedge];
/// Share of black mixed into the first variant's colour, and of white into the last one's.
const DARKEST: f64 = 0.45;
const LIGHTEST: f64 = 0.45;

/// The looks of all curves of a report: one hue per curriculum, and for its variants shades from dark to light
/// with dashes and markers of their own.
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

    /// A palette in which the variant `plain` has the look that the table gives its curriculum, and no other has.
    pub(super) fn around(keys: impl IntoIterator<Item = &'a GroupKey>, plain: &'a str) -> Self {
        let mut methods: Vec<&GroupKey> = keys.into_iter().collect();
        methods.sort_by(|a, b| a.cmp_method(b));
        methods.dedup_by(|a, b| a.cmp_method(b).is_eq());
        Self { methods, plain }
    }

    /// The look of a curve.
    pub(super) fn look(&self, key: &GroupKey) -> Look {
        let base = methods::method(&key.curriculum).map_or_else(|| self.fallback(key), |method| method.look);
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

    /// The look of a curriculum without a row in the table.
    fn fallback(&self, key: &GroupKey) -> Look {
        let mut unknown: Vec<&str> = self.methods.iter().map(|other| other.curriculum.as_str()).collect();
        unknown.retain(|id| methods::method(id).is_none());
        unknown.dedup();
        let index = unknown.iter().position(|id| *id == key.curriculum).unwrap_or(0);
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

    fn key(environment: &str, curriculum: &str, variant: &str) -> GroupKey {
        GroupKey { environment: environment.into(), curriculum: curriculum.into(), variant: variant.into() }
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
        let only = key("A", "teach", "n=3");
        assert_eq!(Some(Palette::new([&only]).look(&only)), methods::method("teach").map(|row| row.look));
    }

    #[test]
    fn variants_get_shades_from_dark_to_light() {
        let keys = ["n=3", "n=20", "n=5", "n=10"].map(|variant| key("A", "teach", variant));
        let palette = Palette::new(&keys);
        let red = |index: usize| palette.look(&keys[index]).colour.0;
        assert!(red(0) < red(2) && red(2) < red(3) && red(3) < red(1));
    }

    #[test]
    fn the_default_keeps_the_look_of_the_table_beside_its_variants() {
        let keys = ["default", "n=3", "n=5", "n=20"].map(|variant| key("A", "teach", variant));
        let palette = Palette::new(&keys);
        let looks = keys.each_ref().map(|key| palette.look(key));
        assert_eq!(Some(looks[0]), methods::method("teach").map(|row| row.look));
        assert!(
            looks[1..].iter().all(|look| look.colour != looks[0].colour && look.marker != looks[0].marker)
        );
    }

    #[test]
    fn the_plain_look_is_the_default_settings_alone() {
        let keys = ["Δ = 1", "Δ = 2", "Δ = 5", "Δ = 10"].map(|variant| key("A", "teach", variant));
        let plain = methods::method("teach").map(|row| row.look);
        let colours = |palette: &Palette<'_>| keys.each_ref().map(|key| palette.look(key).colour);
        let palette = Palette::around(&keys, "Δ = 1");
        assert_eq!(Some(palette.look(&keys[0])), plain);
        assert!(colours(&palette)[1..].iter().all(|colour| Some(*colour) != plain.map(|look| look.colour)));
        // Nor does a level have it where the default was not run.
        let without = Palette::around(&keys[1..], "Δ = 1");
        assert!(keys[1..].iter().all(|key| Some(without.look(key).colour) != plain.map(|look| look.colour)));
    }

    #[test]
    fn mixing_by_hand() {
        assert_eq!(mix((0, 100, 200), (100, 200, 0), 0.25), (25, 125, 150));
    }
}
