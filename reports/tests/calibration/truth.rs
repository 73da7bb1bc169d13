//! What is true in a simulated experiment, and how large the experiment is.

use super::curve::MeanFinal;
use reports::analysis::ledger::Verdict;

/// Mean ceilings of the success rates of environments, in turn.
const CEILINGS: [f64; 3] = [0.6, 0.7, 0.8];
/// Chance that a run collapses, where runs do.
const COLLAPSE: f64 = 0.1;

/// The size of an experiment.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Design {
    pub(crate) environments: usize,
    pub(crate) seeds: u64,
    /// Baselines that the paper's method is compared with.
    pub(crate) baselines: usize,
}

impl Design {
    pub(crate) const fn new(environments: usize, seeds: u64, baselines: usize) -> Self {
        Self { environments, seeds, baselines }
    }

    pub(crate) fn title(self) -> String {
        let Self { environments, seeds, baselines } = self;
        format!("{environments} × {seeds}, {baselines} baselines")
    }
}

/// How the paper's method, with its default settings, differs from all others: from the baselines, and from
/// other values of a setting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Truth {
    /// All methods are alike.
    Equal,
    /// The method ends a little higher, but one run in ten collapses, so that means are equal.
    Collapses,
    /// It ends higher by so much in half of the environments and lower by as much in the others.
    Mixed(f64),
    /// It ends higher by so much than all others, everywhere.
    Above(f64),
    /// It ends higher by so much than the first baseline and the first other value, everywhere.
    AboveOne(f64),
}

/// All of them, in the order of tables.
pub(crate) const TRUTHS: [Truth; 9] = [
    Truth::Equal,
    Truth::Collapses,
    Truth::Mixed(0.2),
    Truth::Above(0.05),
    Truth::Above(0.1),
    Truth::Above(0.2),
    Truth::AboveOne(0.05),
    Truth::AboveOne(0.1),
    Truth::AboveOne(0.2),
];

impl Truth {
    pub(crate) fn title(self) -> String {
        match self {
            Self::Equal => "all alike".to_owned(),
            Self::Collapses => "equal means, rare collapses".to_owned(),
            Self::Mixed(by) => format!("+{by} and −{by} in turn"),
            Self::Above(by) => format!("+{by} over all others"),
            Self::AboveOne(by) => format!("+{by} over one"),
        }
    }

    /// By how much the method's mean final success is above that of baseline or value `index` in the
    /// environment at `place` of so many.
    pub(crate) fn lead(self, index: usize, place: usize, environments: usize) -> f64 {
        match self {
            Self::Equal | Self::Collapses => 0.0,
            // An odd environment out has no difference, so that the mean over all is 0.
            Self::Mixed(_) if place + 1 == environments && environments % 2 == 1 => 0.0,
            Self::Mixed(by) => by * if place.is_multiple_of(2) { 1.0 } else { -1.0 },
            Self::Above(by) => by,
            Self::AboveOne(by) => by * f64::from(u8::from(index == 0)),
        }
    }

    /// The right verdict on "the method is above baseline `index` on average over environments", if there is
    /// one.
    pub(crate) fn above(self, index: usize) -> Option<Verdict> {
        let is_above = match self {
            Self::Equal | Self::Collapses | Self::Mixed(_) => false,
            Self::Above(_) => true,
            Self::AboveOne(_) => index == 0,
        };
        is_above.then_some(Verdict::Confirmed)
    }

    /// The right verdict on "the setting makes no difference", where smaller ones than `margin` are none. At
    /// the margin itself neither is right.
    pub(crate) fn invariance(self, margin: f64) -> Option<Verdict> {
        let largest = match self {
            Self::Equal | Self::Collapses => 0.0,
            Self::Mixed(by) | Self::Above(by) | Self::AboveOne(by) => by,
        };
        if (largest - margin).abs() < 1e-9 {
            None
        } else {
            Some(if largest < margin { Verdict::Confirmed } else { Verdict::Refuted })
        }
    }
}

/// How the runs of a method turn out in an environment.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Outlook {
    /// Mean ceiling.
    pub(crate) ceiling: f64,
    /// Chance that a run is at 0 throughout.
    pub(crate) collapse: f64,
}

/// The outlooks of the method and of the others, by environment.
pub(crate) struct World {
    /// `[environments]`
    own: Vec<Outlook>,
    /// Those of the first baseline and the first value, and those of all others, `[environments]`.
    others: Vec<[Outlook; 2]>,
}

impl World {
    pub(crate) fn new(truth: Truth, environments: usize, mean: &MeanFinal) -> Self {
        let collapse = if truth == Truth::Collapses { COLLAPSE } else { 0.0 };
        let own = |place: usize| Outlook { ceiling: CEILINGS[place % CEILINGS.len()], collapse };
        let other = |place: usize, index: usize| {
            let Outlook { ceiling, collapse } = own(place);
            let mean_final = (1.0 - collapse) * mean.of(ceiling) - truth.lead(index, place, environments);
            Outlook { ceiling: mean.ceiling(mean_final), collapse: 0.0 }
        };
        Self {
            own: (0..environments).map(own).collect(),
            others: (0..environments).map(|place| [0, 1].map(|index| other(place, index))).collect(),
        }
    }

    /// The outlook of the paper's method with its default settings in the environment at `place`.
    pub(crate) fn method(&self, place: usize) -> Outlook {
        self.own[place]
    }

    /// That of baseline, or of value, `index`.
    pub(crate) fn other(&self, index: usize, place: usize) -> Outlook {
        self.others[place][index.min(1)]
    }
}
