//! A trained policy as plain numbers, for programs that have no student.

/// The greedy policy: dense layers with ReLU between them and tanh after the last, on the state and the goal,
/// each scaled first.
#[derive(Clone, Debug, PartialEq)]
pub struct PolicyWeights {
    /// How states are scaled, `[S]`.
    pub state: InputScaling,
    /// How goals are scaled, `[G]`.
    pub goal: InputScaling,
    /// The layers, the first of which takes the scaled state followed by the scaled goal, `[S + G]`; the last
    /// gives the action, `[A]`.
    pub layers: Vec<DenseLayer>,
}

/// y = W·x + b.
#[derive(Clone, Debug, PartialEq)]
pub struct DenseLayer {
    /// Numbers in.
    pub inputs: usize,
    /// Numbers out.
    pub outputs: usize,
    /// W, `[outputs, inputs]`, row after row.
    pub weight: Vec<f32>,
    /// b, `[outputs]`.
    pub bias: Vec<f32>,
}

/// clip((clip(x, ±`clip_before`) − `mean`)·`scale`, ±`clip_after`), in single precision and in this order.
#[derive(Clone, Debug, PartialEq)]
pub struct InputScaling {
    /// Means, in the units of the input.
    pub mean: Vec<f32>,
    /// Inverse standard deviations, in the inverse units of the input.
    pub scale: Vec<f32>,
    /// Bound on the raw input.
    pub clip_before: f32,
    /// Bound on the scaled input.
    pub clip_after: f32,
}
