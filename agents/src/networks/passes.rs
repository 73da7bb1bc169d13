//! Forward and backward passes of a stack on buffers that are allocated once.

use tch::{Device, Kind, TchError, Tensor};

use super::block::{Block, multiply, multiply_add};
use super::kernels;
use super::shape::{Output, Shape};
use super::stack::Stack;

/// The buffers that a stack's passes run on.
///
/// A backward pass must follow a forward pass with the same parameters and the same input.
#[derive(Debug)]
pub(crate) struct Passes {
    shape: Shape,
    members: usize,
    device: Device,
    rows: usize,
    /// Memory, each `[E · capacity · columns]`: one per hidden layer, then deltas, output and its gradient.
    memory: Memory,
    /// Views of the memory for the current number of rows.
    views: BufferViews,
}

#[derive(Debug)]
struct Memory {
    capacity: usize,
    hidden: Vec<Tensor>,
    deltas: [Tensor; 2],
    output: Tensor,
    output_gradient: Tensor,
}

#[derive(Debug)]
struct BufferViews {
    /// Activations of the hidden layers, `[E, n, width]`.
    hidden: Vec<Block>,
    /// Gradients with respect to the sums of the hidden layers, used in turn, `[E, n, width]`.
    deltas: [Block; 2],
    /// `[E, n, outputs]`, by columns.
    output: Block,
    /// Gradient with respect to the output, then to the last layer's sums, `[E, n, outputs]`, by columns.
    output_gradient: Block,
}

impl Memory {
    fn new(shape: Shape, members: usize, capacity: usize, device: Device) -> Result<Self, TchError> {
        let take =
            |columns: usize| Tensor::f_zeros([(members * capacity * columns) as i64], (Kind::Float, device));
        Ok(Self {
            capacity,
            hidden: (0..shape.layers).map(|_| take(shape.width)).collect::<Result<_, _>>()?,
            deltas: [take(shape.width)?, take(shape.width)?],
            output: take(shape.outputs)?,
            output_gradient: take(shape.outputs)?,
        })
    }

    fn views(&self, shape: Shape, members: usize, rows: usize) -> Result<BufferViews, TchError> {
        let view = |memory: &Tensor, size: [usize; 3]| {
            let numbers = size.iter().product::<usize>() as i64;
            memory.f_narrow(0, 0, numbers)?.f_view(size.map(|n| n as i64))
        };
        let hidden = |memory| Block::new(view(memory, [members, rows, shape.width])?);
        let output = |memory| Block::by_columns(view(memory, [members, shape.outputs, rows])?);
        Ok(BufferViews {
            hidden: self.hidden.iter().map(hidden).collect::<Result<_, _>>()?,
            deltas: [hidden(&self.deltas[0])?, hidden(&self.deltas[1])?],
            output: output(&self.output)?,
            output_gradient: output(&self.output_gradient)?,
        })
    }
}

impl Passes {
    /// Buffers for `rows` rows through each of `members` networks of `shape`.
    pub(crate) fn new(shape: Shape, members: usize, rows: usize, device: Device) -> Result<Self, TchError> {
        let memory = Memory::new(shape, members, rows, device)?;
        let views = memory.views(shape, members, rows)?;
        Ok(Self { shape, members, device, rows, memory, views })
    }

    /// Prepares for another number of rows; allocates only if it is larger than every one before.
    pub(crate) fn set_rows(&mut self, rows: usize) -> Result<(), TchError> {
        if rows > self.memory.capacity {
            self.memory = Memory::new(self.shape, self.members, rows, self.device)?;
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
        let BufferViews { hidden, output, .. } = &self.views;
        let mut source = input;
        for (layer, hidden) in stack.layers.iter().zip(hidden) {
            multiply(&hidden.plain, &source.plain, &layer.weight.plain)?;
            kernels::add_bias_relu(&hidden.plain, &layer.bias.plain)?;
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
            } else {
                multiply_add(&weight.plain, &below.transposed, &delta.plain)?;
            }
            if layer > 0 {
                let next = &deltas[layer % 2];
                multiply(&next.plain, &delta.plain, &stack.layers[layer].weight.transposed)?;
                let bias = &gradient.layers[layer - 1].bias;
                kernels::mask_and_add_column_sums(&next.plain, &below.plain, &bias.plain)?;
                delta = next;
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
        let BufferViews { hidden, deltas, output_gradient, .. } = &self.views;
        let mut delta = output_gradient;
        for layer in (1..=self.shape.layers).rev() {
            let next = &deltas[layer % 2];
            multiply(&next.plain, &delta.plain, &stack.layers[layer].weight.transposed)?;
            kernels::mask(&next.plain, &hidden[layer - 1].plain)?;
            delta = next;
        }
        multiply(&out.transposed, &weights.plain, &delta.transposed)
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
