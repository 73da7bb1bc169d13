//! The claims about baselines under every reading of the paper.

use super::{Artefact, Section, columns};
use crate::analysis::ledger::LedgerEntry;
use crate::analysis::options::ReportOptions;
use crate::analysis::readings::{JudgedClaim, ReadingFamily, Readings};
use crate::analysis::whole::Analysis;
use crate::error::ReportError;
use crate::render::table::cells::{or_undefined, p_value, with_interval};
use crate::render::table::{Column, Sheet};
use crate::wording::counted;

const SECTION: Section =
    Section::Named { id: "readings", title: "Does a claim's verdict hang on the reading?" };

pub(super) const ROW: Artefact =
    Artefact::table("readings", SECTION, "claim and reading of the paper", sheet);

/// A claim under a reading, or what it comes to under all of them: a remark.
struct Judged<'a> {
    family: &'a ReadingFamily,
    claim: &'a JudgedClaim,
    under: Option<&'a (usize, LedgerEntry)>,
}

fn sheet(analysis: &Analysis<'_>) -> Result<Sheet, ReportError> {
    let rows: Vec<Judged<'_>> = analysis.readings.families.iter().flat_map(judged).collect();
    let method = analysis.catalogue().title(&analysis.paper().method);
    Sheet::with_remarks(caption(analysis), &rows, &columns(&method), |row| row.under.is_none())
}

/// All of a family, claim by claim, each followed by what it comes to.
fn judged(family: &ReadingFamily) -> impl Iterator<Item = Judged<'_>> {
    family.claims.iter().flat_map(move |claim| {
        let single = claim.judged.iter().map(Some).chain([None]);
        single.map(move |under| Judged { family, claim, under })
    })
}

impl Judged<'_> {
    fn entry(&self) -> Option<&LedgerEntry> {
        self.under.map(|(_, entry)| entry)
    }

    fn number(&self) -> Option<usize> {
        self.under.map(|(number, _)| *number)
    }

    /// The claim, `at Δ = 10` where the method's other settings are not the default ones.
    fn statement(&self) -> String {
        let at = self.family.at().map_or_else(String::new, |at| format!(", {at}"));
        let first = self.claim.judged.first();
        first.map(|(_, entry)| format!("{}{at}", entry.statement)).unwrap_or_default()
    }

    fn reading(&self) -> String {
        let named = |number| format!("{number}: {}", self.family.reading(number));
        self.number().map_or_else(|| "all together".to_owned(), named)
    }

    fn verdict(&self) -> &'static str {
        let together = || if self.claim.hangs() { "hangs on it" } else { "the same" };
        self.entry().map_or_else(together, |entry| entry.verdict.as_str())
    }

    fn effect(&self) -> String {
        let effect = |entry: &LedgerEntry| {
            let effect = &entry.effect;
            or_undefined(effect.difference, |difference| with_interval(difference, effect.interval))
        };
        self.entry().map(effect).unwrap_or_default()
    }
}

fn columns<'a>(method: &str) -> Vec<Column<'a, Judged<'a>>> {
    let of_family = format!(
        "what {method}'s other settings, the same for all readings of a family, have apart from the default ones; empty \
         for those"
    );
    let text = |value: &str| Some(value.to_owned()).filter(|value| !value.is_empty());
    let mut columns = vec![
        Column::text("claim", "short name, as in the ledger", |row: &Judged<'_>| {
            row.entry().map(|entry| entry.id.clone())
        })
        .named("Claim", Judged::statement),
        Column::text("family", of_family, move |row: &Judged<'_>| text(&row.family.name)),
        Column::count(
            "reading",
            "number of the reading, the same for all claims of its family",
            |row: &Judged<'_>| row.number().map(|number| number as u64),
        )
        .named("Reading", Judged::reading),
        Column::text(
            "settings",
            "the settings that the reading is named by, and in parentheses those that gave the same runs",
            |row: &Judged<'_>| row.number().map(|number| row.family.reading(number)),
        ),
        Column::text(
            "verdict",
            "`confirmed`, `refuted` or `undecided`, by the ledger's rule",
            |row: &Judged<'_>| row.verdict().to_owned(),
        )
        .named("Verdict", |row| row.verdict().to_owned()),
    ];
    columns.extend(columns::effect(
        |row: &Judged<'_>| row.entry(),
        "difference of success rates under this reading, mean over environments",
        "coverage of that interval after Bonferroni's correction for the claim's readings",
    ));
    columns.extend([
        Column::text(
            "evidence",
            "what the verdict rests on, or what is missing for one",
            |row: &Judged<'_>| row.entry().map(|entry| entry.evidence.clone()),
        )
        .named("Evidence", |row| {
            row.entry().map_or_else(|| row.claim.conclusion.clone(), |entry| entry.evidence.clone())
        }),
        Column::text(
            "conclusion",
            "whether the claim's verdict is the same under all readings",
            |row: &Judged<'_>| row.claim.conclusion.clone(),
        ),
        Column::only_shown("p", |row: &Judged<'_>| {
            row.entry().map(|entry| or_undefined(entry.effect.p, p_value)).unwrap_or_default()
        }),
        Column::only_shown("Effect", Judged::effect),
    ]);
    columns
}

/// `MazeA, MazeB; at Δ = 10: MazeA`: environments by family, those without any left out.
fn by_family(readings: &Readings, environments: impl Fn(&ReadingFamily) -> &[String]) -> String {
    let part = |family: &ReadingFamily| {
        let at = family.at().map_or_else(String::new, |at| format!("{at}: "));
        let names = environments(family).join(", ");
        (!names.is_empty()).then(|| format!("{at}{names}"))
    };
    readings.families.iter().filter_map(part).collect::<Vec<_>>().join("; ")
}

fn caption(analysis: &Analysis<'_>) -> String {
    let Analysis { readings, options: ReportOptions { window, resampling, fewest_pairs, .. }, .. } = analysis;
    let method = analysis.catalogue().title(&analysis.paper().method);
    let left_out = match by_family(readings, |family| &family.left_out) {
        names if names.is_empty() => names,
        names => format!(" Left out, for they lack some of these readings: {names}."),
    };
    let (window, pairs) = (counted(*window, "evaluation"), counted(*fewest_pairs, "pair"));
    format!(
        "The claims about baselines under every reading of the paper that {method} was run with, from the environments that \
         have all of them: {}.{left_out} A reading is named by the settings that differ between readings; readings whose \
         runs are the same evaluation by evaluation are one. {method}'s other settings are the same for all readings of a \
         claim, which names those that are not the default ones. {method} under each is set against the baseline's runs of \
         the same settings outside the curriculum, evaluation goals included, by the rule and the test of the ledger: \
         final success over the last {window} or area under the curve, finished runs of the same evaluations, \
         at least {pairs} in all. p: of the sign-flip test, uncorrected. Brackets: what the \
         test does not refuse, at {} % together for the readings of one claim (Bonferroni's correction: the level over the \
         number of readings). Readings with different verdicts need not differ from each other: one that is undecided may \
         only lack runs.",
        by_family(readings, |family| &family.environments),
        columns::percent(resampling.confidence),
    )
}
