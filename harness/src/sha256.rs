//! Checksums of what runs are and recorded.

use sha2::{Digest, Sha256};

/// SHA-256 of `bytes`, in hex.
pub(crate) fn hex(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}
