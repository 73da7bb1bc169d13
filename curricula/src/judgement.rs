//! What a teacher believes of the goals of its pool.

/// What a teacher believes of every goal of the pool; one that asks the student did so when it last proposed.
/// Instruments set it against what the student can really do; nobody else hears of it.
///
/// ```
/// use curricula::testing::Class;
///
/// // The student's confidence in goal i is -25 i, and no return is below -50.
/// let mut class = Class::new("procurl", "", 3, |goal, _steps| -25.0 * goal as f64);
/// class.cycles(1);
/// let judgement = class.teacher.judge(&class.student);
/// assert_eq!(judgement.success, Some(vec![1.0, 0.5, 0.0]));
/// assert_eq!(judgement.scores, Some(vec![0.0, 0.25, 0.0]));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Judgement {
    /// How likely it takes the student to succeed at each goal, `[N]`, in [0, 1]; `None` for a teacher that
    /// has no such estimate, or none yet.
    pub success: Option<Vec<f64>>,
    /// How it scores each goal, `[N]`, in its own unit: the larger, the more it wants the goal. `None`
    /// likewise.
    pub scores: Option<Vec<f64>>,
}

/// p = clip((value − min) / (max − min), 0, 1), in [0, 1]; 0 where `max` is not above `min` (ProCuRL-val,
/// see [`procurl`](crate::methods::procurl)).
///
/// ```
/// use curricula::methods::procurl::success_probability;
///
/// assert_eq!(success_probability(-5.0, -20.0, 0.0), 0.75);
/// assert_eq!(success_probability(1.0, -20.0, 0.0), 1.0);
/// ```
pub fn success_probability(value: f64, min: f64, max: f64) -> f64 {
    if max > min { ((value - min) / (max - min)).clamp(0.0, 1.0) } else { 0.0 }
}

/// p (1 − p) for a success rate p in [0, 1]: in [0, 1/4], largest for goals that are reached every other time
/// (ProCuRL's score with an optimal rate of 1, see [`procurl`](crate::methods::procurl); SFL's learnability,
/// see [`sfl`](crate::methods::sfl)).
///
/// ```
/// use curricula::learnability;
///
/// assert_eq!([0.0, 0.25, 0.5, 0.75, 1.0].map(learnability), [0.0, 0.1875, 0.25, 0.1875, 0.0]);
/// ```
pub fn learnability(p: f64) -> f64 {
    p * (1.0 - p)
}
