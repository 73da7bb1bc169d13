//! Protocols, `--set` assignments, lists of seeds.

use goalbench::Registry;
use goalbench::config::layer::ConfigLayer;
use goalbench::config::{defaults, seeds};
use goalbench::protocol::Protocol;
use goalbench::protocol::plan::Plan;
use goalbench::run::manifest;
use proptest::prelude::*;
use proptest::sample::select;
use reports::schema::Manifest;

use crate::damage::{damaged, damages, value};
use crate::target::fuzz;

/// Protocols with all that a protocol can hold.
const PROTOCOLS: [&str; 5] = [
    include_str!("../../src/protocol/presets/ambiguity.toml"),
    include_str!("../../src/protocol/presets/reduced.toml"),
    include_str!("../../src/protocol/presets/smoke.toml"),
    include_str!("../../baselines/gate.toml"),
    include_str!("../../examples/search.toml"),
];

const SMALL: &str = "name = 'small'\nenvironments = ['Point']\ncurricula = ['teach']\nseeds = [0]\n";

/// What was planned is what a manifest keeps.
fn assert_kept(plan: &Plan) {
    for run in plan.runs.iter().take(4) {
        let text = serde_json::to_string(&manifest::manifest(run)).expect("plain data");
        let read: Manifest = serde_json::from_str(&text).expect("what was written");
        assert_eq!(manifest::config(&read).expect("what was written"), run.config);
    }
}

#[test]
fn protocols() {
    let inputs = (select(PROTOCOLS.to_vec()), damages());
    fuzz("protocols", 500, &inputs, |(text, damages)| {
        let bytes = damaged(text.as_bytes(), &damages);
        let text = String::from_utf8_lossy(&bytes);
        let registry = Registry::builtin();
        match Protocol::parse("damaged.toml", &text, &registry) {
            Err(error) => {
                let said = error.to_string();
                assert!(said.contains("damaged.toml"), "{said}");
            }
            Ok(protocol) => {
                if let Ok(plan) = Plan::new(&protocol, &registry) {
                    assert_kept(&plan);
                    let trials = protocol.trials(&registry).ok().flatten();
                    if let Some(Ok(plan)) = trials.map(|trials| Plan::new(&trials.protocol, &registry)) {
                        assert_kept(&plan);
                    }
                }
            }
        }
    });
}

/// Every path of the config, in its order.
fn paths(table: &toml::Table, prefix: &str, found: &mut Vec<String>) {
    for (key, value) in table {
        let path = format!("{prefix}{key}");
        if let Some(inner) = value.as_table() {
            paths(inner, &format!("{path}."), found);
        }
        found.push(path);
    }
}

#[test]
fn assignments() {
    let registry = Registry::builtin();
    let mut known = Vec::new();
    paths(&defaults(&registry), "", &mut known);
    let assignment = (select(known), value()).prop_map(|(path, value)| format!("{path}={value}"));
    let chain = (1..30_000usize).prop_map(|depth| "a.".repeat(depth) + "b=1");
    let inputs = prop_oneof![
        20 => assignment.clone(),
        6 => (assignment, damages()).prop_map(|(text, damages)| {
            String::from_utf8_lossy(&damaged(text.as_bytes(), &damages)).into_owned()
        }),
        1 => chain,
        2 => any::<String>(),
    ];
    fuzz("assignments", 2500, &inputs, |text| {
        let mut protocol = Protocol::parse("small.toml", SMALL, &registry).expect("a valid protocol");
        match ConfigLayer::from_assignment("--set", &text) {
            Err(error) => assert!(error.to_string().contains("--set"), "{error}"),
            Ok(layer) => {
                protocol.set(layer);
                match Plan::new(&protocol, &registry) {
                    Err(error) => assert!(!error.to_string().is_empty()),
                    Ok(plan) => assert_kept(&plan),
                }
            }
        }
    });
}

#[test]
fn lists_of_seeds() {
    let part = prop_oneof![
        any::<u64>().prop_map(|seed| seed.to_string()),
        (any::<u64>(), any::<u64>()).prop_map(|(from, to)| format!("{from}..{to}")),
        (0..50u64, 0..9_000u64).prop_map(|(from, length)| format!("{from}..{}", from + length)),
        "[0-9.,= -]{0,12}",
    ];
    let inputs = prop_oneof![
        proptest::collection::vec(part, 1..12).prop_map(|parts| parts.join(",")),
        any::<String>(),
    ];
    fuzz("seeds", 1000, &inputs, |text| {
        let Ok(list) = seeds::parse(&text) else { return };
        assert!(!list.is_empty());
        let written: Vec<String> = list.iter().map(u64::to_string).collect();
        assert_eq!(seeds::parse(&written.join(",")).expect("what was read"), list);
    });
}
