//! What a report shows: a table of figures and tables, one file each.
//!
//! A row of [`ARTEFACTS`] says what its files are called, where it stands and how it computes itself from the
//! one [`Analysis`]. The page, `summary.md`, `DATA.md`, LaTeX, CSV, Parquet, SVG and PNG all follow from the
//! rows. So a new figure or table is a new file here with its `mod` line, and its row.

mod ablations;
mod aggregates;
mod calibration;
mod citations;
mod columns;
mod comparisons;
mod costs;
mod coverage;
mod dataset;
mod deviations;
mod efficiency;
mod environments;
mod files;
mod film;
mod frontier;
mod goal_map;
mod heading;
mod heat;
mod improvement;
mod intervals;
mod learning;
mod ledger;
mod made;
mod numbers;
mod options;
mod page;
mod profiles;
mod progress;
mod ranks;
mod readings;
mod records;
mod report;
mod runs;
mod shadow;
mod student;
mod summary;
mod teaching;
mod tuning;
mod variant_settings;
mod variants;

pub use dataset::{TidyData, tidy_data};
pub use report::{Written, write, write_beside};

use crate::analysis::levels;
use crate::analysis::options::ReportOptions;
use crate::analysis::whole::Analysis;
use crate::error::ReportError;
use crate::render::figure::{Band, Basis, Palette, Style};
use crate::render::table::Sheet;

/// Every figure and table of a report, in the order in which they are read. Within a section figures stand
/// above tables.
pub static ARTEFACTS: &[Artefact] = &[
    records::ROW,
    runs::ROW,
    student::ROW,
    frontier::MEASURES,
    shadow::LINES,
    calibration::RELIABILITY,
    calibration::JUDGEMENTS,
    tuning::TRIALS,
    learning::STEPS,
    learning::ALL_STEPS,
    learning::GRADIENT_STEPS,
    learning::HOURS,
    summary::ROW,
    variant_settings::ROW,
    costs::ROW,
    teaching::ROW,
    frontier::ROW,
    coverage::ROW,
    calibration::ROW,
    progress::ROW,
    shadow::AGREEMENT,
    ledger::ROW,
    ledger::ROW_ELSEWHERE,
    readings::ROW,
    tuning::FIGURES,
    tuning::ROW,
    tuning::SENSITIVITY,
    intervals::ROW,
    profiles::ROW,
    efficiency::ROW,
    improvement::ROW,
    aggregates::ROW,
    ablations::ROW,
    variants::ROW,
    heat::ROW,
    goal_map::ROW,
    ranks::ROW,
    film::ROW,
    frontier::MAPS,
    calibration::DIAGRAMS,
    shadow::MATRICES,
    student::FIGURES,
    numbers::TEACHERS,
    comparisons::ROW,
    environments::ROW,
    deviations::ROW,
    citations::ROW,
    options::ROW,
];

/// A row of [`ARTEFACTS`].
#[derive(Clone, Copy, Debug)]
pub struct Artefact {
    /// Name of its files, without extension; of figures of single environments, what comes before the
    /// environment.
    pub id: &'static str,
    /// Where it stands.
    pub section: Section,
    /// How it computes itself.
    pub content: Content,
}

/// Where an artefact stands on the page and in `summary.md`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Section {
    /// A section, which several artefacts may share. Sections come in the order of their first artefacts.
    Named {
        /// Its anchor on the page.
        id: &'static str,
        /// Its heading.
        title: &'static str,
    },
    /// The sections of single environments. They come where the first such artefact stands.
    Environments,
    /// Nowhere: data alone.
    Nowhere,
}

/// At the top: all environments.
const RESULTS: Section = Section::Named { id: "results", title: "Results" };
/// Sums over environments.
const ACROSS: Section = Section::Named { id: "across", title: "Across environments" };

/// What the figures of sums over environments rest on.
fn basis<'a>(analysis: &'a Analysis<'_>) -> Basis<'a> {
    let across = &analysis.across;
    Basis {
        environments: across.environments.len(),
        seeds: &across.seeds,
        fewest_runs: across.fewest_runs,
        failed: across.failed,
        resampling: analysis.options.resampling,
    }
}

/// How all figures are drawn: each method, variant and level of an ablation in one look.
fn style(analysis: &Analysis<'_>) -> Style {
    let levels = levels::levels(&analysis.groups.all, &analysis.paper().axes, &analysis.ablations);
    let ReportOptions { bands, zoom, resampling, .. } = analysis.options;
    Style {
        palette: Palette::with_levels(analysis.groups.keys(), &levels),
        zoom: *zoom,
        band: Band { kind: *bands, confidence: resampling.confidence },
    }
}

/// What an artefact is, and how it is computed.
#[derive(Clone, Copy, Debug)]
pub enum Content {
    /// Figures: none where there is nothing to draw, several where environments have one each.
    Figures(fn(&Analysis<'_>) -> Result<Vec<Drawing>, ReportError>),
    /// Films: none where there is nothing to show.
    Films(fn(&Analysis<'_>) -> Result<Vec<Reel>, ReportError>),
    /// A table.
    Table {
        /// What a row stands for, in the data dictionary.
        row: &'static str,
        /// Whether there is a Parquet file beside the CSV.
        parquet: bool,
        /// Whether the rows of an environment, which stands in the first column shown, are repeated in its
        /// section.
        repeated: Repeated,
        /// Computes it.
        sheet: fn(&Analysis<'_>) -> Result<Sheet, ReportError>,
    },
}

/// How the rows of an environment are repeated in its section of the page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Repeated {
    /// Not at all.
    No,
    /// As a table.
    Open,
    /// To unfold, as it is long; below this title and the number of rows.
    Folded(&'static str),
}

/// A figure as SVG.
#[derive(Clone, Debug)]
pub struct Drawing {
    /// Name of its files, without extension.
    pub name: String,
    /// What it shows: its heading, and what is read out in its place.
    pub title: String,
    /// The environment in whose section it stands; `None`: in that of its artefact.
    pub environment: Option<String>,
    /// The picture.
    pub svg: String,
}

/// A moving picture as GIF.
#[derive(Clone, Debug)]
pub struct Reel {
    /// Name of its file, without extension.
    pub name: String,
    /// What it shows: its heading, and what is read out in its place.
    pub title: String,
    /// The environment in whose section it stands.
    pub environment: String,
    /// The pictures.
    pub gif: Vec<u8>,
    /// Width and height in pixels.
    pub size: (u32, u32),
}

impl Artefact {
    /// Films of single environments.
    const fn films(
        id: &'static str,
        section: Section,
        shoot: fn(&Analysis<'_>) -> Result<Vec<Reel>, ReportError>,
    ) -> Self {
        Self { id, section, content: Content::Films(shoot) }
    }

    /// Figures.
    const fn figures(
        id: &'static str,
        section: Section,
        draw: fn(&Analysis<'_>) -> Result<Vec<Drawing>, ReportError>,
    ) -> Self {
        Self { id, section, content: Content::Figures(draw) }
    }

    /// A table of its own section, with data as CSV.
    const fn table(
        id: &'static str,
        section: Section,
        row: &'static str,
        sheet: fn(&Analysis<'_>) -> Result<Sheet, ReportError>,
    ) -> Self {
        Self { id, section, content: Content::Table { row, parquet: false, repeated: Repeated::No, sheet } }
    }

    /// The same table, repeated in the sections of environments.
    const fn repeated(mut self, how: Repeated) -> Self {
        if let Content::Table { repeated, .. } = &mut self.content {
            *repeated = how;
        }
        self
    }

    /// The same table, its data as Parquet too.
    const fn with_parquet(mut self) -> Self {
        if let Content::Table { parquet, .. } = &mut self.content {
            *parquet = true;
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_sections_are_clear() {
        let is_table = |row: &Artefact| matches!(row.content, Content::Table { .. });
        for (index, row) in ARTEFACTS.iter().enumerate() {
            for other in &ARTEFACTS[..index] {
                let same_kind = is_table(row) == is_table(other);
                assert!(!same_kind || row.id != other.id, "two files would be called {}", row.id);
                if let (Section::Named { id, title }, Section::Named { id: other, title: other_title }) =
                    (row.section, other.section)
                {
                    assert_eq!(id == other, title == other_title, "{id}: one heading for one anchor");
                }
            }
        }
    }
}
