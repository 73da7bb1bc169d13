//! The `goalbench` program: the built-in environments and curricula behind the command line.

use std::process::ExitCode;

fn main() -> ExitCode {
    goalbench::cli::main(goalbench::Registry::builtin().of_program(goalbench::program!()))
}
