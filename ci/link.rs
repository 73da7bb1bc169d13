//! Shared by the build scripts of the crates that link a native library (`#[path = "../ci/link.rs"] mod
//! link;`).
//!
//! Neither torch-sys nor mujoco-rs can set a run-time search path for the crates above it: cargo applies link
//! arguments only to the package whose build script prints them. So each of those packages sets its own,
//! absolute, and its binaries, tests, benches and examples start from any folder, whatever the target folder
//! or `RUSTFLAGS`.

use std::{env, path::Path};

/// Lets this package's binaries find `library` at run time in the folder that the environment variable
/// `variable` names.
///
/// The path goes in as RUNPATH, which `LD_LIBRARY_PATH` overrides: another build of the same library can be
/// tried without linking again. Fails the build with one line when the library is not there.
pub(crate) fn search_at_run_time(variable: &str, library: &str) {
    println!("cargo::rerun-if-env-changed={variable}");
    let Some(folder) = env::var_os(variable) else {
        println!(
            "cargo::error={variable} is not set: build inside the project folder, whose .cargo/config.toml sets it"
        );
        return;
    };
    let path = Path::new(&folder).join(library);
    // If the library goes missing later, the line below must say so, rather than the loader when a program
    // starts.
    println!("cargo::rerun-if-changed={}", path.display());
    if !path.is_file() {
        println!("cargo::error=native libraries are missing (no {}): run `cargo setup`", path.display());
        return;
    }
    // -Xlinker rather than -Wl, so that a comma in the path does no harm.
    for argument in ["--enable-new-dtags", "-rpath", &folder.to_string_lossy()] {
        println!("cargo::rustc-link-arg=-Xlinker");
        println!("cargo::rustc-link-arg={argument}");
    }
}
