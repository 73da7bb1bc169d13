//! The part of the results that a report is about.

use crate::analysis::options::ReportOptions;
use crate::error::ReportError;
use crate::schema::RunKey;
use crate::store::Store;
use crate::wording::counted;

/// What was asked for, and how much of the results it is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Subset {
    /// Environment ids; empty: all.
    pub environments: Vec<String>,
    /// Curriculum ids; empty: all.
    pub curricula: Vec<String>,
    /// Runs in it.
    pub runs: usize,
    /// Runs of the results.
    pub of: usize,
}

impl Subset {
    /// Cuts `store` to the environments and curricula that the options name; `None` where they name none.
    ///
    /// # Errors
    /// [`ReportError::NotInResults`] for a name that no run has.
    pub fn cut(store: &mut Store, options: &ReportOptions) -> Result<Option<Self>, ReportError> {
        let (environments, curricula) = (&options.environments, &options.curricula);
        if environments.is_empty() && curricula.is_empty() {
            return Ok(None);
        }
        check(store, "environments", environments, |run| &run.environment)?;
        check(store, "curricula", curricula, |run| &run.curriculum)?;
        let of = store.runs().len();
        let is_among = |names: &[String], id: &String| names.is_empty() || names.contains(id);
        store.retain(|run| is_among(environments, &run.environment) && is_among(curricula, &run.curriculum));
        let (environments, curricula) = (environments.clone(), curricula.clone());
        Ok(Some(Self { environments, curricula, runs: store.runs().len(), of }))
    }

    /// `Only the environments MazeA and the curricula teach, vds: 6 of the 12 runs of the results.`
    pub fn said(&self) -> String {
        let part = |what: &str, names: &[String]| {
            (!names.is_empty()).then(|| format!("the {what} {}", names.join(", ")))
        };
        let parts = [part("environments", &self.environments), part("curricula", &self.curricula)];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        format!(
            "Only {}: {} of the {} of the results.",
            parts.join(" and "),
            self.runs,
            counted(self.of, "run")
        )
    }
}

fn check(
    store: &Store,
    option: &'static str,
    names: &[String],
    of: fn(&RunKey) -> &String,
) -> Result<(), ReportError> {
    let mut there: Vec<&String> = store.runs().iter().map(|run| of(run.key())).collect();
    there.sort();
    there.dedup();
    match names.iter().find(|name| !there.contains(name)) {
        Some(name) => Err(ReportError::NotInResults {
            option,
            value: name.clone(),
            there: there.into_iter().cloned().collect::<Vec<_>>().join(", "),
        }),
        None => Ok(()),
    }
}
