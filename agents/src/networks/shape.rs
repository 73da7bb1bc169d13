//! The shape of a network and where its parameters lie.

/// What follows the last layer's sums.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Output {
    /// Nothing: values.
    Linear,
    /// tanh: actions in [-1, 1].
    Tanh,
}

/// A multilayer perceptron with ReLU between its layers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Shape {
    /// Numbers in.
    pub(crate) inputs: usize,
    /// Hidden layers.
    pub(crate) layers: usize,
    /// Units per hidden layer.
    pub(crate) width: usize,
    /// Numbers out.
    pub(crate) outputs: usize,
    /// What follows the last layer.
    pub(crate) output: Output,
}

/// One layer's place in the flat parameter vector.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Layer {
    /// Numbers in.
    pub(super) inputs: usize,
    /// Numbers out, length of the bias.
    pub(super) outputs: usize,
    /// First number of the weight matrix: `[inputs, outputs]`, the last layer's `[outputs, inputs]`.
    pub(super) weight: usize,
    /// First number of the bias `[outputs]`.
    pub(super) bias: usize,
}

/// Matrices start at multiples of 16 floats (a cache line), where the processor's wide loads are fastest. The
/// gaps between them hold zeros and get no gradient.
const ALIGNMENT: usize = 16;

impl Shape {
    /// The layers in order.
    pub(super) fn places(&self) -> Vec<Layer> {
        let mut end = 0;
        let mut take = |numbers: usize| {
            let start = end;
            end = (start + numbers).next_multiple_of(ALIGNMENT);
            start
        };
        (0..=self.layers)
            .map(|layer| {
                let inputs = if layer == 0 { self.inputs } else { self.width };
                let outputs = if layer == self.layers { self.outputs } else { self.width };
                Layer { inputs, outputs, weight: take(inputs * outputs), bias: take(outputs) }
            })
            .collect()
    }

    /// Length of the flat parameter vector of one network.
    pub(crate) fn parameters(&self) -> usize {
        let last = self.places()[self.layers];
        (last.bias + last.outputs).next_multiple_of(ALIGNMENT)
    }
}

#[cfg(test)]
mod tests {
    use super::{Layer, Output, Shape};

    #[test]
    fn layers_lie_one_after_the_other_on_cache_lines() {
        let shape = Shape { inputs: 3, layers: 1, width: 20, outputs: 2, output: Output::Linear };
        let first = Layer { inputs: 3, outputs: 20, weight: 0, bias: 64 };
        let last = Layer { inputs: 20, outputs: 2, weight: 96, bias: 144 };
        assert_eq!(shape.places(), [first, last]);
        assert_eq!(shape.parameters(), 160);
    }
}
