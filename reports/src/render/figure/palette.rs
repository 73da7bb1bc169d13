//! Which look each curve of a report gets.
//!
//! Looks are settled once for a whole report: a method, a variant or a level of an ablation has the same one
//! in every figure, and no two of them share one.

use std::collections::BTreeMap;

use crate::analysis::catalogue::MethodInfo;
use crate::analysis::group::GroupKey;
use crate::analysis::levels::LevelVariant;
use looks::colours::{GREY, ORANGE, SKY_BLUE};
use looks::{Dash, Look, Marker, Rgb};

/// Looks of curricula without one of their own, taken in the order of legends. Where they are used up, or
/// somebody has brought the same, looks are varied until they are nobody's.
pub static FALLBACK: &[Look] = &[
    Look::new(ORANGE, Dash::Solid, Marker::Square),
    Look::new(SKY_BLUE, Dash::Long, Marker::Triangle),
    Look::new(ORANGE, Dash::Dotted, Marker::Diamond),
    Look::new(SKY_BLUE, Dash::Short, Marker::Circle),
    Look::new(GREY, Dash::Solid, Marker::Cross),
];

/// Dash patterns in the order in which variants of one curriculum take them.
const DASHES: [Dash; 6] = [Dash::Solid, Dash::Long, Dash::Short, Dash::Dotted, Dash::DashDot, Dash::Sparse];
/// Markers in the order in which variants of one curriculum take them.
const MARKERS: [Marker; 6] =
    [Marker::Circle, Marker::Square, Marker::Triangle, Marker::Diamond, Marker::Cross, Marker::Wedge];
/// Shades of variants: the share of black mixed into the first one's colour (below 0), and of white into the
/// last one's. Black has no darker shade.
const SHADES: (f64, f64) = (-0.45, 0.45);
const SHADES_OF_BLACK: (f64, f64) = (0.25, 0.6);
/// A colour is black here whose channels are all below this.
const BLACKEST: u8 = 48;
/// Colours that differ by less in every channel look the same.
const ONE_COLOUR: u8 = 40;

/// The looks of all curves of a report: one hue per curriculum, and for its variants shades from dark to
/// light with dashes and markers of their own.
#[derive(Clone, Debug)]
pub struct Palette {
    /// Looks by curriculum id and variant.
    variants: BTreeMap<(String, String), Look>,
    /// Looks by curriculum id and level of an ablation.
    levels: BTreeMap<(String, String), Look>,
}

impl Palette {
    /// A palette for curves with these keys.
    pub fn new<'a>(keys: impl IntoIterator<Item = &'a GroupKey>) -> Self {
        Self::with_levels(keys, &[])
    }

    /// The same, with levels of ablations: one that a variant stands for has that variant's look.
    pub fn with_levels<'a>(keys: impl IntoIterator<Item = &'a GroupKey>, levels: &[LevelVariant]) -> Self {
        let mut methods: Vec<&GroupKey> = keys.into_iter().collect();
        methods.sort_by(|a, b| a.cmp_method(b));
        methods.dedup_by(|a, b| a.cmp_method(b).is_eq());
        let by_curriculum: Vec<&[&GroupKey]> =
            methods.chunk_by(|a, b| a.curriculum == b.curriculum).collect();
        let mut taken = Vec::new();
        let bases = bases(by_curriculum.iter().map(|keys| &*keys[0].curriculum), &mut taken);
        let mut palette = Self { variants: BTreeMap::new(), levels: BTreeMap::new() };
        for (keys, base) in by_curriculum.into_iter().zip(bases) {
            palette.add(keys, levels, base, &mut taken);
        }
        palette
    }

    /// The variants of one curriculum, and the levels of its ablations.
    fn add(&mut self, keys: &[&GroupKey], levels: &[LevelVariant], base: Look, taken: &mut Vec<Look>) {
        let id = keys[0].curriculum.id.as_str();
        let levels = || levels.iter().filter(|level| level.curriculum == id);
        let plain = plain(keys, levels());
        if let Some(variant) = plain {
            self.variants.insert((id.to_owned(), variant.to_owned()), base);
        }
        let others = keys.iter().map(|key| key.variant.as_str()).filter(|variant| Some(*variant) != plain);
        let variants = others.map(|name| {
            let levels = levels().filter(|level| level.variant.as_deref() == Some(name));
            Curve { name, is_level: false, levels: levels.collect() }
        });
        let own = levels().filter(|level| level.variant.is_none());
        let own = own.map(|level| Curve { name: &level.name, is_level: true, levels: vec![level] });
        let mut curves: Vec<Curve<'_>> = variants.chain(own).collect();
        // Stable: those of an axis come together, those on none at the end.
        curves.sort_by_key(Curve::main_axis);
        let (mut index, mut placed) = (0, Vec::<(Vec<usize>, Look)>::new());
        for together in curves.chunk_by(|a, b| a.main_axis() == b.main_axis()) {
            for (place, curve) in together.iter().enumerate() {
                index += 1;
                let axes = curve.axes();
                let is_beside =
                    |(others, _): &&(Vec<usize>, Look)| others.iter().any(|axis| axes.contains(axis));
                let beside: Vec<Look> = [base]
                    .into_iter()
                    .chain(placed.iter().filter(is_beside).map(|(_, look)| *look))
                    .collect();
                let look = free(shade(base.colour, place, together.len()), index, taken, &beside);
                taken.push(look);
                placed.push((axes, look));
                let looks = if curve.is_level { &mut self.levels } else { &mut self.variants };
                looks.insert((id.to_owned(), curve.name.to_owned()), look);
            }
        }
        for level in levels() {
            let variant = level.variant.as_ref().map(|variant| (id.to_owned(), variant.clone()));
            if let Some(look) = variant.and_then(|variant| self.variants.get(&variant)) {
                self.levels.insert((id.to_owned(), level.name.clone()), *look);
            }
        }
    }

    /// The look of a curve whose key the palette was made with.
    pub fn look(&self, key: &GroupKey) -> Look {
        let found = self.variants.get(&(key.curriculum.id.clone(), key.variant.clone()));
        found.copied().or(key.curriculum.look).unwrap_or(FALLBACK[0])
    }

    /// The look of a level of an ablation, which stands in the place of the key's variant.
    pub(super) fn level(&self, key: &GroupKey) -> Look {
        let found = self.levels.get(&(key.curriculum.id.clone(), key.variant.clone()));
        found.copied().unwrap_or_else(|| self.look(key))
    }
}

/// A curve of a curriculum beside its plain one: a variant, or a level that no variant stands for.
struct Curve<'a> {
    name: &'a str,
    is_level: bool,
    /// The levels that it is drawn for.
    levels: Vec<&'a LevelVariant>,
}

impl Curve<'_> {
    /// The axes whose figures show it; one past all of them for a variant that lies on none.
    fn axes(&self) -> Vec<usize> {
        let axes: Vec<usize> = self.levels.iter().map(|level| level.axis).collect();
        if axes.is_empty() { vec![usize::MAX] } else { axes }
    }

    /// The axis along which it departs from the paper's own value.
    fn main_axis(&self) -> usize {
        self.levels.iter().find(|level| !level.is_reference).map_or(usize::MAX, |level| level.axis)
    }
}

/// The variant that has the plain look of its curriculum: `default`, or what an ablation has in its place, or
/// the only one there is.
fn plain<'a>(keys: &[&'a GroupKey], levels: impl Iterator<Item = &'a LevelVariant>) -> Option<&'a str> {
    let mut variants = keys.iter().map(|key| key.variant.as_str());
    let references = levels.filter(|level| level.is_reference && level.variant.is_some());
    let reference =
        references.min_by_key(|level| level.deviations).and_then(|level| level.variant.as_deref());
    variants.clone().find(|variant| *variant == "default").or(reference).or_else(|| {
        let first = variants.next();
        first.filter(|_| variants.next().is_none())
    })
}

/// The plain look of every curriculum: its own, unless that is taken.
fn bases<'a>(methods: impl Iterator<Item = &'a MethodInfo> + Clone, taken: &mut Vec<Look>) -> Vec<Look> {
    let own = methods.clone().map(|method| {
        let look = method.look.filter(|look| taken.iter().all(|other| differences(look, other) > 0))?;
        taken.push(look);
        Some(look)
    });
    let own: Vec<Option<Look>> = own.collect();
    let mut next = 0..;
    let other = |(method, look): (&MethodInfo, Option<Look>)| {
        look.unwrap_or_else(|| {
            // A guest keeps the hue of its method.
            let own =
                method.look.filter(|_| method.origin.is_some()).map(|own| free(own.colour, 1, taken, &[]));
            let spare = FALLBACK.iter().find(|look| taken.iter().all(|other| differences(look, other) > 0));
            let index: usize = next.next().unwrap_or(0);
            let hue = FALLBACK[index % FALLBACK.len()].colour;
            let look = own.or(spare.copied()).unwrap_or_else(|| free(hue, index, taken, &[]));
            taken.push(look);
            look
        })
    };
    methods.zip(own).map(other).collect()
}

/// In how many of colour, dashes and marker two looks differ.
fn differences(a: &Look, b: &Look) -> usize {
    let channels = [(a.colour.0, b.colour.0), (a.colour.1, b.colour.1), (a.colour.2, b.colour.2)];
    let is_other_colour = channels.iter().any(|(a, b)| a.abs_diff(*b) >= ONE_COLOUR);
    [is_other_colour, a.dash != b.dash, a.marker != b.marker].into_iter().filter(|differs| *differs).count()
}

/// A look of this colour that differs from all `taken` ones in two things, or else in one, and from all that
/// can be told apart no longer at least as far as numbers go. If possible it has neither the dashes nor the
/// marker of one that stands `beside` it. Dashes and markers are tried from number `index` on.
fn free(colour: Rgb, index: usize, taken: &[Look], beside: &[Look]) -> Look {
    let candidates = (0..DASHES.len() * MARKERS.len()).map(|shift| Look {
        colour,
        dash: DASHES[(index + shift) % DASHES.len()],
        marker: MARKERS[(index + shift + shift / DASHES.len()) % MARKERS.len()],
    });
    let is_apart = |look: &Look, fewest| taken.iter().all(|other| differences(look, other) >= fewest);
    let apart = |fewest: usize| candidates.clone().find(|look| is_apart(look, fewest));
    let stands_out = |look: &Look| {
        beside.iter().all(|other| look.dash != other.dash && look.marker != other.marker) && is_apart(look, 1)
    };
    let mut outstanding = candidates.clone().filter(stands_out);
    let unequal = || candidates.clone().find(|look| !taken.contains(look));
    let first = Look { colour, dash: DASHES[index % DASHES.len()], marker: MARKERS[index % MARKERS.len()] };
    outstanding.next().or_else(|| apart(2)).or_else(|| apart(1)).or_else(unequal).unwrap_or(first)
}

/// The colour of variant `index` of `count`.
fn shade(base: Rgb, index: usize, count: usize) -> Rgb {
    let is_black = [base.0, base.1, base.2].iter().all(|channel| *channel < BLACKEST);
    let (first, last) = if is_black { SHADES_OF_BLACK } else { SHADES };
    // An even number of tones, none of which is the plain one in the middle.
    let tones = count.next_multiple_of(2);
    let tone = first + (last - first) * index as f64 / (tones - 1) as f64;
    if tone < 0.0 { mix(base, (0, 0, 0), -tone) } else { mix(base, (255, 255, 255), tone) }
}

/// `a (1 - share) + b share`, per channel.
fn mix(a: Rgb, b: Rgb, share: f64) -> Rgb {
    let channel = |a: u8, b: u8| (f64::from(a) + (f64::from(b) - f64::from(a)) * share).round() as u8;
    (channel(a.0, b.0), channel(a.1, b.1), channel(a.2, b.2))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::catalogue::Catalogue;

    const LOOK: Look = Look::new((213, 94, 0), Dash::Solid, Marker::Circle);
    const BLACK: Look = Look::new((0, 0, 0), Dash::Dotted, Marker::Cross);

    fn key(environment: &str, curriculum: &str, variant: &str) -> GroupKey {
        let catalogue = Catalogue::of([
            MethodInfo::new("nova", "NOVA", Some(LOOK)),
            MethodInfo::new("dull", "DULL", Some(BLACK)),
            MethodInfo::new("copy", "Copy", Some(LOOK)),
        ]);
        GroupKey::new(&catalogue, environment, curriculum, variant)
    }

    fn level(name: &str, variant: Option<&str>, is_reference: bool) -> LevelVariant {
        LevelVariant {
            curriculum: "nova".into(),
            axis: usize::from(name.starts_with('Δ')),
            name: name.into(),
            variant: variant.map(str::to_owned),
            deviations: 0,
            is_reference,
        }
    }

    fn all_differ(palette: &Palette, keys: &[GroupKey]) {
        for (index, key) in keys.iter().enumerate() {
            for other in &keys[..index] {
                let (a, b) = (palette.look(key), palette.look(other));
                assert!(differences(&a, &b) > 0, "{} and {}: {a:?}", key.name(), other.name());
            }
        }
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
        assert_eq!(palette.look(&keys[0]), LOOK);
        assert!(keys[1..].iter().all(|key| palette.look(key).colour != LOOK.colour));
        all_differ(&palette, &keys);
    }

    #[test]
    fn a_level_looks_like_the_variant_that_stands_for_it() {
        let keys = ["n3", "n5", "n10", "n20"].map(|variant| key("A", "nova", variant));
        let levels = [
            level("n = 10", Some("n10"), true),
            level("n = 3", Some("n3"), false),
            level("n = 4", None, false),
        ];
        let palette = Palette::with_levels(&keys, &levels);
        assert_eq!(palette.look(&keys[2]), LOOK, "the paper's own value, without a default");
        let of_level = |name: &str| palette.level(&key("B", "nova", name));
        assert_eq!((of_level("n = 10"), of_level("n = 3")), (LOOK, palette.look(&keys[0])));
        assert!(keys.iter().all(|key| differences(&palette.look(key), &of_level("n = 4")) > 0));
        // A default that was run is plainer than any level.
        let with_default = [key("A", "nova", "default"), key("A", "nova", "n10")];
        let palette = Palette::with_levels(&with_default, &levels[..1]);
        assert_eq!(palette.look(&with_default[0]), LOOK);
        assert_ne!(palette.level(&key("A", "nova", "n = 10")), LOOK);
    }

    #[test]
    fn levels_of_one_axis_share_neither_dashes_nor_markers() {
        let mut variants: Vec<String> = (0..10).map(|index| format!("other{index}")).collect();
        let axes = [("n", ["3", "5", "20"]), ("Δ", ["5", "10", "50"])];
        let mut levels = vec![level("n = 10", Some("default"), true)];
        for (axis, values) in axes {
            for value in values {
                variants.push(format!("{axis}{value}"));
                levels.push(level(&format!("{axis} = {value}"), variants.last().map(String::as_str), false));
            }
        }
        // The second axis departs from a variant that lies on the first.
        levels.push(level("Δ = 1", Some("n3"), true));
        let keys: Vec<GroupKey> = [key("A", "nova", "default")]
            .into_iter()
            .chain(variants.iter().map(|variant| key("A", "nova", variant)))
            .collect();
        let palette = Palette::with_levels(&keys, &levels);
        all_differ(&palette, &keys);
        for (axis, values) in axes {
            let first = if axis == "n" { "default" } else { "n3" };
            let mut looks = vec![palette.look(&key("A", "nova", first))];
            looks.extend(values.map(|value| palette.level(&key("A", "nova", &format!("{axis} = {value}")))));
            for (index, look) in looks.iter().enumerate() {
                for other in &looks[..index] {
                    assert!(look.dash != other.dash && look.marker != other.marker, "{axis}: {looks:?}");
                }
            }
        }
    }

    #[test]
    fn a_guest_has_the_colour_of_its_method() {
        let mut catalogue = Catalogue::of([MethodInfo::new("nova", "NOVA", Some(LOOK))]);
        catalogue.add_guest("nova", "nova@theirs", "theirs");
        let [own, guest] = ["nova", "nova@theirs"].map(|id| GroupKey::new(&catalogue, "A", id, "default"));
        assert_eq!(Palette::new([&guest]).look(&guest), LOOK);
        let both = Palette::new([&own, &guest]);
        assert_eq!((both.look(&own), both.look(&guest).colour), (LOOK, LOOK.colour));
        assert!(differences(&both.look(&own), &both.look(&guest)) > 1);
    }

    #[test]
    fn a_variant_of_a_black_method_is_not_black() {
        for count in 1..8 {
            let variants = (0..count).map(|index| key("A", "dull", &format!("v{index}")));
            let keys: Vec<GroupKey> = [key("A", "dull", "default")].into_iter().chain(variants).collect();
            let palette = Palette::new(&keys);
            assert_eq!(palette.look(&keys[0]), BLACK);
            for key in &keys[1..] {
                assert!(
                    palette.look(key).colour.0 >= ONE_COLOUR && differences(&palette.look(key), &BLACK) > 1
                );
            }
            all_differ(&palette, &keys);
        }
    }

    #[test]
    fn no_two_of_many_share_a_look() {
        // Twelve unknown methods, one that brings another's look, and thirty variants.
        let mut keys: Vec<GroupKey> =
            (0..12).map(|index| key("A", &format!("own{index}"), "default")).collect();
        keys.extend(["nova", "dull", "copy"].map(|id| key("A", id, "default")));
        for id in ["nova", "dull", "own3"] {
            keys.extend((0..10).map(|index| key("A", id, &format!("v{index}"))));
        }
        all_differ(&Palette::new(&keys), &keys);
    }

    #[test]
    fn mixing_by_hand() {
        assert_eq!(mix((0, 100, 200), (100, 200, 0), 0.25), (25, 125, 150));
    }
}
