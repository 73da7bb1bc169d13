//! Whether runs of one seed are a pair although they come from different results.
//!
//! Within one results folder they are: the program sees to it that they share initial weights, goals and
//! evaluation episodes. Runs of an archive may have been made otherwise.

use serde_json::Value;

use crate::analysis::group::{Group, shared_seeds};
use crate::schema::Manifest;
use crate::store::cells::first_difference;

/// The versions, by their names in manifests, that starts, goals and episodes follow from.
const VERSIONS: [&str; 3] = ["goalbench", "libtorch", "mujoco"];

/// Why runs of one seed of `a` and `b` are no pairs, in words; `None` where they are, or there are none.
pub fn obstacle(a: &Group<'_>, b: &Group<'_>) -> Option<String> {
    if a.key.curriculum.origin == b.key.curriculum.origin {
        return None;
    }
    shared_seeds(a, b).find_map(|(a, b)| between(&a.manifest, &b.manifest))
}

fn between(a: &Manifest, b: &Manifest) -> Option<String> {
    for name in VERSIONS {
        let [a, b] = [a, b].map(|manifest| manifest.versions.get(name).map_or("not told", String::as_str));
        if a != b || a == "not told" {
            return Some(format!("version of {name}: {a} and {b}"));
        }
    }
    let [a, b] = [a, b].map(|manifest| besides_the_curriculum(&manifest.config));
    first_difference(&a, &b).map(|pointer| format!("their configs differ at {pointer}"))
}

/// A config without what curricula are meant to differ in.
fn besides_the_curriculum(config: &Value) -> Value {
    let mut config = config.clone();
    if let Value::Object(fields) = &mut config {
        fields.remove("curriculum");
    }
    config
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::schema::{RunKey, SCHEMA};

    fn manifest(config: Value, versions: [&str; 3]) -> Manifest {
        let [environment, curriculum, variant] = ["MazeA", "nova", "default"].map(String::from);
        Manifest {
            schema: SCHEMA,
            run: RunKey { environment, curriculum, variant, seed: 0 },
            config,
            hash: String::new(),
            versions: VERSIONS.map(String::from).into_iter().zip(versions.map(String::from)).collect(),
            earlier_budgets: Vec::new(),
        }
    }

    #[test]
    fn pairs_share_versions_and_all_but_the_curriculum() {
        let now = ["0.1.0", "2.11.0", "3.3.7"];
        let config =
            |width: u64, window: u64| json!({"student": {"width": width}, "curriculum": {"n": window}});
        let own = manifest(config(64, 3), now);
        assert_eq!(between(&own, &manifest(config(64, 5), now)), None);
        let wide = between(&own, &manifest(config(256, 3), now));
        assert_eq!(wide.as_deref(), Some("their configs differ at /student/width"));
        let older = between(&own, &manifest(config(64, 3), ["0.1.0", "2.11.0", "3.3.6"]));
        assert_eq!(older.as_deref(), Some("version of mujoco: 3.3.7 and 3.3.6"));
        let mut silent = manifest(config(64, 3), now);
        silent.versions.clear();
        let said = between(&silent, &silent);
        assert_eq!(said.as_deref(), Some("version of goalbench: not told and not told"));
    }
}
