//! Methods as figures and tables know them: their titles, order and looks.

use std::cmp::Ordering;

use looks::Look;

/// How a report shows a method.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MethodInfo {
    /// Curriculum id, as in records.
    pub id: String,
    /// Name in figures and tables.
    pub title: String,
    /// How its curves are drawn; `None`: in a look that is free.
    pub look: Option<Look>,
    /// The archive that its runs come from; `None`: the results themselves.
    pub origin: Option<String>,
    /// Place in legends and tables.
    rank: usize,
}

impl MethodInfo {
    /// A method that comes after all that a catalogue has.
    pub fn new(id: impl Into<String>, title: impl Into<String>, look: Option<Look>) -> Self {
        Self { id: id.into(), title: title.into(), look, origin: None, rank: usize::MAX }
    }

    /// The method as runs of the archive `origin` have it, under the curriculum id `id`, with the same look.
    pub(super) fn of_guest(&self, id: &str, origin: &str) -> Self {
        let title = format!("{} [{origin}]", self.title);
        Self { id: id.to_owned(), title, origin: Some(origin.to_owned()), ..self.clone() }
    }

    /// The same under the name that a user gave it.
    pub(super) fn titled(&self, title: &str) -> Self {
        let marked = |origin: &String| format!("{title} [{origin}]");
        let title = self.origin.as_ref().map_or_else(|| title.to_owned(), marked);
        Self { title, ..self.clone() }
    }

    /// Its id where it was run: without what [`of_guest`](Self::of_guest) added.
    pub(super) fn own_id(&self) -> &str {
        let added = self.origin.as_ref().and_then(|origin| self.id.strip_suffix(origin.as_str()));
        added.and_then(|id| id.strip_suffix('@')).unwrap_or(&self.id)
    }

    pub(super) fn ranked(self, rank: usize) -> Self {
        Self { rank, ..self }
    }
}

/// Order of legends and tables: methods of a catalogue as they stand there, then the others by id; at the end
/// those of archives.
impl Ord for MethodInfo {
    fn cmp(&self, other: &Self) -> Ordering {
        let is_guest = |method: &Self| method.origin.is_some();
        (is_guest(self).cmp(&is_guest(other)))
            .then_with(|| self.rank.cmp(&other.rank))
            .then_with(|| natural_order(&self.id, &other.id))
    }
}

impl PartialOrd for MethodInfo {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// Order in which `n=3` comes before `n=10`: runs of digits compare as numbers, everything else byte by byte.
pub fn natural_order(a: &str, b: &str) -> Ordering {
    let (mut left, mut right) = (a, b);
    while let (Some(x), Some(y)) = (left.chars().next(), right.chars().next()) {
        if x.is_ascii_digit() && y.is_ascii_digit() {
            let (x, rest_x) = split_number(left);
            let (y, rest_y) = split_number(right);
            // Without leading zeros, the longer number is the larger one.
            let order = x.len().cmp(&y.len()).then_with(|| x.cmp(y));
            if order != Ordering::Equal {
                return order;
            }
            (left, right) = (rest_x, rest_y);
        } else if x != y {
            return x.cmp(&y);
        } else {
            (left, right) = (&left[x.len_utf8()..], &right[y.len_utf8()..]);
        }
    }
    // `01` and `1` are equal as numbers but are different names.
    left.len().cmp(&right.len()).then_with(|| a.cmp(b))
}

/// The digits at the start, without leading zeros, and what follows them.
fn split_number(text: &str) -> (&str, &str) {
    let end = text.find(|c: char| !c.is_ascii_digit()).unwrap_or(text.len());
    (text[..end].trim_start_matches('0'), &text[end..])
}

#[cfg(test)]
mod tests {
    use super::super::Catalogue;
    use super::*;

    #[test]
    fn numbers_in_names_compare_as_numbers() {
        let mut names = ["n=20", "n=3", "n=10", "n=3b", "n", "m=5"];
        names.sort_by(|a, b| natural_order(a, b));
        assert_eq!(names, ["m=5", "n", "n=3", "n=3b", "n=10", "n=20"]);
        assert_ne!(natural_order("n=01", "n=1"), Ordering::Equal);
    }

    #[test]
    fn unknown_methods_come_last() {
        let catalogue = Catalogue::of(
            [("nova", "NOVA"), ("dull", "Dull")].map(|(id, title)| MethodInfo::new(id, title, None)),
        );
        let mut methods = ["zeta", "dull", "alpha", "nova"].map(|id| catalogue.method(id));
        methods.sort();
        assert_eq!(methods.each_ref().map(|method| method.title.as_str()), ["NOVA", "Dull", "alpha", "zeta"]);
    }
}
