//! The claims of a paper as testable statements, each with a verdict on the data at hand.
//!
//! Comparable runs are compared, paired by seed, by the sign-flip test
//! ([`stats::sign_flip`](crate::stats::sign_flip)) over all pairs, in strata of one per environment; overlap
//! of bands never counts. Its null is that the two runs of a pair are exchangeable. A verdict on an average
//! reads the interval that inverts the test (what lies outside is refused), and needs the same test of the
//! pairs' signs to say the same: means can be the work of a few collapsed runs. Claims of no difference are
//! judged in every environment, for averages hide differences of opposite sign.
//!
//! Where a claim (or a family of claims of one kind) looks at several intervals, each is widened by
//! Bonferroni's correction, so that all of them together keep the confidence; over environments, which share
//! no runs, by Hochberg's.

mod effect;
mod rules;
mod students;
mod values;
mod verdict;
mod versus;

pub use effect::{Effect, PlaceEffect};
pub use verdict::Verdict;
pub(crate) use versus::{Versus, corrected};

use crate::analysis::catalogue::{Claim, ClaimKind, ClaimScope, EnvironmentInfo, Measure};
use crate::analysis::complete::Pair;
use crate::analysis::group::Group;
use crate::analysis::options::ReportOptions;
use values::Values;

/// A claim and its verdict.
#[derive(Clone, Debug, PartialEq)]
pub struct LedgerEntry {
    /// Short name, unique in the ledger.
    pub id: String,
    /// Where the paper shows it.
    pub source: &'static str,
    /// What is claimed, as a statement that data can contradict.
    pub statement: String,
    /// When it counts as confirmed or refuted.
    pub rule: String,
    /// What the data say.
    pub verdict: Verdict,
    /// The value whose effect decides, where the claim is about several: `Δ = 5`; with its environment where
    /// each is judged: `n = 3 in MazeA`.
    pub value: Option<String>,
    /// The difference that decides: of several the one that the verdict hangs on.
    pub effect: Effect,
    /// Coverage of its interval after the correction.
    pub confidence: f64,
    /// What the verdict rests on, or what is missing for one.
    pub evidence: String,
}

/// The whole ledger: every claim of the catalogue's paper on the paper's tasks, also those claims that the
/// data say nothing about. `groups` come in order; those of other environments decide nothing.
pub fn ledger(groups: &[Group<'_>], options: &ReportOptions) -> Vec<LedgerEntry> {
    Judge { groups: &of_tasks(groups, options, true), options }.judge()
}

/// The same claims on the environments that are none of the paper's tasks; of the claims only those that
/// these have runs for. The paper says nothing of them.
pub fn ledger_elsewhere(groups: &[Group<'_>], options: &ReportOptions) -> Vec<LedgerEntry> {
    let mut entries = Judge { groups: &of_tasks(groups, options, false), options }.judge();
    entries.retain(|entry| entry.effect.pairs > 0);
    entries
}

/// The groups of the paper's tasks, or all others; those of archives decide nothing.
pub(crate) fn of_tasks<'a>(groups: &[Group<'a>], options: &ReportOptions, inside: bool) -> Vec<Group<'a>> {
    let paper = &options.catalogue.paper;
    let of_it = |group: &&Group<'a>| group.is_own() && paper.has_task(&group.key.environment) == inside;
    groups.iter().filter(of_it).cloned().collect()
}

/// What claims are judged by.
struct Judge<'a> {
    groups: &'a [Group<'a>],
    options: &'a ReportOptions,
}

impl Judge<'_> {
    fn judge(&self) -> Vec<LedgerEntry> {
        self.options.catalogue.paper.claims.iter().flat_map(|claim| self.claim(claim)).collect()
    }

    fn claim(&self, claim: &Claim) -> Vec<LedgerEntry> {
        let paper = &self.options.catalogue.paper;
        let groups = self.in_scope(claim.scope);
        match claim.kind {
            ClaimKind::AboveBaselines(measure) => self.above(claim, &groups, &paper.baselines, measure),
            ClaimKind::AboveControl(measure) => {
                let control: Vec<String> = paper.control.iter().cloned().collect();
                self.above(claim, &groups, &control, measure)
            }
            ClaimKind::Consistent => self.above(claim, &groups, &paper.baselines, Measure::Final),
            ClaimKind::Values { axis, about, measure, rule } => {
                let values = |axis| self.values(claim, &groups, &Values { axis, about, measure, rule });
                paper.axis(axis).map(values).into_iter().collect()
            }
            ClaimKind::Untestable(reason) => vec![LedgerEntry {
                id: claim.id.to_owned(),
                source: claim.source,
                statement: claim.statement.to_owned(),
                rule: "no rule: nothing here can tell".to_owned(),
                verdict: Verdict::Untestable,
                value: None,
                effect: Effect::default(),
                confidence: self.options.resampling.confidence,
                evidence: reason.to_owned(),
            }],
        }
    }

    /// The groups of the environments that a claim is about.
    fn in_scope(&self, scope: ClaimScope) -> Vec<Group<'_>> {
        let environments = &self.options.catalogue.environments;
        let is_in = |environment: &str| {
            let goal = |is: &dyn Fn(usize) -> bool| {
                let is_it = |info: &&EnvironmentInfo| info.id == environment;
                environments.iter().find(is_it).is_some_and(|info| is(info.goal))
            };
            match scope {
                ClaimScope::All => true,
                ClaimScope::GoalsUpTo(most) => goal(&|dimension| dimension <= most),
                ClaimScope::GoalsFrom(fewest) => goal(&|dimension| dimension >= fewest),
                ClaimScope::Only(ids) => ids.contains(&environment),
            }
        };
        self.groups.iter().filter(|group| is_in(&group.key.environment)).cloned().collect()
    }

    /// The paper's method against each of `baselines`, in every environment that has both with default
    /// settings.
    fn above(
        &self,
        claim: &Claim,
        groups: &[Group<'_>],
        baselines: &[String],
        measure: Measure,
    ) -> Vec<LedgerEntry> {
        let catalogue = &self.options.catalogue;
        let resampling = corrected(self.options.resampling, baselines.len());
        let default = |curriculum: &str| {
            let of_it = groups.iter().filter(move |group| group.key.curriculum.id == curriculum);
            of_it.filter(|group| group.key.variant == "default").collect::<Vec<_>>()
        };
        let own = default(&catalogue.paper.method);
        let judged = |baseline: &String| {
            let others = default(baseline);
            let mut pairs: Vec<Pair<'_>> = Vec::new();
            for group in &own {
                let here = others.iter().find(|other| other.key.environment == group.key.environment);
                pairs.extend(here.map(|other| Pair::of(group, other)));
            }
            let versus = Versus { claim, measure, baseline, title: &catalogue.title(baseline) };
            match claim.kind {
                ClaimKind::Consistent => versus.judge_everywhere(&pairs, self.options, resampling),
                _ => versus.judge(&pairs, self.options, resampling),
            }
        };
        baselines.iter().map(judged).collect()
    }
}
