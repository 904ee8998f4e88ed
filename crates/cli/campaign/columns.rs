//! The table of a campaign: a row a run, in the order of the runs.

use std::path::Path;

use anyhow::Context;
use wisdom_mission::{Row, RowResult};

use super::folder::write_whole;

/// How a column's value is found.
pub(super) enum Of {
    /// A whole number; none for a run that has none.
    Count(fn(&Row) -> Option<u64>),
    /// A number; none for a run that has none.
    Real(fn(&Row) -> Option<f64>),
    /// Text.
    Text(fn(&Row) -> String),
}

/// A column: its name, with its unit, and its value for a run.
pub(super) struct Column {
    pub(super) name: &'static str,
    pub(super) of: Of,
}

const fn count(name: &'static str, of: fn(&Row) -> Option<u64>) -> Column {
    Column { name, of: Of::Count(of) }
}

const fn real(name: &'static str, of: fn(&Row) -> Option<f64>) -> Column {
    Column { name, of: Of::Real(of) }
}

const fn text(name: &'static str, of: fn(&Row) -> String) -> Column {
    Column { name, of: Of::Text(of) }
}

/// The columns of `runs.csv`, as docs/campaign.md explains them.
pub(super) const COLUMNS: [Column; 27] = [
    count("index", |row| Some(row.index as u64)),
    count("seed", |row| Some(row.seed)),
    text("rule", |row| row.rule.clone()),
    text("policy", |row| row.policy.clone()),
    text("status", status),
    count("decisions", |row| Some(row.run()?.decisions.into())),
    count("observations", |row| Some(row.run()?.observations.into())),
    count("goals", |row| Some(row.run()?.goals.len() as u64)),
    real("interest_own_map", |row| Some(row.run()?.interest())),
    real("interest_ruler", |row| Some(row.run()?.ruler())),
    real("distance_m", |row| Some(row.run()?.distance_m)),
    real("time_s", |row| Some(row.run()?.time_s)),
    real("energy_j", |row| Some(row.run()?.energy_j)),
    real("data_mb", |row| Some(row.run()?.data_mb)),
    real("reliability", |row| Some(row.run()?.reliability)),
    count("reallocations", |row| Some(row.run()?.reallocations.into())),
    count("added", |row| Some(row.run()?.added.into())),
    count("modified", |row| Some(row.run()?.modified.into())),
    count("reordered", |row| Some(row.run()?.reordered.into())),
    count("dropped", |row| Some(row.run()?.dropped.into())),
    count("legs", |row| Some(row.run()?.legs.len() as u64)),
    count("legs_ended", |row| Some(row.run()?.forecasts().count() as u64)),
    count("legs_arrived", |row| {
        Some(row.run()?.forecasts().filter(|leg| leg.happened).count() as u64)
    }),
    real("predicted_arrivals", |row| {
        Some(row.run()?.forecasts().fold(0.0, |sum, leg| sum + leg.predicted))
    }),
    real("brier", |row| row.run()?.brier()),
    text("faults", |row| row.run().map_or_else(String::new, |run| run.faults.join("; "))),
    text("error", error),
];

fn status(row: &Row) -> String {
    row.run().map_or_else(|| "failed".to_owned(), |run| run.status.clone())
}

fn error(row: &Row) -> String {
    match &row.result {
        RowResult::Failed { error } => error.clone(),
        RowResult::Finished(_) => String::new(),
    }
}

/// Writes `runs.csv`.
pub(super) fn write_runs(path: &Path, rows: &[Row]) -> anyhow::Result<()> {
    let mut out = csv::Writer::from_writer(Vec::new());
    out.write_record(COLUMNS.iter().map(|column| column.name))?;
    for row in rows {
        out.write_record(COLUMNS.iter().map(|column| match column.of {
            Of::Count(of) => of(row).map_or_else(String::new, |n| n.to_string()),
            // The shortest digits that read back to the same number.
            Of::Real(of) => of(row).map_or_else(String::new, |x| x.to_string()),
            Of::Text(of) => of(row),
        }))?;
    }
    finish(path, out)
}

/// Writes `legs.csv`: a row a leg.
pub(super) fn write_legs(path: &Path, rows: &[Row]) -> anyhow::Result<()> {
    let mut out = csv::Writer::from_writer(Vec::new());
    out.write_record(["index", "leg", "predicted", "arrived"])?;
    for (row, run) in rows.iter().filter_map(|row| Some((row, row.run()?))) {
        for (leg, number) in run.legs.iter().zip(0u32..) {
            out.write_record([
                row.index.to_string(),
                number.to_string(),
                leg.predicted.to_string(),
                leg.arrived.map_or_else(String::new, |arrived| arrived.to_string()),
            ])?;
        }
    }
    finish(path, out)
}

fn finish(path: &Path, out: csv::Writer<Vec<u8>>) -> anyhow::Result<()> {
    let bytes = out.into_inner().with_context(|| path.display().to_string())?;
    write_whole(path, &bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_column_is_explained() {
        let page = include_str!("../../../docs/campaign.md");
        for column in &COLUMNS {
            assert!(page.contains(&format!("| `{}` |", column.name)), "{}", column.name);
        }
    }
}
