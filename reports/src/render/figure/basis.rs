//! What the figures of several environments rest on, and what their captions say of it.

use crate::stats::Resampling;

/// What a figure of several environments rests on.
#[derive(Clone, Copy, Debug)]
pub struct Basis<'a> {
    /// How many environments.
    pub environments: usize,
    /// Whose numbers: `of the 7 seeds that all of them have in each`.
    pub seeds: &'a str,
    /// Fewest runs of a method in an environment.
    pub fewest_runs: usize,
    /// Runs that failed, and count 0 from their failure on.
    pub failed: usize,
    /// How intervals were made.
    pub resampling: Resampling,
}

impl Basis<'_> {
    /// `runs of the 7 seeds that all of them have in each; 2 failed runs count 0 from their failure on`.
    pub(super) fn runs(&self) -> String {
        let failed = match self.failed {
            0 => String::new(),
            1 => "; 1 failed run counts 0 from its failure on".to_owned(),
            k => format!("; {k} failed runs count 0 from their failure on"),
        };
        format!("runs {}{failed}", self.seeds)
    }

    /// `95 % stratified bootstrap intervals over seeds`, and what they are worth where seeds are very few.
    pub(super) fn intervals(&self) -> String {
        let percent = self.resampling.confidence * 100.0;
        let worth = match self.fewest_runs {
            2 => " (of 2 seeds such an interval covers 51 % where it says 95 %)",
            3 => " (of 3 seeds such an interval covers 77 % where it says 95 %)",
            _ => "",
        };
        format!("{percent} % stratified bootstrap intervals over seeds{worth}")
    }
}
