//! The list of known deviations from the paper.

use super::{Align, Table};
use crate::deviations::DEVIATIONS;

/// The list as a table to read.
pub fn deviation_table() -> Table {
    Table {
        caption:
            "Where the paper is silent or contradicts itself, each choice is a setting with this default."
                .into(),
        columns: ["Topic", "The paper", "Here"].map(|title| (title, Align::Text)).to_vec(),
        rows: DEVIATIONS
            .iter()
            .map(|row| [row.topic, row.paper, row.here].map(str::to_owned).to_vec())
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn deviations_are_complete_sentences_of_three() {
        for row in DEVIATIONS {
            assert!([row.topic, row.paper, row.here].iter().all(|text| !text.is_empty()), "{row:?}");
        }
    }
}
