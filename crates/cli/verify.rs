//! `wisdom verify`: every decision derived again from what was logged.

use std::io::{IsTerminal, Write};
use std::path::PathBuf;
use std::process::ExitCode;

use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;
use wisdom_logbook::Status;

use crate::exit::{FAILED, LOSSY};

/// Derive every decision of a log again from its logged inputs and compare.
#[derive(clap::Args, Debug)]
pub(crate) struct VerifyArgs {
    /// The log (NAME.mcap or NAME.mcap.part).
    log: PathBuf,
    /// Print one JSON object instead of text.
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &VerifyArgs) -> anyhow::Result<ExitCode> {
    let shown = !args.json && std::io::stderr().is_terminal();
    let bar = if shown { ProgressBar::new_spinner() } else { ProgressBar::hidden() };
    bar.set_style(ProgressStyle::with_template(
        "{spinner} {pos} decisions derived again  {elapsed}",
    )?);
    let found = wisdom_logbook::verify(&args.log, &mut |_| bar.inc(1))?;
    bar.finish_and_clear();
    let mut out = std::io::stdout().lock();
    let identical = found.difference.is_none();
    if args.json {
        let object = json!({
            "log": args.log.display().to_string(),
            "identical": identical,
            "decisions": found.decisions,
            "log_status": found.status.to_string(),
            "chain": found.chain,
            "difference": found.difference.as_ref().map(|d| json!({
                "decision": d.decision, "stage": d.stage, "field": d.path,
                "logged": d.left, "derived": d.right,
            })),
            "remarks": found.remarks,
        });
        writeln!(out, "{object}")?;
    } else {
        for remark in &found.remarks {
            writeln!(out, "remark: {remark}")?;
        }
        match &found.difference {
            None => writeln!(
                out,
                "identical: {} decisions derived again from the logged inputs; log {}, chain {}",
                found.decisions, found.status, found.chain
            )?,
            Some(d) => {
                writeln!(out, "DIFFERENT: {d}")?;
                writeln!(out, "{} decisions before it agree", found.decisions)?;
            }
        }
    }
    Ok(match (&found.difference, &found.status) {
        (None, Status::Complete) => ExitCode::SUCCESS,
        (None, Status::Truncated { .. }) => ExitCode::from(LOSSY),
        _ => ExitCode::from(FAILED),
    })
}
