//! `goalbench report`.

use std::path::PathBuf;

use reports::environment::{EnvironmentInfo, MazeInfo};
use reports::report::Options;

use super::{Exit, ExitCode, complain, print};
use crate::Registry;

#[derive(clap::Args)]
pub(super) struct Args {
    /// Results folder, as written by `goalbench run`
    results: PathBuf,
}

pub(super) fn report(registry: &Registry, args: &Args) -> Exit {
    let written = reports::report::write(&args.results, &options(registry))?;
    for path in &written.files {
        print(&format!("{}\n", path.display()));
    }
    for missing in &written.missing {
        complain(&format!("missing: {missing}"));
    }
    for problem in &written.problems {
        complain(&format!("goalbench: {problem}"));
    }
    Ok(if written.problems.is_empty() { ExitCode::Success } else { ExitCode::Failed })
}

/// What a report should know of the environments: it knows none itself.
fn options(registry: &Registry) -> Options {
    let environments = registry.environments().iter().map(|entry| EnvironmentInfo {
        id: entry.spec.id.to_owned(),
        state: entry.spec.state,
        goal: entry.spec.goal,
        action: entry.spec.action,
        horizon: entry.spec.horizon,
        paper_action: entry.paper.map(|paper| paper.action),
        note: entry.paper.map_or_else(String::new, |paper| paper.note.to_owned()),
    });
    let mazes = registry.environments().iter().filter_map(|entry| {
        let walls = entry.walls?;
        Some(MazeInfo {
            id: entry.spec.id.to_owned(),
            grid: walls.iter().map(|row| (*row).to_owned()).collect(),
        })
    });
    Options { environments: environments.collect(), mazes: mazes.collect(), ..Options::default() }
}
