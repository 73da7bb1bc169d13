//! Text of unknown origin for terminals and pages.
//!
//! Names of files, reasons and words of other programs may hold characters that a terminal obeys: to colour,
//! to erase, to type. They are written in JSON's notation, `\u001b`, so that a line of JSON stays one.

use std::borrow::Cow;

/// `text` with every control character shown; lines and tabs stay.
///
/// ```
/// assert_eq!(guard::text::shown("a\tb\n\u{1b}[31mred"), "a\tb\n\\u001b[31mred");
/// ```
pub fn shown(text: &str) -> Cow<'_, str> {
    escaped(text, |character| is_obeyed(character) && !matches!(character, '\n' | '\t'))
}

/// `text` as part of a single line: ends of lines and tabs are shown as well.
///
/// ```
/// assert_eq!(guard::text::in_line("a\nb"), "a\\u000ab");
/// ```
pub fn in_line(text: &str) -> Cow<'_, str> {
    escaped(text, is_obeyed)
}

/// The longest text that is repeated in a message, in characters.
const LONGEST: usize = 80;

/// `text` as it is repeated in a message: on one line, and cut where it is long.
///
/// ```
/// assert_eq!(guard::text::short("a\nb"), "a\\u000ab");
/// assert_eq!(guard::text::short(&"x".repeat(1000)), "x".repeat(80) + "…");
/// ```
pub fn short(text: &str) -> String {
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => in_line(&text[..end]).into_owned() + "…",
        None => in_line(text).into_owned(),
    }
}

fn escaped(text: &str, is_shown: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.contains(&is_shown) {
        return Cow::Borrowed(text);
    }
    let mut safe = String::with_capacity(text.len() + 8);
    for character in text.chars() {
        if is_shown(character) {
            safe.push_str(&format!("\\u{:04x}", u32::from(character)));
        } else {
            safe.push(character);
        }
    }
    Cow::Owned(safe)
}

/// Whether terminals or pages act on a character instead of showing it: control characters, ends of lines and
/// paragraphs, and those that turn the direction of the text after them.
fn is_obeyed(character: char) -> bool {
    let turns =
        matches!(character, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    character.is_control() || turns || matches!(character, '\u{2028}' | '\u{2029}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_terminal_obeys_is_shown_and_the_rest_stays() {
        assert!(matches!(shown("Füße, 手\n\tx"), Cow::Borrowed(_)));
        let text = "\r\u{0}\u{7}\u{1b}]0;t\u{7f}\u{9b}2J\u{202e}";
        assert_eq!(shown(text), "\\u000d\\u0000\\u0007\\u001b]0;t\\u007f\\u009b2J\\u202e");
        assert_eq!(in_line("a\n\tb"), "a\\u000a\\u0009b");
    }
}
