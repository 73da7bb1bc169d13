//! Tensors as plain slices, for loops that libtorch has no kernel for.

use half::bf16;
use tch::{Device, Kind, TchError, Tensor};

use crate::device::in_reach;

/// The numbers of a tensor to read.
#[derive(Debug)]
pub(super) enum Numbers<'a> {
    Single(&'a [f32]),
    Rounded(&'a [bf16]),
}

/// The numbers of a tensor to overwrite.
#[derive(Debug)]
pub(super) enum NumbersMut<'a> {
    Single(&'a mut [f32]),
    Rounded(&'a mut [bf16]),
}

/// Calls `work` with the numbers of `written` and `read` as slices of singles.
///
/// # Panics
/// If a tensor is not contiguous f32 on the CPU, or a written one shares memory with another of them.
pub(crate) fn with_slices<const W: usize, const R: usize, T>(
    written: [&Tensor; W],
    read: [&Tensor; R],
    work: impl FnOnce([&mut [f32]; W], [&[f32]; R]) -> T,
) -> T {
    with_numbers(written, read, |written, read| {
        let written = written.map(|numbers| match numbers {
            NumbersMut::Single(numbers) => numbers,
            NumbersMut::Rounded(_) => panic!("singles expected"),
        });
        let read = read.map(|numbers| match numbers {
            Numbers::Single(numbers) => numbers,
            Numbers::Rounded(_) => panic!("singles expected"),
        });
        work(written, read)
    })
}

/// Calls `work` with the numbers of `written` and `read` as slices.
///
/// # Panics
/// If a tensor is not contiguous f32 or bf16 on the CPU, or a written one shares memory with another of them.
#[allow(unsafe_code, reason = "tch gives a tensor's memory as a raw pointer only")]
pub(super) fn with_numbers<const W: usize, const R: usize, T>(
    written: [&Tensor; W],
    read: [&Tensor; R],
    work: impl FnOnce([NumbersMut<'_>; W], [Numbers<'_>; R]) -> T,
) -> T {
    let written = written.map(span);
    let read = read.map(span);
    for (i, a) in written.iter().enumerate() {
        assert!(
            written[i + 1..].iter().chain(&read).all(|b| !a.overlaps(b)),
            "tensors that are written must not share memory"
        );
    }
    // SAFETY: each span is the memory of a contiguous tensor on the CPU with numbers of this kind, which the
    // borrowed tensor keeps alive during the call. Written spans overlap nothing. Tensors are not Sync and
    // this crate hands none of them out, so nothing else touches the memory during the call.
    let written = written.map(|Span { start, len, rounded }| unsafe {
        if rounded {
            NumbersMut::Rounded(std::slice::from_raw_parts_mut(start.cast(), len))
        } else {
            NumbersMut::Single(std::slice::from_raw_parts_mut(start.cast(), len))
        }
    });
    // SAFETY: as above.
    let read = read.map(|Span { start, len, rounded }| unsafe {
        if rounded {
            Numbers::Rounded(std::slice::from_raw_parts(start.cast_const().cast(), len))
        } else {
            Numbers::Single(std::slice::from_raw_parts(start.cast_const().cast(), len))
        }
    });
    work(written, read)
}

/// Calls `work` with the numbers of a contiguous f32 tensor on any device.
pub(crate) fn read<T>(tensor: &Tensor, work: impl FnOnce(&[f32]) -> T) -> Result<T, TchError> {
    if in_reach(tensor.device()) {
        return Ok(with_slices([], [tensor], |[], [numbers]| work(numbers)));
    }
    let host = tensor.f_to_device(Device::Cpu)?;
    Ok(with_slices([], [&host], |[], [numbers]| work(numbers)))
}

/// Whether two views of equal size see the same memory.
pub(super) fn same_memory(a: &Tensor, b: &Tensor) -> bool {
    a.data_ptr() == b.data_ptr()
}

/// Where a tensor's numbers lie.
#[derive(Clone, Copy)]
struct Span {
    start: *mut u8,
    /// How many numbers.
    len: usize,
    /// Whether they are bf16 rather than f32.
    rounded: bool,
}

impl Span {
    fn overlaps(&self, other: &Self) -> bool {
        let end = |span: &Self| span.start.wrapping_add(span.len * if span.rounded { 2 } else { 4 });
        self.len > 0 && other.len > 0 && self.start < end(other) && other.start < end(self)
    }
}

fn span(tensor: &Tensor) -> Span {
    let rounded = tensor.kind() == Kind::BFloat16;
    assert!(
        tensor.device() == Device::Cpu && (rounded || tensor.kind() == Kind::Float) && tensor.is_contiguous(),
        "contiguous f32 or bf16 on the CPU"
    );
    let len = tensor.numel();
    // A pointer that is aligned for both, where there is nothing.
    let nothing = std::ptr::NonNull::<f32>::dangling().as_ptr().cast();
    Span { start: if len == 0 { nothing } else { tensor.data_ptr().cast() }, len, rounded }
}

#[cfg(test)]
mod tests {
    use tch::{Kind, Tensor};

    use super::with_slices;

    #[test]
    fn writes_reach_the_tensor() {
        let target = Tensor::from_slice(&[1.0f32, 2.0]);
        let source = Tensor::from_slice(&[10.0f32, 20.0]);
        let sum = with_slices([&target], [&source], |[target], [source]| {
            target[1] += source[0];
            target.iter().sum::<f32>()
        });
        assert_eq!(sum, 13.0);
        assert_eq!(target.double_value(&[1]), 12.0);
    }

    #[test]
    #[should_panic(expected = "share memory")]
    fn overlapping_views_are_refused() {
        let whole = Tensor::zeros([8], (Kind::Float, tch::Device::Cpu));
        with_slices([&whole.narrow(0, 0, 5)], [&whole.narrow(0, 4, 4)], |_, _| ());
    }

    #[test]
    #[should_panic(expected = "contiguous f32")]
    fn strided_views_are_refused() {
        let whole = Tensor::zeros([4, 4], (Kind::Float, tch::Device::Cpu));
        with_slices([&whole.narrow(1, 0, 2)], [], |_, _| ());
    }
}
