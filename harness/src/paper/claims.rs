//! What the paper claims in its sections 5.3 to 5.6, as statements that data can contradict.

use reports::analysis::catalogue::{Claim, ClaimKind, Measure, Rule};

use super::FIGURES;

/// All claims, in the order of the ledger.
pub(super) static CLAIMS: [Claim; 5] = [
    Claim {
        id: "final",
        source: FIGURES,
        statement: "TEACH reaches a higher final success than {baseline} on average over environments",
        kind: ClaimKind::AboveBaselines(Measure::Final),
    },
    Claim {
        id: "area",
        source: FIGURES,
        statement: "TEACH learns faster than {baseline} on average over environments: more area under its learning curve",
        kind: ClaimKind::AboveBaselines(Measure::Area),
    },
    Claim {
        id: "target-confidence",
        source: "Figure 3",
        statement: "Confidence of the smooth value function (the target critic) gives no better final success than that \
                    of the online networks",
        kind: ClaimKind::Values {
            axis: "confidence",
            // Section 5.4 and Eq. 12 speak of a smooth value function alone; old results have no such runs.
            about: &["target-critic", "target"],
            rule: Rule::NotAbove,
        },
    },
    Claim {
        id: "window",
        source: "Figure 4",
        statement: "Final success does not depend on the window n (each value against n = 10)",
        kind: ClaimKind::Values { axis: "window", about: &[], rule: Rule::Equivalent },
    },
    Claim {
        id: "interplay",
        source: "Figure 5",
        statement: "A larger Δ can help: some Δ > 1 gives a higher final success than Δ = 1",
        kind: ClaimKind::Values { axis: "interplay", about: &[], rule: Rule::SomeAbove },
    },
];
