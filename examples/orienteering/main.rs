//! Solves orienteering problems with the sequencer of the rover's goals and holds the scores against the best known.
//!
//! ```text
//! cargo run --release --example orienteering -- FILE… [--seconds S] [--best CSV] [--json]
//! ```
//!
//! Reads the texts of Tsiligirides and of Chao, `OPLib`, and problems with time windows; `docs/orienteering.md` says how.
//! Files are solved one after another, each on one core. Every route is followed by a checker that knows nothing of
//! the solver before it is printed.
//!
//! Exit code 0: all files are solved; 1: a route broke a rule, which is a mistake of the program; 2: a file cannot be
//! read (the others are solved first), or the call is wrong.
#![expect(clippy::print_stdout, clippy::print_stderr, reason = "a program prints what it found")]

mod best;
mod instance;
mod metric;
mod reader;
mod report;
mod solve;

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use anyhow::Context;
use clap::Parser;

use best::BestKnown;
use instance::Instance;
use report::{Against, Row, status};

/// Solve orienteering problems with the rover's sequencer.
#[derive(Parser)]
#[command(name = "orienteering", max_term_width = 100)]
struct Args {
    /// Problems: Tsiligirides' and Chao's text, `OPLib`, or with time windows; the content tells which.
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Most time a file may take, unless its best route is proven before.
    #[arg(long, value_name = "S", default_value = "1", value_parser = seconds)]
    seconds: f64,
    /// A table of best known scores with the columns `set`, `file` and `best`: says how far each score is from it.
    #[arg(long, value_name = "CSV")]
    best: Option<PathBuf>,
    /// Print one JSON object a file: file, score, length, route, bound, status, seconds.
    #[arg(long)]
    json: bool,
}

fn seconds(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|seconds: &f64| seconds.is_finite() && *seconds > 0.0)
        .ok_or_else(|| "expected a number of seconds above 0".to_owned())
}

fn main() -> ExitCode {
    match run(&Args::parse()) {
        Ok(code) => ExitCode::from(code),
        // Whoever reads the output has seen enough.
        Err(error) if is_broken_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error:#}");
            ExitCode::from(2)
        }
    }
}

fn is_broken_pipe(error: &anyhow::Error) -> bool {
    let kind = error.downcast_ref::<std::io::Error>().map(std::io::Error::kind);
    kind == Some(std::io::ErrorKind::BrokenPipe)
}

fn bytes(path: &Path) -> anyhow::Result<(String, Vec<u8>)> {
    let name = path.display().to_string();
    let bytes = fs::read(path).with_context(|| name.clone())?;
    Ok((name, bytes))
}

fn instance(path: &Path) -> anyhow::Result<Instance> {
    let (name, bytes) = bytes(path)?;
    Ok(reader::read(&name, &bytes)?)
}

/// Solves and prints; gives the exit code.
fn run(args: &Args) -> anyhow::Result<u8> {
    let best = match &args.best {
        None => None,
        Some(path) => {
            let (name, bytes) = bytes(path)?;
            Some(BestKnown::read(&name, &bytes)?)
        }
    };
    // One core, whatever the library would do with more.
    let core = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let mut rows = Vec::new();
    let (mut wrong, mut unreadable) = (false, false);
    for (index, path) in args.files.iter().enumerate() {
        let instance = match instance(path) {
            Ok(instance) => instance,
            Err(error) => {
                eprintln!("{error:#}");
                unreadable = true;
                continue;
            }
        };
        let mut row = match core.install(|| solved(path, &instance, args.seconds)) {
            Ok(row) => row,
            Err(mistake) => {
                eprintln!("{}: internal error: {mistake}", path.display());
                wrong = true;
                continue;
            }
        };
        row.against = best.as_ref().map(|best| Against::new(row.score, best.of(path)));
        if args.json {
            writeln!(io::stdout(), "{}", serde_json::to_string(&row)?)?;
        } else {
            eprintln!("[{}/{}] {}", index + 1, args.files.len(), row.progress());
        }
        rows.push(row);
    }
    let summary = report::summary(&rows);
    if args.json {
        // Standard output is for programs: it has nothing but the lines.
        if !summary.is_empty() {
            eprintln!("{summary}");
        }
    } else if !rows.is_empty() {
        println!("{}", report::table(&rows));
        if !summary.is_empty() {
            println!("\n{summary}");
        }
    }
    Ok(if wrong {
        1
    } else if unreadable {
        2
    } else {
        0
    })
}

/// Sums of the same scores that are not whole differ by less than this share, in whatever order they are added.
const SAME: f64 = 1e-12;

/// Solves a problem and follows the route.
///
/// # Errors
/// What is wrong with the answer.
fn solved(path: &Path, instance: &Instance, seconds: f64) -> Result<Row, String> {
    #[expect(clippy::disallowed_methods, reason = "the user says how long a search may take")]
    let start = Instant::now();
    let clock = || start.elapsed().as_secs_f64() / seconds;
    let answer = solve::solve(instance, u64::MAX, Some(&clock));
    let seconds = start.elapsed().as_secs_f64();
    let worth = answer.route.as_ref().map(|route| instance.check(route)).transpose()?;
    let bound = match worth {
        Some(worth) if (worth.score - answer.bound).abs() <= SAME * worth.score => worth.score,
        Some(worth) if worth.score > answer.bound => {
            return Err(format!("a score of {} above its bound, {}", worth.score, answer.bound));
        }
        _ => answer.bound,
    };
    Ok(Row {
        file: path.display().to_string(),
        score: worth.map(|worth| worth.score),
        length: worth.map(|worth| worth.length),
        route: answer.route,
        bound: Some(bound),
        status: status(worth, bound),
        seconds,
        against: None,
        nodes: instance.nodes.len(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn args(words: &[&str]) -> Result<Args, String> {
        let words = ["orienteering"].iter().chain(words);
        Args::try_parse_from(words).map_err(|error| error.to_string())
    }

    fn call(words: &[&str]) -> anyhow::Result<u8> {
        run(&args(words).expect("a sound call"))
    }

    #[test]
    fn a_file_that_cannot_be_read_is_told_and_the_others_are_solved() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = |name: &str| folder.path().join(name).display().to_string();
        let write = |name: &str, text: &str| {
            fs::write(path(name), text).expect("the folder can be written");
            path(name)
        };
        let sound = write("sound.txt", "10 1\n0 0 0\n6 0 0\n3 0 5\n");
        let far = write("far.txt", "5 1\n0 0 0\n6 0 0\n");
        let broken = write("broken.txt", "10 1\n0 0\n");
        let best = write("best.csv", "set,file,best\nours,sound.txt,5\n");
        assert_eq!(call(&[&sound, &far, "--json"]).expect("solved"), 0);
        assert_eq!(call(&[&sound, "--best", &best]).expect("solved"), 0);
        assert_eq!(call(&[&path("none.txt"), &sound]).expect("solved"), 2);
        assert_eq!(call(&[&broken, &sound, "--json"]).expect("solved"), 2);
        // A table that cannot be read is told before anything is solved.
        let error = call(&[&sound, "--best", &broken]).expect_err("no table");
        let told = format!("{error:#}");
        assert!(told.ends_with("line 1: found `10 1`; expected a column `set`"), "{told}");
    }

    #[test]
    fn a_call_needs_a_file_and_a_time() {
        assert!(args(&[]).is_err());
        for seconds in ["0", "-1", "NaN", "inf", "soon"] {
            let told = args(&["a", &format!("--seconds={seconds}")]).err().unwrap_or_default();
            assert!(told.contains("expected a number of seconds above 0"), "{told}");
        }
        assert_eq!(args(&["a", "--seconds", "0.1"]).map(|args| args.seconds), Ok(0.1));
    }
}
