//! What a report is told about the paper that it sets results against.

/// A paper that compares one method with baselines, as data: what it ran, what it varied, what it claims, and
/// where it can be read in more than one way.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Paper {
    /// The paper's own method, as a curriculum id.
    pub method: String,
    /// Its baselines, as curriculum ids.
    pub baselines: Vec<String>,
    /// A control that the paper lacks, as a curriculum id.
    pub control: Option<String>,
    /// Its environments, as environment ids. Where a task can be run under several ids, each of them counts.
    pub tasks: Vec<Vec<String>>,
    /// Protocols that do what it did, or part of it. Only of their results it is said what they lack for
    /// being the paper's.
    pub protocols: Vec<PaperProtocol>,
    /// Where it shows its main comparison: `Figures 2 and 6`.
    pub figures: String,
    /// JSON pointer (RFC 6901) into a run's config: where the settings of its own method stand. Those of
    /// other methods stand beside them, and everything outside the object around them is no method's.
    pub settings: String,
    /// The fields that it varies, in the order of its figures.
    pub axes: Vec<Axis>,
    /// What it claims, in the order of the ledger.
    pub claims: Vec<Claim>,
    /// Where it can be read in more than one way, in the order in which choices are named.
    pub choices: Vec<ReadingChoice>,
    /// Where results deviate from it, in the order of the table.
    pub deviations: Vec<Deviation>,
}

impl Paper {
    /// The curriculum ids of all its methods.
    pub fn methods(&self) -> impl Iterator<Item = &str> {
        let own = Some(self.method.as_str()).filter(|id| !id.is_empty());
        own.into_iter().chain(self.baselines.iter().map(String::as_str))
    }

    /// Whether an environment is one of its tasks. A paper that names none has all.
    pub fn has_task(&self, environment: &str) -> bool {
        self.tasks.is_empty() || self.tasks.iter().flatten().any(|id| id == environment)
    }

    /// The axis with this id.
    pub fn axis(&self, id: &str) -> Option<&Axis> {
        self.axes.iter().find(|axis| axis.id == id)
    }

    /// JSON pointer to what holds the settings of methods.
    pub(crate) fn outer(&self) -> &str {
        self.settings.rsplit_once('/').map_or("", |(outer, _)| outer)
    }
}

/// A protocol that does what the paper did, or part of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PaperProtocol {
    /// Its name.
    pub name: String,
    /// Whether it runs the paper's methods in the paper's environments.
    pub comparison: bool,
    /// [`Axis::id`] of the fields that it varies.
    pub axes: Vec<String>,
}

/// A field of a run's config that the paper varies.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Axis {
    /// Short name, for files and claims.
    pub id: String,
    /// Where the paper varies it: `Figure 4`.
    pub source: String,
    /// JSON pointer (RFC 6901) into a run's config.
    pub pointer: String,
    /// Title of its figures.
    pub title: String,
    /// What stands before a value: `n = 3`.
    pub symbol: String,
    /// The paper's own value as text, which the others are compared with.
    pub reference: String,
}

impl Axis {
    /// A value of it as in legends: `n = 3`.
    pub fn level(&self, value: &str) -> String {
        format!("{} = {value}", self.symbol)
    }
}

/// A claim of the paper as a statement that data can contradict.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Claim {
    /// Short name, unique in the ledger.
    pub id: &'static str,
    /// Where the paper shows it.
    pub source: &'static str,
    /// What is claimed; `{baseline}` stands for the title of a baseline.
    pub statement: &'static str,
    /// The tasks that it is about.
    pub scope: ClaimScope,
    /// What it is about.
    pub kind: ClaimKind,
}

/// The tasks that a claim is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClaimScope {
    /// All of the paper.
    All,
    /// Those whose goals have at most this dimension ([`EnvironmentInfo::goal`](super::EnvironmentInfo)).
    GoalsUpTo(usize),
    /// Those whose goals have at least this dimension.
    GoalsFrom(usize),
    /// The environments with these ids.
    Only(&'static [&'static str]),
}

/// The kinds of claims that can be judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClaimKind {
    /// The paper's method is above each of its baselines on average: one entry of the ledger per baseline.
    AboveBaselines(Measure),
    /// The paper's method is above the control that the paper lacks, on average.
    AboveControl(Measure),
    /// The paper's method is above each of its baselines wherever one looks, by the final score: one entry
    /// per baseline.
    Consistent,
    /// The values of a field against the paper's own one.
    Values {
        /// [`Axis::id`] of the field.
        axis: &'static str,
        /// The values that the claim is about, best first: it rests on the first that any run has, the others
        /// are shown and not tested. Empty: it rests on every value.
        about: &'static [&'static str],
        /// What runs are compared by.
        measure: Measure,
        /// When it counts as confirmed or refuted.
        rule: Rule,
    },
    /// No run of this program can tell, and why.
    Untestable(&'static str),
}

/// When a claim about the values of a field counts as confirmed or refuted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// "None is any better than the paper's own", on average and in any environment.
    NotAbove,
    /// "It makes no difference", in any environment.
    Equivalent,
    /// "At least one is above the paper's own", on average.
    SomeAbove,
    /// "At least one is below the paper's own", on average.
    SomeBelow,
    /// "One is better than the paper's own in one environment and worse in another".
    Mixed,
    /// "The paper's own is better than every other in some environment".
    SomewhereBest,
}

/// What a run is judged by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// The final score.
    Final,
    /// The area under the learning curve.
    Area,
    /// The noise of the learning curve: the mean size of the change of the success rate from an evaluation to
    /// the next. A run that failed has none.
    Noise,
}

/// A place where the paper can be read in more than one way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReadingChoice {
    /// What stands before a value: `states = replay`.
    pub name: &'static str,
    /// JSON pointer (RFC 6901) into a run's config.
    pub pointer: &'static str,
}

/// A known deviation from the paper, or a choice where it is silent or contradicts itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Deviation {
    /// What it is about.
    pub topic: &'static str,
    /// What the paper says, or that it says nothing.
    pub paper: &'static str,
    /// What is done here.
    pub here: &'static str,
}
