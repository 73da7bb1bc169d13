//! What each variant is.

use super::{Artefact, Section};
use crate::analysis::variants::{self, VariantSettings};
use crate::analysis::whole::Analysis;
use crate::error::ReportError;
use crate::render::table::{Column, Sheet};

const SECTION: Section = Section::Named { id: "variants", title: "What each variant is" };

pub(super) const ROW: Artefact = Artefact::table("variants", SECTION, "variant", sheet);

fn sheet(analysis: &Analysis<'_>) -> Result<Sheet, ReportError> {
    let columns = [
        text("variant", "label of the variant", "Variant", |row| row.variant.clone()),
        text(
            "settings",
            "the settings that make it, and in brackets what they have without it",
            "What it changes",
            said,
        ),
        text("curricula", "methods for which it is that", "Curricula", |row| row.curricula.join(", ")),
        text("environments", "environments in which it is that", "Environments", |row| {
            row.environments.join(", ")
        }),
    ];
    Sheet::of(CAPTION.to_owned(), &variants::variants(&analysis.groups.all), &columns)
}

fn text(
    name: &'static str,
    meaning: &'static str,
    title: &'static str,
    value: fn(&VariantSettings) -> String,
) -> Column<'static, VariantSettings> {
    Column::text(name, meaning, value).named(title, value)
}

fn said(row: &VariantSettings) -> String {
    match (row.settings.is_empty(), row.from_default) {
        (true, true) => "nothing: the same as default".to_owned(),
        (true, false) => "nothing that another variant here has otherwise".to_owned(),
        (false, _) => row.settings.join("; "),
    }
}

const CAPTION: &str = "Every variant by the settings in which its runs differ from the default of the same method in the same \
                       environment, with the default's value in brackets. Where a method has no default there, by those in \
                       which its variants differ from each other, without brackets.";
