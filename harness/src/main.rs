//! The `goalbench` program: the built-in environments and curricula behind the command line.

fn main() {
    goalbench::cli::main(goalbench::Registry::builtin().of_program(goalbench::program!()))
}
