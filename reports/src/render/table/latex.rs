//! Tables in LaTeX, in the style of the package `booktabs`.

use super::{Align, Table};

/// Rows that a page holds: a longer table is one that goes on over pages.
const LONGEST: usize = 40;
/// The same of rows with prose in them, which take several lines each.
const LONGEST_PROSE: usize = 20;
/// Widest column of prose, and all of them together, in widths of a line.
const PROSE_WIDTH: (f64, f64) = (0.22, 0.6);

impl Table {
    /// A `tabular`, or a `longtable` where it is longer than a page; the caption is a comment above it, to be
    /// copied into the float that a paper wants.
    pub fn latex(&self) -> String {
        let has_prose = (0..self.columns.len()).any(|column| self.is_prose(column));
        let is_long = self.rows.len() > if has_prose { LONGEST_PROSE } else { LONGEST };
        let environment = if is_long { "longtable" } else { "tabular" };
        // A comment ends with its line, which a name must not do.
        let caption: String = self.caption.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
        let mut text = format!(
            "% {caption}\n% Needs \\usepackage{{array,booktabs,longtable}}; a longtable settles in the second run.\n\\begin{{{environment}}}{{{}}}\n\\toprule\n",
            self.column_types(),
        );
        text += &line(self.columns.iter().map(|(title, _)| escape(title)));
        text += if is_long { "\\midrule\n\\endhead\n\\bottomrule\n\\endfoot\n" } else { "\\midrule\n" };
        for row in &self.rows {
            let line = line(row.iter().map(|cell| escape(cell)));
            // At the start of a row `[` and `*` would be read as arguments of the `\\` before it.
            text += if line.starts_with(['[', '*']) { "{}" } else { "" };
            text += &line;
        }
        text += if is_long { "" } else { "\\bottomrule\n" };
        text + &format!("\\end{{{environment}}}\n")
    }

    fn column_types(&self) -> String {
        let prose = (0..self.columns.len()).filter(|&column| self.is_prose(column)).count();
        let column_type = |(column, &(_, align)): (usize, &(&str, Align))| match align {
            Align::Text if self.is_prose(column) => {
                let width = PROSE_WIDTH.0.min(PROSE_WIDTH.1 / prose as f64);
                format!(">{{\\raggedright\\arraybackslash}}p{{{width:.2}\\linewidth}}")
            }
            Align::Text => "l".to_owned(),
            Align::Number => "r".to_owned(),
        };
        self.columns.iter().enumerate().map(column_type).collect()
    }
}

fn line(cells: impl Iterator<Item = String>) -> String {
    format!("{} \\\\\n", cells.collect::<Vec<_>>().join(" & "))
}

/// Plain text in LaTeX; the signs of our own cells become commands that every engine knows.
fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    let mut before = ' ';
    let mut rest = text.chars().peekable();
    while let Some(c) = rest.next() {
        match c {
            '&' | '%' | '$' | '#' | '_' | '{' | '}' => escaped.extend(['\\', c]),
            '\\' => escaped.push_str("\\textbackslash{}"),
            '~' => escaped.push_str("\\textasciitilde{}"),
            '^' => escaped.push_str("\\textasciicircum{}"),
            '<' => escaped.push_str("$<$"),
            '>' => escaped.push_str("$>$"),
            '|' => escaped.push_str("\\textbar{}"),
            '±' => escaped.push_str("$\\pm$"),
            'Δ' => escaped.push_str("$\\Delta$"),
            'β' => escaped.push_str("$\\beta$"),
            'γ' => escaped.push_str("$\\gamma$"),
            'η' => escaped.push_str("$\\eta$"),
            '≤' => escaped.push_str("$\\le$"),
            '−' => escaped.push_str("$-$"),
            '–' => escaped.push_str("--"),
            // A sign, not a hyphen.
            '-' if " [".contains(before) && rest.peek().is_some_and(char::is_ascii_digit) => {
                escaped.push_str("$-$")
            }
            c if c.is_control() => escaped.push('?'),
            c => escaped.push(c),
        }
        before = c;
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(rows: &[&str]) -> Table {
        Table {
            caption: "What 50 % means.".into(),
            columns: vec![("Name", Align::Text), ("Value", Align::Number)],
            rows: rows.iter().map(|&name| vec![name.to_owned(), "-0.50 ± 0.10".to_owned()]).collect(),
        }
    }

    #[test]
    fn names_are_escaped_and_numbers_have_signs() {
        let text = table(&["a|b_<i>-3"]).latex();
        assert!(text.contains("\\midrule\na\\textbar{}b\\_$<$i$>$-3 & $-$0.50 $\\pm$ 0.10 \\\\\n"), "{text}");
        assert_eq!(escape("[-0.1, -0.2] n-1 100 %\u{7}"), "[$-$0.1, $-$0.2] n-1 100 \\%?");
        assert_eq!(escape("Δβγη"), "$\\Delta$$\\beta$$\\gamma$$\\eta$");
    }

    #[test]
    fn a_row_is_no_argument_of_the_one_before() {
        let text = table(&["[a]"]).latex();
        assert!(text.contains("\\midrule\n{}[a] & "), "{text}");
    }

    #[test]
    fn a_caption_stays_a_comment() {
        let table = Table { caption: "a\nb".into(), ..table(&[]) };
        assert!(table.latex().starts_with("% a b\n% Needs"));
    }

    #[test]
    fn prose_is_broken_into_lines_and_long_tables_into_pages() {
        let prose = "a sentence that is too long for a name";
        assert!(
            table(&[prose])
                .latex()
                .contains("\\begin{tabular}{>{\\raggedright\\arraybackslash}p{0.22\\linewidth}r}")
        );
        let long = table(&["a"; LONGEST + 1]).latex();
        assert!(long.contains("\\begin{longtable}{lr}") && long.ends_with("\\end{longtable}\n"), "{long}");
        assert!(table(&["a"; LONGEST]).latex().contains("\\begin{tabular}{lr}"));
        assert!(table(&[prose; LONGEST_PROSE]).latex().contains("\\begin{tabular}{>"));
        assert!(table(&[prose; LONGEST_PROSE + 1]).latex().contains("\\begin{longtable}{>"));
    }
}
