//! `wisdom compare`: runs held against each other, by their logs.

mod against;
mod csv;
mod figures;
mod json;
mod paired;
mod runs;
mod source;
mod tell;
mod world;

use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::ValueEnum;
use indicatif::{ProgressBar, ProgressStyle};
use wisdom_logbook::Status;

use crate::exit::{FAILED, InputError, LOSSY, complain};
use paired::Paired;
use source::Given;
use world::World;

pub(crate) use source::seeds;

/// Hold runs against each other: a mission under several rules, or logs that are there.
///
/// A mission is run under every rule and seed, each run into a log, and the logs are compared; the first rule (or log) is the one the
/// others are held against. Told are: whether they were given the same, where they part and what they knew then, what each
/// rule would have chosen at every state of the other's run, how their goals line up, what each sequence is worth on the
/// other's map, on the common ruler and by labelled truth, and over several seeds the paired differences.
#[derive(clap::Args, Debug)]
pub(crate) struct CompareArgs {
    /// A mission's folder or its mission.toml; or two logs or more (NAME.mcap or NAME.mcap.part).
    #[arg(required = true, value_name = "MISSION|LOG")]
    given: Vec<PathBuf>,
    /// The rules a mission is run under, the first being the one the others are held against
    /// [default: dsmc,dempster,pcr6].
    #[arg(long, value_delimiter = ',', value_name = "RULES")]
    rules: Option<Vec<String>>,
    /// Seeds of the worlds: `3`, `1,4,7` or `1..5` (both ends included); the mission's own by default.
    #[arg(long, value_name = "SEEDS")]
    seeds: Option<String>,
    /// Change a key of mission.toml: `budget.energy-j=2e6`, `directive.0.weight=2`.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// The objective over goal sequences: expected-interest, most-interesting, all-or-nothing, chance-constrained,
    /// net-benefit or utility.
    #[arg(long, value_name = "POLICY")]
    policy: Option<String>,
    /// Keep the logs of a mission's runs in this folder; without it they are removed at the end.
    #[arg(long, value_name = "DIR")]
    logs: Option<PathBuf>,
    /// Whether to ask what each rule would have chosen at every state of the other's run, which takes about as long as the
    /// runs did; by default for one world and not for many.
    #[arg(
        long, value_name = "WHEN", num_args = 0..=1, require_equals = true, default_missing_value = "always"
    )]
    at_states: Option<AtStatesWhen>,
    /// Print one JSON object instead of tables.
    #[arg(long)]
    json: bool,
    /// Write runs.csv, sequences.csv, edits.csv, decisions.csv, regret.csv and paired.csv into this folder.
    #[arg(long, value_name = "DIR")]
    csv: Option<PathBuf>,
    /// Draw maps, sequences, time lines and gains of the first world, and paired differences, into this folder, each as
    /// SVG and as PNG.
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,
    /// Merge the logs of the first world into one new file, under /a/, /b/ and so on, for viewers that know MCAP.
    #[arg(long, value_name = "FILE")]
    mcap: Option<PathBuf>,
    /// No progress, and no remarks on what was written.
    #[arg(long)]
    quiet: bool,
}

/// When to ask what another rule would have chosen.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
enum AtStatesWhen {
    /// For every world.
    Always,
    /// For none.
    Never,
}

/// The most logs in one merged file: runs go by letters there.
const MOST_MERGED: usize = 26;

pub(crate) fn run(args: &CompareArgs) -> anyhow::Result<ExitCode> {
    let given = source::given(args)?;
    check_outputs(args, &given)?;
    let kept = source::log_folder(args, &given)?;
    let worlds = match &given {
        Given::Mission(cases) => {
            let bar = bar(args, cases.len() as u64, "runs")?;
            // Runs end in good order; nothing else here is worth waiting for.
            let stop = crate::run::interrupted()?;
            source::perform(cases, kept.path(), &stop, &bar)?
        }
        Given::Logs(paths) => source::by_world(paths)?,
    };
    let at_states = match args.at_states {
        Some(when) => when == AtStatesWhen::Always,
        None => worlds.len() == 1,
    };
    let (mut compared, mut written) = (Vec::new(), Vec::new());
    for (turn, of_world) in worlds.iter().enumerate() {
        let runs = runs::read(of_world)?;
        let decisions = runs.iter().skip(1).map(|run| run.decisions() + runs[0].decisions()).sum();
        let bar = bar(args, if at_states { decisions } else { 0 }, "states")?;
        let world = World::of(&runs, at_states, &|_| bar.inc(1))?;
        bar.finish_and_clear();
        if let (0, Some(folder)) = (turn, &args.figures) {
            written.extend(figures::draw(folder, &world, &runs)?);
        }
        if let (0, Some(file)) = (turn, &args.mcap) {
            let logs: Vec<&Path> = of_world.iter().map(|run| run.path.as_path()).collect();
            written.push(wisdom_logbook::comparison::merge(file, &logs)?.path);
        }
        compared.push(world);
    }
    let paired = Paired::of(&compared);
    if let (Some(folder), Some(paired)) = (&args.figures, &paired) {
        written.extend(figures::draw_paired(folder, paired)?);
    }
    if let Some(folder) = &args.csv {
        written.extend(csv::write(folder, &compared, paired.as_ref())?);
    }
    let remarks = if args.quiet { Vec::new() } else { remarks(args, &compared) };
    let mut out = std::io::stdout().lock();
    if args.json {
        for remark in remarks {
            complain(&format!("remark: {remark}"));
        }
        writeln!(out, "{}", json::of(&compared, paired.as_ref()))?;
    } else {
        tell::write(&mut out, &compared, paired.as_ref())?;
        if let (Some(_), Given::Mission(_)) = (&args.logs, &given) {
            written.extend(worlds.iter().flatten().map(|run| run.path.clone()));
        }
        for remark in remarks {
            writeln!(out, "{remark}")?;
        }
        if !args.quiet {
            for path in &written {
                writeln!(out, "wrote {}", path.display())?;
            }
        }
    }
    Ok(exit(&compared))
}

/// What of the files asked for is about one world, or is not written at all.
fn remarks(args: &CompareArgs, worlds: &[World]) -> Vec<String> {
    let mut told = Vec::new();
    if args.csv.is_some() && !csv::asked(worlds) {
        told.push(
            "decisions.csv is not written: no rule was asked at the states of another's run; --at-states asks"
                .to_owned(),
        );
    }
    if let ([first, _, ..], true) = (worlds, args.figures.is_some() || args.mcap.is_some()) {
        let what = match (&args.figures, &args.mcap) {
            (Some(_), Some(_)) => "the figures of runs, and the merged log, are",
            (None, Some(_)) => "the merged log is",
            _ => "the figures of runs are",
        };
        told.push(format!("{what} of {}, the first of {} worlds", first.title(), worlds.len()));
    }
    told
}

/// What cannot be written is told before anything is run.
fn check_outputs(args: &CompareArgs, given: &Given) -> Result<(), InputError> {
    if let Some(file) = &args.mcap {
        if file.exists() {
            let message =
                format!("--mcap {}: is there already; a log is never written over", file.display());
            return Err(InputError(message));
        }
        let runs = given.first_world();
        if runs > MOST_MERGED {
            let message = format!(
                "--mcap {}: {runs} runs; at most {MOST_MERGED} go into one file",
                file.display()
            );
            return Err(InputError(message));
        }
    }
    for (option, folder) in [("--csv", &args.csv), ("--figures", &args.figures)] {
        if let Some(folder) = folder {
            std::fs::create_dir_all(folder)
                .map_err(|e| InputError(format!("{option} {}: {e}", folder.display())))?;
        }
    }
    Ok(())
}

fn bar(args: &CompareArgs, length: u64, what: &str) -> anyhow::Result<ProgressBar> {
    let shown = !args.quiet && length > 0 && std::io::stderr().is_terminal();
    let bar = if shown { ProgressBar::new(length) } else { ProgressBar::hidden() };
    let template = format!("{{bar:30}} {{pos}}/{{len}} {what}  {{elapsed}}");
    bar.set_style(ProgressStyle::with_template(&template)?);
    bar.tick();
    Ok(bar)
}

/// A log that is not whole says so, in words and in the code.
fn exit(worlds: &[World]) -> ExitCode {
    let mut code = 0;
    for run in worlds.iter().flat_map(|world| &world.runs) {
        let (word, found) = match &run.status {
            Status::Complete => continue,
            Status::Truncated { .. } => ("remark", LOSSY),
            Status::Corrupt { .. } => ("error", FAILED),
        };
        complain(&format!("{word}: {} is {}", run.path.display(), run.status));
        // What is corrupt weighs more than what is missing.
        code = if code == FAILED { code } else { found };
    }
    ExitCode::from(code)
}
