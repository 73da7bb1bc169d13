//! The page of nouns and the code agree.

use std::path::Path;

use super::{
    Finding, Source,
    nouns::{Kind, Noun},
};

pub(crate) const FILE: &str = "harness/docs/glossary.md";

const RULE: &str = "the glossary and the code name the same things";

/// The glossary: a Markdown page with tables of noun, meaning and place in the code.
#[derive(Debug)]
pub(crate) struct Glossary {
    file: String,
    places: Vec<Place>,
}

/// Something between backticks in the last column of a table.
#[derive(Debug, PartialEq, Eq)]
struct Place {
    line: usize,
    text: String,
}

impl Place {
    /// Crate and name of an item such as `envs::GoalEnv` or `agents::registry::AGENTS`.
    fn item(&self) -> Option<(&str, &str)> {
        let (krate, path) = self.text.split_once("::")?;
        Some((krate, path.rsplit("::").next()?))
    }
}

impl Glossary {
    /// The places that the tables of the page `text` name; `file` is its path.
    pub(crate) fn read(file: &str, text: &str) -> Self {
        let mut places = Vec::new();
        for (index, row) in text.lines().enumerate().filter(|(_, line)| line.starts_with('|')) {
            let last = row.trim_end_matches([' ', '|']).rsplit('|').next().unwrap_or_default();
            let quoted = last.split('`').skip(1).step_by(2);
            places.extend(quoted.map(|text| Place { line: index + 1, text: text.to_owned() }));
        }
        Self { file: file.to_owned(), places }
    }

    /// Whether it has a place for each of several meanings of `name`.
    pub(crate) fn explains(&self, name: &str) -> bool {
        self.places.iter().filter(|place| place.item().is_some_and(|(_, item)| item == name)).count() > 1
    }

    /// The places that do not exist: items that no crate of that name defines, and files or folders below
    /// `project`.
    pub(crate) fn dangling(&self, project: &Path, sources: &[Source]) -> Vec<Finding> {
        let exists = |place: &Place| match place.item() {
            Some((krate, name)) => sources
                .iter()
                .filter(|source| source.krate() == Some(krate))
                .any(|source| defines(source, name)),
            None => !place.text.contains('/') || project.join(&place.text).exists(),
        };
        let missing = self.places.iter().filter(|place| !exists(place));
        missing.map(|place| self.finding(place.line, format!("there is no `{}`", place.text))).collect()
    }

    /// The traits among `nouns` that no row has: they are what code of one's own is written against.
    pub(crate) fn missing_traits(&self, nouns: &[Noun]) -> Vec<Finding> {
        let known = |noun: &Noun| {
            self.places.iter().any(|place| place.item().is_some_and(|(_, name)| name == noun.name))
        };
        let missing = nouns.iter().filter(|noun| noun.kind == Kind::Trait && !known(noun));
        missing
            .map(|Noun { name, file, line, .. }| Finding {
                rule: RULE,
                file: file.clone(),
                line: *line,
                what: format!("the trait `{name}` has no row in {FILE}"),
            })
            .collect()
    }

    fn finding(&self, line: usize, what: String) -> Finding {
        Finding { rule: RULE, file: self.file.clone(), line, what }
    }
}

/// Whether some public item of `source` has this name.
fn defines(source: &Source, name: &str) -> bool {
    const ITEMS: [&str; 9] = ["struct", "enum", "union", "trait", "fn", "mod", "static", "const", "type"];
    source.lines().any(|(_, line)| {
        let mut words = line
            .trim_start()
            .split(|c: char| !c.is_alphanumeric() && c != '_')
            .filter(|word| !word.is_empty());
        words.next() == Some("pub")
            && words.next().is_some_and(|word| ITEMS.contains(&word))
            && words.next() == Some(name)
    })
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::{Glossary, Place, Source};
    use crate::house::nouns;

    const PAGE: &str = "\
# Nouns
| noun | meaning | in the code |
|---|---|---|
| student | what learns; `agents` knows no teacher | `agents::Pupil`, `agents/src` |
| pool | goals | `curricula::Pool` |
";

    #[test]
    fn the_last_column_names_places() {
        let glossary = Glossary::read("g.md", PAGE);
        let texts: Vec<_> = glossary.places.iter().map(|place| (place.line, place.text.as_str())).collect();
        assert_eq!(texts, [(4, "agents::Pupil"), (4, "agents/src"), (5, "curricula::Pool")]);
        let nested = Place { line: 1, text: "agents::registry::AGENTS".into() };
        assert_eq!(nested.item(), Some(("agents", "AGENTS")));
    }

    #[test]
    fn places_that_do_not_exist_are_named_with_their_line() {
        let source = Source { file: "agents/src/lib.rs".into(), text: "pub trait Pupil: Send {\n".into() };
        let found = Glossary::read("g.md", PAGE).dangling(Path::new("/nowhere"), &[source]);
        let texts: Vec<String> =
            found.iter().map(|finding| format!("{}: {}", finding.line, finding.what)).collect();
        assert_eq!(texts, ["4: there is no `agents/src`", "5: there is no `curricula::Pool`"]);
    }

    #[test]
    fn a_trait_without_a_row_is_named_where_it_is_defined() {
        let source = Source {
            file: "agents/src/lib.rs".into(),
            text: "pub trait Pupil {\npub trait Judge {\n".into(),
        };
        let found = Glossary::read("g.md", PAGE).missing_traits(&nouns::public(&source));
        assert_eq!(found.len(), 1);
        assert_eq!(
            (found[0].line, found[0].what.as_str()),
            (2, "the trait `Judge` has no row in harness/docs/glossary.md")
        );
    }
}
