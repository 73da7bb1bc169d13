//! `index.html`: the whole report on one page that needs nothing else, neither files nor network.

mod protocol;

use crate::render::table::{Table, html_escape};
use crate::store::Store;
use crate::store::problem::Problem;

/// Where a figure stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Section {
    /// At the top: all environments.
    Overview,
    /// Sums over environments.
    Across,
    /// The paper's ablations.
    Ablations,
    /// One environment, by id.
    Environment(String),
}

/// A figure of the page.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Where it stands.
    pub section: Section,
    /// What it shows: its heading and what is read out in its place.
    pub title: String,
    /// The picture, text as outlines.
    pub svg: String,
}

/// What the page shows.
#[derive(Debug)]
pub struct Page<'a> {
    /// All results.
    pub store: &'a Store,
    /// What is wrong with them.
    pub problems: &'a [Problem],
    /// All figures, in order.
    pub pictures: &'a [Picture],
    /// Environment ids, in order.
    pub environments: &'a [&'a str],
    /// A row per environment, curriculum and variant; the first column is the environment.
    pub summary: &'a Table,
    /// What training took, with the same first column.
    pub costs: &'a Table,
    /// What teachers picked, with the same first column.
    pub teaching: Option<&'a Table>,
    /// Single runs, with the same first column.
    pub runs: &'a Table,
    /// Sums over environments.
    pub aggregates: Option<&'a Table>,
    /// Methods against the first of their environment; the first column is the environment.
    pub comparisons: Option<&'a Table>,
    /// The paper's claims.
    pub ledger: &'a Table,
    /// The paper's claims under every reading of it.
    pub readings: Option<&'a Table>,
    /// Dimensions of environments.
    pub dimensions: Option<&'a Table>,
    /// Known deviations from the paper.
    pub deviations: &'a Table,
    /// What the report lacks.
    pub missing: &'a [String],
}

/// Title of the section of readings.
pub const READINGS: &str = "Does a claim's verdict hang on the reading?";

const STYLE: &str = include_str!("style.css");

impl Page<'_> {
    /// The page as HTML.
    pub fn html(&self) -> String {
        let mut sections = vec![
            ("results", "Results", self.overview()),
            ("costs", "What training took", self.costs.html()),
            ("teaching", "What teachers picked", self.teaching.map(Table::html).unwrap_or_default()),
            ("ledger", "Claims of the paper", self.ledger.html()),
            ("readings", READINGS, self.readings.map(Table::html).unwrap_or_default()),
            ("across", "Across environments", self.across()),
            ("ablations", "Ablations", self.pictures(&Section::Ablations)),
        ];
        let ids: Vec<String> =
            (0..self.environments.len()).map(|index| format!("environment-{index}")).collect();
        let names = self.environments.iter().zip(&ids);
        sections.extend(names.map(|(name, id)| (id.as_str(), *name, self.environment(name))));
        sections.extend([
            ("comparisons", "Comparisons", self.comparisons.map(Table::html).unwrap_or_default()),
            (
                "dimensions",
                "Dimensions of the environments",
                self.dimensions.map(Table::html).unwrap_or_default(),
            ),
            ("deviations", "Deviations from the paper", self.deviations.html()),
            ("protocol", "Protocol", protocol::settings(self.store.runs()).html()),
            ("versions", "Versions", protocol::versions(self.store.runs()).html()),
            ("missing", "What is missing", self.missing()),
            ("problems", "Problems in the records", self.problems()),
        ]);
        sections.retain(|(_, _, body)| !body.is_empty());

        let link = |(id, title, _): &(&str, &str, String)| {
            format!("<li><a href=\"#{id}\">{}</a></li>", html_escape(title))
        };
        let section = |(id, title, body): &(&str, &str, String)| {
            format!("<section id=\"{id}\">\n<h2>{}</h2>\n{body}</section>\n", html_escape(title))
        };
        let links: String = sections.iter().map(link).collect();
        let bodies: String = sections.iter().map(section).collect();
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <title>Automatic curricula, compared</title>\n\
             <link rel=\"icon\" href=\"data:,\">\n<style>\n{STYLE}</style>\n</head>\n<body>\n\
             <header><h1>Automatic curricula, compared</h1>\n<nav><ul>{links}</ul></nav></header>\n\
             <main>\n{bodies}</main>\n</body>\n</html>\n"
        )
    }

    fn overview(&self) -> String {
        let runs = self.store.runs();
        let finished = runs.iter().filter(|run| run.is_finished()).count();
        let linked = |count: usize, what: &str, id: &str| {
            let text = format!("{count} {what}{}", if count == 1 { "" } else { "s" });
            if count == 0 { text } else { format!("<a href=\"#{id}\">{text}</a>") }
        };
        format!(
            "<p>{} evaluations of {} runs, {finished} of them finished; {} in the records, {} missing.</p>\n{}{}",
            self.store.len(),
            runs.len(),
            linked(self.problems.len(), "problem", "problems"),
            linked(self.missing.len(), "thing", "missing"),
            self.pictures(&Section::Overview),
            self.summary.html(),
        )
    }

    fn across(&self) -> String {
        self.pictures(&Section::Across) + &self.aggregates.map(Table::html).unwrap_or_default()
    }

    fn environment(&self, name: &str) -> String {
        let mut text = self.pictures(&Section::Environment(name.to_owned()));
        // Their captions stand below the tables of all environments.
        let tables =
            [Some(self.summary), Some(self.costs), self.teaching, self.comparisons].into_iter().flatten();
        for table in tables.map(|table| Table { caption: String::new(), ..table.part(name) }) {
            if !table.rows.is_empty() {
                text += &table.html();
            }
        }
        let runs = self.runs.part(name);
        text + &format!(
            "<details><summary>Single runs ({})</summary>{}</details>\n",
            runs.rows.len(),
            runs.html()
        )
    }

    fn missing(&self) -> String {
        list(self.missing.iter().map(String::as_str))
    }

    fn problems(&self) -> String {
        let problems: Vec<String> = self.problems.iter().map(Problem::to_string).collect();
        list(problems.iter().map(String::as_str))
    }

    fn pictures(&self, section: &Section) -> String {
        let pictures: Vec<&Picture> =
            self.pictures.iter().filter(|picture| picture.section == *section).collect();
        if pictures.is_empty() {
            return String::new();
        }
        let figure = |picture: &&Picture| {
            let title = html_escape(&picture.title);
            // All at one scale, so that text is of one size.
            let scaled = |name| (SCALE * side(&picture.svg, name).unwrap_or_default()).round();
            let (width, height) = (scaled("width"), scaled("height"));
            let class = if width > WIDE { "wide" } else { "narrow" };
            let data = percent_encode(&picture.svg);
            format!(
                "<figure class=\"{class}\"><img width=\"{width}\" height=\"{height}\" alt=\"{title}\" \
                 src=\"data:image/svg+xml,{data}\"><figcaption>{title}</figcaption></figure>\n"
            )
        };
        format!("<div class=\"figures\">\n{}</div>\n", pictures.iter().map(figure).collect::<String>())
    }
}

/// Pixels of the page per pixel of a figure.
const SCALE: f64 = 0.42;
/// Figures wider than this have a row of the page to themselves.
const WIDE: f64 = 500.0;

/// `width` or `height` of an SVG, as its root says.
fn side(svg: &str, name: &str) -> Option<f64> {
    let (_, rest) = svg.split_once(&format!("{name}=\""))?;
    rest.split_once('"')?.0.parse().ok()
}

/// An HTML list, or nothing for no items.
fn list<'a>(items: impl Iterator<Item = &'a str>) -> String {
    let items: String = items.map(|item| format!("<li>{}</li>\n", html_escape(item))).collect();
    if items.is_empty() { items } else { format!("<ul>\n{items}</ul>\n") }
}

/// The content of a data URL in an attribute: bytes that are not plainly safe there become `%XX` (RFC 3986, 2.1).
fn percent_encode(text: &str) -> String {
    let mut encoded = String::with_capacity(text.len() * 5 / 4);
    for byte in text.bytes() {
        match byte {
            b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' => encoded.push(char::from(byte)),
            b' ' | b'-' | b'.' | b'/' | b':' | b'=' | b',' | b';' | b'(' | b')' | b'_' => {
                encoded.push(char::from(byte))
            }
            other => encoded.push_str(&format!("%{other:02X}")),
        }
    }
    encoded
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn data_urls_by_hand() {
        assert_eq!(percent_encode("<a b=\"#é\">\n"), "%3Ca b=%22%23%C3%A9%22%3E%0A");
        assert_eq!(side("<svg xmlns=\"x\" width=\"1050\" height=\"9\">", "height"), Some(9.0));
    }
}
