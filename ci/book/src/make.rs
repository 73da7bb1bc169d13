//! The book, and beside it the files that its pages point to.

use std::fs;
use std::path::{Component, Path, PathBuf};

use mdbook_driver::MDBook;
use mdbook_driver::errors::{Error, Result};

use crate::links;

/// Where the pages lie in the project, and in the book: links from there to other files of the project then
/// lead to the same places.
const DOCS: &str = "harness/docs";

/// The way in: browsers go on to the first page.
const INDEX: &str = "<!doctype html>\n<meta charset=\"utf-8\">\n<title>goalbench</title>\n\
    <meta http-equiv=\"refresh\" content=\"0; url=harness/docs/index.html\">\n\
    <a href=\"harness/docs/index.html\">goalbench</a>\n";

/// Makes the book of `project` in the folder `out`.
///
/// # Errors
/// If a page is missing, or a file cannot be read or written.
pub(crate) fn book(project: &Path, out: &Path) -> Result<()> {
    let mut book = MDBook::load(project.join("harness"))?;
    book.config.build.build_dir = std::path::absolute(out.join(DOCS))?;
    book.build()?;
    let docs = project.join(DOCS);
    for page in pages(&docs)? {
        let text = fs::read_to_string(&page)?;
        for target in links::local(&text) {
            let path = within(&Path::new(DOCS).join(target));
            if !path.starts_with(DOCS) {
                copy(&project.join(&path), &out.join(&path))?;
            }
        }
    }
    fs::write(out.join("index.html"), INDEX)?;
    Ok(())
}

/// The pages in `docs`.
pub(crate) fn pages(docs: &Path) -> Result<Vec<PathBuf>> {
    let paths: Vec<PathBuf> =
        fs::read_dir(docs)?.map(|entry| entry.map(|entry| entry.path())).collect::<Result<_, _>>()?;
    Ok(paths.into_iter().filter(|path| path.extension().is_some_and(|end| end == "md")).collect())
}

/// `path` without `..`.
fn within(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => drop(plain.pop()),
            other => plain.push(other),
        }
    }
    plain
}

/// Copies a file, or a folder with all that is in it.
fn copy(from: &Path, to: &Path) -> Result<()> {
    let named = |error| Error::from(error).context(format!("cannot copy {}", from.display()));
    if !from.is_dir() {
        fs::create_dir_all(to.parent().unwrap_or(to)).map_err(named)?;
        fs::copy(from, to).map_err(named)?;
        return Ok(());
    }
    for entry in fs::read_dir(from).map_err(named)? {
        let entry = entry.map_err(named)?;
        copy(&entry.path(), &to.join(entry.file_name()))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::PROJECT;

    /// What stands between quotes after `attribute`, as in `href="python.html#part"`.
    fn values<'a>(page: &'a str, attribute: &'a str) -> impl Iterator<Item = &'a str> {
        page.split(attribute).skip(1).filter_map(|rest| rest.split_once('"').map(|(value, _)| value))
    }

    #[test]
    fn every_page_is_in_the_book_and_every_link_of_it_leads_somewhere() {
        let out = tempfile::tempdir().expect("a folder");
        let project = Path::new(PROJECT);
        book(project, out.path()).expect("a book");
        let docs = out.path().join(DOCS);
        let summary = fs::read_to_string(project.join(DOCS).join("SUMMARY.md")).expect("the list of pages");
        let listed: BTreeSet<&str> = links::local(&summary).collect();
        for page in pages(&project.join(DOCS)).expect("pages") {
            let name = page.file_name().and_then(|name| name.to_str()).expect("plain names");
            if name == "SUMMARY.md" {
                continue;
            }
            assert!(listed.contains(name), "{name} is not in SUMMARY.md");
            let html = fs::read_to_string(docs.join(name).with_extension("html")).expect("it is in the book");
            let mut checked = 0;
            for target in values(&html, " href=\"").chain(values(&html, " src=\"")) {
                let (path, anchor) = target.split_once('#').unwrap_or((target, ""));
                if path.contains("://") {
                    continue;
                }
                let file =
                    if path.is_empty() { docs.join(name).with_extension("html") } else { docs.join(path) };
                assert!(file.exists(), "{name}: {target}");
                let is_page = file.extension().is_some_and(|end| end == "html");
                if is_page && !anchor.is_empty() {
                    let there = fs::read_to_string(&file).expect("a page");
                    assert!(there.contains(&format!("id=\"{anchor}\"")), "{name}: {target}");
                }
                checked += 1;
            }
            assert!(checked > 10, "{name} has links of its own and those of the list of pages");
        }
        assert!(out.path().join("index.html").exists());
    }
}
