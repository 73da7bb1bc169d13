//! Which part of a config is to blame for an error: the field that the error names may be right by itself and
//! only not fit what somebody set elsewhere.

use toml::{Table, Value};

use super::layer::{ConfigLayer, place_of};

/// Where to look for what is wrong with the field at `path`: in the layer with which it went wrong, at the
/// field itself or else at the one without which the config would be `sound`.
pub(super) fn place(layers: &[ConfigLayer], path: &str, sound: impl Fn(&[ConfigLayer]) -> bool) -> String {
    let breaks = (1..=layers.len()).rev().find(|&count| sound(&layers[..count - 1]));
    let Some((last, below)) = breaks.and_then(|count| layers[..count].split_last()) else {
        return place_of(layers, path);
    };
    let keys: Vec<&str> = path.split('.').collect();
    if last.touches(&keys) {
        return last.origin.place(&keys);
    }
    let is_guilty = |field: &Vec<&str>| {
        let without = ConfigLayer { origin: last.origin.clone(), table: without(&last.table, field) };
        sound(&[below, &[without]].concat())
    };
    let guilty = fields(&last.table).into_iter().find(is_guilty);
    last.origin.place(&guilty.unwrap_or_default())
}

/// The paths of all fields that `table` sets.
fn fields(table: &Table) -> Vec<Vec<&str>> {
    let paths = table.iter().flat_map(|(key, value)| match value {
        Value::Table(inner) => {
            fields(inner).into_iter().map(|path| [&[key.as_str()], path.as_slice()].concat()).collect()
        }
        _ => vec![vec![key.as_str()]],
    });
    paths.collect()
}

/// `table` without the field at `path`.
fn without(table: &Table, path: &[&str]) -> Table {
    let mut table = table.clone();
    match (path, path.first().and_then(|key| table.get_mut(*key))) {
        ([_, rest @ ..], Some(Value::Table(inner))) if !rest.is_empty() => *inner = without(inner, rest),
        ([key, ..], _) => drop(table.remove(*key)),
        ([], _) => {}
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::layer::{Document, Origin};

    /// `a` must not be above `b`, which is 100 unless it is set.
    fn sound(layers: &[ConfigLayer]) -> bool {
        let last = |key: &str, default| {
            let set = layers.iter().rev().find_map(|layer| layer.table.get(key)?.as_integer());
            set.unwrap_or(default)
        };
        last("a", 0) <= last("b", 100)
    }

    fn option(text: &str) -> ConfigLayer {
        ConfigLayer::from_assignment("--set", text).expect("sound")
    }

    fn document(text: &str) -> ConfigLayer {
        let (document, table) = Document::parse("p.toml", text).expect("TOML");
        ConfigLayer { origin: Origin::Document(document, vec![]), table }
    }

    #[test]
    fn the_layer_that_broke_it_is_named_and_not_the_one_that_was_there_before() {
        let of = |layers: &[ConfigLayer]| place(layers, "b", sound);
        assert_eq!(of(&[option("c=1"), option("a=200"), option("d=1")]), "--set a=200");
        assert_eq!(of(&[document("b = 10"), option("a=20")]), "--set a=20");
        assert_eq!(of(&[option("a=20"), option("b=10")]), "--set b=10");
        assert_eq!(of(&[document("[c]\nd = 1\n"), document("c.d = 2\nc.e = 1\na = 200\nf = 1")]), "p.toml:3");
        // Whatever was wrong before and then right is not to blame.
        assert_eq!(of(&[option("a=200"), option("b=300"), option("b=50")]), "--set b=50");
    }
}
