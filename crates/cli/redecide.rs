//! `wisdom redecide`: every logged decision again, from its logged state, under a change.

use std::io::{IsTerminal, Write};
use std::path::PathBuf;
use std::process::ExitCode;

use comfy_table::Table;
use comfy_table::presets::NOTHING;
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::{Value, json};
use wisdom_logbook::record::{Act, Decision, Goal, Sequence, Verdict};
use wisdom_logbook::{
    LogReader, Redecided, ReplayError, Retaken, Terms, mission_with, redecide, side_by_side,
};
use wisdom_mission::{Mission, Override};

use crate::exit::InputError;
use crate::mission_args::{changes, quoted};
use crate::replay::place;

/// Take every logged decision again under another rule, policy or value, each from its logged state.
///
/// The readings, the rover's pose, purse and facts and the goal manager's memory are those that were logged, so what differs is the
/// work of the change alone. After the first difference the changed rover would have driven elsewhere: what is told of later
/// decisions is what it would have done in the logged rover's place.
#[derive(clap::Args, Debug)]
pub(crate) struct RedecideArgs {
    /// The log (NAME.mcap or NAME.mcap.part).
    log: PathBuf,
    /// Fusion rule, instead of the log's (see `wisdom rules`).
    #[arg(long)]
    rule: Option<String>,
    /// The objective over goal sequences, instead of the log's.
    #[arg(long, value_name = "POLICY")]
    policy: Option<String>,
    /// Change a key of the mission: `goals.hysteresis=0`, `directive.0.weight=2`.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Another mission on the same ground (a folder or a mission.toml), instead of the one in the log.
    #[arg(long, value_name = "MISSION")]
    mission: Option<PathBuf>,
    /// The decision told term by term; the first that differs by default.
    #[arg(long, value_name = "N")]
    decision: Option<u32>,
    /// Print one JSON object instead of text.
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &RedecideArgs) -> anyhow::Result<ExitCode> {
    let mut overrides: Vec<Override> = Vec::new();
    overrides.extend(args.rule.iter().map(|r| Override::new("rule", quoted(r))));
    overrides.extend(args.policy.iter().map(|p| Override::new("policy", quoted(p))));
    changes(&mut overrides, &args.set)?;
    if overrides.is_empty() && args.mission.is_none() {
        let message = "nothing is changed: give --rule, --policy, --set or --mission";
        return Err(InputError(message.to_owned()).into());
    }
    let log = LogReader::open(&args.log)?;
    let under = match &args.mission {
        Some(path) => Mission::load(path, &overrides)?,
        None => match mission_with(&log, &overrides) {
            // The log's own mission loads: what does not is the change.
            Err(ReplayError::Mission(error)) => return Err(error.into()),
            other => other?,
        },
    };
    let count = log.decisions().count();
    if let Some(number) = args.decision
        && !log.decisions().any(|d| d.number == number)
    {
        let name = args.log.display();
        let message = format!("{name}: no decision {number}; the log holds {count}, from 0");
        return Err(InputError(message).into());
    }
    let shown = !args.json && std::io::stderr().is_terminal();
    let bar = if shown { ProgressBar::new(count as u64) } else { ProgressBar::hidden() };
    bar.set_style(ProgressStyle::with_template("{bar:30} {pos} of {len} decisions  {elapsed}")?);
    let radius_cells = under.spec.manager.identity_radius_m / under.spec.grid.spacing_m();
    let mut rows: Vec<Row> = Vec::new();
    let mut in_full: Option<Retaken> = None;
    let found = redecide(&log, &under, &mut |retaken| {
        bar.inc(1);
        rows.push(Row::of(&retaken));
        let wanted = match args.decision {
            Some(number) => retaken.logged.number == number,
            None => retaken.parting.is_some() && in_full.is_none(),
        };
        if wanted {
            in_full = Some(retaken);
        }
        true
    })?;
    bar.finish_and_clear();
    let mut out = std::io::BufWriter::new(std::io::stdout().lock());
    let change = Change::between(&log, &under, args, &overrides);
    if args.json {
        let object = json!({
            "log": args.log.display().to_string(),
            "change": change.0,
            "decisions": found.decisions,
            "alike": found.alike,
            "first": found.first,
            "remarks": found.remarks,
            "rows": rows.iter().map(Row::as_json).collect::<Vec<_>>(),
            "terms": in_full.as_ref().map(|r| terms_json(r, radius_cells)),
        });
        writeln!(out, "{object}")?;
    } else {
        tell(&mut out, &change, &found, &rows)?;
        if let Some(retaken) = &in_full {
            tell_terms(&mut out, retaken, radius_cells)?;
        }
    }
    out.flush()?;
    Ok(crate::exit::of_log(&log))
}

/// What is changed, in words.
struct Change(String);

impl Change {
    fn between(
        log: &LogReader,
        under: &Mission,
        args: &RedecideArgs,
        overrides: &[Override],
    ) -> Self {
        let mut told: Vec<String> = Vec::new();
        if let Some(path) = &args.mission {
            told.push(format!("mission {} ({})", path.display(), under.name));
        }
        for Override { key, value, .. } in overrides {
            let value = value.trim_matches('"');
            told.push(match log.metadata.get(key) {
                Some(before) => format!("{key} {value} (logged: {before})"),
                None => format!("{key}={value}"),
            });
        }
        Self(told.join(", "))
    }
}

/// One decision, told in a line.
struct Row {
    number: u32,
    parting: Option<&'static str>,
    stage: Option<String>,
    logged: Told,
    decided: Told,
    score: (Option<f64>, f64),
}

/// What was chosen.
struct Told {
    act: String,
    order: Vec<String>,
    value: f64,
}

impl Told {
    fn of(decision: &Decision) -> Self {
        let sequence = sequence(decision);
        let order = sequence.iter().flat_map(|s| &s.stops).map(|s| format!("G{}", s.goal));
        Self {
            act: act(decision),
            order: order.collect(),
            value: sequence.map_or(0.0, |s| s.value),
        }
    }

    fn as_json(&self) -> Value {
        json!({ "act": self.act, "order": self.order, "value": self.value })
    }
}

impl Row {
    fn of(retaken: &Retaken) -> Self {
        Self {
            number: retaken.logged.number,
            parting: retaken.parting.map(wisdom_logbook::Parting::name),
            stage: retaken.difference.as_ref().map(|d| d.stage.to_owned()),
            logged: Told::of(&retaken.logged),
            decided: Told::of(&retaken.decided),
            score: (retaken.scores.logged, retaken.scores.decided),
        }
    }

    fn as_json(&self) -> Value {
        json!({
            "decision": self.number,
            "differs_in": self.parting,
            "first_stage": self.stage,
            "logged": self.logged.as_json(),
            "decided": self.decided.as_json(),
            "expected_interest": { "logged": self.score.0, "decided": self.score.1 },
        })
    }
}

fn sequence(decision: &Decision) -> Option<&Sequence> {
    let chosen = decision.choice.as_ref()?.chosen as usize;
    decision.objective.as_ref()?.family.get(chosen)?.sequence.as_ref()
}

/// What is to be done next, in words.
fn act(decision: &Decision) -> String {
    let none = Act::default();
    let choice = decision.choice.as_ref();
    let act = choice.and_then(|c| c.act.as_ref()).unwrap_or(&none);
    let end = act.route.as_ref().and_then(|route| route.cells.last());
    match (act.goal, end) {
        (Some(goal), _) => {
            let verdicts = choice.map_or(&[][..], |c| &c.verdicts);
            let goals = verdicts.iter().filter_map(|v| v.goal.as_ref());
            let target = goals.filter(|g| g.id == goal).find_map(|g| g.target.as_ref());
            format!("{} G{goal} at {}", act.name, place(target))
        }
        (None, Some(end)) => format!("{} from {}", act.name, place(Some(end))),
        (None, None) => act.name.clone(),
    }
}

fn tell(
    out: &mut dyn Write,
    change: &Change,
    found: &Redecided,
    rows: &[Row],
) -> std::io::Result<()> {
    let Redecided { decisions, alike, first, remarks, .. } = found;
    writeln!(out, "Under {}: {alike} of {decisions} decisions choose alike", change.0)?;
    for remark in remarks {
        writeln!(out, "remark: {remark}")?;
    }
    if change.0.starts_with("mission ") {
        writeln!(
            out,
            "remark: readings, messages and the times of decisions are the log's; rules, tables, directives, limits and \
             the effort of\n        searching are the other mission's, without what the log's run had changed (--set)"
        )?;
    }
    let mut table = Table::new();
    table.load_style(NOTHING);
    table.set_header([
        "decision",
        "differs in",
        "logged",
        "here",
        "logged order\non this map",
        "own order",
    ]);
    for row in rows {
        let decided = match row.parting {
            None => String::new(),
            Some("order") => row.decided.order.join(" > "),
            Some(_) => row.decided.act.clone(),
        };
        let logged = match row.parting {
            Some("order") => row.logged.order.join(" > "),
            _ => row.logged.act.clone(),
        };
        table.add_row([
            row.number.to_string(),
            row.parting.unwrap_or("-").to_owned(),
            logged,
            decided,
            row.score.0.map_or_else(|| "-".to_owned(), |score| format!("{score:.3}")),
            format!("{:.3}", row.score.1),
        ]);
    }
    writeln!(out, "\n{table}")?;
    writeln!(
        out,
        "Scores: expected interest of both orders on the map of this change. The own order may have less: it was chosen by the\n\
         mission's policy, and places of the logged one need be no goals here. Goals born at the decision itself may bear one\n\
         name and be two places."
    )?;
    match first {
        None => writeln!(out, "\nThe change makes no difference to what would have been done."),
        Some(number) => writeln!(
            out,
            "\nUp to decision {number} the changed rover would have driven just as the logged one. From there on its path is \
             not\nknown: later rows tell what it would have done in the logged rover's place."
        ),
    }
}

/// Both sides of one decision, goal by goal.
fn tell_terms(out: &mut dyn Write, retaken: &Retaken, radius_cells: f64) -> std::io::Result<()> {
    let Retaken { logged, decided, difference, parting, scores, .. } = retaken;
    let alike = parting.map_or("chooses alike".to_owned(), |p| format!("differs in its {p}"));
    writeln!(out, "\nDecision {} {alike}", logged.number)?;
    for (name, decision) in [("logged", logged), ("here", decided)] {
        let told = Told::of(decision);
        let order = if told.order.is_empty() { "nothing".into() } else { told.order.join(" > ") };
        writeln!(out, "  {name:<8} {}; {order} (value {:.3})", told.act, told.value)?;
    }
    match difference {
        Some(d) => writeln!(out, "  the records part at stage {}: {}", d.stage, d.path)?,
        None => writeln!(out, "  the records are equal to the last bit")?,
    }
    let mut table = Table::new();
    table.load_style(NOTHING);
    table.set_header([
        "place",
        "directive",
        "interest",
        "prize",
        "logged: turn, verdict",
        "here: turn, verdict",
    ]);
    for Terms { left, right } in side_by_side(logged, decided, radius_cells) {
        let goal = |side: &Option<Verdict>| side.as_ref().and_then(|v| v.goal.clone());
        let (a, b) = (goal(&left), goal(&right));
        let Some(any) = a.as_ref().or(b.as_ref()) else { continue };
        // What the changed map says of a place that is no goal on it is the reason why.
        let there = a.as_ref().and_then(|g| retaken.interests.get(&g.id));
        let interest = match (&a, &b) {
            (Some(a), Some(b)) => format!("{:.3} | {:.3}", a.interest, b.interest),
            (Some(a), None) => {
                let there = there.map_or_else(|| "-".to_owned(), |i| format!("({i:.3})"));
                format!("{:.3} | {there}", a.interest)
            }
            (None, Some(b)) => format!("- | {:.3}", b.interest),
            (None, None) => String::new(),
        };
        let prize = |side: &Option<Goal>| {
            side.as_ref().map_or_else(|| "-".to_owned(), |g| format!("{:.3}", g.prize))
        };
        table.add_row([
            place(any.target.as_ref()),
            any.directive_name.clone(),
            interest,
            format!("{} | {}", prize(&a), prize(&b)),
            verdict(left.as_ref()),
            verdict(right.as_ref()),
        ]);
    }
    writeln!(out, "{table}")?;
    writeln!(
        out,
        "  logged | here; in brackets the interest here of a place that is no goal here"
    )?;
    if let Some(score) = scores.logged {
        let (own, less) = (scores.decided, scores.decided - score);
        writeln!(
            out,
            "  on this change's map the logged order is worth {score:.3} (expected interest), its own {own:.3}: {less:+.3}"
        )?;
    }
    Ok(())
}

/// Turn, name, action, reason and the numbers behind them.
fn verdict(verdict: Option<&Verdict>) -> String {
    let Some(verdict) = verdict else { return "no such goal".to_owned() };
    let goal = verdict.goal.as_ref().map_or(0, |g| g.id);
    let turn = verdict.turn.map_or_else(|| "-".to_owned(), |turn| (turn + 1).to_string());
    let terms = crate::replay::terms(&verdict.terms);
    format!("{turn}  G{goal} {}: {}; {terms}", verdict.action, verdict.reason)
}

fn terms_json(retaken: &Retaken, radius_cells: f64) -> Value {
    let terms = side_by_side(&retaken.logged, &retaken.decided, radius_cells);
    json!({
        "decision": retaken.logged.number,
        "differs_in": retaken.parting.map(wisdom_logbook::Parting::name),
        "difference": retaken.difference.as_ref().map(|d| json!({
            "stage": d.stage, "field": d.path, "logged": d.left, "decided": d.right, "ulps": d.ulps,
        })),
        "goals": terms.iter().map(|t| json!({ "logged": t.left, "decided": t.right,
            "interest_here": t.left.as_ref().and_then(|v| v.goal.as_ref()).and_then(|g| retaken.interests.get(&g.id)),
        })).collect::<Vec<_>>(),
    })
}
