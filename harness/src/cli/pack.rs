//! `goalbench pack`.

use std::collections::BTreeSet;
use std::path::PathBuf;

use reports::ReportOptions;
use reports::store::layout;
use reports::wording::counted;

use super::{Exit, ExitCode, print};
use crate::archive::{Packing, PolicyChoice, name_of, pack};
use crate::config::seeds;
use crate::error::HarnessError;
use crate::{Registry, outputs, paper};

#[derive(clap::Args)]
#[command(after_help = "\
The archive holds the records as they are and as Parquet, every run's complete config and outcome, the protocols, the \
chosen policies, checksums, and DATA.md, a dataset card. The same results give the same bytes. Results with damaged or \
unfinished runs are refused. `goalbench report --with` draws an archive beside other results.")]
pub(super) struct Args {
    /// Results folder, all of whose runs have ended
    results: PathBuf,
    /// Archive to write; a file of this name is replaced
    #[arg(long, value_name = "NAME.tar.zst")]
    out: PathBuf,
    /// Trained policies that come along: `first` (the lowest finished seed of each environment, curriculum
    /// and variant), `all`, `none`, or seeds such as 0..3
    #[arg(long, value_name = "WHICH", default_value = "first", value_parser = policies)]
    policies: PolicyChoice,
    /// What stays behind of every run, separated by commas. Most of an archive is `teaching`, what the
    /// teacher did; maps and films of where teachers sent students, and the ranks of their picks, need it
    #[arg(long, value_name = "WHAT,...", value_delimiter = ',')]
    without: Vec<Part>,
    /// Licence of the data, as an SPDX id
    #[arg(long, value_name = "ID", default_value = "CC-BY-4.0", value_parser = licence)]
    licence: String,
    /// What stands above the card [default: the names of the protocols]
    #[arg(long, value_name = "TEXT", value_parser = super::report::title)]
    title: Option<String>,
}

/// A file of a run that an archive can do without.
#[derive(Clone, Copy, clap::ValueEnum)]
enum Part {
    Teaching,
    Student,
    Frontier,
    Shadow,
}

impl Part {
    fn file(self) -> &'static str {
        match self {
            Self::Teaching => layout::TEACHING,
            Self::Student => layout::STUDENT,
            Self::Frontier => layout::FRONTIER,
            Self::Shadow => layout::SHADOW,
        }
    }
}

fn policies(text: &str) -> Result<PolicyChoice, String> {
    match text {
        "first" => Ok(PolicyChoice::First),
        "all" => Ok(PolicyChoice::All),
        "none" => Ok(PolicyChoice::None),
        seeds => {
            let wrong = |reason| format!("first, all, none or seeds are accepted: {reason}");
            seeds::parse(seeds).map(PolicyChoice::Seeds).map_err(wrong)
        }
    }
}

fn licence(text: &str) -> Result<String, &'static str> {
    let is_id = |byte: u8| byte.is_ascii_alphanumeric() || b"-.+".contains(&byte);
    let is_accepted = !text.is_empty() && text.bytes().all(is_id);
    is_accepted.then(|| text.to_owned()).ok_or("an SPDX id such as CC-BY-4.0 is accepted")
}

pub(super) fn run(registry: &Registry, args: &Args) -> Exit {
    name_of(&args.out).map_err(|reason| HarnessError::Argument { option: "--out", reason })?;
    outputs::file("--out", &args.out, &[])?;
    let read = [layout::runs_dir, layout::protocols_dir, layout::tuning_dir].map(|of| of(&args.results));
    outputs::outside("--out", &args.out, &read)?;
    // In one order, each once: however it is asked for, the same archive.
    let without: BTreeSet<_> = args.without.iter().map(|part| part.file()).collect();
    let packing = Packing {
        policies: args.policies.clone(),
        without: without.into_iter().collect(),
        licence: args.licence.clone(),
        title: args.title.clone(),
    };
    let options = ReportOptions { catalogue: paper::catalogue(registry), ..ReportOptions::default() };
    let packed = pack(registry, &args.results, &args.out, &options, &packing)?;
    let policies = match packed.policies {
        1 => "1 policy".to_owned(),
        count => format!("{count} policies"),
    };
    print(&format!(
        "{}: {}, {policies}, {:.2} MB\nSHA-256 {}\n",
        args.out.display(),
        counted(packed.runs, "run"),
        packed.bytes as f64 / 1e6,
        packed.sha256,
    ));
    Ok(ExitCode::Success)
}
