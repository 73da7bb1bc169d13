//! Tensors as plain slices, for loops that libtorch has no kernel for.

use tch::{Device, Kind, TchError, Tensor};

use crate::device::in_reach;

/// Calls `work` with the numbers of `written` and `read` as slices.
///
/// # Panics
/// If a tensor is not contiguous f32 on the CPU, or a written one shares memory with another of them.
#[allow(unsafe_code, reason = "tch gives a tensor's memory as a raw pointer only")]
pub(crate) fn with_slices<const W: usize, const R: usize, T>(
    written: [&Tensor; W],
    read: [&Tensor; R],
    work: impl FnOnce([&mut [f32]; W], [&[f32]; R]) -> T,
) -> T {
    let written = written.map(span);
    let read = read.map(span);
    for (i, a) in written.iter().enumerate() {
        assert!(
            written[i + 1..].iter().chain(&read).all(|b| !overlap(*a, *b)),
            "tensors that are written must not share memory"
        );
    }
    // SAFETY: each span is the memory of a contiguous f32 tensor on the CPU, which the borrowed tensor keeps
    // alive during the call. Written spans overlap nothing. Tensors are not Sync and this crate hands none of
    // them out, so nothing else touches the memory during the call.
    let written = written.map(|(start, len)| unsafe { std::slice::from_raw_parts_mut(start, len) });
    let read = read.map(|(start, len)| unsafe { std::slice::from_raw_parts(start.cast_const(), len) });
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

/// First number and count.
fn span(tensor: &Tensor) -> (*mut f32, usize) {
    assert!(
        tensor.device() == Device::Cpu && tensor.kind() == Kind::Float && tensor.is_contiguous(),
        "contiguous f32 on the CPU"
    );
    let len = tensor.numel();
    let start = if len == 0 { std::ptr::NonNull::dangling().as_ptr() } else { tensor.data_ptr().cast() };
    (start, len)
}

fn overlap(a: (*mut f32, usize), b: (*mut f32, usize)) -> bool {
    let end = |(start, len): (*mut f32, usize)| start.wrapping_add(len);
    a.1 > 0 && b.1 > 0 && a.0 < end(b) && b.0 < end(a)
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
