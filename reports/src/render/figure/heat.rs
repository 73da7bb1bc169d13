//! Heat maps of mazes: where a method's teacher sent the student beside where the student succeeded.

use super::maze::{MazeBlock, MazePicture, MazeRow, MazeSheet, budgets};
use crate::analysis::heat::{FEWEST_EPISODES, HeatMap, HeatPhase, MazeHeat};
use crate::error::ReportError;
use crate::wording::counted;

/// The heat maps of the methods run in one maze, as SVG.
///
/// # Errors
/// [`ReportError::Figure`] if drawing fails.
pub fn heat(heat: &MazeHeat<'_>) -> Result<String, ReportError> {
    let shares = heat.maps.iter().flat_map(|map| &map.phases).flat_map(HeatPhase::shares);
    // Highest share of goals in a cell: the end of its colour scale.
    let most = shares.fold(f64::MIN_POSITIVE, f64::max);
    let sheet = MazeSheet {
        maze: heat.maze,
        blocks: [
            MazeBlock {
                title: "Where the teacher sent the student",
                scale: ["0 %".to_owned(), "of goals".to_owned(), format!("{:.1} %", most * 100.0)],
            },
            MazeBlock {
                title: "Where the student succeeded",
                scale: ["0.0", "success rate", "1.0"].map(str::to_owned),
            },
        ],
        rows: heat.maps.iter().map(|map| row(map, most)).collect(),
        caption: caption(heat),
    };
    sheet.draw()
}

/// The maps of one method; `most` is the end of the colour scale of shares.
fn row(map: &HeatMap, most: f64) -> MazeRow {
    let share = |share: f64| (share > 0.0).then_some(share / most);
    let sent = |index: usize| MazePicture {
        values: map.phases[index].shares().into_iter().map(share).collect(),
        reason: reasons(map, index)[0],
    };
    let succeeded =
        |index: usize| MazePicture { values: map.phases[index].rates(), reason: reasons(map, index)[1] };
    MazeRow { label: map.key.name(), blocks: [[0, 1, 2].map(sent), [0, 1, 2].map(succeeded)] }
}

/// What the maps show, and of what.
fn caption(MazeHeat { maze, maps }: &MazeHeat<'_>) -> String {
    let partly = maps.iter().filter(|map| map.runs.0 < map.runs.1);
    let runs: Vec<String> = partly
        .map(|map| format!("{}: {} of {}", map.key.name(), map.runs.0, counted(map.runs.1, "run")))
        .collect();
    let seeds = match &runs[..] {
        [] => "all seeds".to_owned(),
        runs => {
            format!("all seeds, but only those with a record of what their teacher did ({})", runs.join(", "))
        }
    };
    format!(
        "{}: training episodes (with exploration noise) by thirds of a budget of {} training steps, in each the episodes that ended \
         there; {seeds}. Black: walls. Left: share of the third's goals, white where none lay. Right: success rate, white \
         where fewer than {FEWEST_EPISODES} goals lay. Empty maps say why.",
        maze.id,
        budgets(maps.iter().map(|map| map.budget)),
    )
}

/// Why the map of goals of the third `index` and the one of success are empty, where they are.
fn reasons(map: &HeatMap, index: usize) -> [Option<&'static str>; 2] {
    let phase = &map.phases[index];
    let begin = (u128::from(map.budget) * index as u128 / 3) as u64;
    if phase.total() == 0 {
        let why = if map.reached <= begin { "not trained so far" } else { "no episode here" };
        return [Some(why); 2];
    }
    let has_rate = phase.rates().iter().any(Option::is_some);
    [None, (!has_rate).then_some("too few goals")]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::catalogue::{Catalogue, MazeInfo};
    use crate::analysis::group::GroupKey;

    #[test]
    fn empty_maps_say_why() {
        let maze = MazeInfo { id: "M".into(), grid: ["..", ".S"].map(String::from).to_vec() };
        let key = GroupKey::new(&Catalogue::default(), "M", "nova", "default");
        let phase = |episodes: [u32; 4]| HeatPhase { episodes: episodes.to_vec(), successes: vec![0; 4] };
        let phases = [phase([9, 1, 0, 0]), phase([4, 4, 4, 4]), phase([0; 4])];
        let map = HeatMap { key, runs: (1, 2), reached: 60, budget: 90, phases };
        let heat = MazeHeat { maze: &maze, maps: vec![map] };
        let reasons = |index: usize| super::reasons(&heat.maps[0], index);
        assert_eq!(reasons(0), [None, None]);
        assert_eq!(reasons(1), [None, Some("too few goals")]);
        assert_eq!(reasons(2), [Some("not trained so far"); 2]);
        let caption = super::caption(&heat);
        assert!(
            caption.contains("thirds of a budget of 90 training steps")
                && caption.contains("nova: 1 of 2 runs"),
            "{caption}"
        );
        let svg = super::heat(&heat).unwrap();
        assert!(svg.contains("not trained so far") && svg.contains("too few goals"));
    }
}
