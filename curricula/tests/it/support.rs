//! What several tests here have in common.

use curricula::{CURRICULA, Entry};

/// The row of the teacher `id`.
pub(crate) fn entry(id: &str) -> &'static Entry {
    CURRICULA.iter().find(|entry| entry.id == id).expect("a registered teacher")
}

/// Whether two lists agree to within rounding.
pub(crate) fn close(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12)
}
