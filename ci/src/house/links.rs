//! Links between pages lead somewhere.

use std::{fs, path::Path};

use super::Finding;

const RULE: &str = "a link of a page leads to a file, and to a heading of it";

/// The folders, from the project folder, whose Markdown pages are checked.
const FOLDERS: [&str; 3] = [".", ".github", "harness/docs"];

/// The links of all pages that lead nowhere.
pub(crate) fn broken(project: &Path) -> Vec<Finding> {
    FOLDERS
        .iter()
        .flat_map(|folder| pages(&project.join(folder)))
        .flat_map(|page| of_page(project, &page))
        .collect()
}

fn pages(folder: &Path) -> Vec<std::path::PathBuf> {
    let entries = fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let paths = entries.map(|entry| entry.expect("an entry").path());
    paths.filter(|path| path.extension().is_some_and(|end| end == "md")).collect()
}

fn of_page(project: &Path, page: &Path) -> Vec<Finding> {
    let text = fs::read_to_string(page).unwrap_or_else(|error| panic!("{}: {error}", page.display()));
    let file = page.strip_prefix(project).unwrap_or(page).display().to_string();
    let folder = page.parent().unwrap_or(project);
    let finding = |line: usize, target: &str| Finding {
        rule: RULE,
        file: file.clone(),
        line: line + 1,
        what: format!("`{target}` leads nowhere"),
    };
    let links =
        text.lines().enumerate().flat_map(|(line, text)| targets(text).map(move |target| (line, target)));
    let local = links.filter(|(_, target)| !target.contains("://"));
    local
        .filter(|(_, target)| !leads_somewhere(folder, page, target))
        .map(|(line, target)| finding(line, target))
        .collect()
}

/// The targets of the Markdown links of a line.
fn targets(line: &str) -> impl Iterator<Item = &str> {
    line.split("](").skip(1).filter_map(|rest| rest.split_once(')').map(|(target, _)| target))
}

fn leads_somewhere(folder: &Path, page: &Path, target: &str) -> bool {
    let (path, anchor) = target.split_once('#').map_or((target, None), |(path, anchor)| (path, Some(anchor)));
    let file = if path.is_empty() { page.to_owned() } else { folder.join(path) };
    match anchor {
        None => file.exists(),
        Some(anchor) => {
            fs::read_to_string(file).is_ok_and(|text| headings(&text).any(|heading| heading == anchor))
        }
    }
}

/// The anchors that GitHub gives the headings of a page.
fn headings(text: &str) -> impl Iterator<Item = String> {
    text.lines().filter(|line| line.starts_with('#')).map(|line| anchor(line.trim_start_matches('#').trim()))
}

fn anchor(heading: &str) -> String {
    let kept = heading.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
    kept.map(|c| if c == ' ' { '-' } else { c }).collect::<String>().to_lowercase()
}

#[cfg(test)]
mod tests {
    use std::fs;

    use tempfile::tempdir;

    use super::{anchor, of_page, targets};

    #[test]
    fn links_and_pictures_are_found() {
        let line = "[a](a.md) and ![b](docs/b.png), [c](https://c.org/x)";
        assert_eq!(targets(line).collect::<Vec<_>>(), ["a.md", "docs/b.png", "https://c.org/x"]);
    }

    #[test]
    fn anchors_are_those_of_github() {
        assert_eq!(anchor("The ledger of the paper's claims"), "the-ledger-of-the-papers-claims");
        assert_eq!(anchor("`run` a-b, c"), "run-a-b-c");
    }

    #[test]
    fn files_and_headings_must_exist() {
        let home = tempdir().unwrap();
        let page = home.path().join("page.md");
        fs::write(home.path().join("other.md"), "# Here it is\n").unwrap();
        let text = "# Top\n[1](other.md) [2](#top)\n[3](other.md#here-it-is) [4](none.md)\n[5](other.md#there) [6](#bottom)\n";
        fs::write(&page, text).unwrap();
        let found = of_page(home.path(), &page);
        let places: Vec<_> = found.iter().map(|finding| (finding.line, finding.what.as_str())).collect();
        let expected = [
            (3, "`none.md` leads nowhere"),
            (4, "`other.md#there` leads nowhere"),
            (4, "`#bottom` leads nowhere"),
        ];
        assert_eq!(places, expected);
        assert_eq!(found[0].file, "page.md");
    }
}
