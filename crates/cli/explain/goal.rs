//! `wisdom explain --goal`: a goal from its first evidence to its end.

use std::io::Write;
use std::process::ExitCode;

use comfy_table::Table;
use comfy_table::presets::NOTHING;
use serde_json::{Value, json};
use wisdom_autonomy::Spec;
use wisdom_goals::{GoalId, Kind, Site};
use wisdom_grid::Cell;
use wisdom_logbook::record::{Goal, Transition};
use wisdom_logbook::{GoalLife, LogReader, Past, Weighing};

use super::ExplainArgs;
use crate::exit::InputError;
use crate::replay::{place, terms};
use crate::run::clock;

/// Cells of a region that are named one by one in text.
const NAMED: usize = 12;

/// What an expert said of the target when the goal was born.
struct Said {
    expert: String,
    layer: String,
    unit: String,
    value: f64,
    uncertainty: f64,
    interesting: f64,
    not_interesting: f64,
    ignorance: f64,
    paradox: f64,
    credit: f64,
}

/// What a goal was born of.
struct Born {
    said: Vec<Said>,
    region: Vec<Cell>,
}

impl Born {
    /// The evidence at the goal's target in the maps of the decision that formulated it.
    fn of(past: &Past, goal: &Goal) -> Self {
        let (maps, spec) = (past.maps(), past.rover.spec());
        let Some(target) = goal.target.map(Cell::from) else {
            return Self { said: Vec::new(), region: Vec::new() };
        };
        let experts = spec.experts.iter().zip(maps.evidence.experts()).enumerate();
        let said = experts.filter_map(|(index, (expert, (_, masses)))| {
            let mass = masses.get(target)?;
            let layer = maps.layers.get(&expert.layer)?;
            let unit = spec.layers.iter().find(|l| l.name == expert.layer);
            Some(Said {
                expert: expert.name.clone(),
                layer: expert.layer.clone(),
                unit: unit.map_or_else(String::new, |l| l.unit.clone()),
                value: f64::from(layer.value(target)),
                uncertainty: f64::from(layer.u(target)),
                interesting: mass.interesting(),
                not_interesting: mass.not_interesting(),
                ignorance: mass.ignorance(),
                paradox: mass.paradox(),
                credit: goal.credit.get(index).copied().unwrap_or(0.0),
            })
        });
        Self { said: said.collect(), region: region(past, spec, goal, target) }
    }
}

/// The cells of the maximum that the goal stands for.
fn region(past: &Past, spec: &Spec, goal: &Goal, target: Cell) -> Vec<Cell> {
    let decision = &past.decision;
    let kind = spec.directives.iter().find(|d| d.name == goal.directive_name).map(|d| d.kind);
    let sites = match kind {
        Some(Kind::LookAgain) => &decision.promises,
        Some(Kind::Adjudicate) => &decision.disputes,
        _ => &decision.sites,
    };
    let of_it = |site: &&Site| site.peak == target || site.region.contains(&target);
    sites.iter().find(of_it).map_or_else(Vec::new, |site| site.region.clone())
}

pub(super) fn run(args: &ExplainArgs, log: &LogReader, goal: GoalId) -> anyhow::Result<ExitCode> {
    let Some(life) = GoalLife::of(log, goal.0) else {
        let mut known: Vec<u32> = log
            .decisions()
            .flat_map(|d| d.choice.iter().flat_map(|c| &c.verdicts))
            .filter_map(|v| v.goal.as_ref().map(|g| g.id))
            .collect();
        known.sort_unstable();
        known.dedup();
        let known = match (known.first(), known.last()) {
            (Some(first), Some(last)) => format!("its goals are G{first} to G{last}"),
            _ => "it speaks of no goal".to_owned(),
        };
        let message = format!("{}: no decision speaks of {goal}; {known}", args.log.display());
        return Err(InputError(message).into());
    };
    let birth = life.birth();
    let born = match (&birth.verdict.goal, wisdom_logbook::derive_at(log, birth.decision)?) {
        (Some(goal), Some(past)) => Born::of(&past, goal),
        _ => Born { said: Vec::new(), region: Vec::new() },
    };
    let mut out = std::io::BufWriter::new(std::io::stdout().lock());
    if args.json {
        writeln!(out, "{}", as_json(args, &life, &born))?;
    } else {
        tell(&mut out, &life, &born)?;
    }
    out.flush()?;
    Ok(crate::exit::of_log(log))
}

fn tell(out: &mut dyn Write, life: &GoalLife, born: &Born) -> std::io::Result<()> {
    let birth = life.birth();
    let none = Goal::default();
    let goal = birth.verdict.goal.as_ref().unwrap_or(&none);
    writeln!(
        out,
        "G{}: {} ({}) at {}",
        life.goal,
        goal.directive_name,
        goal.kind,
        place(goal.target.as_ref())
    )?;
    let parent = goal.parent.map_or_else(String::new, |p| format!(", split off from G{p}"));
    let order = goal
        .order
        .as_ref()
        .map_or_else(String::new, |order| format!(", for the command `{}`", order.name));
    writeln!(
        out,
        "  born       at decision {}, {}: {}{parent}{order}",
        birth.decision,
        clock(birth.time_s),
        birth.verdict.changes.first().map_or(&birth.verdict.reason, |change| &change.reason)
    )?;
    writeln!(
        out,
        "  of         a region of {} cells, {} x {} from {}; interest {:.4}, prize {:.4}, prominence {:.3}",
        goal.region_cells,
        goal.extent_rows,
        goal.extent_cols,
        place(goal.extent_first.as_ref()),
        goal.interest,
        goal.prize,
        goal.prominence
    )?;
    if !born.region.is_empty() {
        let named = born.region.iter().take(NAMED).map(ToString::to_string);
        let mut cells: Vec<String> = named.collect();
        if born.region.len() > NAMED {
            cells.push(format!("and {} more", born.region.len() - NAMED));
        }
        writeln!(out, "             {}", cells.join(" "))?;
    }
    let mut table = Table::new();
    table.load_style(NOTHING);
    table.set_header([
        "    expert",
        "read",
        "value",
        "u",
        "m(I)",
        "m(NI)",
        "m(I u NI)",
        "m(I n NI)",
        "credit",
    ]);
    for said in &born.said {
        table.add_row([
            format!("    {}", said.expert),
            said.layer.clone(),
            format!("{:.4} {}", said.value, said.unit),
            format!("{:.3}", said.uncertainty),
            format!("{:.4}", said.interesting),
            format!("{:.4}", said.not_interesting),
            format!("{:.4}", said.ignorance),
            format!("{:.4}", said.paradox),
            format!("{:.2} %", 100.0 * said.credit),
        ]);
    }
    writeln!(out, "  evidence   at its target when it was born\n{table}")?;
    writeln!(out, "  weighed    {} times", life.weighings.len())?;
    let mut table = Table::new();
    table.load_style(NOTHING);
    table.set_header([
        "    decision",
        "at",
        "place",
        "verdict",
        "turn",
        "interest",
        "prize",
        "credit",
        "numbers",
    ]);
    for weighing in &life.weighings {
        table.add_row(row(weighing, &none));
        for step in changes(weighing) {
            table.add_row(["", "", "", &step]);
        }
    }
    writeln!(out, "{table}")?;
    match life.end() {
        None => writeln!(out, "  end        it was open when the log ended"),
        Some(end) => writeln!(
            out,
            "  end        at decision {}, {}: {}, {}",
            end.decision,
            clock(end.time_s),
            end.verdict.action,
            end.verdict.reason
        ),
    }
}

fn row(weighing: &Weighing, none: &Goal) -> [String; 9] {
    let verdict = &weighing.verdict;
    let goal = verdict.goal.as_ref().unwrap_or(none);
    let credit: Vec<String> = goal.credit.iter().map(|c| format!("{:.1}", 100.0 * c)).collect();
    let other = verdict.other.map_or_else(String::new, |other| format!(" (G{other})"));
    [
        format!("    {}", weighing.decision),
        clock(weighing.time_s),
        place(goal.target.as_ref()),
        format!("{}: {}{other}", verdict.action, verdict.reason),
        verdict.turn.map_or_else(|| "-".to_owned(), |turn| (turn + 1).to_string()),
        format!("{:.4}", goal.interest),
        format!("{:.4}", goal.prize),
        credit.join("/"),
        terms(&verdict.terms),
    ]
}

/// What changed about the goal, and the steps it took, a line each.
fn changes(weighing: &Weighing) -> Vec<String> {
    let changed = weighing.verdict.changes.iter().map(|change| {
        let other = change.other.map_or_else(String::new, |other| format!(" (G{other})"));
        let numbers = terms(&change.terms);
        format!("  {}: {}{other}; {numbers}", change.transformation, change.reason)
    });
    let life = steps(&weighing.steps).map(|life| format!("  {life}"));
    changed.chain(life).collect()
}

fn steps(steps: &[Transition]) -> Option<String> {
    let first = steps.first()?;
    Some(steps.iter().fold(first.from.clone(), |life, step| {
        let outcome = step.outcome.as_ref().map_or_else(String::new, |o| format!(" ({o})"));
        format!("{life} > {}{outcome}", step.to)
    }))
}

fn as_json(args: &ExplainArgs, life: &GoalLife, born: &Born) -> Value {
    let birth = life.birth();
    json!({
        "log": args.log.display().to_string(),
        "goal": format!("G{}", life.goal),
        "born": {
            "decision": birth.decision,
            "time_s": birth.time_s,
            "goal": birth.verdict.goal,
            "reason": birth.verdict.reason,
            "region": born.region.iter().map(|c| [c.row, c.col]).collect::<Vec<_>>(),
            "evidence": born.said.iter().map(|s| json!({
                "expert": s.expert, "layer": s.layer, "unit": s.unit, "value": s.value,
                "uncertainty": s.uncertainty, "credit": s.credit,
                "masses": {
                    "interesting": s.interesting, "not_interesting": s.not_interesting,
                    "ignorance": s.ignorance, "paradox": s.paradox,
                },
            })).collect::<Vec<_>>(),
        },
        "weighings": life.weighings.iter().map(|w| json!({
            "decision": w.decision, "time_s": w.time_s, "verdict": w.verdict, "steps": w.steps,
        })).collect::<Vec<_>>(),
        "end": life.end().map(|end| json!({
            "decision": end.decision, "time_s": end.time_s,
            "action": end.verdict.action, "reason": end.verdict.reason,
        })),
    })
}
