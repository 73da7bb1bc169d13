//! The page: sections in the order of the artefacts, then how the runs were made and what is wrong.

use super::heading::Heading;
use super::made::{Made, shown};
use super::{Artefact, Content, Drawing, RESULTS, Reel, Repeated, Section};
use crate::analysis::whole::Analysis;
use crate::render::page::{self, PageSection, Picture};
use crate::render::table::{Sheet, Table};
use crate::store::problem::StoreProblem;
use crate::wording::counted;

/// `index.html`.
pub(super) fn html(
    analysis: &Analysis<'_>,
    heading: &Heading,
    made: &[Made],
    missing: &[String],
    problems: &[StoreProblem],
) -> String {
    let mut sections = Vec::new();
    let mut done: Vec<Section> = vec![Section::Nowhere];
    for section in made.iter().map(|made| made.artefact.section) {
        if done.contains(&section) {
            continue;
        }
        done.push(section);
        match section {
            Section::Named { id, title } => {
                let mut body = pictures(made, |one, drawing| {
                    one.artefact.section == section && drawing.environment.is_none()
                });
                let tables = shown(made).filter(|(artefact, _)| artefact.section == section);
                body.extend(tables.map(|(_, sheet)| sheet.table.html()));
                if section == RESULTS {
                    body.insert_str(0, &overview(analysis, missing, problems));
                }
                sections.push(PageSection::new(id, title, body));
            }
            Section::Environments => sections.extend(environments(analysis, made)),
            Section::Nowhere => {}
        }
    }
    let runs = analysis.store.runs();
    sections.extend([
        PageSection::new("protocol", "Protocol", page::settings(runs).html()),
        PageSection::new("versions", "Versions", page::versions(runs).html()),
        PageSection::new("missing", "What is missing", page::list(missing)),
        PageSection::new("problems", "Problems in the records", page::list(problems)),
    ]);
    page::html(&heading.title, &heading.lines, sections)
}

/// How much there is, with links to what is wrong.
fn overview(analysis: &Analysis<'_>, missing: &[String], problems: &[StoreProblem]) -> String {
    let runs = analysis.store.runs();
    let finished = runs.iter().filter(|run| run.is_finished()).count();
    let linked = |count: usize, what: &str, id: &str| {
        let text = counted(count, what);
        if count == 0 { text } else { format!("<a href=\"#{id}\">{text}</a>") }
    };
    format!(
        "<p>{} of {}, {finished} of them finished; {} in the records, {} missing.</p>\n",
        counted(analysis.store.len(), "evaluation"),
        counted(runs.len(), "run"),
        linked(problems.len(), "problem", "problems"),
        linked(missing.len(), "thing", "missing"),
    )
}

/// The sections of single environments: their figures, and their rows of the tables that are repeated there.
fn environments(analysis: &Analysis<'_>, made: &[Made]) -> Vec<PageSection> {
    let ids = analysis.groups.environments();
    let section = |(index, name): (usize, &&str)| {
        let mut body = pictures(made, |_, drawing| drawing.environment.as_deref() == Some(*name));
        body += &films(made, name);
        for (sheet, _) in repeated(made).filter(|(_, how)| *how == Repeated::Open) {
            // Their captions stand below the tables of all environments.
            let part = Table { caption: String::new(), ..sheet.table.part(name) };
            if !part.rows.is_empty() {
                body += &part.html();
            }
        }
        for (sheet, how) in repeated(made) {
            if let Repeated::Folded(title) = how {
                let part = sheet.table.part(name);
                body += &page::folded(&format!("{title} ({})", part.rows.len()), &part.html());
            }
        }
        PageSection::new(format!("environment-{index}"), *name, body)
    };
    ids.iter().enumerate().map(section).collect()
}

/// The tables that are repeated in sections of environments.
fn repeated(made: &[Made]) -> impl Iterator<Item = (&Sheet, Repeated)> {
    made.iter().filter_map(|Made { artefact: Artefact { content, .. }, sheet, .. }| match content {
        Content::Table { repeated, .. } => Some((sheet.as_ref()?, *repeated)),
        Content::Figures(_) | Content::Films(_) => None,
    })
}

/// The films of an environment, to unfold: nothing on the page moves unasked.
fn films(made: &[Made], environment: &str) -> String {
    let all = made.iter().flat_map(|made| &made.reels);
    let here: Vec<&Reel> = all.filter(|reel| reel.environment == environment).collect();
    if here.is_empty() {
        return String::new();
    }
    let film = |reel: &&Reel| page::film(&reel.title, &reel.gif, reel.size);
    let films: String = here.iter().map(film).collect();
    let title = format!("Where teachers sent the student, in motion ({})", here.len());
    page::folded(&title, &page::row_of_figures(&films))
}

/// The figures that `belongs` says of, as HTML.
fn pictures(made: &[Made], belongs: impl Fn(&Made, &Drawing) -> bool) -> String {
    let all = made.iter().flat_map(|one| one.drawings.iter().map(move |drawing| (one, drawing)));
    let of_it = all.filter(|(one, drawing)| belongs(one, drawing));
    let picture =
        |(_, drawing): (_, &Drawing)| Picture { title: drawing.title.clone(), svg: drawing.svg.clone() };
    page::figures(&of_it.map(picture).collect::<Vec<_>>())
}
