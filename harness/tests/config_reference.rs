//! The reference of the config: complete, true, and the same as the page in the repository.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]

mod support;

use goalbench::Registry;
use goalbench::config::layer::ConfigLayer;
use goalbench::config::reference::{fields, page};
use goalbench::config::{self, notes::Notes};
use serde_json::Value as Json;
use support::{goalbench, stderr, stdout};

#[test]
fn the_program_prints_the_page_of_its_registry() {
    assert_eq!(stdout(&goalbench(&["help", "config"])), page(&Registry::builtin()));
}

#[test]
fn every_field_is_described() {
    let registry = Registry::builtin();
    let found = fields(registry.config_schema());
    assert!(found.len() > 50, "{}", found.len());
    for field in &found {
        let (path, schema) = (&field.path, field.schema);
        let told = |key: &str| schema[key].as_str().is_some_and(|text| !text.is_empty());
        assert!(told("description"), "{path}: no description");
        assert!(!schema["default"].is_null(), "{path}: no default");
        // The kinds of a table say their sources themselves.
        if path.ends_with(".kind") {
            continue;
        }
        assert!(told("x-source"), "{path}: no source");
        let text = schema.to_string();
        if text.contains("\"integer\"") || text.contains("\"number\"") {
            assert!(told("x-unit"), "{path}: no unit");
            let bounded = ["minimum", "exclusiveMinimum"].iter().any(|key| schema[key].is_number());
            assert!(bounded, "{path}: no range");
        }
        assert_eq!(text.contains("\"const\":\"auto\""), told("x-auto"), "{path}: what is auto?");
        let unread = Notes::parse(schema["description"].as_str().unwrap_or_default());
        assert_eq!(unread.range, None, "{path}: a range that was not read");
    }
    // Every field that a config has is there.
    let defaults = config::defaults(&registry).to_string();
    for field in found.iter().filter(|field| field.kind.is_none_or(|kind| kind == "gaussian")) {
        let name = field.path.rsplit('.').next().expect("a last name");
        assert!(defaults.contains(&format!("{name} = ")), "{}", field.path);
    }
}

/// Whether a run of MazeA with `curriculum` accepts `path = value`.
fn accepts(registry: &Registry, path: &str, kind: Option<&str>, value: &str) -> Result<(), String> {
    let curriculum = path.strip_prefix("curriculum.").and_then(|rest| rest.split('.').next());
    let entry = registry.curriculum(curriculum.unwrap_or("her-iid")).expect("there");
    let spec = &registry.environment("MazeA").expect("there").spec;
    let mut layers = Vec::new();
    let mut set = |assignment: String| {
        layers.push(ConfigLayer::from_assignment("--set", &assignment).expect("an assignment"));
    };
    // What a field's range depends on.
    match path {
        // OMEGA's counts episodes and depends on nothing.
        "curriculum.omega.renewal" => {}
        "curriculum.hgg.trajectories" => set("curriculum.hgg.goals=1".to_owned()),
        _ if path.ends_with(".renewal") => set(format!("{}=initial", path.replace("renewal", "states"))),
        "student.episodes_per_cycle" => set("evaluation.every=1_000_000_000".to_owned()),
        _ if path.ends_with(".easy") => set(format!("{}=0.0", path.replace("easy", "hard"))),
        _ if path.ends_with(".hard") => set(format!("{}=1.0", path.replace("hard", "easy"))),
        "curriculum.goid.highest" => set("curriculum.goid.lowest=0.0".to_owned()),
        "curriculum.goid.earlier" => set("curriculum.goid.fresh=0.0005".to_owned()),
        "curriculum.goid.lowest" => set("curriculum.goid.highest=1.0".to_owned()),
        "curriculum.sfl.candidates" => set("curriculum.sfl.kept=1".to_owned()),
        _ if path.starts_with("curriculum.process.") => set("curriculum.process.command=python".to_owned()),
        _ => {}
    }
    if let (Some(kind), Some((table, _))) = (kind, path.rsplit_once('.')) {
        set(format!("{table}.kind={kind}"));
    }
    set(format!("{path}={value}"));
    config::resolve(registry, spec, entry, &layers).map(|_| ()).map_err(|error| error.to_string())
}

/// The ends of every range are accepted, and what lies just beyond them is refused with the field's path.
#[test]
fn ranges_are_those_that_are_checked() {
    let registry = Registry::builtin();
    let mut checked = 0;
    for field in fields(registry.config_schema()) {
        let (path, schema) = (&field.path, field.schema);
        let whole = schema.to_string().contains("\"integer\"");
        let bound = |key: &str| schema[key].as_f64();
        let shown = |value: f64| if whole { format!("{value:.0}") } else { format!("{value:?}") };
        let step = |value: f64| if whole { 1.0 } else { value.abs().max(1.0) * 1e-3 };
        let mut try_out = |value: f64, good: bool| {
            // Their least is a cycle or an episode of the environment at hand.
            if good && value == 1.0 && matches!(path.as_str(), "student.replay_capacity" | "evaluation.every")
            {
                return;
            }
            let result = accepts(&registry, path, field.kind, &shown(value));
            assert_eq!(result.is_ok(), good, "{path} = {value}: {result:?}");
            if let Err(message) = result {
                assert!(message.contains(&format!(": {path}: ")), "{message}");
            }
            checked += 1;
        };
        if let Some(least) = bound("minimum") {
            try_out(least, true);
            try_out(least - step(least), false);
        }
        if let Some(above) = bound("exclusiveMinimum") {
            try_out(above, false);
            try_out(above + step(above), true);
        }
        if let Some(most) = bound("maximum") {
            try_out(most, true);
            try_out(most + step(most), false);
        }
        if let Some(below) = bound("exclusiveMaximum") {
            try_out(below, false);
            try_out(below - step(below), true);
        }
    }
    assert!(checked > 100, "{checked}");
}

#[test]
fn the_schema_for_editors_accepts_what_the_program_does() {
    let output = goalbench(&["list", "schema"]);
    let schema: Json = serde_json::from_str(&stdout(&output)).expect("JSON");
    assert_eq!(schema["$schema"], "https://json-schema.org/draft/2020-12/schema");
    let fields = schema["properties"].as_object().expect("an object");
    for key in ["name", "environments", "curricula", "seeds", "override", "variant", "student", "curriculum"]
    {
        assert!(fields.contains_key(key), "{key}");
    }
    assert_eq!(fields["student"]["properties"]["layers"]["maximum"], 8);
    let set = &fields["variant"]["items"]["properties"]["set"]["properties"];
    assert_eq!(set["curriculum"]["properties"]["teach"]["properties"]["window"]["minimum"], 2);
    assert_eq!(schema["required"], serde_json::json!(["name", "environments", "curricula", "seeds"]));
}

#[test]
fn help_explains_commands_pages_and_fields() {
    let help = |args: &[&str]| {
        let output = goalbench(&[&["help"], args].concat());
        assert!(output.status.success(), "{args:?}: {}", stderr(&output));
        stdout(&output)
    };
    assert!(help(&[]).contains("Benchmarks automatic curricula"));
    assert!(help(&["run"]).contains("--print-config"));
    assert!(help(&["regress", "check"]).contains("--baseline"));
    assert!(help(&["json"]).contains("goalbench status --json"));
    assert!(help(&["glossary"]).contains("interplay"));
    let noise = help(&["config", "student.noise"]);
    assert!(noise.contains("student.noise.std") && !noise.contains("student.batch"), "{noise}");
    for (args, expected) in [
        (["help", "rnu"].as_slice(), "did you mean `run`?"),
        (&["help", "config", "student.bach"], "did you mean `student.batch`?"),
    ] {
        let output = goalbench(args);
        assert_eq!(output.status.code(), Some(2));
        assert!(stderr(&output).contains(expected), "{}", stderr(&output));
    }
}

#[test]
fn the_resolved_config_of_every_kind_of_run_is_printed_and_nothing_done() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("results");
    let args = support::toy_args(&out, &["--print-config", "--set", "budget.steps=2k"]);
    let output = goalbench(&args);
    assert!(output.status.success(), "{}", stderr(&output));
    let table: toml::Table = stdout(&output).parse().expect("TOML");
    let teach = &table["Point/teach/default"];
    assert_eq!(teach["budget"]["steps"].as_integer(), Some(2000));
    assert_eq!(teach["student"]["layers"].as_integer(), Some(2), "auto is resolved");
    assert_eq!(teach["curriculum"]["teach"]["window"].as_integer(), Some(10));
    assert!(table.contains_key("Point/her-iid/default"));
    assert!(!out.exists());
}
