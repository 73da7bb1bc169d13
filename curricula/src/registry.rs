//! The table of all teachers.

use looks::Look;
use schemars::Schema;
use toml::Table;

use crate::config::{Checked, Configured, table};
use crate::curriculum::{Curriculum, Setting};
use crate::error::CurriculumError;
use crate::method::Method;
use crate::methods;

/// Every teacher that comes with this crate. A new one is a file in [`methods`], its `pub mod` line there and
/// a row here.
///
/// ```
/// let teach = curricula::CURRICULA.iter().find(|entry| entry.id == "teach").unwrap();
/// assert_eq!(teach.title, "TEACH");
///
/// // A config may leave fields out. Names and values that a method does not have are refused.
/// let config = teach.resolve("window = 3".parse().unwrap())?;
/// assert_eq!(config["window"].as_integer(), Some(3));
/// assert_eq!(config["interplay"].as_integer(), Some(1));
/// assert!(teach.resolve("windw = 3".parse().unwrap()).is_err());
/// # Ok::<(), curricula::CurriculumError>(())
/// ```
pub const CURRICULA: &[Entry] = &[
    Entry::of::<methods::teach::Teach>(),
    Entry::of::<methods::her_iid::HerIid>(),
    Entry::of::<methods::her_iid_pool::HerIidPool>(),
    Entry::of::<methods::vds::Vds>(),
    Entry::of::<methods::space::Space>(),
    Entry::of::<methods::procurl::ProCurl>(),
    Entry::of::<methods::sfl::Sfl>(),
    Entry::of::<methods::plr::Plr>(),
    Entry::of::<methods::goid::Goid>(),
    Entry::of::<methods::lp::Lp>(),
    Entry::of::<methods::alp_gmm::AlpGmm>(),
    Entry::of::<methods::mega::Mega>(),
    Entry::of::<methods::omega::Omega>(),
    Entry::of::<methods::hgg::Hgg>(),
    Entry::of::<methods::process::Process>(),
];

/// A row of the table: a [`Method`] behind functions that do not name its type.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// [`Method::ID`].
    pub id: &'static str,
    /// [`Method::TITLE`].
    pub title: &'static str,
    /// [`Method::SOURCE`].
    pub source: &'static str,
    /// [`Method::VERSION`].
    pub version: &'static str,
    /// [`Method::LOOK`].
    pub look: Option<Look>,
    /// [`Method::USES_POOL`].
    pub uses_pool: bool,
    /// [`Method::NEEDS`].
    pub needs: Option<&'static str>,
    /// The complete default config: every field.
    pub defaults: fn() -> Table,
    /// [`Method::schema`].
    pub schema: fn() -> Option<Schema>,
    /// Completes a config with defaults and checks every field's name, type and range: the only way to a
    /// teacher.
    pub configure: Configure,
}

/// Reads and checks a config. The error is a [`CurriculumError::Config`] that names the field.
pub type Configure = fn(Table) -> Result<Box<dyn Configured>, CurriculumError>;

impl Entry {
    /// The row of method `M`.
    ///
    /// ```
    /// use curricula::{Entry, methods::her_iid::HerIid};
    ///
    /// let row = Entry::of::<HerIid>();
    /// assert_eq!((row.id, row.uses_pool), ("her-iid", false));
    /// ```
    pub const fn of<M: Method>() -> Self {
        Self {
            id: M::ID,
            title: M::TITLE,
            source: M::SOURCE,
            version: M::VERSION,
            look: M::LOOK,
            uses_pool: M::USES_POOL,
            needs: M::NEEDS,
            schema: M::schema,
            defaults: || table(&M::Config::default()),
            configure: |written| Ok(Box::new(Checked::<M>::new(written)?)),
        }
    }

    /// The config that is `written`, completed with defaults.
    ///
    /// # Errors
    /// [`CurriculumError::Config`], naming the first field whose name, type or value is not accepted.
    pub fn resolve(&self, written: Table) -> Result<Table, CurriculumError> {
        Ok((self.configure)(written)?.table())
    }

    /// The teacher with the config that is `written`.
    ///
    /// # Errors
    /// As [`Entry::resolve`], and [`CurriculumError`] if the teacher cannot be built for this setting.
    pub fn build(&self, written: Table, setting: &Setting) -> Result<Box<dyn Curriculum>, CurriculumError> {
        (self.configure)(written)?.build(setting)
    }
}
