//! Tables for people, objects for programs.

use std::io::Write;

use comfy_table::presets::NOTHING;
use comfy_table::{CellAlignment, Table};
use serde_json::{Value, json};
use wisdom_mission::Mission;

use crate::Report;
use crate::study::auc::Ends;
use crate::study::fate::{Done, Fate, Standing};
use crate::study::lie::{Line, NEARER, SLOPE, Share};
use crate::study::sweep::{Answer, CONDITIONS, RANGE, Stretch, Sweep, Threshold, Way};

/// What stands above every output of the sweep.
const STAND_IN: &str = "The values are STAND-INS: what was measured at Elk is in no file here. Real means nearby, for \
                        scale: Hewolf 58.4, Buckskin 64.1, Sorrel Springs 72.8 % SiO2.";

fn table(header: &[String]) -> Table {
    let mut table = Table::new();
    table.load_style(NOTHING);
    table.set_header(header);
    table
}

fn right(table: &mut Table, from: usize) {
    for column in table.column_iter_mut().skip(from) {
        column.set_cell_alignment(CellAlignment::Right);
    }
}

/// A run in a word: the goal's turn in the plan with the reading, and whether it was carried out.
fn word(fate: &Fate) -> String {
    if fate.done_before.is_some() && fate.turn().is_none() && fate.done_after.is_none() {
        return "done".to_owned();
    }
    let turn = fate.turn().map_or_else(|| "-".to_owned(), |turn| (turn + 1).to_string());
    let back = if fate.turns_back() { "<" } else { "" };
    let done = if fate.done_after.is_some() { "*" } else { "" };
    format!("{back}{turn}{done}")
}

/// One way in a line, as it is found.
pub(crate) fn line(answer: &Answer) -> String {
    let Way { condition, rule, prize, policy } = answer.way;
    let words: Vec<String> = answer.at.iter().map(|(_, fate)| word(fate)).collect();
    let (without, from) = (word(&answer.control), threshold(answer.threshold));
    format!(
        "{} {rule} {prize} {policy}: without {without}; {}; planned from {from}",
        condition.name,
        words.join(" ")
    )
}

fn threshold(found: Threshold) -> String {
    match found {
        Threshold::Never => "never".to_owned(),
        Threshold::Always => "any, and without".to_owned(),
        Threshold::Any => "any".to_owned(),
        Threshold::Edge(edge) => edge.to_string(),
        Threshold::Between(low, high) => format!("{low:.2} to {high:.2}"),
        Threshold::NotMonotone => "not monotone".to_owned(),
    }
}

fn bands(sweep: &Sweep<'_>) -> Vec<String> {
    let mut ends = vec![RANGE.0];
    ends.extend(&sweep.edges);
    ends.push(RANGE.1);
    ends.windows(2).map(|pair| format!("{} to {}", pair[0], pair[1])).collect()
}

pub(crate) fn sweep(
    out: &mut dyn Write,
    sweep: &Sweep<'_>,
    mission: &Mission,
    stretches: &[(Way, Vec<Stretch>)],
    answers: &[Answer],
) -> std::io::Result<()> {
    let spot = sweep.spot;
    writeln!(
        out,
        "{}: a reading at row {}, col {}, known from {:.0} s on; goals within {:.0} m count as there",
        mission.name,
        spot.cell.row,
        spot.cell.col,
        spot.at_s,
        spot.radius * mission.spec.grid.spacing_m()
    )?;
    writeln!(out, "{STAND_IN}")?;
    let edges: Vec<String> = sweep.edges.iter().map(ToString::to_string).collect();
    writeln!(
        out,
        "The expert's table is a step function with edges at {} %: nothing can change between them.\n",
        edges.join(", ")
    )?;
    for condition in CONDITIONS {
        writeln!(out, "{}: {}", condition.name, condition.about)?;
        let mut header: Vec<String> =
            ["rule", "prize", "policy", "before", "without"].map(str::to_owned).into();
        header.extend(bands(sweep));
        header.push("planned from".to_owned());
        let mut rows = table(&header);
        right(&mut rows, 3);
        for answer in answers.iter().filter(|answer| answer.way.condition == condition) {
            let Way { rule, prize, policy, .. } = answer.way;
            let before =
                answer.control.turn_before().map_or("-".to_owned(), |t| (t + 1).to_string());
            let mut row = vec![
                rule.to_string(),
                prize.to_string(),
                policy.to_string(),
                before,
                word(&answer.control),
            ];
            row.extend(answer.at.iter().map(|(_, fate)| word(fate)));
            row.push(threshold(answer.threshold));
            rows.add_row(row);
        }
        writeln!(out, "{}\n", rows.trim_fmt())?;
    }
    writeln!(
        out,
        "before: turn of a goal there in the last plan without the reading. Others: its turn in the first plan with it \
         (without: at the same time, no reading), - none, < the rover turns to it at once and was on its way \
         elsewhere, * carried out within two hours, done: carried out before that plan, and none there in it.\n"
    )?;
    writeln!(
        out,
        "By steps, the mission's own way: values with the same decision, to the last bit"
    )?;
    for (way, stretches) in stretches {
        for (low, high, fate) in stretches {
            writeln!(out, "  {}  {low} to {high} %: {}", way.condition.name, fate.why)?;
        }
    }
    writeln!(out, "\nWhy, at the first decision with the reading")?;
    for answer in answers {
        let Way { condition, rule, prize, policy } = answer.way;
        writeln!(out, "  {} {rule} {prize} {policy}", condition.name)?;
        writeln!(out, "    without   {}", answer.control.why)?;
        for (band, (_, fate)) in bands(sweep).iter().zip(&answer.at) {
            writeln!(out, "    {band:<9} {}", fate.why)?;
        }
    }
    Ok(())
}

fn standing(standing: Option<&Standing>) -> Value {
    let Some(standing) = standing else { return Value::Null };
    let goal = &standing.goal;
    let terms = standing.terms.iter();
    json!({
        "goal": goal.id.to_string(),
        "directive": standing.directive,
        "target": [goal.target.row, goal.target.col],
        "turn": standing.turn,
        "action": standing.action.to_string(),
        "reason": standing.reason.to_string(),
        "interest": goal.interest,
        "prize": goal.prize,
        "prominence": goal.prominence,
        "credit": goal.credit,
        "terms": terms.map(|t| json!([t.name, t.value, t.limit])).collect::<Vec<_>>(),
    })
}

fn done(done: Option<&Done>) -> Value {
    let Some(Done { achievement, distance }) = done else { return Value::Null };
    json!({
        "goal": achievement.goal.to_string(),
        "directive": achievement.directive,
        "target": [achievement.target.row, achievement.target.col],
        "distance_cells": distance,
        "time_s": achievement.time_s,
    })
}

fn fate(fate: &Fate) -> Value {
    json!({
        "before": standing(fate.before.as_ref()),
        "decision": fate.decision.map(|(number, time_s, at)| json!({
            "number": number, "time_s": time_s, "rover": [at.row, at.col],
        })),
        "after": standing(fate.after.as_ref()),
        "turns_back": fate.turns_back(),
        "why": fate.why,
        "done_before": done(fate.done_before.as_ref()),
        "done_after": done(fate.done_after.as_ref()),
    })
}

fn way(way: &Way) -> Value {
    json!({
        "condition": way.condition.name,
        "rule": way.rule.to_string(),
        "prize": way.prize.to_string(),
        "policy": way.policy.to_string(),
    })
}

pub(crate) fn sweep_json(
    sweep: &Sweep<'_>,
    mission: &Mission,
    stretches: &[(Way, Vec<Stretch>)],
    answers: &[Answer],
) -> Value {
    let answer = |answer: &Answer| {
        let at: Vec<Value> = answer
            .at
            .iter()
            .map(|(value, found)| json!({ "value": value, "fate": fate(found) }))
            .collect();
        json!({
            "way": way(&answer.way),
            "without": fate(&answer.control),
            "at": at,
            "planned_from": threshold(answer.threshold),
        })
    };
    let stretch = |(of, stretches): &(Way, Vec<Stretch>)| {
        let each: Vec<Value> = stretches
            .iter()
            .map(|(low, high, found)| json!({ "from": low, "to": high, "fate": fate(found) }))
            .collect();
        json!({ "way": way(of), "stretches": each })
    };
    let spot = sweep.spot;
    json!({
        "mission": mission.name,
        "stand_in": STAND_IN,
        "reading": {
            "cell": [spot.cell.row, spot.cell.col], "at_s": spot.at_s, "radius_cells": spot.radius,
        },
        "edges": sweep.edges,
        "answers": answers.iter().map(answer).collect::<Vec<_>>(),
        "steps": stretches.iter().map(stretch).collect::<Vec<_>>(),
    })
}

/// By how much a map's AUC is above that of slope.
fn above(line: &Line, slope: Option<&Line>) -> String {
    match slope.filter(|slope| slope.name != line.name).map(|slope| line.above(slope)) {
        Some((by, Some(Ends { low, high }))) => format!("{by:+.3} ({low:+.3} to {high:+.3})"),
        _ => "-".to_owned(),
    }
}

fn ends(ends: Ends) -> String {
    format!("{:.3} to {:.3}", ends.low, ends.high)
}

pub(crate) fn report(out: &mut dyn Write, report: &Report) -> std::io::Result<()> {
    let Report { terms, targets, target_cells, ground, lines, shares } = report;
    writeln!(
        out,
        "{targets} targets on {target_cells} cells against {ground} cells of ground within {:.0} cells of a stop; \
         {} resamples, seed {}\n",
        terms.near, terms.resamples, terms.seed
    )?;
    let mut header: Vec<String> =
        ["map", "AUC", "stops drawn", "sols drawn", "cells drawn", "above slope", "cells once"]
            .map(str::to_owned)
            .into();
    header.extend(NEARER.map(|near| format!("within {near:.0}")));
    let mut rows = table(&header);
    right(&mut rows, 1);
    let slope = lines.iter().find(|line| line.name == SLOPE);
    for line in lines {
        let mut row = vec![
            line.name.clone(),
            format!("{:.3}", line.auc),
            ends(line.by_stop),
            ends(line.by_sol),
            ends(line.by_cell),
            above(line, slope),
            format!("{:.3}", line.by_distinct_cell),
        ];
        row.extend(line.nearer.iter().map(|auc| format!("{auc:.3}")));
        rows.add_row(row);
    }
    writeln!(out, "{}\n", rows.trim_fmt())?;
    writeln!(
        out,
        "AUC: the chance that a target scores above ground near the stops, with three 95 % intervals: whole stops drawn \
         anew; sols for the targets and stops for the ground; every target and cell as if all were independent, which \
         they are not. above slope: by how much, whole stops drawn. cells once: cells with several targets counted \
         once. within: against ground so near to a stop only, cells.\n"
    )?;
    let header =
        ["places", "count", "within 5 m of a target", "share", "95 %", "drawn"].map(str::to_owned);
    let mut rows = table(&header);
    right(&mut rows, 1);
    for share in shares {
        let of = share.met as f64 / share.count.max(1) as f64;
        rows.add_row([
            share.name.clone(),
            share.count.to_string(),
            share.met.to_string(),
            if share.count > 0 { format!("{:.1} %", 100.0 * of) } else { "-".to_owned() },
            share.ends.map_or_else(
                || "-".to_owned(),
                |ends| format!("{:.1} to {:.1} %", 100.0 * ends.low, 100.0 * ends.high),
            ),
            share.drawn.to_owned(),
        ]);
    }
    writeln!(out, "{}", rows.trim_fmt())
}

pub(crate) fn report_json(report: &Report) -> Value {
    let pair = |ends: Ends| json!([ends.low, ends.high]);
    let slope = report.lines.iter().find(|line| line.name == SLOPE);
    let line = |line: &Line| {
        let above = slope.map(|slope| line.above(slope));
        json!({
            "map": line.name,
            "auc": line.auc,
            "above_slope": above.map(|(by, ends)| json!([by, ends.map(pair)])),
            "by_stop": pair(line.by_stop),
            "by_sol": pair(line.by_sol),
            "by_cell": pair(line.by_cell),
            "cells_once": line.by_distinct_cell,
            "within": NEARER.iter().zip(&line.nearer).map(|(r, auc)| json!([r, auc])).collect::<Vec<_>>(),
        })
    };
    let share = |share: &Share| {
        json!({
            "places": share.name,
            "count": share.count,
            "met": share.met,
            "ends": share.ends.map(pair),
            "drawn": share.drawn,
        })
    };
    json!({
        "targets": report.targets,
        "target_cells": report.target_cells,
        "ground": report.ground,
        "near_cells": report.terms.near,
        "met_cells": report.terms.met,
        "resamples": report.terms.resamples,
        "seed": report.terms.seed,
        "maps": report.lines.iter().map(line).collect::<Vec<_>>(),
        "shares": report.shares.iter().map(share).collect::<Vec<_>>(),
    })
}
