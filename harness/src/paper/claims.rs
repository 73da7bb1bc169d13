//! What the paper claims in its sections 5.3 to 5.6, as statements that data can contradict, and what we ask
//! beside it.

use reports::analysis::catalogue::{Claim, ClaimKind, ClaimScope, Measure, Rule};

use super::FIGURES;

/// A claim about all tasks.
const fn claim(id: &'static str, source: &'static str, statement: &'static str, kind: ClaimKind) -> Claim {
    Claim { id, source, statement, scope: ClaimScope::All, kind }
}

/// The same claim about some tasks alone.
const fn on(scope: ClaimScope, claim: Claim) -> Claim {
    Claim { scope, ..claim }
}

/// Values of a field by their final success.
const fn values(axis: &'static str, about: &'static [&'static str], rule: Rule) -> ClaimKind {
    by(Measure::Final, axis, about, rule)
}

const fn by(measure: Measure, axis: &'static str, about: &'static [&'static str], rule: Rule) -> ClaimKind {
    ClaimKind::Values { axis, about, measure, rule }
}

/// Section 5.4 and Eq. 12 speak of a smooth value function alone; old results have no such runs.
const SMOOTH: &[&str] = &["target-critic", "target"];

/// "Low-context tasks, such as Maze navigation": mazes and Fetch have goals of 2 and 3 dimensions.
const LOW: ClaimScope = ClaimScope::GoalsUpTo(3);

/// "High-context tasks, such as HandManipulation": these have goals of 7 dimensions, HandReach of 15.
const HIGH: ClaimScope = ClaimScope::GoalsFrom(7);

/// All claims, in the order of the ledger.
pub(super) static CLAIMS: [Claim; 18] = [
    claim(
        "final",
        FIGURES,
        "TEACH reaches a higher final success than {baseline} on average over environments",
        ClaimKind::AboveBaselines(Measure::Final),
    ),
    claim(
        "area",
        FIGURES,
        "TEACH learns faster than {baseline} on average over environments: more area under its learning curve",
        ClaimKind::AboveBaselines(Measure::Area),
    ),
    on(
        LOW,
        claim(
            "area-low",
            "Section 5.3",
            "TEACH learns faster than {baseline} in tasks with low-dimensional goals (at most 3)",
            ClaimKind::AboveBaselines(Measure::Area),
        ),
    ),
    on(
        HIGH,
        claim(
            "area-high",
            "Section 5.3",
            "TEACH learns faster than {baseline} in tasks with high-dimensional goals (at least 7)",
            ClaimKind::AboveBaselines(Measure::Area),
        ),
    ),
    claim(
        "consistent",
        "Section 5.3",
        "TEACH consistently yields better policies than {baseline}: on average and in most environments, and in none worse ones",
        ClaimKind::Consistent,
    ),
    claim(
        "control",
        "ours",
        "TEACH reaches a higher final success than {baseline} on average over environments: it gains by choosing goals, not \
         by choosing them from a fixed pool",
        ClaimKind::AboveControl(Measure::Final),
    ),
    claim(
        "target-confidence",
        "Section 5.4",
        "Confidence of the smooth value function (the target critic) gives no better final success than that of the online \
         networks",
        values("confidence", SMOOTH, Rule::NotAbove),
    ),
    claim(
        "target-confidence-similar",
        "Figure 3",
        "Confidence of the smooth value function gives a final success similar to that of the online networks",
        values("confidence", SMOOTH, Rule::Equivalent),
    ),
    on(
        ClaimScope::Only(&["FetchPickAndPlace"]),
        claim(
            "target-confidence-pick",
            "Section 5.4",
            "Confidence of the smooth value function gives a higher final success in FetchPickAndPlace",
            values("confidence", SMOOTH, Rule::SomeAbove),
        ),
    ),
    on(
        ClaimScope::Only(&["FetchPush"]),
        claim(
            "target-confidence-push",
            "Section 5.4",
            "Confidence of the smooth value function gives a lower final success in FetchPush",
            values("confidence", SMOOTH, Rule::SomeBelow),
        ),
    ),
    claim(
        "window",
        "Figure 4",
        "Final success does not depend on the window n (each value against n = 10)",
        values("window", &[], Rule::Equivalent),
    ),
    claim(
        "window-best",
        "Section 5.5",
        "n = 10 gives better final success than every other window in some tasks",
        values("window", &[], Rule::SomewhereBest),
    ),
    claim(
        "window-noise-small",
        "Section 5.5",
        "n = 10 is less sensitive to noise than a smaller window: with n = 3 the success rate changes more from an evaluation \
         to the next",
        by(Measure::Noise, "window", &["3"], Rule::SomeAbove),
    ),
    claim(
        "window-noise",
        "ours",
        "A window larger than n = 10 reduces noise further: with n = 20 the success rate changes less from an evaluation to \
         the next",
        by(Measure::Noise, "window", &["20"], Rule::SomeBelow),
    ),
    claim(
        "interplay",
        "Figure 5",
        "A larger Δ can help: some Δ > 1 gives a higher final success than Δ = 1",
        values("interplay", &[], Rule::SomeAbove),
    ),
    claim(
        "interplay-area",
        "Section 5.6",
        "A larger Δ can lead to faster learning: some Δ > 1 has more area under its learning curve than Δ = 1",
        by(Measure::Area, "interplay", &[], Rule::SomeAbove),
    ),
    claim(
        "interplay-tasks",
        "Figure 5",
        "Different tasks ask for different Δ: some Δ > 1 gives a higher final success than Δ = 1 in one task and a lower one \
         in another",
        values("interplay", &[], Rule::Mixed),
    ),
    claim(
        "interplay-adaptive",
        "Section 5.6",
        "An adaptive interplay is more stable and better than every fixed Δ",
        ClaimKind::Untestable(
            "not testable here: there is no adaptive interplay, and the paper describes none",
        ),
    ),
];
