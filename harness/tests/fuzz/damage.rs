//! What happens to files: bytes lost, doubled, flipped; numbers and texts that nobody expects.

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::{Index, select};

/// One thing that happens to a file. Places are shares of its length.
#[derive(Clone, Debug)]
pub(crate) enum Damage {
    /// Everything from a place on is lost.
    Cut(Index),
    /// Some bytes are lost.
    Lose(Index, usize),
    /// Some bytes stand there twice.
    Repeat(Index, usize),
    /// Bytes stand there that do not belong there.
    Insert(Index, Vec<u8>),
    /// A bit is flipped.
    Flip(Index, u8),
    /// A number is another thing.
    Number(Index, String),
    /// A text in quotation marks is another thing.
    Text(Index, String),
    /// A line is lost.
    LoseLine(Index),
    /// A line stands in the place of another as well.
    CopyLine(Index, Index),
    /// A mark of UTF-8 stands before everything.
    Mark,
    /// Lines end as on other systems.
    Returns,
    /// Nothing is left of it.
    Replace(Vec<u8>),
}

/// One to three things that happen.
pub(crate) fn damages() -> impl Strategy<Value = Vec<Damage>> {
    vec(damage(), 1..4)
}

fn damage() -> impl Strategy<Value = Damage> {
    prop_oneof![
        2 => any::<Index>().prop_map(Damage::Cut),
        2 => (any::<Index>(), 1..40usize).prop_map(|(place, length)| Damage::Lose(place, length)),
        2 => (any::<Index>(), 1..200usize).prop_map(|(place, length)| Damage::Repeat(place, length)),
        2 => (any::<Index>(), vec(any::<u8>(), 1..20)).prop_map(|(place, bytes)| Damage::Insert(place, bytes)),
        3 => (any::<Index>(), 0..8u8).prop_map(|(place, bit)| Damage::Flip(place, bit)),
        8 => (any::<Index>(), value()).prop_map(|(place, value)| Damage::Number(place, value)),
        6 => (any::<Index>(), value()).prop_map(|(place, value)| Damage::Text(place, value)),
        2 => any::<Index>().prop_map(Damage::LoseLine),
        2 => (any::<Index>(), any::<Index>()).prop_map(|(from, to)| Damage::CopyLine(from, to)),
        1 => Just(Damage::Mark),
        1 => Just(Damage::Returns),
        1 => vec(any::<u8>(), 0..200).prop_map(Damage::Replace),
    ]
}

/// A value that nobody expects, as it stands in JSON or TOML.
pub(crate) fn value() -> impl Strategy<Value = String> + Clone {
    let strange = [
        "-1",
        "0",
        "-0.0",
        "1",
        "2",
        "3",
        "7",
        "0.5",
        "1e300",
        "-1e300",
        "1e999",
        "1e-320",
        "NaN",
        "nan",
        "inf",
        "Infinity",
        "1000000",
        "1000000000",
        "4294967295",
        "4294967296",
        "9223372036854775807",
        "-9223372036854775808",
        "18446744073709551615",
        "18446744073709551616",
        "99999999999999999999999999",
        "922337203685477581",
        "0x10",
        "1_000",
        "007",
        "true",
        "null",
        "[]",
        "{}",
        "[1, 2]",
        "\"\"",
        "\"x\"",
        "\"auto\"",
        "\"../../x\"",
        "\"/etc/passwd\"",
        "\"\\u0000\"",
        "\"\\u001b[31m\"",
        "\"\u{1b}[2J\"",
        "\"\u{202e}\"",
        "\"ünï\"",
        "1979-05-27",
        "",
    ];
    prop_oneof![
        20 => select(strange.to_vec()).prop_map(str::to_owned),
        1 => (1..40_000usize).prop_map(|depth| "[".repeat(depth)),
        1 => (1..2_000usize).prop_map(|depth| "{\"a\":".repeat(depth)),
        1 => (1..2_000usize).prop_map(|depth| "{a=".repeat(depth) + "1" + &"}".repeat(depth)),
        1 => (1..100_000usize).prop_map(|length| format!("\"{}\"", "long".repeat(length))),
        3 => any::<f64>().prop_map(|number| format!("{number:?}")),
        3 => any::<i64>().prop_map(|number| number.to_string()),
    ]
}

/// `bytes` after all of it happened.
pub(crate) fn damaged(bytes: &[u8], damages: &[Damage]) -> Vec<u8> {
    damages.iter().fold(bytes.to_vec(), |bytes, damage| damage.applied(bytes))
}

impl Damage {
    fn applied(&self, mut bytes: Vec<u8>) -> Vec<u8> {
        let length = bytes.len();
        if length == 0 {
            return match self {
                Self::Insert(_, inserted) | Self::Replace(inserted) => inserted.clone(),
                _ => bytes,
            };
        }
        match self {
            Self::Cut(place) => bytes.truncate(place.index(length)),
            Self::Lose(place, count) => {
                let from = place.index(length);
                drop(bytes.drain(from..length.min(from + count)));
            }
            Self::Repeat(place, count) => {
                let from = place.index(length);
                let again = bytes[from..length.min(from + count)].to_vec();
                drop(bytes.splice(from..from, again));
            }
            Self::Insert(place, inserted) => {
                let at = place.index(length);
                drop(bytes.splice(at..at, inserted.iter().copied()));
            }
            Self::Flip(place, bit) => bytes[place.index(length)] ^= 1 << bit,
            Self::Number(place, value) => replace_one(&mut bytes, *place, value, numbers),
            Self::Text(place, value) => replace_one(&mut bytes, *place, value, texts),
            Self::LoseLine(_) | Self::CopyLine(..) => return self.applied_to_lines(&bytes),
            Self::Mark => drop(bytes.splice(0..0, *b"\xef\xbb\xbf")),
            Self::Returns => {
                let ends = |byte: &u8| if *byte == b'\n' { b"\r\n".to_vec() } else { vec![*byte] };
                return bytes.iter().flat_map(ends).collect();
            }
            Self::Replace(other) => return other.clone(),
        }
        bytes
    }

    fn applied_to_lines(&self, bytes: &[u8]) -> Vec<u8> {
        let mut lines: Vec<&[u8]> = bytes.split_inclusive(|&byte| byte == b'\n').collect();
        match self {
            Self::LoseLine(line) => drop(lines.remove(line.index(lines.len()))),
            Self::CopyLine(from, to) => lines.insert(to.index(lines.len()), lines[from.index(lines.len())]),
            _ => {}
        }
        lines.concat()
    }
}

/// Replaces one of the `parts` of `bytes` by `value`.
fn replace_one(
    bytes: &mut Vec<u8>,
    place: Index,
    value: &str,
    parts: fn(&[u8]) -> Vec<std::ops::Range<usize>>,
) {
    let found = parts(bytes);
    if !found.is_empty() {
        drop(bytes.splice(found[place.index(found.len())].clone(), value.bytes()));
    }
}

/// Where numbers stand.
fn numbers(bytes: &[u8]) -> Vec<std::ops::Range<usize>> {
    let of_number = |byte: u8| byte.is_ascii_digit() || b".-+e".contains(&byte);
    let mut found = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        let end =
            bytes[at..].iter().position(|&byte| !of_number(byte)).map_or(bytes.len(), |length| at + length);
        if bytes[at..end].iter().any(u8::is_ascii_digit) {
            found.push(at..end);
        }
        at = end + 1;
    }
    found
}

/// Where texts in quotation marks stand, marks included.
fn texts(bytes: &[u8]) -> Vec<std::ops::Range<usize>> {
    let marks: Vec<usize> = (0..bytes.len()).filter(|&at| bytes[at] == b'"').collect();
    marks.chunks_exact(2).map(|pair| pair[0]..pair[1] + 1).collect()
}

#[test]
fn parts_are_found_and_damage_does_what_it_says() {
    let text = br#"{"a": -1.5e3, "b": "x9"}"#;
    let found = |parts: Vec<std::ops::Range<usize>>| -> Vec<String> {
        parts.into_iter().map(|part| String::from_utf8_lossy(&text[part]).into_owned()).collect()
    };
    assert_eq!(found(numbers(text)), ["-1.5e3", "9"]);
    assert_eq!(found(texts(text)), ["\"a\"", "\"b\"", "\"x9\""]);
    assert_eq!(damaged(b"a\nb\n", &[Damage::Returns, Damage::Mark]), b"\xef\xbb\xbfa\r\nb\r\n");
}
