//! Set-up of a small part made for the test; a file copy takes pip's place.

use std::{
    io::Write,
    os::unix::fs::symlink,
    process::{self, Command},
};

use tempfile::{TempDir, tempdir};
use zip::{ZipWriter, write::SimpleFileOptions};

use super::*;
use crate::pins::{Addition, Take};

const WHEEL: &str = "w.whl";

/// A wheel on disk and a part that pins it.
struct Fixture {
    home: TempDir,
    part: Part,
}

impl Fixture {
    fn new() -> Self {
        Self::with_content("the library")
    }

    fn with_content(text: &str) -> Self {
        let home = tempdir().unwrap();
        let wheel = home.path().join(WHEEL);
        let mut zip = ZipWriter::new(File::create(&wheel).unwrap());
        zip.start_file("a/lib.so", SimpleFileOptions::default()).unwrap();
        zip.write_all(text.as_bytes()).unwrap();
        zip.finish().unwrap();
        fs::create_dir(home.path().join("native")).unwrap();
        let part = part(hash_file(&wheel).unwrap());
        Self { home, part }
    }

    fn native(&self) -> PathBuf {
        self.home.path().join("native")
    }

    fn bring(&self) -> Result<()> {
        bring(&self.part, &self.native(), |_, wheels, _| copy(&self.home.path().join(WHEEL), wheels))
    }

    fn state(&self, depth: Depth) -> State {
        inspect(&self.native().join("lib"), &self.part, depth)
    }

    fn text(&self) -> String {
        fs::read_to_string(self.native().join("lib/lib.so")).unwrap()
    }

    /// Names of everything directly below `.native`.
    fn entries(&self) -> Vec<String> {
        let entries = fs::read_dir(self.native()).unwrap();
        let mut names: Vec<_> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }
}

fn copy(wheel: &Path, wheels: &Path) -> Result<()> {
    fs::copy(wheel, wheels.join(WHEEL)).map(drop).map_err(doing("copy", wheel))
}

/// A part that pins the wheel with this hash. Pins are `'static`, so this one is leaked.
fn part(sha256: String) -> Part {
    let takes: &'static [Take] = &[Take { from: "a/", to: "" }];
    let wheel = Wheel { project: "w", version: "1", sha256: sha256.leak(), bytes: 1, takes };
    Part {
        name: "lib",
        title: "the library",
        wheels: vec![wheel].leak(),
        additions: &[Addition::Link { path: "lib.so.1", target: "lib.so" }],
        unpacked_bytes: 11,
        variable: "OWN_LIB",
        proof: "lib.so",
    }
}

#[test]
fn a_part_is_fetched_whole_and_found_intact() {
    let fixture = Fixture::new();
    assert_eq!(fixture.state(Depth::Sizes), State::Missing);
    fixture.bring().unwrap();
    assert_eq!(fixture.state(Depth::Hashes), State::Intact);
    assert_eq!(fixture.entries(), ["lib"], "nothing else is left");
    assert_eq!(fs::read_to_string(fixture.native().join("lib/lib.so.1")).unwrap(), "the library");
}

#[test]
fn damage_is_found_and_named() {
    let fixture = Fixture::new();
    fixture.bring().unwrap();
    let file = fixture.native().join("lib/lib.so");
    let damaged = |what: &str| State::Damaged(what.to_owned());

    fs::write(&file, "the l1brary").unwrap();
    assert_eq!(fixture.state(Depth::Sizes), State::Intact, "sizes alone do not tell");
    assert_eq!(fixture.state(Depth::Hashes), damaged("lib.so has changed"));
    fs::write(&file, "short").unwrap();
    assert_eq!(fixture.state(Depth::Sizes), damaged("lib.so has 5 bytes instead of 11"));
    fs::remove_file(&file).unwrap();
    assert_eq!(fixture.state(Depth::Sizes), damaged("lib.so is missing"));

    fixture.bring().unwrap();
    assert_eq!(fixture.state(Depth::Hashes), State::Intact, "fetched anew");
    let link = fixture.native().join("lib/lib.so.1");
    fs::remove_file(&link).unwrap();
    symlink("elsewhere", link).unwrap();
    assert_eq!(fixture.state(Depth::Sizes), damaged("lib.so.1 links to elsewhere instead of lib.so"));
    fs::write(fixture.native().join("lib/stamp.json"), "{").unwrap();
    assert!(
        matches!(fixture.state(Depth::Sizes), State::Damaged(what) if what.starts_with("stamp.json: EOF"))
    );
}

#[test]
fn a_part_of_other_pins_is_outdated() {
    let (old, new) = (Fixture::new(), Fixture::with_content("the next one"));
    old.bring().unwrap();
    let found = inspect(&old.native().join("lib"), &new.part, Depth::Sizes);
    assert_eq!(found, State::Outdated);
}

#[test]
fn a_wheel_that_is_not_the_pinned_one_changes_nothing() {
    let fixture = Fixture::new();
    fixture.bring().unwrap();
    fs::write(fixture.home.path().join(WHEEL), "another wheel").unwrap();
    let error = fixture.bring().unwrap_err();
    assert!(error.to_string().starts_with("pip did not bring the pinned wheel of w 1 (sha256 "), "{error}");
    assert_eq!(fixture.state(Depth::Hashes), State::Intact);
    assert_eq!(fixture.entries(), ["lib"]);
}

#[test]
fn a_failed_fetch_changes_nothing() {
    let fixture = Fixture::new();
    let fail = |_: &Part, _: &Path, _: &Path| Err(Error::Pip { reason: "of the test".to_owned() });
    assert!(bring(&fixture.part, &fixture.native(), fail).is_err());
    assert!(fixture.entries().is_empty());
}

#[test]
fn a_swap_that_fails_half_way_puts_the_old_part_back() {
    let home = tempdir().unwrap();
    let path = |name: &str| home.path().join(name);
    fs::write(path("old"), "old").unwrap();
    let error = swap(&path("never made"), &path("old"), &path("aside")).unwrap_err();
    assert!(error.to_string().starts_with("cannot put in place "), "{error}");
    assert_eq!(fs::read_to_string(path("old")).unwrap(), "old");
}

/// Names the folder of the process that is to be killed. If it is set, the test below is that process.
const KILLED: &str = "XTASK_TEST_KILLED_IN";

#[test]
fn killed_while_fetching_leaves_the_old_part_and_the_next_set_up_cleans_up() {
    if let Some(native) = env::var_os(KILLED) {
        let abort = |_: &Part, wheels: &Path, _: &Path| {
            fs::write(wheels.join("half.whl"), "half").unwrap();
            // Like a kill, this runs no destructor.
            process::abort()
        };
        bring(&part(String::new()), Path::new(&native), abort).unwrap();
    }
    let fixture = Fixture::new();
    fixture.bring().unwrap();
    let name = "setup::tests::killed_while_fetching_leaves_the_old_part_and_the_next_set_up_cleans_up";
    let mut child = Command::new(env::current_exe().unwrap());
    let output = child.args(["--exact", name]).env(KILLED, fixture.native()).output().unwrap();
    assert!(!output.status.success());
    assert_eq!(fixture.entries().len(), 2, "the part and what the killed process left");
    assert_eq!(fixture.state(Depth::Hashes), State::Intact);

    remove_leftovers(&fixture.native()).unwrap();
    assert_eq!(fixture.entries(), ["lib"]);
}

#[test]
fn killed_between_the_two_renames_leaves_no_part_and_the_next_set_up_brings_it() {
    let fixture = Fixture::new();
    fixture.bring().unwrap();
    let work = fixture.native().join("tmp-killed");
    fs::create_dir(&work).unwrap();
    // The first rename of `swap`, without the second.
    fs::rename(fixture.native().join("lib"), work.join("old")).unwrap();
    assert_eq!(fixture.state(Depth::Sizes), State::Missing);

    remove_leftovers(&fixture.native()).unwrap();
    fixture.bring().unwrap();
    assert_eq!(fixture.entries(), ["lib"]);
    assert_eq!(fixture.text(), "the library");
}

#[test]
fn a_second_set_up_waits_for_the_first() {
    let native = tempdir().unwrap();
    let first = lock(native.path()).unwrap();
    let other = File::open(native.path().join("lock")).unwrap();
    assert!(matches!(other.try_lock(), Err(TryLockError::WouldBlock)));
    drop(first);
    other.try_lock().unwrap();
}
