//! From a results folder to an archive.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use guard::{files, fresh};
use reports::ReportOptions;
use reports::schema::{Manifest, RunKey};
use reports::store::checksums::Checksums;
use reports::store::problem::StoreProblem;
use reports::store::protocols::{self, ProtocolCopy};
use reports::store::{Run, RunFolder, Store, layout};
use tar::{EntryType, Header};

use super::card::Card;
use super::member::member;
use super::problem::PackProblem;
use super::sums::{self, Summing, Sums};
use super::{CARD, MOST_BYTES, MOST_FILES, POLICIES, ROOT, SUMS, unpacked_policy};
use crate::Registry;
use crate::error::HarnessError;
use crate::export::ExportedPolicy;
use crate::outputs;
use crate::run::policy::Policy;

/// What goes into an archive beside the records.
pub struct Packing {
    /// Whose trained policies.
    pub policies: PolicyChoice,
    /// Files of every run that stay behind, by name.
    pub without: Vec<&'static str>,
    /// Under which licence the data are given away, as an SPDX id.
    pub licence: String,
    /// What the card is headed by; `None`: the names of the protocols.
    pub title: Option<String>,
}

/// Whose trained policies are packed. Those of finished runs alone.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PolicyChoice {
    /// Of the lowest seed of each environment, curriculum and variant.
    First,
    /// Of all runs.
    All,
    /// Of none.
    None,
    /// Of these seeds.
    Seeds(Vec<u64>),
}

/// An archive that was written.
pub struct Packed {
    /// Runs in it.
    pub runs: usize,
    /// Runs whose policies are in it.
    pub policies: usize,
    /// Its size.
    pub bytes: u64,
    /// Its SHA-256, in hex.
    pub sha256: String,
}

/// What a file of the archive holds.
enum Content {
    Bytes(Vec<u8>),
    File(PathBuf),
}

/// How hard zstd tries: above this it takes much longer for little.
const LEVEL: i32 = 12;
/// Longest name of a protocol in an archive, in bytes, without number and extension: tar's format has room
/// for 100.
const LONGEST_STEM: usize = 80;
/// What errors say was tried.
const PACK: &str = "pack these results";

/// Packs the results folder `results` into the file `out`, which appears complete or not at all. `options`
/// say what the runs' final success is.
///
/// # Errors
/// [`HarnessError::Unusable`] with a [`PackProblem`]; [`HarnessError`] if a policy that is asked for cannot
/// be read, or a file not be read or written.
pub fn pack(
    registry: &Registry,
    results: &Path,
    out: &Path,
    options: &ReportOptions,
    packing: &Packing,
) -> Result<Packed, HarnessError> {
    let refused = || HarnessError::unusable(results.display(), PACK);
    let store = Store::read(results)?;
    let (protocols, unreadable) = protocols::protocols(results);
    let (_, damaged) = reports::store::tuning(results);
    check(&store, &[unreadable, damaged].concat()).map_err(refused())?;
    let chosen = chosen(store.runs(), &packing.policies).map_err(refused())?;
    let tidy = reports::tidy_data(results, &store, options)?;
    let mut contents: BTreeMap<String, Content> = BTreeMap::new();
    let named = |(name, bytes): (PathBuf, Vec<u8>)| (name.display().to_string(), Content::Bytes(bytes));
    contents.extend(tidy.files.into_iter().map(named));
    for run in store.runs() {
        contents.extend(files_of(results, run.key(), &packing.without)?);
    }
    contents.extend(protocol_files(results));
    let choice = layout::choice_file(results);
    if choice.is_file() {
        contents.insert(format!("{}/{}", layout::TUNING, layout::CHOICE), Content::File(choice));
    }
    for run in &chosen {
        for (name, bytes) in policy(registry, results, &run.manifest)?.files() {
            contents.insert(format!("{POLICIES}/{}/{name}", run.key()), Content::Bytes(bytes.to_vec()));
        }
    }
    let title = packing.title.clone().unwrap_or_else(|| title(&protocols));
    let card = Card {
        title: &title,
        licence: &packing.licence,
        runs: store.runs(),
        protocols: &protocols,
        policies: chosen.len(),
        without: &packing.without,
        columns: &tidy.columns,
    };
    contents.insert(CARD.to_owned(), Content::Bytes(card.text().into_bytes()));
    let sums = sums_of(&contents, results)?;
    let (bytes, sha256) = write(out, &contents, &sums, results)?;
    Ok(Packed { runs: store.runs().len(), policies: chosen.len(), bytes, sha256 })
}

/// # Errors
/// [`PackProblem`] if results are not whole.
fn check(store: &Store, unreadable: &[StoreProblem]) -> Result<(), PackProblem> {
    let lines = |problems: Vec<String>| problems.join("\n  ");
    let problems: Vec<String> = store.damages().chain(unreadable).map(ToString::to_string).collect();
    if !problems.is_empty() {
        return Err(PackProblem::Damaged(lines(problems)));
    }
    let unfinished = store.runs().iter().filter(|run| run.outcome.is_none());
    let unfinished: Vec<String> = unfinished.map(|run| run.key().to_string()).collect();
    if unfinished.is_empty() { Ok(()) } else { Err(PackProblem::Unfinished(lines(unfinished))) }
}

/// The runs whose policies are packed, of all `runs` by rising key.
fn chosen<'a>(runs: &'a [Run], choice: &PolicyChoice) -> Result<Vec<&'a Run>, PackProblem> {
    let finished = || runs.iter().filter(|run| run.is_finished());
    let cell = |run: &Run| {
        let RunKey { environment, curriculum, variant, .. } = run.key();
        [environment, curriculum, variant].map(Clone::clone)
    };
    Ok(match choice {
        PolicyChoice::All => finished().collect(),
        PolicyChoice::None => Vec::new(),
        PolicyChoice::First => {
            let mut first: Vec<&Run> = finished().collect();
            first.dedup_by_key(|run| cell(run));
            first
        }
        PolicyChoice::Seeds(seeds) => {
            if let Some(&seed) = seeds.iter().find(|seed| finished().all(|run| run.key().seed != **seed)) {
                let there: BTreeSet<u64> = finished().map(|run| run.key().seed).collect();
                let names: Vec<String> = there.iter().map(u64::to_string).collect();
                return Err(PackProblem::NoPolicy { seed, finished: names.join(", ") });
            }
            finished().filter(|run| seeds.contains(&run.key().seed)).collect()
        }
    })
}

/// The policy of the run of `manifest`, from its checkpoint. A run that came out of an archive has none, but
/// its policy may have come with it.
///
/// # Errors
/// [`HarnessError`] if there is neither, or one that is damaged.
fn policy(registry: &Registry, results: &Path, manifest: &Manifest) -> Result<ExportedPolicy, HarnessError> {
    let folder = RunFolder::of(results, &manifest.run);
    if !folder.has(layout::CHECKPOINT)?
        && let Some(unpacked) = unpacked_policy(results, manifest)?
    {
        return Ok(unpacked);
    }
    ExportedPolicy::of(registry, &Policy::read(registry, folder.path())?)
}

/// The packed files of a run that are there, without those of these names.
///
/// # Errors
/// [`HarnessError::Store`] if nobody can tell which are.
fn files_of(
    results: &Path,
    run: &RunKey,
    without: &[&'static str],
) -> Result<Vec<(String, Content)>, HarnessError> {
    let folder = RunFolder::of(results, run);
    let mut files = Vec::new();
    for row in layout::FILES.iter().filter(|row| row.packed && !without.contains(&row.name)) {
        if folder.has(row.name)? {
            let content = match row.name {
                layout::CHECKSUMS if !without.is_empty() => {
                    let of_the_others = Checksums::noted(&folder)?.without(without);
                    let unwritable = HarnessError::io(folder.file(row.name), "write these checksums");
                    Content::Bytes(crate::files::json(&of_the_others).map_err(unwritable)?)
                }
                name => Content::File(folder.file(name)),
            };
            files.push((format!("runs/{run}/{}", row.name), content));
        }
    }
    Ok(files)
}

/// The copies of protocols, by their names as far as these fit.
fn protocol_files(results: &Path) -> BTreeMap<String, Content> {
    let entries = fs::read_dir(layout::protocols_dir(results)).into_iter().flatten().flatten();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    paths.sort();
    let mut files = BTreeMap::new();
    for path in paths {
        let Some(stem) = path.file_name().and_then(|name| name.to_str()?.strip_suffix(".toml")) else {
            continue;
        };
        let stem = &stem[..stem.floor_char_boundary(LONGEST_STEM)];
        let numbered = |number: usize| match number {
            1 => format!("protocols/{stem}.toml"),
            _ => format!("protocols/{stem}~{number}.toml"),
        };
        let name = (1..).map(numbered).find(|name| !files.contains_key(name));
        if let Some(name) = name.filter(|name| member(name).is_some()) {
            files.insert(name, Content::File(path));
        }
    }
    files
}

/// The heading of a card for results of these protocols.
fn title(protocols: &[ProtocolCopy]) -> String {
    let mut names: Vec<&str> = Vec::new();
    for protocol in protocols {
        if !names.contains(&protocol.name.as_str()) {
            names.push(&protocol.name);
        }
    }
    if names.is_empty() { "Automatic curricula, compared".to_owned() } else { names.join(", ") }
}

impl Content {
    fn open(&self) -> io::Result<(u64, Box<dyn Read + '_>)> {
        Ok(match self {
            Self::Bytes(bytes) => (bytes.len() as u64, Box::new(bytes.as_slice())),
            Self::File(path) => {
                let file = files::open(path)?;
                (file.metadata()?.len(), Box::new(file))
            }
        })
    }

    /// For `map_err`: that the file `name` of the archive could not be read.
    fn unreadable(&self, name: &str) -> impl FnOnce(io::Error) -> HarnessError + use<> {
        let path = if let Self::File(path) = self { path.clone() } else { PathBuf::from(name) };
        HarnessError::io(path, "read this file")
    }
}

/// The checksums of all files.
fn sums_of(contents: &BTreeMap<String, Content>, results: &Path) -> Result<Sums, HarnessError> {
    let mut all = Sums::new();
    let mut total = 0;
    for (name, content) in contents {
        let (_, reader) = content.open().map_err(content.unreadable(name))?;
        let (sum, bytes) = sums::of(reader).map_err(content.unreadable(name))?;
        total += bytes;
        all.insert(name.clone(), sum);
    }
    if total > MOST_BYTES || all.len() > MOST_FILES {
        let problem = PackProblem::TooLarge { bytes: total, files: all.len() };
        return Err(HarnessError::unusable(results.display(), PACK)(problem));
    }
    Ok(all)
}

/// Writes the archive. Gives its size and checksum.
fn write(
    out: &Path,
    contents: &BTreeMap<String, Content>,
    sums: &Sums,
    results: &Path,
) -> Result<(u64, String), HarnessError> {
    let folder = outputs::folder_of(out);
    fs::create_dir_all(folder).map_err(HarnessError::io(folder, "create this folder"))?;
    let unwritable = || HarnessError::io(out, "write this file");
    let mut file = fresh::file(folder).map_err(unwritable())?;
    let mut encoder = zstd::Encoder::new(Summing::new(&mut file), LEVEL).map_err(unwritable())?;
    encoder.include_checksum(true).map_err(unwritable())?;
    let mut archive = tar::Builder::new(encoder);
    let list = sums::text(sums);
    append(&mut archive, SUMS, list.len() as u64, list.as_bytes(), results)?.map_err(unwritable())?;
    for (name, content) in contents {
        let (size, reader) = content.open().map_err(content.unreadable(name))?;
        let mut reader = Summing::new(reader);
        append(&mut archive, name, size, &mut reader, results)?.map_err(unwritable())?;
        if sums.get(name) != Some(&reader.sum()) {
            let problem = PackProblem::Changed(name.clone());
            return Err(HarnessError::unusable(results.display(), PACK)(problem));
        }
    }
    let encoder = archive.into_inner().map_err(unwritable())?;
    let sha256 = encoder.finish().map_err(unwritable())?.sum();
    file.as_file().sync_all().map_err(unwritable())?;
    let bytes = file.as_file().metadata().map_err(unwritable())?.len();
    fresh::put(file, out).map_err(unwritable())?;
    Ok((bytes, sha256))
}

/// Appends a file without time and owner.
fn append(
    archive: &mut tar::Builder<impl Write>,
    name: &str,
    size: u64,
    reader: impl Read,
    results: &Path,
) -> Result<io::Result<()>, HarnessError> {
    let mut header = Header::new_ustar();
    let is_known = name == SUMS || member(name).is_some();
    if !is_known || header.set_path(format!("{ROOT}/{name}")).is_err() {
        let problem = PackProblem::Name(name.to_owned());
        return Err(HarnessError::unusable(results.display(), PACK)(problem));
    }
    header.set_entry_type(EntryType::Regular);
    header.set_size(size);
    header.set_mode(0o644);
    header.set_mtime(0);
    header.set_uid(0);
    header.set_gid(0);
    header.set_cksum();
    Ok(archive.append(&header, reader.take(size)))
}
