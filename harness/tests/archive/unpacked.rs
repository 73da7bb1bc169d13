//! `goalbench unpack`: from an archive back to results.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use crate::support::refused;
use crate::{files, hex, text, trained, works};

/// Unpacked, results are drawn as they were; without what teachers did, all but the maps of that.
#[test]
fn unpacked_results_give_the_same_report() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let at = |name: &str| folder.path().join(name);
    let results = at("results");
    trained(&results, "teach,her-iid", &[]);
    works(&["report", text(&results), "--title", "Toys"]);
    let drawn = |results: &Path| -> BTreeMap<String, Vec<u8>> {
        let files = fs::read_dir(results.join("report")).expect("a report").flatten();
        let files = files.filter(|entry| entry.path().is_file());
        files
            .map(|file| (file.file_name().display().to_string(), fs::read(file.path()).expect("a file")))
            .collect()
    };
    let before = drawn(&results);

    let whole = at("whole.tar.zst");
    works(&["pack", text(&results), "--out", text(&whole)]);
    let said = works(&["unpack", text(&whole), "--out", text(&at("whole"))]);
    assert!(said.contains("4 runs") && said.contains(&hex(&fs::read(&whole).expect("an archive"))), "{said}");
    for (name, bytes) in files(&whole) {
        assert!(fs::read(at("whole").join(&name)).expect("every file of the archive") == bytes, "{name}");
    }
    works(&["report", text(&at("whole")), "--title", "Toys"]);
    let after = drawn(&at("whole"));
    assert_eq!(before.keys().collect::<Vec<_>>(), after.keys().collect::<Vec<_>>());
    for name in ["records.csv", "summary.csv", "ledger.csv", "teaching.csv"] {
        assert!(before.get(name).is_some_and(|bytes| after[name] == *bytes), "{name}");
    }

    let small = at("small.tar.zst");
    works(&["pack", text(&results), "--out", text(&small), "--without", "teaching,student"]);
    let less = files(&small);
    assert!(!less.keys().any(|name| name.contains("teaching.jsonl") || name.contains("student.jsonl")));
    let card = String::from_utf8(less["DATA.md"].clone()).expect("text");
    assert!(card.contains("left out of every run: `student.jsonl`, `teaching.jsonl`"), "{card}");
    let same = at("same.tar.zst");
    works(&["pack", text(&results), "--out", text(&same), "--without", "student,teaching,student"]);
    assert!(fs::read(&same).expect("an archive") == fs::read(&small).expect("an archive"));
    // What a killed unpack has left goes with the next one.
    let left = at(".goalbench-unpack-0123456789ab");
    fs::remove_dir_all(at("whole").join("report")).expect("it can be removed");
    fs::rename(at("whole"), &left).expect("it can be renamed");
    works(&["unpack", text(&small), "--out", text(&at("small"))]);
    assert!(!left.exists());
    works(&["report", text(&at("small")), "--title", "Toys"]);
    let after = drawn(&at("small"));
    for name in ["records.csv", "summary.csv", "ledger.csv", "teaching.csv"] {
        assert!(after.get(name).is_some_and(|bytes| before[name] == *bytes), "{name}");
    }
}

/// Whoever is given an archive can give it on, with the policies and with further runs.
#[test]
fn unpacked_results_are_packed_again_with_their_policies() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let at = |name: &str| folder.path().join(name);
    trained(&at("results"), "teach,her-iid", &[]);
    let [first, second] = ["first.tar.zst", "second.tar.zst"].map(at);
    works(&["pack", text(&at("results")), "--out", text(&first)]);
    works(&["unpack", text(&first), "--out", text(&at("unpacked"))]);
    works(&["pack", text(&at("unpacked")), "--out", text(&second)]);
    assert!(fs::read(&first).expect("an archive") == fs::read(&second).expect("an archive"));

    let policy = |seed| format!("policies/Point/teach/default/seed-{seed}/policy.safetensors");
    trained(&at("unpacked"), "teach,her-iid", &["--seeds", "2"]);
    works(&["pack", text(&at("unpacked")), "--out", text(&second), "--policies", "0,2"]);
    let more = files(&second);
    assert!(more[&policy(0)] == files(&first)[&policy(0)] && more.contains_key(&policy(2)));
    assert_eq!(more.keys().filter(|name| name.ends_with("manifest.json")).count(), 6);

    let pack = ["pack", text(&at("unpacked")), "--out", text(&at("third.tar.zst"))].map(str::to_owned);
    let pack = pack.each_ref().map(String::as_str);
    refused(&[&pack[..], &["--policies", "1"]].concat(), &["seed-1", "checkpoint.bin", "is missing"]);
    let altered = at("unpacked").join(policy(0));
    let mut bytes = fs::read(&altered).expect("a policy");
    *bytes.last_mut().expect("numbers") ^= 1;
    fs::write(&altered, bytes).expect("it can be written");
    refused(&pack, &["policies/Point/teach/default/seed-0", "not the policy of the run", "unpack"]);
    fs::remove_file(&altered).expect("it can be removed");
    refused(&pack, &["policy.safetensors", "cannot read this file"]);
    assert!(!at("third.tar.zst").exists());
}

/// Nor does a merge with somebody else's runs lose them.
#[test]
fn merged_results_keep_the_policies_that_came_with_an_archive() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let at = |name: &str| folder.path().join(name);
    trained(&at("lab"), "teach", &[]);
    trained(&at("own"), "her-iid", &[]);
    let [first, second] = ["first.tar.zst", "second.tar.zst"].map(at);
    works(&["pack", text(&at("lab")), "--out", text(&first)]);
    works(&["unpack", text(&first), "--out", text(&at("unpacked"))]);
    let (unpacked, own, out) = (at("unpacked"), at("own"), at("merged"));
    let merge = ["merge", text(&unpacked), text(&own), "--out", text(&out)];
    works(&merge);
    works(&["pack", text(&out), "--out", text(&second)]);
    let run = "policies/Point/teach/default/seed-0";
    for name in ["policy.json", "policy.safetensors"].map(|name| format!("{run}/{name}")) {
        assert!(files(&second)[&name] == files(&first)[&name], "{name}");
    }
    assert!(files(&second).contains_key("policies/Point/her-iid/default/seed-0/policy.safetensors"));

    // One that was altered is no policy.
    fs::remove_dir_all(&out).expect("it can be removed");
    let numbers = unpacked.join(run).join("policy.safetensors");
    let good = fs::read(&numbers).expect("a policy");
    let mut altered = good.clone();
    *altered.last_mut().expect("numbers") ^= 1;
    fs::write(&numbers, &altered).expect("it can be written");
    refused(&merge, &[run, "not the policy of the run"]);
    // Another one, with its own checksum, contradicts that of the archive.
    let about = unpacked.join(run).join("policy.json");
    let known = fs::read_to_string(&about).expect("what it is");
    fs::write(&about, known.replace(&hex(&good), &hex(&altered))).expect("it can be written");
    let again = at("again");
    works(&["unpack", text(&first), "--out", text(&again)]);
    let both = ["merge", text(&unpacked), text(&again), "--out", text(&out)];
    refused(&both, &["Point/teach/default/seed-0", "different policies"]);
    assert!(!out.exists(), "nothing is written");
}

#[test]
fn what_cannot_be_unpacked_leaves_nothing_behind() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let at = |name: &str| folder.path().join(name);
    trained(&at("results"), "her-iid", &[]);
    let packed = at("packed.tar.zst");
    works(&["pack", text(&at("results")), "--out", text(&packed)]);
    let bytes = fs::read(&packed).expect("an archive");
    let cut = at("cut.tar.zst");
    fs::write(&cut, &bytes[..bytes.len() / 2]).expect("it can be written");
    let before = fs::read_dir(folder.path()).expect("a folder").count();
    refused(&["unpack", text(&cut), "--out", text(&at("new"))], &["cut.tar.zst", "cannot be read"]);
    refused(&["unpack", text(&packed), "--out", text(&at("results"))], &["--out", "results", "exists"]);
    refused(&["unpack", text(&at("none.tar.zst")), "--out", text(&at("new"))], &["none.tar.zst"]);
    refused(
        &["pack", text(&at("results")), "--out", text(&at("new.tar.zst")), "--without", "records"],
        &["--without", "teaching, student, frontier, shadow"],
    );
    assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), before);
}
