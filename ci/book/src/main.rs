//! `cargo book`: makes a book of the pages in `harness/docs`, in `target/book`.

mod links;
mod make;

use std::path::Path;
use std::process::ExitCode;

/// The project's folder.
pub(crate) const PROJECT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

fn main() -> ExitCode {
    let (project, out) = (Path::new(PROJECT), Path::new("target/book"));
    match make::book(project, &project.join(out)) {
        Ok(()) => {
            println!("{}", out.join("index.html").display());
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("book: {error:#}");
            ExitCode::FAILURE
        }
    }
}
