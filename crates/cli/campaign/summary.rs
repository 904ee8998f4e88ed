//! What a campaign came to: means, paired differences, and whether the predicted reliability came true.

use std::io::Write;

use comfy_table::Table;
use comfy_table::presets::NOTHING;
use serde_json::{Map, Value, json};
use wisdom_mission::statistics::{
    Calibration, Forecast, Interval, mean_interval, paired_difference,
};
use wisdom_mission::{METRICS, PairedTable, Row, RowResult, RunRow, Variant, table};

use super::folder::Folder;

/// Bootstrap samples of each interval: a thousand steady its ends to a tenth of its width, and more are cheap.
const RESAMPLES: usize = 4000;

/// Seed of the bootstrap: a fixed one, so that a summary is a function of its rows.
const RESAMPLING_SEED: u64 = 1;

/// Groups of legs that the calibration is held over.
const BINS: usize = 10;

/// What a variant came to.
pub(super) struct Of {
    pub(super) variant: Variant,
    /// By metric; none without paired seeds.
    pub(super) means: Vec<Option<Interval>>,
    /// By metric, less the first variant's; none without paired seeds, and for the first.
    pub(super) differences: Vec<Option<Interval>>,
    /// Over all its runs, paired or not; none without legs that ended.
    pub(super) legs: Option<Calibration>,
    /// Legs that were cut short.
    cut_short: usize,
}

/// What a campaign came to.
pub(super) struct Summary {
    pub(super) mission: String,
    runs: usize,
    rows: usize,
    failed: Vec<(usize, String)>,
    paired: PairedTable,
    pub(super) variants: Vec<Of>,
    /// Over all runs; none without legs that ended.
    pub(super) legs: Option<Calibration>,
}

impl Summary {
    /// The summary of the rows that are there.
    pub(super) fn of(folder: &Folder, rows: &[Row]) -> Self {
        let paired = table(&folder.plan, rows);
        let variants = paired
            .variants
            .iter()
            .enumerate()
            .map(|(v, &variant)| {
                let metrics = 0..METRICS.len();
                let means = metrics
                    .clone()
                    .map(|m| mean_interval(paired.values(m, v), RESAMPLES, RESAMPLING_SEED))
                    .collect();
                let difference = |m| {
                    let (own, first) = (paired.values(m, v), paired.values(m, 0));
                    paired_difference(own, first, RESAMPLES, RESAMPLING_SEED)
                };
                let count = paired.variants.len();
                let runs = || rows.iter().filter(|r| r.index % count == v).filter_map(Row::run);
                let forecasts: Vec<Forecast> = runs().flat_map(RunRow::forecasts).collect();
                Of {
                    variant,
                    means,
                    differences: metrics.map(|m| difference(m).filter(|_| v > 0)).collect(),
                    cut_short: runs().map(|run| run.legs.len()).sum::<usize>() - forecasts.len(),
                    legs: Calibration::of(&forecasts, BINS),
                }
            })
            .collect();
        let failed = rows
            .iter()
            .filter_map(|row| match &row.result {
                RowResult::Failed { error } => Some((row.index, error.clone())),
                RowResult::Finished(_) => None,
            })
            .collect();
        let legs: Vec<Forecast> =
            rows.iter().filter_map(Row::run).flat_map(RunRow::forecasts).collect();
        Self {
            mission: folder.manifest.mission.clone(),
            runs: folder.plan.len(),
            rows: rows.len(),
            failed,
            paired,
            variants,
            legs: Calibration::of(&legs, BINS),
        }
    }

    /// The worlds that means are over, in words.
    pub(super) fn worlds(&self) -> String {
        format!(
            "{}: means over {} worlds, 95 % bootstrap intervals",
            self.mission,
            self.paired.seeds.len()
        )
    }

    /// What a variant is called: its policy is left out where there is only one.
    pub(super) fn name(&self, of: &Of) -> String {
        let policy = self.variants[0].variant.policy;
        if self.variants.iter().all(|other| other.variant.policy == policy) {
            return of.variant.rule.to_string();
        }
        of.variant.to_string()
    }

    /// Runs that failed.
    pub(super) fn failed(&self) -> usize {
        self.failed.len()
    }

    /// Runs without a row.
    pub(super) fn missing(&self) -> usize {
        self.runs - self.rows
    }

    /// As `summary.json` has it.
    pub(super) fn as_json(&self) -> Value {
        let failed: Vec<Value> = self
            .failed
            .iter()
            .map(|(index, error)| json!({ "index": index, "error": error }))
            .collect();
        let variants: Vec<Value> = self
            .variants
            .iter()
            .map(|of| {
                json!({
                    "rule": of.variant.rule.to_string(),
                    "policy": of.variant.policy.to_string(),
                    "means": by_metric(&of.means),
                    "less_first": by_metric(&of.differences),
                    "legs_cut_short": of.cut_short,
                    "legs": of.legs.as_ref().map(calibration),
                })
            })
            .collect();
        json!({
            "mission": self.mission,
            "runs": self.runs,
            "finished": self.rows - self.failed.len(),
            "failed": failed,
            "missing": self.missing(),
            "paired_seeds": self.paired.seeds.len(),
            "seeds_left_out": self.paired.left_out,
            "variants": variants,
            "legs": self.legs.as_ref().map(calibration),
        })
    }

    /// As people read it.
    pub(super) fn write(&self, out: &mut dyn Write) -> std::io::Result<()> {
        writeln!(
            out,
            "{}: {} of {} runs finished; means over {} worlds, 95 % intervals in brackets",
            self.mission,
            self.rows - self.failed.len(),
            self.runs,
            self.paired.seeds.len()
        )?;
        if !self.paired.left_out.is_empty() {
            let count = self.paired.left_out.len();
            writeln!(out, "{count} worlds are left out: not all their runs finished")?;
        }
        writeln!(out, "{}\n", self.values(|of| &of.means, 0))?;
        if self.variants.len() > 1 {
            writeln!(out, "in the same worlds, less {}", self.variants[0].variant)?;
            writeln!(out, "{}\n", self.values(|of| &of.differences, 1))?;
        }
        self.write_legs(out)?;
        for (index, error) in &self.failed {
            writeln!(out, "run {index} failed: {}", error.lines().next().unwrap_or_default())?;
        }
        Ok(())
    }

    /// One line a variant, from some variant on, with the metrics that people look at.
    fn values(&self, of: impl Fn(&Of) -> &Vec<Option<Interval>>, from: usize) -> Table {
        const SHOWN: [(&str, &str, usize); 6] = [
            ("goals", "goals", 1),
            ("interest_own_map", "interest\nown map", 3),
            ("interest_ruler", "interest\nruler", 3),
            ("distance_m", "distance\nm", 0),
            ("reliability", "reliability", 3),
            ("reallocations", "realloc.", 1),
        ];
        let mut table = Table::new();
        table.load_style(NOTHING);
        let names = ["rule", "policy"].into_iter().chain(SHOWN.map(|(_, title, _)| title));
        table.set_header(names);
        for variant in &self.variants[from..] {
            let mut row =
                vec![variant.variant.rule.to_string(), variant.variant.policy.to_string()];
            for (name, _, digits) in SHOWN {
                let metric = METRICS.iter().position(|metric| metric.name == name);
                let interval = metric.and_then(|metric| of(variant)[metric]);
                row.push(interval.map_or_else(
                    || "-".to_owned(),
                    |i| format!("{:.digits$}\n[{:.digits$}, {:.digits$}]", i.mean, i.low, i.high),
                ));
            }
            table.add_row(row);
        }
        table
    }

    fn write_legs(&self, out: &mut dyn Write) -> std::io::Result<()> {
        writeln!(
            out,
            "legs: predicted reliability against what happened (legs cut short left out)"
        )?;
        let mut table = Table::new();
        table.load_style(NOTHING);
        table.set_header([
            "rule",
            "policy",
            "ended",
            "arrived",
            "predicted",
            "Brier",
            "if true",
            "p\nHosmer-L.",
            "p\nSpiegelh.",
            "cut\nshort",
        ]);
        for of in &self.variants {
            let Some(legs) = &of.legs else { continue };
            let chance = |p: Option<f64>| p.map_or_else(|| "-".to_owned(), |p| format!("{p:.3}"));
            table.add_row([
                of.variant.rule.to_string(),
                of.variant.policy.to_string(),
                legs.count.to_string(),
                legs.happened.to_string(),
                format!("{:.1}", legs.mean_predicted * legs.count as f64),
                format!("{:.4}", legs.brier.score),
                format!("{:.4}", legs.brier.expected),
                chance(legs.hosmer_lemeshow.map(|test| test.p)),
                chance(legs.spiegelhalter.map(|test| test.p)),
                of.cut_short.to_string(),
            ]);
        }
        writeln!(out, "{table}")
    }
}

fn by_metric(intervals: &[Option<Interval>]) -> Value {
    let fields: Map<String, Value> = METRICS
        .iter()
        .zip(intervals)
        .filter_map(|(metric, i)| Some((metric.name.to_owned(), interval(i.as_ref()?))))
        .collect();
    Value::Object(fields)
}

fn interval(i: &Interval) -> Value {
    json!({ "mean": i.mean, "low": i.low, "high": i.high })
}

fn calibration(legs: &Calibration) -> Value {
    let bins: Vec<Value> = legs
        .bins
        .iter()
        .map(|bin| {
            json!({
                "low": bin.low,
                "high": bin.high,
                "count": bin.count,
                "arrived": bin.happened,
                "mean_predicted": bin.mean_predicted,
                "observed": interval(&bin.observed),
            })
        })
        .collect();
    json!({
        "ended": legs.count,
        "arrived": legs.happened,
        "mean_predicted": legs.mean_predicted,
        "brier": {
            "score": legs.brier.score,
            "expected": legs.brier.expected,
            "reliability": legs.brier.reliability,
            "resolution": legs.brier.resolution,
            "uncertainty": legs.brier.uncertainty,
            "within": legs.brier.within,
        },
        "hosmer_lemeshow": legs.hosmer_lemeshow.map(|test| json!({
            "statistic": test.statistic,
            "degrees_of_freedom": test.degrees_of_freedom,
            "p": test.p,
        })),
        "spiegelhalter": legs.spiegelhalter.map(|test| json!({ "z": test.z, "p": test.p })),
        "bins": bins,
    })
}
