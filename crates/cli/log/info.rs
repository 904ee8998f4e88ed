//! `wisdom log info`: what a log holds, counted.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use serde_json::json;
use wisdom_logbook::{AttachmentAt, IndexedLog, read};

use crate::run::clock;

/// Tell what a log holds: its run, its topics, its files.
///
/// A whole log is opened by its index, which takes no longer for a large one; its data are then not read, so
/// that `wisdom log check` says whether they hold.
#[derive(clap::Args, Debug)]
pub(crate) struct InfoArgs {
    /// The log (NAME.mcap or NAME.mcap.part).
    log: PathBuf,
    /// Print one JSON object instead of text.
    #[arg(long)]
    json: bool,
}

/// Nanoseconds as seconds.
fn seconds(ns: u64) -> f64 {
    ns as f64 / 1e9
}

pub(crate) fn run(args: &InfoArgs) -> anyhow::Result<ExitCode> {
    let mut log = IndexedLog::open(&args.log)?;
    let contents = log.contents()?;
    let bytes = std::fs::metadata(&args.log)?.len();
    let status = match &contents.status {
        Some(status) => status.to_string(),
        None if contents.end.is_some() => "complete, by its index".to_owned(),
        None => "truncated: by its index the run did not end".to_owned(),
    };
    let unknown = contents.topics.iter().filter(|(topic, _)| !read::is_known(topic));
    let unknown: Vec<&str> = unknown.map(|(topic, _)| topic.as_str()).collect();
    let mut out = std::io::BufWriter::new(std::io::stdout().lock());
    if args.json {
        let object = json!({
            "log": args.log.display().to_string(),
            "bytes": bytes,
            "status": status,
            "indexed": log.without_index.is_none(),
            "without_index": log.without_index,
            "run": log.metadata,
            "end": contents.end.as_ref().map(|end| json!({
                "status": end.status, "decisions": end.decisions, "chain": end.chain,
                "facts": end.facts,
            })),
            "recovered": contents.recovered,
            "decisions": contents.decisions(),
            "topics": contents.topics,
            "unknown_topics": unknown,
            "span_s": contents.span_ns.map(|(from, to)| [seconds(from), seconds(to)]),
            "maps": log.metadata.get("maps"),
            "attachments": log.attachments.iter().map(|a| json!({
                "name": a.name, "media_type": a.media_type, "bytes": a.bytes,
            })).collect::<Vec<_>>(),
        });
        writeln!(out, "{object}")?;
    } else {
        writeln!(out, "log         {}, {bytes} bytes", args.log.display())?;
        writeln!(out, "status      {status}")?;
        if let Some(why) = &log.without_index {
            writeln!(out, "no index    {why}; read from the beginning")?;
        }
        match &contents.end {
            Some(end) => writeln!(
                out,
                "end         {}, after {} decisions, chain {}",
                end.status, end.decisions, end.chain
            )?,
            None => writeln!(out, "end         none: the run did not end")?,
        }
        if let Some(facts) = &contents.recovered {
            let fact = |key: &str| facts.get(key).map_or("?", String::as_str);
            writeln!(
                out,
                "recovered   from a log that was {}; {} bytes left out",
                fact("log_was"),
                fact("bytes_left_out")
            )?;
        }
        writeln!(out, "decisions   {}", contents.decisions())?;
        if let Some((from, to)) = contents.span_ns {
            let (from, to) = (clock(seconds(from)), clock(seconds(to)));
            writeln!(out, "time        {from} to {to} of mission time")?;
        }
        if let Some(maps) = log.metadata.get("maps") {
            writeln!(out, "maps        {maps}")?;
        }
        writeln!(out, "\nrun")?;
        for (key, value) in log.metadata.iter().filter(|(_, value)| !value.is_empty()) {
            writeln!(out, "  {key:<18} {}", value.replace('\n', " "))?;
        }
        writeln!(out, "\nmessages by topic")?;
        for (topic, count) in &contents.topics {
            let remark = if unknown.contains(&topic.as_str()) {
                "  (not known to this version)"
            } else {
                ""
            };
            writeln!(out, "  {topic:<18} {count:>8}{remark}")?;
        }
        writeln!(out, "\nfiles")?;
        for attachment in &log.attachments {
            let AttachmentAt { name, media_type, bytes, .. } = attachment;
            writeln!(out, "  {bytes:>10} bytes  {name} ({media_type})")?;
        }
    }
    out.flush()?;
    Ok(match &contents.status {
        Some(status) => crate::exit::of_status(status),
        None if contents.end.is_some() => ExitCode::SUCCESS,
        None => ExitCode::from(crate::exit::LOSSY),
    })
}
