//! `wisdom verify`: whether a log holds what its inputs lead to.

use std::io::{IsTerminal, Write};
use std::path::PathBuf;
use std::process::ExitCode;

use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;
use wisdom_logbook::{Difference, Status, Verification, VerifyLevel};

use crate::exit::{BAD_INPUT, FAILED, LOSSY};

/// Check a log: its file, its identity, its decisions, its whole run.
///
/// Each level checks what the ones before it do. file: every checksum, numbers without gaps, the digest chain, the end record.
/// identity: the mission inside is the one that the log names, and decisions mean what this build's mean. re-decide: every
/// decision is derived again from the logged inputs and compared field by field and map by map, and the mission's invariants
/// hold. re-simulate: the closed loop is driven again in the world inside the log, so that the inputs must come out too.
#[derive(clap::Args, Debug)]
pub(crate) struct VerifyArgs {
    /// The log (NAME.mcap or NAME.mcap.part).
    log: PathBuf,
    /// How much is checked: file, identity, re-decide or re-simulate.
    #[arg(long, default_value_t, value_name = "LEVEL", value_parser = level)]
    level: VerifyLevel,
    /// Print one JSON object instead of text.
    #[arg(long)]
    json: bool,
}

fn level(text: &str) -> Result<VerifyLevel, String> {
    VerifyLevel::ALL.into_iter().find(|level| level.name() == text).ok_or_else(|| {
        let names = VerifyLevel::ALL.map(VerifyLevel::name);
        format!("expected one of {}", names.join(", "))
    })
}

pub(crate) fn run(args: &VerifyArgs) -> anyhow::Result<ExitCode> {
    let shown = !args.json && std::io::stderr().is_terminal();
    let bar = if shown { ProgressBar::new_spinner() } else { ProgressBar::hidden() };
    bar.set_style(ProgressStyle::with_template(
        "{spinner} {pos} decisions derived again  {elapsed}",
    )?);
    let found = wisdom_logbook::verify(&args.log, args.level, &mut |_| bar.inc(1))?;
    bar.finish_and_clear();
    let mut out = std::io::stdout().lock();
    if args.json {
        writeln!(out, "{}", as_json(args, &found))?;
    } else {
        tell(&mut out, &found)?;
    }
    Ok(match (&found.not_comparable, found.holds(), &found.status) {
        (Some(_), _, _) => ExitCode::from(BAD_INPUT),
        (None, true, Status::Complete) => ExitCode::SUCCESS,
        (None, true, _) => ExitCode::from(LOSSY),
        (None, false, _) => ExitCode::from(FAILED),
    })
}

fn as_json(args: &VerifyArgs, found: &Verification) -> serde_json::Value {
    let decided = found.level >= VerifyLevel::Redecide && found.not_comparable.is_none();
    json!({
        "log": args.log.display().to_string(),
        "level": found.level.name(),
        "holds": found.holds(),
        "identical": decided.then(|| found.difference.is_none() && !matches!(found.status, Status::Corrupt { .. })),
        "decisions": found.decisions,
        "maps": found.maps,
        "log_status": found.status.to_string(),
        "chain": found.chain,
        "not_comparable": found.not_comparable,
        "difference": found.difference.as_ref().map(difference_json),
        "breaches": found.breaches.iter().map(|b| json!({
            "decision": b.decision, "invariant": b.invariant, "found": b.detail,
        })).collect::<Vec<_>>(),
        "remarks": found.remarks,
    })
}

fn difference_json(d: &Difference) -> serde_json::Value {
    json!({
        "decision": d.decision, "stage": d.stage, "field": d.path,
        "logged": d.left, "derived": d.right, "ulps": d.ulps,
        "map": d.map.as_ref().map(|m| json!({
            "plane": m.plane, "row": m.cell.row, "col": m.cell.col,
            "logged": m.left, "derived": m.right, "cells": m.cells,
        })),
    })
}

fn tell(out: &mut dyn Write, found: &Verification) -> std::io::Result<()> {
    let Verification { level, decisions, maps, status, chain, .. } = found;
    for remark in &found.remarks {
        writeln!(out, "remark: {remark}")?;
    }
    let of_file = format!("log {status}, chain {chain}");
    let before = match status {
        Status::Corrupt { .. } => "DAMAGED; before the damage ",
        Status::Complete | Status::Truncated { .. } => "",
    };
    match (&found.not_comparable, &found.difference) {
        (Some(why), _) => writeln!(out, "not comparable: {why}; {of_file}")?,
        (None, Some(d)) => {
            // By the time the world is driven again, all decisions were found to follow from what was logged.
            let when =
                if d.stage == "simulation" { " with the logged inputs" } else { " before it" };
            writeln!(out, "DIFFERENT: {d}")?;
            writeln!(out, "{decisions} decisions agree{when}; {of_file}")?;
        }
        (None, None) => {
            let told = match level {
                VerifyLevel::File => format!("file checked: {decisions} decisions"),
                VerifyLevel::Identity => "identity holds".to_owned(),
                VerifyLevel::Redecide | VerifyLevel::Resimulate => format!(
                    "identical: {decisions} decisions and {maps} maps derived again from the logged inputs"
                ),
            };
            let driven = match level {
                VerifyLevel::Resimulate => ", and the inputs by driving it again",
                _ => "",
            };
            writeln!(out, "{before}{told}{driven}; {of_file}")?;
        }
    }
    for breach in &found.breaches {
        writeln!(out, "BREACH: {breach}")?;
    }
    if *level >= VerifyLevel::Redecide && found.holds() {
        let names: Vec<&str> = wisdom_logbook::INVARIANTS.iter().map(|(name, _)| *name).collect();
        writeln!(out, "invariants hold: {}", names.join(", "))?;
    }
    Ok(())
}
