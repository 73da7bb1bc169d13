//! Layers of config: tables laid over each other, each knowing where it comes from.

use std::ops::Range;
use std::sync::Arc;

use guard::text::short;
use toml::de::{DeTable, DeValue};
use toml::{Spanned, Table, Value};

use crate::error::HarnessError;

/// A TOML document with its text, so that errors can name lines.
#[derive(Clone, Debug)]
pub struct Document {
    name: Arc<str>,
    text: Arc<str>,
}

impl Document {
    /// Parses `text`; `name` is what errors call it.
    ///
    /// # Errors
    /// [`HarnessError::Protocol`] naming the line, if it is not TOML.
    pub fn parse(name: &str, text: &str) -> Result<(Self, Table), HarnessError> {
        let document = Self { name: name.into(), text: text.into() };
        let refuse = |span, reason| Err(HarnessError::Protocol { place: document.at(span), reason });
        if text.len() > LARGEST {
            return refuse(
                None,
                format!("is larger than {LARGEST} bytes, the most that a protocol may have"),
            );
        }
        match text.parse::<Table>() {
            Ok(table) if is_deeper_than(&table, DEEPEST) => {
                let reason = "its tables and lists are nested too deeply";
                refuse(None, format!("{reason}; at most {DEEPEST} within each other are accepted"))
            }
            Ok(table) => Ok((document, table)),
            Err(error) => refuse(error.span(), in_words(&error, text)),
        }
    }

    /// `NAME:LINE` of the value at `path`, or of its nearest parent that stands in the text.
    pub fn place(&self, path: &[&str]) -> String {
        let span = DeTable::parse(&self.text).ok().and_then(|root| deepest_span(root.get_ref(), path));
        self.at(span)
    }

    fn at(&self, span: Option<Range<usize>>) -> String {
        match span {
            Some(span) => {
                let line = self.text[..span.start.min(self.text.len())].matches('\n').count() + 1;
                format!("{}:{line}", self.name)
            }
            None => self.name.to_string(),
        }
    }
}

/// The most bytes of a document.
const LARGEST: usize = 1 << 20;
/// The most tables and lists within each other, also as names in a path; the config has four.
const DEEPEST: usize = 16;

fn is_deeper_than(table: &Table, most: usize) -> bool {
    fn deeper(value: &Value, most: usize) -> bool {
        match value {
            Value::Table(table) => is_deeper_than(table, most),
            Value::Array(items) => most == 0 || items.iter().any(|item| deeper(item, most - 1)),
            _ => false,
        }
    }
    most == 0 || table.values().any(|value| deeper(value, most - 1))
}

/// How the parser begins what it says of whole numbers out of range: a little above it, beyond 64 bits,
/// beyond 128 bits. A document is parsed into values of any type, so that no integer is of a wrong one.
const OUT_OF_RANGE: [&str; 3] =
    ["u64 value was too large", "invalid type: integer", "integer number overflowed"];

/// Why `text` is not TOML.
fn in_words(error: &toml::de::Error, text: &str) -> String {
    let message = error.message().trim().replace('\n', ", ");
    let at = error.span().and_then(|span| text.get(span)).map(short).unwrap_or_default();
    match message.as_str() {
        "duplicate key" => format!("`{at}` is given twice"),
        "recursion limit" => format!("has a path of more than {DEEPEST} names"),
        _ if OUT_OF_RANGE.iter().any(|words| message.starts_with(words)) => {
            format!("the whole number `{at}` is out of range; {} to {} are accepted", i64::MIN, i64::MAX)
        }
        _ if message.contains("recurs") => "its tables and lists are nested too deeply".to_owned(),
        _ => message,
    }
}

/// The span of the key at `path` (array indices are written as numbers), or of its nearest parent.
fn deepest_span(table: &DeTable<'_>, path: &[&str]) -> Option<Range<usize>> {
    let (first, rest) = path.split_first()?;
    let (key, value) = table.iter().find(|(key, _)| key.get_ref() == first)?;
    Some(deeper(value, rest).unwrap_or_else(|| key.span()))
}

fn deeper(value: &Spanned<DeValue<'_>>, path: &[&str]) -> Option<Range<usize>> {
    match value.get_ref() {
        DeValue::Table(table) => deepest_span(table, path),
        DeValue::Array(items) => {
            let (index, rest) = path.split_first()?;
            let item = items.get(index.parse::<usize>().ok()?)?;
            Some(deeper(item, rest).unwrap_or_else(|| item.span()))
        }
        _ => None,
    }
}

/// Where a layer comes from.
#[derive(Clone, Debug)]
pub enum Origin {
    /// A part of a document: the path of the table that holds the layer.
    Document(Document, Vec<String>),
    /// A command-line option, as typed.
    Option(String),
}

impl Origin {
    /// Where the field at `path` was given.
    pub fn place(&self, path: &[&str]) -> String {
        match self {
            Self::Document(document, prefix) => {
                let full: Vec<&str> = prefix.iter().map(String::as_str).chain(path.iter().copied()).collect();
                document.place(&full)
            }
            Self::Option(option) => option.clone(),
        }
    }
}

/// A partial config from one origin.
#[derive(Clone, Debug)]
pub struct ConfigLayer {
    /// Where it comes from.
    pub origin: Origin,
    /// The fields it sets.
    pub table: Table,
}

impl ConfigLayer {
    /// The layer of one assignment `path=value`, given with the command-line option `option`. The value is
    /// read as TOML, and as a plain string where it is none.
    ///
    /// # Errors
    /// [`HarnessError::Argument`] if there is no `=`, if the path has an empty name or too many, or if the
    /// value is nested too deeply.
    pub fn from_assignment(option: &'static str, assignment: &str) -> Result<Self, HarnessError> {
        let wrong = |reason: String| HarnessError::Argument { option, reason };
        let told = short(assignment);
        let (path, value) = assignment.split_once('=').ok_or_else(|| {
            wrong(format!("`{told}` has no `=`; accepted: path=value, as in curriculum.teach.window=5"))
        })?;
        let names = path.split('.').count();
        if names > DEEPEST {
            return Err(wrong(format!(
                "`{told}` has a path of {names} names; at most {DEEPEST} are accepted"
            )));
        }
        let path: Vec<&str> = path.trim().split('.').collect();
        if path.iter().any(|segment| segment.is_empty()) {
            return Err(wrong(format!("`{told}` has an empty name in its path")));
        }
        let table = nest(&path, parse_value(value.trim()));
        if is_deeper_than(&table, DEEPEST) {
            return Err(wrong(format!(
                "`{told}` is nested too deeply; at most {DEEPEST} levels are accepted"
            )));
        }
        Ok(Self { origin: Origin::Option(format!("{option} {told}")), table })
    }

    /// The layer of an option that stands for one config path.
    pub fn from_option(option: String, path: &[&str], value: Value) -> Self {
        Self { origin: Origin::Option(option), table: nest(path, value) }
    }

    /// Whether the layer sets the field at `path`, or something above or below it.
    pub(crate) fn touches(&self, path: &[&str]) -> bool {
        let Some((first, rest)) = path.split_first() else { return true };
        let mut value = self.table.get(*first);
        for segment in rest {
            match value {
                Some(Value::Table(table)) => value = table.get(*segment),
                other => return other.is_some(),
            }
        }
        value.is_some()
    }
}

fn parse_value(text: &str) -> Value {
    format!("value = {text}")
        .parse::<Table>()
        .ok()
        .filter(|table| table.len() == 1)
        .and_then(|mut table| table.remove("value"))
        .unwrap_or_else(|| Value::String(text.to_owned()))
}

fn nest(path: &[&str], value: Value) -> Table {
    let (last, parents) = path.split_last().expect("callers pass a path of at least one name");
    let mut table = Table::from_iter([((*last).to_owned(), value)]);
    for parent in parents.iter().rev() {
        table = Table::from_iter([((*parent).to_owned(), Value::Table(table))]);
    }
    table
}

/// Lays `over` upon `base`: tables merge, everything else is replaced. So is a table of another `kind`, since
/// its fields differ.
pub fn merge(base: &mut Table, over: &Table) {
    let other_kind = |below: &Table, above: &Table| {
        above.get("kind").is_some_and(|kind| below.get("kind").is_some_and(|other| other != kind))
    };
    for (key, value) in over {
        match (base.get_mut(key), value) {
            (Some(Value::Table(below)), Value::Table(above)) if !other_kind(below, above) => {
                merge(below, above)
            }
            _ => {
                base.insert(key.clone(), value.clone());
            }
        }
    }
}

/// Where the field at `path` was last set: the place in the topmost layer that touches it.
pub fn place_of(layers: &[ConfigLayer], path: &str) -> String {
    let path: Vec<&str> = path.split('.').collect();
    match layers.iter().rev().find(|layer| layer.touches(&path)) {
        Some(layer) => layer.origin.place(&path),
        None => "the defaults".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_of_another_kind_replaces_the_one_below() {
        let table = |text: &str| text.parse::<Table>().expect("TOML");
        let mut base = table("noise = { kind = 'a', x = 1 }\nrest = { y = 2 }");
        merge(&mut base, &table("noise = { x = 3 }\nrest = { z = 4 }"));
        assert_eq!(base, table("noise = { kind = 'a', x = 3 }\nrest = { y = 2, z = 4 }"));
        merge(&mut base, &table("noise = { kind = 'b', w = 5 }"));
        assert_eq!(base["noise"], Value::Table(table("kind = 'b'\nw = 5")));
    }

    #[test]
    fn set_reads_toml_values_and_plain_words() {
        let set = |text: &str| ConfigLayer::from_assignment("--set", text);
        let get = |text: &str| set(text).expect(text).table;
        assert_eq!(get("budget.steps=5_000").to_string(), "[budget]\nsteps = 5000\n");
        assert_eq!(get("student.preset=official").to_string(), "[student]\npreset = \"official\"\n");
        assert_eq!(get("a=[1, 2]")["a"].as_array().map(Vec::len), Some(2));
        assert_eq!(get("a=1\nb=2")["a"].as_str(), Some("1\nb=2"), "no smuggling of a second key");
        assert!(set("budget.steps").is_err());
        assert!(set(".steps=1").is_err());
    }

    #[test]
    fn whole_numbers_out_of_range_are_refused_with_what_is_accepted() {
        let beyond = ["9223372036854775808", "-99999999999999999999", "0x1FFFFFFFFFFFFFFFF", &"9".repeat(60)];
        for number in beyond {
            let error = Document::parse("p.toml", &format!("a = 1\nb = {number}")).expect_err("too large");
            let expected = format!(
                "p.toml:2: the whole number `{}` is out of range; -9223372036854775808 to \
                 9223372036854775807 are accepted",
                short(number)
            );
            assert_eq!(error.to_string(), expected);
        }
    }

    #[test]
    fn what_is_nested_too_deeply_is_refused_and_told_in_short() {
        let nested = |open: &str, close: &str, times| open.repeat(times) + "1" + &close.repeat(times);
        for assignment in [
            format!("{}=1", ["a"; 20_000].join(".")),
            format!("a={}", nested("[", "]", 30)),
            format!("a={}", nested("{ a.a.a.a = ", " }", 60)),
        ] {
            let error = ConfigLayer::from_assignment("--set", &assignment).expect_err("too deep").to_string();
            assert!(error.contains("at most 16") && error.len() < 300, "{error}");
        }
        for text in [
            format!("{} = 1", ["a"; 20_000].join(".")),
            format!("[{}]", ["a"; 20_000].join(".")),
            format!("a = {}", nested("[", "]", 20_000)),
            format!("a = {}", nested("{ a = ", " }", 20_000)),
            format!("a = {}", nested("{ a.a.a.a = ", " }", 60)),
            "#".repeat(2 << 20),
        ] {
            let error = Document::parse("p.toml", &text).expect_err("too much").to_string();
            let words = ["nested too deeply", "more than 16 names", "is larger than 1048576 bytes"];
            assert!(words.iter().any(|words| error.contains(words)) && error.len() < 300, "{error}");
        }
        let twice = Document::parse("p.toml", "[a]\nb = 1\nb = 2\n").expect_err("twice").to_string();
        assert_eq!(twice, "p.toml:3: `b` is given twice");
    }

    #[test]
    fn the_topmost_layer_that_sets_a_field_is_named() {
        let (document, table) = Document::parse("p.toml", "name = 'x'\n[budget]\nsteps = 1\n").expect("TOML");
        let file = ConfigLayer { origin: Origin::Document(document, vec![]), table };
        let option = ConfigLayer::from_assignment("--set", "budget.steps=2").expect("valid");
        assert_eq!(place_of(std::slice::from_ref(&file), "budget.steps"), "p.toml:3");
        assert_eq!(place_of(&[file.clone(), option], "budget.steps"), "--set budget.steps=2");
        assert_eq!(place_of(&[file], "student.batch"), "the defaults");
    }

    #[test]
    fn lines_inside_arrays_of_tables_are_found() {
        let text = "[[variant]]\nlabel = 'a'\n[[variant]]\nlabel = 'b'\nset.budget.stps = 3\n";
        let (document, _) = Document::parse("p.toml", text).expect("TOML");
        assert_eq!(document.place(&["variant", "1", "set", "budget", "stps"]), "p.toml:5");
        let error = Document::parse("p.toml", "a = 1\nb = = 2\n").expect_err("not TOML");
        assert!(error.to_string().starts_with("p.toml:2: "), "{error}");
    }
}
