//! `wisdom log`: what is in a log, whether it holds, what a broken one still has, and the maps it leaves out.

mod cat;
mod check;
mod expand;
mod info;
mod recover;

use std::process::ExitCode;

use clap::Subcommand;

/// Look into a log, check it, save what a broken one still holds, or make the maps it leaves out.
///
/// Every command takes finished logs (NAME.mcap), logs that are being written and logs that a killed run left
/// (NAME.mcap.part). Exit codes: 0 the log is whole; 1 something in it is not what was written; 2 a mistake in what was
/// given; 3 it ends before the run did, or something was lost.
#[derive(clap::Args, Debug)]
pub(crate) struct LogArgs {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand, Debug)]
enum Command {
    // Without doc comments: they would hide those of the arguments, which say more.
    Info(info::InfoArgs),
    Check(check::CheckArgs),
    Recover(recover::RecoverArgs),
    Cat(cat::CatArgs),
    // As above.
    Expand(expand::ExpandArgs),
}

pub(crate) fn run(args: &LogArgs) -> anyhow::Result<ExitCode> {
    match &args.command {
        Command::Info(args) => info::run(args),
        Command::Check(args) => check::run(args),
        Command::Recover(args) => recover::run(args),
        Command::Cat(args) => cat::run(args),
        Command::Expand(args) => expand::run(args),
    }
}
