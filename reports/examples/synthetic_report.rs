//! Makes up results and reports them: `cargo run --release -p reports --example synthetic_report -- FOLDER`.
//!
//! The folder gets results of the size of a whole paper, ablations included, with their report; the seconds
//! and the memory that the report took are printed.

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use reports::analysis::catalogue::MazeInfo;
use reports::synthetic::{self, Experiment};
use reports::{ReportError, ReportOptions, Written};

#[expect(clippy::print_stdout, clippy::print_stderr, reason = "a program's output")]
fn main() -> ExitCode {
    let Some(results) = std::env::args_os().nth(1).map(PathBuf::from) else {
        eprintln!("usage: synthetic_report FOLDER");
        return ExitCode::FAILURE;
    };
    let made = Experiment::paper().iter().try_for_each(|experiment| experiment.write(&results));
    let start = Instant::now();
    match made.and_then(|()| write(&results)) {
        Ok(written) => {
            written.files.iter().for_each(|file| println!("{}", file.display()));
            let seconds = start.elapsed().as_secs_f64();
            let memory =
                peak_memory().map_or_else(String::new, |kib| format!(", at most {} MiB", kib / 1024));
            println!("{} runs, {} evaluations: {seconds:.1} s{memory}", written.runs, written.evaluations);
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

/// The most memory that this process ever had resident, in KiB, where the system tells (Linux).
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.split_whitespace().next()?.parse().ok()
}

/// Reports on made-up mazes without inner walls.
fn write(results: &std::path::Path) -> Result<Written, ReportError> {
    let line = |row: usize| if row == 0 || row == 12 { "#############" } else { "#...........#" };
    let mut grid: Vec<String> = (0..13).map(|row| line(row).to_owned()).collect();
    grid[1].replace_range(1..2, "S");
    let maze = |id: &str| MazeInfo { id: id.to_owned(), grid: grid.clone() };
    let mut catalogue = synthetic::catalogue();
    catalogue.mazes = ["RoomA", "RoomB", "RoomC"].map(maze).to_vec();
    reports::write(results, &ReportOptions { catalogue, ..ReportOptions::default() })
}
