//! A made-up paper of the size and shape of a real one: methods, environments, claims and readings that
//! nobody has.

use looks::colours::{BLACK, BLUE, GREEN, GREY, PURPLE, VERMILION};
use looks::{Dash, Look, Marker};

use crate::analysis::catalogue::{
    Axis, Catalogue, Citation, Claim, ClaimKind, ClaimScope, Deviation, Measure, MethodInfo, Paper,
    PaperProtocol, ReadingChoice, Rule,
};

const FIGURES: &str = "Figures 2 and 6";

/// Its methods, in the order of legends and tables: the paper's own, four baselines and a control.
const METHODS: [(&str, &str, Look); 6] = [
    ("nova", "NOVA", Look::new(VERMILION, Dash::Solid, Marker::Circle)),
    ("wren", "WREN", Look::new(BLUE, Dash::Long, Marker::Square)),
    ("kite", "KiTe", Look::new(GREEN, Dash::Short, Marker::Triangle)),
    ("moss", "MoSS", Look::new(PURPLE, Dash::DashDot, Marker::Diamond)),
    ("dull", "DULL", Look::new(BLACK, Dash::Dotted, Marker::Cross)),
    ("dull-pool", "DULL-pool", Look::new(GREY, Dash::Sparse, Marker::Wedge)),
];

/// Its tasks; the last three under either of several ids.
const TASKS: [&[&str]; 11] = [
    &["RoomA"],
    &["RoomB"],
    &["RoomC"],
    &["ArmReach"],
    &["ArmPush"],
    &["ArmSlide"],
    &["ArmPickAndPlace"],
    &["ClawReach"],
    &["ClawManipulateBlock", "ClawManipulateBlockRotate"],
    &["ClawManipulatePen", "ClawManipulatePenRotate"],
    &["ClawManipulateEgg", "ClawManipulateEggRotate"],
];

/// Its claims: that it ends higher, learns faster and is consistently better, and one about each field that
/// it varies.
const CLAIMS: [Claim; 6] = [
    above(
        "final",
        Measure::Final,
        "NOVA reaches a higher final success than {baseline} on average over environments",
    ),
    above(
        "area",
        Measure::Area,
        "NOVA learns faster than {baseline} on average over environments: more area under its learning curve",
    ),
    Claim {
        id: "consistent",
        source: FIGURES,
        statement: "NOVA reaches a higher final success than {baseline} wherever one looks",
        scope: ClaimScope::All,
        kind: ClaimKind::Consistent,
    },
    values(
        ("target-confidence", "Figure 3"),
        ("confidence", &["target-critic", "target"], Rule::NotAbove),
        "Confidence of the smooth value function (the target critic) gives no better final success than that of the \
         online networks",
    ),
    values(
        ("window", "Figure 4"),
        ("window", &[], Rule::Equivalent),
        "Final success does not depend on the window n (each value against n = 10)",
    ),
    values(
        ("interplay", "Figure 5"),
        ("interplay", &[], Rule::SomeAbove),
        "A larger Δ can help: some Δ > 1 gives a higher final success than Δ = 1",
    ),
];

const fn above(id: &'static str, measure: Measure, statement: &'static str) -> Claim {
    Claim { id, source: FIGURES, statement, scope: ClaimScope::All, kind: ClaimKind::AboveBaselines(measure) }
}

const fn values(
    (id, source): (&'static str, &'static str),
    (axis, about, rule): (&'static str, &'static [&'static str], Rule),
    statement: &'static str,
) -> Claim {
    let kind = ClaimKind::Values { axis, about, measure: Measure::Final, rule };
    Claim { id, source, statement, scope: ClaimScope::All, kind }
}

const CHOICES: [ReadingChoice; 4] = [
    ReadingChoice { name: "states", pointer: "/curriculum/nova/states" },
    ReadingChoice { name: "selection", pointer: "/curriculum/nova/selection" },
    ReadingChoice { name: "record", pointer: "/curriculum/nova/record" },
    ReadingChoice { name: "evaluation goals", pointer: "/evaluation/goals" },
];

const DEVIATIONS: [Deviation; 2] = [
    Deviation {
        topic: "Width of networks",
        paper: "does not say how wide the networks of its students are",
        here: "256 units",
    },
    Deviation { topic: "Evaluations", paper: "20 episodes", here: "20 episodes (`evaluation.episodes`)" },
];

/// The catalogue of the made-up paper. It knows no dimensions and no mazes.
pub fn catalogue() -> Catalogue {
    let method = |(id, title, look)| MethodInfo::new(id, title, Some(look));
    let mut catalogue = Catalogue::of(METHODS.map(method));
    let owned = |ids: &[&str]| ids.iter().map(|&id| id.to_owned()).collect();
    let axis = |id: &str, figure: u32, title: &str, symbol: &str, reference: &str| Axis {
        id: id.to_owned(),
        source: format!("Figure {figure}"),
        pointer: format!("/curriculum/nova/{id}"),
        title: title.to_owned(),
        symbol: symbol.to_owned(),
        reference: reference.to_owned(),
    };
    let cited = |of: &str, curriculum: Option<&str>, text: &str| Citation {
        of: of.to_owned(),
        curriculum: curriculum.map(str::to_owned),
        text: text.to_owned(),
    };
    catalogue.citations = vec![
        cited("Results", None, "Nobody, a program that was made up"),
        cited("NOVA", Some("nova"), "Nobody, NOVA"),
        cited("STARLING", Some("starling"), "Nobody, a curriculum that no run has"),
    ];
    catalogue.paper = Paper {
        method: "nova".to_owned(),
        baselines: owned(&["wren", "kite", "moss", "dull"]),
        control: Some("dull-pool".to_owned()),
        tasks: TASKS.iter().map(|ids| owned(ids)).collect(),
        protocols: vec![PaperProtocol {
            name: "made-up paper".to_owned(),
            comparison: true,
            axes: owned(&["confidence", "window", "interplay"]),
        }],
        figures: FIGURES.to_owned(),
        settings: "/curriculum/nova".to_owned(),
        axes: vec![
            axis(
                "confidence",
                3,
                "confidence of online networks, or smoothed by target networks",
                "confidence",
                "online",
            ),
            axis("window", 4, "temporal window n", "n", "10"),
            axis("interplay", 5, "interplay frequency Δ", "Δ", "1"),
        ],
        claims: CLAIMS.to_vec(),
        choices: CHOICES.to_vec(),
        deviations: DEVIATIONS.to_vec(),
    };
    catalogue
}
