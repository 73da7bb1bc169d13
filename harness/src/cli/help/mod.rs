//! `goalbench help`.

mod commands;
mod paper;
mod records;
mod topics;

use super::{Exit, ExitCode, print};
use crate::Registry;
use crate::config::reference;
use crate::error::HarnessError;
use guard::text::short;
use topics::TOPICS;

#[derive(clap::Args)]
#[command(after_help = topics::listed())]
pub(super) struct Args {
    /// A command such as `run`, or a page; `config` takes a path after it and shows that part, as in `config
    /// student.noise`
    subject: Vec<String>,
}

pub(super) fn help(registry: &Registry, program: clap::Command, args: &Args) -> Exit {
    let subject: Vec<&str> = args.subject.iter().map(String::as_str).collect();
    let topic = |id: &str| TOPICS.iter().find(|topic| topic.id == id);
    let text = match subject.as_slice() {
        [id] if let Some(topic) = topic(id) => topic.page(registry, &program),
        ["config", path] => reference::part(registry, path).ok_or_else(|| {
            let fields = reference::fields(registry.config_schema());
            HarnessError::unknown("", "config field", path, fields.iter().map(|field| field.path.as_str()))
        })?,
        [id, word, ..] if topic(id).is_some() => {
            let path =
                if *id == "config" { "one path, as in `config student.noise`" } else { "no further word" };
            let reason = format!("the page `{id}` takes {path}; `{}` follows", short(word));
            return Err(HarnessError::Argument { option: "help", reason });
        }
        names => of_command(program, names)?,
    };
    print(&text);
    Ok(ExitCode::Success)
}

/// The long help of the command that `names` lead to.
fn of_command(mut program: clap::Command, names: &[&str]) -> Result<String, HarnessError> {
    program.build();
    let mut command = &mut program;
    for name in names {
        if command.find_subcommand(name).is_none() {
            let shown = command.get_subcommands().filter(|command| !command.is_hide_set());
            let known: Vec<&str> =
                shown.map(clap::Command::get_name).chain(TOPICS.iter().map(|topic| topic.id)).collect();
            return Err(HarnessError::unknown("", "command", name, known));
        }
        command = command.find_subcommand_mut(name).expect("it was found");
    }
    Ok(format!("{}\n", command.render_long_help()))
}
