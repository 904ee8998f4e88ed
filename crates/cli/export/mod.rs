//! `wisdom export`: a logged decision in the languages of other tools.

mod dot;
mod pddl;

use std::path::Path;
use std::process::ExitCode;

use clap::Subcommand;
use wisdom_logbook::LogReader;

use crate::exit::InputError;

/// Hand a logged decision to other tools.
#[derive(clap::Args, Debug)]
pub(crate) struct ExportArgs {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand, Debug)]
enum Command {
    /// Draw what must precede what in the chosen sequence, in the DOT language of Graphviz.
    Dot(dot::DotArgs),
    // Without a doc comment: one here would hide that of `PddlArgs`, which says what the files hold.
    Pddl(pddl::PddlArgs),
}

pub(crate) fn run(args: &ExportArgs) -> anyhow::Result<ExitCode> {
    match &args.command {
        Command::Dot(args) => dot::run(args),
        Command::Pddl(args) => pddl::run(args),
    }
}

/// Refuses a decision that the log does not hold, before anything is derived.
fn check_decision(path: &Path, log: &LogReader, wanted: u32) -> Result<(), InputError> {
    if log.decisions().any(|d| d.number == wanted) {
        return Ok(());
    }
    let decisions = log.decisions().count();
    Err(InputError(format!(
        "{}: no decision {wanted}; the log holds {decisions}, counted from 0",
        path.display()
    )))
}
