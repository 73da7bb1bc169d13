//! A method's row and its config.

use toml::{Table, Value};

use super::{GOALS, restless};
use crate::error::CurriculumError;
use crate::registry::Entry;
use crate::testing::Class;

pub(super) fn is_in_order(entry: &Entry) {
    let Entry { id, title, source, .. } = *entry;
    let plain = id.bytes().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == b'-');
    assert!(plain && !id.is_empty(), "`{id}` is not lower case with hyphens");
    assert!(!title.is_empty() && !source.is_empty(), "{id}: has no title or no source");
}

pub(super) fn has_complete_and_valid_defaults(entry: &Entry) {
    let defaults = (entry.defaults)();
    let resolve =
        |table| entry.resolve(table).unwrap_or_else(|error| panic!("{}: the defaults: {error}", entry.id));
    assert_eq!(resolve(Table::new()), defaults, "{}: the defaults are not complete", entry.id);
    assert_eq!(resolve(defaults.clone()), defaults, "{}: the defaults do not stay as they are", entry.id);
}

pub(super) fn refuses_what_a_config_has_not(entry: &Entry) {
    const MISSPELT: &str = "no-option-is-called-this";
    let refusal = |field: &str, value: Value| {
        let written = Table::from_iter([(field.to_owned(), value.clone())]);
        match entry.resolve(written) {
            Err(CurriculumError::Config { field, reason }) => (field, reason),
            other => panic!("{}: {field} = {value} gives {other:?}", entry.id),
        }
    };
    let (named, reason) = refusal(MISSPELT, 3.into());
    assert!(named == MISSPELT && reason.contains("unknown field"), "{}: {named}: {reason}", entry.id);
    for (field, value) in (entry.defaults)() {
        let of_another_type = if value.is_array() { Value::Boolean(true) } else { Value::Array(Vec::new()) };
        let (named, reason) = refusal(&field, of_another_type);
        assert_eq!(named, field, "{}: {reason}", entry.id);
    }
}

pub(super) fn says_whether_it_needs_a_pool(entry: &Entry) {
    match Class::with(entry, "", 0, restless) {
        Ok(_) => assert!(!entry.uses_pool, "{}: is built without the pool that it uses", entry.id),
        Err(CurriculumError::Config { field, .. }) if field == "pool.size" => {
            assert!(entry.uses_pool, "{}: asks for a pool that it does not use", entry.id);
        }
        Err(error) => panic!("{}: {error}", entry.id),
    }
    Class::with(entry, "", GOALS, restless).unwrap_or_else(|error| panic!("{}: {error}", entry.id));
}
