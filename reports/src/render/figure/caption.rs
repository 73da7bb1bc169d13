//! The line below a figure that says what its curves and bands are.

use std::collections::BTreeSet;
use std::fmt::Display;

use super::band::Band;
use crate::analysis::curves::{Curve, Point};

/// For example `mean ± std over 7 seeds (ddof = 1), cut at 0 and 1, 20-episode evaluations`.
pub(super) fn of(curves: &[&Curve], band: Band) -> String {
    let seeds = bounds(curves.iter().map(|curve| curve.seeds()));
    let (what, how) = band.words();
    let spread = match seeds {
        (_, 1) => "one seed, no band".to_owned(),
        (1, _) => format!("{what} over {} seeds ({how}; no band where n = 1)", range(seeds)),
        _ => format!("{what} over {} seeds ({how})", range(seeds)),
    };
    let is_cut = |point: &Point| band.at(point).is_some_and(|(low, high)| low < 0.0 || high > 1.0);
    let cut = if curves.iter().flat_map(|curve| &curve.points).any(is_cut) { ", cut at 0 and 1" } else { "" };
    let mut caption = format!("{spread}{cut}, {} evaluations", sizes(curves));
    if curves.iter().any(|curve| curve.interpolated) {
        caption.push_str("; seeds evaluated at other steps: on the line between two evaluations");
    }
    match curves.iter().map(|curve| curve.failed).sum() {
        0 => {}
        1 => caption.push_str("; 1 failed run counts 0 from its failure on"),
        k => caption.push_str(&format!("; {k} failed runs count 0 from their failure on")),
    }
    caption
}

/// How many episodes evaluations have: `20-episode`, `20- or 200-episode` where curves differ,
/// `10–20-episode` where the evaluations of one do.
fn sizes(curves: &[&Curve]) -> String {
    let ranges = || curves.iter().map(|curve| curve.episodes);
    let lows: BTreeSet<u64> = ranges().map(|(low, _)| low).collect();
    let each: Vec<String> = lows.iter().map(u64::to_string).collect();
    match each.as_slice() {
        [others @ .., last] if ranges().all(|(low, high)| low == high) && !others.is_empty() => {
            format!("{}- or {last}-episode", others.join("-, "))
        }
        _ => format!("{}-episode", range(bounds(ranges()))),
    }
}

/// `7`, or `3–7`.
pub(super) fn range<T: PartialEq + Display>((low, high): (T, T)) -> String {
    if low == high { low.to_string() } else { format!("{low}–{high}") }
}

/// The lowest and the highest bound of all.
fn bounds<T: Ord + Default + Copy>(ranges: impl Iterator<Item = (T, T)> + Clone) -> (T, T) {
    let low = ranges.clone().map(|(low, _)| low).min().unwrap_or_default();
    (low, ranges.map(|(_, high)| high).max().unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::catalogue::Catalogue;
    use crate::analysis::group::GroupKey;
    use crate::analysis::options::Bands;

    fn curve(seeds: &[usize], episodes: (u64, u64)) -> Curve {
        let point = |&n: &usize| Point { n, mean: 0.5, ..Point::default() };
        let key = GroupKey::new(&Catalogue::default(), "E", "c", "default");
        Curve { key, points: seeds.iter().map(point).collect(), episodes, interpolated: false, failed: 0 }
    }

    #[test]
    fn captions_state_seeds_ddof_and_episodes() {
        let say = |seeds: &[usize], episodes| of(&[&curve(seeds, episodes)], Band::default());
        assert_eq!(say(&[7, 7], (20, 20)), "mean ± std over 7 seeds (ddof = 1), 20-episode evaluations");
        assert_eq!(say(&[1, 1], (20, 20)), "one seed, no band, 20-episode evaluations");
        assert_eq!(
            say(&[7, 1], (10, 20)),
            "mean ± std over 1–7 seeds (ddof = 1; no band where n = 1), 10–20-episode evaluations"
        );
    }

    #[test]
    fn evaluations_of_several_sizes_are_named() {
        let say = |sizes: &[(u64, u64)]| {
            let curves: Vec<Curve> = sizes.iter().map(|size| curve(&[2], *size)).collect();
            self::sizes(&curves.iter().collect::<Vec<_>>())
        };
        assert_eq!(say(&[(20, 20), (20, 20)]), "20-episode");
        assert_eq!(say(&[(200, 200), (20, 20)]), "20- or 200-episode", "none has 100");
        assert_eq!(say(&[(20, 20), (50, 50), (200, 200)]), "20-, 50- or 200-episode");
        assert_eq!(say(&[(20, 20), (50, 100)]), "20–100-episode");
    }

    #[test]
    fn captions_say_what_bands_are() {
        let say = |kind| of(&[&curve(&[7, 7], (20, 20))], Band { kind, confidence: 0.95 });
        assert_eq!(say(Bands::Sem), "mean ± standard error over 7 seeds (ddof = 1), 20-episode evaluations");
        let interval = "mean and its 95 % interval over 7 seeds (Student's t), 20-episode evaluations";
        assert_eq!(say(Bands::Ci), interval);
    }

    #[test]
    fn captions_say_what_was_made_of_curves() {
        let mut one = curve(&[2], (20, 20));
        one.points[0].std = Some(0.6);
        assert_eq!(
            of(&[&one], Band::default()),
            "mean ± std over 2 seeds (ddof = 1), cut at 0 and 1, 20-episode evaluations"
        );
        one.points[0].std = Some(0.5);
        one.interpolated = true;
        one.failed = 2;
        assert_eq!(
            of(&[&one], Band::default()),
            "mean ± std over 2 seeds (ddof = 1), 20-episode evaluations; seeds evaluated at other steps: on the line \
             between two evaluations; 2 failed runs count 0 from their failure on"
        );
    }
}
