//! What the paper varies are fields of TEACH's config: one that is renamed cannot silently empty a figure.

use std::collections::BTreeSet;

use curricula::methods::teach::AXES;
use toml::Value;

use crate::support::entry;

/// A value as figures and variants write it.
fn text(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

#[test]
fn every_axis_is_a_field_and_its_reference_is_the_default() {
    let defaults = (entry("teach").defaults)();
    for axis in &AXES {
        let default =
            defaults.get(axis.field).unwrap_or_else(|| panic!("TEACH has no field `{}`", axis.field));
        assert_eq!(text(default), axis.reference, "{}", axis.id);
    }
}

#[test]
fn no_two_axes_share_an_id_a_field_or_a_figure() {
    let distinct = |name: fn(usize) -> String| (0..AXES.len()).map(name).collect::<BTreeSet<_>>().len();
    assert_eq!(distinct(|i| AXES[i].id.to_owned()), AXES.len());
    assert_eq!(distinct(|i| AXES[i].field.to_owned()), AXES.len());
    assert_eq!(distinct(|i| AXES[i].figure.to_string()), AXES.len());
}
