//! Where teachers sent their students, in motion: a film per environment and curriculum.

use rayon::prelude::*;

use super::files::file_name;
use super::{Artefact, Reel, Section};
use crate::analysis::film::{Film, GoalWorld};
use crate::analysis::whole::Analysis;
use crate::error::ReportError;
use crate::render::figure;

pub(super) const ROW: Artefact = Artefact::films("film", Section::Environments, shoot);

fn shoot(analysis: &Analysis<'_>) -> Result<Vec<Reel>, ReportError> {
    let films: Vec<(usize, &(GoalWorld<'_>, Film))> = analysis.films.films.iter().enumerate().collect();
    let reel = |(index, (world, film)): (usize, &(GoalWorld<'_>, Film))| {
        let key = &film.key;
        let moving = figure::film(*world, film)?;
        let method = match key.variant.as_str() {
            "default" => key.curriculum.id.clone(),
            variant => format!("{}-{variant}", key.curriculum.id),
        };
        Ok(Reel {
            name: format!("film-{}", file_name(&format!("{}-{method}", key.environment), index)),
            title: format!(
                "{}: where {} sent the student of seed {} over training, in {} pictures",
                key.environment,
                key.name(),
                film.seed,
                moving.pictures
            ),
            environment: key.environment.clone(),
            gif: moving.gif,
            size: moving.size,
        })
    };
    films.into_par_iter().map(reel).collect()
}
