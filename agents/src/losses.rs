//! The student's losses and their gradients, one equation each.
//!
//! The equations come first, as functions of plain numbers. Below them they are applied to matrices: values
//! of shape `[E, rows, 1]` and actions of shape `[E, A, rows]`, for E learners. Each learner's loss is a mean
//! over n transitions. A batch may come in parts, so n is passed in and the parts' losses add up.

use tch::{Device, Kind, TchError, Tensor};

use crate::networks::{Views, with_slices};

/// What bounds a return: the discount γ and the lowest value, −1/(1 − γ).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Discount {
    /// γ in [0, 1).
    pub(crate) gamma: f64,
}

impl Discount {
    /// −1/(1 − γ), the return of failing for ever and so the lowest possible value. The highest is 0.
    pub(crate) fn lowest_value(self) -> f64 {
        -1.0 / (1.0 - self.gamma)
    }

    /// The clipped Bellman target ([`bellman_target`]) of one transition.
    pub(crate) fn target(self, reward: f32, next_value: f32) -> f32 {
        bellman_target(reward, next_value, self.gamma as f32, self.lowest_value() as f32)
    }
}

/// y = clip(r + γ·Q'(s', g, π'(s', g)), −1/(1 − γ), 0), the clipped Bellman target (DDPG, Eq. 5; HER, section
/// 4.1: rewards in {−1, 0} bound every return; Baselines). There are no terminal states: episodes end by time
/// alone.
#[inline]
fn bellman_target(reward: f32, next_value: f32, gamma: f32, lowest: f32) -> f32 {
    (reward + gamma * next_value).clamp(lowest, 0.0)
}

/// (Q − y)²/n, one transition's part of the critic's loss (DDPG, Eq. 4).
#[inline]
fn critic_loss(value: f32, target: f32, n: f32) -> f32 {
    (value - target) * (value - target) / n
}

/// ∂((Q − y)²/n)/∂Q = 2·(Q − y)/n.
#[inline]
fn critic_loss_slope(value: f32, target: f32, n: f32) -> f32 {
    2.0 * (value - target) / n
}

/// λ·π²/(n·A), one action component's part of the penalty in the actor's loss
/// −mean Q(s, g, π(s, g)) + λ·mean π² (DDPG, Eq. 6; the penalty: Baselines). `components` is n·A.
#[inline]
fn action_penalty(action: f32, action_l2: f32, components: f32) -> f32 {
    action_l2 * action * action / components
}

/// ∂(λ·π²/(n·A))/∂π = 2·λ·π/(n·A).
#[inline]
fn action_penalty_slope(action: f32, action_l2: f32, components: f32) -> f32 {
    2.0 * action_l2 * action / components
}

/// A part of a loss, or all of it.
#[derive(Debug)]
pub(crate) enum Loss {
    /// Summed over the learners: on the CPU, where a number costs no wait.
    Known(f64),
    /// One number per learner, `[E]`, on a device that may not have computed it yet.
    Awaited(Tensor),
}

impl Loss {
    /// This part and `other`.
    pub(crate) fn plus(self, other: Self) -> Result<Self, TchError> {
        Ok(match (self, other) {
            (Self::Known(a), Self::Known(b)) => Self::Known(a + b),
            (Self::Awaited(a), Self::Awaited(b)) => Self::Awaited(a.f_add(&b)?),
            (Self::Awaited(_), Self::Known(_)) | (Self::Known(_), Self::Awaited(_)) => {
                unreachable!("parts of one loss lie in one place")
            }
        })
    }

    /// Of each of `losses`, every learner's number, or on the CPU the sum over all learners. A device is
    /// waited for once.
    pub(crate) fn read(losses: &[Self]) -> Result<Vec<Vec<f64>>, TchError> {
        let (mut known, mut awaited) = (Vec::new(), Vec::new());
        for loss in losses {
            match loss {
                Self::Known(number) => known.push(vec![*number]),
                Self::Awaited(numbers) => awaited.push(numbers),
            }
        }
        if awaited.is_empty() {
            return Ok(known);
        }
        Vec::try_from(Tensor::f_stack(&awaited, 0)?.f_to_kind(Kind::Double)?.f_to_device(Device::Cpu)?)
    }

    /// The sum over all learners, which a device is waited for.
    pub(crate) fn total(self) -> Result<f64, TchError> {
        Ok(Self::read(&[self])?.iter().flatten().sum())
    }
}

/// Writes the targets y of transitions with `rewards` and `next_values` into `targets`; all are `[E, rows,
/// 1]`.
pub(crate) fn write_targets(
    rewards: &Views,
    next_values: &Views,
    discount: Discount,
    targets: &Views,
) -> Result<(), TchError> {
    let (gamma, lowest) = (discount.gamma, discount.lowest_value());
    if !targets.on_cpu {
        let returns = next_values.whole.f_mul_scalar(gamma)?.f_add(&rewards.whole)?;
        let _ = returns.f_clamp_out(&targets.whole, lowest, 0.0)?;
        return Ok(());
    }
    let (gamma, lowest) = (gamma as f32, lowest as f32);
    for ((r, q), y) in rewards.members.iter().zip(&next_values.members).zip(&targets.members) {
        with_slices([y], [r, q], |[y], [r, q]| {
            for ((y, &r), &q) in y.iter_mut().zip(r).zip(q) {
                *y = bellman_target(r, q, gamma, lowest);
            }
        });
    }
    Ok(())
}

/// Writes the slope of mean (Q − y)² in Q into `slope` (`[E, rows, 1]` all) and returns these rows' part of
/// the loss.
pub(crate) fn critic_part(
    values: &Views,
    targets: &Views,
    n: usize,
    slope: &Views,
) -> Result<Loss, TchError> {
    if !values.on_cpu {
        let error = values.whole.f_sub(&targets.whole)?;
        let _ = error.f_mul_scalar_out(&slope.whole, 2.0 / n as f64)?;
        return awaited(&error.f_square()?, 1.0 / n as f64);
    }
    let (count, mut loss) = (n as f32, 0.0);
    for ((q, y), slope) in values.members.iter().zip(&targets.members).zip(&slope.members) {
        with_slices([slope], [q, y], |[slope], [q, y]| {
            for ((slope, &q), &y) in slope.iter_mut().zip(q).zip(y) {
                *slope = critic_loss_slope(q, y, count);
                loss += f64::from(critic_loss(q, y, count));
            }
        });
    }
    Ok(Loss::Known(loss))
}

/// Writes the slope of −mean Q in Q, −1/n, into `slope` (`[E, rows, 1]` both) and returns these rows' part of
/// −mean Q.
pub(crate) fn value_part(values: &Views, n: usize, slope: &Views) -> Result<Loss, TchError> {
    if slope.on_cpu {
        for slope in &slope.members {
            with_slices([slope], [], |[slope], []| slope.fill(-1.0 / n as f32));
        }
    } else {
        let _ = slope.whole.shallow_clone().f_fill_(-1.0 / n as f64)?;
    }
    Ok(match mean_part(values, n)? {
        Loss::Known(mean) => Loss::Known(-mean),
        Loss::Awaited(means) => Loss::Awaited(means.f_neg()?),
    })
}

/// These rows' part of mean Q (`[E, rows, 1]`).
pub(crate) fn mean_part(values: &Views, n: usize) -> Result<Loss, TchError> {
    if !values.on_cpu {
        return awaited(&values.whole, 1.0 / n as f64);
    }
    let total = |[values]: [&[f32]; 1]| values.iter().map(|&q| f64::from(q)).sum::<f64>();
    let totals = values.members.iter().map(|values| with_slices([], [values], |[], read| total(read)));
    Ok(Loss::Known(totals.map(|total| total / n as f64).sum()))
}

/// Adds the slope of λ·mean π² in π to `slope` (`[E, A, rows]` both) and returns these rows' part of λ·mean
/// π².
pub(crate) fn penalty_part(
    actions: &Views,
    action_l2: f64,
    n: usize,
    slope: &Views,
) -> Result<Loss, TchError> {
    let components = (n as i64 * actions.whole.size()[1]) as f64;
    if !actions.on_cpu {
        let own = actions.whole.f_mul_scalar(2.0 * action_l2 / components)?;
        let _ = slope.whole.f_add_out(&slope.whole, &own)?;
        return awaited(&actions.whole.f_square()?, action_l2 / components);
    }
    let (action_l2, components, mut loss) = (action_l2 as f32, components as f32, 0.0);
    for (actions, slope) in actions.members.iter().zip(&slope.members) {
        with_slices([slope], [actions], |[slope], [actions]| {
            for (slope, &action) in slope.iter_mut().zip(actions) {
                *slope += action_penalty_slope(action, action_l2, components);
                loss += f64::from(action_penalty(action, action_l2, components));
            }
        });
    }
    Ok(Loss::Known(loss))
}

/// The sum over every learner's matrix in `terms` (`[E, rows, columns]`) times `weight`.
fn awaited(terms: &Tensor, weight: f64) -> Result<Loss, TchError> {
    let sums = terms.f_sum_dim_intlist(&[1i64, 2][..], false, Kind::Float)?;
    Ok(Loss::Awaited(sums.f_mul_scalar(weight)?))
}

#[cfg(test)]
mod tests {
    use tch::Tensor;

    use super::{
        Discount, Loss, action_penalty, action_penalty_slope, bellman_target, critic_loss, critic_loss_slope,
        critic_part, penalty_part, value_part, write_targets,
    };
    use crate::networks::Views;

    #[test]
    fn lowest_value_by_hand() {
        assert_eq!(Discount { gamma: 0.75 }.lowest_value(), -4.0);
        assert_eq!(Discount { gamma: 0.0 }.lowest_value(), -1.0);
    }

    #[test]
    fn bellman_target_by_hand() {
        assert_eq!(bellman_target(-1.0, -2.0, 0.75, -4.0), -2.5);
        assert_eq!(bellman_target(0.0, 1.0, 0.75, -4.0), 0.0, "0.75, clipped above");
        assert_eq!(bellman_target(-1.0, -8.0, 0.75, -4.0), -4.0, "-7, clipped below");
    }

    #[test]
    fn critic_loss_by_hand() {
        assert_eq!(critic_loss(-5.0, -2.0, 2.0), 4.5);
        assert_eq!(critic_loss_slope(-5.0, -2.0, 2.0), -3.0);
    }

    #[test]
    fn action_penalty_by_hand() {
        assert_eq!(action_penalty(-0.5, 3.0, 6.0), 0.125);
        assert_eq!(action_penalty_slope(-0.5, 3.0, 6.0), -0.5);
    }

    /// Two learners' matrices of `rows` by `columns`; `looped` says whether loops over the numbers work on
    /// them or the operations of another device.
    fn views([rows, columns]: [i64; 2], numbers: &[f32], looped: bool) -> Views {
        let mut views = Views::new(Tensor::from_slice(numbers).view([2, rows, columns])).unwrap();
        views.on_cpu = looped;
        views
    }

    fn assert_numbers(views: &Views, expected: &[f32]) {
        let numbers = Vec::<f32>::try_from(views.whole.view(-1)).unwrap();
        assert_eq!(numbers.len(), expected.len());
        for (number, expected) in numbers.iter().zip(expected) {
            assert!((number - expected).abs() < 1e-6, "{numbers:?} against {expected}");
        }
    }

    /// Matrices by hand, where the batch of n = 4 comes in two parts of which this is one.
    #[test]
    fn matrices_agree_with_the_equations_on_every_device() {
        for looped in [true, false] {
            let column = |numbers: [f32; 4]| views([2, 1], &numbers, looped);
            let (targets, slope) = (column([0.0; 4]), column([0.0; 4]));
            let (rewards, next) = (column([-1.0, 0.0, -1.0, 0.0]), column([-2.0, 1.0, -8.0, -1.0]));
            write_targets(&rewards, &next, Discount { gamma: 0.75 }, &targets).unwrap();
            assert_numbers(&targets, &[-2.5, 0.0, -4.0, -0.75]);

            let values = column([-0.5, -1.0, -4.0, 0.25]);
            let loss = critic_part(&values, &targets, 4, &slope).unwrap();
            let read = Loss::read(&[loss, value_part(&values, 4, &slope).unwrap()]).unwrap();
            assert_eq!(read.iter().map(Vec::len).collect::<Vec<_>>(), [if looped { 1 } else { 2 }; 2]);
            let loss = critic_part(&values, &targets, 4, &slope).unwrap();
            let loss = loss.total().unwrap();
            assert!((loss - (4.0 + 1.0 + 0.0 + 1.0) / 4.0).abs() < 1e-6, "{loss}");
            assert_numbers(&slope, &[1.0, -0.5, 0.0, 0.5]);

            let loss = value_part(&values, 4, &slope).unwrap().total().unwrap();
            assert!((loss - 5.25 / 4.0).abs() < 1e-6, "{loss}");
            assert_numbers(&slope, &[-0.25; 4]);

            // Three components in two rows.
            let numbers = [1.0, -0.5, 0.0, 0.5, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0];
            let (actions, slope) = (views([3, 2], &numbers, looped), views([3, 2], &[1.0; 12], looped));
            let loss = penalty_part(&actions, 3.0, 4, &slope).unwrap().total().unwrap();
            assert!((loss - 3.0 * 2.5 / 12.0).abs() < 1e-6, "{loss}");
            assert_numbers(&slope, &[1.5, 0.75, 1.0, 1.25, 1.0, 1.0, 1.0, 0.5, 1.0, 1.0, 1.0, 1.0]);
        }
    }
}
