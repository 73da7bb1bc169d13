//! The paper (TEACH, arXiv 2512.22824) as data: what it compares, varies and claims, for reports.
//!
//! Reports know none of this by themselves; [`catalogue`] hands it in, together with what the registry knows
//! of methods and environments. What stands in configs is named by the code that owns it: the fields that the
//! paper varies by [`teach::AXES`], titles and looks by the methods.

mod claims;
mod deviations;

use curricula::methods::teach::{self, Teach};
use curricula::{Entry, Method as _};
use reports::Catalogue;
use reports::analysis::catalogue::{
    Axis, Citation, EnvironmentInfo, MazeInfo, MethodInfo, Paper, PaperProtocol, ReadingChoice,
};

use crate::Registry;

/// Its own method, as a curriculum id.
pub const METHOD: &str = Teach::ID;

/// Its baselines, as curriculum ids.
pub const BASELINES: [&str; 4] = ["vds", "procurl", "space", "her-iid"];

/// The control that the paper lacks, as a curriculum id: goals of the pool that nobody chooses.
pub const CONTROL: &str = "her-iid-pool";

/// Its environments, as environment ids. Where its names and its appendix B describe different goals, a task
/// counts as present under either id: that of the name comes first, then those of the appendix.
pub const TASKS: [&[&str]; 11] = [
    &["MazeA"],
    &["MazeB"],
    &["MazeC"],
    &["FetchReach"],
    &["FetchPush"],
    &["FetchSlide"],
    &["FetchPickAndPlace"],
    &["HandReach"],
    &["HandManipulateBlock", "HandManipulateBlockRotateZ", "HandManipulateBlockRotateParallel"],
    &["HandManipulatePen", "HandManipulatePenRotate"],
    &["HandManipulateEgg", "HandManipulateEggRotate"],
];

/// How it is cited.
const TITLE_OF_PAPER: &str = "Chaudhary and Behera, TEACH: Temporal Variance-Driven Curriculum for Reinforcement Learning, arXiv 2512.22824, 2025";

/// How the student's method, DDPG with hindsight experience replay, is cited.
const STUDENT: &str = "Andrychowicz et al., Hindsight Experience Replay, NeurIPS 2017";

/// Where it shows its main comparison.
const FIGURES: &str = "Figures 2 and 6";

/// Protocols that do what it did, or part of it: whether they compare its methods in its environments, and
/// which fields they vary ([`teach::AXES`]).
const PROTOCOLS: [(&str, bool, &[&str]); 5] = [
    ("paper", true, &[]),
    ("reduced", true, &["confidence", "window", "interplay"]),
    ("ablation-polyak", false, &["confidence"]),
    ("ablation-window", false, &["window"]),
    ("ablation-interplay", false, &["interplay"]),
];

/// Where it can be read in more than one way, in the order in which choices are named.
const CHOICES: [ReadingChoice; 4] = [
    ReadingChoice { name: "states", pointer: "/curriculum/teach/states" },
    ReadingChoice { name: "selection", pointer: "/curriculum/teach/selection" },
    ReadingChoice { name: "record", pointer: "/curriculum/teach/record" },
    ReadingChoice { name: "evaluation goals", pointer: "/evaluation/goals" },
];

/// Everything that a report should know.
pub fn catalogue(registry: &Registry) -> Catalogue {
    let info = |entry: &Entry| MethodInfo::new(entry.id, entry.title, entry.look);
    let mut catalogue = Catalogue::of(methods(registry).map(info));
    catalogue.environments = registry.environments().iter().map(environment).collect();
    catalogue.mazes = registry.environments().iter().filter_map(maze).collect();
    catalogue.paper = paper();
    catalogue.citations = citations(registry);
    catalogue
}

/// What to cite: this program, its student, and the source of every curriculum.
fn citations(registry: &Registry) -> Vec<Citation> {
    let always = |of: &str, text: String| Citation { of: of.to_owned(), curriculum: None, text };
    let version = env!("CARGO_PKG_VERSION");
    let of_curriculum = |entry: &Entry| Citation {
        of: entry.title.to_owned(),
        curriculum: Some(entry.id.to_owned()),
        text: entry.source.to_owned(),
    };
    let everywhere = [
        always("Results", format!("The goalbench developers, goalbench, version {version}")),
        always("Paper", TITLE_OF_PAPER.to_owned()),
        always("Student", STUDENT.to_owned()),
    ];
    everywhere.into_iter().chain(methods(registry).map(of_curriculum)).collect()
}

/// All methods in the order of legends and tables: those of the paper first.
fn methods(registry: &Registry) -> impl Iterator<Item = &Entry> {
    let known = [METHOD].into_iter().chain(BASELINES).chain([CONTROL]);
    let others = registry.curricula().iter().filter(move |entry| !is_known(entry.id));
    known.filter_map(|id| registry.curriculum(id)).chain(others)
}

fn is_known(id: &str) -> bool {
    id == METHOD || id == CONTROL || BASELINES.contains(&id)
}

fn environment(entry: &envs::Environment) -> EnvironmentInfo {
    EnvironmentInfo {
        id: entry.spec.id.to_owned(),
        state: entry.spec.state,
        goal: entry.spec.goal,
        action: entry.spec.action,
        horizon: entry.spec.horizon,
        paper_action: entry.paper.map(|paper| paper.action),
        note: entry.paper.map_or_else(String::new, |paper| paper.note.to_owned()),
    }
}

fn maze(entry: &envs::Environment) -> Option<MazeInfo> {
    let walls = entry.walls?;
    let grid = walls.iter().map(|row| (*row).to_owned()).collect();
    Some(MazeInfo { id: entry.spec.id.to_owned(), grid })
}

/// The paper itself.
pub fn paper() -> Paper {
    let owned = |ids: &[&str]| ids.iter().map(|&id| id.to_owned()).collect();
    let settings = format!("/curriculum/{METHOD}");
    let protocol = |(name, comparison, axes): &(&str, bool, &[&str])| PaperProtocol {
        name: (*name).to_owned(),
        comparison: *comparison,
        axes: owned(axes),
    };
    let axis = |axis: &teach::AblationAxis| Axis {
        id: axis.id.to_owned(),
        source: format!("Figure {}", axis.figure),
        pointer: format!("{settings}/{}", axis.field),
        title: axis.title.to_owned(),
        symbol: axis.symbol.to_owned(),
        reference: axis.reference.to_owned(),
    };
    Paper {
        method: METHOD.to_owned(),
        baselines: owned(&BASELINES),
        control: Some(CONTROL.to_owned()),
        tasks: TASKS.iter().map(|ids| owned(ids)).collect(),
        protocols: PROTOCOLS.iter().map(protocol).collect(),
        figures: FIGURES.to_owned(),
        axes: teach::AXES.iter().map(axis).collect(),
        claims: claims::CLAIMS.to_vec(),
        choices: CHOICES.to_vec(),
        deviations: deviations::DEVIATIONS.to_vec(),
        settings,
    }
}

#[cfg(test)]
mod tests {
    use looks::{Dash, Look, Marker};
    use reports::analysis::catalogue::ClaimKind;
    use reports::render::figure::FALLBACK;

    use super::*;
    use crate::config;
    use crate::protocol::presets;

    #[test]
    fn a_free_look_is_nobodys() {
        let registry = Registry::builtin();
        for (i, free) in FALLBACK.iter().enumerate() {
            assert!(registry.curricula().iter().all(|entry| entry.look.as_ref() != Some(free)));
            assert!(!FALLBACK[..i].contains(free));
        }
    }

    #[test]
    fn a_method_from_outside_brings_its_title_and_its_look() {
        let builtin = Registry::builtin();
        let look = Look::new((1, 2, 3), Dash::Solid, Marker::Cross);
        let own = Entry { id: "mine", title: "Mine", look: Some(look), ..builtin.curricula()[0] };
        let catalogue = catalogue(&builtin.with_curriculum(own));
        let (mine, last) = (catalogue.method("mine"), catalogue.method(CONTROL));
        assert_eq!((mine.title.as_str(), mine.look), ("Mine", Some(look)));
        assert!(catalogue.method(METHOD) < last && last < mine, "after those of the paper");
        assert!(mine < catalogue.method("unknown"));
    }

    #[test]
    fn what_the_paper_varies_or_leaves_open_stands_in_its_methods_config() {
        let registry = Registry::builtin();
        let (method, maze) = (registry.curriculum(METHOD), registry.environment(TASKS[0][0]));
        let config = config::resolve(&registry, &maze.expect("there").spec, method.expect("there"), &[]);
        let config = serde_json::to_value(config.expect("the defaults are sound")).expect("plain data");
        let paper = paper();
        for axis in &paper.axes {
            let value = config.pointer(&axis.pointer).unwrap_or_else(|| panic!("no field {}", axis.pointer));
            assert_eq!(
                value.to_string().trim_matches('"'),
                axis.reference,
                "the default of {}",
                axis.pointer
            );
        }
        for choice in &paper.choices {
            assert!(config.pointer(choice.pointer).is_some(), "no field {}", choice.pointer);
        }
        assert!(config.pointer(&paper.settings).is_some());
    }

    #[test]
    fn the_paper_speaks_of_what_there_is() {
        let registry = Registry::builtin();
        for id in [METHOD, CONTROL].into_iter().chain(BASELINES) {
            assert!(registry.curriculum(id).is_some(), "{id}");
        }
        for id in TASKS.concat() {
            assert!(registry.environment(id).is_some(), "{id}");
        }
        let paper = paper();
        for claim in &paper.claims {
            if let ClaimKind::Values { axis, .. } = claim.kind {
                assert!(paper.axis(axis).is_some(), "{axis}");
            }
        }
        for protocol in &paper.protocols {
            assert!(presets::find(&protocol.name).is_ok(), "{}", protocol.name);
            assert!(protocol.axes.iter().all(|id| paper.axis(id).is_some()), "{}", protocol.name);
        }
        for row in &paper.deviations {
            assert!([row.topic, row.paper, row.here].iter().all(|text| !text.is_empty()), "{row:?}");
        }
    }
}
