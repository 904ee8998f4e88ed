//! Does the reliability that plans promise come true? Missions of the paper's scene, thousands of legs, and what was
//! predicted of each held against what happened.
//!
//! ```text
//! cargo run --release --example reliability -- [--missions N] [--blocks 1,2,3,4,5] [--jobs J] [-o DIR] [--json]
//! ```
//!
//! # What is run
//!
//! `missions/paper` under three conditions, on the same worlds:
//!
//! - `dem-known`: the rover knows the true ground (`prior.kind = "complete"`), so that its hazard model is the world's;
//! - `dem-sensed`: the mission's own first look and the instruments' later ones, so that a leg may be
//!   more or less hazardous than the map says, or blocked;
//! - `hazard-1.5`: as `dem-known`, but the world is 1.5 times as hazardous as the rover's model has it
//!   (`execution.hazard-factor`). A test worth its name must reject these forecasts.
//!
//! Block b is the 200 worlds of the seeds 1000·b + 1 to 1000·b + 200; five blocks are 1000 missions a condition. With
//! `--missions N` each block's first N / blocks seeds are run.
//!
//! Three keys are changed in all conditions. They were chosen from the argument below, before any result was seen:
//!
//! - `rover.vehicle.hazard-floor-per-m = 2e-3`, twenty times the default, so that legs fail often enough to be counted:
//!   30 m of flat ground arrive in 94 of 100 cases. Both the rover's model and the world have it;
//! - `rover.look-every-m = 1e6`: no look on the way, so that nothing seen there can cut a leg short;
//! - `execution.slip-scatter = 0` and `execution.operator-scatter = 0`: drives on known ground cost what was planned, so
//!   that no budget runs out halfway.
//!
//! # Why the legs can be tested as they are
//!
//! Legs of one mission depend on each other: what a failed leg cost decides what is driven next, and how many legs there
//! are. Still the forecasts can be tested as if the legs were independent. Let F be all that is
//! known when leg j is decided, `p_j` the reliability predicted of it, `o_j` whether it arrived. `p_j` is fixed by
//! F: it is predictable. Every step's hazard draw is keyed by the world's seed, the cell, and how often it was
//! entered, so no draw is used twice and those of leg j are independent of F. If the map is true, the leg arrives with
//! the chance exp(−Σ λ·length) = `p_j`, given F, whatever came before. The differences `o_j − p_j` are then
//! martingale differences with the variances `p_j(1 − p_j)`, and so are they times any weight that F fixes, such as
//! Spiegelhalter's `1 − 2p_j` or whether `p_j` lies in some range. Their sums over all legs of a mission,
//! however it decides to end, have mean 0 and those variances' sum as variance, uncorrelated from leg to leg; missions
//! are independent of each other; and so both tests have their usual limits. (The edges of the bins are
//! quantiles of all legs together, which no single leg fixes; over thousands of legs they hardly move.)
//!
//! The argument needs every leg that was begun to be counted. A leg that is cut short tells nothing of its end, and
//! leaving it out is harmless only if the cut does not depend on the ground: of legs that would be cut late, those
//! that failed early would be counted and those that went well would not, and the share that arrived would be too
//! low. Looks on the way cause such cuts, so there are none. The budget may still run out on the way, where the ground
//! costs more than the map says; how often is printed, and what it could do to the share that arrived is at most
//! that share of the legs.
//!
//! With `dem-sensed` no such law holds, and none is claimed: the rover's hazard rates carry a surcharge for uncertainty,
//! and its map errs. What the table shows is by how much the promise then misses, and to which side.

#[allow(dead_code, unused_imports, reason = "shared with the command, which needs more of it")]
#[path = "../../crates/cli/chart/mod.rs"]
mod chart;
#[allow(dead_code, unused_imports, reason = "shared with the command, which needs more of it")]
#[path = "../../crates/cli/figure/mod.rs"]
mod figure;
mod report;
mod study;

use std::io::{IsTerminal, Write};
use std::path::PathBuf;

use anyhow::Context;
use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};

use study::{BLOCK, CONDITIONS, Plan};

/// Hold the predicted reliability of legs against what happened, over missions of the paper's scene.
#[derive(Parser, Debug)]
#[command(name = "reliability", max_term_width = 100)]
struct Args {
    /// Missions of each condition, spread evenly over the blocks; all 200 of each block by default.
    #[arg(long, value_name = "N")]
    missions: Option<usize>,
    /// Blocks of seeds: block b is 1000·b + 1 to 1000·b + 200.
    #[arg(long, value_delimiter = ',', default_value = "1,2,3,4,5")]
    blocks: Vec<u64>,
    /// Missions run at a time; all cores by default.
    #[arg(long, value_name = "J", default_value_t = 0, hide_default_value = true)]
    jobs: usize,
    /// Write the reliability diagrams (SVG and PNG), reliability.json and legs.csv into this folder.
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Print one JSON object instead of tables.
    #[arg(long)]
    json: bool,
    /// The folder of the mission that is varied.
    #[arg(long, value_name = "PATH", default_value = "missions/paper")]
    mission: PathBuf,
}

fn main() -> anyhow::Result<()> {
    let args = Args::parse();
    let plan = plan(&args)?;
    if let Some(folder) = &args.output {
        std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(args.jobs).build()?;
    let count = CONDITIONS.len() * plan.seeds().count();
    let bar = if std::io::stderr().is_terminal() {
        ProgressBar::new(count as u64)
    } else {
        ProgressBar::hidden()
    };
    bar.set_style(ProgressStyle::with_template(
        "{bar:30} {pos}/{len} missions  {elapsed}, {eta} left",
    )?);
    let results = pool.install(|| study::run(&plan, || bar.inc(1)))?;
    bar.finish_and_clear();

    let mut out = std::io::stdout().lock();
    let object = report::json(&plan, &results);
    if args.json {
        writeln!(out, "{object}")?;
    } else {
        report::write_tables(&mut out, &plan, &results)?;
    }
    if let Some(folder) = &args.output {
        let written = report::write_files(folder, &plan, &results, &object)?;
        if !args.json {
            for path in written {
                writeln!(out, "written  {}", path.display())?;
            }
        }
    }
    Ok(())
}

fn plan(args: &Args) -> anyhow::Result<Plan> {
    let blocks = args.blocks.clone();
    anyhow::ensure!(!blocks.is_empty(), "--blocks: expected at least one");
    for (i, block) in blocks.iter().enumerate() {
        anyhow::ensure!(!blocks[..i].contains(block), "--blocks: {block} is given twice");
        anyhow::ensure!(*block <= 1_000_000, "--blocks: {block}; expected at most 1000000");
    }
    let whole = BLOCK * blocks.len();
    let missions = args.missions.unwrap_or(whole);
    anyhow::ensure!(
        missions > 0 && missions <= whole && missions.is_multiple_of(blocks.len()),
        "--missions {missions}: expected a multiple of the number of blocks, up to {whole}"
    );
    let each = missions / blocks.len();
    Ok(Plan { mission: args.mission.clone(), blocks, each })
}
