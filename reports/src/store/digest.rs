//! Checksums of what runs are and recorded.

use sha2::{Digest, Sha256};

/// SHA-256 of `bytes`, in hex.
///
/// ```
/// let digest = reports::store::digest::sha256(b"abc");
/// assert!(digest.starts_with("ba7816bf") && digest.len() == 64);
/// ```
pub fn sha256(bytes: &[u8]) -> String {
    hex::encode(Sha256::digest(bytes))
}
