//! Command lines that clap refuses, in words that help.

use clap::error::{ContextKind, ContextValue, Error};
use clap::{Command, Parser};

use crate::console::takes_sequences;

/// What clap and the standard library say, and what is said instead.
const PLAIN: [(&str, &str); 6] = [
    ("invalid digit found in string", "a whole number of at least 0 is accepted"),
    ("cannot parse integer from empty string", "a whole number of at least 0 is accepted"),
    ("number too large to fit in target type", "too large"),
    ("number too small to fit in target type", "too small"),
    ("invalid float literal", "a number is accepted"),
    ("cannot parse float from empty string", "a number is accepted"),
];

/// The command line as `P`.
///
/// # Errors
/// Clap's answer where it is refused, or where help or version are asked for.
pub(super) fn parse<P: Parser>() -> Result<P, Error> {
    command::<P>().try_get_matches().and_then(|matches| P::from_arg_matches(&matches))
}

/// The command of `P`, whose options take negative numbers: they are refused as values, not as options.
pub(super) fn command<P: Parser>() -> Command {
    fn with_negative_numbers(command: Command) -> Command {
        let is_option = |arg: &clap::Arg| arg.get_action().takes_values() && !arg.is_positional();
        command
            .mut_args(|arg| if is_option(&arg) { arg.allow_negative_numbers(true) } else { arg })
            .mut_subcommands(with_negative_numbers)
    }
    with_negative_numbers(P::command())
}

/// What is wrong with the command line of `P`; in colours where standard error is a terminal that takes them.
pub(super) fn text<P: Parser>(error: &Error) -> String {
    let rendered = error.render();
    let mut text = if takes_sequences() { rendered.ansi().to_string() } else { rendered.to_string() };
    for (jargon, plain) in PLAIN {
        text = text.replace(jargon, plain);
    }
    let words: Vec<String> = std::env::args_os().map(|word| word.to_string_lossy().into_owned()).collect();
    if let Some(ContextValue::String(value)) = error.get(ContextKind::InvalidArg)
        && let Some((option, word)) = option_before(&command::<P>(), &words, value)
    {
        // Clap's tip would make it a further argument.
        text = text.replace(&format!("-- {value}"), &format!("{option}={word}"));
    }
    text
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
