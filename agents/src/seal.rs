//! Bytes that say what they are and whether they are whole.

use serde::Serialize;
use serde::de::DeserializeOwned;

/// A kind of saved state: a header of magic number, version and CRC-32 before the value in postcard's format.
///
/// ```
/// use agents::Seal;
///
/// const SEAL: Seal = Seal { magic: *b"GBEX", version: 1, what: "an example" };
/// let bytes = SEAL.close(&[1.0, 2.0]);
/// assert_eq!(SEAL.open::<[f64; 2]>(&bytes), Ok([1.0, 2.0]));
/// assert!(SEAL.open::<[f64; 2]>(&bytes[..20]).is_err());
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Seal {
    /// The first four bytes.
    pub magic: [u8; 4],
    /// Version of the value's layout, raised whenever it changes.
    pub version: u32,
    /// What it is, in error messages: `a checkpoint`.
    pub what: &'static str,
}

/// What is wrong with bytes that should be a value under a [`Seal`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SealError {
    /// Not even the header is whole.
    #[error("only {0} bytes long")]
    Short(usize),
    /// The magic number is another.
    #[error("not {what}")]
    Other {
        /// What was expected.
        what: &'static str,
    },
    /// The version is another.
    #[error("{what} of version {found}; this program reads version {own}")]
    Version {
        /// What it is.
        what: &'static str,
        /// Version of the bytes.
        found: u32,
        /// Version that this program writes and reads.
        own: u32,
    },
    /// The value was cut off or altered.
    #[error("its checksum does not fit: it was cut off or altered")]
    Checksum,
    /// The value is whole, but of another type.
    #[error(transparent)]
    Format(#[from] postcard::Error),
}

/// Bytes of the header.
const HEADER: usize = 12;

impl Seal {
    /// `value` as bytes.
    ///
    /// # Panics
    /// If `value` cannot be serialised: plain data can.
    pub fn close(&self, value: &impl Serialize) -> Vec<u8> {
        let payload = postcard::to_stdvec(value).expect("plain data in memory always serialises");
        let mut bytes = Vec::with_capacity(HEADER + payload.len());
        bytes.extend_from_slice(&self.magic);
        bytes.extend_from_slice(&self.version.to_le_bytes());
        bytes.extend_from_slice(&crc32fast::hash(&payload).to_le_bytes());
        bytes.extend_from_slice(&payload);
        bytes
    }

    /// The value that [`Seal::close`] was given.
    ///
    /// # Errors
    /// [`SealError`] if the bytes are something else, of another version, cut off or altered.
    pub fn open<T: DeserializeOwned>(&self, bytes: &[u8]) -> Result<T, SealError> {
        let word = |at: usize| bytes.get(at..at + 4).map(|b| [b[0], b[1], b[2], b[3]]);
        let (Some(magic), Some(version), Some(crc)) = (word(0), word(4), word(8)) else {
            return Err(SealError::Short(bytes.len()));
        };
        if magic != self.magic {
            return Err(SealError::Other { what: self.what });
        }
        let found = u32::from_le_bytes(version);
        if found != self.version {
            return Err(SealError::Version { what: self.what, found, own: self.version });
        }
        let payload = &bytes[HEADER..];
        if crc32fast::hash(payload) != u32::from_le_bytes(crc) {
            return Err(SealError::Checksum);
        }
        Ok(postcard::from_bytes(payload)?)
    }
}

#[cfg(test)]
mod tests {
    use super::Seal;

    const SEAL: Seal = Seal { magic: *b"TEST", version: 3, what: "a test" };

    #[test]
    fn what_is_closed_can_be_opened_and_damage_is_named() {
        let bytes = SEAL.close(&(7u32, "seven"));
        assert_eq!(SEAL.open::<(u32, String)>(&bytes), Ok((7, "seven".to_owned())));
        let refusal = |bytes: &[u8]| SEAL.open::<(u32, String)>(bytes).unwrap_err().to_string();
        for place in 12..bytes.len() {
            let mut altered = bytes.clone();
            altered[place] ^= 1;
            assert!(refusal(&altered).contains("checksum"), "byte {place}");
            assert!(refusal(&bytes[..place]).contains("checksum"), "{place} bytes");
        }
        assert_eq!(refusal(&bytes[..11]), "only 11 bytes long");
        assert_eq!(refusal(b"nonsense, and long"), "not a test");
        let newer = Seal { version: 4, ..SEAL }.close(&(7u32, "seven"));
        assert_eq!(refusal(&newer), "a test of version 4; this program reads version 3");
    }
}
