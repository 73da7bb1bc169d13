//! The page: self-contained, escaped, and sound in a real browser.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::support::{HOSTILE, every_kind, program};
use reports::store::layout;
use tempfile::TempDir;

/// The page of a report with every kind of figure, and the folder of its results.
fn page() -> (TempDir, String) {
    let results = every_kind();
    let html = fs::read_to_string(layout::report_dir(results.path()).join("index.html")).unwrap();
    (results, html)
}

#[test]
fn the_page_needs_nothing_else_and_escapes_names() {
    let (results, html) = page();
    assert!(!html.contains(HOSTILE) && !html.contains("<script"), "names are escaped");
    assert!(html.contains("&lt;img src=x onerror=alert(1)&gt;&amp;&quot;&#39;"));
    for attribute in ["src=\"", "href=\""] {
        for (_, rest) in html.match_indices(attribute).map(|(at, _)| html.split_at(at + attribute.len())) {
            assert!(rest.starts_with("data:") || rest.starts_with('#'), "{}", &rest[..40]);
        }
    }
    assert!(!html.contains("url(") && !html.contains("@import"));
    // A figure is there twice, as PNG and as SVG; a film once.
    let files = fs::read_dir(layout::report_dir(results.path()).join("figures")).unwrap().flatten();
    let is_shown = |name: &OsStr| Path::new(name).extension().is_some_and(|end| end == "png" || end == "gif");
    let figures = files.filter(|file| is_shown(&file.file_name())).count();
    assert_eq!(html.matches("<img ").count(), figures, "every figure is on the page");
    for id in [
        "results",
        "teaching",
        "ledger",
        "readings",
        "ablations",
        "comparisons",
        "dimensions",
        "deviations",
        "citations",
        "protocol",
        "versions",
    ] {
        assert!(html.contains(&format!("<section id=\"{id}\">")), "{id}");
    }
}

/// Has `page` shown in a window of this size and gives the title that it ends with, and what the browser
/// logged.
fn shown(browser: &Path, page: &Path, size: &str) -> (String, String) {
    let profile = TempDir::new().unwrap();
    let output = Command::new(browser)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run"])
        .args(["--disable-background-networking", "--disable-component-update", "--disable-sync"])
        .args(["--enable-logging=stderr", "--v=0", "--virtual-time-budget=20000", "--dump-dom"])
        .arg(format!("--window-size={size}"))
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .arg(format!("file://{}", page.display()))
        .output()
        .unwrap();
    let dom = String::from_utf8_lossy(&output.stdout).into_owned();
    let title =
        dom.split("<title>").nth(1).and_then(|rest| rest.split("</title>").next()).unwrap_or_default();
    (title.to_owned(), String::from_utf8_lossy(&output.stderr).into_owned())
}

/// A copy of a page that says, once loaded, how many figures it shows and by how many pixels anything sticks
/// out of the window: in its title, and to the page around it.
fn with_probe(folder: &Path, html: &str) -> PathBuf {
    let probe = "<script>addEventListener('load', () => { const images = [...document.images];\
                 const excess = element => element.scrollWidth - element.clientWidth;\
                 const scrolled = [...document.querySelectorAll('.scroll, figure')].map(excess);\
                 document.title = 'shown ' + images.filter(i => i.complete && i.naturalWidth > 300).length +\
                 ' of ' + images.length + ', excess ' + excess(document.documentElement) +\
                 ', inside ' + Math.max(0, ...scrolled);\
                 parent.postMessage(document.title, '*'); });</script></body>";
    let copy = folder.join("probe.html");
    fs::write(&copy, html.replace("</body>", probe)).unwrap();
    copy
}

#[test]
fn a_browser_shows_every_figure_and_complains_of_nothing() {
    let Some(browser) = program("chromium", "GOALBENCH_REQUIRE_BROWSER") else { return };
    let (results, html) = page();
    let copy = with_probe(results.path(), &html);
    let figures = html.matches("<img ").count();
    // 500 pixels is the narrowest window of a headless browser.
    for size in ["1200,900", "500,900"] {
        let (title, log) = shown(&browser, &copy, size);
        assert!(!log.contains("CONSOLE"), "{log}");
        let expected = format!("shown {figures} of {figures}, excess 0, inside ");
        assert!(title.starts_with(&expected), "window of {size}: {title}: {log}");
    }
}

#[test]
fn nothing_on_a_phone_scrolls_sideways() {
    let Some(browser) = program("chromium", "GOALBENCH_REQUIRE_BROWSER") else { return };
    let (results, html) = page();
    let copy = with_probe(results.path(), &html);
    let figures = html.matches("<img ").count();
    for width in [390, 320] {
        // A frame is as narrow as it is told to be, and the page in it takes it for the window.
        let phone = results.path().join("phone.html");
        let frame = format!(
            "<!DOCTYPE html><html><head><title>nothing</title></head><body><script>\
             addEventListener('message', event => {{ document.title = event.data; }});</script>\
             <iframe src=\"{}\" style=\"width: {width}px; height: 900px; border: 0\"></iframe></body></html>",
            copy.file_name().unwrap().to_str().unwrap()
        );
        fs::write(&phone, frame).unwrap();
        let (title, log) = shown(&browser, &phone, "1200,900");
        let expected = format!("shown {figures} of {figures}, excess 0, inside 0");
        assert_eq!(title, expected, "{width} pixels: {log}");
    }
}
