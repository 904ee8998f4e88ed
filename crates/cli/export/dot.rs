//! `wisdom export dot`: the causal links of a chosen sequence.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Context;
use wisdom_logbook::LogReader;

use crate::exit::InputError;

/// Draw what must precede what in the chosen sequence, in the DOT language of Graphviz.
#[derive(clap::Args, Debug)]
pub(crate) struct DotArgs {
    /// The log (NAME.mcap or NAME.mcap.part).
    log: PathBuf,
    /// The decision.
    #[arg(long, value_name = "N")]
    decision: u32,
    /// Where the text goes; to standard output by default.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

pub(super) fn run(args: &DotArgs) -> anyhow::Result<ExitCode> {
    if let Some(path) = &args.output {
        let is_ours = std::fs::read(path).map_or(true, |bytes| bytes.starts_with(b"digraph"));
        if !is_ours {
            let refused = format!("-o {}: is there already, and is no graph", path.display());
            return Err(InputError(refused).into());
        }
    }
    let log = LogReader::open(&args.log)?;
    super::check_decision(&args.log, &log, args.decision)?;
    let dot = wisdom_logbook::causal_dot(&log, args.decision)?;
    let mut out = std::io::stdout().lock();
    match &args.output {
        None => writeln!(out, "{dot}")?,
        Some(path) => {
            let name = path.display();
            std::fs::write(path, format!("{dot}\n")).with_context(|| name.to_string())?;
            writeln!(out, "{name}")?;
        }
    }
    Ok(crate::exit::of_log(&log))
}
