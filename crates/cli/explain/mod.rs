//! `wisdom explain`: why a decision left goals out and what would have brought them in; the life of a goal.

mod goal;

use std::io::{IsTerminal, Write};
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;
use serde_json::{Value, json};
use wisdom_autonomy::{Applied, Confirmation, Deliberation, GoalPrice, Spec};
use wisdom_goals::{GoalId, GoalSequence, Known, Lever, Price, Reason, Term};
use wisdom_logbook::record::Decision;
use wisdom_logbook::{LogReader, Past};

use crate::exit::InputError;
use crate::replay::trigger;
use crate::run::clock;

/// Tell why a logged decision left goals out, and what would have brought them in; or the life of one goal.
///
/// Every goal that was deferred or dropped carries a price tag: the least change of the energy or time left, of the floor on
/// reliability, or of the goal's own interest that would have brought it into the sequence, all else being as it was. The
/// decision is taken again to find it, and once more at the price and at 1 % less.
#[derive(clap::Args, Debug)]
pub(crate) struct ExplainArgs {
    /// The log (NAME.mcap or NAME.mcap.part).
    log: PathBuf,
    /// The decision; the last one by default.
    #[arg(long, value_name = "N")]
    decision: Option<u32>,
    /// The life of a goal (G7 or 7) instead: what it was born of, with each expert's credit, every weighing, its end.
    #[arg(long, value_name = "GOAL", value_parser = goal_id, conflicts_with_all = ["decision", "why_not"])]
    goal: Option<GoalId>,
    /// Only this goal (G7 or 7), with its poses, the best order that holds it and what that displaces.
    #[arg(long, value_name = "GOAL", value_parser = goal_id)]
    why_not: Option<GoalId>,
    /// Print one JSON object instead of text.
    #[arg(long)]
    json: bool,
}

fn goal_id(text: &str) -> Result<GoalId, String> {
    let digits = text.strip_prefix(['G', 'g']).unwrap_or(text);
    digits.parse().map(GoalId).map_err(|_| "a goal is written G7 or 7".to_owned())
}

/// A goal that was left out, its price tag, and what became of that when it was applied.
struct Told {
    price: GoalPrice,
    confirmation: Confirmation,
}

/// What is needed to get one goal in, spelled out.
struct Way {
    /// What is loosened for it, if anything must be.
    lever: Option<(Lever, f64)>,
    sequence: GoalSequence,
    displaced: Vec<GoalId>,
}

pub(crate) fn run(args: &ExplainArgs) -> anyhow::Result<ExitCode> {
    let log = LogReader::open(&args.log)?;
    if let Some(goal) = args.goal {
        return goal::run(args, &log, goal);
    }
    let count = log.decisions().count();
    let refuse = |what: String| InputError(format!("{}: {what}", args.log.display()));
    let number = match args.decision {
        Some(number) => number,
        None => log
            .decisions()
            .last()
            .map(|d| d.number)
            .ok_or_else(|| refuse("the log holds no decision".to_owned()))?,
    };
    let record = log.decisions().find(|d| d.number == number).ok_or_else(|| {
        refuse(format!("no decision {number}; the log holds {count}, counted from 0"))
    })?;
    let shown = !args.json && std::io::stderr().is_terminal();
    let bar = if shown { ProgressBar::new_spinner() } else { ProgressBar::hidden() };
    bar.set_style(ProgressStyle::with_template("{spinner} {msg}  {elapsed}")?);
    bar.enable_steady_tick(Duration::from_millis(200));
    bar.set_message(format!("deriving the decisions up to {number}"));
    let past = wisdom_logbook::derive_at(&log, number)?
        .ok_or_else(|| refuse(format!("no decision {number}")))?;
    if let Some(goal) = args.why_not {
        check_goal(&past, goal).map_err(|what| refuse(format!("decision {number}: {what}")))?;
    }
    bar.set_message(format!("taking decision {number} again under other limits and prizes"));
    let prices = match args.why_not {
        Some(goal) => past.rover.price_tag(goal).into_iter().collect(),
        None => past.rover.price_tags(),
    };
    bar.set_message("applying the prices".to_owned());
    let confirmations = past.rover.confirmed(&prices);
    let told = told(prices, confirmations);
    let decided = past.rover.deliberation().expect("a core that has decided has deliberated");
    let spec = past.rover.spec();
    bar.finish_and_clear();
    let mut out = std::io::BufWriter::new(std::io::stdout().lock());
    if args.json {
        let goals: Vec<Value> = told.par_iter().map(|t| as_json(t, decided, spec)).collect();
        let object = json!({
            "log": args.log.display().to_string(),
            "decision": number,
            "triggers": record.triggers,
            "limits": limits_of(decided),
            "chosen": names(past.decision.plan().sequence.goals()),
            "left_out": goals,
        });
        writeln!(out, "{object}")?;
    } else {
        headline(&mut out, record, &past, decided)?;
        for t in &told {
            tell(&mut out, t, decided, spec)?;
            if args.why_not.is_some() {
                tell_in_full(&mut out, t, decided, spec)?;
            }
        }
        summary(&mut out, &told)?;
    }
    out.flush()?;
    Ok(crate::exit::of_log(&log))
}

/// The price tags of all goals that a decision left out, each taken again, and the limits it was taken under, as `--json`
/// prints them.
pub(crate) fn left_out(past: &Past) -> Value {
    let prices = past.rover.price_tags();
    let confirmations = past.rover.confirmed(&prices);
    let spec = past.rover.spec();
    let decided = past.rover.deliberation().expect("a core that has decided has deliberated");
    let told = told(prices, confirmations);
    let goals: Vec<Value> = told.par_iter().map(|told| as_json(told, decided, spec)).collect();
    json!({ "limits": limits_of(decided), "left_out": goals })
}

fn limits_of(decided: &Deliberation) -> Value {
    let limits = decided.limits;
    json!({
        "energy_j": limits.energy_j, "time_s": limits.time_s, "data_mb": limits.data_mb,
        "min_reliability": limits.min_reliability,
    })
}

fn told(prices: Vec<GoalPrice>, confirmations: Vec<Confirmation>) -> Vec<Told> {
    let both = prices.into_iter().zip(confirmations);
    both.map(|(price, confirmation)| Told { price, confirmation }).collect()
}

/// A goal that has something to be explained.
fn check_goal(past: &Past, goal: GoalId) -> Result<(), String> {
    use wisdom_goals::Action::{Achieve, Defer, Drop};
    let verdicts = &past.decision.verdicts;
    let left_out = || verdicts.iter().filter(|v| matches!(v.action, Defer | Drop));
    let others = names(left_out().map(|v| v.goal.id)).join(" ");
    let others = if others.is_empty() { "none".to_owned() } else { others };
    match verdicts.iter().find(|v| v.goal.id == goal) {
        None => Err(format!("nothing is said of {goal}; left out were: {others}")),
        Some(v) if v.action == Achieve => {
            Err(format!("{goal} was achieved; left out were: {others}"))
        }
        Some(v) if !matches!(v.action, Defer | Drop) => {
            Err(format!("{goal} is in the sequence that was chosen; left out were: {others}"))
        }
        Some(_) => Ok(()),
    }
}

fn names(goals: impl Iterator<Item = GoalId>) -> Vec<String> {
    goals.map(|g| g.to_string()).collect()
}

fn headline(
    out: &mut dyn Write,
    record: &Decision,
    past: &Past,
    decided: &Deliberation,
) -> std::io::Result<()> {
    let state = &past.decision.state;
    let triggers: Vec<String> = record.triggers.iter().map(trigger).collect();
    let limits = &decided.limits;
    let sequence = &past.decision.plan().sequence;
    let order = names(sequence.goals()).join(" > ");
    writeln!(
        out,
        "Decision {} at {}, rover at {}",
        record.number,
        clock(state.spent.time_s),
        state.pose.cell
    )?;
    writeln!(out, "  because    {}", triggers.join("; "))?;
    writeln!(
        out,
        "  had left   {} and {:.1} MB; no plan under reliability {:.3}",
        [time(limits.time_s), energy(limits.energy_j)].join(", "),
        limits.data_mb,
        limits.min_reliability
    )?;
    writeln!(
        out,
        "  chose      {} (value {:.3}, reliability {:.4}, {}, {}){}",
        if order.is_empty() { "nothing" } else { &order },
        sequence.value,
        sequence.reliability,
        time(sequence.time_s),
        energy(sequence.energy_j),
        if past.decision.held {
            ", held although another was better, but not by enough"
        } else {
            ""
        }
    )
}

fn time(time_s: f64) -> String {
    if time_s.is_infinite() { "any time".to_owned() } else { clock(time_s) }
}

fn energy(energy_j: f64) -> String {
    if energy_j.is_infinite() {
        "any energy".to_owned()
    } else {
        format!("{:.3} MJ", energy_j / 1e6)
    }
}

fn numbers(terms: &[Term]) -> String {
    let told = terms.iter().map(|t| {
        let value =
            if t.value.is_finite() { format!("{:.3}", t.value) } else { "unbounded".into() };
        match t.limit {
            // By how much it misses, which is what somebody would have to find.
            Some(limit) if t.value.is_finite() => {
                format!("{} {value} against {limit:.3} ({:+.3})", t.name, t.value - limit)
            }
            Some(limit) => format!("{} {value} against {limit:.3}", t.name),
            None => format!("{} {value}", t.name),
        }
    });
    told.collect::<Vec<_>>().join(", ")
}

fn tell(
    out: &mut dyn Write,
    told: &Told,
    decided: &Deliberation,
    spec: &Spec,
) -> std::io::Result<()> {
    let GoalPrice { verdict, tag, interest } = &told.price;
    let goal = &verdict.goal;
    let other = verdict.other.map_or_else(String::new, |g| format!(" {g}"));
    writeln!(
        out,
        "\n  {:<8}   {} {} at {}: {}{other}; {}",
        verdict.action.to_string(),
        goal.id,
        spec.directives[goal.directive].name,
        goal.target,
        verdict.reason,
        numbers(&verdict.terms)
    )?;
    let Confirmation { energy_j, time_s, reliability, prize } = told.confirmation;
    let limits = &decided.limits;
    // Levers of which the same is to be said share a line.
    let mut lines: Vec<(String, String)> = Vec::new();
    let mut line = |name: &str, price: &Price, applied, in_words: &dyn Fn(f64) -> String| {
        let text = in_text(price, applied, in_words);
        match lines.last_mut() {
            Some((names, before)) if *before == text => *names = format!("{names}, {name}"),
            _ => lines.push((name.to_owned(), text)),
        }
    };
    line("energy", &tag.energy_j, energy_j, &|x| {
        format!(
            "{:.1} kJ more ({} instead of {})",
            x / 1e3,
            energy(limits.energy_j + x),
            energy(limits.energy_j)
        )
    });
    line("time", &tag.time_s, time_s, &|x| {
        format!("{x:.0} s more ({} instead of {})", time(limits.time_s + x), time(limits.time_s))
    });
    line("floor", &tag.reliability, reliability, &|x| {
        let floor = limits.min_reliability.max(spec.policy.objective().floor(&spec.preferences));
        format!("{x:.4} lower ({:.4} instead of {floor:.4})", floor - x)
    });
    line("interest", &tag.prize, prize, &|x| {
        let prize = format!("prize {x:.4} higher");
        match interest {
            Some(interest) if *interest <= 1.0 => {
                format!("{interest:.4} instead of {:.4} ({prize})", goal.interest)
            }
            Some(_) => format!("{prize}: more than an interest of 1 is worth here"),
            None => prize,
        }
    });
    for (names, text) in lines {
        writeln!(out, "    {names:<11}{}{text}", if names.len() < 11 { "" } else { "  " })?;
    }
    Ok(())
}

fn in_text(price: &Price, applied: Option<Applied>, in_words: &dyn Fn(f64) -> String) -> String {
    match price {
        Price::Least { change, known } => {
            let known = match known {
                Known::Exactly => "",
                Known::Searched => ", the least of those tried",
            };
            let applied = match applied {
                Some(applied) if applied.confirms() => "; applied: it is in, and out at 1 % less",
                Some(_) => "; applied: NOT CONFIRMED",
                None => "",
            };
            format!("{}{known}{applied}", in_words(*change))
        }
        Price::Nothing { reason, terms, known } => {
            let tried = match known {
                Known::Exactly => "none does it",
                Known::Searched => "none that was tried does it",
            };
            let terms = numbers(terms);
            let terms = if terms.is_empty() { terms } else { format!("; {terms}") };
            format!("{tried}: {}{terms}", barrier(*reason))
        }
        Price::Unknown => "unknown: the search for it ended first".to_owned(),
    }
}

/// What is in the way, as a sentence goes on.
fn barrier(reason: Reason) -> String {
    let told = match reason {
        Reason::Time => "it needs more time too",
        Reason::Energy => "it needs more energy too",
        Reason::Data => "it needs more data volume",
        Reason::Risk => "it needs a lower floor too",
        Reason::Preconditions => "facts, order or the leg under way rule it out",
        Reason::BeyondExact => "it was not among the goals sequenced",
        Reason::Unreachable => "no pose of it can be reached",
        Reason::Outweighed => "other goals are worth more",
        Reason::Held => "it would be better, but not by enough",
        Reason::Excluded => "a goal beside it stands for its place",
        Reason::SearchCut => "no sequence with it was met",
        other => return format!("it was given up, {other}"),
    };
    told.to_owned()
}

/// Poses, the best order with the goal, and what it displaces.
fn tell_in_full(
    out: &mut dyn Write,
    told: &Told,
    decided: &Deliberation,
    spec: &Spec,
) -> std::io::Result<()> {
    let goal = &told.price.verdict.goal;
    let poses = decided.poses.get(&goal.id).map_or(&[][..], Vec::as_slice);
    writeln!(
        out,
        "    evidence   interest {:.4}, prize {:.4}, prominence {:.3}, ignorance {:.3}, paradox {:.3}, attempts {}",
        goal.interest, goal.prize, goal.prominence, goal.ignorance, goal.paradox, goal.attempts
    )?;
    for (cell, way) in poses {
        writeln!(
            out,
            "    pose       {cell}: {:.0} m, {}, {}, reliability {:.4} from where the rover stood",
            way.length_m,
            time(way.time_s),
            energy(way.energy_j),
            way.reliability()
        )?;
    }
    let Some(Way { lever, sequence, displaced }) = best_way(decided, spec, told) else {
        return writeln!(out, "    with it    no order was met that holds it");
    };
    let under = match lever {
        None => "",
        Some((Lever::Energy, _)) => ", with the energy it asks for",
        Some((Lever::Time, _)) => ", with the time it asks for",
        Some((Lever::Reliability, _)) => ", with the floor it asks for",
    };
    writeln!(
        out,
        "    with it    {} (value {:.3}, reliability {:.4}, {}, {}){under}",
        names(sequence.goals()).join(" > "),
        sequence.value,
        sequence.reliability,
        time(sequence.time_s),
        energy(sequence.energy_j)
    )?;
    let displaced = names(displaced.into_iter());
    let none = "nothing that was chosen".to_owned();
    writeln!(
        out,
        "    displaces  {}",
        if displaced.is_empty() { none } else { displaced.join(", ") }
    )
}

/// The best order that holds the goal: within the limits if there is one, else with the first limit that has a price loosened
/// by it.
fn best_way(decided: &Deliberation, spec: &Spec, told: &Told) -> Option<Way> {
    let choice = decided.choice(spec);
    let tag = &told.price.tag;
    let loosened = [
        (Lever::Energy, &tag.energy_j),
        (Lever::Time, &tag.time_s),
        (Lever::Reliability, &tag.reliability),
    ];
    let priced = loosened.iter().filter_map(|(lever, price)| Some((*lever, price.change()?)));
    let (lever, sequence) = std::iter::once(None).chain(priced.map(Some)).find_map(|lever| {
        let choice = lever.map_or(choice, |(lever, change)| choice.loosened(lever, change));
        Some((lever, choice.best_with(tag.goal)?))
    })?;
    let chosen = decided.selection.sequence().goals();
    let displaced = chosen.filter(|id| sequence.goals().all(|other| other != *id)).collect();
    Some(Way { lever, sequence, displaced })
}

fn summary(out: &mut dyn Write, told: &[Told]) -> std::io::Result<()> {
    let applied: Vec<Applied> = told
        .iter()
        .flat_map(|t| {
            let c = &t.confirmation;
            [c.energy_j, c.time_s, c.reliability, c.prize]
        })
        .flatten()
        .collect();
    let confirmed = applied.iter().filter(|a| a.confirms()).count();
    let plural = |count: usize, what: &str| match count {
        1 => format!("1 {what}"),
        count => format!("{count} {what}s"),
    };
    let (goals, prices) = (plural(told.len(), "goal"), plural(applied.len(), "price"));
    writeln!(out, "\n{goals} left out; {prices}, {confirmed} confirmed by applying")
}

fn as_json(told: &Told, decided: &Deliberation, spec: &Spec) -> Value {
    let GoalPrice { verdict, tag, interest } = &told.price;
    let goal = &verdict.goal;
    let Confirmation { energy_j, time_s, reliability, prize } = told.confirmation;
    let terms = |terms: &[Term]| -> Vec<Value> {
        let one = |t: &Term| json!({ "name": t.name, "value": t.value, "limit": t.limit });
        terms.iter().map(one).collect()
    };
    let price = |price: &Price, applied: Option<Applied>| match price {
        Price::Least { change, known } => json!({
            "least": change,
            "exact": *known == Known::Exactly,
            "confirmed": applied.map(Applied::confirms),
        }),
        Price::Nothing { reason, terms: numbers, known } => json!({
            "nothing": reason.to_string(),
            "terms": terms(numbers),
            "exact": *known == Known::Exactly,
        }),
        Price::Unknown => json!({ "unknown": true }),
    };
    json!({
        "goal": goal.id.to_string(),
        "directive": spec.directives[goal.directive].name,
        "target": { "row": goal.target.row, "col": goal.target.col },
        "interest": goal.interest,
        "prize": goal.prize,
        "action": verdict.action.to_string(),
        "reason": verdict.reason.to_string(),
        "other": verdict.other.map(|g| g.to_string()),
        "terms": terms(&verdict.terms),
        "price": {
            "energy_j": price(&tag.energy_j, energy_j),
            "time_s": price(&tag.time_s, time_s),
            "reliability": price(&tag.reliability, reliability),
            "prize": price(&tag.prize, prize),
            "interest": interest,
        },
        "with_it": best_way(decided, spec, told).map(|way| json!({
            "order": names(way.sequence.goals()),
            "displaced": names(way.displaced.into_iter()),
            "lever": way.lever.map(|(lever, _)| lever_name(lever)),
            "value": way.sequence.value,
            "reliability": way.sequence.reliability,
            "time_s": way.sequence.time_s,
            "energy_j": way.sequence.energy_j,
        })),
    })
}

/// The name of a lever.
fn lever_name(lever: Lever) -> &'static str {
    match lever {
        Lever::Energy => "energy",
        Lever::Time => "time",
        Lever::Reliability => "reliability",
    }
}
