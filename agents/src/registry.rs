//! The table of all agents.

use envs::Spec;

use crate::agent::Agent;
use crate::config::{DEFAULT_AGENT, StudentConfig};
use crate::ddpg::Ddpg;
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
}

type Constructor = fn(&StudentConfig, &Spec, u64) -> Result<Box<dyn Agent>, AgentError>;

/// All agents, the default one first.
pub static AGENTS: &[AgentRow] = &[AgentRow {
    id: DEFAULT_AGENT,
    title: "DDPG + HER",
    source: "Lillicrap et al. 2016 (arXiv 1509.02971), Andrychowicz et al. 2017 (arXiv 1707.01495)",
    build: |config, spec, seed| Ok(Box::new(Ddpg::new(config, spec, seed)?)),
}];

/// Makes the agent that `config` names, for the task `spec`; the run's `seed` determines its initial weights.
/// Call [`crate::prepare_thread`] first.
///
/// # Errors
/// [`AgentError::Unknown`], [`AgentError::Config`], [`AgentError::Device`].
pub fn make(config: &StudentConfig, spec: &Spec, seed: u64) -> Result<Box<dyn Agent>, AgentError> {
    let Some(row) = AGENTS.iter().find(|row| row.id == config.agent) else {
        let known: Vec<&str> = AGENTS.iter().map(|row| row.id).collect();
        return Err(AgentError::Unknown { name: config.agent.clone(), known: known.join(", ") });
    };
    (row.build)(config, spec, seed)
}
