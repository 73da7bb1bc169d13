//! The page: self-contained, escaped, and sound in a real browser.

use std::fs;
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
    let figures = fs::read_dir(layout::report_dir(results.path()).join("figures")).unwrap().count() / 2;
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
        "protocol",
        "versions",
    ] {
        assert!(html.contains(&format!("<section id=\"{id}\">")), "{id}");
    }
}

#[test]
fn a_browser_shows_every_figure_and_complains_of_nothing() {
    let Some(browser) = program("chromium", "GOALBENCH_REQUIRE_BROWSER") else { return };
    let (results, html) = page();
    // A copy that says, once loaded, how many figures it shows and whether anything sticks out of the window.
    let probe = "<script>addEventListener('load', () => { const images = [...document.images];\
                 document.title = 'shown ' + images.filter(i => i.complete && i.naturalWidth > 300).length +\
                 ' of ' + images.length + ', excess ' +\
                 (document.documentElement.scrollWidth - document.documentElement.clientWidth); });</script></body>";
    let copy = results.path().join("probe.html");
    fs::write(&copy, html.replace("</body>", probe)).unwrap();
    // 500 pixels is the narrowest window of a headless browser.
    for size in ["1200,900", "500,900"] {
        let profile = TempDir::new().unwrap();
        let output = Command::new(&browser)
            .args(["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run"])
            .args(["--disable-background-networking", "--disable-component-update", "--disable-sync"])
            .args(["--enable-logging=stderr", "--v=0", "--virtual-time-budget=20000", "--dump-dom"])
            .arg(format!("--window-size={size}"))
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .arg(format!("file://{}", copy.display()))
            .output()
            .unwrap();
        let log = String::from_utf8_lossy(&output.stderr);
        assert!(!log.contains("CONSOLE"), "{log}");
        let dom = String::from_utf8_lossy(&output.stdout);
        let title =
            dom.split("<title>").nth(1).and_then(|rest| rest.split("</title>").next()).unwrap_or_default();
        let figures = html.matches("<img ").count();
        assert_eq!(title, format!("shown {figures} of {figures}, excess 0"), "window of {size}: {log}");
    }
}
