//! A public noun means one thing in the whole workspace.

use std::collections::BTreeMap;

use super::{Finding, Source, glossary::Glossary};

const RULE: &str = "a public noun is defined once, or the glossary explains both meanings";

/// What a noun is in Rust.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Type,
    Trait,
}

/// A public type or trait.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Noun {
    pub(crate) kind: Kind,
    pub(crate) name: String,
    pub(crate) file: String,
    pub(crate) line: usize,
}

/// The types and traits that a crate's source defines with `pub`.
pub(crate) fn public(source: &Source) -> Vec<Noun> {
    if source.krate().is_none() {
        return Vec::new();
    }
    let noun = |(line, text): (usize, &str)| {
        let (kind, name) = definition(text)?;
        Some(Noun { kind, name: name.to_owned(), file: source.file.clone(), line })
    };
    source.lines().filter_map(noun).collect()
}

/// What a line like `pub struct Name<T> {` defines.
fn definition(line: &str) -> Option<(Kind, &str)> {
    let rest = line.trim_start().strip_prefix("pub ")?;
    let (word, rest) = rest.split_once(' ')?;
    let kind = match word {
        "struct" | "enum" | "union" => Kind::Type,
        "trait" => Kind::Trait,
        _ => return None,
    };
    let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
    Some((kind, &rest[..end]))
}

/// Every definition of a name that has several, unless `glossary` explains the name.
pub(crate) fn defined_twice(nouns: &[Noun], glossary: &Glossary) -> Vec<Finding> {
    let mut by_name: BTreeMap<&str, Vec<&Noun>> = BTreeMap::new();
    for noun in nouns {
        by_name.entry(&noun.name).or_default().push(noun);
    }
    let several = by_name.into_iter().filter(|(name, places)| places.len() > 1 && !glossary.explains(name));
    several
        .flat_map(|(name, places)| places.into_iter().map(move |place| (name, place)))
        .map(|(name, Noun { file, line, .. })| Finding {
            rule: RULE,
            file: file.clone(),
            line: *line,
            what: format!("`{name}` is defined elsewhere too"),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::{super::glossary::Glossary, Kind, Noun, Source, defined_twice, public};

    fn source(file: &str, text: &str) -> Vec<Noun> {
        public(&Source { file: file.into(), text: text.into() })
    }

    #[test]
    fn types_and_traits_are_found_and_nothing_else() {
        let text = "pub struct Shelf<T> {\n    pub enum Inner {\n}\npub(crate) struct Own;\npub fn shelf() {}\npub trait Make {}\n";
        let found = source("envs/src/lib.rs", text);
        let names: Vec<_> = found.iter().map(|noun| (noun.name.as_str(), noun.kind, noun.line)).collect();
        assert_eq!(names, [("Shelf", Kind::Type, 1), ("Inner", Kind::Type, 2), ("Make", Kind::Trait, 6)]);
        assert!(source("envs/tests/it/main.rs", text).is_empty());
    }

    #[test]
    fn a_second_definition_needs_an_explanation() {
        let mut nouns = source("envs/src/lib.rs", "pub struct Shelf;\npub struct Other;\n");
        nouns.extend(source("agents/src/lib.rs", "pub enum Shelf {\n"));
        let files = |glossary: &str| -> Vec<String> {
            let found = defined_twice(&nouns, &Glossary::read("glossary.md", glossary));
            found.into_iter().map(|finding| finding.file).collect()
        };
        assert_eq!(files(""), ["envs/src/lib.rs", "agents/src/lib.rs"]);
        assert!(files("| shelf | two | `envs::Shelf`, `agents::Shelf` |").is_empty());
        assert_eq!(files("| shelf | one | `envs::Shelf` |").len(), 2, "one of the two is not explained");
    }
}
