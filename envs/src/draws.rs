//! Where an environment's random numbers come from: a seeded stream, or the draws recorded with a reset.

use rand::Rng as _;
use rand_distr::StandardNormal;
use serde::Deserialize;

use crate::rng::{Purpose, Rng, stream};

/// What a [`World`](crate::World) draws its starts and goals from.
///
/// ```
/// use envs::Draws;
/// use envs::rng::{Purpose, stream};
///
/// let mut rng = stream(0, Purpose::Environment);
/// let mut draws = Draws::from(&mut rng);
/// let [x, y] = draws.uniform([0.0, -2.0], [1.0, 2.0]);
/// assert!((0.0..1.0).contains(&x) && (-2.0..2.0).contains(&y));
/// assert!(draws.index(3) < 3);
/// ```
pub struct Draws<'a>(Origin<'a>);

enum Origin<'a> {
    Stream(&'a mut Rng),
    Recorded(&'a mut RecordedDraws),
}

impl<'a> From<&'a mut Rng> for Draws<'a> {
    fn from(rng: &'a mut Rng) -> Self {
        Self(Origin::Stream(rng))
    }
}

impl<'a> From<&'a mut RecordedDraws> for Draws<'a> {
    fn from(recorded: &'a mut RecordedDraws) -> Self {
        Self(Origin::Recorded(recorded))
    }
}

impl Draws<'_> {
    /// Independent uniform numbers, component i on [`low[i]`, `high[i]`).
    pub fn uniform<const N: usize>(&mut self, low: [f64; N], high: [f64; N]) -> [f64; N] {
        if let Origin::Recorded(recorded) = &mut self.0 {
            let domain = format!("on {low:?} to {high:?}");
            let inside = |i: usize, value| i < N && (low[i]..=high[i]).contains(&value);
            if let Some(numbers) = recorded.next(&[DrawKind::Uniform], &domain, inside) {
                return numbers;
            }
        }
        let rng = self.stream();
        std::array::from_fn(|i| low[i] + (high[i] - low[i]) * rng.random::<f64>())
    }

    /// Independent normal numbers of mean 0 and standard deviation `deviation`.
    pub fn normal<const N: usize>(&mut self, deviation: f64) -> [f64; N] {
        if let Origin::Recorded(recorded) = &mut self.0
            && let Some(numbers) = recorded.next(&[DrawKind::Normal], "", |_, value| value.is_finite())
        {
            return numbers;
        }
        let rng = self.stream();
        std::array::from_fn(|_| deviation * rng.sample::<f64, _>(StandardNormal))
    }

    /// A uniform index in 0..`n`.
    ///
    /// # Panics
    /// If `n` is 0.
    pub fn index(&mut self, n: usize) -> usize {
        if let Origin::Recorded(recorded) = &mut self.0 {
            let whole = |_, value: f64| value.fract() == 0.0 && value >= 0.0 && value < n as f64;
            let kinds = [DrawKind::Integers, DrawKind::Choice];
            if let Some([index]) = recorded.next(&kinds, &format!("below {n}"), whole) {
                return index as usize;
            }
        }
        self.stream().random_range(0..n)
    }

    fn stream(&mut self) -> &mut Rng {
        match &mut self.0 {
            Origin::Stream(rng) => rng,
            Origin::Recorded(recorded) => &mut recorded.instead,
        }
    }
}

/// The kind of a recorded draw, named after numpy's generator methods.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DrawKind {
    /// Uniform real numbers.
    Uniform,
    /// Normal numbers.
    Normal,
    /// A uniform index.
    Integers,
    /// A uniform choice from a list, recorded as the index of the chosen item.
    Choice,
}

/// One recorded draw: its kind and the numbers that came out, already scaled.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Draw(pub DrawKind, pub Vec<f64>);

/// Why a list of recorded draws does not fit the reset it is fed to.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DrawError {
    /// The list is over too early.
    #[error("the reset asks for a draw number {0}, but fewer are recorded")]
    Missing(usize),
    /// Draws are left when the reset is done.
    #[error("{used} of {recorded} recorded draws were asked for")]
    LeftOver {
        /// Draws that the reset asked for.
        used: usize,
        /// Draws in the file.
        recorded: usize,
    },
    /// Another kind or count of numbers.
    #[error("draw {index} should be {expected}, but {got} is recorded")]
    Mismatch {
        /// Which draw, from 0.
        index: usize,
        /// What the reset asks for.
        expected: String,
        /// What the file holds.
        got: String,
    },
}

/// Recorded draws, handed out in order.
///
/// After the first draw that does not fit what is asked for, numbers come from a seeded stream instead, so
/// that the reset can still end; [`RecordedDraws::finish`] then reports the misfit.
#[derive(Clone, Debug)]
pub struct RecordedDraws {
    draws: Vec<Draw>,
    used: usize,
    misfit: Option<DrawError>,
    instead: Rng,
}

impl RecordedDraws {
    /// Starts at the first draw.
    pub fn new(draws: &[Draw]) -> Self {
        Self { draws: draws.to_vec(), used: 0, misfit: None, instead: stream(0, Purpose::Environment) }
    }

    /// Checks that every recorded draw was asked for, and nothing else.
    ///
    /// # Errors
    /// [`DrawError`] for the first draw that did not fit, or for those that are left.
    pub fn finish(&self) -> Result<(), DrawError> {
        match &self.misfit {
            Some(misfit) => Err(misfit.clone()),
            None if self.used == self.draws.len() => Ok(()),
            None => Err(DrawError::LeftOver { used: self.used, recorded: self.draws.len() }),
        }
    }

    /// The next draw, if it is of one of `kinds`, has N numbers, and each lies where `fits` wants it.
    fn next<const N: usize>(
        &mut self,
        kinds: &[DrawKind],
        domain: &str,
        fits: impl Fn(usize, f64) -> bool,
    ) -> Option<[f64; N]> {
        if self.misfit.is_some() {
            return None;
        }
        let index = self.used;
        let Some(Draw(kind, values)) = self.draws.get(index) else {
            self.misfit = Some(DrawError::Missing(index));
            return None;
        };
        self.used += 1;
        let inside = values.iter().enumerate().all(|(i, &value)| fits(i, value));
        match <[f64; N]>::try_from(values.as_slice()) {
            Ok(numbers) if kinds.contains(kind) && inside => Some(numbers),
            _ => {
                self.misfit = Some(DrawError::Mismatch {
                    index,
                    expected: format!("{N} of {:?} {domain}", kinds[0]),
                    got: format!("{} of {kind:?}: {values:?}", values.len()),
                });
                None
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Draw, DrawError, DrawKind, Draws, RecordedDraws};

    #[test]
    fn recorded_draws_come_in_order_and_must_all_be_used() {
        let draws = [Draw(DrawKind::Uniform, vec![0.25, -1.0]), Draw(DrawKind::Choice, vec![3.0])];
        let mut recorded = RecordedDraws::new(&draws);
        assert_eq!(Draws::from(&mut recorded).uniform([-1.0; 2], [1.0; 2]), [0.25, -1.0]);
        assert_eq!(recorded.finish(), Err(DrawError::LeftOver { used: 1, recorded: 2 }));
        assert_eq!(Draws::from(&mut recorded).index(4), 3);
        assert_eq!(recorded.finish(), Ok(()));
        let [_] = Draws::from(&mut recorded).normal(1.0);
        assert_eq!(recorded.finish(), Err(DrawError::Missing(2)));
    }

    #[test]
    fn a_draw_of_another_kind_count_or_range_is_noticed_for_good() {
        for (draw, why) in [
            (Draw(DrawKind::Normal, vec![0.5]), "kind"),
            (Draw(DrawKind::Uniform, vec![0.5, 0.5]), "count"),
            (Draw(DrawKind::Uniform, vec![1.5]), "range"),
        ] {
            let mut recorded = RecordedDraws::new(&[draw, Draw(DrawKind::Uniform, vec![0.5])]);
            for _ in 0..2 {
                let [instead] = Draws::from(&mut recorded).uniform([0.0], [1.0]);
                assert!((0.0..1.0).contains(&instead) && instead != 0.5, "{why}: {instead}");
            }
            let outcome = recorded.finish();
            assert!(matches!(outcome, Err(DrawError::Mismatch { index: 0, .. })), "{why}: {outcome:?}");
        }
        let mut fractional = RecordedDraws::new(&[Draw(DrawKind::Integers, vec![1.5])]);
        assert!(Draws::from(&mut fractional).index(4) < 4);
        assert!(fractional.finish().is_err());
    }
}
