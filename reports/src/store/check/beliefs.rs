//! What a teacher can have believed.

use crate::schema::Beliefs;

/// The first thing about what a teacher believed of `size` goals that cannot be: the field, what it is and
/// what is accepted.
pub(super) fn misfit(beliefs: &Beliefs, size: u64) -> Option<(&'static str, String, &'static str)> {
    let Beliefs { success, scores } = beliefs;
    for (field, values) in [("beliefs.success", success), ("beliefs.scores", scores)] {
        let length = values.as_ref().map_or(size, |values| values.len() as u64);
        if length != size {
            return Some((field, format!("{length} long"), "an entry for every goal of the pool"));
        }
    }
    if let Some(odd) = success.iter().flatten().flatten().find(|value| !(0.0..=1.0).contains(*value)) {
        return Some(("beliefs.success", odd.to_string(), "numbers in [0, 1]"));
    }
    let odd = scores.iter().flatten().flatten().find(|value| !value.is_finite())?;
    Some(("beliefs.scores", odd.to_string(), "finite numbers"))
}
