//! What the doc comment of a field says besides its meaning: unit, range, what "auto" means, source.
//!
//! They stand in the last paragraph, as in `Unit: episodes. Range: 1 to 100. Source: a paper.`

use serde_json::{Number, Value as Json, json};

/// The notes that a doc comment may hold.
const KEYS: [&str; 4] = ["Unit: ", "Range: ", "Auto: ", "Source: "];

/// A doc comment, taken apart.
#[derive(Debug, Default, PartialEq)]
pub struct Notes {
    /// What the field means.
    pub meaning: String,
    /// The unit of its number; "none" for a pure number.
    pub unit: Option<String>,
    /// The numbers that it accepts, as in `1 to 100`.
    pub range: Option<String>,
    /// What the value "auto" stands for.
    pub auto: Option<String>,
    /// Where its default comes from.
    pub source: Option<String>,
}

impl Notes {
    /// Takes the doc comment `text` apart.
    pub fn parse(text: &str) -> Self {
        let paragraphs: Vec<String> = text
            .split("\n\n")
            .map(|paragraph| paragraph.split_whitespace().collect::<Vec<_>>().join(" "))
            .filter(|paragraph| !paragraph.is_empty())
            .collect();
        let mut notes = Self::default();
        let mut meaning = Vec::new();
        for paragraph in paragraphs {
            if KEYS.iter().any(|key| paragraph.starts_with(key)) {
                notes.read(&paragraph);
            } else {
                meaning.push(paragraph);
            }
        }
        notes.meaning = meaning.join(" ");
        notes
    }

    fn read(&mut self, paragraph: &str) {
        let mut starts: Vec<(usize, &str)> =
            KEYS.iter().filter_map(|key| Some((paragraph.find(key)?, *key))).collect();
        starts.sort_unstable();
        let ends = starts.iter().skip(1).map(|(at, _)| *at).chain([paragraph.len()]);
        for ((at, key), end) in starts.iter().zip(ends) {
            let told = paragraph[at + key.len()..end].trim().trim_end_matches('.').to_owned();
            let slot = match *key {
                "Unit: " => &mut self.unit,
                "Range: " => &mut self.range,
                "Auto: " => &mut self.auto,
                _ => &mut self.source,
            };
            *slot = Some(told);
        }
    }

    /// The keywords of JSON Schema that say the same as the range.
    ///
    /// # Errors
    /// The range, if it is not of a known form.
    pub fn bounds(&self) -> Result<Vec<(&'static str, Json)>, String> {
        let Some(range) = &self.range else { return Ok(Vec::new()) };
        let number = |text: &str| -> Result<Json, String> {
            let number: Number = text.replace(',', "").parse().map_err(|_| range.clone())?;
            Ok(json!(number))
        };
        if let Some(least) = range.strip_prefix("at least ") {
            return Ok(vec![("minimum", number(least)?)]);
        }
        let (start, end) = match range.split_once(" to ") {
            Some((start, end)) => (start, Some(end)),
            None => (range.as_str(), None),
        };
        let low = match start.strip_prefix("above ") {
            Some(bound) => ("exclusiveMinimum", number(bound)?),
            None if end.is_some() => ("minimum", number(start)?),
            None => return Err(range.clone()),
        };
        let high = end.map(|end| match end.strip_prefix("below ") {
            Some(bound) => Ok(("exclusiveMaximum", number(bound)?)),
            None => Ok(("maximum", number(end)?)),
        });
        [Ok(low)].into_iter().chain(high).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_doc_comment_is_taken_apart() {
        let notes = Notes::parse(
            "Transitions per\nstep.\n\nUnit: transitions. Range: 1 to 1,000,000. Auto: 1024. Source: TEACH 5.2; VDS's\ncode.",
        );
        assert_eq!(notes.meaning, "Transitions per step.");
        assert_eq!(notes.unit.as_deref(), Some("transitions"));
        assert_eq!(notes.auto.as_deref(), Some("1024"));
        assert_eq!(notes.source.as_deref(), Some("TEACH 5.2; VDS's code"));
        let bounds = vec![("minimum", json!(1)), ("maximum", json!(1_000_000))];
        assert_eq!(notes.bounds(), Ok(bounds));
        assert_eq!(Notes::parse("Plain.").bounds(), Ok(vec![]));
    }

    #[test]
    fn ranges_of_every_form_are_read() {
        let of = |range: &str| Notes { range: Some(range.to_owned()), ..Notes::default() }.bounds();
        assert_eq!(of("0 to below 1"), Ok(vec![("minimum", json!(0)), ("exclusiveMaximum", json!(1))]));
        assert_eq!(of("above 0"), Ok(vec![("exclusiveMinimum", json!(0))]));
        assert_eq!(of("above 0 to 1"), Ok(vec![("exclusiveMinimum", json!(0)), ("maximum", json!(1))]));
        assert_eq!(of("at least 2"), Ok(vec![("minimum", json!(2))]));
        assert_eq!(of("some numbers"), Err("some numbers".to_owned()));
    }
}
