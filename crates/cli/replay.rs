//! `wisdom replay`: a logged mission as a story.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use wisdom_logbook::record::{self, Decision, Goal, Outcome, Sequence, Trigger};
use wisdom_logbook::{Entry, LogReader};

use crate::exit::InputError;
use crate::run::clock;

/// Tell a logged mission as a story, decision by decision.
#[derive(clap::Args, Debug)]
pub(crate) struct ReplayArgs {
    /// The log (NAME.mcap or NAME.mcap.part).
    log: PathBuf,
    /// Only this decision, in full.
    #[arg(long, value_name = "N")]
    decision: Option<u32>,
    /// One JSON object a decision, one a line: the whole record.
    #[arg(long)]
    json: bool,
    /// With --decision: the causal links of the chosen sequence in the DOT language.
    #[arg(long, requires = "decision")]
    dot: bool,
}

pub(crate) fn run(args: &ReplayArgs) -> anyhow::Result<ExitCode> {
    let log = LogReader::open(&args.log)?;
    let mut out = std::io::BufWriter::new(std::io::stdout().lock());
    if let Some(wanted) = args.decision {
        let decisions = log.decisions().count();
        if !log.decisions().any(|d| d.number == wanted) {
            let message = format!(
                "{}: no decision {wanted}; the log holds {decisions}, counted from 0",
                args.log.display()
            );
            return Err(InputError(message).into());
        }
        if args.dot {
            let dot = wisdom_logbook::causal_dot(&log, wanted)?;
            writeln!(out, "{dot}")?;
            return Ok(crate::exit::of_log(&log));
        }
    }
    if args.json {
        for decision in log.decisions().filter(|d| args.decision.is_none_or(|n| n == d.number)) {
            writeln!(out, "{}", serde_json::to_string(decision)?)?;
        }
        out.flush()?;
        return Ok(crate::exit::of_log(&log));
    }
    if args.decision.is_none() {
        headline(&mut out, &log)?;
    }
    for entry in &log.entries {
        match entry {
            Entry::Observation(_) => {}
            Entry::Message(message) => {
                if args.decision.is_none() {
                    writeln!(out, "{}\n", message.text())?;
                }
            }
            Entry::Fault(fault) => {
                if args.decision.is_none() {
                    let told =
                        if fault.kind == "facts-lost" { "" } else { " (the rover is not told)" };
                    writeln!(out, "{}{told}\n", fault.text)?;
                }
            }
            Entry::Outcome(outcome) => {
                if args.decision.is_none_or(|n| n == outcome.decision) {
                    tell_outcome(&mut out, outcome)?;
                }
            }
            Entry::Decision(decision) => {
                if args.decision.is_none_or(|n| n == decision.number) {
                    tell(&mut out, decision, args.decision.is_some())?;
                }
            }
        }
    }
    if args.decision.is_none() {
        ending(&mut out, &log)?;
    }
    out.flush()?;
    Ok(crate::exit::of_log(&log))
}

fn headline(out: &mut dyn Write, log: &LogReader) -> std::io::Result<()> {
    let get = |key: &str| log.metadata.get(key).map_or("?", String::as_str);
    writeln!(
        out,
        "{}: seed {}, rule {}, policy {}, wisdom {}\n",
        get("mission"),
        get("seed"),
        get("rule"),
        get("policy"),
        get("version")
    )
}

fn ending(out: &mut dyn Write, log: &LogReader) -> std::io::Result<()> {
    match &log.end {
        Some(end) => {
            writeln!(out, "\nThe run ended: {}, after {} decisions.", end.status, end.decisions)
        }
        None => writeln!(out, "\nThe log has no end record. Log: {}.", log.status),
    }
}

pub(crate) fn place(cell: Option<&record::Cell>) -> String {
    cell.map_or_else(|| "?".to_owned(), |c| format!("({}, {})", c.row, c.col))
}

pub(crate) fn trigger(trigger: &Trigger) -> String {
    let mut parts = vec![trigger.name.clone()];
    parts.extend(trigger.goal.map(|g| format!("G{g}")));
    parts.extend(trigger.cell.as_ref().map(|c| format!("at {}", place(Some(c)))));
    if let (Some(before), Some(after)) = (trigger.before, trigger.after) {
        let what = if trigger.name == "conflict" { "contradiction" } else { "prize" };
        parts.push(format!("{what} {before:.3} -> {after:.3}"));
    }
    parts.extend(trigger.prize.map(|p| format!("prize {p:.3}")));
    parts.extend(trigger.share.map(|s| format!("{:+.0} % of the leg's energy", s * 100.0)));
    if let (Some(reliability), Some(floor)) = (trigger.reliability, trigger.floor) {
        parts.push(format!("reliability {reliability:.3} under {floor:.3}"));
    }
    parts.extend(trigger.seconds.map(|s| match trigger.name.as_str() {
        "window-closing" => format!("{s:.0} s left"),
        _ => format!("{s:.0} s after the last one"),
    }));
    parts.extend(trigger.message.map(|n| format!("by message {n}")));
    parts.join(" ")
}

/// Numbers compared, in words.
pub(crate) fn terms(terms: &[record::Term]) -> String {
    let told = terms.iter().map(|t| {
        let value = t.value.map_or_else(|| "unbounded".to_owned(), |v| format!("{v:.3}"));
        match t.limit {
            Some(limit) => format!("{} {value} against {limit:.3}", t.name),
            None => format!("{} {value}", t.name),
        }
    });
    told.collect::<Vec<_>>().join(", ")
}

fn tell(out: &mut dyn Write, d: &Decision, full: bool) -> std::io::Result<()> {
    let state = d.state.clone().unwrap_or_default();
    let spent = state.spent.unwrap_or_default();
    let triggers: Vec<String> = d.triggers.iter().map(trigger).collect();
    let pose = state.pose.unwrap_or_default();
    writeln!(
        out,
        "Decision {} at {}, {:.0} m driven, rover at {}",
        d.number,
        clock(spent.time_s),
        spent.length_m,
        place(pose.cell.as_ref())
    )?;
    writeln!(out, "  because    {}", triggers.join("; "))?;
    let frame = d.frame.clone().unwrap_or_default();
    let fusion = d.fusion.clone().unwrap_or_default();
    writeln!(
        out,
        "  knew       {:.1} % of the ground ({}), background interest {:.3}, facts: {}",
        frame.seen * 100.0,
        if frame.map_changed { "changed since the last decision" } else { "unchanged" },
        fusion.background,
        state.facts.join(", ")
    )?;
    let choice = d.choice.clone().unwrap_or_default();
    tell_goals(out, &choice, full)?;
    tell_choice(out, d, &choice, full)?;
    writeln!(out)
}

fn tell_goals(out: &mut dyn Write, choice: &record::Choice, full: bool) -> std::io::Result<()> {
    let verdicts = &choice.verdicts;
    let deferred = verdicts.iter().filter(|v| v.action == "defer").count();
    for verdict in verdicts {
        let goal = verdict.goal.clone().unwrap_or_default();
        let told = full || verdict.action != "defer";
        if told {
            let other = verdict.other.map_or_else(String::new, |g| format!(" G{g}"));
            writeln!(
                out,
                "  {:<8}   G{:<3} {} at {}: {}{other} ({}); {}",
                verdict.action,
                goal.id,
                goal.directive_name,
                place(goal.target.as_ref()),
                verdict.reason,
                verdict.cause,
                terms(&verdict.terms)
            )?;
        }
        // What the verdict itself says, and that a goal is new, need not be said twice.
        let news = |c: &&record::Change| {
            full || (c.transformation != "formulation"
                && c.reason != "peak-moved"
                && c.reason != verdict.reason)
        };
        for change in verdict.changes.iter().filter(news) {
            let from = change.other.map_or_else(String::new, |g| format!(" G{g}"));
            let record::Change { transformation, reason, .. } = change;
            let numbers = terms(&change.terms);
            writeln!(
                out,
                "    change   G{:<3} {transformation}: {reason}{from}; now {} at {}; {numbers}",
                goal.id,
                goal.directive_name,
                place(goal.target.as_ref()),
            )?;
        }
        if full {
            tell_life(out, goal.id, &choice.transitions)?;
            tell_evidence(out, &goal)?;
        }
    }
    if !full && deferred > 0 {
        let mut reasons: std::collections::BTreeMap<&str, u32> = std::collections::BTreeMap::new();
        for verdict in verdicts.iter().filter(|v| v.action == "defer") {
            *reasons.entry(&verdict.reason).or_default() += 1;
        }
        let told: Vec<String> = reasons.iter().map(|(reason, n)| format!("{n} {reason}")).collect();
        writeln!(out, "  defer      {deferred} goals: {}", told.join(", "))?;
    }
    Ok(())
}

/// The steps in a goal's life that a decision took.
fn tell_life(
    out: &mut dyn Write,
    goal: u32,
    transitions: &[record::Transition],
) -> std::io::Result<()> {
    let mut steps = transitions.iter().filter(|step| step.goal == goal).peekable();
    let Some(first) = steps.peek() else { return Ok(()) };
    let mut life = first.from.clone();
    for step in steps {
        let outcome = step.outcome.as_ref().map_or_else(String::new, |o| format!(" ({o})"));
        life = format!("{life} > {}{outcome}", step.to);
    }
    writeln!(out, "                  life: {life}")
}

fn tell_evidence(out: &mut dyn Write, goal: &Goal) -> std::io::Result<()> {
    let credit: Vec<String> = goal.credit.iter().map(|c| format!("{:.1} %", c * 100.0)).collect();
    writeln!(
        out,
        "                  interest {:.4}, prize {:.4}, prominence {:.3}, ignorance {:.3}, paradox {:.3}, \
         credit {}, attempts {}",
        goal.interest,
        goal.prize,
        goal.prominence,
        goal.ignorance,
        goal.paradox,
        credit.join(" / "),
        goal.attempts
    )
}

fn order(sequence: &Sequence) -> String {
    if sequence.stops.is_empty() {
        return "nothing".into();
    }
    let goals: Vec<String> = sequence.stops.iter().map(|s| format!("G{}", s.goal)).collect();
    goals.join(" > ")
}

fn tell_choice(
    out: &mut dyn Write,
    d: &Decision,
    choice: &record::Choice,
    full: bool,
) -> std::io::Result<()> {
    let objective = d.objective.clone().unwrap_or_default();
    let candidates = d.candidates.clone().unwrap_or_default();
    let (kept, left_out) = (candidates.shortlist.len(), candidates.left_out.len());
    let best = objective.family.first().and_then(|o| o.sequence.as_ref()).map_or(0.0, |s| s.value);
    let proof = match objective.bound {
        _ if objective.proof == "proven" => "proven".to_owned(),
        Some(bound) if bound > 0.0 && best > 0.0 => {
            let gap = (bound - best) / bound * 100.0;
            format!("gap {gap:.1} % (none above {bound:.3})")
        }
        Some(bound) => format!("none above {bound:.3}"),
        None => "heuristic".to_owned(),
    };
    // Nothing is said of goals that the search was not given.
    let proof = if left_out > 0 {
        format!("{proof} among {kept} of {} goals", kept + left_out)
    } else {
        proof
    };
    // Logs of decision versions before 3 know no fronts: there every member is the best of its set.
    let is_way = |(i, option): &(usize, &record::PlanOption)| {
        option.front_plans > 0 && option.front_best as usize != *i
    };
    let sets = objective.family.iter().enumerate().filter(|member| !is_way(member)).count();
    for (i, option) in objective.family.iter().enumerate() {
        let chosen = i == choice.chosen as usize;
        let way = is_way(&(i, option));
        let of_chosen = option.front_best == choice.chosen;
        if !chosen && (!full || way && !of_chosen) {
            continue;
        }
        let s = option.sequence.clone().unwrap_or_default();
        if way && !chosen {
            let length_m = option.total.as_ref().map_or(0.0, |cost| cost.length_m);
            writeln!(
                out,
                "  or, the same order over other poses and routes (value {:.3}, reliability {:.4}, {}, {:.2} MJ, \
                 {length_m:.0} m)",
                s.value,
                s.reliability,
                clock(s.time_s),
                s.energy_j / 1e6
            )?;
            continue;
        }
        writeln!(
            out,
            "  {}     {} (value {:.3}, prize {:.3}, reliability {:.4}, {}, {:.2} MJ){}",
            if chosen { "chose " } else { "or    " },
            order(&s),
            s.value,
            s.prize,
            s.reliability,
            clock(s.time_s),
            s.energy_j / 1e6,
            if chosen {
                let ways = match (option.front_plans, option.front_complete) {
                    (0 | 1, _) => String::new(),
                    (n, true) => format!("; its order has a front of {n} plans"),
                    (n, false) => format!("; its order has a front of {n} plans at least"),
                };
                format!(", out of {sets} {}, {proof}{ways}", if sets == 1 { "set" } else { "sets" })
            } else {
                String::new()
            }
        )?;
        if full && chosen {
            if let Some(all) = &option.objectives {
                writeln!(
                    out,
                    "             all objectives: expected-interest {:.4}, most-interesting {:.4}, \
                     all-or-nothing {:.4}, chance-constrained {:.4}, net-benefit {}, utility {}",
                    all.expected_interest,
                    all.most_interesting,
                    all.all_or_nothing,
                    all.chance_constrained,
                    all.net_benefit.map_or_else(|| "unbounded".into(), |n| format!("{n:.4}")),
                    all.utility.map_or_else(|| "unknown".into(), |u| format!("{u:.4}"))
                )?;
            }
            for stop in &s.stops {
                let operators: Vec<&str> = stop
                    .before
                    .iter()
                    .map(String::as_str)
                    .chain(["drive"])
                    .chain(stop.after.iter().map(String::as_str))
                    .collect();
                writeln!(out, "             G{}: {}", stop.goal, operators.join(", "))?;
            }
        }
    }
    if objective.held {
        writeln!(
            out,
            "  held       the committed sequence stays: another is better, but not by enough"
        )?;
    }
    let act = choice.act.clone().unwrap_or_default();
    let cost = act.cost.unwrap_or_default();
    let what = match act.name.as_str() {
        "pursue" => format!("pursue G{}", act.goal.unwrap_or_default()),
        "wait" => format!("wait for {}", act.wake.unwrap_or_default()),
        other => {
            let end = act.route.as_ref().and_then(|r| r.cells.last());
            format!("{other}, driving to {}", place(end))
        }
    };
    let reliability = cost.neg_ln_r.map_or(0.0, |n| (-n).exp());
    writeln!(
        out,
        "  act        {what}: {:.0} m, {}, reliability {reliability:.4}",
        cost.length_m,
        clock(cost.time_s)
    )
}

fn tell_outcome(out: &mut dyn Write, outcome: &Outcome) -> std::io::Result<()> {
    let goal = outcome.goal.map_or_else(String::new, |g| format!(" G{g}"));
    let spent = outcome.spent.unwrap_or_default();
    writeln!(
        out,
        "  -> {}{goal} at {}: {} cells driven; {}\n",
        outcome.result,
        clock(spent.time_s),
        outcome.track.len().saturating_sub(1),
        if outcome.operators.is_empty() {
            "no operator".to_owned()
        } else {
            outcome.operators.join(", ")
        }
    )
}
