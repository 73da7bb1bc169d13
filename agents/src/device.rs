//! Where networks live: the CPU, or a CUDA device when libtorch's CUDA half lies beside it.

use std::path::PathBuf;
use std::sync::OnceLock;

use serde::{Deserialize, Serialize};

use crate::error::AgentError;
use crate::runtime::{libtorch_folder, libtorch_version};

/// A kind of device.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Device {
    /// The processor, one thread per student.
    #[default]
    Cpu,
    /// The first NVIDIA GPU.
    Cuda,
}

impl Device {
    /// libtorch's device, its CUDA library loaded if need be.
    ///
    /// # Errors
    /// [`AgentError::Device`] saying what is missing.
    pub fn open(self) -> Result<tch::Device, AgentError> {
        match self {
            Self::Cpu => Ok(tch::Device::Cpu),
            Self::Cuda => {
                static LOADED: OnceLock<Result<(), String>> = OnceLock::new();
                let outcome = LOADED.get_or_init(load_cuda);
                match outcome {
                    Ok(()) => Ok(tch::Device::Cuda(0)),
                    Err(reason) => Err(AgentError::Device { device: "cuda", reason: reason.clone() }),
                }
            }
        }
    }
}

/// Loads `libtorch_cuda.so` from beside the libtorch this process runs on, so that it registers its kernels.
fn load_cuda() -> Result<(), String> {
    let Some(folder) = libtorch_folder() else {
        return Err("the folder of the loaded libtorch_cpu.so could not be found".to_owned());
    };
    let library: PathBuf = folder.join("libtorch_cuda.so");
    if !library.is_file() {
        return Err(format!(
            "{} is missing; point LD_LIBRARY_PATH at the lib folder of a CUDA build of libtorch {}, such as torch/lib in a \
             Python install of it",
            library.display(),
            libtorch_version()
        ));
    }
    open_globally(&library).map_err(|error| format!("{} does not load: {error}", library.display()))?;
    // Tried out, because whether a device is there is answered with no more than no.
    match tch::Tensor::f_zeros([1], (tch::Kind::Float, tch::Device::Cuda(0))) {
        Ok(_) => Ok(()),
        Err(error) => {
            let text = error.to_string();
            Err(format!("libtorch cannot use it: {}", text.lines().next().unwrap_or_default()))
        }
    }
}

/// Whether loops over plain numbers reach the memory of `device`: the CPU's alone.
pub(crate) fn in_reach(device: tch::Device) -> bool {
    #[cfg(test)]
    if tests::FAR.get() {
        return false;
    }
    device == tch::Device::Cpu
}

#[allow(unsafe_code, reason = "dlopen runs the library's initialisers")]
fn open_globally(library: &std::path::Path) -> Result<(), libloading::Error> {
    use libloading::os::unix::{Library, RTLD_GLOBAL, RTLD_NOW};
    // SAFETY: libtorch_cuda.so's initialisers register kernels with libtorch, which is loaded already; they have
    // no precondition beyond that. The library is never unloaded.
    let loaded = unsafe { Library::open(Some(library), RTLD_NOW | RTLD_GLOBAL) }?;
    std::mem::forget(loaded);
    Ok(())
}

/// Runs `work` as if no memory were in reach: what would run on a GPU, on the CPU.
#[cfg(test)]
pub(crate) fn far_away<T>(work: impl FnOnce() -> T) -> T {
    tests::FAR.set(true);
    let result = work();
    tests::FAR.set(false);
    result
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::Device;

    thread_local! {
        pub(super) static FAR: Cell<bool> = const { Cell::new(false) };
    }

    #[test]
    fn the_cpu_is_always_there() {
        assert_eq!(Device::Cpu.open().unwrap(), tch::Device::Cpu);
    }

    #[test]
    fn a_missing_cuda_library_is_named() {
        match Device::Cuda.open() {
            Ok(device) => assert_eq!(device, tch::Device::Cuda(0)),
            Err(error) => {
                let text = error.to_string();
                assert!(text.starts_with("device cuda: ") && text.contains("CUDA"), "{text}");
            }
        }
    }
}
