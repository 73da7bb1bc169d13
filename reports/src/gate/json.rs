//! JSON that people review: a line per run.

use std::io::{self, Write};

use serde::Serialize;
use serde_json::Serializer;
use serde_json::ser::Formatter;

/// Objects nested deeper than this stand on one line, as arrays always do.
const DEPTH: usize = 4;

/// `value` with a line per key of its outer objects.
///
/// # Errors
/// If `value` has no JSON form.
pub(super) fn to_lines(value: &impl Serialize) -> serde_json::Result<String> {
    let mut bytes = Vec::new();
    value.serialize(&mut Serializer::with_formatter(&mut bytes, Lines::default()))?;
    bytes.push(b'\n');
    Ok(String::from_utf8(bytes).expect("serde_json writes UTF-8"))
}

#[derive(Default)]
struct Lines {
    depth: usize,
    /// Whether the object that was last begun or ended holds anything.
    filled: bool,
}

impl Lines {
    fn new_line<W: ?Sized + Write>(&self, writer: &mut W) -> io::Result<()> {
        write!(writer, "\n{:1$}", "", 2 * self.depth)
    }
}

impl Formatter for Lines {
    fn begin_array_value<W: ?Sized + Write>(&mut self, writer: &mut W, first: bool) -> io::Result<()> {
        writer.write_all(if first { b"" } else { b", " })
    }

    fn begin_object<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.depth += 1;
        self.filled = false;
        writer.write_all(b"{")
    }

    fn begin_object_key<W: ?Sized + Write>(&mut self, writer: &mut W, first: bool) -> io::Result<()> {
        self.filled = true;
        match (self.depth <= DEPTH, first) {
            (true, true) => self.new_line(writer),
            (true, false) => writer.write_all(b",").and_then(|()| self.new_line(writer)),
            (false, true) => Ok(()),
            (false, false) => writer.write_all(b", "),
        }
    }

    fn begin_object_value<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        writer.write_all(b": ")
    }

    fn end_object<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.depth -= 1;
        if self.filled && self.depth < DEPTH {
            self.new_line(writer)?;
        }
        // What surrounds it holds this object at least.
        self.filled = true;
        writer.write_all(b"}")
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::to_lines;

    #[test]
    fn outer_objects_have_a_line_per_key_and_inner_ones_a_line() {
        let value = json!({ "a": [1, 2], "b": {}, "c": { "d": { "e": { "0": { "x": 1, "y": [] } } } } });
        let text = to_lines(&value).expect("plain data");
        let expected = r#"{
  "a": [1, 2],
  "b": {},
  "c": {
    "d": {
      "e": {
        "0": {"x": 1, "y": []}
      }
    }
  }
}
"#;
        assert_eq!(text, expected);
        assert_eq!(serde_json::from_str::<serde_json::Value>(&text).expect("JSON"), value);
    }
}
