//! Maps of the frontier in a maze: what the student could do, as measured, beside where its teacher looked.

use super::maze::{MazeBlock, MazePicture, MazeRow, MazeSheet};
use crate::analysis::frontier::map::{FrontierMap, MazeFrontier};
use crate::error::ReportError;
use crate::render::table::cells::thousands;
use crate::wording::counted;

/// The maps of the methods run in one maze, as SVG.
///
/// # Errors
/// [`ReportError::Figure`] if drawing fails.
pub fn frontier(frontier: &MazeFrontier<'_>) -> Result<String, ReportError> {
    let shares = frontier.maps.iter().flat_map(|map| &map.phases).flat_map(|phase| &phase.weights);
    // Highest probability of a cell: the end of its colour scale.
    let most = shares.flatten().copied().fold(f64::MIN_POSITIVE, f64::max);
    let sheet = MazeSheet {
        maze: frontier.maze,
        blocks: [
            MazeBlock {
                title: "What the student could do",
                scale: ["0.0", "measured success", "1.0"].map(str::to_owned),
            },
            MazeBlock {
                title: "Where its teacher looked",
                scale: ["0 %".to_owned(), "of probability".to_owned(), format!("{:.1} %", most * 100.0)],
            },
        ],
        rows: frontier.maps.iter().map(|map| row(map, most)).collect(),
        caption: caption(frontier),
    };
    sheet.draw()
}

/// The maps of one method; `most` is the end of the colour scale of probabilities.
fn row(map: &FrontierMap, most: f64) -> MazeRow {
    let measured = |index: usize| {
        let values = map.phases[index].success.clone();
        MazePicture { reason: values.is_empty().then_some("no measure"), values }
    };
    let looked = |index: usize| {
        let phase = &map.phases[index];
        let reason = if phase.success.is_empty() { "no measure" } else { "no weights" };
        MazePicture {
            values: phase.weights.iter().map(|share| share.map(|share| share / most)).collect(),
            reason: phase.weights.is_empty().then_some(reason),
        }
    };
    MazeRow { label: map.key.name(), blocks: [[0, 1, 2].map(measured), [0, 1, 2].map(looked)] }
}

/// What the maps show, and of what.
fn caption(MazeFrontier { maze, end, maps }: &MazeFrontier<'_>) -> String {
    let partly = maps.iter().filter(|map| map.runs.0 < map.runs.1);
    let runs: Vec<String> = partly
        .map(|map| format!("{}: {} of {}", map.key.name(), map.runs.0, counted(map.runs.1, "run")))
        .collect();
    let seeds = match &runs[..] {
        [] => "all seeds".to_owned(),
        runs => format!("all seeds that were measured ({})", runs.join(", ")),
    };
    format!(
        "{}: the last measure of the frontier in each third of {} training steps; {seeds}. Black: walls. White: no goal of \
         the pool lies there. Left: success rate of greedy episodes towards the goals of the pool in each cell. Right: the \
         teacher's probability of a goal there. Empty maps say why: no measure fell into that third, or the teacher \
         does not weigh the pool.",
        maze.id,
        thousands(*end),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::catalogue::{Catalogue, MazeInfo};
    use crate::analysis::frontier::map::FrontierPhase;
    use crate::analysis::group::GroupKey;

    #[test]
    fn empty_maps_say_why() {
        let maze = MazeInfo { id: "M".into(), grid: ["..", ".S"].map(String::from).to_vec() };
        let key = GroupKey::new(&Catalogue::default(), "M", "nova", "default");
        let cells = vec![Some(0.5), None, Some(0.25), None];
        let both = FrontierPhase { success: cells.clone(), weights: cells.clone() };
        let unweighed = FrontierPhase { success: cells, weights: Vec::new() };
        let map = FrontierMap { key, runs: (1, 2), phases: [both, unweighed, FrontierPhase::default()] };
        let MazeRow { blocks: [measured, looked], .. } = row(&map, 0.5);
        assert_eq!(measured.map(|picture| picture.reason), [None, None, Some("no measure")]);
        assert_eq!(looked[0].values, [Some(1.0), None, Some(0.5), None]);
        let reasons = looked.map(|picture| picture.reason);
        assert_eq!(reasons, [None, Some("no weights"), Some("no measure")]);
        let frontier = MazeFrontier { maze: &maze, end: 90, maps: vec![map] };
        assert!(caption(&frontier).contains("all seeds that were measured (nova: 1 of 2 runs)"));
        let svg = super::frontier(&frontier).unwrap();
        assert!(svg.contains("no weights") && svg.contains("no measure") && svg.contains("50.0 %"));
    }
}
