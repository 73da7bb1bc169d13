//! What to cite: the program, the paper, and the sources of the methods that were run.

use super::{Artefact, Section};
use crate::analysis::catalogue::Citation;
use crate::analysis::whole::Analysis;
use crate::error::ReportError;
use crate::render::table::{Column, Sheet};

const SECTION: Section = Section::Named { id: "citations", title: "How to cite" };

pub(super) const ROW: Artefact = Artefact::table("citations", SECTION, "citation", sheet);

fn sheet(analysis: &Analysis<'_>) -> Result<Sheet, ReportError> {
    let runs = analysis.store.runs();
    let was_run = |citation: &&Citation| {
        let is_of = |curriculum: &String| runs.iter().any(|run| run.key().curriculum == *curriculum);
        citation.curriculum.as_ref().is_none_or(is_of)
    };
    let shown: Vec<&Citation> = analysis.catalogue().citations.iter().filter(was_run).collect();
    let columns = [
        Column::only_named("For", |row: &&Citation| row.of.clone()),
        Column::only_named("Cite", |row: &&Citation| row.text.clone()),
    ];
    let caption = "What these results rest on: the program, and the sources of the curricula that were run.";
    Sheet::of(caption.to_owned(), &shown, &columns)
}
