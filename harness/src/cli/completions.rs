//! `goalbench completions` and `goalbench man`: the command line as other programs want to know it.

use std::fs;
use std::path::{Path, PathBuf};

use clap::Command;
use clap_complete::Shell;
use clap_mangen::Man;

use super::{Exit, ExitCode, print};
use crate::error::HarnessError;
use crate::{Registry, outputs};

#[derive(clap::Args)]
#[command(after_help = "\
For bash: goalbench completions bash > ~/.local/share/bash-completion/completions/goalbench\n\
For zsh, a folder of $fpath: goalbench completions zsh > ~/.zfunc/_goalbench\n\
For fish: goalbench completions fish > ~/.config/fish/completions/goalbench.fish")]
pub(super) struct CompletionsArgs {
    /// The shell
    #[arg(value_enum)]
    shell: Shell,
}

#[derive(clap::Args)]
#[command(
    after_help = "Read one with `man DIR/goalbench.1`, or put them where `man goalbench` looks: ~/.local/share/man/man1."
)]
pub(super) struct ManArgs {
    /// Folder to write a page for each command into
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

/// Prints a script that completes commands and options.
pub(super) fn completions(registry: &Registry, program: &Command, args: &CompletionsArgs) -> Exit {
    let name = registry.program().map_or("goalbench", |program| program.name);
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut visible(program), name, &mut script);
    print(&String::from_utf8_lossy(&script));
    Ok(ExitCode::Success)
}

/// Writes the manual's pages.
pub(super) fn man(program: &Command, args: &ManArgs) -> Exit {
    outputs::folder("DIR", &args.folder, &[])?;
    fs::create_dir_all(&args.folder).map_err(HarnessError::io(&args.folder, "create this folder"))?;
    let mut program = visible(program);
    program.build();
    pages(&program, &args.folder)?;
    Ok(ExitCode::Success)
}

/// Writes the page of `command`, and those of the commands below it.
fn pages(command: &Command, folder: &Path) -> Result<(), HarnessError> {
    let man = Man::new(command.clone());
    let path = folder.join(man.get_filename());
    let mut page = Vec::new();
    man.render(&mut page)
        .and_then(|()| guard::fresh::write(&path, &page))
        .map_err(HarnessError::io(&path, "write this page"))?;
    print(&format!("{}\n", path.display()));
    command.get_subcommands().try_for_each(|below| pages(below, folder))
}

/// `program` without the commands that only the program itself gives.
pub(super) fn visible(program: &Command) -> Command {
    let shown = program.get_subcommands().filter(|command| !command.is_hide_set());
    let bare = Command::new("goalbench")
        .about(program.get_about().cloned().unwrap_or_default())
        .version(env!("GOALBENCH_VERSION"))
        .disable_help_subcommand(true);
    bare.args(program.get_arguments()).subcommands(shown)
}
