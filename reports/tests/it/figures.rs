//! Figures of every shape of results: each label lies inside the page and on top of no other label.

use reports::analysis::aggregate::Shared;
use reports::analysis::catalogue::MazeInfo;
use reports::analysis::curves::{Curve, Point, Progress};
use reports::analysis::efficiency::Efficiency;
use reports::analysis::finals::Finals;
use reports::analysis::group::GroupKey;
use reports::analysis::heat::{HeatMap, HeatPhase, MazeHeat};
use reports::analysis::improvement;
use reports::analysis::options::Bands;
use reports::render::figure::{self, Band, Basis, Style};
use reports::stats::Resampling;
use reports::synthetic::catalogue;
use resvg::usvg::{self, Node, Rect};

const LONG: &str = "an-environment-id-that-goes-on-and-on-and-on-until-nobody-remembers-how-it-began-v4";

/// `points` evaluations, 10,000 steps apart, of `n` seeds each; `rate` maps a share of the budget to a rate.
fn curve(environment: &str, curriculum: &str, variant: &str, n: usize, rate: impl Fn(f64) -> f64) -> Curve {
    let point = |index: u64| {
        let share = index as f64 / 100.0;
        let std = (n > 1).then_some(0.1);
        Point {
            step: index * 10_000,
            n,
            mean: rate(share),
            std,
            gradient_steps: index as f64 * 4_000.0,
            uncharged_steps: 0.0,
            hours: Some(0.037 * index as f64),
        }
    };
    Curve {
        key: key(environment, curriculum, variant),
        points: (0..=100).map(point).collect(),
        episodes: (20, 20),
        interpolated: true,
        failed: 3,
    }
}

fn key(environment: &str, curriculum: &str, variant: &str) -> GroupKey {
    GroupKey::new(&catalogue(), environment, curriculum, variant)
}

/// Curves of six curricula.
fn comparison(environment: &str) -> Vec<Curve> {
    ["nova", "wren", "kite", "moss", "dull", "dull-pool"]
        .iter()
        .enumerate()
        .map(|(index, id)| {
            let midpoint = 0.1 + 0.1 * index as f64;
            curve(environment, id, "default", 7, |share| 1.0 / (1.0 + (-12.0 * (share - midpoint)).exp()))
        })
        .collect()
}

fn cases() -> Vec<(&'static str, Vec<Curve>)> {
    let mut eleven = Vec::new();
    for index in 0..11 {
        eleven.extend(comparison(&format!("Environment{index}")));
    }
    let windows = ["n=3", "n=5", "n=10", "n=20"];
    let mut partial = comparison("Maze");
    for (index, curve) in partial.iter_mut().enumerate() {
        curve.points.truncate(20 * index + 1);
        for point in &mut curve.points {
            point.n = index + 1;
            point.std = (point.n > 1).then_some(0.1);
        }
    }
    let long_curricula = (0..4).map(|index| format!("{LONG}-{index}"));
    vec![
        ("one curve", vec![curve("ArmReach", "nova", "default", 7, |share| share)]),
        ("one seed", vec![curve("ArmReach", "nova", "default", 1, |share| share)]),
        ("six curves", comparison("ArmPush")),
        ("eleven environments", eleven),
        (
            "always 0 and always 1",
            vec![curve("E", "nova", "default", 7, |_| 1.0), curve("E", "dull", "default", 7, |_| 0.0)],
        ),
        ("equal curves", ["nova", "wren", "moss"].map(|id| curve("E", id, "default", 7, |_| 1.0)).to_vec()),
        (
            "variants",
            windows
                .map(|variant| curve("RoomA", "nova", variant, 7, |share| share * variant.len() as f64 / 5.0))
                .to_vec(),
        ),
        ("partial", partial),
        (
            "one evaluation",
            vec![Curve {
                key: key("E", "nova", "default"),
                points: vec![Point { n: 1, mean: 0.05, hours: Some(0.0), ..Point::default() }],
                episodes: (20, 20),
                interpolated: false,
                failed: 0,
            }],
        ),
        ("long names", long_curricula.map(|id| curve(LONG, &id, LONG, 7, |share| share)).collect()),
        (
            "odd names",
            vec![curve("<b>&\"maze\"</b>\u{7}\n", "λ-curriculum & <friends>", "β='20'", 7, |share| share)],
        ),
    ]
}

/// All figures of a case: learning curves of one and of all environments, the same over hours, and what sums
/// up environments.
fn figures(curves: &[Curve], zoom: bool) -> Vec<String> {
    let first = &curves[0].key.environment;
    let all: Vec<&Curve> = curves.iter().collect();
    let single: Vec<&Curve> = curves.iter().filter(|curve| curve.key.environment == *first).collect();
    let banded = |curves: &[&Curve], progress, kind| {
        let keys = all.iter().map(|curve| &curve.key);
        let band = Band { kind, confidence: 0.9875 };
        let style = Style { zoom, band, ..Style::new(keys) };
        figure::learning(&figure::by_environment(curves), &style, progress).unwrap()
    };
    let learning = |curves: &[&Curve], progress| banded(curves, progress, Bands::Std);
    let mut figures = vec![
        learning(&single, Progress::EnvironmentSteps),
        banded(&single, Progress::EnvironmentSteps, Bands::Ci),
        banded(&all, Progress::Hours, Bands::Sem),
        learning(&all, Progress::EnvironmentSteps),
        learning(&single, Progress::Hours),
        learning(&all, Progress::GradientSteps),
        efficiency(&single, zoom),
        heat(&single),
    ];
    figures.extend(across(&single, zoom));
    figures
}

/// With all that captions can say.
const BASIS: Basis<'_> = Basis {
    environments: 11,
    seeds: "of the 2 to 7 seeds that all of them have in each",
    fewest_runs: 2,
    failed: 3,
    resampling: Resampling { seed: 0, resamples: 1_000, confidence: 0.95 },
};

/// Performance profiles, aggregates and improvements of the methods of some curves, with made-up final
/// scores.
fn across(curves: &[&Curve], zoom: bool) -> [String; 3] {
    let finals = |(index, curve): (usize, &&Curve)| Finals {
        key: curve.key.clone(),
        by_seed: (0..7).map(|seed| (seed, (0.1 * (seed as f64 + index as f64)).min(1.0))).collect(),
        failed: Vec::new(),
    };
    let finals: Vec<Finals> = curves.iter().enumerate().map(finals).collect();
    let resampling = Resampling { resamples: 1_000, ..Resampling::default() };
    let shared = Shared::of(&finals);
    let style = Style { zoom, ..Style::new(curves.iter().map(|curve| &curve.key)) };
    let profiles = shared.profiles(resampling);
    assert_eq!(profiles.len(), curves.len());
    [
        figure::profiles(&profiles, &BASIS, &style).unwrap(),
        figure::aggregates(&shared.aggregates(resampling), &BASIS, &style).unwrap(),
        figure::improvements(
            &improvement::improvements(&finals.iter().collect::<Vec<_>>(), resampling),
            &BASIS,
            &style,
        )
        .unwrap(),
    ]
}

/// Sample-efficiency curves that follow the learning curves.
fn efficiency(curves: &[&Curve], zoom: bool) -> String {
    let of = |curve: &&'_ Curve| {
        let shares: Vec<f64> = (0..=20).map(|index| f64::from(index) / 20.0).collect();
        let iqm: Vec<f64> = shares.iter().map(|share| share * curve.points[0].mean.max(0.5)).collect();
        let intervals = iqm.iter().map(|y| (y - 0.1, y + 0.1)).collect();
        (curve.key.clone(), shares, iqm, Some(intervals))
    };
    let owned: Vec<_> = curves.iter().map(of).collect();
    let curves: Vec<Efficiency<'_>> = owned
        .iter()
        .map(|(method, shares, iqm, intervals)| Efficiency {
            method,
            shares: shares.clone(),
            iqm: iqm.clone(),
            intervals: intervals.clone(),
        })
        .collect();
    let style = Style { zoom, ..Style::new(owned.iter().map(|(key, ..)| key)) };
    figure::efficiency(&curves, &BASIS, &style).unwrap()
}

/// Heat maps of the methods of some curves in a maze whose middle row is a wall.
fn heat(curves: &[&Curve]) -> String {
    let line = |row: usize| match row {
        6 => "#############",
        11 => "......S......",
        _ => ".............",
    };
    let maze = MazeInfo {
        id: curves[0].key.environment.clone(),
        grid: (0..13).map(|row| line(row).to_owned()).collect(),
    };
    let phase = |offset: u32| HeatPhase {
        episodes: (0..169).map(|cell| (cell + offset) % 40).collect(),
        successes: (0..169).map(|cell| (cell + offset) % 40 / 2).collect(),
    };
    let empty = || HeatPhase { episodes: vec![0; 169], successes: vec![0; 169] };
    let map = |curve: &&Curve| HeatMap {
        key: curve.key.clone(),
        runs: (1, 7),
        reached: 600_000,
        budget: 1_000_000,
        phases: [phase(0), phase(7), empty()],
    };
    let maps = curves.iter().map(map).collect();
    figure::heat(&MazeHeat { maze: &maze, maps }).unwrap()
}

fn parse(svg: &str) -> usvg::Tree {
    let mut options = usvg::Options::default();
    options.fontdb_mut().load_font_data(dejavu::sans::regular().to_vec());
    usvg::Tree::from_str(svg, &options).unwrap()
}

/// Every text of a figure and the box it fills.
fn texts(group: &usvg::Group) -> Vec<(String, Rect)> {
    let mut found = Vec::new();
    for node in group.children() {
        match node {
            Node::Group(group) => found.extend(texts(group)),
            Node::Text(text) => {
                let content = text.chunks().iter().map(|chunk| chunk.text()).collect();
                found.push((content, text.abs_bounding_box()));
            }
            Node::Path(_) | Node::Image(_) => {}
        }
    }
    found
}

#[test]
fn labels_are_inside_the_page_and_apart() {
    for (case, curves) in cases() {
        for svg in [false, true].iter().flat_map(|zoom| figures(&curves, *zoom)) {
            let tree = parse(&svg);
            let (width, height) = (tree.size().width(), tree.size().height());
            let texts = texts(tree.root());
            assert!(texts.len() > 6, "{case}: too few labels");
            for (index, (text, a)) in texts.iter().enumerate() {
                let inside = a.left() >= 0.0 && a.top() >= 0.0 && a.right() <= width && a.bottom() <= height;
                assert!(inside, "{case}: `{text}` at {a:?} leaves the page of {width} x {height}");
                for (other, b) in &texts[index + 1..] {
                    let apart = a.right() <= b.left()
                        || b.right() <= a.left()
                        || a.bottom() <= b.top()
                        || b.bottom() <= a.top();
                    assert!(apart, "{case}: `{text}` and `{other}` overlap: {a:?}, {b:?}");
                }
            }
        }
    }
}

#[test]
fn axes_that_do_not_span_0_to_1_say_so() {
    let high = [curve("E", "nova", "default", 7, |share| 0.8 + 0.05 * share)];
    for (zoom, expected) in [(false, 0), (true, 1)] {
        let svg = &figures(&high, zoom)[0];
        let texts: Vec<String> = texts(parse(svg).root()).into_iter().map(|(text, _)| text).collect();
        assert_eq!(texts.iter().filter(|text| text.contains("(zoom)")).count(), expected, "{texts:?}");
        assert_eq!(texts.iter().any(|text| text == "0.0"), !zoom, "{texts:?}");
    }
}

#[test]
fn names_stay_readable_through_escaping() {
    let curves = cases().pop().unwrap().1;
    let svg = &figures(&curves, false)[0];
    let texts: Vec<String> = texts(parse(svg).root()).into_iter().map(|(text, _)| text).collect();
    assert!(texts.iter().any(|text| text.contains("<b>&\"maze\"</b>")), "{texts:?}");
    assert!(texts.iter().any(|text| text.contains("λ-curriculum & <friends> (β='20')")), "{texts:?}");
}

/// Pixels of a PNG rendered from `curves` that have exactly this colour.
fn pixels_of(curves: &[Curve], colour: [u8; 3]) -> usize {
    let svg = &figures(curves, false)[0];
    let png = figure::png("test", svg).unwrap();
    let image = resvg::tiny_skia::Pixmap::decode_png(&png).unwrap();
    image.pixels().iter().filter(|pixel| [pixel.red(), pixel.green(), pixel.blue()] == colour).count()
}

#[test]
fn curves_at_the_limits_are_visible() {
    let vermilion = [213, 94, 0];
    for rate in [0.0, 1.0] {
        let flat = [curve("E", "nova", "default", 7, |_| rate)];
        // 5 pixels wide on a plot of more than 800 pixels, most of it not hidden by the frame.
        assert!(pixels_of(&flat, vermilion) > 3_000, "rate {rate}");
    }
}

#[test]
fn equal_curves_can_all_be_seen() {
    let equal = ["nova", "wren", "moss"].map(|id| curve("E", id, "default", 7, |_| 1.0));
    for (method, colour) in [("nova", [213, 94, 0]), ("wren", [0, 114, 178]), ("moss", [204, 121, 167])] {
        let alone: Vec<Curve> = equal.iter().filter(|curve| curve.key.is_of(method)).cloned().collect();
        let legend_sample = 600;
        assert!(pixels_of(&equal, colour) > legend_sample + 1_000, "{method}");
        assert!(pixels_of(&alone, colour) > legend_sample + 1_000, "{method}");
    }
}

/// Writes all cases for inspection by eye: `FIGURES=FOLDER cargo test --release -p reports --test it --
/// --ignored`.
#[test]
#[ignore = "writes files for people to look at"]
fn draw_all_cases() {
    let folder = std::path::PathBuf::from(std::env::var_os("FIGURES").unwrap());
    for (case, curves) in cases() {
        for zoom in [false, true] {
            for (index, svg) in figures(&curves, zoom).iter().enumerate() {
                let zoomed = if zoom { " zoomed" } else { "" };
                let name = format!("{case} {index}{zoomed}").replace(' ', "-");
                std::fs::write(folder.join(format!("{name}.png")), figure::png(case, svg).unwrap()).unwrap();
            }
        }
    }
}
