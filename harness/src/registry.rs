//! All environments and curricula that a command line knows.

use curricula::Entry as CurriculumEntry;
use envs::Environment;
use reports::schema::RunKey;

use crate::error::HarnessError;

/// Tables of environments and curricula. The built-in ones can be extended from a program of one's own, which then
/// has the whole command line: `goalbench::cli::main(Registry::builtin().with_curriculum(Entry::of::<Mine>()))`.
#[derive(Clone)]
pub struct Registry {
    environments: Vec<Environment>,
    curricula: Vec<CurriculumEntry>,
}

impl Registry {
    /// Everything that this workspace brings.
    pub fn builtin() -> Self {
        Self { environments: envs::ENVIRONMENTS.to_vec(), curricula: curricula::CURRICULA.to_vec() }
    }

    /// Adds a curriculum.
    ///
    /// # Panics
    /// If its id is taken.
    #[must_use]
    pub fn with_curriculum(mut self, entry: CurriculumEntry) -> Self {
        assert!(self.curriculum(entry.id).is_none(), "there already is a curriculum `{}`", entry.id);
        self.curricula.push(entry);
        self
    }

    /// Adds an environment.
    ///
    /// # Panics
    /// If its id is taken.
    #[must_use]
    pub fn with_environment(mut self, entry: Environment) -> Self {
        assert!(
            self.environment(entry.spec.id).is_none(),
            "there already is an environment `{}`",
            entry.spec.id
        );
        self.environments.push(entry);
        self
    }

    /// All environments, in the order of the table.
    pub fn environments(&self) -> &[Environment] {
        &self.environments
    }

    /// All curricula, in the order of the table.
    pub fn curricula(&self) -> &[CurriculumEntry] {
        &self.curricula
    }

    /// The environment with this id.
    pub fn environment(&self, id: &str) -> Option<&Environment> {
        self.environments.iter().find(|entry| entry.spec.id == id)
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
            let found = match envs::suite(name) {
                Ok(ids) => ids.iter().map(|id| (*id).to_owned()).collect(),
                Err(_) if self.environment(name).is_some() => vec![name.clone()],
                Err(_) => {
                    let suites = envs::registry::SUITES.iter().map(|(suite, _)| *suite);
                    let accepted = self.environments.iter().map(|entry| entry.spec.id).chain(suites);
                    return Err(HarnessError::unknown(place, "environment", name, accepted));
                }
            };
            for id in found {
                if !ids.contains(&id) {
                    ids.push(id);
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
            let accepted = self.environments.iter().map(|entry| entry.spec.id);
            return Err(HarnessError::unknown(place, "environment", &run.environment, accepted));
        }
        Ok(())
    }
}
