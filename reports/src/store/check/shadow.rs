//! What the shadows of a run can have done.

use super::{OfEvaluation, beliefs, range};
use crate::schema::{RunKey, ShadowNote, Shadowing};
use crate::store::limits::Limits;
use crate::store::problem::Fault;

impl OfEvaluation for Shadowing {
    fn eval_index(&self) -> u64 {
        self.eval_index
    }

    fn misfit(&self, _: &RunKey, limits: &Limits) -> Option<Fault> {
        let ids: Vec<&str> = self.shadows.iter().map(|shadow| shadow.id.as_str()).collect();
        if limits.shadows.as_ref().is_some_and(|expected| *expected != ids) {
            return range("shadows", ids.join(", "), "the shadows of the config");
        }
        if let Some(id) =
            ids.iter().enumerate().find_map(|(index, id)| ids[..index].contains(id).then_some(id))
        {
            return range("shadows", format!("{id} twice"), "each shadow once");
        }
        self.shadows.iter().find_map(|shadow| misfit(shadow, self.episodes, limits.goals))
    }
}

/// The first thing about `note` that cannot be, after so many episodes and with so many goals in the pool.
fn misfit(note: &ShadowNote, episodes: u64, goals: Option<u64>) -> Option<Fault> {
    let ShadowNote { id, weights, picks, elsewhere, beliefs: believed, failed } = note;
    let wrong = |field: &str, value: String, accepted: &'static str| {
        range(&format!("{field} of {id}"), value, accepted)
    };
    if let Some(weights) = weights {
        if failed.is_some() {
            return wrong("weights", "given".to_owned(), "none from a shadow that has failed");
        }
        if goals.is_some_and(|goals| goals != weights.len() as u64) {
            return wrong(
                "weights",
                format!("{} long", weights.len()),
                "an entry for every goal of the pool",
            );
        }
        if let Some(weight) = weights.iter().find(|weight| !(0.0..=1.0).contains(*weight)) {
            return wrong("weights", weight.to_string(), "numbers in [0, 1]");
        }
    }
    if let Some(told) = believed {
        if failed.is_some() {
            return wrong("beliefs", "given".to_owned(), "none from a shadow that has failed");
        }
        let lists = [&told.success, &told.scores];
        let length = lists.into_iter().flatten().next().map(|list| list.len() as u64);
        let size = goals.or(length).unwrap_or_default();
        if let Some((field, value, accepted)) = beliefs::misfit(told, size) {
            return wrong(field, value, accepted);
        }
    }
    let size = goals.or_else(|| Some(weights.as_ref()?.len() as u64));
    if let Some((goal, _)) = picks.iter().find(|(goal, _)| size.is_some_and(|size| u64::from(*goal) >= size))
    {
        return wrong("picks", goal.to_string(), "indices below the number of goals");
    }
    if let Some(pair) = picks.windows(2).find(|pair| pair[0].0 >= pair[1].0) {
        return wrong("picks", format!("{} after {}", pair[1].0, pair[0].0), "goals by rising index");
    }
    if picks.iter().any(|(_, times)| *times == 0) {
        return wrong("picks", "0 times".to_owned(), "goals that were proposed");
    }
    let proposals: u64 = picks.iter().map(|(_, times)| u64::from(*times)).sum();
    if proposals > episodes || (failed.is_none() && proposals < episodes) {
        return wrong("picks", format!("{proposals} in all"), "one for every episode");
    }
    if *elsewhere > proposals {
        return wrong("elsewhere", elsewhere.to_string(), "at most one for every proposal");
    }
    None
}
