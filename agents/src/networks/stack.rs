//! The parameters of a stack of networks.

use envs::rng::Rng;
use rand::Rng as _;
use tch::{TchError, Tensor};

use super::block::{Block, copy};
use super::shape::{Layer, Shape};
use crate::actor::DenseLayer;
use crate::precision::{Arithmetic, Precision};

/// One number for every parameter of E networks of one shape: the parameters themselves, or their gradients.
#[derive(Debug)]
pub(crate) struct Stack {
    shape: Shape,
    /// All numbers, shape `[E, P]`. Whoever changes them calls [`Stack::round`].
    pub(super) flat: Tensor,
    /// A copy of them for products in less than single precision.
    rounded: Option<Tensor>,
    /// Views of them, one pair per layer.
    pub(super) layers: Vec<LayerViews>,
}

/// One layer of all members.
#[derive(Debug)]
pub(super) struct LayerViews {
    /// `[E, inputs, outputs]`, the last layer's by columns.
    pub(super) weight: Block,
    /// A copy of the weights of a hidden layer for products in less than single precision.
    pub(super) rounded: Option<Block>,
    /// `[E, 1, outputs]`.
    pub(super) bias: Block,
}

impl LayerViews {
    /// The weights of a hidden layer as factors of products in `precision`.
    ///
    /// # Panics
    /// If the stack was not made for this precision.
    pub(super) fn factors(&self, precision: Precision) -> &Block {
        match precision {
            Precision::F32 => &self.weight,
            Precision::Bf16 => self.rounded.as_ref().expect("a stack that keeps rounded weights"),
        }
    }
}

impl Stack {
    /// All zeros.
    pub(crate) fn zeros(shape: Shape, members: usize, arithmetic: Arithmetic) -> Result<Self, TchError> {
        let parameters = shape.parameters() as i64;
        let take = |options| Tensor::f_zeros([members as i64, parameters], options);
        let flat = take(Arithmetic::single(arithmetic.device).options())?;
        let rounded = match arithmetic.precision {
            Precision::F32 => None,
            Precision::Bf16 => Some(take(arithmetic.options())?),
        };
        Self::over(shape, flat, rounded)
    }

    /// The networks whose numbers are `flat`, shape `[E, P]`, with a copy in less than single precision.
    fn over(shape: Shape, flat: Tensor, rounded: Option<Tensor>) -> Result<Self, TchError> {
        let view_of = |numbers: &Tensor, rows: usize, columns: usize, offset: usize| {
            let part = numbers.f_narrow(1, offset as i64, (rows * columns) as i64)?;
            part.f_view([part.size()[0], rows as i64, columns as i64])
        };
        let view = |rows, columns, offset| view_of(&flat, rows, columns, offset);
        let layers = shape
            .places()
            .into_iter()
            .enumerate()
            .map(|(i, layer)| {
                let bias = Block::new(view(1, layer.outputs, layer.bias)?)?;
                if i == shape.layers {
                    let weight = Block::by_columns(view(layer.outputs, layer.inputs, layer.weight)?)?;
                    return Ok(LayerViews { weight, rounded: None, bias });
                }
                let weights = |flat| Block::new(view_of(flat, layer.inputs, layer.outputs, layer.weight)?);
                let rounded = rounded.as_ref().map(weights).transpose()?;
                Ok(LayerViews { weight: weights(&flat)?, rounded, bias })
            })
            .collect::<Result<_, TchError>>()?;
        Ok(Self { shape, flat, rounded, layers })
    }

    /// The member with this index: a stack of one that shares its memory with this one.
    pub(super) fn member(&self, index: usize) -> Result<Self, TchError> {
        let row = |numbers: &Tensor| numbers.f_narrow(0, index as i64, 1);
        Self::over(self.shape, row(&self.flat)?, self.rounded.as_ref().map(row).transpose()?)
    }

    /// Xavier-uniform weights drawn from `rng`, zero biases (Glorot and Bengio 2010, Eq. 16; Baselines).
    pub(crate) fn xavier(
        shape: Shape,
        members: usize,
        arithmetic: Arithmetic,
        rng: &mut Rng,
    ) -> Result<Self, TchError> {
        let stack = Self::zeros(shape, members, arithmetic)?;
        let mut numbers = vec![0.0; members * shape.parameters()];
        for network in numbers.chunks_exact_mut(shape.parameters()) {
            for Layer { inputs, outputs, weight, .. } in shape.places() {
                let limit = xavier_limit(inputs, outputs) as f32;
                network[weight..weight + inputs * outputs].fill_with(|| rng.random_range(-limit..=limit));
            }
        }
        stack.set_numbers(&numbers)?;
        Ok(stack)
    }

    /// All numbers, member after member.
    pub(crate) fn numbers(&self) -> Result<Vec<f32>, TchError> {
        Vec::try_from(self.flat.f_view(-1)?)
    }

    /// The layers of the first network.
    pub(crate) fn dense(&self) -> Result<Vec<DenseLayer>, TchError> {
        let numbers = |tensor: &Tensor| Vec::try_from(tensor.f_contiguous()?.f_view(-1)?);
        let layer = |views: &LayerViews| {
            let (weight, bias) = (&views.weight.transposed.members[0], &views.bias.plain.members[0]);
            let (outputs, inputs) = weight.size2()?;
            let (inputs, outputs) = (inputs as usize, outputs as usize);
            Ok(DenseLayer { inputs, outputs, weight: numbers(weight)?, bias: numbers(bias)? })
        };
        self.layers.iter().map(layer).collect()
    }

    /// Overwrites all numbers; there must be as many.
    pub(crate) fn set_numbers(&self, numbers: &[f32]) -> Result<(), TchError> {
        copy(&self.flat, &Tensor::f_from_slice(numbers)?.f_view_as(&self.flat)?)?;
        self.round()
    }

    /// Brings the copy for products in less than single precision up to date.
    pub(super) fn round(&self) -> Result<(), TchError> {
        self.rounded.as_ref().map_or(Ok(()), |rounded| copy(rounded, &self.flat))
    }

    /// Overwrites all numbers with those of a stack of the same shape.
    pub(crate) fn copy_from(&self, other: &Self) -> Result<(), TchError> {
        copy(&self.flat, &other.flat)?;
        self.round()
    }

    /// Whether every number is finite, member by member.
    pub(super) fn are_finite(&self) -> Result<Vec<bool>, TchError> {
        Vec::try_from(self.flat.f_isfinite()?.f_all_dim(1, false)?)
    }
}

/// √(6/(fan in + fan out)): the bound of the uniform distribution that keeps the variance of activations and
/// gradients even across layers (Glorot and Bengio 2010, Eq. 16).
fn xavier_limit(inputs: usize, outputs: usize) -> f64 {
    (6.0 / (inputs + outputs) as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use envs::rng::{Purpose, stream};
    use tch::Device;

    use super::{Stack, xavier_limit};
    use crate::networks::{Output, Shape};
    use crate::precision::Arithmetic;

    #[test]
    fn xavier_limit_by_hand() {
        assert_eq!(xavier_limit(10, 14), 0.5);
    }

    #[test]
    fn weights_fill_the_range_and_biases_are_zero() {
        let shape = Shape { inputs: 24, layers: 1, width: 300, outputs: 2, output: Output::Linear };
        let mut rng = stream(0, Purpose::Weights);
        let stack = Stack::xavier(shape, 2, Arithmetic::single(Device::Cpu), &mut rng).unwrap();
        let numbers = stack.numbers().unwrap();
        let [first, second] = [&numbers[..shape.parameters()], &numbers[shape.parameters()..]];
        assert_ne!(first, second, "members start apart");
        let place = shape.places()[0];
        let weights = &first[place.weight..place.bias];
        let largest = weights.iter().fold(0f32, |a, w| a.max(w.abs()));
        let limit = xavier_limit(24, 300) as f32;
        assert!(largest <= limit && largest > 0.99 * limit, "{largest} against {limit}");
        let mean = weights.iter().sum::<f32>() / weights.len() as f32;
        assert!(mean.abs() < 0.03 * limit, "{mean}");
        assert!(first[place.bias..place.bias + 300].iter().all(|b| *b == 0.0));
    }
}
