//! How well a score tells two classes apart.

/// Area under the receiver operating characteristic of `scores` for the class `positive`, both `[n]`: the
/// probability that a random member of the class has a higher score than a random other one, ties one half
/// (Hanley and McNeil 1982). 1/2 for a score that knows nothing, 1 where the whole class lies above all
/// others. `None` unless both classes have members.
///
/// ```
/// // Of the 2 · 2 pairs the first member wins both, the second ties one and loses one.
/// let auc = reports::stats::auc(&[0.9, 0.3, 0.3, 0.5], &[true, true, false, false]);
/// assert_eq!(auc, Some(2.5 / 4.0));
/// ```
///
/// # Panics
/// If the slices differ in length.
pub fn auc(scores: &[f64], positive: &[bool]) -> Option<f64> {
    assert_eq!(scores.len(), positive.len(), "a class for every score");
    let mut sorted: Vec<(f64, bool)> = scores.iter().copied().zip(positive.iter().copied()).collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut below, mut won, mut members) = (0.0, 0.0, 0.0);
    for tied in sorted.chunk_by(|a, b| a.0 == b.0) {
        let inside = tied.iter().filter(|(_, positive)| *positive).count() as f64;
        let outside = tied.len() as f64 - inside;
        won += inside * (below + outside / 2.0);
        below += outside;
        members += inside;
    }
    (members > 0.0 && below > 0.0).then(|| won / (members * below))
}

#[cfg(test)]
mod tests {
    use super::auc;

    #[test]
    fn areas_by_hand() {
        let positive = [true, false, true, false, false];
        // The members, 5 and 2, against 3, 2 and 1: 3 won, then 1 lost, 1 tied, 1 won.
        assert_eq!(auc(&[5.0, 3.0, 2.0, 2.0, 1.0], &positive), Some(4.5 / 6.0));
        assert_eq!(auc(&[5.0, 3.0, 4.0, 2.0, 1.0], &positive), Some(1.0));
        assert_eq!(auc(&[1.0, 3.0, 0.0, 2.0, 4.0], &positive), Some(0.0));
        assert_eq!(auc(&[0.2; 5], &positive), Some(0.5));
        // Minus zero is zero.
        assert_eq!(auc(&[0.0, -0.0], &[true, false]), Some(0.5));
    }

    #[test]
    fn one_class_alone_has_no_area() {
        assert_eq!(auc(&[], &[]), None);
        assert_eq!(auc(&[1.0, 2.0], &[true, true]), None);
        assert_eq!(auc(&[1.0, 2.0], &[false, false]), None);
    }
}
