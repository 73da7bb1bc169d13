//! Forward and backward passes of a stack on buffers that are allocated once.

use tch::{TchError, Tensor};

use super::block::{Block, multiply, multiply_add};
use super::kernels;
use super::shape::{Output, Shape};
use super::stack::Stack;
use crate::precision::{Arithmetic, Precision};

/// The buffers that a stack's passes run on.
///
/// In less than single precision the products of input and hidden layers have rounded factors and results.
/// The two ends are single: what the last layer reads (the last hidden layer's activations) and what it sends
/// back, and the gradient that reaches the input. In single precision all of these are views of one memory.
///
/// A backward pass must follow a forward pass with the same parameters and the same input.
#[derive(Debug)]
pub(crate) struct Passes {
    shape: Shape,
    members: usize,
    arithmetic: Arithmetic,
    rows: usize,
    memory: Memory,
    /// Views of the memory for the current number of rows.
    views: BufferViews,
}

/// Memory, each `[E · capacity · columns]` unless it says otherwise.
#[derive(Debug)]
struct Memory {
    capacity: usize,
    /// One per hidden layer.
    hidden: Vec<Tensor>,
    deltas: [Tensor; 2],
    output: Tensor,
    output_gradient: Tensor,
    /// What only products in less than single precision need.
    rounding: Option<Rounding>,
}

#[derive(Debug)]
struct Rounding {
    /// Activations of the last hidden layer, single.
    top: Tensor,
    /// Deltas at either end, single.
    end: Tensor,
    /// A rounded weight gradient per hidden layer, `[E, inputs, width]`.
    products: Vec<Block>,
}

#[derive(Debug)]
struct BufferViews {
    /// Sums of the hidden layers, `[E, n, width]`.
    sums: Vec<Block>,
    /// Activations of the hidden layers, `[E, n, width]`; in the sums' memory where both are of one kind.
    hidden: Vec<Block>,
    /// Gradients with respect to the sums of the hidden layers, used in turn, `[E, n, width]`.
    deltas: [Block; 2],
    /// What the last layer sends back to the last hidden one, single, `[E, n, width]`.
    top_delta: Block,
    /// The first hidden layer's delta for the gradient of the input, single, `[E, n, width]`.
    bottom_delta: Block,
    /// `[E, n, outputs]`, by columns.
    output: Block,
    /// Gradient with respect to the output, then to the last layer's sums, `[E, n, outputs]`, by columns.
    output_gradient: Block,
}

impl Memory {
    fn new(shape: Shape, members: usize, capacity: usize, arithmetic: Arithmetic) -> Result<Self, TchError> {
        let single = Arithmetic::single(arithmetic.device);
        let take = |columns: usize, arithmetic: Arithmetic| {
            Tensor::f_zeros([(members * capacity * columns) as i64], arithmetic.options())
        };
        let rounding = match arithmetic.precision {
            Precision::F32 => None,
            Precision::Bf16 => Some(Rounding {
                top: take(shape.width, single)?,
                end: take(shape.width, single)?,
                products: (0..shape.layers)
                    .map(|layer| {
                        let inputs = if layer == 0 { shape.inputs } else { shape.width };
                        Block::zeros(members, inputs, shape.width, arithmetic)
                    })
                    .collect::<Result<_, _>>()?,
            }),
        };
        Ok(Self {
            capacity,
            hidden: (0..shape.layers).map(|_| take(shape.width, arithmetic)).collect::<Result<_, _>>()?,
            deltas: [take(shape.width, arithmetic)?, take(shape.width, arithmetic)?],
            output: take(shape.outputs, single)?,
            output_gradient: take(shape.outputs, single)?,
            rounding,
        })
    }

    fn views(&self, shape: Shape, members: usize, rows: usize) -> Result<BufferViews, TchError> {
        let view = |memory: &Tensor, size: [usize; 3]| {
            let numbers = size.iter().product::<usize>() as i64;
            memory.f_narrow(0, 0, numbers)?.f_view(size.map(|n| n as i64))
        };
        let hidden = |memory| Block::new(view(memory, [members, rows, shape.width])?);
        let output = |memory| Block::by_columns(view(memory, [members, shape.outputs, rows])?);
        let (below, last) = self.hidden.split_at(shape.layers - 1);
        let top = self.rounding.as_ref().map_or(&last[0], |rounding| &rounding.top);
        let end =
            |layer: usize| self.rounding.as_ref().map_or(&self.deltas[layer % 2], |rounding| &rounding.end);
        Ok(BufferViews {
            sums: self.hidden.iter().map(hidden).collect::<Result<_, _>>()?,
            hidden: below.iter().chain([top]).map(hidden).collect::<Result<_, _>>()?,
            deltas: [hidden(&self.deltas[0])?, hidden(&self.deltas[1])?],
            top_delta: hidden(end(shape.layers))?,
            bottom_delta: hidden(end(1))?,
            output: output(&self.output)?,
            output_gradient: output(&self.output_gradient)?,
        })
    }
}

impl Passes {
    /// Buffers for `rows` rows through each of `members` networks of `shape`, which a stack made for the same
    /// `arithmetic` goes through.
    pub(crate) fn new(
        shape: Shape,
        members: usize,
        rows: usize,
        arithmetic: Arithmetic,
    ) -> Result<Self, TchError> {
        let memory = Memory::new(shape, members, rows, arithmetic)?;
        let views = memory.views(shape, members, rows)?;
        Ok(Self { shape, members, arithmetic, rows, memory, views })
    }

    /// Prepares for another number of rows; allocates only if it is larger than every one before.
    pub(crate) fn set_rows(&mut self, rows: usize) -> Result<(), TchError> {
        if rows > self.memory.capacity {
            self.memory = Memory::new(self.shape, self.members, rows, self.arithmetic)?;
        }
        if rows != self.rows {
            self.views = self.memory.views(self.shape, self.members, rows)?;
            self.rows = rows;
        }
        Ok(())
    }

    /// What the last forward pass gave, `[E, n, outputs]`, by columns.
    pub(crate) fn output(&self) -> &Block {
        &self.views.output
    }

    /// Runs `stack` on `input`, `[E, n, inputs]`.
    pub(crate) fn forward(&mut self, stack: &Stack, input: &Block) -> Result<(), TchError> {
        let BufferViews { sums, hidden, output, .. } = &self.views;
        let mut source = input;
        for ((layer, sums), hidden) in stack.layers.iter().zip(sums).zip(hidden) {
            multiply(&sums.plain, &source.plain, &layer.factors(self.arithmetic.precision).plain)?;
            kernels::add_bias_relu(&sums.plain, &layer.bias.plain, &hidden.plain)?;
            source = hidden;
        }
        let last = &stack.layers[self.shape.layers];
        let output = &output.transposed;
        multiply(output, &last.weight.transposed, &source.transposed)?;
        kernels::add_bias(output, &last.bias.transposed)?;
        if self.shape.output == Output::Tanh {
            let _ = output.whole.f_tanh_out(&output.whole)?;
        }
        Ok(())
    }

    /// The loss's gradient with respect to the output, `[E, n, outputs]`, by columns. The caller writes it
    /// before a backward pass, which overwrites it.
    pub(crate) fn output_gradient(&self) -> &Block {
        &self.views.output_gradient
    }

    /// Adds to `gradient` the loss's gradient with respect to every parameter.
    pub(crate) fn backward_parameters(
        &mut self,
        stack: &Stack,
        input: &Block,
        gradient: &mut Stack,
    ) -> Result<(), TchError> {
        self.through_output()?;
        let BufferViews { hidden, deltas, output_gradient, .. } = &self.views;
        let mut delta = output_gradient;
        kernels::add_row_sums(&gradient.layers[self.shape.layers].bias.transposed, &delta.transposed)?;
        for layer in (0..=self.shape.layers).rev() {
            let below = if layer == 0 { input } else { &hidden[layer - 1] };
            let weight = &gradient.layers[layer].weight;
            if layer == self.shape.layers {
                multiply_add(&weight.transposed, &delta.transposed, &below.plain)?;
            } else if let Some(Rounding { products, .. }) = &self.memory.rounding {
                multiply(&products[layer].plain, &below.transposed, &delta.plain)?;
                kernels::add(&weight.plain, &products[layer].plain)?;
            } else {
                multiply_add(&weight.plain, &below.transposed, &delta.plain)?;
            }
            if layer > 0 {
                let sent = self.send_back(stack, layer, delta)?;
                let bias = &gradient.layers[layer - 1].bias;
                delta = &deltas[layer % 2];
                kernels::mask_and_add_column_sums(&sent.plain, &below.plain, &delta.plain, &bias.plain)?;
            }
        }
        Ok(())
    }

    /// Writes the loss's gradient with respect to some columns of the input into `out` (`[E, n, columns]`, by
    /// columns). `weights` holds the weights of these columns: rows of the first layer's weight matrix, `[E,
    /// columns, width]`.
    pub(crate) fn backward_input(
        &mut self,
        stack: &Stack,
        weights: &Block,
        out: &Block,
    ) -> Result<(), TchError> {
        self.through_output()?;
        let BufferViews { hidden, deltas, bottom_delta, output_gradient, .. } = &self.views;
        let mut delta = output_gradient;
        for layer in (1..=self.shape.layers).rev() {
            let sent = self.send_back(stack, layer, delta)?;
            delta = if layer == 1 { bottom_delta } else { &deltas[layer % 2] };
            kernels::mask(&sent.plain, &hidden[layer - 1].plain, &delta.plain)?;
        }
        multiply(&out.transposed, &weights.plain, &delta.transposed)
    }

    /// What `delta`, the gradient with respect to the sums of `layer`, gives for the activations below it.
    fn send_back(&self, stack: &Stack, layer: usize, delta: &Block) -> Result<&Block, TchError> {
        let BufferViews { deltas, top_delta, .. } = &self.views;
        let (sent, weights) = if layer == self.shape.layers {
            (top_delta, &stack.layers[layer].weight)
        } else {
            (&deltas[layer % 2], stack.layers[layer].factors(self.arithmetic.precision))
        };
        multiply(&sent.plain, &delta.plain, &weights.transposed)?;
        Ok(sent)
    }

    /// Takes the gradient with respect to the output back through what follows the last layer's sums.
    fn through_output(&mut self) -> Result<(), TchError> {
        match self.shape.output {
            Output::Linear => Ok(()),
            Output::Tanh => {
                kernels::tanh_backward(&self.views.output_gradient.transposed, &self.views.output.transposed)
            }
        }
    }
}

impl Stack {
    /// The weights of some input columns: rows of the first layer's matrices, `[E, count, width]`.
    pub(crate) fn input_weights(&self, first: usize, count: usize) -> Result<Block, TchError> {
        self.layers[0].weight.rows(first, count)
    }
}
