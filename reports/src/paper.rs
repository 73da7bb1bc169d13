//! What the paper (TEACH, arXiv 2512.22824) compares.

/// Its own method, as a curriculum id.
pub const METHOD: &str = "teach";

/// Its baselines, as curriculum ids.
pub const BASELINES: [&str; 4] = ["vds", "procurl", "space", "her-iid"];

/// The control that the paper lacks, as a curriculum id: goals of the pool that nobody chooses.
pub const CONTROL: &str = "her-iid-pool";

/// Its environments, as environment ids. Where its names and its appendix B describe different goals, the task counts
/// as there under either id: first that of the name, then those of the appendix.
pub const TASKS: [&[&str]; 11] = [
    &["MazeA"],
    &["MazeB"],
    &["MazeC"],
    &["FetchReach"],
    &["FetchPush"],
    &["FetchSlide"],
    &["FetchPickAndPlace"],
    &["HandReach"],
    &["HandManipulateBlock", "HandManipulateBlockRotateZ", "HandManipulateBlockRotateParallel"],
    &["HandManipulatePen", "HandManipulatePenRotate"],
    &["HandManipulateEgg", "HandManipulateEggRotate"],
];

/// All its methods.
pub fn methods() -> impl Iterator<Item = &'static str> {
    std::iter::once(METHOD).chain(BASELINES)
}
