//! libtorch's switch for TF32.
//!
//! tch has no call for it, so this looks up libtorch's own, `setAllowTF32CuBLAS` and `allowTF32CuBLAS` of
//! `at::globalContext()`, by the names that C++ compilers give them on Linux.

use std::ffi::c_void;

use libloading::os::unix::{Library, Symbol};

use crate::error::SwitchProblem;
use crate::runtime::libtorch_version;

type Context = unsafe extern "C-unwind" fn() -> *mut c_void;
type Set = unsafe extern "C-unwind" fn(*mut c_void, bool);
type Get = unsafe extern "C-unwind" fn(*const c_void) -> bool;

/// Lets products of singles on a GPU round their factors to TF32, or not. It holds for the whole process: the
/// student that was made last decides, and those of a process are alike, since its runs keep step.
///
/// # Errors
/// If this libtorch does not show such a switch, or it does not stay as it was set: `PyTorch`'s environment
/// variable `TORCH_ALLOW_TF32_CUBLAS_OVERRIDE` can hold it on.
pub(crate) fn allow(wanted: bool) -> Result<(), SwitchProblem> {
    let now = switch(wanted)?;
    if now == wanted { Ok(()) } else { Err(SwitchProblem::Stays(if now { "on" } else { "off" })) }
}

/// Sets the switch, and reads it.
#[allow(unsafe_code, reason = "calls C++ functions of libtorch that no header of tch declares")]
fn switch(wanted: bool) -> Result<bool, SwitchProblem> {
    let missing = |source| SwitchProblem::Missing { version: libtorch_version(), source };
    let this = Library::this();
    // SAFETY: these are the signatures in ATen/Context.h, where a member function takes its object first. The
    // context is a static of libtorch, which is never unloaded; set and get touch a few of its fields. They
    // may throw, which "C-unwind" allows for.
    unsafe {
        let context: Symbol<Context> = this.get(b"_ZN2at13globalContextEv\0").map_err(missing)?;
        let set: Symbol<Set> = this.get(b"_ZN2at7Context18setAllowTF32CuBLASEb\0").map_err(missing)?;
        let get: Symbol<Get> = this.get(b"_ZNK2at7Context15allowTF32CuBLASEv\0").map_err(missing)?;
        let context = context();
        set(context, wanted);
        Ok(get(context))
    }
}

#[cfg(test)]
mod tests {
    use super::{allow, switch};

    /// libtorch's own answer, on any machine; what a GPU makes of it is another question.
    #[test]
    fn the_switch_is_found_and_stays_as_it_is_set() {
        assert!(switch(true).unwrap());
        allow(true).unwrap();
        assert!(!switch(false).unwrap());
        allow(false).unwrap();
    }
}
