//! `policy.json`: what the numbers of an exported policy are.

use std::collections::BTreeMap;

use agents::{InputScaling, PolicyWeights};
use envs::Spec;
use reports::schema::RunKey;
use serde::Serialize;
use sha2::{Digest, Sha256};

use crate::run::policy::Policy;

/// Version of the format, raised whenever a field changes its meaning.
const FORMAT: u32 = 1;

/// The whole file.
#[derive(Serialize)]
struct PolicyFile<'a> {
    format: u32,
    run: &'a RunKey,
    /// Training steps behind the policy, and of the whole run.
    step: u64,
    steps: u64,
    /// The manifest's hash of the complete config.
    config_hash: &'a str,
    versions: &'a BTreeMap<String, String>,
    environment: TaskFields<'a>,
    inputs: [InputFields<'a>; 2],
    layers: Vec<LayerFields>,
    action: ActionFields,
    /// Of the file of numbers, in hex.
    sha256: String,
}

#[derive(Serialize)]
struct TaskFields<'a> {
    id: &'a str,
    family: &'a str,
    horizon: usize,
    /// Whether MuJoCo's native CCD was on; means nothing where nothing is simulated.
    native_ccd: bool,
}

/// A part of what the first layer takes, in order.
#[derive(Serialize)]
struct InputFields<'a> {
    name: &'a str,
    /// Its key in the observations of Gymnasium's goal environments.
    observation: &'a str,
    width: usize,
    clip_before: f32,
    mean: String,
    scale: String,
    clip_after: f32,
}

#[derive(Serialize)]
struct LayerFields {
    weight: String,
    bias: String,
    inputs: usize,
    outputs: usize,
    activation: &'static str,
}

#[derive(Serialize)]
struct ActionFields {
    width: usize,
    low: f64,
    high: f64,
}

/// Name of a layer's weights, `[outputs, inputs]`.
pub(super) fn weight(layer: usize) -> String {
    format!("layers.{layer}.weight")
}

/// Name of its biases, `[outputs]`.
pub(super) fn bias(layer: usize) -> String {
    format!("layers.{layer}.bias")
}

/// The text of the file. `numbers` is the content of the file of numbers.
pub(super) fn text(policy: &Policy, spec: &Spec, weights: &PolicyWeights, numbers: &[u8]) -> String {
    let manifest = policy.manifest();
    let last = weights.layers.len() - 1;
    let layer = |(index, layer): (usize, &agents::DenseLayer)| LayerFields {
        weight: weight(index),
        bias: bias(index),
        inputs: layer.inputs,
        outputs: layer.outputs,
        activation: if index == last { "tanh" } else { "relu" },
    };
    let file = PolicyFile {
        format: FORMAT,
        run: policy.run(),
        step: policy.step(),
        steps: policy.steps(),
        config_hash: &manifest.hash,
        versions: &manifest.versions,
        environment: TaskFields {
            id: spec.id,
            family: spec.family,
            horizon: spec.horizon,
            native_ccd: policy.native_ccd(),
        },
        inputs: [input("state", "observation", &weights.state), input("goal", "desired_goal", &weights.goal)],
        layers: weights.layers.iter().enumerate().map(layer).collect(),
        action: ActionFields { width: spec.action, low: -1.0, high: 1.0 },
        sha256: Sha256::digest(numbers).iter().map(|byte| format!("{byte:02x}")).collect(),
    };
    let text = serde_json::to_string_pretty(&file).expect("the fields are plain data");
    text + "\n"
}

fn input<'a>(name: &'a str, observation: &'a str, scaling: &InputScaling) -> InputFields<'a> {
    InputFields {
        name,
        observation,
        width: scaling.mean.len(),
        clip_before: scaling.clip_before,
        mean: format!("{name}.mean"),
        scale: format!("{name}.scale"),
        clip_after: scaling.clip_after,
    }
}
