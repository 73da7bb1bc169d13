//! Runs that are not what they were when they ended.

use std::fs;
use std::path::{Path, PathBuf};

use super::support::{key, line, seal, write_configured, write_run};
use reports::schema::Outcome;
use reports::store::layout::{CHECKSUMS, MANIFEST, OUTCOME, RECORDS, STUDENT, TEACHING};
use reports::store::{RunFolder, Store, check_ended, learning, teaching};
use serde_json::{Value, json};
use tempfile::TempDir;

#[test]
fn a_run_that_was_altered_after_its_end_is_named_and_left_out() {
    /// A run with a teaching file, and what is said after `damage`.
    fn told(damage: impl FnOnce(&Path)) -> (Vec<String>, usize) {
        let results = TempDir::new().unwrap();
        let folder = write_run(results.path(), &key("E", "nova", "default", 0), &[0.0, 0.5]);
        fs::write(folder.join(TEACHING), "").unwrap();
        seal(&folder);
        let whole = Store::read(results.path()).unwrap();
        assert_eq!((whole.problems(), whole.len()), (&[][..], 2));
        damage(&folder);
        let store = Store::read(results.path()).unwrap();
        (store.problems().iter().map(ToString::to_string).collect(), store.runs().len())
    }
    let write = |name: &'static str, text: &'static str| {
        move |folder: &Path| {
            fs::write(folder.join(name), text).unwrap();
        }
    };
    let remove = |name: &'static str| move |folder: &Path| fs::remove_file(folder.join(name)).unwrap();
    let replace = |name: &'static str, from: &'static str, to: &'static str| {
        move |folder: &Path| {
            let text = fs::read_to_string(folder.join(name)).unwrap();
            assert!(text.contains(from));
            fs::write(folder.join(name), text.replace(from, to)).unwrap();
        }
    };
    let cut = |folder: &Path| {
        let path = folder.join(RECORDS);
        let text = fs::read_to_string(&path).unwrap();
        fs::write(&path, text.split_inclusive('\n').next().unwrap()).unwrap();
    };
    let altered = "was cut off or altered after the run ended, run left out";
    let cases = [
        (told(replace(RECORDS, "\"success_rate\":0.5", "\"success_rate\":0.9")), RECORDS, altered),
        (told(write(RECORDS, "")), RECORDS, altered),
        (told(cut), RECORDS, altered),
        (
            told(remove(RECORDS)),
            RECORDS,
            "cannot read this file: No such file or directory (os error 2), run left out",
        ),
        (told(write(TEACHING, "{}\n")), TEACHING, altered),
        (
            told(remove(TEACHING)),
            TEACHING,
            "cannot read this file: No such file or directory (os error 2), run left out",
        ),
        (told(replace(OUTCOME, "1000", "0")), OUTCOME, altered),
        (told(write(OUTCOME, r#"{"status":"failed","step":1000,"reason":"x"}"#)), OUTCOME, altered),
        (told(remove(CHECKSUMS)), CHECKSUMS, "is missing, though the run has ended, run left out"),
    ];
    for ((problems, runs), file, expected) in cases {
        assert_eq!((problems, runs), (vec![format!("runs/E/nova/default/seed-0/{file}: {expected}")], 0));
    }
    let (problems, runs) = told(replace(MANIFEST, "256", "1024"));
    let expected = "its hash does not fit its config: it was altered after it was written, and the run may have had \
                    another config";
    assert_eq!((problems, runs), (vec![format!("runs/E/nova/default/seed-0/{MANIFEST}: {expected}")], 1));
}

/// A run of three evaluations whose config bounds what it can record.
fn bounded(results: &Path) -> PathBuf {
    let config = json!({
        "budget": { "steps": 1_990 },
        "evaluation": { "episodes": 20 },
        "student": { "updates_per_cycle": 1 },
    });
    write_configured(results, &key("E", "nova", "default", 0), &[0.0, 0.5, 1.0], config)
}

/// What a lenient and a strict reader say of the run in `folder`.
fn said(results: &Path, folder: &Path) -> (Vec<String>, Option<String>) {
    let problems = Store::read(results).unwrap().problems().iter().map(ToString::to_string).collect();
    let run = RunFolder::new(folder);
    let (manifest, outcome) = (run.manifest().unwrap().unwrap(), run.outcome().unwrap().unwrap());
    (problems, check_ended(&run, &manifest, &outcome).err().map(|error| error.to_string()))
}

#[test]
fn an_outcome_must_fit_where_no_checksum_was_noted_of_it() {
    let results = TempDir::new().unwrap();
    let folder = bounded(results.path());
    let sums = fs::read_to_string(folder.join(CHECKSUMS)).unwrap();
    let mut sums: Value = serde_json::from_str(&sums).unwrap();
    sums["sha256"].as_object_mut().unwrap().remove(OUTCOME).unwrap();
    fs::write(folder.join(CHECKSUMS), sums.to_string()).unwrap();
    assert_eq!(said(results.path(), &folder), (vec![], None), "old versions noted none");
    let failed = |step| Outcome::Failed { step, reason: "NaN".into() };
    for (outcome, expected) in [
        (Outcome::Finished { step: 0 }, "finished at step 0, but the last evaluation is at step 2000"),
        (
            Outcome::Finished { step: u64::MAX },
            "finished at step 18446744073709551615, but the last evaluation is at step 2000",
        ),
        (failed(1_000), "failed at step 1000, but the last evaluation is at step 2000"),
        (failed(u64::MAX), "failed at step 18446744073709551615, which is beyond its budget"),
    ] {
        fs::write(folder.join(OUTCOME), line(&outcome)).unwrap();
        let (problems, refusal) = said(results.path(), &folder);
        let expected = format!("outcome.json: says that the run {expected}");
        assert!(problems[0].ends_with(&format!("{expected}; the evaluations are kept")), "{problems:?}");
        assert!(refusal.is_some_and(|refusal| refusal.ends_with(&expected)));
    }
}

#[test]
fn numbers_that_the_config_rules_out_are_named_though_checksums_fit() {
    let forged = |from: &str, to: &str, expected: &str| {
        let results = TempDir::new().unwrap();
        let folder = bounded(results.path());
        let text = fs::read_to_string(folder.join(RECORDS)).unwrap();
        assert!(text.contains(from));
        fs::write(folder.join(RECORDS), text.replacen(from, to, 1)).unwrap();
        seal(&folder);
        let (problems, refusal) = said(results.path(), &folder);
        assert!(problems[0].contains("records.jsonl:") && problems[0].ends_with(expected), "{problems:?}");
        let refusal = refusal.expect("it is refused");
        assert!(refusal.contains("records.jsonl: line ") && refusal.ends_with(expected), "{refusal}");
    };
    let most = u64::MAX.to_string();
    forged("\"episodes\":20", &format!("\"episodes\":{most}"), "expected as many as the config says");
    forged("\"episodes\":20", "\"episodes\":40", "expected as many as the config says");
    let gradient_steps = format!("\"gradient_steps\":{most}");
    forged("\"gradient_steps\":400", &gradient_steps, "expected no more than the config's updates per cycle");
    let few = "expected at least -1 for every step of an episode";
    forged("\"mean_return\":-50.0", "\"mean_return\":-1.7e308", few);
    forged("\"mean_return\":-50.0", "\"mean_return\":-1000.5", few);
    forged("\"step\":2000", &format!("\"step\":{most}"), "expected a step within the budget");
    // A cycle of 1,000 steps cannot end later than this.
    forged("\"step\":2000", "\"step\":2990", "expected a step within the budget");
}

#[test]
fn what_stands_beside_an_evaluation_is_of_its_step() {
    let results = TempDir::new().unwrap();
    let folder = bounded(results.path());
    let line = |step: u64, episodes: u64| {
        format!(
            "{{\"eval_index\":1,\"step\":{step},\"critic_loss\":null,\"actor_loss\":null,\"mean_q\":null,\
             \"critic_gradient_norm\":null,\"actor_gradient_norm\":null,\"replay_episodes\":{episodes},\
             \"replay_transitions\":1000}}\n"
        )
    };
    let taught = |step: u64| {
        format!("{{\"eval_index\":1,\"step\":{step},\"goals\":[],\"successes\":[],\"weights\":null}}\n")
    };
    for (step, episodes, expected) in [
        (1_000, 20, None),
        (1_001, 20, Some("step is 1001, line ignored; expected the step of the same evaluation")),
        (1_000, u64::MAX, Some("expected at most one for every training step")),
    ] {
        fs::write(folder.join(STUDENT), line(step, episodes)).unwrap();
        fs::write(folder.join(TEACHING), taught(step)).unwrap();
        seal(&folder);
        let store = Store::read(results.path()).unwrap();
        let (learned, problems) = learning(results.path(), &store.runs()[0]);
        assert_eq!((learned.len(), problems.len()), if expected.is_none() { (1, 0) } else { (0, 1) });
        assert!(problems.iter().all(|problem| problem.to_string().ends_with(expected.unwrap())));
        let (taught, problems) = teaching(results.path(), &store.runs()[0]);
        assert_eq!((taught.len(), problems.len()), if step == 1_000 { (1, 0) } else { (0, 1) });
    }
}
