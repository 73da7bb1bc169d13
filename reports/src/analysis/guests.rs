//! Results of others beside one's own: baselines that they packed.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use crate::analysis::catalogue::Catalogue;
use crate::error::ReportError;
use crate::store::{Run, Store};
use crate::wording::counted;

/// Results of others that a report draws beside its own.
#[derive(Clone, Debug)]
pub struct Guest {
    /// What marks its methods: `TEACH [NAME]`.
    pub name: String,
    /// Where it comes from, in words: `6 runs in NAME.tar.zst`.
    pub source: String,
    /// Its runs.
    pub store: Store,
}

/// Brings the runs of `guests` into `store`, under curricula of their own that `catalogue` then has, too.
/// Runs in environments that `store` does not have are left out, and so are those of other curricula than
/// `curricula`, where these are named. Gives a line about each guest.
///
/// # Errors
/// [`ReportError::Guest`] if two have one name, or nothing of one is left.
pub(crate) fn welcome(
    store: &mut Store,
    catalogue: &mut Catalogue,
    guests: Vec<Guest>,
    curricula: &[String],
) -> Result<Vec<String>, ReportError> {
    let environments: BTreeSet<String> =
        store.runs().iter().map(|run| run.key().environment.clone()).collect();
    let mut names = BTreeSet::new();
    let mut lines = Vec::new();
    for Guest { name, source, store: theirs } in guests {
        let refused = |reason: String| ReportError::Guest { name: name.clone(), reason };
        if !names.insert(name.clone()) {
            return Err(refused("two archives have this name; rename one of them".to_owned()));
        }
        let is_wanted = |run: &Run| {
            let key = run.key();
            environments.contains(&key.environment)
                && (curricula.is_empty() || curricula.contains(&key.curriculum))
        };
        let mut runs: Vec<Run> = theirs.into_runs().into_iter().filter(is_wanted).collect();
        if runs.iter().all(|run| run.records.is_empty()) {
            let there: Vec<&str> = environments.iter().map(String::as_str).collect();
            return Err(refused(format!(
                "it has no evaluation to set beside these results, of {}",
                there.join(", ")
            )));
        }
        let copies = runs.iter().filter(|run| store.runs().iter().any(|own| is_copy(run, own))).count();
        let ids: BTreeSet<String> = runs.iter().map(|run| run.key().curriculum.clone()).collect();
        ids.iter().for_each(|id| catalogue.add_guest(id, &guest_id(id, &name), &name));
        for run in &mut runs {
            run.manifest.run.curriculum = guest_id(&run.manifest.run.curriculum, &name);
            for record in &mut run.records {
                record.curriculum.clone_from(&run.manifest.run.curriculum);
            }
        }
        let mut line =
            format!("Beside them, marked [{name}], {} of the {source}.", counted(runs.len(), "run"));
        if copies > 0 {
            let _ = write!(
                line,
                " {} once more what these results have already, and no new evidence.",
                are(copies)
            );
        }
        lines.push(line);
        store
            .add_guests(runs)
            .map_err(|id| refused(format!("these results have a curriculum `{id}` of their own")))?;
    }
    Ok(lines)
}

/// Whether two runs are one: of one config, with the same evaluations.
fn is_copy(one: &Run, other: &Run) -> bool {
    let found = |run: &Run| -> Vec<(u64, f64, f64)> {
        run.records.iter().map(|record| (record.step, record.success_rate, record.mean_return)).collect()
    };
    one.manifest.hash == other.manifest.hash && found(one) == found(other)
}

fn are(runs: usize) -> String {
    format!("{} {}", counted(runs, "run"), if runs == 1 { "is" } else { "are" })
}

/// The curriculum id of a guest's runs, in records and files of numbers.
fn guest_id(curriculum: &str, name: &str) -> String {
    format!("{curriculum}@{name}")
}
