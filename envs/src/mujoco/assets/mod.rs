//! Model files: where they lie, and one loaded copy per process of each.

mod manifest;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use mujoco_rs::wrappers::mj_model::{MjModel, MjtEq};
use serde::{Deserialize, Serialize};

use super::library;
use crate::error::EnvError;

/// MuJoCo's `mjDSBL_NATIVECCD` flag: collide convex shapes with libccd instead of MuJoCo's own algorithm.
pub(crate) const DISABLE_NATIVE_CCD: i32 = 1 << 17;
/// What the reference writes over the first seven numbers of every weld: no offset, and an identity rotation
/// whose 1 stands last.
const WELD: [f64; 7] = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];

/// Which collision detection MuJoCo uses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Physics {
    /// Native CCD disabled, as it was by default when the paper was written.
    #[default]
    Paper,
    /// Native CCD on: what a plain install of the reference environments does.
    NativeCcd,
}

/// The folder with the model files: `$GOALBENCH_ASSETS`, or where `cargo setup` puts them.
pub(crate) fn folder() -> PathBuf {
    std::env::var_os("GOALBENCH_ASSETS")
        .map_or_else(|| Path::new(env!("GOALBENCH_NATIVE")).join("assets"), PathBuf::from)
}

type Cache = Mutex<BTreeMap<(PathBuf, Physics), Arc<MjModel>>>;

/// The model in `file`, a path below [`folder`] such as `fetch/reach.xml`. Environments share one copy.
///
/// # Errors
/// [`EnvError::MujocoVersion`], [`EnvError::Asset`].
pub(crate) fn model(file: &str, physics: Physics) -> Result<Arc<MjModel>, EnvError> {
    model_in(&folder(), file, physics)
}

fn model_in(folder: &Path, file: &str, physics: Physics) -> Result<Arc<MjModel>, EnvError> {
    static MODELS: Cache = Mutex::new(BTreeMap::new());
    library::prepare()?;
    let path = folder.join(file);
    // A poisoned lock only means that another thread died. Models are inserted when they are complete.
    let mut models = MODELS.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(model) = models.get(&(path.clone(), physics)) {
        return Ok(Arc::clone(model));
    }
    let family = file.split('/').next().unwrap_or_default();
    manifest::check(folder, family)?;
    let model = Arc::new(load(&path, physics)?);
    models.insert((path, physics), Arc::clone(&model));
    Ok(model)
}

fn load(path: &Path, physics: Physics) -> Result<MjModel, EnvError> {
    let broken =
        |reason: &str, source| EnvError::Asset { path: path.to_owned(), reason: reason.into(), source };
    // MjModel::from_xml panics on paths that cannot be passed to C.
    if path.to_str().is_none_or(|text| text.contains('\0')) {
        return Err(broken("MuJoCo needs a path in UTF-8", None));
    }
    let mut model =
        MjModel::from_xml(path).map_err(|error| broken("MuJoCo refuses it", Some(error.into())))?;
    if physics == Physics::Paper {
        model.opt_mut().disableflags |= DISABLE_NATIVE_CCD;
    }
    let welds: Vec<bool> = model.eq_type().iter().map(|&kind| kind == MjtEq::mjEQ_WELD).collect();
    for (data, _) in model.eq_data_mut().iter_mut().zip(welds).filter(|(_, weld)| *weld) {
        data[..7].copy_from_slice(&WELD);
    }
    Ok(model)
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::sync::Arc;

    use super::{Physics, folder, model, model_in};

    #[test]
    fn environments_share_a_model_unless_their_physics_differ() {
        let first = model("fetch/reach.xml", Physics::Paper).unwrap();
        assert!(Arc::ptr_eq(&first, &model("fetch/reach.xml", Physics::Paper).unwrap()));
        let native = model("fetch/reach.xml", Physics::NativeCcd).unwrap();
        assert_eq!((first.opt().disableflags, native.opt().disableflags), (131_072, 0));
    }

    /// The files of the Fetch models in a folder of their own.
    fn copied_assets() -> tempfile::TempDir {
        let copy = tempfile::tempdir().unwrap();
        for part in ["fetch", "stls/fetch", "textures"] {
            fs::create_dir_all(copy.path().join(part)).unwrap();
            for entry in fs::read_dir(folder().join(part)).unwrap() {
                let source = entry.unwrap().path();
                let target = copy.path().join(part).join(source.file_name().unwrap());
                fs::copy(source, target).unwrap();
            }
        }
        copy
    }

    #[test]
    fn missing_and_damaged_files_are_named_and_not_remembered() {
        let assets = copied_assets();
        let load = || model_in(assets.path(), "fetch/push.xml", Physics::Paper);
        for file in ["fetch/push.xml", "fetch/robot.xml", "stls/fetch/gripper_link.stl", "textures/block.png"]
        {
            let path = assets.path().join(file);
            let intact = fs::read(&path).unwrap();
            let mut one_byte = intact.clone();
            one_byte[intact.len() / 2] ^= 1;
            for damaged in [None, Some(&intact[..intact.len() / 2]), Some(one_byte.as_slice())] {
                match damaged {
                    None => fs::remove_file(&path).unwrap(),
                    Some(bytes) => fs::write(&path, bytes).unwrap(),
                }
                let error = load().unwrap_err().to_string();
                assert!(error.contains(file) && error.contains("cargo setup"), "{error}");
            }
            fs::write(&path, intact).unwrap();
        }
        load().unwrap();
    }

    #[test]
    fn a_path_that_c_cannot_be_told_is_an_error() {
        let folder = std::path::Path::new("assets\0");
        assert!(super::load(&folder.join("fetch/push.xml"), Physics::Paper).is_err());
    }
}
