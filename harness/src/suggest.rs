//! "Did you mean": the accepted name closest to a mistyped one.

/// The closest of `accepted`, if it is close enough to be a slip of the keyboard (edit distance at most a
/// third of the word, at least 2; a differing case or separator costs nothing).
pub fn closest<'a>(typed: &str, accepted: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let plain = |s: &str| s.to_lowercase().replace(['_', ' '], "-");
    let wanted = plain(typed);
    let limit = (wanted.chars().count() / 3).max(2);
    accepted
        .into_iter()
        .map(|name| (strsim::damerau_levenshtein(&wanted, &plain(name)), name))
        .filter(|(distance, _)| *distance <= limit)
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, name)| name)
}

/// The end of an error message about an unknown name: the suggestion, then everything accepted.
pub fn hint<'a>(typed: &str, accepted: impl IntoIterator<Item = &'a str> + Clone) -> String {
    let list = accepted.clone().into_iter().collect::<Vec<_>>().join(", ");
    match closest(typed, accepted) {
        Some(name) => format!("; did you mean `{name}`? Accepted: {list}"),
        None if list.is_empty() => "; there are none".into(),
        None => format!("; accepted: {list}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_is_recognised_and_a_stranger_is_not() {
        let names = ["teach", "her-iid", "her-iid-pool"];
        assert_eq!(closest("tech", names), Some("teach"));
        assert_eq!(closest("HER_IID", names), Some("her-iid"));
        assert_eq!(closest("procurl", names), None);
        assert_eq!(hint("tech", ["teach", "vds"]), "; did you mean `teach`? Accepted: teach, vds");
    }
}
