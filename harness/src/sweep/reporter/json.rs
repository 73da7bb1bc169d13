//! JSON lines for scripts.

use serde_json::{Value, json};

use super::Reporter;
use crate::sweep::event::Event;
use crate::sweep::job::{Ending, Job};

/// Hands every line, without its newline, to `out`.
pub(super) struct Json<F: Fn(&str) + Sync> {
    pub(super) out: F,
}

impl<F: Fn(&str) + Sync> Json<F> {
    fn tell(&self, job: &Job, mut event: Value) {
        event["run"] = json!(job.run());
        event["steps"] = json!(job.steps());
        (self.out)(&event.to_string());
    }
}

impl<F: Fn(&str) + Sync> Reporter for Json<F> {
    fn started(&self, job: &Job) {
        self.tell(job, json!({ "event": "started" }));
    }

    fn event(&self, job: &Job, event: &Event) {
        self.tell(job, json!(event));
    }

    fn ended(&self, job: &Job, ending: &Ending) {
        let event = match ending {
            Ending::Ended(outcome) => json!(Event::Ended { outcome: outcome.clone() }),
            Ending::Stopped => json!({ "event": "stopped" }),
            Ending::Taken => json!({ "event": "taken" }),
            Ending::Crashed { reason } => json!({ "event": "crashed", "reason": reason }),
        };
        self.tell(job, event);
    }

    fn note(&self, text: &str) {
        (self.out)(&json!({ "event": "note", "text": text }).to_string());
    }
}
