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
/// assert_eq!(judgement.success, Some([1.0, 0.5, 0.0].map(Some).to_vec()));
/// assert_eq!(judgement.scores, Some([0.0, 0.25, 0.0].map(Some).to_vec()));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Judgement {
    /// How likely it takes the student to succeed at each goal, `[N]`, in [0, 1]; `None` for a goal of which
    /// it has no estimate, and for a teacher that has none of any, or none yet.
    pub success: Option<Vec<Option<f64>>>,
    /// How it scores each goal, `[N]`, in its own unit: the larger, the more it wants the goal. `None`
    /// likewise.
    pub scores: Option<Vec<Option<f64>>>,
}

impl Judgement {
    /// Of a teacher that judges all goals or none.
    pub fn of_all(success: Option<Vec<f64>>, scores: Option<Vec<f64>>) -> Self {
        let every = |values: Vec<f64>| values.into_iter().map(Some).collect();
        Self { success: success.map(every), scores: scores.map(every) }
    }

    /// Of a teacher that judges the goals that it knows something of; a list without a value is none.
    ///
    /// ```
    /// let judgement = curricula::Judgement::of_some(vec![None, None], vec![None, Some(0.5)]);
    /// assert_eq!((judgement.success, judgement.scores), (None, Some(vec![None, Some(0.5)])));
    /// ```
    pub fn of_some(success: Vec<Option<f64>>, scores: Vec<Option<f64>>) -> Self {
        let [success, scores] =
            [success, scores].map(|values| values.iter().any(Option::is_some).then_some(values));
        Self { success, scores }
    }
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
