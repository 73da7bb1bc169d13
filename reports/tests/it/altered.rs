//! Runs that are not what they were when they ended.

use std::fs;
use std::path::Path;

use super::support::{key, seal, write_run};
use reports::store::Store;
use reports::store::layout::{CHECKSUMS, MANIFEST, RECORDS, TEACHING};
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
