//! Which settings make readings and which make families of them, on grids like those of the presets.

use std::fs;
use std::path::Path;

use super::readings::{claim, names, readings, write};
use super::support::options;
use reports::ReportOptions;
use reports::analysis::readings::{ReadingFamily, Readings};
use reports::store::layout;
use serde_json::{Value, json};
use tempfile::TempDir;

/// A config of NOVA or of another curriculum with the budget of its environment, as protocols resolve it:
/// NOVA's defaults but for `settings`.
fn resolved(environment: &str, curriculum: &str, goals: &str, settings: &[(&str, Value)]) -> Value {
    let (steps, every) = if environment == "ArmReach" { (600, 500) } else { (1_000, 1_000) };
    let mut own = json!({});
    if curriculum == "nova" {
        own = json!({
            "window": 10, "interplay": 1, "record": "cycle", "signal": "variance", "confidence": "online",
            "states": "reference", "replay_states": 8, "selection": "proportional",
        });
        settings.iter().for_each(|(name, value)| own[*name] = value.clone());
    }
    json!({
        "budget": {"steps": steps},
        "evaluation": {"every": every, "goals": goals},
        "curriculum": {curriculum: own},
    })
}

#[test]
fn the_preset_reduced_has_no_readings() {
    let results = TempDir::new().unwrap();
    let variants: [(&str, &[(&str, Value)]); 7] = [
        ("default", &[]),
        ("n3", &[("window", json!(3))]),
        ("n5", &[("window", json!(5))]),
        ("n20", &[("window", json!(20))]),
        ("d5", &[("interplay", json!(5))]),
        ("d50", &[("interplay", json!(50))]),
        ("n3-target", &[("window", json!(3)), ("confidence", json!("target-critic"))]),
    ];
    for environment in ["RoomA", "ArmReach"] {
        for (index, (variant, settings)) in variants.iter().enumerate() {
            let config = resolved(environment, "nova", "environment", settings);
            write(results.path(), environment, "nova", variant, 0.1 * index as f64, &config);
        }
        for curriculum in ["wren", "moss", "kite", "dull", "dull-pool"] {
            let config = resolved(environment, curriculum, "environment", &[]);
            write(results.path(), environment, curriculum, "default", 0.3, &config);
        }
    }
    assert_eq!(readings(results.path()), Readings::default());
}

/// The grid of the preset `ambiguity` in two of its environments, and a window of its own in one.
fn write_ambiguity(path: &Path) {
    for environment in ["RoomA", "ArmReach"] {
        let write_nova = |label: &str, rate: f64, goals: &str, settings: &[(&str, Value)]| {
            let config = resolved(environment, "nova", goals, settings);
            write(path, environment, "nova", label, rate, &config);
        };
        for (goals, suffix) in [("environment", ""), ("pool", "+goals=pool")] {
            for (states, rate) in [("reference", 0.6), ("replay", 0.7), ("initial", 0.8)] {
                for (selection, less) in [("proportional", 0.0), ("argmax", 0.01)] {
                    let names: Vec<&str> = [states, selection]
                        .into_iter()
                        .filter(|name| !["reference", "proportional"].contains(name))
                        .collect();
                    let label = (names.join("+") + suffix).trim_start_matches('+').to_owned();
                    let label = if label.is_empty() { "default" } else { &label };
                    let settings = [("states", json!(states)), ("selection", json!(selection))];
                    write_nova(label, rate - less, goals, &settings);
                }
            }
            let label = if suffix.is_empty() { "default" } else { "goals=pool" };
            for curriculum in ["dull", "dull-pool"] {
                let config = resolved(environment, curriculum, goals, &[]);
                write(path, environment, curriculum, label, 0.3, &config);
            }
        }
        write_nova("d10", 0.6, "environment", &[("interplay", json!(10))]);
        let settings = [("interplay", json!(10)), ("record", json!("evaluation"))];
        write_nova("d10+evaluation", 0.1, "environment", &settings);
    }
    let config = resolved("RoomA", "nova", "environment", &[("window", json!(3))]);
    write(path, "RoomA", "nova", "n3", 0.9, &config);
}

#[test]
fn readings_at_other_settings_are_a_family_of_their_own() {
    let results = TempDir::new().unwrap();
    write_ambiguity(results.path());
    let found = readings(results.path());
    let of = |family: &ReadingFamily| (family.name.clone(), family.readings.len(), family.claims.len());
    let sizes: Vec<_> = found.families.iter().map(of).collect();
    assert_eq!(sizes, [(String::new(), 12, 4), ("Δ = 10".to_owned(), 2, 4)]);
    for (family, count) in found.families.iter().zip([12.0, 2.0]) {
        // Budgets differ between these environments, settings of NOVA do not.
        assert_eq!((family.environments.join(" "), family.left_out.len()), ("ArmReach RoomA".into(), 0));
        for (_, entry) in family.claims.iter().flat_map(|claim| &claim.judged) {
            assert!((entry.confidence - (1.0 - 0.05 / count)).abs() < 1e-12, "{}", entry.confidence);
            assert_eq!(entry.effect.places.len(), 2);
        }
    }
    let [default, slow] = &found.families[..] else { unreachable!("two, as seen above") };
    let conclusion = |family| claim(family, "final-dull").conclusion.clone();
    assert_eq!(conclusion(default), "the same under all 12 readings: confirmed");
    assert_eq!(names(slow), ["record = cycle", "record = evaluation"]);
    let expected = "hangs on the reading: confirmed under record = cycle, refuted under record = evaluation";
    assert_eq!(conclusion(slow), expected);
    reports::write(results.path(), &ReportOptions { window: 1, ..options() }).unwrap();
    let folder = layout::report_dir(results.path());
    let summary = fs::read_to_string(folder.join("summary.md")).unwrap();
    let row = format!(
        "| NOVA reaches a higher final success than DULL on average over environments, at Δ = 10 | all together | \
         hangs on it | {expected} |"
    );
    assert!(summary.contains(&row), "{summary}");
    assert!(
        summary.contains("that have all of them: ArmReach, RoomA; at Δ = 10: ArmReach, RoomA. A reading")
    );
    let csv = fs::read_to_string(folder.join("readings.csv")).unwrap();
    assert_eq!(csv.lines().filter(|line| line.starts_with("final-dull,,")).count(), 12);
    assert_eq!(csv.lines().filter(|line| line.starts_with("final-dull,Δ = 10,")).count(), 2);
}
