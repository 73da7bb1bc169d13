//! An artefact, computed: its table, or its figures and their files.

use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::files::File;
use super::{Artefact, Content, Drawing, Reel, Section};
use crate::analysis::whole::Analysis;
use crate::error::ReportError;
use crate::render::figure;
use crate::render::table::Sheet;

/// An artefact, computed.
pub(super) struct Made {
    pub(super) artefact: &'static Artefact,
    /// Its table, if it is one.
    pub(super) sheet: Option<Sheet>,
    /// Its figures, text as outlines.
    pub(super) drawings: Vec<Drawing>,
    /// Its films.
    pub(super) reels: Vec<Reel>,
    /// The files of figures and films.
    pub(super) figures: Vec<File>,
}

/// Computes an artefact.
pub(super) fn make(artefact: &'static Artefact, analysis: &Analysis<'_>) -> Result<Made, ReportError> {
    let mut made =
        Made { artefact, sheet: None, drawings: Vec::new(), reels: Vec::new(), figures: Vec::new() };
    match artefact.content {
        Content::Table { sheet, .. } => made.sheet = Some(sheet(analysis)?),
        Content::Films(shoot) => {
            made.reels = shoot(analysis)?;
            let file = |reel: &Reel| (figure_path(&reel.name, "gif"), reel.gif.clone());
            made.figures.extend(made.reels.iter().map(file));
        }
        Content::Figures(draw) => {
            let rendered: Result<Vec<_>, ReportError> = draw(analysis)?.into_par_iter().map(render).collect();
            for (drawing, files) in rendered? {
                made.drawings.push(drawing);
                made.figures.extend(files);
            }
        }
    }
    Ok(made)
}

/// A drawing with its text as outlines, and its files.
fn render(drawing: Drawing) -> Result<(Drawing, [File; 2]), ReportError> {
    let Drawing { name, svg, .. } = &drawing;
    let png = figure::png(name, svg)?;
    let svg = figure::outlined(name, svg)?;
    let files = [(figure_path(name, "svg"), svg.clone().into_bytes()), (figure_path(name, "png"), png)];
    Ok((Drawing { svg, ..drawing }, files))
}

fn figure_path(name: &str, extension: &str) -> PathBuf {
    Path::new("figures").join(format!("{name}.{extension}"))
}

/// The tables that are there to read in a section of their own or of several.
pub(super) fn shown(made: &[Made]) -> impl Iterator<Item = (&'static Artefact, &Sheet)> {
    let tables = made.iter().filter_map(|made| Some((made.artefact, made.sheet.as_ref()?)));
    tables.filter(|(artefact, sheet)| sheet.is_shown() && matches!(artefact.section, Section::Named { .. }))
}
