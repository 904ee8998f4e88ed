//! `wisdom campaign`: one mission under many seeds, rules and policies, a row a run.

mod columns;
mod folder;
#[cfg(feature = "parquet")]
mod parquet;
mod plots;
mod summary;
mod work;

use std::io::{IsTerminal, Write};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::{AtomicUsize, Ordering};

use clap::Subcommand;
use indicatif::{ProgressBar, ProgressStyle};
use rayon::ThreadPool;
use serde_json::json;
use wisdom_mission::{MISSION_FILE, Mission, Plan, Row, RowResult};

use self::folder::{Folder, Given, Kept, Manifest, write_whole};
use self::summary::Summary;
use crate::exit::{self, InputError};
use crate::mission_args::MissionArgs;

/// Run a mission under many seeds, rules and policies, and keep a row a run.
///
/// The folder DIR holds everything: campaign.toml (what the campaign is), mission/ (the mission's files), runs/ (a
/// file a run), and, made from these, runs.csv, legs.csv and summary.json. The same call again goes on where the last one
/// ended; more seeds behind the others extend the campaign. docs/campaign.md explains every column.
#[derive(clap::Args, Debug)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub(crate) struct CampaignArgs {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    start: Option<StartArgs>,
    // Not inside `StartArgs`: clap cannot tell whether a group that holds groups is there.
    #[command(flatten)]
    jobs: Jobs,
    #[command(flatten)]
    told: Told,
}

#[derive(Subcommand, Debug)]
enum Command {
    /// Do one run of a campaign's folder, unless it is done already.
    RunOne(OneArgs),
    /// Make the tables and the summary of a campaign's folder from the runs that are there.
    Gather(GatherArgs),
}

// Without a doc comment: one here would hide that of `CampaignArgs`.
#[derive(clap::Args, Debug)]
struct StartArgs {
    /// A mission's folder or its mission.toml.
    mission: PathBuf,
    /// Seeds of the worlds: `3`, `1,4,7` or `1..100` (both ends included).
    #[arg(long, value_name = "SEEDS")]
    seeds: String,
    /// The rules of combination, the first being the one the others are held against [default: the mission's].
    #[arg(long, value_delimiter = ',')]
    rules: Vec<String>,
    /// The objectives over goal sequences [default: the mission's].
    #[arg(long, value_delimiter = ',')]
    policies: Vec<String>,
    /// Change a key of mission.toml: `budget.energy-j=2e6`, `directive.0.weight=2`.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Only make the folder, for `run-one` to fill.
    #[arg(long)]
    prepare: bool,
    /// The campaign's folder.
    #[arg(short, long = "output", value_name = "DIR")]
    output: PathBuf,
}

/// One run of a campaign.
#[derive(clap::Args, Debug)]
struct OneArgs {
    /// The campaign's folder.
    folder: PathBuf,
    /// The run, from 0: seed by seed, then rule by rule, then policy by policy.
    #[arg(long)]
    index: usize,
    #[command(flatten)]
    jobs: Jobs,
    /// Print one JSON object instead of text.
    #[arg(long)]
    json: bool,
    /// Print nothing but errors, and the object of --json.
    #[arg(long)]
    quiet: bool,
}

#[derive(clap::Args, Debug)]
struct GatherArgs {
    /// The campaign's folder.
    folder: PathBuf,
    #[command(flatten)]
    told: Told,
}

#[derive(clap::Args, Debug)]
struct Jobs {
    /// Threads to work with [default: all cores].
    #[arg(long, value_name = "J")]
    jobs: Option<usize>,
}

/// How the tables and the summary are given.
#[derive(clap::Args, Debug)]
struct Told {
    /// Write runs.parquet too.
    #[arg(long)]
    parquet: bool,
    /// Print one JSON object instead of text.
    #[arg(long)]
    json: bool,
    /// Print nothing but errors, and the object of --json.
    #[arg(long)]
    quiet: bool,
}

pub(crate) fn run(args: &CampaignArgs) -> anyhow::Result<ExitCode> {
    match (&args.command, &args.start) {
        (Some(Command::RunOne(args)), _) => run_one(args),
        (Some(Command::Gather(args)), _) => gather(args),
        (None, Some(start)) => begin(start, &args.jobs, &args.told),
        (None, None) => Err(InputError("expected a mission, `run-one` or `gather`".into()).into()),
    }
}

impl Jobs {
    /// All the threads there will be: what a run does in parallel goes to the same ones.
    fn pool(&self) -> anyhow::Result<ThreadPool> {
        let all = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
        let jobs = self.jobs.unwrap_or(all);
        if jobs == 0 || jobs > MAX_JOBS {
            let message = format!("--jobs {jobs}: expected 1 to {MAX_JOBS}");
            return Err(InputError(message).into());
        }
        Ok(rayon::ThreadPoolBuilder::new().num_threads(jobs).build()?)
    }
}

/// The most threads of a campaign: more is a slip of the pen, and far more than there are cores make it crawl.
const MAX_JOBS: usize = 256;

impl Told {
    /// Refuses what this program was built without.
    fn check(&self) -> Result<(), InputError> {
        if self.parquet && !cfg!(feature = "parquet") {
            let message = "--parquet: this program was built without it; `cargo build --release --features parquet` \
                           builds it in";
            return Err(InputError(message.into()));
        }
        Ok(())
    }
}

/// What the call asks for, without looking at any folder but the mission's.
fn wanted(args: &StartArgs) -> anyhow::Result<(Mission, Manifest)> {
    if !args.mission.exists() {
        let message = format!(
            "{}: there is no such file; a mission's folder or its {MISSION_FILE} is expected",
            args.mission.display()
        );
        return Err(InputError(message).into());
    }
    for change in &args.set {
        let key = change.split('=').next().unwrap_or_default().trim();
        for (taken, plural) in [("seed", "seeds"), ("rule", "rules"), ("policy", "policies")] {
            if key == taken {
                let message =
                    format!("--set {change}: a campaign's {plural} are given with --{plural}");
                return Err(InputError(message).into());
            }
        }
    }
    let mission =
        MissionArgs { mission: args.mission.clone(), set: args.set.clone(), policy: None };
    let base = mission.load(&[])?;
    let rules = named("--rules", &args.rules, base.spec.fusion.rule)?;
    let policies = named("--policies", &args.policies, base.spec.policy)?;
    let seeds = crate::compare::seeds(&args.seeds)?;
    let plan = Plan::new(seeds, &rules, &policies).map_err(|e| InputError(e.to_string()))?;
    // A rule that does not suit the mission is told before anything is written.
    for (index, _) in plan.variants().iter().enumerate() {
        mission.load(&plan.case(index).expect("the first world").overrides())?;
    }
    let manifest = Manifest::of(&base, &args.mission, &plan)?;
    Ok((base, manifest))
}

/// Names as given, or what the mission has.
fn named<T>(option: &str, names: &[String], own: T) -> Result<Vec<T>, InputError>
where
    T: std::str::FromStr,
    T::Err: std::fmt::Display,
{
    if names.is_empty() {
        return Ok(vec![own]);
    }
    let error = |e: T::Err| InputError(format!("{option}: {e}"));
    names.iter().map(|n| n.trim().parse().map_err(error)).collect()
}

fn begin(args: &StartArgs, jobs: &Jobs, told: &Told) -> anyhow::Result<ExitCode> {
    told.check()?;
    let pool = jobs.pool()?;
    let (mission, manifest) = wanted(args)?;
    let given = Given { rules: !args.rules.is_empty(), policies: !args.policies.is_empty() };
    let folder = Folder::prepare(&args.output, &manifest, given, &mission)?;
    drop(mission);
    folder.check()?;
    if args.prepare {
        let mut out = std::io::stdout().lock();
        let (shown, count) = (folder.shown().to_string(), folder.plan.len());
        if told.json {
            writeln!(out, "{}", json!({ "campaign": shown, "runs": count }))?;
        } else if !told.quiet {
            let (runs, last) = (counted(count, "run"), count - 1);
            writeln!(
                out,
                "{shown} is ready: {runs}; `wisdom campaign run-one {shown} --index I`, I from 0 to {last}"
            )?;
        }
        return Ok(ExitCode::SUCCESS);
    }
    folder.clear_parts()?;
    let (rows, open) = folder.survey(&mut |text| exit::complain(&format!("remark: {text}")))?;
    drop(rows);
    let stop = crate::run::interrupted()?;
    let bar = bar(told, &folder, open.len())?;
    let begun = work::now();
    let done = AtomicUsize::new(0);
    let ended =
        work::all(&pool, &open, &stop, &|case| work::perform(&folder, case, &stop), &|row, s| {
            folder.keep(row, s)?;
            done.fetch_add(1, Ordering::Relaxed);
            bar.inc(1);
            Ok(())
        });
    let (wall_s, done) = (begun.elapsed().as_secs_f64(), done.into_inner());
    bar.finish_and_clear();
    ended?;
    let pace = Pace { runs: done, wall_s, jobs: pool.current_num_threads() };
    pool.install(|| conclude(&folder, told, Some(&pace)))
}

fn bar(told: &Told, folder: &Folder, open: usize) -> anyhow::Result<ProgressBar> {
    let shown = !told.quiet && std::io::stderr().is_terminal();
    let all = folder.plan.len();
    let bar = if shown { ProgressBar::new(all as u64) } else { ProgressBar::hidden() };
    bar.set_style(ProgressStyle::with_template(
        "{prefix} {bar:30} {pos}/{len} runs  {elapsed} gone, {eta} left",
    )?);
    bar.set_prefix(folder.manifest.mission.clone());
    bar.set_position((all - open) as u64);
    // What was done before says nothing of the pace.
    bar.reset_eta();
    bar.tick();
    Ok(bar)
}

/// How fast a campaign went.
struct Pace {
    runs: usize,
    wall_s: f64,
    jobs: usize,
}

impl Pace {
    /// Missions a minute; none if none was run.
    fn per_minute(&self) -> Option<f64> {
        (self.runs > 0).then(|| self.runs as f64 * 60.0 / self.wall_s.max(f64::MIN_POSITIVE))
    }
}

/// Makes the tables and the summary from the rows that are there, and tells how the campaign stands.
fn conclude(folder: &Folder, told: &Told, pace: Option<&Pace>) -> anyhow::Result<ExitCode> {
    let (rows, _) = folder.survey(&mut |text| exit::complain(&format!("remark: {text}")))?;
    columns::write_runs(&folder.path("runs.csv"), &rows)?;
    columns::write_legs(&folder.path("legs.csv"), &rows)?;
    write_parquet(folder, told, &rows)?;
    let summary = Summary::of(folder, &rows);
    let text = serde_json::to_string_pretty(&summary.as_json())? + "\n";
    write_whole(&folder.path("summary.json"), text.as_bytes())?;
    plots::draw(&folder.path(""), &summary)?;
    let mut out = std::io::stdout().lock();
    if told.json {
        let object = json!({
            "campaign": folder.shown().to_string(),
            "computed": pace.map_or(0, |pace| pace.runs),
            "jobs": pace.map(|pace| pace.jobs),
            "wall_s": pace.map(|pace| pace.wall_s),
            "missions_per_minute": pace.and_then(Pace::per_minute),
            "summary": summary.as_json(),
        });
        writeln!(out, "{object}")?;
    } else if !told.quiet {
        summary.write(&mut out)?;
        if let Some((pace, rate)) = pace.and_then(|pace| Some((pace, pace.per_minute()?))) {
            let Pace { runs, wall_s, jobs } = pace;
            let (runs, jobs) = (counted(*runs, "run"), counted(*jobs, "job"));
            writeln!(out, "{runs} in {wall_s:.1} s, {rate:.1} missions a minute, {jobs}")?;
        }
        writeln!(out, "tables and summary in {}", folder.shown())?;
    }
    drop(out);
    if summary.missing() > 0 {
        let (missing, all) = (summary.missing(), folder.plan.len());
        exit::complain(&format!(
            "remark: {missing} of {all} runs are still to be done; the same call again goes on, or `wisdom campaign \
             run-one {} --index I` does one",
            folder.shown()
        ));
    }
    Ok(match (summary.failed(), summary.missing()) {
        (0, 0) => ExitCode::SUCCESS,
        (0, _) => ExitCode::from(exit::LOSSY),
        _ => ExitCode::from(exit::FAILED),
    })
}

/// A number of things in words.
fn counted(count: usize, thing: &str) -> String {
    format!("{count} {thing}{}", if count == 1 { "" } else { "s" })
}

#[cfg(feature = "parquet")]
fn write_parquet(folder: &Folder, told: &Told, rows: &[Row]) -> anyhow::Result<()> {
    if told.parquet {
        parquet::write(&folder.path("runs.parquet"), rows)?;
    }
    Ok(())
}

#[cfg(not(feature = "parquet"))]
#[expect(clippy::unnecessary_wraps, reason = "with the feature it may fail")]
fn write_parquet(_: &Folder, _: &Told, _: &[Row]) -> anyhow::Result<()> {
    Ok(())
}

fn gather(args: &GatherArgs) -> anyhow::Result<ExitCode> {
    args.told.check()?;
    let folder = Folder::open(&args.folder)?;
    if let Some(difference) = folder.program_difference() {
        exit::complain(&format!("remark: {}: {difference}", folder.shown()));
    }
    conclude(&folder, &args.told, None)
}

fn run_one(args: &OneArgs) -> anyhow::Result<ExitCode> {
    let folder = Folder::open(&args.folder)?;
    let Some(case) = folder.plan.case(args.index) else {
        let message = format!(
            "--index {}: {} has {} runs, 0 to {}",
            args.index,
            folder.shown(),
            folder.plan.len(),
            folder.plan.len() - 1
        );
        return Err(InputError(message).into());
    };
    folder.check()?;
    match folder.kept(&case)? {
        Kept::Whole(row) if row.run().is_some() => return tell_one(args, &folder, &row, true),
        Kept::Spoiled(why) => exit::complain(&format!("remark: {why}; it is computed again")),
        Kept::Whole(_) | Kept::Nothing => {}
    }
    let pool = args.jobs.pool()?;
    let stop = crate::run::interrupted()?;
    work::all(
        &pool,
        std::slice::from_ref(&case),
        &stop,
        &|case| work::perform(&folder, case, &stop),
        &|row, wall_s| folder.keep(row, wall_s),
    )?;
    match folder.kept(&case)? {
        Kept::Whole(row) => tell_one(args, &folder, &row, false),
        Kept::Spoiled(why) => anyhow::bail!("{why}, though just written"),
        Kept::Nothing => {
            exit::complain(&format!(
                "remark: run {} was stopped; nothing is kept of it",
                case.index
            ));
            Ok(ExitCode::from(exit::LOSSY))
        }
    }
}

/// Tells what there is of a run.
fn tell_one(
    args: &OneArgs,
    folder: &Folder,
    row: &Row,
    was_done: bool,
) -> anyhow::Result<ExitCode> {
    let path = folder.row_path(row.index);
    let mut out = std::io::stdout().lock();
    if args.json {
        let object = json!({
            "row": serde_json::to_value(row)?,
            "path": path.display().to_string(),
            "computed": !was_done,
        });
        writeln!(out, "{object}")?;
    }
    match &row.result {
        RowResult::Failed { error } => {
            exit::complain(&format!("error: run {} failed: {error}", row.index));
            Ok(ExitCode::from(exit::FAILED))
        }
        RowResult::Finished(run) => {
            if !args.json && !args.quiet {
                let how = if was_done { "was done already" } else { "is done" };
                writeln!(
                    out,
                    "run {} {how} (seed {}, {}, {}): {}, {} goals; {}",
                    row.index,
                    row.seed,
                    row.rule,
                    row.policy,
                    run.status,
                    run.goals.len(),
                    path.display()
                )?;
            }
            Ok(ExitCode::SUCCESS)
        }
    }
}
