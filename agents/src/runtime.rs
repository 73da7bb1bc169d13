//! The libtorch that this process runs on: its threads, its version and its folder.

use std::path::{Path, PathBuf};
use std::sync::Once;

/// Limits libtorch to one thread for students on the calling thread. Call it first on every thread that makes
/// or trains a student.
///
/// With one thread each, runs are reproducible to the byte. Several one-thread runs side by side also do as
/// much work as one run on several threads, and no OpenMP threads spin while they wait for a busy processor.
pub fn prepare_thread() {
    // The thread count is a setting of each thread, the interoperability pool one of the process.
    static ONCE: Once = Once::new();
    ONCE.call_once(|| tch::set_num_interop_threads(1));
    tch::set_num_threads(1);
}

/// Name and version of every native library that the student needs.
pub fn versions() -> Vec<(&'static str, String)> {
    vec![("libtorch", libtorch_version())]
}

/// The version of the loaded libtorch, as in `2.11.0`.
#[allow(unsafe_code, reason = "libtorch's C interface has no safe wrapper for its version")]
pub(crate) fn libtorch_version() -> String {
    unsafe extern "C" {
        /// Major, minor and patch in the three highest bytes.
        fn aoti_torch_abi_version() -> u64;
    }
    // SAFETY: the function takes nothing, changes nothing and is exported by the libtorch linked here.
    let [major, minor, patch, ..] = unsafe { aoti_torch_abi_version() }.to_be_bytes();
    format!("{major}.{minor}.{patch}")
}

/// The folder that the running process loaded `libtorch_cpu.so` from.
pub(crate) fn libtorch_folder() -> Option<PathBuf> {
    folder_of(&std::fs::read_to_string("/proc/self/maps").ok()?, "libtorch_cpu.so")
}

/// The folder of the mapped file called `name` in the text of `/proc/self/maps`.
fn folder_of(maps: &str, name: &str) -> Option<PathBuf> {
    maps.lines()
        .filter_map(|line| line.find('/').map(|start| Path::new(&line[start..])))
        .find(|path| path.file_name().is_some_and(|file| file == name))
        .and_then(|path| path.parent().map(Path::to_owned))
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::{folder_of, libtorch_folder, prepare_thread, versions};

    #[test]
    fn finds_a_library_among_the_mappings() {
        let maps = "7f00-7f01 r--p 00000000 08:01 12 /usr/lib/libc.so.6\n\
                    7f02-7f03 r-xp 00001000 08:01 13 /opt/torch lib/libtorch_cpu.so\n\
                    7f04-7f05 rw-p 00000000 00:00 0 [heap]\n";
        assert_eq!(folder_of(maps, "libtorch_cpu.so"), Some(PathBuf::from("/opt/torch lib")));
        assert_eq!(folder_of(maps, "libtorch_cuda.so"), None);
    }

    #[test]
    fn the_loaded_libtorch_is_found_and_is_the_one_tch_was_made_for() {
        assert!(libtorch_folder().unwrap().join("libtorch_cpu.so").is_file());
        let (name, version) = &versions()[0];
        assert_eq!(*name, "libtorch");
        assert!(version.starts_with("2.11."), "{version}");
    }

    #[test]
    fn every_thread_is_limited_to_one() {
        for _ in 0..2 {
            std::thread::spawn(|| {
                prepare_thread();
                assert_eq!(tch::get_num_threads(), 1);
            })
            .join()
            .unwrap();
        }
    }
}
