//! Which places of its ordering a teacher trained on over time, for those that rank goals.

use std::path::Path;

use rayon::prelude::*;

use crate::analysis::group::{Group, GroupKey};
use crate::analysis::groups::Groups;
use crate::analysis::parts::{episode_end, slice_of};
use crate::schema::Teaching;
use crate::store;

/// Slices of training.
pub const TIMES: usize = 60;

/// Rows of places, at most.
pub const MOST_ROWS: usize = 40;

/// How often the goals of each place were trained on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RankMap {
    /// Which group.
    pub key: GroupKey,
    /// Its runs that have ranks.
    pub runs: usize,
    /// Training steps at the end of the last slice.
    pub end: u64,
    /// Places that share a row.
    pub together: usize,
    /// Episodes by row and slice, the first places first: `[rows][TIMES]`.
    pub counts: Vec<Vec<u32>>,
}

impl RankMap {
    /// Of the runs of a group, each with its lines by rising step. `None` if no goal has a rank.
    pub fn of<'a>(key: &GroupKey, runs: impl IntoIterator<Item = &'a [Teaching]>) -> Option<Self> {
        let runs: Vec<&[Teaching]> = runs.into_iter().collect();
        let end = runs.iter().filter_map(|lines| Some(lines.last()?.step)).max()?;
        let ranked: Vec<Vec<(usize, u32)>> = runs.iter().map(|lines| ranked(lines, end)).collect();
        let highest = ranked.iter().flatten().map(|(_, rank)| *rank).max()?;
        let together = (highest as usize / MOST_ROWS) + 1;
        let mut counts = vec![vec![0; TIMES]; highest as usize / together + 1];
        for (slice, rank) in ranked.iter().flatten() {
            counts[*rank as usize / together][*slice] += 1;
        }
        let runs = ranked.iter().filter(|run| !run.is_empty()).count();
        Some(Self { key: key.clone(), runs, end, together, counts })
    }

    /// Share of a slice's episodes in every row, `[rows]`.
    pub fn shares(&self, slice: usize) -> Vec<f64> {
        let all: u32 = self.counts.iter().map(|row| row[slice]).sum();
        self.counts.iter().map(|row| f64::from(row[slice]) / f64::from(all.max(1))).collect()
    }
}

/// The ranks of a run's goals, each with its slice of `end` steps.
fn ranked(lines: &[Teaching], end: u64) -> Vec<(usize, u32)> {
    let mut found = Vec::new();
    let mut before = 0;
    for line in lines {
        for (index, rank) in line.ranks.iter().flatten().enumerate() {
            let slice = slice_of(episode_end(line, before, index), end, TIMES);
            found.extend(rank.map(|rank| (slice, rank)));
        }
        before = line.step;
    }
    found
}

/// The maps of the groups of these environments that stand for their method and rank goals. What is wrong
/// with the files is said where goals are counted.
pub fn maps(results: &Path, groups: &Groups<'_>, environments: &[&str]) -> Vec<RankMap> {
    let mut chosen = groups.compared_groups();
    chosen.retain(|group| group.is_own() && environments.contains(&group.key.environment.as_str()));
    let map = |group: &&Group<'_>| {
        // One run tells whether there are ranks at all.
        let (first, _) = store::teaching(results, group.runs.first()?);
        first.iter().find(|line| line.ranks.is_some())?;
        let others = group.runs[1..].iter().map(|run| store::teaching(results, run).0);
        let read: Vec<Vec<Teaching>> = [first].into_iter().chain(others).collect();
        RankMap::of(&group.key, read.iter().map(Vec::as_slice))
    };
    chosen.par_iter().filter_map(map).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::catalogue::Catalogue;

    #[test]
    fn ranks_by_hand() {
        let key = GroupKey::new(&Catalogue::default(), "M", "nova", "default");
        let line = |step, ranks: &[Option<u32>]| Teaching {
            step,
            goals: vec![vec![0.0, 0.0]; ranks.len()],
            successes: vec![false; ranks.len()],
            ranks: Some(ranks.to_vec()),
            ..Teaching::default()
        };
        // 600 steps are 60 slices of 10. Episodes end at 150, 300; then at 450 and 600.
        let run = [line(300, &[Some(0), Some(1)]), line(600, &[None, Some(0)])];
        let other = [line(600, &[Some(2)])];
        let map = RankMap::of(&key, [&run[..], &other[..], &[]]).expect("ranks");
        assert_eq!((map.runs, map.end, map.together, map.counts.len()), (2, 600, 1, 3));
        let places: Vec<(usize, usize)> = (0..3)
            .flat_map(|row| (0..TIMES).map(move |slice| (row, slice)))
            .filter(|&(row, slice)| map.counts[row][slice] > 0)
            .collect();
        assert_eq!(places, [(0, 14), (0, 59), (1, 29), (2, 59)]);
        assert_eq!(map.shares(59), [0.5, 0.0, 0.5]);
        assert_eq!(map.shares(0), [0.0; 3]);
        // Places 0 to 80 in no more than 40 rows.
        let many = RankMap::of(&key, [&[line(600, &[Some(80), Some(2)])][..]]).expect("ranks");
        assert_eq!((many.together, many.counts.len()), (3, 27));
        assert_eq!((many.counts[26].iter().sum::<u32>(), many.counts[0].iter().sum::<u32>()), (1, 1));
        let unranked = Teaching { ranks: None, ..line(600, &[]) };
        assert_eq!(RankMap::of(&key, [&[unranked][..]]), None);
    }
}
