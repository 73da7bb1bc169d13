//! The tables in LaTeX, compiled.

use std::fs;
use std::process::Command;

use super::support::{every_kind, program};
use reports::store::layout;

#[test]
fn every_table_compiles() {
    let Some(latex) = program("pdflatex", "GOALBENCH_REQUIRE_LATEX") else { return };
    let results = every_kind();
    let tables = layout::report_dir(results.path()).join("tables");
    let names = fs::read_dir(&tables).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let inputs: Vec<String> =
        names.map(|name| format!("\\noindent\\input{{{name}}}\n\\clearpage\n")).collect();
    assert_eq!(inputs.len(), 12, "{inputs:?}");
    let inputs = inputs.concat();
    let document = format!(
        "\\documentclass{{article}}\n\\usepackage[a3paper,landscape,margin=1cm]{{geometry}}\n\
         \\usepackage{{array,booktabs,longtable}}\n\\begin{{document}}\n\\small\n{inputs}\\end{{document}}\n"
    );
    fs::write(tables.join("all.tex"), document).unwrap();
    let output = Command::new(latex)
        .args(["-interaction=nonstopmode", "-halt-on-error", "-no-shell-escape", "all.tex"])
        .current_dir(&tables)
        .output()
        .unwrap();
    let log = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{log}");
    assert!(!log.contains("Overfull"), "a table sticks out of its page: {log}");
}
