//! The page of all commands and options.

use clap::Command;
use clap_markdown::{MarkdownOptions, help_markdown_command_custom};

use crate::cli::completions::visible;

const INTRODUCTION: &str = "\
# Commands

Every command with its options, made from the program. `goalbench help commands` prints this page, `goalbench help run` or
`goalbench run --help` the part of a command. Exit codes: 0 for success; 1 if something failed, such as a run or a check; 2 for
wrong input, which changes nothing; 3 if a signal stopped it.

";

/// The page, in Markdown.
pub(super) fn page(program: &Command) -> String {
    let options = MarkdownOptions::new().show_footer(false).title(String::new());
    let text = help_markdown_command_custom(&visible(program), &options);
    // Its own introduction ends where the overview begins.
    let body = text.find("* [").map_or(text.as_str(), |start| &text[start..]);
    // Its smallest headings, one for arguments and one for options of each command, would fill tables of
    // contents.
    let body = body.replace("###### **", "**").replace('↴', "");
    let lines: Vec<&str> = body.lines().map(str::trim_end).collect();
    format!("{INTRODUCTION}{}\n", lines.join("\n").trim())
}
