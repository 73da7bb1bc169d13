//! The page about the paper: what it claims, and what it leaves open.

use std::fmt::Write as _;

use reports::analysis::catalogue::{Catalogue, Claim, ClaimKind, ClaimScope};

use crate::Registry;
use crate::paper;

const INTRODUCTION: &str = "\
# What the paper says, and what it leaves open

*TEACH: Temporal Variance-Driven Curriculum for Reinforcement Learning* (Chaudhary and Behera, arXiv 2512.22824) is what
goalbench reproduces. `goalbench help paper` prints this page, which is made from the same tables as reports: they judge each
claim by the data at hand ([the ledger](reports.md#the-ledger-of-the-papers-claims)) and list each deviation.

## Claims
";

const OPEN: &str = "
## What it leaves open

Where the paper is silent or contradicts itself, something has to be chosen. Most choices are config fields, so that whoever
reads the paper otherwise can train under that reading, too; [Does a verdict hang on the
reading?](reports.md#does-a-verdict-hang-on-the-reading) tells how reports compare them.

| topic | the paper | here |
|---|---|---|
";

/// The page, in Markdown.
pub(super) fn page(registry: &Registry) -> String {
    let catalogue = paper::catalogue(registry);
    let titles = |ids: &[String]| {
        let titles: Vec<String> = ids.iter().map(|id| catalogue.method(id).title.clone()).collect();
        titles.join(", ")
    };
    let mut text = INTRODUCTION.to_owned();
    let _ = writeln!(
        text,
        "\nThe paper compares {} with {}, in {} tasks ({}).{}\n",
        catalogue.method(&catalogue.paper.method).title,
        titles(&catalogue.paper.baselines),
        catalogue.paper.tasks.len(),
        catalogue.paper.figures,
        catalogue.paper.control.iter().fold(String::new(), |text, id| {
            text + &format!(
                " Goalbench adds the control {}, which draws from the same pool and chooses nothing.",
                catalogue.method(id).title
            )
        }),
    );
    text += "| claim | where | what | tasks |\n|---|---|---|---|\n";
    for claim in &catalogue.paper.claims {
        let Claim { id, source, .. } = claim;
        let (statement, scope) = (statement(claim, &catalogue), scope(claim, &catalogue));
        let _ = writeln!(text, "| `{id}` | {source} | {statement} | {scope} |");
    }
    text += OPEN;
    for row in &catalogue.paper.deviations {
        let cells = [row.topic, row.paper, row.here].map(|cell| cell.replace('|', "\\|"));
        let _ = writeln!(text, "| {} |", cells.join(" | "));
    }
    text
}

/// A claim in words, about whichever baseline, or about the control.
fn statement(claim: &Claim, catalogue: &Catalogue) -> String {
    let control = || catalogue.paper.control.as_ref().map(|id| catalogue.title(id));
    let is_of_control = matches!(claim.kind, ClaimKind::AboveControl(_));
    let baseline = is_of_control.then(control).flatten().unwrap_or_else(|| "each baseline".to_owned());
    claim.statement.replace("{baseline}", &baseline).replace('|', "\\|")
}

/// The tasks that a claim is about, in words.
fn scope(claim: &Claim, catalogue: &Catalogue) -> String {
    match claim.scope {
        ClaimScope::All => "all".to_owned(),
        ClaimScope::GoalsUpTo(most) => format!("goals of at most {most} numbers"),
        ClaimScope::GoalsFrom(least) => format!("goals of at least {least} numbers"),
        ClaimScope::Only(ids) => {
            let known = ids.iter().filter(|id| catalogue.environments.iter().any(|info| info.id == **id));
            known.copied().collect::<Vec<_>>().join(", ")
        }
    }
}
