//! The table of all teachers.

use looks::Look;
use serde::Serialize;
use serde::de::DeserializeOwned;
use toml::Table;

use crate::curriculum::{Curriculum, Setting};
use crate::error::CurriculumError;
use crate::methods;

/// Every teacher that comes with this crate. A new one is a file in [`methods`], its `pub mod` line there and a row here.
pub const CURRICULA: &[Entry] = &[
    Entry::of::<methods::teach::Teach>(),
    Entry::of::<methods::her_iid::HerIid>(),
    Entry::of::<methods::her_iid_pool::HerIidPool>(),
    Entry::of::<methods::vds::Vds>(),
    Entry::of::<methods::space::Space>(),
    Entry::of::<methods::procurl::ProCurl>(),
];

/// A teaching method: what makes a row of the table.
pub trait Method {
    /// Its options. The config's own doc comments give each field's range and source. Use
    /// `#[serde(default, deny_unknown_fields)]`, so that users may leave fields out but not misspell them.
    type Config: Serialize + DeserializeOwned + Default;
    /// Short name on the command line, in configs and in run folders: lower case with hyphens. In this workspace it is the
    /// name of the method's file with hyphens for underscores.
    const ID: &'static str;
    /// Name in lists, figures and tables.
    const TITLE: &'static str;
    /// How its curves are drawn: unlike any other's. A method without a look of its own gets a free one in each report.
    const LOOK: Option<Look> = None;
    /// The paper, in one line.
    const SOURCE: &'static str;
    /// Whether it chooses from the pool. Such a method is never built on an empty pool.
    const USES_POOL: bool;

    /// Checks the ranges of a config.
    ///
    /// # Errors
    /// [`CurriculumError::Config`], naming the field and what is accepted.
    fn check(_config: &Self::Config) -> Result<(), CurriculumError> {
        Ok(())
    }

    /// Makes the teacher from a checked config.
    ///
    /// # Errors
    /// [`CurriculumError`] if it cannot be built for this setting.
    fn build(config: Self::Config, setting: &Setting) -> Result<Box<dyn Curriculum>, CurriculumError>;
}

/// A row of the table: a [`Method`] with its config behind TOML.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// [`Method::ID`].
    pub id: &'static str,
    /// [`Method::TITLE`].
    pub title: &'static str,
    /// [`Method::LOOK`].
    pub look: Option<Look>,
    /// [`Method::SOURCE`].
    pub source: &'static str,
    /// [`Method::USES_POOL`].
    pub uses_pool: bool,
    /// The complete default config: every field.
    pub defaults: fn() -> Table,
    /// Completes a config with defaults and checks every field's name, type and range; the error names the field.
    pub resolve: fn(Table) -> Result<Table, CurriculumError>,
    /// Makes the teacher from a config, which is checked as in `resolve`.
    pub build: Build,
}

/// Makes a teacher from its config.
pub type Build = fn(&Table, &Setting) -> Result<Box<dyn Curriculum>, CurriculumError>;

impl Entry {
    /// The row of method `M`.
    pub const fn of<M: Method>() -> Self {
        Self {
            id: M::ID,
            title: M::TITLE,
            look: M::LOOK,
            source: M::SOURCE,
            uses_pool: M::USES_POOL,
            defaults: || table(&M::Config::default()),
            resolve: |written| parse::<M>(written).map(|config| table(&config)),
            build: |written, setting| {
                let config = parse::<M>(written.clone())?;
                if M::USES_POOL {
                    let goals = setting.pool.len();
                    CurriculumError::require(goals > 0, "pool.size", "at least 1", goals)?;
                }
                M::build(config, setting)
            },
        }
    }
}

/// A config as a complete table.
fn table<C: Serialize>(config: &C) -> Table {
    Table::try_from(config).expect("a method's config is a struct of TOML values")
}

/// Reads and checks a config.
fn parse<M: Method>(written: Table) -> Result<M::Config, CurriculumError> {
    let config = serde_path_to_error::deserialize(toml::Value::Table(written)).map_err(|error| {
        CurriculumError::Config {
            field: error.path().to_string(),
            reason: error.inner().message().to_owned(),
        }
    })?;
    M::check(&config)?;
    Ok(config)
}
