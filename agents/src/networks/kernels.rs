//! What lies between two matrix products: on the CPU one fused loop each, elsewhere libtorch's kernels.

use multiversion::multiversion;
use tch::{Kind, TchError};

use super::block::Views;
use super::slices::with_slices;

/// z ← z + b for every column of `z` (`[E, w, n]`); `bias` is `[E, w, 1]`.
pub(super) fn add_bias(z: &Views, bias: &Views) -> Result<(), TchError> {
    if z.on_cpu {
        each(z, bias, add_bias_columns);
    } else {
        let _ = z.whole.f_add_out(&z.whole, &bias.whole)?;
    }
    Ok(())
}

/// z ← max(z + b, 0), the forward step of a hidden layer.
pub(super) fn add_bias_relu(z: &Views, bias: &Views) -> Result<(), TchError> {
    if z.on_cpu {
        each(z, bias, add_bias_relu_rows);
    } else {
        let _ = z.whole.f_add_out(&z.whole, &bias.whole)?;
        let _ = z.whole.f_relu_out(&z.whole)?;
    }
    Ok(())
}

/// δ ← δ where h > 0, else 0: the backward step through the ReLU that gave `h` (`[E, n, w]` both).
pub(super) fn mask(delta: &Views, hidden: &Views) -> Result<(), TchError> {
    if delta.on_cpu {
        each(delta, hidden, mask_all);
    } else {
        let _ = delta.whole.f_mul_out(&delta.whole, &hidden.whole.f_gt(0.0)?)?;
    }
    Ok(())
}

/// [`mask`]; then adds the sum of every column to `sums` (`[E, 1, w]`), which gives the bias's gradient.
pub(super) fn mask_and_add_column_sums(delta: &Views, hidden: &Views, sums: &Views) -> Result<(), TchError> {
    if delta.on_cpu {
        for ((delta, hidden), sums) in delta.members.iter().zip(&hidden.members).zip(&sums.members) {
            with_slices([delta, sums], [hidden], |[delta, sums], [hidden]| {
                mask_and_add_rows(delta, hidden, sums);
            });
        }
        Ok(())
    } else {
        mask(delta, hidden)?;
        let of_delta = delta.whole.f_sum_dim_intlist(&[1i64][..], true, Kind::Float)?;
        let _ = sums.whole.f_add_out(&sums.whole, &of_delta)?;
        Ok(())
    }
}

/// sums ← sums + the sum of every row of `delta` (`[E, w, n]`), shape `[E, w, 1]`.
pub(super) fn add_row_sums(sums: &Views, delta: &Views) -> Result<(), TchError> {
    if sums.on_cpu {
        each(sums, delta, |sums, delta| add_rows(delta, sums));
    } else {
        let of_delta = delta.whole.f_sum_dim_intlist(&[2i64][..], true, Kind::Float)?;
        let _ = sums.whole.f_add_out(&sums.whole, &of_delta)?;
    }
    Ok(())
}

/// δ ← δ·(1 − y²): the backward step through y = tanh(z), as d tanh(z)/dz = 1 − tanh²(z). Both of any one
/// shape.
pub(super) fn tanh_backward(delta: &Views, output: &Views) -> Result<(), TchError> {
    if delta.on_cpu {
        each(delta, output, |delta, output| {
            for (d, y) in delta.iter_mut().zip(output) {
                *d *= 1.0 - y * y;
            }
        });
    } else {
        let slope = output.whole.f_square()?.f_neg()?.f_add_scalar(1.0)?;
        let _ = delta.whole.f_mul_out(&delta.whole, &slope)?;
    }
    Ok(())
}

/// Calls `work` with the numbers of every member: first those of `written`, then those of `read`.
fn each(written: &Views, read: &Views, work: impl Fn(&mut [f32], &[f32])) {
    for (written, read) in written.members.iter().zip(&read.members) {
        with_slices([written], [read], |[written], [read]| work(written, read));
    }
}

fn add_bias_columns(z: &mut [f32], bias: &[f32]) {
    let n = z.len() / bias.len();
    for (row, b) in z.chunks_exact_mut(n).zip(bias) {
        row.iter_mut().for_each(|z| *z += b);
    }
}

#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn add_bias_relu_rows(z: &mut [f32], bias: &[f32]) {
    for row in z.chunks_exact_mut(bias.len()) {
        for (z, b) in row.iter_mut().zip(bias) {
            let sum = *z + b;
            // Not `max`, which would turn a NaN into 0 and hide it from all later checks.
            *z = if sum < 0.0 { 0.0 } else { sum };
        }
    }
}

#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn mask_all(delta: &mut [f32], hidden: &[f32]) {
    for (d, h) in delta.iter_mut().zip(hidden) {
        *d = if *h > 0.0 { *d } else { 0.0 };
    }
}

#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn mask_and_add_rows(delta: &mut [f32], hidden: &[f32], sums: &mut [f32]) {
    let width = sums.len();
    for (delta, hidden) in delta.chunks_exact_mut(width).zip(hidden.chunks_exact(width)) {
        for ((d, h), sum) in delta.iter_mut().zip(hidden).zip(&mut *sums) {
            *d = if *h > 0.0 { *d } else { 0.0 };
            *sum += *d;
        }
    }
}

fn add_rows(delta: &[f32], sums: &mut [f32]) {
    let n = delta.len() / sums.len();
    for (row, sum) in delta.chunks_exact(n).zip(sums) {
        row.iter().for_each(|d| *sum += d);
    }
}

#[cfg(test)]
mod tests {
    use tch::{TchError, Tensor};

    use super::*;

    /// Two members with rows of `columns` numbers; handled in loops, or as on another device.
    fn views(numbers: &[f32], columns: i64, looped: bool) -> Views {
        let mut views = Views::new(Tensor::from_slice(numbers).view([2, -1, columns])).unwrap();
        views.on_cpu = looped;
        views
    }

    /// Runs `kernel` on `numbers` and `others`, each given with its number of columns, both in loops and with
    /// the operations of another device, and compares with `expected`.
    fn check(
        kernel: fn(&Views, &Views) -> Result<(), TchError>,
        (numbers, columns): (&[f32], i64),
        (others, other_columns): (&[f32], i64),
        expected: &[f32],
    ) {
        for looped in [true, false] {
            let target = views(numbers, columns, looped);
            kernel(&target, &views(others, other_columns, looped)).unwrap();
            assert_eq!(Vec::<f32>::try_from(target.whole.view(-1)).unwrap(), expected, "looped: {looped}");
        }
    }

    #[test]
    fn kernels_by_hand_on_every_device() {
        let z = [1.0, -2.0, 3.0, 0.0, 0.5, 0.5, -1.0, 4.0];
        let bias = [1.0, -1.0, 0.0, 2.0];
        check(add_bias, (&z, 2), (&bias, 1), &[2.0, -1.0, 2.0, -1.0, 0.5, 0.5, 1.0, 6.0]);
        check(add_bias, (&z, 4), (&bias[..2], 1), &[2.0, -1.0, 4.0, 1.0, -0.5, -0.5, -2.0, 3.0]);
        check(add_bias_relu, (&z, 2), (&bias, 2), &[2.0, 0.0, 4.0, 0.0, 0.5, 2.5, 0.0, 6.0]);
        let hidden = [0.0, 1.0, 2.0, 0.0, 3.0, 0.0, 0.5, 0.5];
        check(mask, (&z, 2), (&hidden, 2), &[0.0, -2.0, 3.0, 0.0, 0.5, 0.0, -1.0, 4.0]);
        let output = [0.5, 0.0, -1.0, 1.0, 0.5, -0.5, 0.0, 0.5];
        check(tanh_backward, (&z, 2), (&output, 2), &[0.75, -2.0, 0.0, 0.0, 0.375, 0.375, -1.0, 3.0]);
        check(add_row_sums, (&[1.0; 4], 1), (&z, 2), &[0.0, 4.0, 2.0, 4.0]);
        check(add_row_sums, (&[1.0; 2], 1), (&z, 4), &[3.0, 5.0]);
    }

    #[test]
    fn masked_columns_are_summed_on_every_device() {
        for looped in [true, false] {
            let delta = views(&[1.0, -2.0, 3.0, 0.0, 0.5, 0.5, -1.0, 4.0], 2, looped);
            let hidden = views(&[0.0, 1.0, 2.0, 0.0, 3.0, 0.0, 0.5, 0.5], 2, looped);
            let sums = views(&[10.0; 4], 2, looped);
            mask_and_add_column_sums(&delta, &hidden, &sums).unwrap();
            let sums = Vec::<f32>::try_from(sums.whole.view(-1)).unwrap();
            assert_eq!(sums, [13.0, 8.0, 9.5, 14.0], "looped: {looped}");
        }
    }
}
