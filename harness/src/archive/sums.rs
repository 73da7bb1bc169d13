//! Checksums in the format of `sha256sum`.

use std::collections::BTreeMap;
use std::io::{self, Read, Write};

use sha2::{Digest, Sha256};

use super::problem::ArchiveProblem;

/// SHA-256 of files by their names, in hex.
pub(super) type Sums = BTreeMap<String, String>;

/// A line for each file, by name.
pub(super) fn text(sums: &Sums) -> String {
    sums.iter().map(|(name, sum)| format!("{sum}  {name}\n")).collect()
}

/// Reads what [`text`] wrote.
///
/// # Errors
/// [`ArchiveProblem::Sums`] naming the first other line.
pub(super) fn parse(text: &str) -> Result<Sums, ArchiveProblem> {
    let mut sums = Sums::new();
    for (index, line) in text.lines().enumerate() {
        let wrong = || ArchiveProblem::Sums(index + 1);
        let (sum, name) = line.split_once("  ").ok_or_else(wrong)?;
        let is_hex = sum.len() == 64 && sum.bytes().all(|byte| byte.is_ascii_hexdigit());
        if !is_hex || sums.insert(name.to_owned(), sum.to_ascii_lowercase()).is_some() {
            return Err(wrong());
        }
    }
    Ok(sums)
}

/// Hands through what is written, and computes its SHA-256.
pub(super) struct Summing<W> {
    inner: W,
    hasher: Sha256,
}

impl<W> Summing<W> {
    pub(super) fn new(inner: W) -> Self {
        Self { inner, hasher: Sha256::new() }
    }

    /// The checksum of everything so far, in hex.
    pub(super) fn sum(self) -> String {
        hex(&self.hasher.finalize())
    }
}

impl<W: Write> Write for Summing<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.inner.write(bytes)?;
        self.hasher.update(&bytes[..count]);
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

impl<R: Read> Read for Summing<R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let count = self.inner.read(bytes)?;
        self.hasher.update(&bytes[..count]);
        Ok(count)
    }
}

/// The checksum of all that `reader` gives, in hex, and the number of bytes.
pub(super) fn of(reader: impl Read) -> io::Result<(String, u64)> {
    let mut reader = Summing::new(reader);
    let bytes = io::copy(&mut reader, &mut io::sink())?;
    Ok((reader.sum(), bytes))
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_are_read_back_and_other_lines_named() {
        let (sum, bytes) = of(&b"abc"[..]).unwrap();
        assert!(sum.starts_with("ba7816bf8f01cfea4141") && bytes == 3);
        let sums = Sums::from([("a b".to_owned(), sum.clone()), ("c".to_owned(), sum.clone())]);
        assert_eq!(parse(&text(&sums)).unwrap(), sums);
        for (wrong, line) in [("x", 1), ("abc  d", 1), (&*format!("{sum}  c\n{sum}  c\n"), 2)] {
            let error = parse(wrong).unwrap_err().to_string();
            assert!(error.starts_with(&format!("line {line} of its SHA256SUMS")), "{error}");
        }
    }
}
