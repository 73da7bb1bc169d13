//! Whether both sides of a claim train the same student: what their configs say outside the settings of
//! curricula.

use std::collections::BTreeMap;

use serde_json::Value;

use crate::analysis::ablation;
use crate::analysis::catalogue::Paper;
use crate::analysis::complete::Pair;
use crate::analysis::group;
use crate::store::Run;

/// Most settings that are named.
const MOST_NAMED: usize = 4;

/// `student.width = 512 against 64`: the settings outside those of curricula in which the first unlike runs
/// of one seed differ; `None` where all pairs have the same.
pub(super) fn unlike(pair: &Pair<'_>, paper: &Paper) -> Option<String> {
    if paper.settings.is_empty() {
        return None;
    }
    group::shared_seeds(&pair.a, &pair.b).find_map(|(a, b)| differing(a, b, paper.outer()))
}

fn differing(a: &Run, b: &Run, curricula: &str) -> Option<String> {
    let (a, b) = (outside(a, curricula), outside(b, curricula));
    if a == b {
        return None;
    }
    let value = |leaves: &BTreeMap<String, String>, name: &str| {
        leaves.get(name).cloned().unwrap_or_else(|| "not set".to_owned())
    };
    let names: Vec<&String> = a.keys().chain(b.keys().filter(|name| !a.contains_key(*name))).collect();
    let unlike: Vec<&String> = names.into_iter().filter(|name| a.get(*name) != b.get(*name)).collect();
    let named = |name: &&String| format!("{name} = {} against {}", value(&a, name), value(&b, name));
    let mut text: Vec<String> = unlike.iter().take(MOST_NAMED).map(named).collect();
    if unlike.len() > MOST_NAMED {
        text.push(format!("{} more", unlike.len() - MOST_NAMED));
    }
    Some(text.join("; "))
}

/// Every value of a run's config outside the object at the pointer `curricula`, and apart from a seed, by its
/// path.
fn outside(run: &Run, curricula: &str) -> BTreeMap<String, String> {
    let mut leaves = BTreeMap::new();
    collect("", &run.manifest.config, curricula, &mut leaves);
    leaves
}

fn collect(pointer: &str, value: &Value, skipped: &str, leaves: &mut BTreeMap<String, String>) {
    if pointer == skipped || pointer == "/seed" {
        return;
    }
    if let Value::Object(fields) = value {
        let mut field = |(name, field): (&String, &Value)| {
            collect(&format!("{pointer}/{name}"), field, skipped, leaves);
        };
        fields.iter().for_each(&mut field);
    } else {
        leaves.insert(pointer.trim_start_matches('/').replace('/', "."), ablation::text(value));
    }
}
