//! Films of where teachers sent their students: every goal in its place, in the picture of its time.

use std::fs;

use super::support::{key, line, options, seal, write_run};
use reports::ReportOptions;
use reports::analysis::catalogue::{EnvironmentInfo, MazeInfo};
use reports::schema::{Frontier, Teaching};
use reports::store::layout::{self, FRONTIER, TEACHING};
use tempfile::TempDir;

type Pixel = [u8; 3];

/// Around goals that were trained on.
const RING: Pixel = [213, 94, 0];
/// Success of 0 and of 1.
const NEVER: Pixel = [253, 231, 37];
const ALWAYS: Pixel = [65, 68, 135];

/// The upper left corner and the side of the world of a maze in a picture.
const MAZE: (usize, usize, usize) = (14, 48, 468);

/// A film, played.
struct Played {
    width: usize,
    /// All pixels after each picture.
    pictures: Vec<Vec<Pixel>>,
}

impl Played {
    fn of(bytes: &[u8]) -> Self {
        let mut options = gif::DecodeOptions::new();
        options.set_color_output(gif::ColorOutput::RGBA);
        let mut decoder = options.read_info(bytes).unwrap();
        let width = usize::from(decoder.width());
        let mut canvas = vec![[0; 3]; width * usize::from(decoder.height())];
        let mut pictures = Vec::new();
        while let Some(frame) = decoder.read_next_frame().unwrap() {
            for (index, pixel) in frame.buffer.chunks(4).enumerate().filter(|(_, pixel)| pixel[3] > 0) {
                let across = usize::from(frame.width);
                let row = usize::from(frame.top) + index / across;
                canvas[row * width + usize::from(frame.left) + index % across] =
                    [pixel[0], pixel[1], pixel[2]];
            }
            pictures.push(canvas.clone());
        }
        Self { width, pictures }
    }

    /// Pixels of this colour in a square of a picture: left, top and side.
    fn count(&self, picture: usize, colour: Pixel, (left, top, side): (usize, usize, usize)) -> usize {
        let rows = (top..top + side).flat_map(|row| (left..left + side).map(move |column| (row, column)));
        rows.filter(|(row, column)| self.pictures[picture][row * self.width + column] == colour).count()
    }
}

/// The square around where a goal lies in a picture of a maze.
fn around([down, across]: [f64; 2]) -> (usize, usize, usize) {
    let (left, top, side) = MAZE;
    let place = |x: f64| ((x + 1.0) / 2.0 * side as f64) as usize - 30;
    (left + place(across), top + place(down), 60)
}

/// A run of 40 episodes of 50 steps whose teacher trains on goals of the pool in turn, each for ten episodes.
fn maze_run(results: &TempDir, seed: u64, measured: bool) {
    let goals = [[-0.5, -0.5], [-0.5, 0.5], [0.5, -0.5], [0.5, 0.5]];
    let folder = write_run(results.path(), &key("Four", "nova", "default", seed), &[0.0, 0.5, 1.0]);
    let teaching = |eval_index: u64, picks: [usize; 2]| {
        let picks: Vec<usize> = picks.iter().flat_map(|&pick| [pick; 10]).collect();
        Teaching {
            eval_index,
            step: 1_000 * eval_index,
            goals: picks.iter().map(|&pick| goals[pick].map(|x| x as f32).to_vec()).collect(),
            successes: vec![false; picks.len()],
            ranks: Some(picks.iter().map(|&pick| Some(pick as u32)).collect()),
            picks: Some(picks.iter().map(|&pick| Some(pick as u32)).collect()),
            ..Teaching::default()
        }
    };
    let start = Teaching { picks: Some(Vec::new()), ..Teaching::default() };
    let lines = [start, teaching(1, [0, 1]), teaching(2, [2, 3])];
    fs::write(folder.join(TEACHING), lines.iter().map(line).collect::<String>()).unwrap();
    if measured {
        let measure = |eval_index: u64, successes: [u64; 4]| Frontier {
            eval_index,
            step: 1_000 * eval_index,
            episodes: 1,
            successes: successes.to_vec(),
            goals: (eval_index == 0).then(|| goals.map(|goal| goal.map(|x| x as f32).to_vec()).to_vec()),
            ..Frontier::default()
        };
        let measures = [measure(0, [0; 4]), measure(1, [1, 1, 1, 0])];
        fs::write(folder.join(FRONTIER), measures.iter().map(line).collect::<String>()).unwrap();
    }
    seal(&folder);
}

fn in_a_maze() -> ReportOptions {
    let mut options = options();
    options.catalogue.mazes =
        vec![MazeInfo { id: "Four".into(), grid: ["..", ".S"].map(String::from).to_vec() }];
    options
}

#[test]
fn a_goal_is_in_the_pictures_of_its_time_and_in_no_others() {
    let results = TempDir::new().unwrap();
    maze_run(&results, 0, true);
    maze_run(&results, 1, true);
    let written = reports::write(results.path(), &in_a_maze()).unwrap();
    assert!(written.problems.is_empty(), "{:?}", written.problems);
    let report = layout::report_dir(results.path());
    let bytes = fs::read(report.join("figures/film-Four-nova.gif")).unwrap();
    assert!(bytes.len() < 100_000, "{}", bytes.len());
    let film = Played::of(&bytes);
    // Five episodes of forty in each.
    assert_eq!(film.pictures.len(), 8);
    let goals = [[-0.5, -0.5], [-0.5, 0.5], [0.5, -0.5], [0.5, 0.5]];
    for picture in 0..8 {
        for (index, goal) in goals.into_iter().enumerate() {
            let rings = film.count(picture, RING, around(goal));
            let is_picked = picture / 2 == index;
            assert_eq!(rings > 100, is_picked, "goal {index} in picture {picture}: {rings}");
            assert_eq!(rings > 0, is_picked, "goal {index} in picture {picture}: {rings}");
            // Measured after half of the training, from the picture on that ends there.
            let colour = if picture < 3 || index == 3 { NEVER } else { ALWAYS };
            let found = film.count(picture, colour, around(goal));
            assert!(found > if is_picked { 900 } else { 20 }, "goal {index} in picture {picture}: {found}");
        }
    }
    let page = fs::read_to_string(report.join("index.html")).unwrap();
    let shown = "alt=\"Four: where NOVA sent the student of seed 0 over training, in 8 pictures\" src=\"data:image/gif;base64,";
    assert!(
        page.contains(shown)
            && page.contains("<details><summary>Where teachers sent the student, in motion (1)")
    );
    // Places of the ordering over time: the fourth one late, in the top row.
    assert!(report.join("figures/ranks-Four.svg").is_file());

    reports::write(results.path(), &in_a_maze()).unwrap();
    assert_eq!(fs::read(report.join("figures/film-Four-nova.gif")).unwrap(), bytes, "the same bytes");
    // What the report before drew goes away with what it was drawn from.
    for seed in [0, 1] {
        let folder = layout::run_dir(results.path(), &key("Four", "nova", "default", seed));
        fs::remove_file(folder.join(TEACHING)).unwrap();
        seal(&folder);
    }
    reports::write(results.path(), &in_a_maze()).unwrap();
    assert!(!report.join("figures/film-Four-nova.gif").exists());
}

#[test]
fn without_measures_goals_have_no_success() {
    let results = TempDir::new().unwrap();
    maze_run(&results, 0, false);
    reports::write(results.path(), &in_a_maze()).unwrap();
    let report = layout::report_dir(results.path());
    let film = Played::of(&fs::read(report.join("figures/film-Four-nova.gif")).unwrap());
    let (left, top, side) = MAZE;
    for picture in 0..8 {
        for colour in [NEVER, ALWAYS] {
            assert_eq!(film.count(picture, colour, (left, top, side)), 0, "picture {picture}");
        }
    }
    assert!(film.count(0, RING, around([-0.5, -0.5])) > 100);
    assert_eq!(film.count(0, RING, around([0.5, 0.5])), 0);
}

#[test]
fn points_in_space_are_seen_from_above_and_from_the_side() {
    let results = TempDir::new().unwrap();
    let folder = write_run(results.path(), &key("Lift", "nova", "default", 0), &[0.0, 0.5]);
    // A cube with edges of 1. The second goal is high up.
    let goals = [[0.0, 0.0, 0.0], [1.0, 0.0, 1.0]];
    let picks: Vec<usize> = [[0; 5], [1; 5]].concat();
    let teaching = Teaching {
        eval_index: 1,
        step: 1_000,
        goals: picks.iter().map(|&pick| goals[pick].to_vec()).collect(),
        successes: vec![false; 10],
        picks: Some(picks.iter().map(|&pick| Some(pick as u32)).collect()),
        ..Teaching::default()
    };
    let start = Teaching { picks: Some(Vec::new()), ..Teaching::default() };
    fs::write(folder.join(TEACHING), [start, teaching].iter().map(line).collect::<String>()).unwrap();
    seal(&folder);
    let mut options = options();
    options.catalogue.environments = vec![EnvironmentInfo {
        id: "Lift".into(),
        state: 10,
        goal: 3,
        action: 4,
        horizon: 50,
        paper_action: None,
        note: String::new(),
    }];
    reports::write(results.path(), &options).unwrap();
    let report = layout::report_dir(results.path());
    let film = Played::of(&fs::read(report.join("figures/film-Lift-nova.gif")).unwrap());
    assert_eq!(film.pictures.len(), 2);
    // Two squares of 372 beside each other; from above the goals lie left and right at half the height, as no
    // goal has another y, from the side they lie in opposite corners.
    let (left, top, side, next) = (14, 72, 372, 392);
    let seen = |picture: usize, view: usize, [across, down]: [f64; 2]| {
        let place = |share: f64| ((0.05 + 0.9 * share) * side as f64) as usize - 18;
        film.count(picture, RING, (left + view * next + place(across), top + place(down), 36)) > 50
    };
    let first: [[f64; 2]; 2] = [[0.0, 0.5], [0.0, 1.0]];
    let second: [[f64; 2]; 2] = [[1.0, 0.5], [1.0, 0.0]];
    for view in [0, 1] {
        assert!(seen(0, view, first[view]) && !seen(0, view, second[view]), "view {view}");
        assert!(seen(1, view, second[view]) && !seen(1, view, first[view]), "view {view}");
    }
}
