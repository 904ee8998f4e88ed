//! `wisdom log expand`: the maps that a log leaves out, made again.

use std::io::{IsTerminal, Write};
use std::path::PathBuf;
use std::process::ExitCode;

use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;
use wisdom_logbook::{LogReader, MapMode};

/// Write a log again with the interest map at every decision, and further planes.
///
/// The maps are derived from the logged inputs, and every decision is held against its record on the way: what comes out is byte for
/// byte what the run would have written with the same `--maps`, and the planes besides.
#[derive(clap::Args, Debug)]
pub(crate) struct ExpandArgs {
    /// The log (NAME.mcap or NAME.mcap.part).
    log: PathBuf,
    /// The new log; never one that exists.
    out: PathBuf,
    /// Further planes at every decision: ignorance, paradox, conflict, contradiction, prize, hazard, blocked, reliability, a layer
    /// of the mission, NAME-u for a layer's uncertainty; of each expert mass-interesting-NAME, mass-not-interesting-NAME,
    /// mass-ignorance-NAME, mass-paradox-NAME, credit-NAME.
    #[arg(long, value_name = "PLANES", value_delimiter = ',')]
    planes: Vec<String>,
    /// Whole maps, or only what changed since the decision before.
    #[arg(long, value_name = "MAPS", value_parser = ["full", "patch"], default_value = "full")]
    maps: String,
    /// Print one JSON object instead of text.
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &ExpandArgs) -> anyhow::Result<ExitCode> {
    let log = LogReader::open(&args.log)?;
    let count = log.decisions().count();
    let shown = !args.json && std::io::stderr().is_terminal();
    let bar = if shown { ProgressBar::new(count as u64) } else { ProgressBar::hidden() };
    bar.set_style(ProgressStyle::with_template("{bar:30} {pos} of {len} decisions  {elapsed}")?);
    let maps = if args.maps == "patch" { MapMode::Patch } else { MapMode::Full };
    let made = wisdom_logbook::expand(&log, &args.out, maps, &args.planes, &mut |_| bar.inc(1))?;
    bar.finish_and_clear();
    let bytes = std::fs::metadata(&made)?.len();
    let mut out = std::io::stdout().lock();
    if args.json {
        let object = json!({
            "log": args.log.display().to_string(),
            "out": made.display().to_string(),
            "decisions": count,
            "planes": args.planes,
            "bytes": bytes,
        });
        writeln!(out, "{object}")?;
    } else {
        writeln!(out, "{count} decisions with their maps, {bytes} bytes: {}", made.display())?;
    }
    Ok(crate::exit::of_log(&log))
}
