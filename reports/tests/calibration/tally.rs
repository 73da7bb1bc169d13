//! What reports say of simulated experiments, counted.

use std::ops::AddAssign;

use rayon::prelude::*;
use reports::ReportOptions;
use reports::analysis::comparison::{self, ALPHA, Comparison, TestFamily};
use reports::analysis::group;
use reports::analysis::ledger::{self, LedgerEntry, Verdict};
use reports::analysis::options::MARGIN;
use reports::stats::Resampling;
use reports::store::Store;

use super::curve::{MeanFinal, WINDOW};
use super::experiment::{paper, simulate};
use super::truth::{Design, Truth, World};

/// Verdicts of one kind of claim.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Verdicts {
    pub(crate) confirmed: u64,
    pub(crate) undecided: u64,
    pub(crate) refuted: u64,
}

impl Verdicts {
    fn count(&mut self, verdict: Verdict) {
        match verdict {
            Verdict::Confirmed => self.confirmed += 1,
            Verdict::Undecided | Verdict::Untestable => self.undecided += 1,
            Verdict::Refuted => self.refuted += 1,
        }
    }

    pub(crate) fn all(self) -> u64 {
        self.confirmed + self.undecided + self.refuted
    }
}

impl AddAssign for Verdicts {
    fn add_assign(&mut self, other: Self) {
        self.confirmed += other.confirmed;
        self.undecided += other.undecided;
        self.refuted += other.refuted;
    }
}

/// What was said of all experiments of one design under one truth.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tally {
    pub(crate) experiments: u64,
    /// "The method is above this baseline", of those that it is above, or of all where it is above none.
    pub(crate) above: Verdicts,
    /// Experiments with a false verdict on any baseline.
    pub(crate) above_false: u64,
    /// "The setting makes no difference".
    pub(crate) invariance: Verdicts,
    /// Comparisons of methods in one environment that differ.
    pub(crate) different: u64,
    /// Those of them that are significant after Holm's correction, in the right direction.
    pub(crate) found: u64,
    /// Experiments with a comparison that is significant and false.
    pub(crate) found_false: u64,
}

impl AddAssign for Tally {
    fn add_assign(&mut self, other: Self) {
        self.experiments += other.experiments;
        self.above += other.above;
        self.above_false += other.above_false;
        self.invariance += other.invariance;
        self.different += other.different;
        self.found += other.found;
        self.found_false += other.found_false;
    }
}

/// How to simulate.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Effort {
    /// Experiments per design and truth.
    pub(crate) repetitions: u64,
    /// Sign flips that are drawn where there are too many to enumerate.
    pub(crate) flips: usize,
}

impl Tally {
    /// The reports on so many experiments of `design`, in parallel. Every design and truth has random streams
    /// of its own.
    pub(crate) fn of(design: Design, truth: Truth, seed: u64, effort: Effort) -> Self {
        let options = ReportOptions {
            window: WINDOW,
            resampling: Resampling { resamples: effort.flips, ..Resampling::default() },
            catalogue: paper(design.baselines),
            ..ReportOptions::default()
        };
        // Bootstrap intervals of comparisons describe; no test rests on them.
        let few = Resampling { resamples: 2, ..options.resampling };
        let few = ReportOptions { resampling: few, ..options.clone() };
        let world = World::new(truth, design.environments, &MeanFinal::new());
        let one = |repetition| {
            let store = simulate(&world, design, &options.catalogue, (seed, repetition));
            Self::one(&store, [&options, &few], design, truth)
        };
        let sum = |mut a: Self, b: Self| {
            a += b;
            a
        };
        (0..effort.repetitions).into_par_iter().map(one).reduce(Self::default, sum)
    }

    /// One experiment, with the options of the ledger and those of comparisons.
    fn one(store: &Store, [options, few]: [&ReportOptions; 2], design: Design, truth: Truth) -> Self {
        let mut tally = Self { experiments: 1, ..Self::default() };
        let groups = group::groups(store, &options.catalogue);
        tally.judge(&ledger::ledger(&groups, options), options, truth);
        let keys: Vec<_> = groups.iter().map(|group| &group.key).collect();
        let comparisons = comparison::comparisons(&groups, &group::compared(&keys), few);
        tally.compare(&comparisons, options, design, truth);
        tally
    }

    fn judge(&mut self, ledger: &[LedgerEntry], options: &ReportOptions, truth: Truth) {
        let mut any_false = false;
        let is_above_any = truth.above(0).is_some();
        for (index, id) in options.catalogue.paper.baselines.iter().enumerate() {
            let verdict = entry(ledger, &format!("final-{id}"));
            any_false |= is_false(verdict, truth.above(index));
            if truth.above(index).is_some() || !is_above_any {
                self.above.count(verdict);
            }
        }
        self.above_false += u64::from(any_false);
        self.invariance.count(entry(ledger, "window"));
    }

    fn compare(
        &mut self,
        comparisons: &[Comparison<'_>],
        options: &ReportOptions,
        design: Design,
        truth: Truth,
    ) {
        let mut any_false = false;
        for one in comparisons.iter().filter(|one| one.family == TestFamily::Methods) {
            let index = options.catalogue.paper.baselines.iter().position(|id| one.method.is_of(id)).unwrap();
            let place = options
                .catalogue
                .paper
                .tasks
                .iter()
                .position(|ids| ids[0] == one.method.environment)
                .unwrap();
            let lead = truth.lead(index, place, design.environments);
            let is_significant = one.p_holm.is_some_and(|p| p <= ALPHA);
            // Differences are baseline minus method.
            let is_right = one.difference.is_some_and(|difference| difference * lead < 0.0);
            self.different += u64::from(lead != 0.0);
            self.found += u64::from(is_significant && is_right);
            any_false |= is_significant && !is_right;
        }
        self.found_false += u64::from(any_false);
    }

    /// Verdicts on the setting that are false.
    pub(crate) fn invariance_false(&self, truth: Truth) -> u64 {
        let Verdicts { confirmed, refuted, .. } = self.invariance;
        match truth.invariance(MARGIN) {
            Some(Verdict::Confirmed) => refuted,
            Some(_) => confirmed,
            None => confirmed + refuted,
        }
    }
}

fn entry(ledger: &[LedgerEntry], id: &str) -> Verdict {
    ledger.iter().find(|entry| entry.id == id).unwrap().verdict
}

fn is_false(verdict: Verdict, right: Option<Verdict>) -> bool {
    verdict != Verdict::Undecided && Some(verdict) != right
}
