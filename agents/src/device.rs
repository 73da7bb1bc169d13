//! Where networks live: the CPU, or a CUDA device when libtorch's CUDA half lies beside it.

use std::path::Path;
use std::sync::OnceLock;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::{AgentError, DeviceProblem, TorchError};
use crate::runtime::{libtorch_folder, libtorch_version};

/// A kind of device.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Device {
    /// The processor, one thread per student.
    #[default]
    Cpu,
    /// The first NVIDIA GPU.
    Cuda,
}

impl Device {
    /// The device as libtorch names it; loads libtorch's CUDA library if that is needed.
    ///
    /// # Errors
    /// [`AgentError::Device`] saying what is missing.
    pub fn open(self) -> Result<tch::Device, AgentError> {
        match self {
            Self::Cpu => Ok(tch::Device::Cpu),
            Self::Cuda => {
                static LOADED: OnceLock<Result<(), DeviceProblem>> = OnceLock::new();
                let outcome = LOADED.get_or_init(|| match libtorch_folder() {
                    Some(folder) => load_cuda(&folder),
                    None => Err(DeviceProblem::NoFolder),
                });
                match outcome {
                    Ok(()) => Ok(tch::Device::Cuda(0)),
                    Err(source) => Err(AgentError::Device { device: "cuda", source }),
                }
            }
        }
    }
}

/// Loads `libtorch_cuda.so` from the folder of the libtorch this process runs on, so that it registers its
/// kernels, and tries it out.
fn load_cuda(folder: &Path) -> Result<(), DeviceProblem> {
    let library = folder.join("libtorch_cuda.so");
    if !library.is_file() {
        return Err(DeviceProblem::Missing { library, version: libtorch_version() });
    }
    open_globally(&library).map_err(|source| DeviceProblem::Loading { library, source })?;
    match multiply_on(tch::Device::Cuda(0)) {
        Ok(4.0) => Ok(()),
        Ok(sum) => Err(DeviceProblem::Wrong(sum)),
        Err(error) => Err(DeviceProblem::Unusable(TorchError(error))),
    }
}

/// Computes (1 1)·(2 2)ᵀ on `device`, which is 4, and waits for the result. libtorch's own query for a device
/// gives no reason when it finds none, and that a driver is installed does not prove that products work.
fn multiply_on(device: tch::Device) -> Result<f64, tch::TchError> {
    let ones = tch::Tensor::f_ones([1, 2], (tch::Kind::Float, device))?;
    ones.f_mm(&ones.f_mul_scalar(2.0)?.f_tr()?)?.f_double_value(&[0, 0])
}

/// Whether loops over plain numbers can reach the memory of `device`: only the CPU's.
pub(crate) fn in_reach(device: tch::Device) -> bool {
    #[cfg(test)]
    if tests::FAR.get() {
        return false;
    }
    device == tch::Device::Cpu
}

#[allow(unsafe_code, reason = "dlopen runs the library's initialisers")]
fn open_globally(library: &Path) -> Result<(), libloading::Error> {
    use libloading::os::unix::{Library, RTLD_GLOBAL, RTLD_NOW};
    // SAFETY: libtorch_cuda.so's initialisers register kernels with libtorch, which is loaded already; they
    // have no precondition beyond that. The library is never unloaded.
    let loaded = unsafe { Library::open(Some(library), RTLD_NOW | RTLD_GLOBAL) }?;
    std::mem::forget(loaded);
    Ok(())
}

/// Runs `work` as if no memory were in reach: the operations that a GPU would do, on the CPU.
#[cfg(test)]
pub(crate) fn far_away<T>(work: impl FnOnce() -> T) -> T {
    struct Back;
    impl Drop for Back {
        fn drop(&mut self) {
            tests::FAR.set(false);
        }
    }
    tests::FAR.set(true);
    let _back = Back;
    work()
}

/// The device of tests that can do without the CPU: a GPU where `GOALBENCH_TEST_CUDA` is set (`ci/gpu-check`
/// sets it), else the CPU.
#[cfg(test)]
pub(crate) fn under_test() -> Device {
    if std::env::var_os("GOALBENCH_TEST_CUDA").is_some() { Device::Cuda } else { Device::Cpu }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;
    use std::error::Error as _;

    use super::{Device, in_reach, load_cuda, multiply_on, under_test};

    thread_local! {
        pub(super) static FAR: Cell<bool> = const { Cell::new(false) };
    }

    #[test]
    fn the_cpu_is_always_there() {
        assert_eq!(Device::Cpu.open().unwrap(), tch::Device::Cpu);
    }

    /// So that a GPU that was asked for is not silently left out.
    #[test]
    fn the_device_under_test_is_there() {
        under_test().open().unwrap();
    }

    #[test]
    fn loops_reach_the_memory_of_the_cpu_alone() {
        assert!(in_reach(tch::Device::Cpu) && !in_reach(tch::Device::Cuda(0)));
    }

    #[test]
    fn the_trial_by_hand() {
        assert_eq!(multiply_on(tch::Device::Cpu).unwrap(), 4.0);
    }

    #[test]
    fn a_device_that_cannot_be_used_says_so() {
        match Device::Cuda.open() {
            Ok(device) => assert_eq!(device, tch::Device::Cuda(0)),
            Err(error) => {
                assert_eq!(error.to_string(), "device cuda");
                let cause = error.source().unwrap().to_string();
                assert!(cause.contains("CUDA") || cause.contains("libtorch_cuda.so"), "{cause}");
            }
        }
    }

    #[test]
    fn a_library_that_is_missing_or_something_else_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let library = folder.path().join("libtorch_cuda.so");
        let expected = format!("{} is missing; point LD_LIBRARY_PATH at the lib folder", library.display());
        let missing = load_cuda(folder.path()).unwrap_err().to_string();
        assert!(missing.starts_with(&expected), "{missing}");
        std::fs::write(&library, "no library").unwrap();
        let garbage = load_cuda(folder.path()).unwrap_err();
        assert_eq!(garbage.to_string(), format!("{} does not load", library.display()));
        assert!(garbage.source().is_some_and(|cause| !cause.to_string().is_empty()));
    }
}
