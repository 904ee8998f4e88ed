//! `wisdom report`: the viewer's page with its logs inside.

use std::io::{BufWriter, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::Context;
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::{Value, json};
use wisdom_logbook::{Deriver, LogReader, MapMode};
use wisdom_viewer::{Page, Slot};

use crate::exit::InputError;
use crate::{explain, remade, view};

/// The most bytes of logs in a page: browsers hold no longer texts.
const MOST: u64 = 256 << 20;

/// Write the viewer's page with a log inside, or two: one file to be opened from disk, or mailed.
///
/// What the log holds only as digests can be put in beside it, made again from the logged inputs: further planes at every decision, the
/// ways of alternatives, price tags.
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

pub(crate) fn run(args: &ReportArgs) -> anyhow::Result<ExitCode> {
    check_output(&args.html)?;
    let logs: Vec<(Slot, &Path)> = std::iter::once((Slot::A, args.log.as_path()))
        .chain(args.log_b.as_deref().map(|log| (Slot::B, log)))
        .collect();
    for (_, log) in &logs {
        view::check(log)?;
    }
    let shown = !args.json && std::io::stderr().is_terminal();
    let mut page = Page::default();
    let mut more = serde_json::Map::new();
    let mut inside = 0;
    for (slot, path) in &logs {
        let (bytes, remade) = taken_in(args, path, shown)?;
        inside += bytes.len() as u64;
        if inside > MOST {
            let found = inside >> 20;
            return Err(InputError(format!(
                "{}: {found} MiB of logs; a page holds {} at most, `wisdom view` any number",
                path.display(),
                MOST >> 20
            ))
            .into());
        }
        page.log(*slot, view::name(path), bytes);
        if let Some(remade) = remade {
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
    Ok(ExitCode::SUCCESS)
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

/// A log's bytes, with further planes if any are asked for, and what else was made again of it.
fn taken_in(
    args: &ReportArgs,
    path: &Path,
    shown: bool,
) -> anyhow::Result<(Vec<u8>, Option<Value>)> {
    let read = |path: &Path| {
        std::fs::read(path).with_context(|| format!("{} cannot be read", path.display()))
    };
    if !args.asks_for_more() {
        return Ok((read(path)?, None));
    }
    let log = LogReader::open(path)?;
    let mut deriver = Deriver::new(&log)?;
    let spec = deriver.start().spec().clone();
    let numbers: Vec<u32> = log.decisions().map(|decision| decision.number).collect();
    for which in &args.prices {
        if let Which::One(number) = which
            && !numbers.contains(number)
        {
            let count = numbers.len();
            let path = path.display();
            return Err(InputError(format!(
                "--prices {number}: {path} holds {count} decisions, counted from 0"
            ))
            .into());
        }
    }
    let planes: Vec<String> = if args.planes.iter().any(|name| name == "all") {
        wisdom_logbook::planes(&spec).into_iter().map(|plane| plane.name).collect()
    } else {
        args.planes.clone()
    };
    let bar = if shown { ProgressBar::new(numbers.len() as u64) } else { ProgressBar::hidden() };
    bar.set_style(ProgressStyle::with_template(
        "{msg} {bar:30} {pos} of {len} decisions  {elapsed}",
    )?);
    bar.set_message(format!("{}: planes", view::name(path)));
    let bytes = if planes.is_empty() {
        read(path)?
    } else {
        let folder = tempfile::tempdir().context("no room for the planes")?;
        let made = wisdom_logbook::expand(
            &log,
            &folder.path().join("expanded.mcap"),
            MapMode::Patch,
            &planes,
            &mut |_| bar.inc(1),
        )?;
        read(&made)?
    };
    bar.set_position(0);
    bar.set_message(format!("{}: plans and prices", view::name(path)));
    let mut families = serde_json::Map::new();
    let mut prices = serde_json::Map::new();
    for number in numbers {
        let priced = args.asks_for_prices_of(number);
        if !args.families && !priced {
            continue;
        }
        let Some(past) = deriver.at(number)? else { continue };
        if args.families {
            families.insert(number.to_string(), remade::family(&past));
        }
        if priced {
            prices.insert(number.to_string(), explain::left_out(&past));
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    let index = remade::index(&spec, |name| name == "interest" || planes.iter().any(|p| p == name));
    Ok((bytes, Some(json!({ "index": index, "families": families, "prices": prices }))))
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
