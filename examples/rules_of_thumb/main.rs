//! What rules of thumb cost: random drives with more goals than their budget allows, and what each rule loses in
//! expected interest against the best plan there is.
//!
//! ```text
//! cargo run --release --example rules_of_thumb -- [--instances N] [--goals N] [--seed S] [--jobs J] [-o DIR] [--json]
//! ```
//!
//! # What is drawn
//!
//! The rover starts in the middle of a square of 100 m; sites are uniform in it; prizes are uniform in [0.1, 1).
//! Between any two places there is one leg, straight, as hazardous there as back. Its hazard rate is drawn for it
//! alone, independent of its length and of all others: log-uniform, which is what the rover's own formula
//! λ = l0·exp(k·severity) gives where severity is uniform. The leg's reliability is exp(−λ·length). Goals cost nothing
//! but the way, plans end at their last goal, and no reliability is too low for a plan. The budget is a length, a
//! stated share of the shortest way from the start through all goals.
//!
//! Four generators ([`study::instance::Generator::all`]) use the same draws:
//!
//! - `base`: hazard rates in [0.0005, 0.012] per metre, 0.55 of the shortest way through all goals, which is enough for
//!   about 5 of 8;
//! - `tight`: as `base` with 0.3 of it, enough for about 3 of 8;
//! - `hazardous`: as `base` with hazard rates in [0.0015, 0.036];
//! - `rover`: as `base` with the hazard rates of the default rover, from flat ground to ground at a limit.
//!
//! # What is held against what
//!
//! The yardstick is J1, the expected interest, Σ prize · chance of getting that far. The optimum is the production
//! sequencer's under the policy `expected-interest`; the table says in how many instances it is proven. LEX, J2,
//! CC (0.8) and NET (λ = 1) are the same sequencer's under their policies, each solved to the end, so that what they
//! lose is the fault of what they ask for and not of how it was sought. J0 takes every leg to be safe. The greedy rules
//! are in [`study::rule::Rule`].

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
use std::process::ExitCode;

use anyhow::Context;
use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};

use report::Outcome;
use study::Study;
use study::instance::{Generator, MOST_GOALS};

/// Measure what rules of thumb lose in expected interest against the best plan, on random instances.
#[derive(Parser, Debug)]
#[command(name = "rules_of_thumb", max_term_width = 100)]
struct Args {
    /// Instances of each generator.
    #[arg(long, value_name = "N", default_value_t = 200)]
    instances: usize,
    /// Goals of each instance, 2 to 14.
    #[arg(long, value_name = "N", default_value_t = 8)]
    goals: usize,
    /// Seed of all draws.
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Instances solved at a time; all cores by default.
    #[arg(long, value_name = "J", default_value_t = 0, hide_default_value = true)]
    jobs: usize,
    /// Write charts of the losses (SVG and PNG), `rules_of_thumb.json` and `plans.csv` into this folder.
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Print one JSON object instead of tables.
    #[arg(long)]
    json: bool,
}

fn main() -> ExitCode {
    match run(&Args::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        // Whoever reads the output has seen enough.
        Err(error) if is_broken_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            let _ = writeln!(std::io::stderr(), "{error:#}");
            ExitCode::from(2)
        }
    }
}

fn is_broken_pipe(error: &anyhow::Error) -> bool {
    let kind = error.downcast_ref::<std::io::Error>().map(std::io::Error::kind);
    kind == Some(std::io::ErrorKind::BrokenPipe)
}

fn run(args: &Args) -> anyhow::Result<()> {
    let study = study(args)?;
    if let Some(folder) = &args.output {
        std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    }
    let generators = Generator::all();
    let bar = if std::io::stderr().is_terminal() {
        ProgressBar::new((generators.len() * study.instances) as u64)
    } else {
        ProgressBar::hidden()
    };
    bar.set_style(ProgressStyle::with_template(
        "{bar:30} {pos}/{len} instances  {elapsed}, {eta} left",
    )?);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(args.jobs).build()?;
    let results: Vec<Outcome> = pool.install(|| {
        let run = |generator| Outcome::new(generator, study.run(&generator, || bar.inc(1)), &study);
        generators.into_iter().map(run).collect()
    });
    bar.finish_and_clear();

    let mut out = std::io::stdout().lock();
    let object = report::json(&study, &results);
    if args.json {
        writeln!(out, "{object}")?;
    } else {
        report::write_tables(&mut out, &study, &results)?;
    }
    if let Some(folder) = &args.output {
        let written = report::write_files(folder, &study, &results, &object)?;
        if !args.json {
            for path in written {
                writeln!(out, "written  {}", path.display())?;
            }
        }
    }
    Ok(())
}

fn study(args: &Args) -> anyhow::Result<Study> {
    let Args { instances, goals, seed, .. } = *args;
    anyhow::ensure!(instances > 0, "--instances 0: expected at least one");
    anyhow::ensure!(
        (2..=MOST_GOALS).contains(&goals),
        "--goals {goals}: expected 2 to {MOST_GOALS}"
    );
    Ok(Study { instances, goals, seed })
}
