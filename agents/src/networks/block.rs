//! Matrices of a stack: E of one shape, multiplied pairwise.

use tch::{TchError, Tensor};

use crate::device::in_reach;
use crate::precision::Arithmetic;

/// E matrices of one shape as one tensor `[E, rows, columns]` and as E views `[rows, columns]`.
#[derive(Debug)]
pub(crate) struct Views {
    /// `[E, rows, columns]`.
    pub(crate) whole: Tensor,
    /// One `[rows, columns]` per member.
    pub(crate) members: Vec<Tensor>,
    /// Whether they lie on the CPU, where loops over plain numbers beat libtorch's kernels.
    pub(crate) on_cpu: bool,
}

impl Views {
    /// Views of `[E, rows, columns]`.
    pub(crate) fn new(whole: Tensor) -> Result<Self, TchError> {
        let members = (0..whole.size()[0]).map(|e| whole.f_select(0, e)).collect::<Result<_, _>>()?;
        let on_cpu = in_reach(whole.device());
        Ok(Self { whole, members, on_cpu })
    }
}

/// [`Views`] of E matrices and of their transposes. Nothing is copied: all see the same numbers.
///
/// Views are made once because making one costs as much as a small product.
#[derive(Debug)]
pub(crate) struct Block {
    /// The matrices.
    pub(crate) plain: Views,
    /// Their transposes.
    pub(crate) transposed: Views,
}

impl Block {
    /// The matrices of `whole`, shape `[E, rows, columns]`.
    pub(crate) fn new(whole: Tensor) -> Result<Self, TchError> {
        let transposed = Views::new(whole.f_transpose(1, 2)?)?;
        Ok(Self { plain: Views::new(whole)?, transposed })
    }

    /// The transposes of `whole`, shape `[E, columns, rows]`: matrices that lie column by column.
    ///
    /// Matrices with few columns are stored this way, and their transposes are computed: on a processor that
    /// multiplies 16 numbers at once, libtorch's product of 512 × 256 by 256 × 4 took 57 µs, the transposed
    /// product 11 to 22 µs.
    pub(crate) fn by_columns(whole: Tensor) -> Result<Self, TchError> {
        let Self { plain, transposed } = Self::new(whole)?;
        Ok(Self { plain: transposed, transposed: plain })
    }

    /// E matrices of zeros.
    pub(crate) fn zeros(
        members: usize,
        rows: usize,
        columns: usize,
        arithmetic: Arithmetic,
    ) -> Result<Self, TchError> {
        Self::new(Tensor::f_zeros([members as i64, rows as i64, columns as i64], arithmetic.options())?)
    }

    /// The columns from `first` on, `count` of them.
    pub(crate) fn columns(&self, first: usize, count: usize) -> Result<Self, TchError> {
        Self::new(self.plain.whole.f_narrow(2, first as i64, count as i64)?)
    }

    /// The rows from `first` on, `count` of them.
    pub(crate) fn rows(&self, first: usize, count: usize) -> Result<Self, TchError> {
        Self::new(self.plain.whole.f_narrow(1, first as i64, count as i64)?)
    }

    /// The same single matrix for each of `members`.
    pub(crate) fn repeated(&self, members: usize) -> Result<Self, TchError> {
        Self::new(self.plain.whole.f_expand([members as i64, -1, -1], false)?)
    }
}

/// Overwrites `to` with the numbers of `from`.
pub(crate) fn copy(to: &Tensor, from: &Tensor) -> Result<(), TchError> {
    to.shallow_clone().f_copy_(from)
}

/// out = left · right, member by member.
///
/// One batched product for all members pays off on a GPU only, and a single member does not need it.
pub(super) fn multiply(out: &Views, left: &Views, right: &Views) -> Result<(), TchError> {
    if out.on_cpu || out.members.len() == 1 {
        for ((out, left), right) in out.members.iter().zip(&left.members).zip(&right.members) {
            #[cfg(test)]
            done::note(left, right);
            let _ = left.f_mm_out(out, right)?;
        }
    } else {
        let _ = left.whole.f_bmm_out(&out.whole, &right.whole)?;
    }
    Ok(())
}

/// out += left · right, member by member.
pub(super) fn multiply_add(out: &Views, left: &Views, right: &Views) -> Result<(), TchError> {
    if out.on_cpu || out.members.len() == 1 {
        for ((out, left), right) in out.members.iter().zip(&left.members).zip(&right.members) {
            #[cfg(test)]
            done::note(left, right);
            let _ = out.f_addmm_out(out, left, right)?;
        }
    } else {
        let _ = out.whole.f_baddbmm_out(&out.whole, &left.whole, &right.whole)?;
    }
    Ok(())
}

/// A record of the products that this thread has computed, for tests.
#[cfg(test)]
pub(crate) mod done {
    use std::cell::RefCell;

    use tch::{Kind, Tensor};

    /// Rows, inner and columns of a product, whether left and right lie transposed in memory, and whether the
    /// factors are rounded.
    pub(crate) type Product = ([i64; 3], [bool; 2], bool);

    thread_local! {
        static DONE: RefCell<Vec<Product>> = const { RefCell::new(Vec::new()) };
    }

    /// left · right.
    pub(crate) fn product(left: &Tensor, right: &Tensor) -> Product {
        // A vector lies either way.
        let lies_transposed = |t: &Tensor| t.size().iter().all(|n| *n > 1) && t.stride()[1] != 1;
        let size = [left.size()[0], left.size()[1], right.size()[1]];
        (size, [left, right].map(lies_transposed), left.kind() == Kind::BFloat16)
    }

    pub(super) fn note(left: &Tensor, right: &Tensor) {
        DONE.with_borrow_mut(|done| done.push(product(left, right)));
    }

    /// The products since the last call, in order of size.
    pub(crate) fn take() -> Vec<Product> {
        let mut done = DONE.take();
        done.sort_unstable();
        done
    }
}

#[cfg(test)]
mod tests {
    use tch::Tensor;

    use super::{Block, multiply, multiply_add};

    /// Member 0: (1 2; 3 4) · (1 1; 0 1) = (1 3; 3 7). Member 1: 2·I · (0 1; 1 0) = (0 2; 2 0).
    #[test]
    fn members_are_multiplied_pairwise_on_every_device() {
        let block = |numbers: [f32; 8]| Block::new(Tensor::from_slice(&numbers).view([2, 2, 2])).unwrap();
        let left = block([1.0, 2.0, 3.0, 4.0, 2.0, 0.0, 0.0, 2.0]);
        let right = block([1.0, 1.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0]);
        for looped in [true, false] {
            let mut out = block([7.0; 8]);
            out.plain.on_cpu = looped;
            let numbers = |out: &Block| Vec::<f32>::try_from(out.plain.whole.view(-1)).unwrap();
            multiply(&out.plain, &left.plain, &right.plain).unwrap();
            assert_eq!(numbers(&out), [1.0, 3.0, 3.0, 7.0, 0.0, 2.0, 2.0, 0.0]);
            multiply_add(&out.plain, &left.plain, &right.transposed).unwrap();
            // (1 2; 3 4) · (1 0; 1 1) = (3 2; 7 4); the second right factor is symmetric.
            assert_eq!(numbers(&out), [4.0, 5.0, 10.0, 11.0, 0.0, 4.0, 4.0, 0.0]);
        }
    }
}
