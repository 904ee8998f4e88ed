//! `wisdom compare`: the same worlds under several rules, goal sequences side by side.

use std::io::{IsTerminal, Write};
use std::process::ExitCode;

use comfy_table::Table;
use comfy_table::presets::NOTHING;
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::{Value, json};
use wisdom_mission::{
    CampaignRun, Override, Places, first_difference, first_divergent_decision, jaccard,
    kendall_tau, run_all,
};

use crate::exit::InputError;
use crate::mission_args::{MissionArgs, quoted};

/// Run the same worlds under several fusion rules and compare the goal sequences.
#[derive(clap::Args, Debug)]
pub(crate) struct CompareArgs {
    #[command(flatten)]
    mission: MissionArgs,
    /// The rules, the first being the one the others are held against.
    #[arg(long, value_delimiter = ',', default_value = "dsmc,dempster,pcr6")]
    rules: Vec<String>,
    /// Seeds of the worlds: `3`, `1,4,7` or `1..5` (both ends included); the mission's own by default.
    #[arg(long, value_name = "SEEDS")]
    seeds: Option<String>,
    /// Print one JSON object instead of tables.
    #[arg(long)]
    json: bool,
    /// No progress.
    #[arg(long)]
    quiet: bool,
}

/// The most seeds from one to another: more is a slip of the pen.
const MOST_SEEDS: u64 = 10_000;

/// What `--seeds` names.
pub(crate) fn seeds(text: &str) -> Result<Vec<u64>, InputError> {
    let error = || InputError(format!("--seeds {text}: expected `3`, `1,4,7` or `1..5`"));
    let number = |s: &str| s.trim().parse::<u64>().map_err(|_| error());
    let mut seeds = Vec::new();
    for part in text.split(',') {
        match part.split_once("..") {
            Some((from, to)) => {
                let (from, to) = (number(from)?, number(to.trim_start_matches('='))?);
                if from > to {
                    let message = format!("--seeds {text}: {from} is larger than {to}");
                    return Err(InputError(message));
                }
                if to - from >= MOST_SEEDS {
                    let message = format!(
                        "--seeds {text}: expected at most {MOST_SEEDS} from one seed to another"
                    );
                    return Err(InputError(message));
                }
                seeds.extend(from..=to);
            }
            None => seeds.push(number(part)?),
        }
    }
    Ok(seeds)
}

pub(crate) fn run(args: &CompareArgs) -> anyhow::Result<ExitCode> {
    let own = args.mission.load(&[])?;
    let seeds = match &args.seeds {
        Some(text) => seeds(text)?,
        None => vec![own.seed],
    };
    let mut missions = Vec::new();
    for seed in &seeds {
        for rule in &args.rules {
            let overrides = [
                Override::new("seed", seed.to_string()),
                Override::new("rule", quoted(rule.trim())),
            ];
            missions.push(args.mission.load(&overrides)?);
        }
    }
    let shown = !args.quiet && std::io::stderr().is_terminal();
    let bar = if shown { ProgressBar::new(missions.len() as u64) } else { ProgressBar::hidden() };
    bar.set_style(ProgressStyle::with_template("{bar:30} {pos}/{len} runs  {elapsed}")?);
    bar.tick();
    let runs = run_all(missions, |_| bar.inc(1))?;
    bar.finish_and_clear();

    let worlds: Vec<&[CampaignRun]> = runs.chunks(args.rules.len()).collect();
    let mut out = std::io::stdout().lock();
    if args.json {
        let worlds: Vec<Value> = seeds
            .iter()
            .zip(&worlds)
            .map(|(seed, runs)| world_json(*seed, &args.rules, runs))
            .collect();
        let means: Vec<Value> = args
            .rules
            .iter()
            .enumerate()
            .map(|(i, rule)| mean_json(rule, &worlds_of(&runs, i, args.rules.len())))
            .collect();
        writeln!(out, "{}", json!({ "mission": own.name, "worlds": worlds, "means": means }))?;
        return Ok(ExitCode::SUCCESS);
    }
    for (seed, runs) in seeds.iter().zip(&worlds) {
        write_world(&mut out, &own.name, *seed, &args.rules, runs)?;
    }
    if seeds.len() > 1 {
        write_means(&mut out, args, &runs, &worlds)?;
    }
    Ok(ExitCode::SUCCESS)
}

fn worlds_of(runs: &[CampaignRun], rule: usize, rules: usize) -> Vec<&CampaignRun> {
    runs.iter().skip(rule).step_by(rules).collect()
}

/// One run held against the first of its world.
struct Held {
    jaccard: f64,
    tau: Option<f64>,
    turn: Option<usize>,
    decision: Option<u32>,
}

fn held(places: &Places, runs: &[CampaignRun], i: usize) -> Held {
    let (a, b) = (&places.sequences[0], &places.sequences[i]);
    Held {
        jaccard: jaccard(a, b),
        tau: kendall_tau(a, b),
        turn: first_difference(a, b),
        decision: first_divergent_decision(&runs[0].record, &runs[i].record),
    }
}

fn world_json(seed: u64, rules: &[String], runs: &[CampaignRun]) -> Value {
    let places = Places::of(&runs.iter().collect::<Vec<_>>());
    let told: Vec<Value> = runs
        .iter()
        .enumerate()
        .map(|(i, run)| {
            let s = &run.summary;
            let held = held(&places, runs, i);
            json!({
                "rule": rules[i],
                "status": s.status.to_string(),
                "sequence": places.sequences[i].iter().map(|p| format!("P{}", p + 1)).collect::<Vec<_>>(),
                "goals": s.achieved.iter().map(|a| json!({
                    "goal": a.goal.to_string(), "directive": a.directive,
                    "row": a.target.row, "col": a.target.col,
                    "interest": a.interest, "prize": a.prize, "ruler": a.ruler, "time_s": a.time_s,
                })).collect::<Vec<_>>(),
                "interest_own_map": s.interest(),
                "interest_ruler": s.ruler(),
                "distance_m": s.spent.length_m,
                "time_s": s.spent.time_s,
                "energy_j": s.spent.energy_j,
                "reliability": run.summary.reliability(),
                "decisions": s.decisions,
                "reallocations": s.reallocations(),
                "against_first": {
                    "jaccard": held.jaccard,
                    "kendall_tau": held.tau,
                    "first_different_stop": held.turn.map(|t| t + 1),
                    "first_divergent_decision": held.decision,
                },
            })
        })
        .collect();
    json!({
        "seed": seed,
        "places": places.places.iter().enumerate()
            .map(|(i, c)| json!({ "name": format!("P{}", i + 1), "row": c.row, "col": c.col }))
            .collect::<Vec<_>>(),
        "runs": told,
    })
}

fn write_world(
    out: &mut dyn Write,
    name: &str,
    seed: u64,
    rules: &[String],
    runs: &[CampaignRun],
) -> std::io::Result<()> {
    let places = Places::of(&runs.iter().collect::<Vec<_>>());
    writeln!(out, "{name}, world of seed {seed}: goals reached, in order (same name, same place)")?;
    let mut table = Table::new();
    table.load_style(NOTHING);
    let mut header = vec!["stop".to_owned()];
    header.extend(rules.iter().cloned());
    table.set_header(header);
    let longest = places.sequences.iter().map(Vec::len).max().unwrap_or(0);
    for turn in 0..longest {
        let mut row = vec![(turn + 1).to_string()];
        for (sequence, run) in places.sequences.iter().zip(runs) {
            row.push(sequence.get(turn).map_or_else(String::new, |p| {
                let goal = &run.summary.achieved[turn];
                format!("P{} ({}, {}) {:.3}", p + 1, goal.target.row, goal.target.col, goal.ruler)
            }));
        }
        table.add_row(row);
    }
    writeln!(out, "{table}")?;
    writeln!(out, "P: place (row, col) and its interest on the common ruler\n")?;

    let mut table = Table::new();
    table.load_style(NOTHING);
    table.set_header([
        "rule",
        "goals",
        "interest\nown map",
        "interest\nruler",
        "distance\nm",
        "reliab.",
        "realloc.",
        "Jaccard",
        "Kendall",
        "parts at\nstop",
        "parts at\ndecision",
    ]);
    let dash = || "-".to_owned();
    for (i, run) in runs.iter().enumerate() {
        let s = &run.summary;
        let held = held(&places, runs, i);
        table.add_row([
            rules[i].clone(),
            s.achieved.len().to_string(),
            format!("{:.3}", s.interest()),
            format!("{:.3}", s.ruler()),
            format!("{:.0}", s.spent.length_m),
            format!("{:.3}", run.summary.reliability()),
            s.reallocations().to_string(),
            format!("{:.2}", held.jaccard),
            held.tau.map_or_else(dash, |t| format!("{t:.2}")),
            held.turn.map_or_else(dash, |t| (t + 1).to_string()),
            held.decision.map_or_else(dash, |n| n.to_string()),
        ]);
    }
    writeln!(out, "{table}")?;
    writeln!(
        out,
        "Jaccard, Kendall and where they part: against {}. Ruler: interest on the noise-free, fully known\n\
         world under dsmc.\n",
        rules[0]
    )
}

/// Means of one rule over all worlds.
struct Means {
    goals: f64,
    own: f64,
    ruler: f64,
    distance_m: f64,
    reallocations: f64,
}

fn means(runs: &[&CampaignRun]) -> Means {
    let mean = |f: &dyn Fn(&CampaignRun) -> f64| {
        runs.iter().map(|r| f(r)).sum::<f64>() / runs.len().max(1) as f64
    };
    Means {
        goals: mean(&|r| r.summary.achieved.len() as f64),
        own: mean(&|r| r.summary.interest()),
        ruler: mean(&|r| r.summary.ruler()),
        distance_m: mean(&|r| r.summary.spent.length_m),
        reallocations: mean(&|r| f64::from(r.summary.reallocations())),
    }
}

fn mean_json(rule: &str, runs: &[&CampaignRun]) -> Value {
    let m = means(runs);
    json!({
        "rule": rule, "goals": m.goals, "interest_own_map": m.own, "interest_ruler": m.ruler,
        "distance_m": m.distance_m, "reallocations": m.reallocations,
    })
}

fn write_means(
    out: &mut dyn Write,
    args: &CompareArgs,
    runs: &[CampaignRun],
    worlds: &[&[CampaignRun]],
) -> std::io::Result<()> {
    writeln!(out, "means over {} worlds", worlds.len())?;
    let mut table = Table::new();
    table.load_style(NOTHING);
    table.set_header([
        "rule",
        "goals",
        "interest\nown map",
        "interest\nruler",
        "distance\nm",
        "realloc.",
        "Jaccard",
        "Kendall",
    ]);
    for (i, rule) in args.rules.iter().enumerate() {
        let m = means(&worlds_of(runs, i, args.rules.len()));
        let held: Vec<Held> =
            worlds.iter().map(|w| held(&Places::of(&w.iter().collect::<Vec<_>>()), w, i)).collect();
        let taus: Vec<f64> = held.iter().filter_map(|h| h.tau).collect();
        let tau = if taus.is_empty() {
            "-".to_owned()
        } else {
            format!("{:.2}", taus.iter().sum::<f64>() / taus.len() as f64)
        };
        table.add_row([
            rule.clone(),
            format!("{:.1}", m.goals),
            format!("{:.3}", m.own),
            format!("{:.3}", m.ruler),
            format!("{:.0}", m.distance_m),
            format!("{:.1}", m.reallocations),
            format!("{:.2}", held.iter().map(|h| h.jaccard).sum::<f64>() / held.len() as f64),
            tau,
        ]);
    }
    writeln!(out, "{table}")
}
