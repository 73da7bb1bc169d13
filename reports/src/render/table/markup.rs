//! One table in Markdown and HTML, and [in LaTeX](super::latex). Names in it are plain text: each markup
//! escapes them its own way.

/// How the cells of a column are set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Align {
    /// Names and prose, at the left.
    Text,
    /// Numbers, at the right.
    Number,
}

/// Longest name, in characters: a longer text in a column of text is prose.
const LONGEST_NAME: usize = 30;

/// A table to read: cells of plain text below a caption that says how its numbers were made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Table {
    /// What the numbers are.
    pub caption: String,
    /// Title and alignment of each column.
    pub columns: Vec<(&'static str, Align)>,
    /// Shape: `[rows, columns]`.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// The rows whose first cell is `name`, without that cell; below the same caption.
    pub fn part(&self, name: &str) -> Self {
        let of_it = |row: &&Vec<String>| row.first().is_some_and(|first| first == name);
        let rest = |row: &Vec<String>| row.iter().skip(1).cloned().collect();
        Self {
            caption: self.caption.clone(),
            columns: self.columns.iter().skip(1).copied().collect(),
            rows: self.rows.iter().filter(of_it).map(rest).collect(),
        }
    }

    /// Caption and table in Markdown.
    pub fn markdown(&self) -> String {
        let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
        let rule = |align| if align == Align::Text { "---" } else { "---:" };
        let mut text = format!("{}\n\n", markdown_escape(&self.caption));
        text += &line(self.columns.iter().map(|(title, _)| (*title).to_owned()).collect());
        text += &line(self.columns.iter().map(|&(_, align)| rule(align).to_owned()).collect());
        for row in &self.rows {
            // Numbers are ours: brackets of intervals need no escape.
            let cell = |(cell, &(_, align)): (&String, &(_, Align))| {
                if align == Align::Text { markdown_escape(cell) } else { cell.clone() }
            };
            text += &line(row.iter().zip(&self.columns).map(cell).collect());
        }
        text
    }

    /// An HTML `table`, its caption below.
    pub fn html(&self) -> String {
        let class = |align| if align == Align::Text { "text" } else { "number" };
        // Narrow screens show a row as a card, each cell beside its title.
        let label = |title| format!(" data-title=\"{}\"", html_escape(title));
        let mut text = "<figure class=\"table\"><div class=\"scroll\"><table>\n<thead><tr>".to_owned();
        for (title, align) in &self.columns {
            text += &format!("<th scope=\"col\" class=\"{}\">{}</th>", class(*align), html_escape(title));
        }
        text += "</tr></thead>\n<tbody>\n";
        for row in &self.rows {
            text += "<tr>";
            for (cell, (title, align)) in row.iter().zip(&self.columns) {
                text +=
                    &format!("<td class=\"{}\"{}>{}</td>", class(*align), label(title), html_escape(cell));
            }
            text += "</tr>\n";
        }
        text += "</tbody></table></div>";
        if !self.caption.is_empty() {
            text += &format!("<figcaption>{}</figcaption>", html_escape(&self.caption));
        }
        text += "</figure>\n";
        text
    }

    /// Whether a column holds prose, which may be broken into lines: a text longer than [`LONGEST_NAME`]
    /// characters.
    pub(super) fn is_prose(&self, column: usize) -> bool {
        let is_long = |row: &Vec<String>| row[column].chars().count() > LONGEST_NAME;
        self.columns[column].1 == Align::Text && self.rows.iter().any(is_long)
    }
}

/// Plain text in Markdown.
pub fn markdown_escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            c if c.is_control() => escaped.push(char::REPLACEMENT_CHARACTER),
            '\\' | '`' | '*' | '_' | '[' | ']' | '<' | '>' | '|' | '#' | '&' | '~' => {
                escaped.extend(['\\', c])
            }
            c => escaped.push(c),
        }
    }
    escaped
}

/// Plain text in HTML, in attributes too.
pub fn html_escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            '\n' => escaped.push('\n'),
            c if c.is_control() => escaped.push(char::REPLACEMENT_CHARACTER),
            c => escaped.push(c),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> Table {
        Table {
            caption: "What 50 % means.".into(),
            columns: vec![("Name", Align::Text), ("Value", Align::Number)],
            rows: vec![vec!["a|b_<i>".to_owned(), "0.50 ± 0.10".to_owned()]],
        }
    }

    #[test]
    fn names_cannot_break_a_table() {
        let table = table();
        assert!(table.markdown().ends_with("| --- | ---: |\n| a\\|b\\_\\<i\\> | 0.50 ± 0.10 |\n"));
        assert!(table.html().contains("<td class=\"text\" data-title=\"Name\">a|b_&lt;i&gt;</td>"));
        assert_eq!(markdown_escape("a|b\n*c*"), "a\\|b\u{fffd}\\*c\\*");
        assert_eq!(html_escape("\"'&\u{7}"), "&quot;&#39;&amp;\u{fffd}");
    }
}
