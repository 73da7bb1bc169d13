//! What stands above a report: its title, what the protocols say of themselves, and of which part of the
//! results it is.

use crate::analysis::options::ReportOptions;
use crate::analysis::subset::Subset;
use crate::store::protocols::ProtocolCopy;

/// Title of a report of results that name no protocol.
const UNTITLED: &str = "Automatic curricula, compared";

/// The head of a report.
pub(super) struct Heading {
    /// As asked for, or else the names of the protocols.
    pub(super) title: String,
    /// A line for each protocol with a description, and one for the part of the results.
    pub(super) lines: Vec<String>,
}

impl Heading {
    /// `guests` are lines about archives beside the results.
    pub(super) fn of(
        options: &ReportOptions,
        protocols: &[ProtocolCopy],
        subset: Option<&Subset>,
        guests: &[String],
    ) -> Self {
        let mut names: Vec<&str> = Vec::new();
        for protocol in protocols {
            if !names.contains(&protocol.name.as_str()) {
                names.push(&protocol.name);
            }
        }
        let of_protocols = if names.is_empty() { UNTITLED.to_owned() } else { names.join(", ") };
        let line = |protocol: &ProtocolCopy| match (protocol.description.trim(), options.title.is_some()) {
            ("", false) => None,
            ("", true) => Some(format!("Protocol {}.", protocol.name)),
            (description, _) => Some(format!("Protocol {}: {description}", protocol.name)),
        };
        let lines =
            protocols.iter().filter_map(line).chain(subset.map(Subset::said)).chain(guests.iter().cloned());
        Self { title: options.title.clone().unwrap_or(of_protocols), lines: lines.collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headings_by_hand() {
        let copy = |name: &str, description: &str| ProtocolCopy {
            name: name.into(),
            description: description.into(),
        };
        let options = ReportOptions::default();
        let of = |options: &ReportOptions, protocols: &[ProtocolCopy]| {
            let heading = Heading::of(options, protocols, None, &[]);
            (heading.title, heading.lines.join("|"))
        };
        assert_eq!(of(&options, &[]), (UNTITLED.to_owned(), String::new()));
        let both = [copy("paper", "The whole."), copy("paper", "A part."), copy("own", "")];
        let lines = "Protocol paper: The whole.|Protocol paper: A part.";
        assert_eq!(of(&options, &both), ("paper, own".to_owned(), lines.to_owned()));
        let titled = ReportOptions { title: Some("Mazes".into()), ..options };
        assert_eq!(of(&titled, &both), ("Mazes".to_owned(), format!("{lines}|Protocol own.")));
    }
}
