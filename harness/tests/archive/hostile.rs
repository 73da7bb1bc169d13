//! Archives that were damaged, or made to do harm.

use std::fs;
use std::path::{Path, PathBuf};

use tar::{EntryType, Header};

use crate::support::refused;
use crate::{ROOT, files, hex, text, trained, works};

/// An entry of an archive that nobody packed.
struct Forged<'a> {
    name: &'a str,
    kind: EntryType,
    content: &'a [u8],
}

fn regular<'a>(name: &'a str, content: &'a [u8]) -> Forged<'a> {
    Forged { name, kind: EntryType::Regular, content }
}

/// Writes an archive of `entries` as they are, whatever their names.
fn forge(path: &Path, entries: &[Forged<'_>]) {
    let mut archive = tar::Builder::new(zstd::Encoder::new(Vec::new(), 3).expect("zstd"));
    for Forged { name, kind, content } in entries {
        let mut header = Header::new_ustar();
        if header.set_path(name).is_err() {
            // What no honest writer takes.
            let field = &mut header.as_ustar_mut().expect("of this kind").name;
            field[..name.len()].copy_from_slice(name.as_bytes());
        }
        header.set_entry_type(*kind);
        header.set_mode(0o644);
        if !matches!(kind, EntryType::Regular) {
            header.as_ustar_mut().expect("of this kind").linkname[..11].copy_from_slice(b"/etc/passwd");
        }
        header.set_size(content.len() as u64);
        header.set_cksum();
        archive.append(&header, *content).expect("memory");
    }
    let bytes = archive.into_inner().expect("memory").finish().expect("memory");
    fs::write(path, bytes).expect("it can be written");
}

/// A results folder, and an archive that is written anew for each case.
struct Case {
    _folder: tempfile::TempDir,
    own: PathBuf,
    good: PathBuf,
    bad: PathBuf,
}

impl Case {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let [own, good, bad] = ["own", "good.tar.zst", "bad.tar.zst"].map(|name| folder.path().join(name));
        trained(&own, "teach", &["--seeds", "0"]);
        works(&["pack", text(&own), "--out", text(&good), "--policies", "none"]);
        Self { _folder: folder, own, good, bad }
    }

    /// Checks that the archive is refused and nothing drawn.
    fn refuse(&self, expected: &[&str]) {
        refused(
            &["report", text(&self.own), "--with", text(&self.bad)],
            &[&["--with", "bad.tar.zst"], expected].concat(),
        );
        assert!(!self.own.join("report").exists(), "{expected:?}");
    }

    fn refuse_forged(&self, entries: &[Forged<'_>], expected: &[&str]) {
        forge(&self.bad, entries);
        self.refuse(expected);
    }
}

/// The list of checksums of these files.
fn sums(entries: &[(&str, &[u8])]) -> Vec<u8> {
    let line = |(name, content): &(&str, &[u8])| format!("{}  {name}\n", hex(content));
    entries.iter().map(line).collect::<String>().into_bytes()
}

/// The name in an archive.
fn rooted(name: &str) -> String {
    format!("{ROOT}/{name}")
}

#[test]
fn links_and_names_that_lead_elsewhere_are_refused() {
    let case = Case::new();
    let (list, card) = (rooted("SHA256SUMS"), rooted("DATA.md"));
    let one = sums(&[("DATA.md", b"card")]);
    for stray in [
        "../../x",
        "/etc/x",
        "goalbench-results/../x",
        "goalbench-results/runs/../../x",
        "DATA.md",
        "goalbench-results/protocols/.x.toml",
        "goalbench-results/runs/Point/teach/default/seed-0/checkpoint.bin",
    ] {
        case.refuse_forged(&[regular(&list, &one), regular(stray, b"x")], &[stray, "is none of the files"]);
    }
    for kind in [
        EntryType::Symlink,
        EntryType::Link,
        EntryType::Fifo,
        EntryType::Char,
        EntryType::Directory,
        EntryType::GNULongName,
        EntryType::XHeader,
        EntryType::GNUSparse,
    ] {
        let entry = Forged { name: &card, kind, content: b"" };
        case.refuse_forged(&[regular(&list, &one), entry], &["is no regular file"]);
    }
}

#[test]
fn archives_that_are_not_what_was_packed_are_refused() {
    let case = Case::new();
    let whole = fs::read(&case.good).expect("an archive");
    let mut flipped = whole.clone();
    flipped[whole.len() / 2] ^= 4;
    for damaged in [&whole[..whole.len() / 2], b"no archive", &flipped] {
        fs::write(&case.bad, damaged).expect("it can be written");
        case.refuse(&["cannot use this archive"]);
    }
    let hidden = zstd::encode_all(b"hidden".as_slice(), 3).expect("zstd");
    fs::write(&case.bad, [&whole, hidden.as_slice()].concat()).expect("it can be written");
    case.refuse(&["something follows its last file"]);
    let (list, card) = (rooted("SHA256SUMS"), rooted("DATA.md"));
    let records = rooted("runs/Point/teach/default/seed-0/records.jsonl");
    let one = sums(&[("DATA.md", b"card")]);
    let (listed, right) = (|| regular(&list, &one), || regular(&card, b"card"));
    case.refuse_forged(&[right(), listed()], &["stands where the list of checksums belongs"]);
    case.refuse_forged(&[listed(), right(), right()], &["is there twice"]);
    case.refuse_forged(
        &[listed(), regular(&card, b"cord")],
        &["DATA.md", "checksum that it was packed with"],
    );
    case.refuse_forged(&[listed(), right(), regular(&records, b"{}")], &["is not in the list of checksums"]);
    case.refuse_forged(&[listed()], &["it lacks `DATA.md`"]);
    case.refuse_forged(&[regular(&list, b"nonsense\n")], &["line 1 of its SHA256SUMS"]);
    case.refuse_forged(&[listed(), right()], &["it holds no runs"]);
    case.refuse_forged(&[], &["it lacks `SHA256SUMS`"]);
    let zeros = vec![0; 64 << 20];
    let bomb = sums(&[("DATA.md", &zeros)]);
    case.refuse_forged(&[regular(&list, &bomb), regular(&card, &zeros)], &["it unpacks to more than"]);
    assert!(fs::metadata(&case.bad).expect("a file").len() < 100_000, "it was a bomb");
}

/// Whole by its own list, but not what the run ended with.
#[test]
fn runs_that_were_altered_before_they_were_packed_anew_are_refused() {
    let case = Case::new();
    let mut files = files(&case.good);
    let run = "runs/Point/teach/default/seed-0/records.jsonl";
    let records = String::from_utf8(files[run].clone()).expect("text");
    let altered = records.replace("\"episodes\":5", "\"episodes\":9");
    assert_ne!(altered, records);
    files.insert(run.to_owned(), altered.into_bytes());
    files.remove("SHA256SUMS");
    let entries: Vec<(&str, &[u8])> =
        files.iter().map(|(name, content)| (name.as_str(), content.as_slice())).collect();
    let (list, listed) = (rooted("SHA256SUMS"), sums(&entries));
    let names: Vec<String> = files.keys().map(|name| rooted(name)).collect();
    let mut forged = vec![regular(&list, &listed)];
    forged.extend(names.iter().zip(files.values()).map(|(name, content)| regular(name, content)));
    case.refuse_forged(&forged, &["its runs are damaged", "altered"]);
}
