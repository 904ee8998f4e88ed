//! `wisdom log cat`: a log's messages, one a line.

use std::io::Write;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::process::ExitCode;

use serde_json::{Value, json};
use wisdom_logbook::read::{Entry, Item, MessageAt, sketch, stream};
use wisdom_logbook::{IndexedLog, Status};

/// Print the messages of a log, one a line.
///
/// Records of the run are told in a line, or with --json whole; messages for viewers by what they hold and how
/// large they are.
#[derive(clap::Args, Debug)]
pub(crate) struct CatArgs {
    /// The log (NAME.mcap or NAME.mcap.part).
    log: PathBuf,
    /// Only messages of this topic (may be given again).
    #[arg(long, value_name = "TOPIC")]
    topic: Vec<String>,
    /// Only what was logged from the decision before this one up to it; a whole log is not read for the rest.
    #[arg(long, value_name = "N")]
    decision: Option<u32>,
    /// One JSON object a message, one a line.
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &CatArgs) -> anyhow::Result<ExitCode> {
    let mut out = std::io::BufWriter::new(std::io::stdout().lock());
    let mut failed = None;
    let mut print = |item: Item<'_>| {
        let line = match &item {
            Item::Entry { at, .. } | Item::View { at, .. }
                if args.topic.is_empty() || args.topic.iter().any(|topic| topic == at.topic) =>
            {
                if args.json {
                    as_json(*at, &item)
                } else {
                    Ok(as_text(*at, &item))
                }
            }
            _ => return ControlFlow::Continue(()),
        };
        let written =
            line.map_err(anyhow::Error::from).and_then(|line| Ok(writeln!(out, "{line}")?));
        match written {
            Ok(()) => ControlFlow::Continue(()),
            Err(error) => {
                failed = Some(error);
                ControlFlow::Break(())
            }
        }
    };
    let status = match args.decision {
        Some(number) => {
            let mut log = IndexedLog::open(&args.log)?;
            log.cycle(number, &mut print)?;
            // What was asked for was there and was checked, whatever the rest of the file is.
            Status::Complete
        }
        None => stream(&args.log, &mut print)?.unwrap_or(Status::Complete),
    };
    if let Some(error) = failed {
        return Err(error);
    }
    out.flush()?;
    Ok(crate::exit::of_status(&status))
}

/// The message in a line.
fn told(item: &Item<'_>) -> String {
    match item {
        Item::Entry { entry, .. } => entry.sketch(),
        Item::View { at, data } => sketch(at.schema, data),
        _ => String::new(),
    }
}

fn as_text(at: MessageAt<'_>, item: &Item<'_>) -> String {
    // A message is one line, whatever its text holds, and gives a terminal no orders.
    let told = told(item).replace(char::is_control, " ");
    let (seconds, rest) = (at.stamp_ns / 1_000_000_000, at.stamp_ns % 1_000_000_000);
    format!("{seconds:>6}.{rest:09} s  {:<16} {:>4}  {told}", at.topic, at.number)
}

fn as_json(at: MessageAt<'_>, item: &Item<'_>) -> Result<String, serde_json::Error> {
    let message = match item {
        Item::Entry { entry, .. } => match entry {
            Entry::Observation(record) => serde_json::to_value(record)?,
            Entry::Decision(record) => serde_json::to_value(record)?,
            Entry::Outcome(record) => serde_json::to_value(record)?,
            Entry::Message(record) => serde_json::to_value(record)?,
            Entry::Fault(record) => serde_json::to_value(record)?,
        },
        _ => Value::Null,
    };
    let object = json!({
        "topic": at.topic,
        "schema": at.schema,
        "number": at.number,
        "stamp_ns": at.stamp_ns,
        "bytes": at.bytes,
        "text": told(item),
        "message": message,
    });
    serde_json::to_string(&object)
}
