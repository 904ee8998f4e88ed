//! `wisdom run`: a mission in closed loop, logged.

use std::collections::BTreeMap;
use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use comfy_table::Table;
use comfy_table::presets::NOTHING;
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::{Value, json};
use wisdom_autonomy::{Decision, Maps, Message, Observation, Outcome};
use wisdom_goals::{Action, Cause, GoalId, Reason};
use wisdom_logbook::{LogWriter, MapMode, Options, SyncPolicy};
use wisdom_mission::{
    FaultEvent, Mission, Override, Progress, RecordError, Recorder, RunStatus, RunSummary,
};

use crate::exit::{InputError, LOSSY};
use crate::mission_args::{MissionArgs, quoted};

/// Run a mission in closed loop and log it.
///
/// A run that is interrupted (Ctrl-C, or a request to terminate) stops after the decision at hand: its log is
/// whole and says `stopped`, and the exit code is 3.
#[derive(clap::Args, Debug)]
pub(crate) struct RunArgs {
    #[command(flatten)]
    mission: MissionArgs,
    /// Where the log goes [default: logs/NAME-seedN-RULE.mcap].
    #[arg(long, value_name = "PATH")]
    log: Option<PathBuf>,
    /// Seed of the world's chance.
    #[arg(long)]
    seed: Option<u64>,
    /// Fusion rule, instead of the mission's (see `wisdom rules`).
    #[arg(long)]
    rule: Option<String>,
    /// How much of the maps the log holds: full (the interest at each decision), patch (what changed of it) or digest (none:
    /// `wisdom log expand` makes them again).
    #[arg(long, default_value_t, value_name = "MODE", value_parser = map_mode)]
    maps: MapMode,
    /// When the log is made to survive a loss of power: cycle (after each decision) or end. A crash of the program alone
    /// never costs a decision.
    #[arg(long, default_value_t, value_name = "WHEN", value_parser = sync_policy)]
    sync: SyncPolicy,
    /// Print nothing but errors.
    #[arg(long)]
    quiet: bool,
    /// Print one JSON object instead of text.
    #[arg(long)]
    json: bool,
    /// Print `decision N` once decision N is safe in the log, for a program that watches over the run: whatever
    /// happens to the process, every decision so acknowledged can be read back.
    #[arg(long, conflicts_with = "json")]
    acknowledge: bool,
}

fn map_mode(text: &str) -> Result<MapMode, String> {
    let named = MapMode::ALL.into_iter().find(|mode| mode.name() == text);
    named.ok_or_else(|| format!("expected one of {}", MapMode::ALL.map(MapMode::name).join(", ")))
}

fn sync_policy(text: &str) -> Result<SyncPolicy, String> {
    let named = SyncPolicy::ALL.into_iter().find(|policy| policy.name() == text);
    named.ok_or_else(|| {
        format!("expected one of {}", SyncPolicy::ALL.map(SyncPolicy::name).join(", "))
    })
}

/// What was done with goals: how often each action was taken for each reason, and with which goals.
#[derive(Default)]
struct Tally {
    changes: BTreeMap<(Action, Reason, Cause), Vec<GoalId>>,
}

/// Writes the log, counts changes and times decisions and the log on the way.
struct Logged<'a> {
    log: &'a mut LogWriter,
    /// How long the log took.
    logging: Duration,
    acknowledge: bool,
    tally: Tally,
    /// When the latest input was handed over.
    told: Instant,
    /// How long each decision took, from its latest input to the choice.
    deciding: Vec<Duration>,
}

/// The wall clock: it is shown to people and never reaches a decision or a log.
#[expect(clippy::disallowed_methods, reason = "timing belongs to the command line")]
fn now() -> Instant {
    Instant::now()
}

impl Logged<'_> {
    /// Keeps a record and counts the time it takes; what is decided next is timed from here.
    fn keep(
        &mut self,
        record: impl FnOnce(&mut LogWriter) -> Result<(), RecordError>,
    ) -> Result<(), RecordError> {
        let begun = now();
        let kept = record(self.log);
        self.told = now();
        self.logging += self.told - begun;
        kept
    }
}

impl Recorder for Logged<'_> {
    fn observation(&mut self, observation: &Observation) -> Result<(), RecordError> {
        self.keep(|log| Recorder::observation(log, observation))
    }

    fn decision(&mut self, decision: &Decision, maps: &Maps) -> Result<(), RecordError> {
        self.deciding.push(now() - self.told);
        for verdict in &decision.verdicts {
            self.tally
                .changes
                .entry((verdict.action, verdict.reason, verdict.cause))
                .or_default()
                .push(verdict.goal.id);
        }
        self.keep(|log| Recorder::decision(log, decision, maps))?;
        if self.acknowledge {
            let mut out = std::io::stdout().lock();
            // A watcher that went away is no reason to end the run.
            writeln!(out, "decision {}", decision.number).and_then(|()| out.flush()).ok();
        }
        Ok(())
    }

    fn outcome(&mut self, outcome: &Outcome) -> Result<(), RecordError> {
        self.keep(|log| Recorder::outcome(log, outcome))
    }

    fn message(&mut self, message: &Message) -> Result<(), RecordError> {
        self.keep(|log| Recorder::message(log, message))
    }

    fn fault(&mut self, event: &FaultEvent) -> Result<(), RecordError> {
        self.keep(|log| Recorder::fault(log, event))
    }
}

/// How long the run took, seconds.
#[derive(Clone, Copy)]
struct Pace {
    /// A decision, in the median.
    median: f64,
    /// The longest decision.
    max: f64,
    /// In the log, from its first byte to its final name.
    logging: f64,
    /// From reading the mission to the log's final name.
    wall: f64,
}

impl Pace {
    fn of(mut times: Vec<Duration>, logging: Duration, wall: Duration) -> Self {
        times.sort_unstable();
        let seconds = |time: Option<&Duration>| time.map_or(0.0, Duration::as_secs_f64);
        Self {
            median: seconds(times.get(times.len() / 2)),
            max: seconds(times.last()),
            logging: logging.as_secs_f64(),
            wall: wall.as_secs_f64(),
        }
    }
}

pub(crate) fn run(args: &RunArgs) -> anyhow::Result<ExitCode> {
    let begun = now();
    let mut overrides = Vec::new();
    overrides.extend(args.seed.map(|s| Override::new("seed", s.to_string())));
    overrides.extend(args.rule.iter().map(|r| Override::new("rule", quoted(r))));
    let mission = args.mission.load(&overrides)?;
    let path = match &args.log {
        Some(path) => path.clone(),
        None => free_name(&mission)?,
    };
    // From the log's first byte on, a request to stop ends it with an end record.
    let stop = interrupted()?;
    let options = Options { sync: args.sync, maps: args.maps };
    let opened = now();
    let mut log = wisdom_logbook::begin(&path, &mission, options)?;
    let logging = now() - opened;
    let bar = bar(args, &mission)?;
    let mut recorder = Logged {
        log: &mut log,
        logging,
        acknowledge: args.acknowledge,
        tally: Tally::default(),
        told: now(),
        deciding: Vec::new(),
    };
    let result = wisdom_mission::run(&mission, &mut recorder, &mut |progress| {
        tick(&bar, progress);
        !stop.load(std::sync::atomic::Ordering::Relaxed)
    });
    let Logged { tally, deciding, mut logging, .. } = recorder;
    bar.finish_and_clear();
    let closing = now();
    let summary = match result {
        Ok(summary) => {
            log.finish(&summary.status.to_string(), &BTreeMap::new())?;
            summary
        }
        Err(error) => {
            // What was written stays, and says why it ends here.
            let closed = log.finish("failed", &BTreeMap::new());
            let error = anyhow::Error::from(error).context(format!("{}", path.display()));
            return Err(match closed {
                Ok(_) => error,
                Err(more) => error.context(format!("and the log could not be closed: {more}")),
            });
        }
    };
    logging += now() - closing;
    let deciding = Pace::of(deciding, logging, now() - begun);
    if args.json || !args.quiet {
        let mut out = std::io::stdout().lock();
        if args.json {
            writeln!(out, "{}", as_json(&mission, &summary, &tally, deciding, &path))?;
        } else {
            write_summary(&mut out, &mission, &summary, &tally, deciding, &path)?;
        }
    }
    Ok(if summary.status == RunStatus::Stopped { ExitCode::from(LOSSY) } else { ExitCode::SUCCESS })
}

/// A flag that an interrupt (Ctrl-C) or a request to terminate raises: the run then ends with its end record.
pub(crate) fn interrupted() -> anyhow::Result<std::sync::Arc<std::sync::atomic::AtomicBool>> {
    let flag = std::sync::Arc::new(std::sync::atomic::AtomicBool::new(false));
    let raised = flag.clone();
    ctrlc::set_handler(move || {
        raised.store(true, std::sync::atomic::Ordering::Relaxed);
    })?;
    Ok(flag)
}

/// `logs/NAME-seedN-RULE.mcap`, with a number behind it if that is taken: a log is never overwritten.
fn free_name(mission: &Mission) -> Result<PathBuf, InputError> {
    let folder = Path::new("logs");
    std::fs::create_dir_all(folder)
        .map_err(|e| InputError(format!("{}: {e}; name a place with --log", folder.display())))?;
    let stem = format!("{}-seed{}-{}", mission.name, mission.seed, mission.spec.fusion.rule);
    let free = |path: &Path| !path.exists() && !path.with_extension("mcap.part").exists();
    (1..=9999)
        .map(|n| match n {
            1 => folder.join(format!("{stem}.mcap")),
            n => folder.join(format!("{stem}-{n}.mcap")),
        })
        .find(|path| free(path))
        .ok_or_else(|| InputError(format!("no free name for {stem} in logs; name one with --log")))
}

fn bar(args: &RunArgs, mission: &Mission) -> anyhow::Result<ProgressBar> {
    let shown = !args.quiet && std::io::stderr().is_terminal();
    let bar = if shown { ProgressBar::new(1000) } else { ProgressBar::hidden() };
    bar.set_style(ProgressStyle::with_template(
        "{prefix} {bar:30} {percent:>3} % of the budget  {msg}  {elapsed}",
    )?);
    bar.set_prefix(mission.name.clone());
    Ok(bar)
}

fn tick(bar: &ProgressBar, progress: &Progress<'_>) {
    let energy = progress.spent.energy_j / progress.energy_j.max(f64::MIN_POSITIVE);
    let time = progress.spent.time_s / progress.time_s.max(f64::MIN_POSITIVE);
    bar.set_position((energy.max(time).clamp(0.0, 1.0) * 1000.0) as u64);
    if let Some(decision) = progress.decision {
        bar.set_message(format!(
            "decision {}, {:.0} m, {} goals reached",
            decision.number, progress.spent.length_m, progress.achieved
        ));
    }
}

/// Changes worth telling: everything but keeping and deferring.
fn told(tally: &Tally) -> impl Iterator<Item = (&(Action, Reason, Cause), &Vec<GoalId>)> {
    tally
        .changes
        .iter()
        .filter(|((action, _, _), _)| !matches!(action, Action::Keep | Action::Defer))
}

fn as_json(
    mission: &Mission,
    summary: &RunSummary,
    tally: &Tally,
    deciding: Pace,
    path: &Path,
) -> Value {
    json!({
        "mission": mission.name,
        "seed": mission.seed,
        "rule": mission.spec.fusion.rule.to_string(),
        "policy": mission.spec.policy.to_string(),
        "status": summary.status.to_string(),
        "goals": summary.achieved.iter().map(|a| json!({
            "goal": a.goal.to_string(), "directive": a.directive,
            "row": a.target.row, "col": a.target.col,
            "interest": a.interest, "prize": a.prize, "ruler": a.ruler, "time_s": a.time_s,
        })).collect::<Vec<_>>(),
        "changes": tally.changes.iter().map(|((action, reason, cause), goals)| json!({
            "action": action.to_string(), "reason": reason.to_string(), "cause": cause.to_string(),
            "count": goals.len(), "goals": goals.iter().map(ToString::to_string).collect::<Vec<_>>(),
        })).collect::<Vec<_>>(),
        "reallocations": summary.reallocations(),
        "interest_own_map": summary.interest(),
        "interest_ruler": summary.ruler(),
        "reliability": summary.reliability(),
        "distance_m": summary.spent.length_m,
        "time_s": summary.spent.time_s,
        "energy_j": summary.spent.energy_j,
        "data_mb": summary.spent.data_mb,
        "decisions": summary.decisions,
        "observations": summary.observations,
        "deciding_s": { "median": deciding.median, "max": deciding.max },
        "logging_s": deciding.logging,
        "wall_s": deciding.wall,
        "legs": legs(summary),
        "faults": summary.faults.iter().map(|f| json!({
            "name": f.name, "kind": f.kind.name(), "time_s": f.time_s,
            "until_s": f.until_s.is_finite().then_some(f.until_s),
        })).collect::<Vec<_>>(),
        "log": path.display().to_string(),
    })
}

fn legs(summary: &RunSummary) -> Value {
    let ended = summary.legs.iter().filter(|l| l.arrived.is_some());
    let arrived = summary.legs.iter().filter(|l| l.arrived == Some(true)).count();
    let predicted = ended.clone().fold(0.0, |sum, l| sum + l.predicted);
    json!({
        "driven": summary.legs.len(),
        "ended": ended.count(),
        "arrived": arrived,
        "predicted_arrivals": predicted,
        "brier": summary.brier(),
    })
}

fn write_summary(
    out: &mut dyn Write,
    mission: &Mission,
    summary: &RunSummary,
    tally: &Tally,
    deciding: Pace,
    path: &Path,
) -> std::io::Result<()> {
    let spec = &mission.spec;
    writeln!(
        out,
        "{}: seed {}, rule {}, policy {}, prize {}\n",
        mission.name, mission.seed, spec.fusion.rule, spec.policy, spec.prize
    )?;
    writeln!(out, "Goals reached, in order")?;
    let mut table = Table::new();
    table.load_style(NOTHING);
    table.set_header(["goal", "directive", "row, col", "interest", "prize", "ruler", "at"]);
    for goal in &summary.achieved {
        table.add_row([
            goal.goal.to_string(),
            goal.directive.clone(),
            format!("{}, {}", goal.target.row, goal.target.col),
            format!("{:.3}", goal.interest),
            format!("{:.3}", goal.prize),
            format!("{:.3}", goal.ruler),
            clock(goal.time_s),
        ]);
    }
    writeln!(out, "{table}")?;
    writeln!(out, "\nWhat was done with goals, and why (keep and defer left out)")?;
    let mut table = Table::new();
    table.load_style(NOTHING);
    table.set_header(["action", "reason", "cause", "times", "goals"]);
    for ((action, reason, cause), goals) in told(tally) {
        let mut names: Vec<String> = goals.iter().take(8).map(ToString::to_string).collect();
        if goals.len() > names.len() {
            names.push("...".into());
        }
        table.add_row([
            action.to_string(),
            reason.to_string(),
            cause.to_string(),
            goals.len().to_string(),
            names.join(" "),
        ]);
    }
    writeln!(out, "{table}\n")?;
    writeln!(
        out,
        "interest gained {:.3} on the rover's own map, {:.3} on the common ruler (the true world under dsmc)",
        summary.interest(),
        summary.ruler()
    )?;
    let legs = legs(summary);
    write!(
        out,
        "legs            {} driven to an end, {} arrived, {:.2} predicted",
        legs["ended"],
        legs["arrived"],
        legs["predicted_arrivals"].as_f64().unwrap_or(0.0)
    )?;
    if let Some(brier) = summary.brier() {
        write!(out, " (Brier score {brier:.4})")?;
    }
    let spent = &summary.spent;
    writeln!(out)?;
    writeln!(
        out,
        "spent           {:.0} m, {} of {}, {:.2} of {:.2} MJ, {:.0} of {:.0} MB",
        spent.length_m,
        clock(spent.time_s),
        clock(spec.budget.time_s),
        spent.energy_j / 1e6,
        (spec.budget.energy_j - spec.budget.reserve_j) / 1e6,
        spent.data_mb,
        spec.budget.data_mb
    )?;
    writeln!(
        out,
        "reliability     {:.4} over all steps driven, by the true hazards",
        summary.reliability()
    )?;
    writeln!(
        out,
        "decisions       {} ({} reallocations after the first), {} looks",
        summary.decisions,
        summary.reallocations(),
        summary.observations
    )?;
    writeln!(
        out,
        "deciding        {:.2} s in the median, {:.2} s at most",
        deciding.median, deciding.max
    )?;
    let share = 100.0 * deciding.logging / deciding.wall.max(f64::MIN_POSITIVE);
    writeln!(
        out,
        "logging         {:.2} s, {share:.1} % of {:.2} s",
        deciding.logging, deciding.wall
    )?;
    for fault in &summary.faults {
        writeln!(out, "broke           {fault}")?;
    }
    writeln!(out, "ended           {}", summary.status)?;
    writeln!(out, "log             {}", path.display())
}

/// Seconds as h:mm.
pub(crate) fn clock(time_s: f64) -> String {
    let minutes = (time_s / 60.0).round() as u64;
    format!("{}:{:02} h", minutes / 60, minutes % 60)
}
