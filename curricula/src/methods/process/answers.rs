//! What a program's answers come to, and what goalbench tells a program that asks.

use envs::Rows;
use serde_json::Value;

use super::Process;
use super::memory::Memory;
use super::wire::{Ask, Message};
use crate::curriculum::{Lesson, Proposal, Rank};
use crate::error::CurriculumError;
use crate::fresh::sample_goals;

/// The most rows that one question may ask for, and the most pairs of a goal and a state.
const MOST: usize = 1_000_000;

/// The proposal that a program made.
///
/// # Errors
/// What is wrong with it.
pub(super) fn proposal(
    goal: &Value,
    score: Option<f64>,
    rank: Option<(usize, usize)>,
    process: &Process,
) -> Result<Proposal, String> {
    let proposal = match goal {
        Value::String(text) if text == "native" => Proposal::native(),
        Value::Number(_) => Proposal::pool(index(goal, process.pool.len())?),
        Value::Array(numbers) => Proposal::other(vector(numbers, process.goal)?),
        other => {
            let accepted = "an index into the pool, \"native\" or a list of numbers is accepted";
            return Err(format!("the goal is {}; {accepted}", short(other)));
        }
    };
    let proposal = proposal.scored(score);
    match rank {
        None => Ok(proposal),
        Some((place, of)) if place < of => Ok(proposal.ranked(Rank { place, of })),
        Some((place, of)) => {
            Err(format!("rank [{place}, {of}]: the place is to be below the number of goals"))
        }
    }
}

/// An index into a pool of `goals`.
fn index(value: &Value, goals: usize) -> Result<usize, String> {
    let index = value.as_u64().and_then(|index| usize::try_from(index).ok()).filter(|&index| index < goals);
    index.ok_or_else(|| format!("the goal is {value}; the pool has the goals 0 to {}", goals - 1))
}

/// A goal of its own, shape `[G]`.
fn vector(numbers: &[Value], width: usize) -> Result<Vec<f64>, String> {
    if numbers.len() != width {
        return Err(format!("the goal has {} numbers; goals of this task have {width}", numbers.len()));
    }
    // Students and records have goals in single precision.
    let fits = |number: &f64| (*number as f32).is_finite();
    let number = |(i, value): (usize, &Value)| {
        value.as_f64().filter(fits).ok_or_else(|| {
            format!("number {i} of the goal is {}; numbers up to {:e} are accepted", short(value), f32::MAX)
        })
    };
    numbers.iter().enumerate().map(number).collect()
}

/// A value as errors show it.
fn short(value: &Value) -> String {
    let text = value.to_string();
    if text.len() <= 60 { text } else { format!("{}...", &text[..text.floor_char_boundary(60)]) }
}

/// What a program is told that asks. The inner error is what is wrong with its question.
///
/// # Errors
/// [`CurriculumError`] if the student's values are unusable.
pub(super) fn tell<'a>(
    ask: &Ask,
    process: &Process,
    memory: &mut Memory,
    lesson: &mut Lesson<'_>,
) -> Result<Result<Message<'a>, String>, CurriculumError> {
    let told = match ask {
        Ask::Confidence { goals, states, network } => {
            let goals = match goals {
                None => Ok(process.pool.as_ref().clone()),
                Some(goals) => rows(goals, process.goal, "goals"),
            };
            let states = match states {
                None => rows(std::slice::from_ref(&lesson.start.state), process.state, "states"),
                Some(states) => rows(states, process.state, "states"),
            };
            let (goals, states) = match (goals, states) {
                (Ok(goals), Ok(states)) => (goals, states),
                (Err(reason), _) | (_, Err(reason)) => return Ok(Err(reason)),
            };
            if goals.len().saturating_mul(states.len()) > MOST {
                let reason =
                    format!("it asks for the confidence in more than {MOST} pairs of goal and state");
                return Ok(Err(reason));
            }
            Message::Confidence { values: lesson.student.confidence(&goals, &states, *network)? }
        }
        Ask::FreshGoals { count } | Ask::ReplayStates { count } | Ask::ReplayAchieved { count }
            if *count > MOST =>
        {
            return Ok(Err(format!("it asks for {count} rows; at most {MOST} are accepted")));
        }
        Ask::FreshGoals { count } => {
            let goals = sample_goals(lesson.goals, process.goal, *count, memory.rng());
            Message::FreshGoals { goals: lists(&goals) }
        }
        Ask::ReplayStates { count } => {
            Message::ReplayStates { states: lists(&lesson.student.replay_states(*count, memory.rng())) }
        }
        Ask::ReplayAchieved { count } => {
            Message::ReplayAchieved { goals: lists(&lesson.student.replay_achieved(*count, memory.rng())) }
        }
        Ask::History {} => {
            let (tries, successes) = memory.history();
            Message::History { tries: tries.to_vec(), successes: successes.to_vec() }
        }
    };
    Ok(Ok(told))
}

/// Lists of `width` numbers each as rows; at least one.
fn rows(lists: &[Vec<f64>], width: usize, what: &str) -> Result<Rows, String> {
    if lists.is_empty() {
        return Err(format!("it asks for the confidence in no {what}"));
    }
    let mut rows = Rows::with_capacity(width, lists.len());
    for list in lists {
        if list.len() != width {
            return Err(format!("{what} of {} numbers; this task's have {width}", list.len()));
        }
        rows.push(list);
    }
    Ok(rows)
}

fn lists(rows: &Rows) -> Vec<Vec<f64>> {
    rows.iter().map(<[f64]>::to_vec).collect()
}
