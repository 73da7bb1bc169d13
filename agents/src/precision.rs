//! What networks are multiplied in.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tch::Kind;

use crate::config::StudentConfig;
use crate::device::Device;
use crate::error::AgentError;
use crate::tf32;

/// The precision of the wide products of a gradient step: those between an input or a hidden layer and a
/// hidden layer.
///
/// With `bf16` the factors and results of these products are numbers of 16 bits, with the range of a single
/// and a precision of 8 bits; sums inside a product are singles. Everything else is a single in any case: the
/// parameters and what Adam and Polyak averages do with them, gradients as they are summed up, normalisers,
/// last layers, Bellman targets and losses, and all that acts or that teachers ask about.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Precision {
    /// Singles (IEEE 754 binary32).
    #[default]
    F32,
    /// The upper halves of singles. Processors with AVX512-BF16 or AMX, and GPUs, multiply them faster.
    Bf16,
}

impl Precision {
    /// Every precision that a config can ask for.
    pub const ALL: [Self; 2] = [Self::F32, Self::Bf16];

    /// As it is written in a config.
    pub fn name(self) -> &'static str {
        match self {
            Self::F32 => "f32",
            Self::Bf16 => "bf16",
        }
    }

    /// As libtorch names it.
    pub(crate) fn kind(self) -> Kind {
        match self {
            Self::F32 => Kind::Float,
            Self::Bf16 => Kind::BFloat16,
        }
    }
}

/// Where and in what precision products are computed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arithmetic {
    pub(crate) device: tch::Device,
    pub(crate) precision: Precision,
}

impl Arithmetic {
    /// As `config` says, with its device opened and libtorch's switch for TF32 set.
    ///
    /// # Errors
    /// [`AgentError::Device`] or [`AgentError::Tf32`] saying what is missing.
    pub(crate) fn of(config: &StudentConfig) -> Result<Self, AgentError> {
        let device = config.device.open()?;
        if config.device == Device::Cuda {
            tf32::allow(config.tf32)?;
        }
        Ok(Self { device, precision: config.precision })
    }

    /// Singles on `device`.
    pub(crate) fn single(device: tch::Device) -> Self {
        Self { device, precision: Precision::F32 }
    }

    /// What a tensor of factors is made of.
    pub(crate) fn options(self) -> (Kind, tch::Device) {
        (self.precision.kind(), self.device)
    }
}

#[cfg(test)]
mod tests {
    use super::Precision;

    #[test]
    fn names_are_those_of_the_config() {
        for precision in Precision::ALL {
            assert_eq!(serde_json::to_string(&precision).unwrap(), format!("{:?}", precision.name()));
        }
    }
}
