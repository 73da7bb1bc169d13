//! Maps of the frontier in a maze: what the student could do, as measured, beside where its teacher looked.

use super::maze::{MazeBlock, MazePicture, MazeRow, MazeSheet, budgets};
use crate::analysis::frontier::map::{FrontierMap, FrontierPhase, MazeFrontier};
use crate::error::ReportError;
use crate::stats;
use crate::wording::counted;

/// The maps of the methods run in one maze, as SVG.
///
/// # Errors
/// [`ReportError::Figure`] if drawing fails.
pub fn frontier(frontier: &MazeFrontier<'_>) -> Result<String, ReportError> {
    let (most, is_highest) = scale_end(frontier);
    let end = format!("{:.1} %{}", most * 100.0, if is_highest { "" } else { " and more" });
    let sheet = MazeSheet {
        maze: frontier.maze,
        blocks: [
            MazeBlock {
                title: "What the student could do",
                scale: ["0.0", "measured success", "1.0"].map(str::to_owned),
            },
            MazeBlock {
                title: "Where teachers looked",
                scale: ["0 %".to_owned(), "of probability".to_owned(), end],
            },
        ],
        rows: frontier.maps.iter().flat_map(|map| rows(map, most)).collect(),
        caption: caption(frontier),
    };
    sheet.draw()
}

/// The probability of a cell at the end of the colour scale, and whether it is the highest one. Where there
/// are shadows, it is the median of the rows' highest: a teacher that wants a single goal would leave the
/// maps of all others white.
fn scale_end(frontier: &MazeFrontier<'_>) -> (f64, bool) {
    let highest = |phases: &[FrontierPhase; 3]| {
        let shares = phases.iter().flat_map(|phase| &phase.weights).flatten().copied();
        shares.fold(f64::MIN_POSITIVE, f64::max)
    };
    let teachers = |map: &FrontierMap| -> Vec<f64> {
        [&map.phases].into_iter().chain(map.shadows.iter().map(|(_, phases)| phases)).map(highest).collect()
    };
    let ends: Vec<f64> = frontier.maps.iter().flat_map(teachers).collect();
    let most = ends.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let is_watched = frontier.maps.iter().any(|map| !map.shadows.is_empty());
    let told: Vec<f64> = ends.into_iter().filter(|&end| end > f64::MIN_POSITIVE).collect();
    match stats::median(&told).filter(|_| is_watched) {
        Some(middle) => (middle, middle >= most),
        None => (most, true),
    }
}

/// The maps of one method, and a row for each teacher that watched it; `most` is the end of the colour scale
/// of probabilities.
fn rows(map: &FrontierMap, most: f64) -> Vec<MazeRow> {
    let watched = map.shadows.iter().map(|(title, phases)| row(title.clone(), phases, most));
    [row(map.key.name(), &map.phases, most)].into_iter().chain(watched).collect()
}

fn row(label: String, phases: &[FrontierPhase; 3], most: f64) -> MazeRow {
    let measured = |index: usize| {
        let values = phases[index].success.clone();
        MazePicture { reason: values.is_empty().then_some("no measure"), values }
    };
    let looked = |index: usize| {
        let phase = &phases[index];
        let reason = if phase.success.is_empty() { "no measure" } else { "no weights" };
        MazePicture {
            values: phase.weights.iter().map(|share| share.map(|share| (share / most).min(1.0))).collect(),
            reason: phase.weights.is_empty().then_some(reason),
        }
    };
    MazeRow { label, blocks: [[0, 1, 2].map(measured), [0, 1, 2].map(looked)] }
}

/// What the maps show, and of what.
fn caption(MazeFrontier { maze, maps }: &MazeFrontier<'_>) -> String {
    let partly = maps.iter().filter(|map| map.runs.0 < map.runs.1);
    let runs: Vec<String> = partly
        .map(|map| format!("{}: {} of {}", map.key.name(), map.runs.0, counted(map.runs.1, "run")))
        .collect();
    let seeds = match &runs[..] {
        [] => "all seeds".to_owned(),
        runs => format!("all seeds that were measured ({})", runs.join(", ")),
    };
    format!(
        "{}: the last measure of the frontier in each third of a budget of {} training steps; {seeds}. Black: walls. White: no goal of \
         the pool lies there. Left: success rate of greedy episodes towards the goals of the pool in each cell. Right: the \
         teacher's probability of a goal there. Empty maps say why: no measure fell into that third, or the teacher \
         does not weigh the pool.{}",
        maze.id,
        budgets(maps.iter().map(|map| map.budget)),
        watchers(maps),
    )
}

/// What rows of teachers are that only watched; nothing without any.
fn watchers(maps: &[FrontierMap]) -> String {
    let watched = maps.iter().filter(|map| !map.shadows.is_empty());
    let acting: Vec<String> = watched.map(|map| map.key.name()).collect();
    if acting.is_empty() {
        return String::new();
    }
    format!(" Rows below {} are of teachers that only watched the same student.", acting.join(" and "))
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
        let cells = vec![Some(0.5), None, Some(0.25), None];
        let both = FrontierPhase { success: cells.clone(), weights: cells.clone() };
        let unweighed = FrontierPhase { success: cells, weights: Vec::new() };
        let phases = [both.clone(), unweighed, FrontierPhase::default()];
        let mut map = FrontierMap { key, runs: (1, 2), budget: 90, phases, shadows: Vec::new() };
        let MazeRow { blocks: [measured, looked], .. } = rows(&map, 0.5).remove(0);
        assert_eq!(measured.map(|picture| picture.reason), [None, None, Some("no measure")]);
        assert_eq!(looked[0].values, [Some(1.0), None, Some(0.5), None]);
        let reasons = looked.map(|picture| picture.reason);
        assert_eq!(reasons, [None, Some("no weights"), Some("no measure")]);
        let alone = MazeFrontier { maze: &maze, maps: vec![map.clone()] };
        assert_eq!((scale_end(&alone), watchers(&alone.maps).as_str()), ((0.5, true), ""));
        // Two shadows: one of four times that, one that weighs nothing.
        let weights = both.weights.iter().map(|share| share.map(|share| 4.0 * share)).collect();
        let sharp = FrontierPhase { weights, ..both };
        let [none, silent] = [FrontierPhase::default(), FrontierPhase::default()];
        map.shadows.push(("Wren".into(), [sharp, none, silent]));
        map.shadows.push(("Moss".into(), Default::default()));
        let frontier = MazeFrontier { maze: &maze, maps: vec![map] };
        assert_eq!(scale_end(&frontier), (1.25, false));
        assert!(
            caption(&frontier)
                .ends_with("Rows below nova are of teachers that only watched the same student.")
        );
        assert_eq!(rows(&frontier.maps[0], 1.25)[1].blocks[1][0].values, [Some(1.0), None, Some(0.8), None]);
        assert!(caption(&frontier).contains("all seeds that were measured (nova: 1 of 2 runs)"));
        assert_eq!(budgets([90, 30, 90].into_iter()), "30 to 90");
        assert!(caption(&frontier).contains("each third of a budget of 90 training steps"));
        let svg = super::frontier(&frontier).unwrap();
        assert!(svg.contains("no weights") && svg.contains("no measure") && svg.contains("125.0 % and more"));
    }
}
