//! `index.html`: the whole report on one page that needs nothing else, neither files nor network.

mod protocol;

use std::fmt::Display;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, utf8_percent_encode};

pub use protocol::{settings, versions};

use crate::render::table::html_escape;

/// A figure of the page.
#[derive(Clone, Debug)]
pub struct Picture {
    /// What it shows: its heading and what is read out in its place.
    pub title: String,
    /// The picture, text as outlines.
    pub svg: String,
}

/// A section of the page.
#[derive(Clone, Debug)]
pub struct PageSection {
    /// Its anchor.
    id: String,
    /// Its heading.
    title: String,
    /// Its content, as HTML.
    body: String,
}

impl PageSection {
    /// A section; one without content is left out.
    pub fn new(id: impl Into<String>, title: impl Into<String>, body: String) -> Self {
        Self { id: id.into(), title: title.into(), body }
    }

    fn link(&self) -> String {
        format!("<li><a href=\"#{}\">{}</a></li>", self.id, html_escape(&self.title))
    }

    fn html(&self) -> String {
        let Self { id, title, body } = self;
        format!("<section id=\"{id}\">\n<h2>{}</h2>\n{body}</section>\n", html_escape(title))
    }
}

const STYLE: &str = include_str!("style.css");

/// The page of these sections, with what stands above them.
pub fn html(title: &str, lines: &[String], mut sections: Vec<PageSection>) -> String {
    let title = html_escape(title);
    let lines: String = lines.iter().map(|line| format!("<p>{}</p>\n", html_escape(line))).collect();
    sections.retain(|section| !section.body.is_empty());
    let links: String = sections.iter().map(PageSection::link).collect();
    let bodies: String = sections.iter().map(PageSection::html).collect();
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{title}</title>\n\
         <link rel=\"icon\" href=\"data:,\">\n<style>\n{STYLE}</style>\n</head>\n<body>\n\
         <header><h1>{title}</h1>\n{lines}<nav><ul>{links}</ul></nav></header>\n\
         <main>\n{bodies}</main>\n</body>\n</html>\n"
    )
}

/// Figures, several in a row where they fit; nothing for none.
pub fn figures(pictures: &[Picture]) -> String {
    if pictures.is_empty() {
        return String::new();
    }
    let figure = |picture: &Picture| {
        let title = html_escape(&picture.title);
        // All at one scale, so that text is of one size.
        let scaled = |name| (SCALE * side(&picture.svg, name).unwrap_or_default()).round();
        let (width, height) = (scaled("width"), scaled("height"));
        let class = if width > WIDE { "wide" } else { "narrow" };
        let data = utf8_percent_encode(&picture.svg, IN_DATA_URLS);
        format!(
            "<figure class=\"{class}\"><img width=\"{width}\" height=\"{height}\" alt=\"{title}\" \
             src=\"data:image/svg+xml,{data}\"><figcaption>{title}</figcaption></figure>\n"
        )
    };
    row_of_figures(&pictures.iter().map(figure).collect::<String>())
}

/// Figures, as HTML, in a row where they fit.
pub fn row_of_figures(figures: &str) -> String {
    format!("<div class=\"figures\">\n{figures}</div>\n")
}

/// A moving picture: a GIF of `size` pixels.
pub fn film(title: &str, gif: &[u8], (width, height): (u32, u32)) -> String {
    let title = html_escape(title);
    let class = if f64::from(width) > WIDE_FILM { "wide" } else { "narrow film" };
    let data = STANDARD.encode(gif);
    format!(
        "<figure class=\"{class}\"><img width=\"{width}\" height=\"{height}\" alt=\"{title}\" \
         src=\"data:image/gif;base64,{data}\"><figcaption>{title}</figcaption></figure>\n"
    )
}

/// HTML to unfold, below a title.
pub fn folded(title: &str, html: &str) -> String {
    format!("<details><summary>{}</summary>{html}</details>\n", html_escape(title))
}

/// A list, or nothing for no items.
pub fn list<T: Display>(items: &[T]) -> String {
    let item = |item: &T| format!("<li>{}</li>\n", html_escape(&item.to_string()));
    let items: String = items.iter().map(item).collect();
    if items.is_empty() { items } else { format!("<ul>\n{items}</ul>\n") }
}

/// What is not plainly safe in a data URL in an attribute (RFC 3986, 2.1).
const IN_DATA_URLS: &AsciiSet = &NON_ALPHANUMERIC
    .remove(b' ')
    .remove(b'-')
    .remove(b'.')
    .remove(b'/')
    .remove(b':')
    .remove(b'=')
    .remove(b',')
    .remove(b';')
    .remove(b'(')
    .remove(b')')
    .remove(b'_');

/// Pixels of the page per pixel of a figure.
const SCALE: f64 = 0.42;
/// Figures wider than this have a row of the page to themselves.
const WIDE: f64 = 500.0;
/// Films wider than this, likewise.
const WIDE_FILM: f64 = 600.0;

/// `width` or `height` of an SVG, as its root says.
fn side(svg: &str, name: &str) -> Option<f64> {
    let (_, rest) = svg.split_once(&format!("{name}=\""))?;
    rest.split_once('"')?.0.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn data_urls_by_hand() {
        let encoded = utf8_percent_encode("<a b=\"#é\">\n", IN_DATA_URLS).to_string();
        assert_eq!(encoded, "%3Ca b=%22%23%C3%A9%22%3E%0A");
        assert_eq!(side("<svg xmlns=\"x\" width=\"1050\" height=\"9\">", "height"), Some(9.0));
    }
}
