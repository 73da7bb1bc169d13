//! Command lines that clap refuses, in words that help.

use std::any::TypeId;
use std::ffi::OsString;
use std::path::PathBuf;

use clap::builder::{PathBufValueParser, TypedValueParser};
use clap::error::{ContextKind, ContextValue, Error};
use clap::{Arg, Command, Parser};
use guard::text::short;

use crate::console::takes_sequences;

/// The command line as `P`.
///
/// # Errors
/// Clap's answer where it is refused, or where help or version are asked for.
pub(super) fn parse<P: Parser>() -> Result<P, Error> {
    parse_from(std::env::args_os())
}

/// The same of other words, the program's name before them.
///
/// # Errors
/// As those of [`parse`].
pub(super) fn parse_from<P: Parser>(
    words: impl IntoIterator<Item = impl Into<OsString> + Clone>,
) -> Result<P, Error> {
    command::<P>().try_get_matches_from(words).and_then(|matches| P::from_arg_matches(&matches))
}

/// The command of `P`, whose options take negative numbers: they are refused as values, not as options. What
/// is longer than any path is refused as one, before it is repeated in a message. Options that take a path
/// have no further `value_parser`: this takes its place.
pub(super) fn command<P: Parser>() -> Command {
    fn prepared(command: Command) -> Command {
        command.mut_args(|arg| path(negative_numbers(arg))).mut_subcommands(prepared)
    }
    prepared(P::command())
}

fn negative_numbers(arg: Arg) -> Arg {
    let is_option = arg.get_action().takes_values() && !arg.is_positional();
    if is_option { arg.allow_negative_numbers(true) } else { arg }
}

/// The longest path that Linux knows, in bytes.
const LONGEST_PATH: usize = 4095;

fn path(arg: Arg) -> Arg {
    if arg.get_value_parser().type_id() != TypeId::of::<PathBuf>() {
        return arg;
    }
    let is_possible = |path: PathBuf| {
        let fits = path.as_os_str().len() <= LONGEST_PATH;
        fits.then_some(path).ok_or_else(|| format!("a path of at most {LONGEST_PATH} bytes is accepted"))
    };
    arg.value_parser(PathBufValueParser::new().try_map(is_possible))
}

/// What is wrong with the command line of `P`; in colours where standard error is a terminal that takes them.
pub(super) fn text<P: Parser>(mut error: Error) -> String {
    let words: Vec<String> = std::env::args_os().map(|word| word.to_string_lossy().into_owned()).collect();
    let typed = match error.get(ContextKind::InvalidArg) {
        Some(ContextValue::String(value)) => option_before(&command::<P>(), &words, value),
        _ => None,
    };
    if let Some((option, word)) = typed {
        // Clap's tip would make it a further argument.
        let tip = format!("to pass '{}' as a value, use '{option}={}'", short(word), short(word));
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
    }
    make_short(&mut error);
    let rendered = error.render();
    if takes_sequences() { rendered.ansi().to_string() } else { rendered.to_string() }
}

/// Makes every word of the command line that `error` repeats short and harmless to a terminal.
fn make_short(error: &mut Error) {
    let parts: Vec<(ContextKind, ContextValue)> =
        error.context().map(|(kind, value)| (kind, value.clone())).collect();
    let repeated: Vec<&str> = parts
        .iter()
        .filter_map(|(_, value)| match value {
            ContextValue::String(text) => Some(text.as_str()),
            _ => None,
        })
        .filter(|text| short(text) != *text)
        .collect();
    // Sentences hold clap's own colours beside the words.
    let shortened =
        |sentence: String| repeated.iter().fold(sentence, |text, word| text.replace(word, &short(word)));
    for (kind, value) in &parts {
        let value = match value {
            ContextValue::String(text) => ContextValue::String(short(text)),
            ContextValue::Strings(texts) => {
                ContextValue::Strings(texts.iter().map(|text| short(text)).collect())
            }
            ContextValue::StyledStr(text) => {
                ContextValue::StyledStr(shortened(text.ansi().to_string()).into())
            }
            ContextValue::StyledStrs(texts) => {
                let texts = texts.iter().map(|text| shortened(text.ansi().to_string()).into());
                ContextValue::StyledStrs(texts.collect())
            }
            other => other.clone(),
        };
        error.insert(*kind, value);
    }
}

/// The option that stands before the word that begins with `value`, if it is one that wants a value; and the
/// word.
fn option_before<'a>(program: &Command, words: &'a [String], value: &str) -> Option<(&'a str, &'a str)> {
    fn wants_value(command: &Command, option: &str) -> bool {
        let takes = |arg: &clap::Arg| arg.get_long() == Some(option) && arg.get_action().takes_values();
        command.get_arguments().any(takes)
            || command.get_subcommands().any(|command| wants_value(command, option))
    }
    let at = words.iter().position(|word| word.starts_with(value))?;
    let before = words.get(at.checked_sub(1)?)?;
    wants_value(program, before.strip_prefix("--")?).then_some((before.as_str(), words[at].as_str()))
}
