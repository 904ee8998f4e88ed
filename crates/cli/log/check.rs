//! `wisdom log check`: whether a log is what was written.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use serde_json::json;
use wisdom_logbook::Status;
use wisdom_logbook::read::Verdict;

use crate::exit::{FAILED, LOSSY};

/// Check everything about a log that can be checked without deciding anything again.
///
/// Every checksum; that indexes and summary say what the data hold; that observations, messages and decisions
/// have no gaps; that decisions follow from their chain and end as the end record says; that time stamps rise.
/// `wisdom verify` goes further and derives the decisions again. Exit codes: 0 everything holds; 1 something
/// does not; 3 what is there holds, but the log ends before the run did.
#[derive(clap::Args, Debug)]
pub(crate) struct CheckArgs {
    /// The log (NAME.mcap or NAME.mcap.part).
    log: PathBuf,
    /// Print one JSON object instead of text.
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &CheckArgs) -> anyhow::Result<ExitCode> {
    let found = wisdom_logbook::check(&args.log)?;
    let mut out = std::io::stdout().lock();
    let told = |verdict: &Verdict| match verdict {
        Verdict::Holds => ("holds", None),
        Verdict::Fails(detail) => ("FAILS", Some(detail.clone())),
        Verdict::Unchecked(detail) => ("unknown", Some(detail.clone())),
        _ => ("unknown", None),
    };
    if args.json {
        let object = json!({
            "log": args.log.display().to_string(),
            "status": found.status.to_string(),
            "bytes": found.bytes,
            "sound_to_byte": found.sound,
            "decisions": found.decisions,
            "messages": found.messages,
            "findings": found.findings.iter().map(|finding| {
                let (verdict, detail) = told(&finding.verdict);
                json!({ "what": finding.what, "verdict": verdict.to_lowercase(), "detail": detail })
            }).collect::<Vec<_>>(),
        });
        writeln!(out, "{object}")?;
    } else {
        for finding in &found.findings {
            let (verdict, detail) = told(&finding.verdict);
            let detail = detail.map_or_else(String::new, |detail| format!(": {detail}"));
            writeln!(out, "{verdict:<8} {}{detail}", finding.what)?;
        }
        writeln!(
            out,
            "{}: {} decisions and {} messages in {} bytes, the log is {}",
            args.log.display(),
            found.decisions,
            found.messages,
            found.bytes,
            found.status
        )?;
    }
    Ok(match found.status {
        Status::Complete => ExitCode::SUCCESS,
        Status::Truncated { .. } => ExitCode::from(LOSSY),
        Status::Corrupt { .. } => ExitCode::from(FAILED),
    })
}
