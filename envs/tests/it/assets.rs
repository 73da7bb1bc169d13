//! Where the model files come from.

use std::path::Path;
use std::process::{Command, Output};

use envs::{EnvError, EnvOptions, make};

/// Builds FetchReach in a process of its own, whose assets lie in `folder`.
fn build_with_assets_in(folder: &Path, work: &Path) -> Output {
    Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "assets::build_fetch_reach", "--ignored"])
        .env("GOALBENCH_ASSETS", folder)
        .current_dir(work)
        .output()
        .unwrap()
}

#[test]
#[ignore = "the process that the test below starts"]
fn build_fetch_reach() {
    if let Err(error) = make("FetchReach", &EnvOptions::default()) {
        assert!(matches!(error, EnvError::Asset { .. }));
        panic!("{error}");
    }
}

#[test]
fn the_asset_folder_can_be_chosen_at_run_time() {
    let work = tempfile::tempdir().unwrap();
    let installed = Path::new(env!("GOALBENCH_NATIVE")).join("assets");
    let built = build_with_assets_in(&installed, work.path());
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));

    let refused = build_with_assets_in(&work.path().join("nowhere"), work.path());
    let message =
        [refused.stderr, refused.stdout].map(|text| String::from_utf8_lossy(&text).into_owned()).concat();
    assert!(!refused.status.success() && message.contains("nowhere/fetch/"), "{message}");
    assert!(message.contains("`cargo setup` restores it"), "{message}");
    assert_eq!(
        std::fs::read_dir(work.path()).unwrap().count(),
        0,
        "nothing is written into the current folder"
    );
}
