//! `wisdom log recover`: what a broken log still holds, saved.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use serde_json::json;

use crate::exit::LOSSY;

/// Copy what a broken log holds before its first fault into a new, whole log.
///
/// Nothing before the fault is dropped or changed: messages, files and facts stay as they are; indexes and
/// checksums are made anew. Nothing after the fault is taken, because a log with a hole would not verify. The
/// new log says what was lost (`wisdom.recovered`) and, unless the run's own end was kept, that the run did not end.
/// Exit codes: 0 nothing was lost; 3 something was.
#[derive(clap::Args, Debug)]
pub(crate) struct RecoverArgs {
    /// The broken log (NAME.mcap or NAME.mcap.part).
    log: PathBuf,
    /// The new log; never one that exists.
    out: PathBuf,
    /// Print one JSON object instead of text.
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &RecoverArgs) -> anyhow::Result<ExitCode> {
    let saved = wisdom_logbook::recover(&args.log, &args.out)?;
    let mut out = std::io::stdout().lock();
    if args.json {
        let object = json!({
            "log": args.log.display().to_string(),
            "out": args.out.display().to_string(),
            "log_was": saved.status.to_string(),
            "kept_to_byte": saved.kept_to,
            "bytes_left_out": saved.left_out,
            "run_ended": saved.ended,
            "decisions": saved.decisions,
            "messages": saved.messages,
            "attachments": saved.attachments,
            "lossy": saved.lossy,
        });
        writeln!(out, "{object}")?;
    } else {
        writeln!(out, "the log was {}", saved.status)?;
        writeln!(
            out,
            "kept        {} decisions, {} messages, {} files: everything up to byte {}",
            saved.decisions, saved.messages, saved.attachments, saved.kept_to
        )?;
        match (saved.lossy, saved.left_out) {
            (false, _) => writeln!(out, "left out    nothing")?,
            (true, 0) => writeln!(
                out,
                "left out    no bytes, but a fact or the end of the run is not what was written"
            )?,
            (true, bytes) => writeln!(out, "left out    {bytes} bytes")?,
        }
        let end = if saved.ended { "kept" } else { "none: the run did not end" };
        writeln!(out, "end         {end}")?;
        writeln!(out, "log         {}", args.out.display())?;
    }
    Ok(if saved.lossy { ExitCode::from(LOSSY) } else { ExitCode::SUCCESS })
}
