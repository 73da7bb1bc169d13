//! `goalbench pack` and `goalbench report --with`: results as a unit.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]

mod hostile;
#[path = "../support/mod.rs"]
mod support;
mod unpacked;

use std::collections::BTreeMap;
use std::fs;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};
use support::{TOY, goalbench, refused, stderr, stdout};

const ROOT: &str = "goalbench-results";

fn text(path: &Path) -> &str {
    path.to_str().expect("a test path is UTF-8")
}

fn works(args: &[&str]) -> String {
    let output = goalbench(args);
    assert!(output.status.success(), "{args:?}: {}", stderr(&output));
    stdout(&output)
}

/// Trains the toy protocol's students by these `curricula` into `out`; lists given twice would add up.
fn trained(out: &Path, curricula: &str, more: &[&str]) {
    trained_in("Point", out, curricula, more);
}

fn trained_in(environment: &str, out: &Path, curricula: &str, more: &[&str]) {
    let replaced = TOY.iter().map(|&arg| match arg {
        "Point" => environment,
        "teach,her-iid" => curricula,
        other => other,
    });
    let args: Vec<&str> =
        replaced.chain(["--out", text(out), "--quiet"]).chain(more.iter().copied()).collect();
    works(&args);
}

/// The files of an archive by name.
fn files(archive: &Path) -> BTreeMap<String, Vec<u8>> {
    let bytes = zstd::decode_all(fs::File::open(archive).expect("an archive")).expect("zstd");
    let mut files = BTreeMap::new();
    for entry in tar::Archive::new(bytes.as_slice()).entries().expect("tar") {
        let mut entry = entry.expect("an entry");
        let header = entry.header();
        assert_eq!((header.mtime().ok(), header.uid().ok(), header.gid().ok()), (Some(0), Some(0), Some(0)));
        let name = entry.path().expect("a name").display().to_string();
        let mut content = Vec::new();
        entry.read_to_end(&mut content).expect("its content");
        files.insert(name.strip_prefix(&format!("{ROOT}/")).expect("one folder").to_owned(), content);
    }
    files
}

fn hex(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The rows of a CSV file of a report, by name of column.
fn rows(results: &Path, name: &str) -> Vec<BTreeMap<String, String>> {
    let text = fs::read_to_string(results.join("report").join(name)).expect("a file of the report");
    let mut lines = text.lines();
    let columns: Vec<&str> = lines.next().expect("a head").split(',').collect();
    let row = |line: &str| {
        columns.iter().map(|name| (*name).to_owned()).zip(line.split(',').map(str::to_owned)).collect()
    };
    lines.map(row).collect()
}

#[test]
fn an_archive_holds_the_results_and_the_same_results_give_the_same_bytes() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let results = folder.path().join("results");
    trained(&results, "teach,her-iid", &[]);
    let [one, two] = ["new/one.tar.zst", "two.tar.zst"].map(|name| folder.path().join(name));
    let said =
        works(&["pack", text(&results), "--out", text(&one), "--title", "Toys", "--licence", "CC0-1.0"]);
    let bytes = fs::read(&one).expect("an archive");
    assert!(said.contains("4 runs, 2 policies") && said.contains(&hex(&bytes)), "{said}");
    // Times, owners and what reports leave behind do not matter.
    works(&["report", text(&results)]);
    works(&["pack", text(&results), "--out", text(&two), "--title", "Toys", "--licence", "CC0-1.0"]);
    assert!(bytes == fs::read(&two).expect("an archive"));

    let files = files(&one);
    let sums = String::from_utf8(files["SHA256SUMS"].clone()).expect("text");
    let listed: BTreeMap<&str, &str> = sums
        .lines()
        .map(|line| line.split_once("  ").expect("two columns"))
        .map(|(sum, name)| (name, sum))
        .collect();
    assert_eq!(listed.len() + 1, files.len());
    for (name, content) in files.iter().filter(|(name, _)| *name != "SHA256SUMS") {
        assert_eq!(listed[name.as_str()], hex(content), "{name}");
    }
    for curriculum in ["teach", "her-iid"] {
        for seed in [0, 1] {
            let run = format!("runs/Point/{curriculum}/default/seed-{seed}");
            for name in ["manifest.json", "records.jsonl", "outcome.json", "checksums.json", "teaching.jsonl"]
            {
                let there = fs::read(results.join(&run).join(name)).expect("a file of the run");
                assert!(files[&format!("{run}/{name}")] == there, "{run}/{name}");
            }
            let has_policy = files
                .contains_key(&format!("policies/Point/{curriculum}/default/seed-{seed}/policy.safetensors"));
            assert_eq!(has_policy, seed == 0, "of the first seed");
        }
    }
    assert!(
        files
            .keys()
            .all(|name| !name.contains("checkpoint") && !name.contains("replay/") && !name.contains(".log"))
    );
    assert!(files["records.parquet"].starts_with(b"PAR1") && files["runs.parquet"].starts_with(b"PAR1"));
    let card = String::from_utf8(files["DATA.md"].clone()).expect("text");
    let head = "---\nlicense: \"cc0-1.0\"\npretty_name: \"Toys\"\n";
    assert!(card.starts_with(head), "{card}");
    for expected in [
        "# Toys",
        "20 evaluations of 4 runs",
        "| Point | teach | default | 0, 1 | 0 | 400 |",
        "- mujoco 3.3.7",
        "## records.parquet: one row per evaluation",
        "`success\\_rate`",
        "Licence: CC0-1.0",
    ] {
        let plain = expected.replace("\\_", "_");
        assert!(card.contains(expected) || card.contains(&plain), "{expected} in\n{card}");
    }
}

#[test]
fn the_policies_are_those_that_were_asked_for() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (results, out) = (folder.path().join("results"), folder.path().join("a.tar.zst"));
    trained(&results, "teach", &[]);
    let seeds = |which: &str| -> Vec<bool> {
        works(&["pack", text(&results), "--out", text(&out), "--policies", which]);
        let files = files(&out);
        let has = |seed| files.contains_key(&format!("policies/Point/teach/default/seed-{seed}/policy.json"));
        [0, 1].map(has).to_vec()
    };
    assert_eq!(seeds("first"), [true, false]);
    assert_eq!(seeds("all"), [true, true]);
    assert_eq!(seeds("none"), [false, false]);
    assert_eq!(seeds("1"), [false, true]);
    let exported = folder.path().join("policy");
    works(&["export", text(&results.join("runs/Point/teach/default/seed-1")), "--out", text(&exported)]);
    let packed = &files(&out)["policies/Point/teach/default/seed-1/policy.safetensors"];
    assert!(
        *packed == fs::read(exported.join("policy.safetensors")).expect("a file"),
        "the same as export's"
    );
}

#[test]
fn results_that_are_not_whole_are_refused_and_nothing_is_written() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let results = folder.path().join("results");
    trained(&results, "teach", &[]);
    let out = folder.path().join("a.tar.zst");
    let pack = |more: &[&str], expected: &[&str]| {
        refused(&[&["pack", text(&results), "--out", text(&out)], more].concat(), expected);
        assert!(!out.exists());
    };
    pack(&["--policies", "0,7"], &["no run with seed 7 has finished"]);
    pack(&["--policies", "some"], &["--policies", "first, all, none or seeds"]);
    pack(&["--licence", "my own"], &["--licence", "SPDX"]);
    refused(&["pack", text(&results), "--out", "a.zip"], &["--out", ".tar.zst"]);
    for name in [".tar.zst", "a@b.tar.zst", &format!("{}.tar.zst", "a".repeat(41))] {
        refused(
            &["pack", text(&results), "--out", text(&folder.path().join(name))],
            &["--out", "NAME.tar.zst"],
        );
    }
    for place in ["runs/a.tar.zst", "runs/Point/teach/default/seed-0/a.tar.zst", "protocols/a.tar.zst"] {
        refused(
            &["pack", text(&results), "--out", text(&results.join(place))],
            &["--out", "name a place outside"],
        );
        assert!(!results.join(place).exists());
    }
    refused(&["pack", "/nowhere", "--out", text(&out)], &["/nowhere"]);
    fs::create_dir(folder.path().join("d.tar.zst")).expect("a folder");
    refused(
        &["pack", text(&results), "--out", text(&folder.path().join("d.tar.zst"))],
        &["--out", "is a folder"],
    );
    let run = results.join("runs/Point/teach/default/seed-1");
    let outcome = fs::read(run.join("outcome.json")).expect("an outcome");
    fs::remove_file(run.join("outcome.json")).expect("it can be removed");
    pack(&[], &["have not ended", "Point/teach/default/seed-1"]);
    fs::write(run.join("outcome.json"), outcome).expect("it can be written");
    let records = fs::read_to_string(run.join("records.jsonl")).expect("records");
    fs::write(run.join("records.jsonl"), records.replace("\"episodes\":5", "\"episodes\":6"))
        .expect("it can be written");
    pack(&[], &["must be set right first", "seed-1", "altered"]);
    let left = fs::read_dir(folder.path()).expect("a folder").count();
    assert_eq!(left, 2, "the results and the folder of this test");
}

#[test]
fn an_archive_is_drawn_beside_ones_own_runs_and_paired_with_them() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (theirs, own) = (folder.path().join("theirs"), folder.path().join("own"));
    trained(&theirs, "teach,her-iid", &["--seeds", "0..3"]);
    trained(&own, "her-iid,procurl", &["--seeds", "0..3"]);
    works(&["report", text(&own)]);
    let alone = ["ledger.csv", "variants.csv", "summary.csv"].map(|name| rows(&own, name));
    let archive = folder.path().join("lab.tar.zst");
    works(&["pack", text(&theirs), "--out", text(&archive)]);
    let sum = hex(&fs::read(&archive).expect("an archive"));
    let output = goalbench(&["report", text(&own), "--with", text(&archive)]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(!stderr(&output).contains("[lab]"), "archives owe these results nothing: {}", stderr(&output));
    let summary = fs::read_to_string(own.join("report/summary.md")).expect("a summary");
    for expected in ["6 runs of the 6 runs in lab", &sum, "TEACH"] {
        assert!(summary.contains(expected), "{expected} in\n{summary}");
    }
    let records = rows(&own, "records.csv");
    let of = |id: &str| records.iter().filter(|row| row["curriculum"] == id).count();
    assert_eq!((of("teach@lab"), of("her-iid@lab"), of("her-iid"), of("teach")), (15, 15, 15, 0));
    let comparisons = rows(&own, "comparisons.csv");
    let guests: Vec<_> = comparisons.iter().filter(|row| row["curriculum"].ends_with("@lab")).collect();
    assert_eq!(guests.len(), 2, "{comparisons:?}");
    assert!(guests.iter().all(|row| row["n_pairs"] == "3" && !row["reference_curriculum"].contains('@')));
    // HER-IID here and there are the same runs, pair by pair.
    let same = guests.iter().find(|row| row["curriculum"] == "her-iid@lab").expect("a comparison");
    if same["reference_curriculum"] == "her-iid" {
        assert_eq!(same["difference"].parse::<f64>(), Ok(0.0));
    }
    let own_rows = |name: &str| -> Vec<_> {
        rows(&own, name)
            .into_iter()
            .filter(|row| !row.get("curriculum").is_some_and(|id| id.contains('@')))
            .collect()
    };
    assert_eq!(
        alone,
        ["ledger.csv", "variants.csv", "summary.csv"].map(own_rows),
        "no guest changes a verdict"
    );
}

#[test]
fn runs_that_were_made_otherwise_are_drawn_and_not_paired() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (theirs, own) = (folder.path().join("theirs"), folder.path().join("own"));
    trained(&theirs, "teach", &["--seeds", "0..3", "--set", "student.width=8"]);
    trained(&own, "her-iid", &["--seeds", "0..3"]);
    let archive = folder.path().join("wide lab.tar.zst");
    works(&["pack", text(&theirs), "--out", text(&archive)]);
    let output = goalbench(&["report", text(&own), "--with", text(&archive)]);
    assert!(output.status.success(), "{}", stderr(&output));
    let reason = "are not paired: their configs differ at /student/width";
    assert!(stderr(&output).contains(reason), "{}", stderr(&output));
    let comparisons = rows(&own, "comparisons.csv");
    let row = comparisons.iter().find(|row| row["curriculum"] == "teach@wide lab").expect("it is compared");
    assert_eq!(
        (row["n_pairs"].as_str(), row["difference"].as_str(), row["n_seeds"].as_str()),
        ("0", "", "3")
    );
    assert_eq!(row["area_difference"], "");
    assert!(row["note"].contains("their configs differ at /student/width"), "{row:?}");
}

#[test]
fn archives_that_cannot_stand_beside_the_results_are_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let [own, theirs] = ["own", "theirs"].map(|name| folder.path().join(name));
    trained(&own, "teach", &["--seeds", "0"]);
    trained_in("MazeA", &theirs, "teach", &["--seeds", "0"]);
    let archive = |results: &PathBuf, name: &str| {
        let path = folder.path().join(name);
        works(&["pack", text(results), "--out", text(&path), "--policies", "none"]);
        path
    };
    let (maze, one) = (archive(&theirs, "maze.tar.zst"), archive(&own, "one.tar.zst"));
    refused(
        &["report", text(&own), "--with", text(&maze)],
        &["maze: it has no evaluation to set beside", "Point"],
    );
    fs::create_dir(folder.path().join("other")).expect("a folder");
    let twin = archive(&own, "other/one.tar.zst");
    refused(
        &["report", text(&own), "--with", text(&one), "--with", text(&twin)],
        &["one: two archives have this name"],
    );
    for wrong in ["one.tar", "a@b.tar.zst", ".tar.zst"] {
        refused(&["report", text(&own), "--with", wrong], &["--with", "is not called NAME.tar.zst"]);
    }
    refused(&["report", text(&own), "--with", "/nowhere/x.tar.zst"], &["--with", "/nowhere/x.tar.zst"]);
    assert!(!own.join("report").exists());
}

#[test]
fn runs_that_failed_are_results_like_any_others() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let at = |name: &str| folder.path().join(name);
    let (results, packed, unpacked) = (at("results"), at("packed.tar.zst"), at("unpacked"));
    trained(&results, "her-iid", &[]);
    // Learning rates beyond all reason: the student diverges.
    let wild = ["--set", "student.actor_lr=1e30", "--set", "student.critic_lr=1e30"];
    let toy = TOY.iter().map(|&arg| if arg == "teach,her-iid" { "space" } else { arg });
    let args: Vec<&str> = toy.chain(["--out", text(&results), "--quiet"]).chain(wild).collect();
    assert_eq!(goalbench(&args).status.code(), Some(1), "they fail");
    let said = works(&["pack", text(&results), "--out", text(&packed)]);
    assert!(said.contains("4 runs, 1 policy"), "failed runs have no policy that is worth packing: {said}");
    works(&["unpack", text(&packed), "--out", text(&unpacked)]);
    let failed = |results: &Path| {
        let output = goalbench(&["status", text(results)]);
        String::from_utf8_lossy(&output.stdout).contains("2 failed")
    };
    assert!(failed(&results) && failed(&unpacked));
    let elsewhere = at("elsewhere");
    trained(&elsewhere, "teach", &[]);
    let output = goalbench(&["report", text(&elsewhere), "--with", text(&packed), "--quiet"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(elsewhere.join("report/index.html").is_file(), "{said}");
}
