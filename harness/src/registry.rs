//! All environments and curricula that a command line knows.

use std::sync::OnceLock;

use curricula::Entry as CurriculumEntry;
use envs::{Environment, Suite};
use reports::schema::RunKey;
use serde_json::Value as Json;

use crate::Program;
use crate::config::schema;
use crate::error::HarnessError;

/// Lists of environments, suites and curricula. A program of your own can extend the built-in ones and then
/// has the whole command line:
/// `goalbench::cli::main(Registry::builtin().of_program(goalbench::program!()).with_environment(MINE))`. See
/// `harness/examples/` for two such programs.
#[derive(Clone)]
pub struct Registry {
    program: Option<Program>,
    environments: Vec<Environment>,
    suites: Vec<Suite>,
    curricula: Vec<CurriculumEntry>,
    /// Made when it is first asked for.
    config_schema: OnceLock<Json>,
}

impl Registry {
    /// Everything that this workspace brings.
    pub fn builtin() -> Self {
        Self {
            program: None,
            environments: envs::environments().cloned().collect(),
            suites: envs::SUITES.to_vec(),
            curricula: curricula::CURRICULA.to_vec(),
            config_schema: OnceLock::new(),
        }
    }

    /// Says which program this is, for the manifests of its runs: `.of_program(goalbench::program!())`. A run
    /// that one program or version began is not carried on by another.
    #[must_use]
    pub fn of_program(mut self, program: Program) -> Self {
        self.program = Some(program);
        self
    }

    /// The program, if it has said which it is.
    pub fn program(&self) -> Option<Program> {
        self.program
    }

    /// Adds a curriculum.
    ///
    /// # Panics
    /// If its id is taken.
    #[must_use]
    pub fn with_curriculum(mut self, entry: CurriculumEntry) -> Self {
        assert!(self.curriculum(entry.id).is_none(), "there already is a curriculum `{}`", entry.id);
        self.curricula.push(entry);
        self.config_schema = OnceLock::new();
        self
    }

    /// The JSON schema of a config, with the options of every curriculum.
    pub fn config_schema(&self) -> &Json {
        self.config_schema.get_or_init(|| schema::config(self))
    }

    /// Adds an environment.
    ///
    /// # Panics
    /// If an environment or a suite is called so already.
    #[must_use]
    pub fn with_environment(mut self, entry: Environment) -> Self {
        self.require_free(entry.id());
        self.environments.push(entry);
        self
    }

    /// Adds a suite: a name that stands for `environments` wherever ids of environments are given.
    ///
    /// # Panics
    /// If an environment or a suite is called `id` already, or if one of `environments` is unknown: add
    /// environments of your own first.
    #[must_use]
    pub fn with_suite(mut self, id: &'static str, environments: &'static [&'static str]) -> Self {
        self.require_free(id);
        for name in environments {
            assert!(self.environment(name).is_some(), "suite `{id}`: there is no environment `{name}`");
        }
        self.suites.push(Suite { id, environments });
        self
    }

    fn require_free(&self, id: &str) {
        let taken = self.environment(id).is_some() || self.suite(id).is_some();
        assert!(!taken, "there already is an environment or suite `{id}`");
    }

    /// All environments, in the order of the table.
    pub fn environments(&self) -> &[Environment] {
        &self.environments
    }

    /// All suites, in the order of the table.
    pub fn suites(&self) -> &[Suite] {
        &self.suites
    }

    /// All curricula, in the order of the table.
    pub fn curricula(&self) -> &[CurriculumEntry] {
        &self.curricula
    }

    /// The environment with this id.
    pub fn environment(&self, id: &str) -> Option<&Environment> {
        self.environments.iter().find(|entry| entry.id() == id)
    }

    /// The suite with this name.
    pub fn suite(&self, id: &str) -> Option<&Suite> {
        self.suites.iter().find(|suite| suite.id == id)
    }

    /// The curriculum with this id.
    pub fn curriculum(&self, id: &str) -> Option<&CurriculumEntry> {
        self.curricula.iter().find(|entry| entry.id == id)
    }

    /// The environments that `names` stand for, ids and suites alike, in order and each once.
    ///
    /// # Errors
    /// [`HarnessError::Unknown`] with a suggestion; `place` says where the name stands.
    pub fn expand_environments(&self, names: &[String], place: &str) -> Result<Vec<String>, HarnessError> {
        let mut ids: Vec<String> = Vec::new();
        for name in names {
            let found = match (self.suite(name), self.environment(name)) {
                (Some(suite), _) => suite.environments,
                (None, Some(entry)) => &[entry.id()],
                (None, None) => {
                    let suites = self.suites.iter().map(|suite| suite.id);
                    let accepted = self.environments.iter().map(Environment::id).chain(suites);
                    return Err(HarnessError::unknown(place, "environment", name, accepted));
                }
            };
            for id in found {
                if !ids.iter().any(|other| other == id) {
                    ids.push((*id).to_owned());
                }
            }
        }
        Ok(ids)
    }

    /// Checks that every name is a curriculum's, and removes repetitions.
    ///
    /// # Errors
    /// [`HarnessError::Unknown`] with a suggestion; `place` says where the name stands.
    pub fn expand_curricula(&self, names: &[String], place: &str) -> Result<Vec<String>, HarnessError> {
        let mut ids: Vec<String> = Vec::new();
        for name in names {
            if self.curriculum(name).is_none() {
                let accepted = self.curricula.iter().map(|entry| entry.id);
                return Err(HarnessError::unknown(place, "curriculum", name, accepted));
            }
            if !ids.contains(name) {
                ids.push(name.clone());
            }
        }
        Ok(ids)
    }

    /// Checks that a recorded run's environment and curriculum are known here.
    ///
    /// # Errors
    /// [`HarnessError::Unknown`] with a suggestion.
    pub fn check(&self, run: &RunKey) -> Result<(), HarnessError> {
        let place = format!("{run}: ");
        self.expand_curricula(std::slice::from_ref(&run.curriculum), &place)?;
        if self.environment(&run.environment).is_none() {
            let accepted = self.environments.iter().map(Environment::id);
            return Err(HarnessError::unknown(place, "environment", &run.environment, accepted));
        }
        Ok(())
    }
}
