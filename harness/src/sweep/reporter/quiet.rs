//! Nothing but what goes wrong.

use reports::schema::Outcome;

use super::{Reporter, ending_text};
use crate::console;
use crate::sweep::event::Event;
use crate::sweep::job::{Ending, Job};

/// Writes to standard error.
pub(super) struct Quiet;

impl Reporter for Quiet {
    fn started(&self, _: &Job) {}

    fn event(&self, _: &Job, _: &Event) {}

    fn ended(&self, job: &Job, ending: &Ending) {
        if !matches!(ending, Ending::Ended(Outcome::Finished { .. })) {
            self.note(&format!("{}  {}", job.run(), ending_text(ending)));
        }
    }

    fn note(&self, text: &str) {
        console::complain(text);
    }
}
