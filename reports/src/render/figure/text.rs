//! Text in figures: the font, its sizes, and how text is made to fit.

use std::sync::OnceLock;

use plotters::style::{BLACK, FontFamily, FontStyle, IntoFont, TextStyle, register_font};

use crate::error::ReportError;

/// The font that is measured here and embedded in PNGs; SVG viewers without it take their own sans-serif.
pub(super) const FAMILY: &str = "DejaVu Sans, sans-serif";

/// Pixels per typographic point (1/72 inch): figures are drawn for print at 300 pixels per inch.
const PIXELS_PER_POINT: f64 = 300.0 / 72.0;
/// plotters writes its font size divided by this as the SVG's `font-size`.
const PLOTTERS_FONT_SCALE: f64 = 1.24;

/// Makes the font known to plotters, once per process.
pub(super) fn register() -> Result<(), ReportError> {
    static REGISTERED: OnceLock<bool> = OnceLock::new();
    let registered =
        *REGISTERED.get_or_init(|| register_font(FAMILY, FontStyle::Normal, dejavu::sans::regular()).is_ok());
    if registered { Ok(()) } else { Err(ReportError::figure("text")("the embedded font is damaged")) }
}

/// Black text of so many typographic points.
pub(super) fn style(points: f64) -> TextStyle<'static> {
    let size = points * PIXELS_PER_POINT * PLOTTERS_FONT_SCALE;
    (FontFamily::Name(FAMILY), size).into_font().color(&BLACK)
}

/// Width of a line of text in pixels. [`register`] comes first.
pub(super) fn width(text: &str, style: &TextStyle<'_>) -> Result<i32, ReportError> {
    let (width, _) = style.font.box_size(text).map_err(ReportError::figure("text"))?;
    // plotters measures at the size that it divides by `PLOTTERS_FONT_SCALE` when it writes.
    Ok((f64::from(width) / PLOTTERS_FONT_SCALE * LINE_HEIGHT_PER_EM).ceil() as i32)
}

/// ab_glyph scales fonts to their line height, SVG to their em square; this is DejaVu Sans's ratio of the
/// two.
const LINE_HEIGHT_PER_EM: f64 = 0.928 + 0.236;

/// `text` without control characters and noncharacters, which XML forbids.
pub(super) fn printable(text: &str) -> String {
    let forbidden = |c: char| c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}');
    text.chars().map(|c| if forbidden(c) { char::REPLACEMENT_CHARACTER } else { c }).collect()
}

/// `text`, with its middle replaced by an ellipsis where it is wider than `max` pixels. Start and end stay:
/// the ends of names (variants, numbers) often tell them apart.
pub(super) fn shorten(text: &str, style: &TextStyle<'_>, max: i32) -> Result<String, ReportError> {
    let text = printable(text);
    if width(&text, style)? <= max {
        return Ok(text);
    }
    let chars: Vec<char> = text.chars().collect();
    let short = |kept: usize| -> String {
        let head = &chars[..kept.div_ceil(2)];
        let tail = &chars[chars.len() - kept / 2..];
        head.iter().chain(&['…']).chain(tail).collect()
    };
    // Widths grow with the characters kept, so the most that fit can be bisected.
    let (mut fits, mut too_many) = (0, chars.len());
    while too_many - fits > 1 {
        let kept = fits.midpoint(too_many);
        if width(&short(kept), style)? <= max { fits = kept } else { too_many = kept }
    }
    Ok(short(fits))
}

/// `text` broken at spaces into lines of at most `max` pixels; a longer word keeps a line of its own.
pub(super) fn wrap(text: &str, style: &TextStyle<'_>, max: i32) -> Result<Vec<String>, ReportError> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ') {
        match lines.last_mut() {
            Some(line) if width(&format!("{line} {word}"), style)? <= max => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    Ok(lines)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_names_keep_both_ends_and_fit() {
        register().unwrap();
        let style = style(7.0);
        let name = "curriculum-with-a-name-that-nobody-would-type-twice (n = 20)";
        let short = shorten(name, &style, 300).unwrap();
        assert!(width(&short, &style).unwrap() <= 300);
        assert!(short.starts_with("curr") && short.ends_with("20)") && short.contains('…'), "{short}");
        assert_eq!(shorten("NOVA", &style, 300).unwrap(), "NOVA");
    }

    #[test]
    fn wrapped_lines_fit_and_keep_every_word() {
        register().unwrap();
        let style = style(6.0);
        let text = "mean ± std over 7 seeds (ddof = 1), 20-episode evaluations";
        let lines = wrap(text, &style, 400).unwrap();
        assert!(lines.len() > 1);
        for line in &lines {
            assert!(width(line, &style).unwrap() <= 400, "{line}");
        }
        assert_eq!(lines.join(" "), text);
    }

    #[test]
    fn control_characters_are_replaced() {
        assert_eq!(printable("a\u{0}b\nc"), "a\u{fffd}b\u{fffd}c");
    }
}
