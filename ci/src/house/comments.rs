//! Comments are no wider than code.

use super::{Finding, Source};

const RULE: &str = "a comment is no wider than rustfmt's max_width, in characters";

/// `max_width` in the text of rustfmt's configuration.
pub(crate) fn max_width(configuration: &str) -> Option<usize> {
    configuration.lines().find_map(|line| line.strip_prefix("max_width = ")?.trim().parse().ok())
}

/// The comment lines (`//`, `///` and `//!`) with more than `width` characters.
pub(crate) fn too_wide(source: &Source, width: usize) -> Vec<Finding> {
    let finding = |(line, text): (usize, &str)| {
        let characters = text.chars().count();
        let comment = text.trim_start().starts_with("//");
        (comment && characters > width).then(|| Finding {
            rule: RULE,
            file: source.file.clone(),
            line,
            what: format!("{characters} characters"),
        })
    };
    source.lines().filter_map(finding).collect()
}

#[cfg(test)]
mod tests {
    use super::{Source, max_width, too_wide};

    #[test]
    fn the_width_is_read_from_the_configuration() {
        assert_eq!(max_width("max_width = 110\nuse_small_heuristics = \"Max\"\n"), Some(110));
        assert_eq!(max_width("hard_tabs = true\n"), None);
    }

    #[test]
    fn characters_of_comments_are_counted_with_their_indentation() {
        let text = "let wide_code = 1;\n    // πππ\n//! ππππ\n";
        let source = Source { file: "a.rs".into(), text: text.into() };
        assert!(too_wide(&source, 10).is_empty(), "10 characters, 13 bytes");
        let lines: Vec<usize> = too_wide(&source, 8).iter().map(|finding| finding.line).collect();
        assert_eq!(lines, [2]);
    }
}
