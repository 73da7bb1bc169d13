//! The table of all agents.

use std::path::Path;

use envs::Spec;

use crate::agent::Agent;
use crate::cohort::Cohort;
use crate::config::{DEFAULT_AGENT, StudentConfig};
use crate::ddpg::{self, Ddpg, DdpgCohort};
use crate::error::AgentError;

/// One agent: a row of [`AGENTS`].
#[derive(Debug)]
pub struct AgentRow {
    /// The id that [`StudentConfig::agent`] names.
    pub id: &'static str,
    /// Name for people.
    pub title: &'static str,
    /// The papers it comes from.
    pub source: &'static str,
    build: Constructor,
    check_replay: ReplayCheck,
    cohort: fn(usize) -> Box<dyn Cohort>,
}

type Constructor = fn(&StudentConfig, &Spec, u64) -> Result<Box<dyn Agent>, AgentError>;
type ReplayCheck = fn(&StudentConfig, &[u8], u64, &Path) -> Result<(), AgentError>;

/// All agents, the default one first.
pub static AGENTS: &[AgentRow] = &[AgentRow {
    id: DEFAULT_AGENT,
    title: "DDPG + HER",
    source: "Lillicrap et al. 2016 (arXiv 1509.02971), Andrychowicz et al. 2017 (arXiv 1707.01495)",
    build: |config, spec, seed| Ok(Box::new(Ddpg::new(config, spec, seed)?)),
    check_replay: ddpg::check_replay,
    cohort: |width| Box::new(DdpgCohort::new(width)),
}];

/// Makes the agent that `config` names, for the task `spec`; the run's `seed` determines its initial weights.
/// Call [`crate::prepare_thread`] first.
///
/// # Errors
/// [`AgentError::Unknown`], [`AgentError::Config`], [`AgentError::Device`].
pub fn make(config: &StudentConfig, spec: &Spec, seed: u64) -> Result<Box<dyn Agent>, AgentError> {
    (row(config)?.build)(config, spec, seed)
}

/// What lets students that [`make`] made for `config` learn in lockstep, `width` of them at most unless more
/// come. See [`Cohort`] for what the width is good for.
///
/// # Errors
/// [`AgentError::Unknown`].
pub fn make_cohort(config: &StudentConfig, width: usize) -> Result<Box<dyn Cohort>, AgentError> {
    Ok((row(config)?.cohort)(width))
}

/// Checks that the log in folder `replay` holds all that the agent which `config` names needs to go on from
/// `state`, which [`Agent::save`] gave after `steps` training steps. Changes nothing and needs no task.
///
/// # Errors
/// [`AgentError::Unknown`]; [`AgentError::State`] if `state` is damaged, [`AgentError::Log`] if the log is.
pub fn check_replay(
    config: &StudentConfig,
    state: &[u8],
    steps: u64,
    replay: &Path,
) -> Result<(), AgentError> {
    (row(config)?.check_replay)(config, state, steps, replay)
}

fn row(config: &StudentConfig) -> Result<&'static AgentRow, AgentError> {
    AGENTS.iter().find(|row| row.id == config.agent).ok_or_else(|| {
        let known: Vec<&str> = AGENTS.iter().map(|row| row.id).collect();
        AgentError::Unknown { name: config.agent.clone(), known: known.join(", ") }
    })
}
