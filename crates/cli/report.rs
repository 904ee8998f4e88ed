//! `wisdom report`: the viewer's page with its logs inside.

use std::io::{BufWriter, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::Context;
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::{Value, json};
use wisdom_logbook::{Deriver, LogReader, PlaneLog, ReplayError, Status, mission_of};
use wisdom_viewer::{Page, Slot};

use crate::exit::InputError;
use crate::{exit, explain, remade, view};

/// The most bytes of logs in a page: browsers hold no longer texts.
const MOST: u64 = 256 << 20;

/// Write the viewer's page with a log inside, or two: one file to be opened from disk, or mailed.
///
/// The log goes in byte for byte, whole or not. What it holds only as digests can be put in beside it, made again from the logged inputs:
/// further planes at every decision, the ways of alternatives, price tags.
#[derive(clap::Args, Debug)]
pub(crate) struct ReportArgs {
    /// The log (NAME.mcap or NAME.mcap.part).
    log: PathBuf,
    /// A second log, to be held against the first.
    log_b: Option<PathBuf>,
    /// Where the page goes; an older page is written over, nothing else.
    #[arg(long, value_name = "FILE")]
    html: PathBuf,
    /// Planes to put in at every decision: ignorance, paradox, conflict, contradiction, prize, hazard, blocked, reliability, a layer
    /// of the mission, NAME-u for a layer's uncertainty; of each expert mass-interesting-NAME, mass-not-interesting-NAME,
    /// mass-ignorance-NAME, mass-paradox-NAME, credit-NAME. `all` puts in every one.
    #[arg(long, value_name = "PLANES", value_delimiter = ',')]
    planes: Vec<String>,
    /// Put in the ways of all plans of each decision's family; the log has that of the chosen one alone.
    #[arg(long)]
    families: bool,
    /// Put in the price tags of the goals that these decisions left out (0,4,7), or `all`; seconds for each.
    #[arg(long, value_name = "DECISIONS", value_delimiter = ',', value_parser = which)]
    prices: Vec<Which>,
    /// Print one JSON object instead of text.
    #[arg(long)]
    json: bool,
}

/// A decision, or all of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Which {
    One(u32),
    All,
}

fn which(text: &str) -> Result<Which, String> {
    if text == "all" {
        return Ok(Which::All);
    }
    text.parse().map(Which::One).map_err(|_| "a decision is a number; or `all`".to_owned())
}

impl ReportArgs {
    fn asks_for_prices_of(&self, decision: u32) -> bool {
        self.prices
            .iter()
            .any(|which| matches!(which, Which::All) || *which == Which::One(decision))
    }

    fn asks_for_more(&self) -> bool {
        !self.planes.is_empty() || self.families || !self.prices.is_empty()
    }
}

/// What goes into the page of one log.
struct TakenIn {
    bytes: Vec<u8>,
    status: Status,
    planes: Option<Vec<u8>>,
    remade: Option<Value>,
}

pub(crate) fn run(args: &ReportArgs) -> anyhow::Result<ExitCode> {
    check_output(&args.html)?;
    let logs: Vec<(Slot, &Path)> = std::iter::once((Slot::A, args.log.as_path()))
        .chain(args.log_b.as_deref().map(|log| (Slot::B, log)))
        .collect();
    let mut inside = 0;
    for (_, log) in &logs {
        view::check(log)?;
        inside += std::fs::metadata(log)?.len();
        check_size(inside, log)?;
    }
    let planes = planes_of(args, &logs)?;
    let shown = !args.json && std::io::stderr().is_terminal();
    let mut page = Page::default();
    let mut more = serde_json::Map::new();
    let mut code = ExitCode::SUCCESS;
    for (slot, path) in &logs {
        let taken = taken_in(args, path, &planes, shown)?;
        if taken.status != Status::Complete {
            code = exit::of_status(&taken.status);
        }
        if let Some(why) = taken.remade.as_ref().and_then(|of| of["index"]["unavailable"].as_str())
        {
            exit::complain(&format!("remark: {}: {why}; it is put in as it is", path.display()));
            code = ExitCode::from(exit::LOSSY);
        }
        page.log(*slot, view::name(path), taken.bytes);
        if let Some(planes) = taken.planes {
            inside += planes.len() as u64;
            check_size(inside, path)?;
            page.planes(*slot, planes);
        }
        if let Some(remade) = taken.remade {
            more.insert(slot.name().to_owned(), remade);
        }
    }
    if !more.is_empty() {
        page.remade(Value::Object(more));
    }
    write(&page, &args.html)?;
    let bytes = std::fs::metadata(&args.html)?.len();
    let mut out = std::io::stdout().lock();
    if args.json {
        let logs: Vec<String> = logs.iter().map(|(_, log)| log.display().to_string()).collect();
        let html = args.html.display().to_string();
        writeln!(out, "{}", json!({ "html": html, "bytes": bytes, "logs": logs }))?;
    } else {
        writeln!(out, "{}: {:.1} MB", args.html.display(), bytes as f64 / 1e6)?;
    }
    Ok(code)
}

fn check_size(inside: u64, path: &Path) -> Result<(), InputError> {
    if inside <= MOST {
        return Ok(());
    }
    let (found, path) = (inside >> 20, path.display());
    let most = MOST >> 20;
    Err(InputError(format!(
        "{path}: {found} MiB of logs and planes; a page holds {most} at most, `wisdom view` any number"
    )))
}

/// The planes asked for by name: each must be one that some log's decisions have.
fn planes_of(args: &ReportArgs, logs: &[(Slot, &Path)]) -> anyhow::Result<Vec<String>> {
    if args.planes.is_empty() {
        return Ok(Vec::new());
    }
    let mut known: Vec<String> = Vec::new();
    let mut missing = None;
    for (_, path) in logs {
        match LogReader::open(path).map_err(ReplayError::from).and_then(|log| mission_of(&log)) {
            Ok(mission) => {
                known.extend(wisdom_logbook::planes(&mission.spec).into_iter().map(|p| p.name));
            }
            Err(error) => missing = Some(error),
        }
    }
    if args.planes.iter().any(|name| name == "all") {
        return Ok(known);
    }
    match args.planes.iter().find(|name| !known.contains(name)) {
        Some(name) if missing.is_none() => {
            Err(ReplayError::NoPlane { name: name.clone(), known }.into())
        }
        _ => Ok(args.planes.clone()),
    }
}

/// Whether a page may go there: a name that ends in `.html`, and nothing there but an older page of ours.
fn check_output(path: &Path) -> Result<(), InputError> {
    let refuse = |why: &str| Err(InputError(format!("--html {}: {why}", path.display())));
    let ends = |end: &str| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(end));
    if !ends("html") && !ends("htm") {
        return refuse("a page's name ends in .html");
    }
    match std::fs::read(path) {
        Ok(bytes) if !is_ours(&bytes) => refuse("is there already, and is no report of ours"),
        _ => Ok(()),
    }
}

/// Whether a file is the viewer's page, of whatever version.
fn is_ours(bytes: &[u8]) -> bool {
    const MARK: &[u8] = b"<title>Wisdom: replay</title>";
    bytes.windows(MARK.len()).any(|window| window == MARK)
}

/// A log's bytes as they are, and what was made again of it, if that is asked for and can be done.
fn taken_in(
    args: &ReportArgs,
    path: &Path,
    planes: &[String],
    shown: bool,
) -> anyhow::Result<TakenIn> {
    let bytes =
        std::fs::read(path).with_context(|| format!("{} cannot be read", path.display()))?;
    if !args.asks_for_more() {
        let status = LogReader::open(path)?.status;
        return Ok(TakenIn { bytes, status, planes: None, remade: None });
    }
    let log = LogReader::open(path)?;
    let numbers: Vec<u32> = log.decisions().map(|decision| decision.number).collect();
    for which in &args.prices {
        if let Which::One(number) = which
            && !numbers.contains(number)
        {
            let (count, path) = (numbers.len(), path.display());
            return Err(InputError(format!(
                "--prices {number}: {path} holds {count} decisions, counted from 0"
            ))
            .into());
        }
    }
    let bar = if shown { ProgressBar::new(numbers.len() as u64) } else { ProgressBar::hidden() };
    bar.set_style(ProgressStyle::with_template(
        "{msg} {bar:30} {pos} of {len} decisions  {elapsed}, {eta} left",
    )?);
    bar.set_message(view::name(path));
    let made = made_again(args, &log, &numbers, planes, &bar);
    bar.finish_and_clear();
    let (planes, remade) = match made {
        Ok((planes, remade)) => (planes, remade),
        Err(why) => (None, json!({ "index": { "unavailable": why.to_string() } })),
    };
    Ok(TakenIn { bytes, status: log.status.clone(), planes, remade: Some(remade) })
}

/// Goes through the decisions once and makes again what is asked for.
fn made_again(
    args: &ReportArgs,
    log: &LogReader,
    numbers: &[u32],
    planes: &[String],
    bar: &ProgressBar,
) -> Result<(Option<Vec<u8>>, Value), ReplayError> {
    let mut deriver = Deriver::new(log)?;
    let spec = deriver.start().spec().clone();
    let own: Vec<String> =
        planes.iter().filter(|name| wisdom_logbook::is_plane(&spec, name)).cloned().collect();
    let mut beside = (!own.is_empty()).then(|| PlaneLog::new(log, &spec, &own)).transpose()?;
    let (mut families, mut prices) = (serde_json::Map::new(), serde_json::Map::new());
    for number in numbers {
        let Some(past) = deriver.at(*number)? else { continue };
        if let Some(planes) = &mut beside {
            planes.add(&past)?;
        }
        if args.families {
            families.insert(number.to_string(), remade::family(&past));
        }
        if args.asks_for_prices_of(*number) {
            prices.insert(number.to_string(), explain::left_out(&past));
        }
        bar.inc(1);
    }
    let index = remade::index(&spec, |name| own.iter().any(|own| own == name));
    let planes = beside.map(PlaneLog::close).transpose()?;
    Ok((planes, json!({ "index": index, "families": families, "prices": prices })))
}

/// Writes the page whole, or leaves what was there.
fn write(page: &Page, to: &Path) -> anyhow::Result<()> {
    let refuse = |error: std::io::Error| InputError(format!("--html {}: {error}", to.display()));
    // Beside it under another name, and moved when it is whole.
    let part = wisdom_logbook::part_of(to);
    let written = std::fs::File::create(&part).and_then(|file| {
        let mut out = BufWriter::new(file);
        page.write_to(&mut out)?;
        out.flush()?;
        std::fs::rename(&part, to)
    });
    if written.is_err() {
        std::fs::remove_file(&part).ok();
    }
    written.map_err(refuse)?;
    Ok(())
}
