//! `goalbench quickstart`.

use std::ffi::{OsStr, OsString};

use super::{Cli, Command, Exit, ExitCode, complain, misuse, report, run, without_a_command};
use crate::Registry;
use crate::console::word;

#[derive(clap::Args)]
#[command(after_help = "`goalbench protocol show quickstart` prints what is run.")]
pub(super) struct Args {
    /// Arguments for `goalbench run`, such as --out DIR, --jobs N or --steps N
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, value_name = "ARGUMENTS")]
    arguments: Vec<OsString>,
}

/// Runs the preset `quickstart`, and draws its report once all runs have ended well.
pub(super) fn quickstart(registry: &Registry, args: &Args) -> Exit {
    let words = ["run", "--preset", "quickstart"].into_iter().map(OsStr::new);
    let run = match command(words.chain(args.arguments.iter().map(OsString::as_os_str))) {
        Ok(Command::Run(run)) => run,
        Ok(_) => return Ok(ExitCode::WrongInput),
        Err(answer) => return Ok(without_a_command(answer)),
    };
    let code = run::run(registry, &run)?;
    let Some(results) = run.results("quickstart").filter(|_| code == ExitCode::Success) else {
        return Ok(code);
    };
    match command([OsStr::new("report"), OsStr::new("--quiet"), results.as_os_str()]) {
        Ok(Command::Report(args)) => {
            let code = report::report(registry, &args)?;
            let page = reports::store::layout::report_dir(&results).join("index.html");
            complain(&format!("goalbench: figures and tables are in {}", word(&page)));
            Ok(code)
        }
        Ok(_) => Ok(ExitCode::WrongInput),
        Err(answer) => Ok(without_a_command(answer)),
    }
}

/// What these words after the program's name ask for.
fn command<'a>(words: impl IntoIterator<Item = &'a OsStr>) -> Result<Command, clap::Error> {
    let program = OsStr::new("goalbench");
    misuse::parse_from(std::iter::once(program).chain(words)).map(|cli: Cli| cli.command)
}
