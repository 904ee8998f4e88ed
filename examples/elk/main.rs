//! Elk, sol 992: does one silica reading, handed in while the rover drives on, change its mind? And how do the mission's
//! maps and goals lie against where Curiosity's team truly went?
//!
//! ```text
//! cargo run --release --example elk -- [--full] [--rules LIST] [--json]
//! cargo run --release --example elk -- --report [--runs N] [--json]
//! ```
//!
//! The reading's value is a stand-in: what was measured at Elk is in no file here. So it is swept from 40 to 80 % silica,
//! and what is asked is from which value on the plan holds a goal there, under which rules, prizes and policies, and why.
//!
//! # What is run
//!
//! `missions/marias-pass-elk` from two starts ([`study::sweep::CONDITIONS`]). For every way of deciding there is a run
//! without the reading, the control, and one with a value from every band of the silica expert's table. The table is
//! all that ever looks at the value, and it is a step function: between two of its edges nothing can change. (The
//! sweep by steps, for the mission's own way, shows it.) Where the answer changes and is monotone, bisection finds
//! the value without being told of the edges.
//!
//! # What the maps are held against
//!
//! See [`study::lie`]. Nothing was chosen by its result: parameters are those of `missions/marias-pass`, and what the
//! mission adds to it was written down before the first run with a reading.

mod print;
mod study;

use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};

use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};
use wisdom_belief::Rule;
use wisdom_goals::{Policy, PrizeScale};
use wisdom_mission::{Mission, Override};

use study::known::Known;
use study::lie::{Line, Share, Terms, achieved, goal_shares, ground, line, maps, site_shares};
use study::places::Places;
use study::sweep::{CONDITIONS, Search, Sweep, Way};

/// Sweep the stand-in for the silica reading at Elk, or report how maps and goals lie against the real targets.
#[derive(Parser, Debug)]
#[command(name = "elk", max_term_width = 100)]
#[expect(clippy::struct_excessive_bools, reason = "each is a switch of the command")]
struct Args {
    /// Report how maps and goals lie against the real stops and targets, instead of sweeping.
    #[arg(long)]
    report: bool,
    /// Sweep every rule with every prize and every policy; by default policies are swept under the mission's own rule
    /// and prize only.
    #[arg(long)]
    full: bool,
    /// Rules of combination.
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "dsmc,dempster,yager,dubois-prade,dsmh,pcr5,pcr6"
    )]
    rules: Vec<Rule>,
    /// Find every threshold by bisection; by default those of the mission's own way only, the others from the edges of the
    /// expert's table.
    #[arg(long)]
    bisect: bool,
    /// Step of the sweep over all values, per cent.
    #[arg(long, value_name = "STEP", default_value_t = 4.0)]
    step: f64,
    /// Runs of the report, seeds 1 to N.
    #[arg(long, value_name = "N", default_value_t = 10)]
    runs: u64,
    /// Resamples of each bootstrap.
    #[arg(long, value_name = "N", default_value_t = 2000)]
    resamples: usize,
    /// Runs at a time; all cores by default.
    #[arg(long, value_name = "J", default_value_t = 0, hide_default_value = true)]
    jobs: usize,
    /// Print one JSON object instead of tables.
    #[arg(long)]
    json: bool,
    /// The mission's folder.
    #[arg(long, value_name = "PATH", default_value = "missions/marias-pass-elk")]
    mission: PathBuf,
}

fn main() -> anyhow::Result<()> {
    let args = Args::parse();
    anyhow::ensure!(args.resamples >= 100, "--resamples {}; expected at least 100", args.resamples);
    anyhow::ensure!((0.1..=40.0).contains(&args.step), "--step {}; expected 0.1 to 40", args.step);
    anyhow::ensure!(args.runs >= 1, "--runs 0; expected at least 1");
    let pool = rayon::ThreadPoolBuilder::new().num_threads(args.jobs).build()?;
    let text = pool.install(|| {
        let mut text = Vec::new();
        if args.report { report(&args, &mut text) } else { sweep(&args, &mut text) }?;
        Ok::<_, anyhow::Error>(text)
    })?;
    std::io::stdout().lock().write_all(&text)?;
    Ok(())
}

/// The ways of deciding that are swept.
fn ways(args: &Args, mission: &Mission) -> Vec<Way> {
    let (own_rule, own_prize) = (mission.spec.fusion.rule, mission.spec.prize);
    let own_policy = mission.spec.policy;
    let mut ways = Vec::new();
    for condition in CONDITIONS {
        for rule in &args.rules {
            for prize in PrizeScale::ALL {
                for policy in Policy::ALL {
                    let own = *rule == own_rule && prize == own_prize;
                    if args.full || own || policy == own_policy {
                        ways.push(Way { condition, rule: *rule, prize, policy });
                    }
                }
            }
        }
    }
    ways
}

fn sweep(args: &Args, out: &mut dyn Write) -> anyhow::Result<()> {
    let mission = Mission::load(&args.mission, &[])?;
    let sweep = Sweep::new(&args.mission)?;
    let ways = ways(args, &mission);
    let bar = bar(ways.len() + CONDITIONS.len(), "ways")?;
    let own = |way: &Way| {
        let spec = &mission.spec;
        (way.rule, way.prize, way.policy) == (spec.fusion.rule, spec.prize, spec.policy)
    };
    let mut answers = Vec::new();
    for way in &ways {
        let bisects = args.bisect || own(way);
        let search = if bisects { Search::Bisection } else { Search::Edges };
        let answer = sweep.answer(way, search)?;
        told(&bar, &print::line(&answer))?;
        answers.push(answer);
    }
    let mut stretches = Vec::new();
    for condition in CONDITIONS {
        let spec = &mission.spec;
        let way = Way { condition, rule: spec.fusion.rule, prize: spec.prize, policy: spec.policy };
        stretches.push((way, sweep.stretches(&way, args.step)?));
        told(&bar, &format!("{}: steps of {} %", condition.name, args.step))?;
    }
    bar.finish_and_clear();
    if args.json {
        writeln!(out, "{}", print::sweep_json(&sweep, &mission, &stretches, &answers))?;
        return Ok(());
    }
    print::sweep(out, &sweep, &mission, &stretches, &answers)?;
    Ok(())
}

/// How maps and goals lie against the real places.
struct Report {
    terms: Terms,
    targets: usize,
    target_cells: usize,
    ground: usize,
    lines: Vec<Line>,
    shares: Vec<Share>,
}

fn report(args: &Args, out: &mut dyn Write) -> anyhow::Result<()> {
    let mission = Mission::load(&args.mission, &[])?;
    let places = Places::read(&args.mission.join("terrain"), mission.spec.grid)?;
    let spacing_m = mission.spec.grid.spacing_m();
    let terms =
        Terms { near: 30.0 / spacing_m, met: 5.0 / spacing_m, resamples: args.resamples, seed: 1 };
    let known = Known::of(&mission)?;
    let near = ground(&places, &mission, terms.near);
    let maps = maps(&known, &args.rules, &places)?;
    let bar = bar(maps.len() + CONDITIONS.len() * args.runs as usize, "maps and runs")?;
    let mut lines = Vec::new();
    for (name, map) in &maps {
        lines.push(line(name, map, &places, &near, &terms)?);
        bar.inc(1);
    }
    let mut shares = site_shares(&known, &args.rules, &places, &mission, &terms)?;
    // Goals need no reading; the control is the mission that was there before it.
    for (name, prior) in [("as it ships", "averaged"), ("knowing the world", "complete")] {
        let missions = seeds(&args.mission, args.runs, prior)?;
        let runs = achieved(missions, || bar.inc(1))?;
        shares.extend(goal_shares(name, &runs, &places, &terms));
    }
    bar.finish_and_clear();
    let mut cells: Vec<_> = places.targets.iter().map(|target| target.at.cell()).collect();
    cells.sort_unstable();
    cells.dedup();
    let report = Report {
        terms,
        targets: places.targets.len(),
        target_cells: cells.len(),
        ground: near.len(),
        lines,
        shares,
    };
    if args.json {
        writeln!(out, "{}", print::report_json(&report))?;
        return Ok(());
    }
    print::report(out, &report)?;
    Ok(())
}

/// The mission without its reading, in the worlds of some seeds.
fn seeds(folder: &Path, runs: u64, prior: &str) -> anyhow::Result<Vec<Mission>> {
    (1..=runs)
        .map(|seed| {
            let changes = [
                Override::new("seed", seed.to_string()),
                Override::new("prior.kind", prior),
                Override::new("reading.0.at-s", "1e12"),
            ];
            Ok(Mission::load(folder, &changes)?)
        })
        .collect()
}

/// One step is done, and what came of it; in lines where nobody watches the bar.
fn told(bar: &ProgressBar, line: &str) -> std::io::Result<()> {
    bar.inc(1);
    if bar.is_hidden() { writeln!(std::io::stderr(), "{line}") } else { Ok(()) }
}

fn bar(count: usize, of: &str) -> anyhow::Result<ProgressBar> {
    let bar = if std::io::stderr().is_terminal() {
        ProgressBar::new(count as u64)
    } else {
        ProgressBar::hidden()
    };
    let style = format!("{{bar:30}} {{pos}}/{{len}} {of}  {{elapsed}}, {{eta}} left");
    bar.set_style(ProgressStyle::with_template(&style)?);
    Ok(bar)
}
