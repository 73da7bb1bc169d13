//! `goalbench quickstart`.

use std::ffi::{OsStr, OsString};
use std::io::Write as _;

use super::{Cli, Command, Exit, ExitCode, complain, misuse, report, run, without_a_command};
use crate::Registry;
use crate::console::word;
use crate::error::HarnessError;

/// What is run.
const PRESET: &str = "quickstart";

#[derive(clap::Args)]
#[command(after_help = "`goalbench protocol show quickstart` prints what is run.")]
pub(super) struct Args {
    /// Arguments for `goalbench run`, such as --out DIR, --jobs N or --steps N
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, value_name = "ARGUMENTS")]
    arguments: Vec<OsString>,
}

/// Runs the preset `quickstart`, and draws its report once all runs have ended well.
pub(super) fn quickstart(registry: &Registry, args: &Args) -> Exit {
    let words = ["run", "--preset", PRESET].into_iter().map(OsStr::new);
    let run = match command(words.chain(args.arguments.iter().map(OsString::as_os_str))) {
        Ok(Command::Run(run)) => run,
        Ok(_) => return Ok(ExitCode::WrongInput),
        Err(answer) if answer.use_stderr() => {
            // The words are the user's, the command `run` is not.
            let text = misuse::text::<Cli>(answer).replace("goalbench run", "goalbench quickstart");
            let _ = std::io::stderr().write_all(text.as_bytes());
            return Ok(ExitCode::WrongInput);
        }
        Err(answer) => return Ok(without_a_command(answer)),
    };
    if !run.is_preset(PRESET) {
        let reason = format!("runs the preset `{PRESET}`; `goalbench run` takes other protocols");
        return Err(HarnessError::Argument { option: "quickstart", reason });
    }
    let code = run::run(registry, &run)?;
    let Some(results) = run.results(PRESET).filter(|_| code == ExitCode::Success) else {
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
