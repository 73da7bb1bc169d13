//! The store reads all that is sound and names all that is not.

use std::fs;
use std::path::Path;

use super::support::{key, line, options, record, seal, write_run};
use reports::schema::{Crash, Outcome, Record};
use reports::store::layout::{self, CRASHES, MANIFEST, OUTCOME, RECORDS, TIMING};
use reports::store::{Results, RunFolder, Store, StoreError};
use tempfile::TempDir;

/// A results folder with the four evaluations of one run, after `damage` was done to the folder of the run.
/// Gives the problems as text and the indices of the evaluations that are left.
fn damaged(damage: impl FnOnce(&Path)) -> (Vec<String>, Vec<u64>) {
    let results = TempDir::new().unwrap();
    let folder = write_run(results.path(), &key("E", "nova", "default", 0), &[0.0, 0.25, 0.5, 1.0]);
    damage(&folder);
    // As if it had ended like this; what is altered after the end is another matter.
    if folder.join(MANIFEST).exists() {
        seal(&folder);
    }
    let store = Store::read(results.path()).unwrap();
    let problems = store.problems().iter().map(ToString::to_string).collect();
    let left = store.runs().iter().flat_map(|run| &run.records).map(|record| record.eval_index).collect();
    (problems, left)
}

/// Rewrites the records file.
fn edit(folder: &Path, change: impl FnOnce(Vec<String>) -> Vec<String>) {
    let path = folder.join(RECORDS);
    let lines = fs::read_to_string(&path).unwrap().lines().map(|text| format!("{text}\n")).collect();
    fs::write(&path, change(lines).concat()).unwrap();
}

const FOLDER: &str = "runs/E/nova/default/seed-0";

#[test]
fn sound_results_have_no_problems() {
    let (problems, left) = damaged(|_| {});
    assert_eq!(problems, [""; 0]);
    assert_eq!(left, [0, 1, 2, 3]);
}

#[test]
fn a_damaged_line_is_named_and_the_others_are_kept() {
    let (problems, left) = damaged(|folder| {
        edit(folder, |mut lines| {
            lines[1] = "{\"environment\": \"E\", oops}\n".into();
            lines
        });
    });
    assert_eq!(problems.len(), 2);
    assert!(problems[0].starts_with(&format!("{FOLDER}/records.jsonl:2: not a valid evaluation, ignored: ")));
    assert!(problems[0].ends_with("at column 22"), "{}", problems[0]);
    assert_eq!(problems[1], format!("{FOLDER}/records.jsonl:3: evaluation 1 is missing"));
    assert_eq!(left, [0, 2, 3]);
}

#[test]
fn fields_that_the_schema_does_not_know_are_refused() {
    let (problems, left) = damaged(|folder| {
        edit(folder, |mut lines| {
            lines[3] = lines[3].replace("\"step\"", "\"steps\"");
            lines
        });
    });
    assert_eq!(problems.len(), 1);
    assert!(
        problems[0].contains("records.jsonl:4") && problems[0].contains("unknown field `steps`"),
        "{problems:?}"
    );
    assert_eq!(left, [0, 1, 2]);
}

#[test]
fn bytes_that_are_not_utf8_are_named() {
    let (problems, left) = damaged(|folder| {
        let mut bytes = fs::read(folder.join(RECORDS)).unwrap();
        bytes[20] = 0xff;
        fs::write(folder.join(RECORDS), bytes).unwrap();
    });
    assert!(problems[0].contains("records.jsonl:1: not a valid evaluation"), "{problems:?}");
    assert_eq!(left, [1, 2, 3]);
}

#[test]
fn an_incomplete_last_line_is_named_even_if_it_parses() {
    let (problems, left) = damaged(|folder| {
        fs::remove_file(folder.join(OUTCOME)).unwrap();
        edit(folder, |mut lines| {
            lines[3] = lines[3].trim_end().into();
            lines
        });
    });
    assert_eq!(problems.len(), 1);
    assert!(problems[0].starts_with(&format!("{FOLDER}/records.jsonl:4: incomplete last line (")));
    assert_eq!(left, [0, 1, 2]);
}

#[test]
fn an_evaluation_of_another_run_is_foreign() {
    let (problems, left) = damaged(|folder| {
        edit(folder, |mut lines| {
            lines[2] = lines[2].replace("\"seed\":0", "\"seed\":5");
            lines
        });
    });
    let expected = "records.jsonl:3: evaluation of E/nova/default/seed-5, ignored; the manifest here says \
                    E/nova/default/seed-0";
    assert!(problems[0].ends_with(expected), "{problems:?}");
    assert_eq!(left, [0, 1, 3]);
}

#[test]
fn an_evaluation_that_comes_twice_counts_once() {
    let (problems, left) = damaged(|folder| {
        edit(folder, |mut lines| {
            lines.insert(2, line(&record(&key("E", "nova", "default", 0), 1, 0.75)));
            lines
        });
    });
    assert_eq!(problems, [format!("{FOLDER}/records.jsonl:3: evaluation 1 again, ignored; line 2 has it")]);
    assert_eq!(left, [0, 1, 2, 3]);
}

#[test]
fn numbers_outside_their_range_are_named() {
    for (from, to, expected) in [
        (
            "\"success_rate\":0.5",
            "\"success_rate\":1.5",
            "success_rate is 1.5, line ignored; expected a number in [0, 1]",
        ),
        (
            "\"success_rate\":0.5",
            "\"success_rate\":0.51",
            "success_rate is 0.51 of 20 episodes, line ignored; expected a whole number of successes",
        ),
        (
            "\"any_success_rate\":0.55",
            "\"any_success_rate\":-0.05",
            "any_success_rate is -0.05, line ignored; expected a number in [0, 1]",
        ),
        (
            "\"any_success_rate\":0.55",
            "\"any_success_rate\":0.56",
            "any_success_rate is 0.56 of 20 episodes, line ignored; expected a whole number of successes",
        ),
        (
            "\"any_success_rate\":0.55",
            "\"any_success_rate\":0.45",
            "any_success_rate is 0.45, line ignored; expected at least success_rate",
        ),
        ("\"episodes\":20", "\"episodes\":0", "episodes is 0, line ignored; expected at least 1"),
        (
            "\"mean_return\":-50.0",
            "\"mean_return\":3.0",
            "mean_return is 3, line ignored; expected a number of at most 0",
        ),
        ("\"entropy\":2", "\"entropy\":[]", "teacher.entropy is [], line ignored; expected a number or null"),
    ] {
        let (problems, left) = damaged(|folder| {
            edit(folder, |mut lines| {
                assert!(lines[2].contains(from));
                lines[2] = lines[2].replace(from, to);
                lines
            });
        });
        assert_eq!(problems[0], format!("{FOLDER}/records.jsonl:3: {expected}"));
        assert_eq!(left, [0, 1, 3]);
    }
}

#[test]
fn steps_must_grow() {
    let (problems, left) = damaged(|folder| {
        edit(folder, |mut lines| {
            lines[2] = lines[2].replace("\"step\":2000", "\"step\":1000");
            lines
        });
    });
    let expected =
        "records.jsonl:3: evaluation 2 at step 1000, ignored; the evaluation before it is at step 1000";
    assert_eq!(problems, [format!("{FOLDER}/{expected}")]);
    assert_eq!(left, [0, 1, 3]);
}

#[test]
fn manifests_are_checked() {
    let manifest = |from: &'static str, to: &'static str| {
        move |folder: &Path| {
            let path = folder.join(MANIFEST);
            let text = fs::read_to_string(&path).unwrap();
            assert!(text.contains(from));
            fs::write(path, text.replace(from, to)).unwrap();
        }
    };
    let (problems, left) = damaged(manifest("\"schema\":1", "\"schema\":99"));
    let expected = format!("{FOLDER}/manifest.json: schema 99, run ignored; this version reads schema 1");
    assert_eq!((problems, left), (vec![expected], vec![]));

    let (problems, left) = damaged(manifest("\"seed\":0", "\"seed\":4"));
    assert!(problems[0].contains("manifest of E/nova/default/seed-4, run ignored"), "{problems:?}");
    assert_eq!(left, [0; 0]);

    let (problems, _) = damaged(|folder| fs::remove_file(folder.join(MANIFEST)).unwrap());
    assert_eq!(problems, [format!("{FOLDER}: its manifest.json is missing, run left out")]);
}

#[test]
fn timings_and_outcomes_are_checked() {
    let (problems, left) = damaged(|folder| {
        fs::write(
            folder.join(TIMING),
            concat!(
                "{\"eval_index\":0,\"step\":0,\"wall_s\":-1.0,\"evaluation_s\":0.0}\n",
                "{\"eval_index\":1,\"step\":1000,\"wall_s\":2.0,\"evaluation_s\":0.0,\"teacher_s\":3.0}\n",
                // Files of old versions do not tell whose time it was.
                "{\"eval_index\":2,\"step\":2000,\"wall_s\":3.0,\"evaluation_s\":0.0}\n",
            ),
        )
        .unwrap();
        fs::write(folder.join(OUTCOME), line(&Outcome::Failed { step: 2_000, reason: "NaN in Q".into() }))
            .unwrap();
    });
    let expected = [
        "outcome.json: says that the run failed at step 2000, but the last evaluation is at step 3000; the evaluations are kept",
        "outcome.json: the run failed at step 2000, its evaluations are kept: NaN in Q",
        "timing.jsonl: evaluations 0 to 1 are missing",
        "timing.jsonl: evaluation 3 is missing",
        "timing.jsonl:1: wall_s is -1, line ignored; expected a number of at least 0",
        "timing.jsonl:2: teacher_s is 3, line ignored; expected a number in [0, wall_s]",
    ];
    assert_eq!(problems, expected.map(|text| format!("{FOLDER}/{text}")));
    assert_eq!(left, [0, 1, 2, 3]);
}

#[test]
fn a_crashed_worker_is_named_while_the_run_has_not_ended() {
    let crash = |folder: &Path| {
        let crash = Crash { attempt: 1, step: None, reason: "killed by signal 9".into() };
        fs::write(folder.join(CRASHES), line(&crash)).unwrap();
    };
    assert_eq!(damaged(crash).0, [""; 0]);
    let (problems, left) = damaged(|folder| {
        crash(folder);
        fs::remove_file(folder.join(OUTCOME)).unwrap();
    });
    let expected =
        "crashes.jsonl:1: worker crashed (attempt 1), the evaluations so far are kept: killed by signal 9";
    assert_eq!(problems, [format!("{FOLDER}/{expected}")]);
    assert_eq!(left, [0, 1, 2, 3]);
}

#[test]
fn files_that_belong_elsewhere_are_named() {
    let (problems, left) = damaged(|folder| {
        fs::write(folder.parent().unwrap().join("notes.txt"), "").unwrap();
    });
    let expected =
        "notes.txt: unexpected here, ignored; expected folders ENVIRONMENT/CURRICULUM/VARIANT/seed-N";
    assert_eq!(problems, [format!("runs/E/nova/default/{expected}")]);
    assert_eq!(left, [0, 1, 2, 3]);
}

#[test]
fn a_copy_of_a_run_is_no_run() {
    let copied = |folder: &Path| {
        let copy = folder.with_file_name("seed-0 (copy)");
        fs::create_dir(&copy).unwrap();
        for name in [MANIFEST, RECORDS] {
            fs::copy(folder.join(name), copy.join(name)).unwrap();
        }
        let runs = Results::new(folder.ancestors().nth(5).unwrap()).survey().unwrap().runs;
        assert_eq!(runs, [RunFolder::new(folder)]);
    };
    let (problems, left) = damaged(copied);
    let expected = "unexpected here, ignored; expected folders ENVIRONMENT/CURRICULUM/VARIANT/seed-N";
    assert_eq!(problems, [format!("{FOLDER} (copy): {expected}")]);
    assert_eq!(left, [0, 1, 2, 3]);
}

#[test]
fn a_strict_reader_is_told_the_first_line_that_is_wrong() {
    let (_, _) = damaged(|folder| {
        let run = RunFolder::new(folder);
        assert_eq!(run.records().unwrap().len(), 4);
        assert_eq!(run.last::<Record>().unwrap().eval_index, 3);
        edit(folder, |mut lines| {
            lines[2] = "{}\n".into();
            lines[3] = lines[3].trim_end().into();
            lines
        });
        let error = run.records().unwrap_err();
        assert!(error.to_string().ends_with("records.jsonl:3: not a valid evaluation"), "{error}");
        let source = std::error::Error::source(&error).unwrap().to_string();
        assert!(source.contains("missing field `environment`"), "{source}");
        assert_eq!(run.last::<Record>(), None, "the last complete line cannot be read");
        fs::remove_file(folder.join(RECORDS)).unwrap();
        assert_eq!(run.records().unwrap(), [], "nothing is recorded yet");
    });
}

#[test]
fn a_crash_counts_until_an_evaluation_beyond_it_is_recorded() {
    let (_, _) = damaged(|folder| {
        let run = RunFolder::new(folder);
        run.note_crash(0, "killed").unwrap();
        let step = Some(3_000);
        assert_eq!(run.last_crash(), Some(Crash { attempt: 0, step, reason: "killed".into() }));
        edit(folder, |mut lines| {
            lines.push(line(&record(&key("E", "teach", "default", 0), 4, 1.0)));
            lines
        });
        assert_eq!(run.last_crash(), None);
        // Of a version that noted no step.
        fs::write(folder.join(CRASHES), "{\"attempt\":0,\"reason\":\"killed\"}\n").unwrap();
        assert_eq!(run.last_crash().unwrap().step, None);
    });
}

#[test]
fn a_run_that_is_not_configured_as_its_cell_is_left_out_and_named() {
    for ended in [true, false] {
        let results = TempDir::new().unwrap();
        for seed in [0, 2] {
            write_run(results.path(), &key("E", "nova", "default", seed), &[0.0]);
        }
        let folder = write_run(results.path(), &key("E", "nova", "default", 1), &[0.0]);
        let path = folder.join(MANIFEST);
        fs::write(&path, fs::read_to_string(&path).unwrap().replace("256", "512")).unwrap();
        seal(&folder);
        if !ended {
            fs::remove_file(folder.join(OUTCOME)).unwrap();
        }
        let store = Store::read(results.path()).unwrap();
        let problems: Vec<String> = store.problems().iter().map(ToString::to_string).collect();
        let expected = "config differs from E/nova/default/seed-0 at `/agent/width`, run left out: \
                        seeds of one cell differ in nothing else";
        assert_eq!(problems, [format!("runs/E/nova/default/seed-1/manifest.json: {expected}")]);
        let seeds: Vec<u64> = store.runs().iter().map(|run| run.key().seed).collect();
        assert_eq!(seeds, [0, 2], "no mean is taken over both configs");
    }
}

#[test]
fn a_run_without_records_yet_is_a_run() {
    let (problems, left) = damaged(|folder| {
        for file in [RECORDS, TIMING, OUTCOME] {
            fs::remove_file(folder.join(file)).unwrap();
        }
    });
    assert_eq!((problems, left), (vec![], vec![]));
}

#[test]
fn other_folders_are_refused_with_what_was_expected() {
    let empty = TempDir::new().unwrap();
    let missing = empty.path().join("nothing");
    let error = Store::read(&missing).unwrap_err().to_string();
    assert!(error.ends_with("nothing: cannot find this folder"), "{error}");
    let error = Store::read(empty.path()).unwrap_err();
    assert!(
        error.to_string().contains("runs/ENVIRONMENT/CURRICULUM/VARIANT/seed-N/manifest.json"),
        "{error}"
    );
    fs::create_dir(layout::runs_dir(empty.path())).unwrap();
    assert!(matches!(Store::read(empty.path()), Err(StoreError::NotResults { .. })));
}

#[test]
fn records_older_than_success_at_any_step_are_read() {
    let results = TempDir::new().unwrap();
    write_run(results.path(), &key("E", "nova", "default", 1), &[0.0, 0.5]);
    let folder = write_run(results.path(), &key("E", "nova", "default", 0), &[0.0, 0.5]);
    edit(&folder, |lines| {
        let old = |line: String| {
            let (before, after) = line.split_once("\"any_success_rate\":").unwrap();
            before.to_owned() + after.split_once(',').unwrap().1
        };
        lines.into_iter().map(old).collect()
    });
    seal(&folder);
    let store = Store::read(results.path()).unwrap();
    assert_eq!(store.problems(), []);
    let rates = store.runs()[0].records.iter().map(|record| record.any_success_rate);
    assert_eq!(rates.collect::<Vec<_>>(), [None, None]);
    let missing = reports::write(results.path(), &options()).unwrap().missing;
    let expected = "success at any step: 1 of 2 runs without a record of it (older than the field)";
    assert!(missing.iter().any(|text| text == expected), "{missing:#?}");
    let csv = fs::read_to_string(layout::report_dir(results.path()).join("summary.csv")).unwrap();
    let at_any_step = csv.lines().map(|line| line.split(',').nth(10).unwrap()).collect::<Vec<_>>();
    assert_eq!(at_any_step, ["final_any_mean", ""], "no mean without a seed");
}
