//! What lies between two matrix products: on the CPU one fused loop each, elsewhere libtorch's kernels.

use half::bf16;
use multiversion::multiversion;
use tch::{Kind, TchError, Tensor};

use super::block::Views;
use super::slices::{Numbers, NumbersMut, same_memory, with_numbers, with_slices};

/// z ← z + b for every column of `z` (`[E, w, n]`); `bias` is `[E, w, 1]`.
pub(super) fn add_bias(z: &Views, bias: &Views) -> Result<(), TchError> {
    if z.on_cpu {
        each(z, bias, add_bias_columns);
    } else {
        let _ = z.whole.f_add_out(&z.whole, &bias.whole)?;
    }
    Ok(())
}

/// h ← max(z + b, 0), the forward step of a hidden layer, for sums `z` (`[E, n, w]`) and `bias` (`[E, 1,
/// w]`). `hidden` may be the sums' memory.
pub(super) fn add_bias_relu(z: &Views, bias: &Views, hidden: &Views) -> Result<(), TchError> {
    if !hidden.on_cpu {
        let _ = z.whole.f_add_out(&hidden.whole, &bias.whole)?;
        let _ = hidden.whole.f_relu_out(&hidden.whole)?;
        return Ok(());
    }
    for ((z, bias), hidden) in z.members.iter().zip(&bias.members).zip(&hidden.members) {
        if same_memory(z, hidden) {
            with_numbers([hidden], [bias], |[z], [bias]| match z {
                NumbersMut::Single(z) => add_bias_relu_rows(z, singles(bias)),
                NumbersMut::Rounded(z) => add_bias_relu_rows(z, singles(bias)),
            });
        } else {
            with_numbers([hidden], [z, bias], |[hidden], [z, bias]| match (hidden, z) {
                (NumbersMut::Single(h), Numbers::Single(z)) => add_bias_relu_into(h, z, singles(bias)),
                (NumbersMut::Single(h), Numbers::Rounded(z)) => add_bias_relu_into(h, z, singles(bias)),
                (NumbersMut::Rounded(h), Numbers::Single(z)) => add_bias_relu_into(h, z, singles(bias)),
                (NumbersMut::Rounded(h), Numbers::Rounded(z)) => add_bias_relu_into(h, z, singles(bias)),
            });
        }
    }
    Ok(())
}

/// δ ← δ' where h > 0, else 0: the backward step through the ReLU that gave `h`, from `sent` δ' (`[E, n, w]`
/// all). `delta` may be the memory of `sent`, which is of the kind of `hidden`.
pub(super) fn mask(sent: &Views, hidden: &Views, delta: &Views) -> Result<(), TchError> {
    if !delta.on_cpu {
        let _ = sent.whole.f_mul_out(&delta.whole, &hidden.whole.f_gt(0.0)?)?;
        return Ok(());
    }
    for ((sent, hidden), delta) in sent.members.iter().zip(&hidden.members).zip(&delta.members) {
        masked(sent, hidden, delta, &mut []);
    }
    Ok(())
}

/// [`mask`]; then adds the sum of every column to `sums` (`[E, 1, w]`), which gives the bias's gradient.
pub(super) fn mask_and_add_column_sums(
    sent: &Views,
    hidden: &Views,
    delta: &Views,
    sums: &Views,
) -> Result<(), TchError> {
    if !delta.on_cpu {
        mask(sent, hidden, delta)?;
        let of_delta = delta.whole.f_sum_dim_intlist(&[1i64][..], true, Kind::Float)?;
        let _ = sums.whole.f_add_out(&sums.whole, &of_delta)?;
        return Ok(());
    }
    let members = sent.members.iter().zip(&hidden.members).zip(&delta.members).zip(&sums.members);
    for (((sent, hidden), delta), sums) in members {
        with_slices([sums], [], |[sums], []| masked(sent, hidden, delta, sums));
    }
    Ok(())
}

/// gradient ← gradient + product, of one size; a rounded product into a single gradient.
pub(super) fn add(gradient: &Views, product: &Views) -> Result<(), TchError> {
    if !gradient.on_cpu {
        let _ = gradient.whole.f_add_out(&gradient.whole, &product.whole)?;
        return Ok(());
    }
    for (gradient, product) in gradient.members.iter().zip(&product.members) {
        with_numbers([gradient], [product], |[gradient], [product]| match (gradient, product) {
            (NumbersMut::Single(gradient), Numbers::Single(product)) => add_all(gradient, product),
            (NumbersMut::Single(gradient), Numbers::Rounded(product)) => add_all(gradient, product),
            (NumbersMut::Rounded(_), _) => unreachable!("gradients are single"),
        });
    }
    Ok(())
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

/// One member of [`mask`]; adds up columns unless there are no `sums`.
fn masked(sent: &Tensor, hidden: &Tensor, delta: &Tensor, sums: &mut [f32]) {
    use {Numbers as N, NumbersMut as M};
    if same_memory(sent, delta) {
        with_numbers([delta], [hidden], |[delta], [hidden]| match (delta, hidden) {
            (M::Single(delta), N::Single(hidden)) => mask_in_place(delta, hidden, sums),
            (M::Rounded(delta), N::Rounded(hidden)) => mask_in_place(delta, hidden, sums),
            _ => unreachable!("deltas are sent in the kind of the activations"),
        });
    } else {
        with_numbers([delta], [sent, hidden], |[delta], [sent, hidden]| match (delta, sent, hidden) {
            (M::Single(delta), N::Single(sent), N::Single(hidden)) => mask_into(delta, sent, hidden, sums),
            (M::Single(delta), N::Rounded(sent), N::Rounded(hidden)) => mask_into(delta, sent, hidden, sums),
            (M::Rounded(delta), N::Single(sent), N::Single(hidden)) => mask_into(delta, sent, hidden, sums),
            (M::Rounded(delta), N::Rounded(sent), N::Rounded(hidden)) => {
                mask_into(delta, sent, hidden, sums);
            }
            _ => unreachable!("deltas are sent in the kind of the activations"),
        });
    }
}

fn singles<'a>(numbers: Numbers<'a>) -> &'a [f32] {
    match numbers {
        Numbers::Single(numbers) => numbers,
        Numbers::Rounded(_) => unreachable!("biases are single"),
    }
}

/// A number as it lies in memory.
trait Stored: Copy {
    fn wide(self) -> f32;
    fn rounded(wide: f32) -> Self;
}

impl Stored for f32 {
    #[inline(always)]
    fn wide(self) -> f32 {
        self
    }

    #[inline(always)]
    fn rounded(wide: f32) -> Self {
        wide
    }
}

/// Without branches, so that loops over many numbers can use wide registers.
impl Stored for bf16 {
    #[inline(always)]
    fn wide(self) -> f32 {
        f32::from_bits(u32::from(self.to_bits()) << 16)
    }

    /// To the nearest number, or the even one of two; NaN stays NaN.
    #[inline(always)]
    fn rounded(wide: f32) -> Self {
        let bits = wide.to_bits();
        let nearest = bits.wrapping_add(0x7fff + ((bits >> 16) & 1));
        let kept = if wide.is_nan() { bits | 0x0040_0000 } else { nearest };
        Self::from_bits((kept >> 16) as u16)
    }
}

/// max(z + b, 0). Not `max`, which would turn a NaN into 0 and hide it from all later checks.
#[inline(always)]
fn relu(z: f32, b: f32) -> f32 {
    let sum = z + b;
    if sum < 0.0 { 0.0 } else { sum }
}

#[multiversion(targets("x86_64+avx512f+avx512bw+avx512vl", "x86_64+avx2"))]
fn add_bias_relu_rows<T: Stored>(z: &mut [T], bias: &[f32]) {
    for row in z.chunks_exact_mut(bias.len()) {
        for (z, b) in row.iter_mut().zip(bias) {
            *z = T::rounded(relu(z.wide(), *b));
        }
    }
}

#[multiversion(targets("x86_64+avx512f+avx512bw+avx512vl", "x86_64+avx2"))]
fn add_bias_relu_into<T: Stored, U: Stored>(hidden: &mut [T], z: &[U], bias: &[f32]) {
    let rows = hidden.chunks_exact_mut(bias.len()).zip(z.chunks_exact(bias.len()));
    for (hidden, z) in rows {
        for ((h, z), b) in hidden.iter_mut().zip(z).zip(bias) {
            *h = T::rounded(relu(z.wide(), *b));
        }
    }
}

#[multiversion(targets("x86_64+avx512f+avx512bw+avx512vl", "x86_64+avx2"))]
fn mask_in_place<T: Stored>(delta: &mut [T], hidden: &[T], sums: &mut [f32]) {
    if sums.is_empty() {
        for (d, h) in delta.iter_mut().zip(hidden) {
            *d = T::rounded(if h.wide() > 0.0 { d.wide() } else { 0.0 });
        }
        return;
    }
    for (delta, hidden) in delta.chunks_exact_mut(sums.len()).zip(hidden.chunks_exact(sums.len())) {
        for ((d, h), sum) in delta.iter_mut().zip(hidden).zip(&mut *sums) {
            let kept = if h.wide() > 0.0 { d.wide() } else { 0.0 };
            *d = T::rounded(kept);
            *sum += kept;
        }
    }
}

#[multiversion(targets("x86_64+avx512f+avx512bw+avx512vl", "x86_64+avx2"))]
fn mask_into<T: Stored, U: Stored>(delta: &mut [T], sent: &[U], hidden: &[U], sums: &mut [f32]) {
    if sums.is_empty() {
        for ((d, s), h) in delta.iter_mut().zip(sent).zip(hidden) {
            *d = T::rounded(if h.wide() > 0.0 { s.wide() } else { 0.0 });
        }
        return;
    }
    let rows = delta.chunks_exact_mut(sums.len()).zip(sent.chunks_exact(sums.len()));
    for ((delta, sent), hidden) in rows.zip(hidden.chunks_exact(sums.len())) {
        for (((d, s), h), sum) in delta.iter_mut().zip(sent).zip(hidden).zip(&mut *sums) {
            let kept = if h.wide() > 0.0 { s.wide() } else { 0.0 };
            *d = T::rounded(kept);
            *sum += kept;
        }
    }
}

#[multiversion(targets("x86_64+avx512f+avx512bw+avx512vl", "x86_64+avx2"))]
fn add_all<T: Stored>(gradient: &mut [f32], product: &[T]) {
    for (gradient, product) in gradient.iter_mut().zip(product) {
        *gradient += product.wide();
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
            assert_eq!(all(&target), expected, "looped: {looped}");
        }
    }

    fn all(views: &Views) -> Vec<f32> {
        Vec::try_from(views.whole.view(-1).to_kind(Kind::Float)).unwrap()
    }

    /// The same numbers in another kind. Those of these tests are exact in either.
    fn in_kind(views: &Views, kind: Kind) -> Views {
        let mut other = Views::new(views.whole.to_kind(kind).copy()).unwrap();
        other.on_cpu = views.on_cpu;
        other
    }

    #[test]
    fn kernels_by_hand_on_every_device() {
        let z = [1.0, -2.0, 3.0, 0.0, 0.5, 0.5, -1.0, 4.0];
        let bias = [1.0, -1.0, 0.0, 2.0];
        check(add_bias, (&z, 2), (&bias, 1), &[2.0, -1.0, 2.0, -1.0, 0.5, 0.5, 1.0, 6.0]);
        check(add_bias, (&z, 4), (&bias[..2], 1), &[2.0, -1.0, 4.0, 1.0, -0.5, -0.5, -2.0, 3.0]);
        let output = [0.5, 0.0, -1.0, 1.0, 0.5, -0.5, 0.0, 0.5];
        check(tanh_backward, (&z, 2), (&output, 2), &[0.75, -2.0, 0.0, 0.0, 0.375, 0.375, -1.0, 3.0]);
        check(add_row_sums, (&[1.0; 4], 1), (&z, 2), &[0.0, 4.0, 2.0, 4.0]);
        check(add_row_sums, (&[1.0; 2], 1), (&z, 4), &[3.0, 5.0]);
    }

    /// Every way in which a kernel from one matrix to another is called: in loops or not, from singles or
    /// rounded numbers, to singles or rounded numbers, to another place or the same.
    fn ways() -> Vec<(bool, Kind, Kind, bool)> {
        let mut ways = Vec::new();
        for looped in [true, false] {
            for from in [Kind::Float, Kind::BFloat16] {
                for to in [Kind::Float, Kind::BFloat16] {
                    ways.push((looped, from, to, false));
                }
                ways.push((looped, from, from, true));
            }
        }
        ways
    }

    /// Where a kernel reads `numbers` and where it writes, in this way.
    fn places(numbers: &[f32], (looped, from, to, in_place): (bool, Kind, Kind, bool)) -> [Views; 2] {
        let from = in_kind(&views(numbers, 2, looped), from);
        let target = if in_place { from.whole.shallow_clone() } else { from.whole.to_kind(to).copy() };
        let mut to = Views::new(target).unwrap();
        to.on_cpu = looped;
        [from, to]
    }

    #[test]
    fn a_hidden_layers_forward_step_by_hand() {
        for way in ways() {
            let [z, hidden] = places(&[1.0, -2.0, 3.0, 0.0, 0.5, 0.5, -1.0, 4.0], way);
            add_bias_relu(&z, &views(&[1.0, -1.0, 0.0, 2.0], 2, way.0), &hidden).unwrap();
            assert_eq!(all(&hidden), [2.0, 0.0, 4.0, 0.0, 0.5, 2.5, 0.0, 6.0], "{way:?}");
        }
    }

    #[test]
    fn a_hidden_layers_backward_step_by_hand() {
        let numbers = [1.0, -2.0, 3.0, 0.0, 0.5, 0.5, -1.0, 4.0];
        let expected = [0.0, -2.0, 3.0, 0.0, 0.5, 0.0, -1.0, 4.0];
        for way in ways() {
            let hidden = in_kind(&views(&[0.0, 1.0, 2.0, 0.0, 3.0, 0.0, 0.5, 0.5], 2, way.0), way.1);
            let [sent, delta] = places(&numbers, way);
            mask(&sent, &hidden, &delta).unwrap();
            assert_eq!(all(&delta), expected, "{way:?}");

            let [sent, delta] = places(&numbers, way);
            let sums = views(&[10.0; 4], 2, way.0);
            mask_and_add_column_sums(&sent, &hidden, &delta, &sums).unwrap();
            assert_eq!(all(&delta), expected, "{way:?}");
            assert_eq!(all(&sums), [13.0, 8.0, 9.5, 14.0], "{way:?}");
        }
    }

    #[test]
    fn numbers_are_rounded_as_the_crate_rounds_them() {
        let mut rng = envs::rng::stream(0, envs::rng::Purpose::Weights);
        let ties =
            [0x3f80_8000, 0x3f81_8000, 0x7f7f_ffff, 0x0000_8000, 0xff80_0000, 0x7fc0_0001, 0x7f80_0001];
        for bits in (0..100_000).map(|_| rand::Rng::random(&mut rng)).chain(ties) {
            let wide = f32::from_bits(bits);
            let (ours, theirs) = (<bf16 as Stored>::rounded(wide), bf16::from_f32(wide));
            assert_eq!(ours.to_bits(), theirs.to_bits(), "{bits:x}");
            assert!(ours.wide() == theirs.to_f32() || wide.is_nan() && ours.wide().is_nan(), "{bits:x}");
        }
    }

    #[test]
    fn rounded_products_are_added_to_single_gradients() {
        for looped in [true, false] {
            for kind in [Kind::Float, Kind::BFloat16] {
                let gradient = views(&[1.0 / 3.0, 2.0, -1.0, 0.0], 2, looped);
                add(&gradient, &in_kind(&views(&[1.0, 0.5, -0.25, 3.0], 2, looped), kind)).unwrap();
                assert_eq!(all(&gradient), [4.0 / 3.0, 2.5, -1.25, 3.0], "looped: {looped}, {kind:?}");
            }
        }
    }
}
