//! Solves every problem of a `MovingAI` scenario with the route search of the planner and holds the lengths against
//! the published ones.
//!
//! `cargo run --release --example movingai -- MAP SCENARIO [--json]`
//!
//! Exit code 0: all lengths agree; 1: some do not; 2: a file cannot be read.
#![expect(clippy::print_stdout, clippy::print_stderr, reason = "a program prints what it found")]

mod reader;

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use anyhow::Context;
use clap::Parser;
use serde::Serialize;
use wisdom_planner::Router;

/// Solves every problem of a `MovingAI` scenario and compares the lengths found with the published ones.
#[derive(Parser)]
#[command(name = "movingai")]
struct Args {
    /// The map (`type octile`).
    map: PathBuf,
    /// The scenario (`version 1`).
    scenario: PathBuf,
    /// Print one JSON object a problem: index, length, expected, expansions, micros.
    #[arg(long)]
    json: bool,
}

/// Lengths may differ by this: some scenarios print two decimals.
const TOLERANCE: f64 = 0.01;

/// A problem solved; a line of `--json`.
#[derive(Serialize)]
struct Solved {
    index: usize,
    /// None if no way was found.
    length: Option<f64>,
    expected: f64,
    expansions: u64,
    micros: f64,
}

impl Solved {
    fn is_wrong(&self) -> bool {
        !self.length.is_some_and(|length| (length - self.expected).abs() <= TOLERANCE)
    }
}

fn main() -> ExitCode {
    match run(&Args::parse()) {
        Ok(0) => ExitCode::SUCCESS,
        Ok(_) => ExitCode::from(1),
        Err(error) => {
            eprintln!("{error:#}");
            ExitCode::from(2)
        }
    }
}

fn text(path: &Path) -> anyhow::Result<(String, String)> {
    let text = fs::read_to_string(path).with_context(|| format!("{}", path.display()))?;
    Ok((path.display().to_string(), text))
}

/// Solves and prints; gives the number of wrong lengths.
fn run(args: &Args) -> anyhow::Result<usize> {
    let (file, map) = text(&args.map)?;
    let blocked = reader::read_map(&file, &map)?;
    let (file, scenario) = text(&args.scenario)?;
    let problems = reader::read_scenario(&file, &scenario, &blocked)?;
    let ground = reader::ground(blocked)?;
    let mut router = Router::new(&ground);
    let mut solved = Vec::new();
    for (index, problem) in problems.iter().enumerate() {
        #[expect(
            clippy::disallowed_methods,
            reason = "the time a search takes is what is asked for"
        )]
        let start = Instant::now();
        let found = router.route(problem.start, problem.goal);
        let micros = start.elapsed().as_secs_f64() * 1e6;
        let solution = Solved {
            index,
            length: found.as_ref().map(|found| found.route.cost.length_m),
            expected: problem.length,
            expansions: found.map_or(0, |found| found.expansions),
            micros,
        };
        if args.json {
            writeln!(io::stdout(), "{}", serde_json::to_string(&solution)?)?;
        }
        solved.push(solution);
    }
    if !args.json {
        print_summary(&args.map, &solved);
    }
    Ok(solved.iter().filter(|solution| solution.is_wrong()).count())
}

fn print_summary(map: &Path, solved: &[Solved]) {
    let wrong: Vec<&Solved> = solved.iter().filter(|solution| solution.is_wrong()).collect();
    let worst = solved
        .iter()
        .map(|solution| (solution.length.unwrap_or(f64::INFINITY) - solution.expected).abs())
        .fold(0.0, f64::max);
    let micros: f64 = solved.iter().map(|solution| solution.micros).sum();
    let expansions: u64 = solved.iter().map(|solution| solution.expansions).sum();
    let longest: Vec<f64> = solved.iter().rev().take(100).map(|solution| solution.micros).collect();
    println!("map                    {}", map.display());
    println!("problems               {}", solved.len());
    println!("wrong lengths          {}", wrong.len());
    println!("worst difference       {worst:.6}");
    println!("time, all              {:.3} s", micros / 1e6);
    println!("time, mean             {:.1} us", micros / solved.len().max(1) as f64);
    println!(
        "time, mean of last 100 {:.1} us",
        longest.iter().sum::<f64>() / longest.len().max(1) as f64
    );
    println!("expansions, mean       {:.0}", expansions as f64 / solved.len().max(1) as f64);
    println!("time an expansion      {:.1} ns", 1e3 * micros / expansions.max(1) as f64);
    for Solved { index, length, expected, .. } in wrong.into_iter().take(10) {
        let length = length.map_or("no way".to_owned(), |length| length.to_string());
        println!("wrong: problem {index} has length {length}, published is {expected}");
    }
}
