//! Takes the wanted files out of a wheel, which is a zip archive.

use std::{
    fs::{self, File},
    io::{self, BufReader},
    os::unix::fs::symlink,
    path::{Component, Path},
};

use zip::ZipArchive;

use crate::{
    error::{Error, Result, doing},
    pins::{Addition, Take},
    stamp::{HashingWriter, Stamp},
};

/// Where a file of a wheel goes, if any of `takes` wants it.
fn destination(entry: &str, takes: &[Take]) -> Option<String> {
    takes.iter().find_map(|take| match entry.strip_prefix(take.from) {
        Some("") if !take.from.ends_with('/') => Some(take.to.to_owned()),
        Some(rest) if take.from.ends_with('/') && !rest.is_empty() => Some(format!("{}{rest}", take.to)),
        _ => None,
    })
}

/// Whether an entry's name stays below the folder that it is unpacked into.
fn stays_inside(entry: &str) -> bool {
    !entry.contains(['\\', '\0'])
        && Path::new(entry).components().all(|part| matches!(part, Component::Normal(_)))
}

/// Unpacks what `takes` name of `wheel` into `folder` and records each file in `stamp`.
///
/// # Errors
/// If any entry of the archive, wanted or not, would leave the folder; if a wanted one is a link or damaged;
/// if one of `takes` names nothing in the archive.
pub(crate) fn unpack(wheel: &Path, takes: &[Take], folder: &Path, stamp: &mut Stamp) -> Result<()> {
    let file = File::open(wheel).map_err(doing("open", wheel))?;
    let broken = |source| Error::Archive { wheel: wheel.to_owned(), source };
    let unsafe_entry = |entry: &str| Error::UnsafeEntry { wheel: wheel.to_owned(), entry: entry.to_owned() };
    let mut archive = ZipArchive::new(BufReader::new(file)).map_err(broken)?;
    if let Some(entry) = archive.file_names().find(|entry| !stays_inside(entry)) {
        return Err(unsafe_entry(entry));
    }
    for take in takes {
        if !archive.file_names().any(|entry| destination(entry, std::slice::from_ref(take)).is_some()) {
            return Err(Error::NoSuchEntry { wheel: wheel.to_owned(), entry: take.from });
        }
    }
    for index in 0..archive.len() {
        let mut entry = archive.by_index(index).map_err(broken)?;
        let Some(to) = destination(entry.name(), takes).filter(|_| !entry.is_dir()) else { continue };
        if !entry.is_file() {
            return Err(unsafe_entry(entry.name()));
        }
        let path = folder.join(&to);
        let mut writer = HashingWriter::new(create(&path)?);
        // Reading to the end also checks the archive's own checksum.
        io::copy(&mut entry, &mut writer).map_err(doing("unpack", &path))?;
        stamp.files.insert(to, writer.finish());
    }
    Ok(())
}

/// Writes what set-up itself adds to a part into `folder` and records it in `stamp`.
pub(crate) fn add(additions: &[Addition], folder: &Path, stamp: &mut Stamp) -> Result<()> {
    for addition in additions {
        match addition {
            Addition::Text { path, text } => {
                let to = folder.join(path);
                let mut writer = HashingWriter::new(create(&to)?);
                io::copy(&mut text.as_bytes(), &mut writer).map_err(doing("write", &to))?;
                stamp.files.insert((*path).to_owned(), writer.finish());
            }
            Addition::Link { path, target } => {
                let to = folder.join(path);
                symlink(target, &to).map_err(doing("link", &to))?;
                stamp.links.insert((*path).to_owned(), (*target).to_owned());
            }
        }
    }
    Ok(())
}

/// Creates a file, and the folders above it, where there is none yet.
fn create(path: &Path) -> Result<File> {
    if let Some(parent) = path.parent() {
        fs::create_dir_all(parent).map_err(doing("create", parent))?;
    }
    File::create_new(path).map_err(doing("create", path))
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use tempfile::tempdir;
    use zip::{ZipWriter, write::SimpleFileOptions};

    use super::*;

    const TAKES: [Take; 2] =
        [Take { from: "torch/include/", to: "include/" }, Take { from: "a/lib.so", to: "lib/x.so" }];

    fn archive(path: &Path, entries: &[(&str, &str)]) {
        let mut zip = ZipWriter::new(File::create(path).unwrap());
        for (name, text) in entries {
            zip.start_file(*name, SimpleFileOptions::default()).unwrap();
            zip.write_all(text.as_bytes()).unwrap();
        }
        zip.finish().unwrap();
    }

    #[test]
    fn only_wanted_entries_are_unpacked_and_recorded() {
        let home = tempdir().unwrap();
        let (wheel, folder) = (home.path().join("w.whl"), home.path().join("part"));
        archive(
            &wheel,
            &[
                ("torch/include/c10/a.h", "abc"),
                ("a/lib.so", "so"),
                ("a/lib.so.2", "no"),
                ("torch/other.py", "no"),
            ],
        );
        let mut stamp = Stamp::default();
        unpack(&wheel, &TAKES, &folder, &mut stamp).unwrap();
        assert_eq!(stamp.files.keys().collect::<Vec<_>>(), ["include/c10/a.h", "lib/x.so"]);
        assert_eq!(fs::read_to_string(folder.join("include/c10/a.h")).unwrap(), "abc");
        let record = &stamp.files["include/c10/a.h"];
        assert_eq!(record.bytes, 3);
        // SHA-256 of "abc": FIPS 180-2, appendix B.1.
        assert_eq!(record.sha256, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
        assert!(!folder.join("lib/x.so.2").exists());
    }

    #[test]
    fn entries_that_leave_the_folder_are_refused_before_anything_is_written() {
        for bad in ["torch/include/../../../evil", "/etc/evil", "torch/include/..\\evil"] {
            let home = tempdir().unwrap();
            let (wheel, folder) = (home.path().join("w.whl"), home.path().join("part"));
            archive(&wheel, &[("a/lib.so", "so"), ("torch/include/a.h", ""), (bad, "evil")]);
            let error = unpack(&wheel, &TAKES, &folder, &mut Stamp::default()).unwrap_err();
            assert!(matches!(&error, Error::UnsafeEntry { entry, .. } if entry == bad), "{bad}: {error}");
            assert!(!folder.exists(), "{bad}");
        }
    }

    #[test]
    fn a_wanted_symbolic_link_is_refused() {
        let home = tempdir().unwrap();
        let wheel = home.path().join("w.whl");
        let mut zip = ZipWriter::new(File::create(&wheel).unwrap());
        zip.add_symlink("a/lib.so", "/etc/passwd", SimpleFileOptions::default()).unwrap();
        zip.finish().unwrap();
        let error =
            unpack(&wheel, &TAKES[1..], &home.path().join("part"), &mut Stamp::default()).unwrap_err();
        assert!(matches!(error, Error::UnsafeEntry { .. }), "{error}");
    }

    #[test]
    fn a_wheel_without_a_wanted_entry_is_an_error_that_names_it() {
        let home = tempdir().unwrap();
        let wheel = home.path().join("w.whl");
        archive(&wheel, &[("a/lib.so", "so")]);
        let error = unpack(&wheel, &TAKES, &home.path().join("part"), &mut Stamp::default()).unwrap_err();
        assert!(error.to_string().ends_with("holds no torch/include/"), "{error}");
    }

    #[test]
    fn a_damaged_archive_is_an_error() {
        let home = tempdir().unwrap();
        let wheel = home.path().join("w.whl");
        archive(&wheel, &[("a/lib.so", "the content of the library")]);
        let mut bytes = fs::read(&wheel).unwrap();
        // Inside the compressed data, which follows the 30-byte header and the 8-byte name.
        bytes[44] ^= 0xff;
        fs::write(&wheel, bytes).unwrap();
        let error =
            unpack(&wheel, &TAKES[1..], &home.path().join("part"), &mut Stamp::default()).unwrap_err();
        assert!(matches!(error, Error::Io { action: "unpack", .. }), "{error}");
    }
}
