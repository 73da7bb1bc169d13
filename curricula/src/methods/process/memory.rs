//! What goalbench remembers of a program that teaches.

use std::collections::BTreeSet;

use envs::Goals;
use envs::rng::Rng;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::curriculum::{Proposal, ProposedGoal, TeacherSummary};
use crate::distribution::Distribution;
use crate::played::told_of;

/// Everything that changes, apart from the program's own state.
#[derive(Serialize, Deserialize)]
pub(super) struct Memory {
    /// The weights that it told last, if it tells any.
    weights: Option<Distribution>,
    /// Its numbers, as it told them last: always the same names.
    statistics: Vec<(String, f64)>,
    /// Training episodes towards each goal of the pool, shape `[N]`.
    tries: Vec<u64>,
    /// Those of them that were successful, shape `[N]`.
    successes: Vec<u64>,
    /// The goal that was proposed for the running episode, if it is of the pool.
    proposed: Option<usize>,
    /// What goalbench draws from on the program's behalf.
    rng: Rng,
}

/// The number of the stream that goalbench draws from; the program has stream 0 of the same key.
const STREAM: u64 = 1;

impl Memory {
    /// Before the first episode: what the program said when it began. `rng` is the teacher's stream.
    ///
    /// # Errors
    /// What is wrong with weights or numbers.
    pub(super) fn begin(
        goals: usize,
        mut rng: Rng,
        weights: Option<Vec<f64>>,
        statistics: Map<String, Value>,
    ) -> Result<Self, String> {
        rng.set_stream(STREAM);
        let weights = weights.map(|weights| distribution(weights, goals)).transpose()?;
        let statistics = numbers(statistics)?;
        for (name, _) in &statistics {
            let snake_case = |c: u8| c.is_ascii_lowercase() || c.is_ascii_digit() || c == b'_';
            if name.is_empty() || !name.bytes().all(snake_case) {
                return Err(format!("the number {name:?} needs a name of a-z, 0-9 and _"));
            }
            if names::OF_WEIGHTS.iter().chain(&names::OF_PICKS).any(|taken| taken == name) {
                return Err(format!("the number `{name}` is recorded by goalbench already"));
            }
        }
        let (tries, successes) = (vec![0; goals], vec![0; goals]);
        Ok(Self { weights, statistics, tries, successes, proposed: None, rng })
    }

    /// Takes over weights and numbers that came with a goal.
    ///
    /// # Errors
    /// What is wrong with them.
    pub(super) fn take(
        &mut self,
        weights: Option<Vec<f64>>,
        statistics: Option<Map<String, Value>>,
    ) -> Result<(), String> {
        if let Some(weights) = weights {
            if self.weights.is_none() {
                return Err("it told no weights when it began, so it cannot tell any now".to_owned());
            }
            self.weights = Some(distribution(weights, self.tries.len())?);
        }
        if let Some(statistics) = statistics {
            let told = numbers(statistics)?;
            let names = |numbers: &[(String, f64)]| -> BTreeSet<String> {
                numbers.iter().map(|(name, _)| name.clone()).collect()
            };
            if names(&told) != names(&self.statistics) {
                let list = |numbers| names(numbers).into_iter().collect::<Vec<_>>().join(", ");
                let (now, before) = (list(&told), list(&self.statistics));
                return Err(format!("its numbers are [{now}]; when it began they were [{before}]"));
            }
            for (name, value) in &mut self.statistics {
                *value = told.iter().find(|(other, _)| other == name).map_or(f64::NAN, |(_, value)| *value);
            }
        }
        Ok(())
    }

    /// Remembers what was proposed.
    pub(super) fn propose(&mut self, proposal: &Proposal) {
        self.proposed = match proposal.goal {
            ProposedGoal::Pool(index) => Some(index),
            ProposedGoal::Native | ProposedGoal::Other(_) => None,
        };
    }

    /// Remembers how the episode towards `goal`, shape `[G]`, ended: the index of that in `pool`, if it is of
    /// the pool. Another teacher may have chosen it.
    pub(super) fn observe(&mut self, pool: &Goals, goal: &[f64], success: bool) -> Option<usize> {
        let index = told_of(pool, goal, self.proposed.take());
        if pool.row(index) != goal {
            return None;
        }
        self.tries[index] += 1;
        self.successes[index] += u64::from(success);
        Some(index)
    }

    /// Episodes and successes of every goal of the pool.
    pub(super) fn history(&self) -> (&[u64], &[u64]) {
        (&self.tries, &self.successes)
    }

    /// What goalbench draws from.
    pub(super) fn rng(&mut self) -> &mut Rng {
        &mut self.rng
    }

    /// Goals of the pool that it was made for; 0 if its parts do not fit each other.
    pub(super) fn goals(&self) -> usize {
        let fits = self.successes.len() == self.tries.len()
            && self.proposed.is_none_or(|index| index < self.tries.len());
        if fits { self.tries.len() } else { 0 }
    }

    /// What there is to record.
    pub(super) fn summary(&self) -> TeacherSummary<'_> {
        let mut summary = self.weights.as_ref().map(Distribution::summary).unwrap_or_default();
        summary.statistics.extend(self.statistics.iter().map(|(name, value)| (name.as_str(), *value)));
        summary
    }
}

/// Weights as a distribution over the pool.
fn distribution(weights: Vec<f64>, goals: usize) -> Result<Distribution, String> {
    if weights.len() != goals {
        return Err(format!("{} weights; the pool has {goals} goals", weights.len()));
    }
    Distribution::try_from(weights).map_err(|reason| format!("weights: {reason}"))
}

/// Numbers by name; null stands for one that is not defined yet.
fn numbers(written: Map<String, Value>) -> Result<Vec<(String, f64)>, String> {
    let number = |(name, value): (String, Value)| match value {
        Value::Null => Ok((name, f64::NAN)),
        // Larger ones overflow in means over seeds.
        Value::Number(number) => match number.as_f64().filter(|number| number.abs() <= f64::from(f32::MAX)) {
            Some(number) => Ok((name, number)),
            None => Err(format!("the number `{name}` is {number}; at most {:e} is accepted", f32::MAX)),
        },
        other => Err(format!("the number `{name}` is {other}; a number or null is accepted")),
    };
    written.into_iter().map(number).collect()
}

#[cfg(test)]
mod tests {
    use envs::rng::{Purpose, stream};

    use super::*;

    #[test]
    fn names_of_numbers_that_goalbench_records_itself_are_refused() {
        let begin = |name: &str| {
            let statistics = Map::from_iter([(name.to_owned(), Value::from(1.0))]);
            Memory::begin(1, stream(0, Purpose::Teacher), None, statistics).err()
        };
        for name in names::OF_WEIGHTS.iter().chain(&names::OF_PICKS) {
            let expected = format!("the number `{name}` is recorded by goalbench already");
            assert_eq!(begin(name), Some(expected));
        }
        assert_eq!(begin("mine"), None);
    }
}
