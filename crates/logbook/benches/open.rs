//! From nothing to a decision of a large log: by its index, and by reading everything.
//!
//! `cargo bench -p wisdom-logbook --bench open [MiB]` writes a log of that size (default 1024), whose maps are noise
//! that does not compress, into the folder for temporary files, opens it, and removes it. The whole log is read
//! last, because the peak of memory only grows.

#![allow(clippy::print_stdout, clippy::disallowed_methods, reason = "a bench tells what it timed")]
#![allow(clippy::unwrap_used, reason = "the story is test code")]

use std::collections::BTreeMap;
use std::error::Error;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

use wisdom_grid::{GridSpec, Raster};
use wisdom_logbook::read::stream;
use wisdom_logbook::{
    DecisionMaps, IndexedLog, LogError, LogReader, LogWriter, Options, PartFile, Setting, Status,
    SyncPolicy,
};

#[allow(dead_code, reason = "the tests' story; not all of it is told here")]
#[path = "../tests/logbook/story.rs"]
mod story;

/// Cells along each side of a map: 1 MiB of values.
const SIDE: usize = 512;

/// Tells the process that writes the log where it goes.
const WRITE: &str = "WISDOM_BENCH_LOG";

/// The most memory this process has had, MiB, where the system tells.
fn peak_mib() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    Some(line.split_whitespace().nth(1)?.parse::<f64>().ok()? / 1024.0)
}

fn timed<T>(what: &str, act: impl FnOnce() -> Result<T, LogError>) -> Result<T, LogError> {
    let start = Instant::now();
    let done = act()?;
    let peak = peak_mib().map_or_else(|| "?".to_owned(), |mib| format!("{mib:.1}"));
    println!("{what:<46} {:>9.4} s   peak so far {peak} MiB", start.elapsed().as_secs_f64());
    Ok(done)
}

/// Writes a log of so many decisions, each with a map of noise.
fn write(path: &Path, decisions: u32) -> Result<(), Box<dyn Error>> {
    let grid = GridSpec::new(SIDE, SIDE, 1.0)?;
    let setting = Setting { grid, ..story::setting() };
    let store = PartFile::create(path, SyncPolicy::End)?;
    let mut log = LogWriter::over(store, &story::header(), setting, Options::default())?;
    let mut state = 1_u64;
    for number in 0..decisions {
        let interest = Raster::from_fn(grid, |_| {
            // Knuth's linear congruential generator; its upper bits are noise. The values are finite.
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            f32::from_bits((state >> 34) as u32)
        });
        log.observation(&story::observation(number))?;
        let maps = DecisionMaps { interest: &interest, others: &[], drape: None };
        log.decision(&story::decision(number), &maps)?;
    }
    log.finish("done", &BTreeMap::new())?;
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    // Cargo hands over arguments of its own, too.
    let size = std::env::args().skip(1).find_map(|argument| argument.parse::<u32>().ok());
    let mib = size.unwrap_or(1024);
    // The writer is another process, so that its memory does not count.
    if let Some(path) = std::env::var_os(WRITE) {
        return write(Path::new(&path), mib);
    }
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("large.mcap");
    let wrote = std::process::Command::new(std::env::current_exe()?)
        .arg(mib.to_string())
        .env(WRITE, &path)
        .status()?;
    assert!(wrote.success(), "the log was not written");
    println!("a log of {:.1} MiB", std::fs::metadata(&path)?.len() as f64 / f64::from(1 << 20));
    let last = mib - 1;
    let mut log = timed("open by index", || IndexedLog::open(&path))?;
    timed("  the first decision", || log.decision(0))?;
    timed("  the last decision", || log.decision(last))?;
    timed("  counts of all topics", || log.contents())?;
    let status =
        timed("stream all, every checksum", || stream(&path, &mut |_| ControlFlow::Continue(())))?;
    assert_eq!(status, Some(Status::Complete));
    let whole = timed("LogReader, every checksum, all records kept", || LogReader::open(&path))?;
    assert_eq!(whole.decisions().count(), mib as usize);
    Ok(())
}
