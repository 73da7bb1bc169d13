//! Which teachers watch a run beside the one that acts.

use curricula::Entry as CurriculumEntry;
use guard::text::short;
use toml::{Table, Value};

use super::strict::FieldError;
use crate::Registry;
use crate::suggest::closest;

/// The word that stands for every curriculum that has all it needs.
pub const ALL: &str = "all";

/// Path of the field.
pub const FIELD: &str = "shadow";

/// The ids of the shadows of a run in which `own` acts, as `written` names them: each once, without the one
/// that acts, in the order of the registry. `lacks` tells whether a curriculum lacks what it cannot teach
/// without.
///
/// # Errors
/// The first name that is no curriculum's.
pub(super) fn read(
    written: &[String],
    registry: &Registry,
    own: &CurriculumEntry,
    lacks: impl Fn(&CurriculumEntry) -> bool,
) -> Result<Vec<String>, FieldError> {
    let known = || registry.curricula().iter().map(|entry| entry.id);
    if let Some(name) = written.iter().find(|name| *name != ALL && known().all(|id| id != **name)) {
        let hint = closest(name, known().chain([ALL]));
        let hint = hint.map(|id| format!("; did you mean `{id}`?")).unwrap_or_default();
        let accepted: Vec<&str> = [ALL].into_iter().chain(known()).collect();
        let name = short(name);
        let reason = format!("unknown curriculum `{name}`{hint} (accepted: {})", accepted.join(", "));
        return Err(FieldError { path: FIELD.to_owned(), reason });
    }
    let all = written.iter().any(|name| name == ALL);
    let is_named = |id: &str| written.iter().any(|name| name == id);
    let watches = |entry: &&CurriculumEntry| is_named(entry.id) || (all && !lacks(entry));
    let others = registry.curricula().iter().filter(|entry| entry.id != own.id).filter(watches);
    Ok(others.map(|entry| entry.id.to_owned()).collect())
}

/// Whether the config that is written in `table` makes the curriculum `id` a shadow of some run.
pub fn names(table: &Table, id: &str) -> bool {
    named(table).any(|name| name == id || name == ALL)
}

/// The shadows that `table` names as they stand there, [`ALL`] included.
pub fn named(table: &Table) -> impl Iterator<Item = &str> {
    table.get(FIELD).and_then(Value::as_array).into_iter().flatten().filter_map(Value::as_str)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shadows(written: &[&str]) -> Result<Vec<String>, String> {
        let registry = Registry::builtin();
        let own = registry.curriculum("teach").expect("it is built in");
        let written: Vec<String> = written.iter().map(|name| (*name).to_owned()).collect();
        read(&written, &registry, own, |entry| entry.needs.is_some()).map_err(|error| error.reason)
    }

    #[test]
    fn shadows_are_others_each_once_in_one_order() {
        assert_eq!(shadows(&["plr", "teach", "vds", "plr"]), Ok(vec!["vds".to_owned(), "plr".to_owned()]));
        assert_eq!(shadows(&[]), Ok(Vec::new()));
        let all = shadows(&["all"]).expect("a word that is accepted");
        assert_eq!(
            all.len(),
            curricula::CURRICULA.len() - 2,
            "the one that acts, and one that lacks a command"
        );
        assert!(!all.iter().any(|id| id == "teach" || id == "process"), "{all:?}");
        assert!(shadows(&["all", "process"]).is_ok_and(|ids| ids.iter().any(|id| id == "process")));
        let unknown = shadows(&["vsd"]).expect_err("no curriculum");
        assert!(
            unknown.starts_with("unknown curriculum `vsd`; did you mean `vds`? (accepted: all, teach, "),
            "{unknown}"
        );
    }
}
