//! A line of progress that fits the terminal: the narrower it is, the less the line tells.

use std::time::Duration;

use console::{measure_text_width, pad_str};

use crate::pace;

/// What there is to show of a run, or of all.
pub(super) struct Row<'a> {
    pub(super) name: &'a str,
    /// Share of the steps that are taken, in [0, 1].
    pub(super) share: f64,
    /// `STEP/STEPS` or `ENDED/ALL runs`.
    pub(super) count: String,
    pub(super) success: Option<f64>,
    pub(super) steps_per_s: Option<f64>,
    pub(super) left: Option<Duration>,
}

/// A part of a line after the name, always as wide.
#[derive(Clone, Copy)]
enum Part {
    Bar,
    Count,
    Success,
    Speed,
    Left,
    Percent,
    /// [`Success`](Part::Success) and [`Left`](Part::Left) without words.
    BareSuccess,
    BareLeft,
}

/// What lines consist of after the name, the fullest first, with the columns that the name must keep.
const LAYOUTS: &[(usize, &[Part])] = &[
    (26, &[Part::Bar, Part::Count, Part::Success, Part::Speed, Part::Left]),
    (26, &[Part::Count, Part::Success, Part::Speed, Part::Left]),
    (26, &[Part::Count, Part::Success, Part::Left]),
    (12, &[Part::Percent, Part::BareSuccess, Part::BareLeft]),
    (0, &[Part::Percent]),
];

/// Columns that no name needs.
const WIDEST_NAME: usize = 64;
/// Columns of the bar.
const BAR: usize = 20;

impl Part {
    fn columns(self) -> usize {
        match self {
            Self::Bar => BAR,
            Self::Count => 17,
            Self::Success => 12,
            Self::Speed => 13,
            Self::Left => 12,
            Self::Percent => 5,
            Self::BareSuccess => 4,
            Self::BareLeft => 7,
        }
    }

    fn text(self, row: &Row<'_>) -> String {
        let left = row.left.map(pace::human);
        let text = match self {
            Self::Bar => Some(bar(row.share)),
            Self::Count => Some(row.count.clone()),
            Self::Success => row.success.map(|rate| format!("success {rate:.2}")),
            Self::Speed => row.steps_per_s.map(|speed| format!("{} steps/s", pace::rounded(speed))),
            Self::Left => left.map(|left| format!("{left} left")),
            // Rounded down: 100 % is the end alone.
            Self::Percent => Some(format!("{} %", (100.0 * row.share) as u64)),
            Self::BareSuccess => row.success.map(|rate| format!("{rate:.2}")),
            Self::BareLeft => left,
        };
        let text = text.unwrap_or_default();
        // A number that is wider than any foreseen is left out rather than cut.
        let text = if text.len() > self.columns() { String::new() } else { text };
        format!("{text:>0$}", self.columns())
    }
}

impl Row<'_> {
    /// The line, of at most `columns` columns.
    pub(super) fn fit(&self, columns: usize) -> String {
        let wide = |parts: &[Part]| parts.iter().map(|part| 1 + part.columns()).sum::<usize>();
        let fits = |(name, parts): &&(usize, &[Part])| name + wide(parts) <= columns;
        let (_, parts) = LAYOUTS.iter().find(fits).copied().unwrap_or_default();
        let rest = columns.saturating_sub(wide(parts)).min(WIDEST_NAME);
        let mut line = pad_str(&end_of(self.name, rest), rest, console::Alignment::Left, None).into_owned();
        for part in parts {
            line.push(' ');
            line += &part.text(self);
        }
        line
    }
}

fn bar(share: f64) -> String {
    let full = (share * BAR as f64) as usize;
    let head = if full < BAR { ">" } else { "" };
    format!("{:<BAR$}", "=".repeat(full) + head)
}

/// The end of a text, which tells runs apart, with an ellipsis where its beginning does not fit.
fn end_of(text: &str, columns: usize) -> String {
    if measure_text_width(text) <= columns {
        return text.to_owned();
    }
    let mut ends = text.char_indices().map(|(at, _)| &text[at..]);
    let end = ends.find(|end| measure_text_width(end) < columns).unwrap_or_default();
    if columns == 0 { String::new() } else { format!("…{end}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(name: &str) -> Row<'_> {
        Row {
            name,
            share: 0.999,
            count: "400000/1000000000".to_owned(),
            success: Some(0.25),
            steps_per_s: Some(1234.5),
            left: Some(Duration::from_secs(3900)),
        }
    }

    #[test]
    fn no_line_is_wider_than_its_terminal() {
        let names =
            ["MazeA/teach/default/seed-0", "Hand/迷宫迷宫迷宫迷宫迷宫迷宫迷宫迷宫/teach/default/seed-12", ""];
        for columns in 0..=220 {
            for name in names {
                let line = row(name).fit(columns);
                assert!(measure_text_width(&line) <= columns, "{columns}: {line}");
            }
        }
    }

    #[test]
    fn a_narrower_terminal_shows_less() {
        let name = "HandManipulateBlockRotateParallel/her-iid-pool/default/seed-0";
        let line = |columns| row(name).fit(columns).trim_end().to_owned();
        assert_eq!(
            line(199),
            "HandManipulateBlockRotateParallel/her-iid-pool/default/seed-0    ===================> 400000/1000000000 \
             success 0.25  1234 steps/s  1h 05m left"
        );
        assert_eq!(
            line(79),
            "…rallel/her-iid-pool/default/seed-0 400000/1000000000 success 0.25  1h 05m left"
        );
        assert_eq!(line(59), "…ateParallel/her-iid-pool/default/seed-0  99 % 0.25  1h 05m");
        assert_eq!(line(39), "…pool/default/seed-0  99 % 0.25  1h 05m");
        assert_eq!(line(12), "…eed-0  99 %");
    }

    #[test]
    fn a_full_bar_has_no_head() {
        assert_eq!([bar(0.0), bar(0.5), bar(1.0)].map(|bar| bar.trim_end().len()), [1, 11, 20]);
    }
}
