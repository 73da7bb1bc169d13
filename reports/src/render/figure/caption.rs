//! The line below a figure that says what its curves and bands are.

use std::fmt::Display;

use crate::analysis::curves::{Curve, DDOF};

/// For example `mean ± std over 7 seeds (ddof = 1), 20-episode evaluations`.
pub(super) fn of(curves: &[&Curve]) -> String {
    let seeds = bounds(curves.iter().map(|curve| curve.seeds()));
    let episodes = range(bounds(curves.iter().map(|curve| curve.episodes)));
    let spread = match seeds {
        (_, 1) => "one seed, no band".to_owned(),
        (1, _) => format!("mean ± std over {} seeds (ddof = {DDOF}; no band where n = 1)", range(seeds)),
        _ => format!("mean ± std over {} seeds (ddof = {DDOF})", range(seeds)),
    };
    format!("{spread}, {episodes}-episode evaluations")
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
    use crate::analysis::curves::Point;
    use crate::analysis::group::GroupKey;

    fn curve(seeds: &[usize], episodes: (u64, u64)) -> Curve {
        let point = |&n: &usize| Point { n, mean: 0.5, ..Point::default() };
        let key = GroupKey::new(&Catalogue::default(), "E", "c", "default");
        Curve { key, points: seeds.iter().map(point).collect(), episodes }
    }

    #[test]
    fn captions_state_seeds_ddof_and_episodes() {
        let say = |seeds: &[usize], episodes| of(&[&curve(seeds, episodes)]);
        assert_eq!(say(&[7, 7], (20, 20)), "mean ± std over 7 seeds (ddof = 1), 20-episode evaluations");
        assert_eq!(say(&[1, 1], (20, 20)), "one seed, no band, 20-episode evaluations");
        assert_eq!(
            say(&[7, 1], (10, 20)),
            "mean ± std over 1–7 seeds (ddof = 1; no band where n = 1), 10–20-episode evaluations"
        );
    }
}
