//! The study's tables, diagrams and files.

use std::fmt::Write as _;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::Context;
use comfy_table::presets::NOTHING;
use comfy_table::{CellAlignment, Table};
use serde_json::{Value, json};
use wisdom_mission::statistics::{Bin, Calibration};

use crate::chart::ReliabilityDiagram;
use crate::study::{BINS, COMMON, CONDITIONS, Condition, Count, Driven, Plan};

/// One line a block, and one for all of them.
struct Row {
    name: String,
    count: Count,
}

fn rows(plan: &Plan, driven: &[Driven]) -> Vec<Row> {
    let blocks = plan.blocks.iter().zip(driven.chunks(plan.each));
    let mut rows: Vec<Row> = blocks
        .map(|(block, driven)| {
            let (first, last) = plan.ends(*block);
            Row { name: format!("seeds {first} to {last}"), count: Count::of(driven) }
        })
        .collect();
    rows.push(Row { name: "pooled".to_owned(), count: Count::of(driven) });
    rows
}

pub(crate) fn write_tables(
    out: &mut dyn Write,
    plan: &Plan,
    results: &[Vec<Driven>],
) -> std::io::Result<()> {
    writeln!(out, "Predicted against observed reliability of legs, {}", plan.mission.display())?;
    for (key, value) in COMMON {
        writeln!(out, "    {key} = {value}")?;
    }
    for (condition, driven) in CONDITIONS.iter().zip(results) {
        writeln!(out, "\n{}: {}", condition.key, condition.title)?;
        for (key, value) in condition.changes {
            writeln!(out, "    {key} = {value}")?;
        }
        let mut table = Table::new();
        table.load_style(NOTHING);
        table.set_header([
            "",
            "missions",
            "legs",
            "cut\nshort",
            "arrived",
            "predicted",
            "observed",
            "Brier",
            "Brier\nexpected",
            "HL",
            "d.f.",
            "p",
            "z",
            "p",
        ]);
        for row in rows(plan, driven) {
            table.add_row(cells(&row));
        }
        for column in table.column_iter_mut().skip(1) {
            column.set_cell_alignment(CellAlignment::Right);
        }
        writeln!(out, "{}", table.trim_fmt())?;
    }
    writeln!(
        out,
        "\nlegs: those that ended by themselves; cut short: the budget ran out on the way, counted nowhere else;\n\
         Brier expected: its mean if every prediction is true; HL: Hosmer-Lemeshow with its degrees of freedom;\n\
         z: Spiegelhalter, positive if the predictions promise too much"
    )
}

fn cells(Row { name, count }: &Row) -> Vec<String> {
    let mut cells = vec![
        name.clone(),
        count.missions.to_string(),
        count.legs.to_string(),
        count.cut_short.to_string(),
    ];
    let Some(found) = &count.calibration else {
        cells.extend((0..10).map(|_| "-".to_owned()));
        return cells;
    };
    let (hl, z) = (found.hosmer_lemeshow, found.spiegelhalter);
    let shown = |number: Option<String>| number.unwrap_or_else(|| "-".to_owned());
    cells.extend([
        found.happened.to_string(),
        format!("{:.4}", found.mean_predicted),
        format!("{:.4}", found.happened as f64 / found.count as f64),
        format!("{:.4}", found.brier.score),
        format!("{:.4}", found.brier.expected),
        shown(hl.map(|test| format!("{:.2}", test.statistic))),
        shown(hl.map(|test| test.degrees_of_freedom.to_string())),
        shown(hl.map(|test| probability(test.p))),
        shown(z.map(|test| format!("{:.2}", test.z))),
        shown(z.map(|test| probability(test.p))),
    ]);
    cells
}

/// A p-value: four decimals, or its power of ten where they would be zeros.
fn probability(p: f64) -> String {
    if p >= 1e-3 || p == 0.0 { format!("{p:.4}") } else { format!("{p:.1e}") }
}

pub(crate) fn json(plan: &Plan, results: &[Vec<Driven>]) -> Value {
    let conditions: Vec<Value> = CONDITIONS
        .iter()
        .zip(results)
        .map(|(condition, driven)| {
            let rows = rows(plan, driven);
            let (pooled, blocks) = rows.split_last().expect("there is a row for all blocks");
            let blocks: Vec<Value> = plan
                .blocks
                .iter()
                .zip(blocks)
                .map(|(block, row)| {
                    let (first, last) = plan.ends(*block);
                    json!({ "block": block, "seeds": [first, last], "found": found(&row.count) })
                })
                .collect();
            json!({
                "condition": condition.key,
                "title": condition.title,
                "changes": pairs(condition.changes),
                "blocks": blocks,
                "pooled": found(&pooled.count),
            })
        })
        .collect();
    json!({
        "mission": plan.mission,
        "changes": pairs(&COMMON),
        "bins": BINS,
        "conditions": conditions,
    })
}

fn pairs(changes: &[(&str, &str)]) -> Value {
    changes.iter().map(|(key, value)| format!("{key}={value}")).collect()
}

fn found(count: &Count) -> Value {
    json!({
        "missions": count.missions,
        "budget_spent": count.spent,
        "legs": count.legs,
        "cut_short": count.cut_short,
        "calibration": count.calibration.as_ref().map(calibration),
    })
}

fn calibration(found: &Calibration) -> Value {
    let brier = found.brier;
    json!({
        "arrived": found.happened,
        "mean_predicted": found.mean_predicted,
        "observed": found.happened as f64 / found.count as f64,
        "brier": {
            "score": brier.score,
            "expected": brier.expected,
            "reliability": brier.reliability,
            "resolution": brier.resolution,
            "uncertainty": brier.uncertainty,
            "within": brier.within,
        },
        "hosmer_lemeshow": found.hosmer_lemeshow.map(|test| json!({
            "statistic": test.statistic,
            "degrees_of_freedom": test.degrees_of_freedom,
            "p": test.p,
        })),
        "spiegelhalter": found.spiegelhalter.map(|test| json!({ "z": test.z, "p": test.p })),
        "bins": found.bins.iter().map(bin).collect::<Vec<_>>(),
    })
}

fn bin(bin: &Bin) -> Value {
    json!({
        "low": bin.low,
        "high": bin.high,
        "legs": bin.count,
        "arrived": bin.happened,
        "mean_predicted": bin.mean_predicted,
        "observed": bin.observed.mean,
        "observed_95": [bin.observed.low, bin.observed.high],
    })
}

/// Writes the diagrams, the numbers and the legs; returns the files' paths.
pub(crate) fn write_files(
    folder: &Path,
    plan: &Plan,
    results: &[Vec<Driven>],
    object: &Value,
) -> anyhow::Result<Vec<PathBuf>> {
    let mut written = Vec::new();
    for (condition, driven) in CONDITIONS.iter().zip(results) {
        let count = Count::of(driven);
        if let Some(calibration) = &count.calibration {
            let name = format!("reliability-{}", condition.key);
            let paths = draw(folder, &name, condition, &count, calibration)
                .with_context(|| format!("{name} in {}", folder.display()))?;
            written.extend(paths);
        }
    }
    for (name, text) in
        [("reliability.json", format!("{object:#}\n")), ("legs.csv", legs(plan, results))]
    {
        let path = folder.join(name);
        fs::write(&path, text).with_context(|| path.display().to_string())?;
        written.push(path);
    }
    Ok(written)
}

fn draw(
    folder: &Path,
    name: &str,
    condition: &Condition,
    count: &Count,
    calibration: &Calibration,
) -> anyhow::Result<[PathBuf; 2]> {
    let Count { missions, legs, cut_short, .. } = count;
    let brier = calibration.brier;
    let mut remarks = vec![
        format!("{missions} missions, {legs} legs, {cut_short} more cut short"),
        format!("Brier score {:.4}, expected {:.4}", brier.score, brier.expected),
    ];
    if let Some(test) = calibration.hosmer_lemeshow {
        let (statistic, degrees, p) =
            (test.statistic, test.degrees_of_freedom, probability(test.p));
        remarks.push(format!("Hosmer-Lemeshow {statistic:.2}, {degrees} d.f., p = {p}"));
    }
    if let Some(test) = calibration.spiegelhalter {
        remarks.push(format!("Spiegelhalter z = {:.2}, p = {}", test.z, probability(test.p)));
    }
    remarks.push("Whiskers: 95 % (Wilson). Dashed: every prediction true.".to_owned());
    let diagram = ReliabilityDiagram {
        title: condition.title,
        remarks: &remarks,
        predicted: "predicted leg reliability",
        observed: "share of legs that arrived",
        counted: "legs",
        calibration,
    };
    diagram.drawing().write(folder, name)
}

/// Every leg, a line each; `arrived` is empty where it was cut short.
fn legs(plan: &Plan, results: &[Vec<Driven>]) -> String {
    let mut text = "condition,block,seed,leg,predicted,arrived\n".to_owned();
    for (condition, driven) in CONDITIONS.iter().zip(results) {
        for (block, driven) in plan.blocks.iter().zip(driven.chunks(plan.each)) {
            for mission in driven {
                for (i, leg) in mission.legs.iter().enumerate() {
                    let arrived = leg.arrived.map_or_else(String::new, |a| a.to_string());
                    let (key, seed, p) = (condition.key, mission.seed, leg.predicted);
                    writeln!(text, "{key},{block},{seed},{i},{p},{arrived}")
                        .expect("a string takes all that is written");
                }
            }
        }
    }
    text
}
