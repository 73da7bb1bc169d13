//! The list of known deviations from the paper.

use super::{Artefact, Section};
use crate::analysis::catalogue::Deviation;
use crate::analysis::whole::Analysis;
use crate::error::ReportError;
use crate::render::table::{Column, Sheet};

const SECTION: Section = Section::Named { id: "deviations", title: "Deviations from the paper" };

pub(super) const ROW: Artefact = Artefact::table("deviations", SECTION, "deviation", sheet);

fn sheet(analysis: &Analysis<'_>) -> Result<Sheet, ReportError> {
    let columns = [
        Column::only_named("Topic", |row: &Deviation| row.topic.to_owned()),
        Column::only_named("The paper", |row: &Deviation| row.paper.to_owned()),
        Column::only_named("Here", |row: &Deviation| row.here.to_owned()),
    ];
    let caption =
        "Where the paper is silent or contradicts itself, each choice is a setting with this default.";
    Sheet::of(caption.to_owned(), &analysis.paper().deviations, &columns)
}
