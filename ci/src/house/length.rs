//! Files are short.

use super::{Finding, Source};

const RULE: &str = "a Rust file has at most 400 lines";

const MOST: usize = 400;

/// The file, if it is too long.
pub(crate) fn too_long(source: &Source) -> Option<Finding> {
    let lines = source.text.lines().count();
    (lines > MOST).then(|| Finding {
        rule: RULE,
        file: source.file.clone(),
        line: MOST + 1,
        what: format!("{lines} lines"),
    })
}

#[cfg(test)]
mod tests {
    use super::{MOST, Source, too_long};

    #[test]
    fn the_first_line_too_many_is_named() {
        let of = |lines| too_long(&Source { file: "a.rs".into(), text: "//\n".repeat(lines) });
        assert_eq!(of(MOST), None);
        assert_eq!(of(402).unwrap().to_string(), "a.rs:401: 402 lines (a Rust file has at most 400 lines)");
    }
}
