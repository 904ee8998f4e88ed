//! What a campaign came to: means, paired differences, and whether the predicted reliability came true.

use std::io::Write;

use comfy_table::Table;
use comfy_table::presets::NOTHING;
use serde_json::{Map, Value, json};
use wisdom_mission::statistics::{
    Calibration, Forecast, Interval, mean_interval, paired_difference,
};
use wisdom_mission::{METRICS, PairedTable, Row, RowResult, RunRow, Variant, table};

use super::counted;
use super::folder::Folder;

/// Bootstrap samples of each interval: a thousand steady its ends to a tenth of its width, and more are cheap.
const RESAMPLES: usize = 4000;

/// Seed of the bootstrap: a fixed one, so that a summary is a function of its rows.
const RESAMPLING_SEED: u64 = 1;

/// Below so many worlds, percentile intervals are remarked upon: they cover the true mean clearly less often than stated.
const FEW_WORLDS: usize = 10;

/// The most variants side by side: what a terminal is wide enough for.
const ABREAST: usize = 3;

/// Groups of legs that the calibration is held over.
const BINS: usize = 10;

/// What is said of intervals over fewer than [`FEW_WORLDS`].
const TOO_SHORT: &str = "percentile intervals over so few worlds are too short";

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
    pub(super) cut_short: usize,
}

/// What a campaign came to.
pub(super) struct Summary {
    pub(super) mission: String,
    runs: usize,
    rows: usize,
    failed: Vec<(usize, String)>,
    paired: PairedTable,
    pub(super) variants: Vec<Of>,
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
        Self {
            mission: folder.manifest.mission.clone(),
            runs: folder.plan.len(),
            rows: rows.len(),
            failed,
            paired,
            variants,
        }
    }

    /// The worlds that means are over, in words, a line each.
    pub(super) fn worlds(&self) -> Vec<String> {
        let worlds = counted(self.paired.seeds.len(), "world");
        let mission = &self.mission;
        if !self.has_intervals() {
            return vec![format!("{mission}: {worlds}, no intervals")];
        }
        let mut lines = vec![format!("{mission}: means over {worlds}, 95 % bootstrap intervals")];
        lines.extend(self.is_hint().then(|| TOO_SHORT.to_owned()));
        lines
    }

    /// Whether the worlds say anything of the spread: one does not.
    pub(super) fn has_intervals(&self) -> bool {
        self.paired.seeds.len() > 1
    }

    /// Whether there are too few worlds for intervals as wide as they should be.
    fn is_hint(&self) -> bool {
        self.has_intervals() && self.paired.seeds.len() < FEW_WORLDS
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
                    "means": by_metric(&of.means, self.has_intervals()),
                    "less_first": by_metric(&of.differences, self.has_intervals()),
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
        })
    }

    /// As people read it.
    pub(super) fn write(&self, out: &mut dyn Write) -> std::io::Result<()> {
        let (finished, worlds) = (self.rows - self.failed.len(), self.paired.seeds.len());
        writeln!(
            out,
            "{}: {finished} of {} finished; means over {}, 95 % intervals in brackets",
            self.mission,
            counted(self.runs, "run"),
            counted(worlds, "world")
        )?;
        if worlds == 1 {
            writeln!(out, "1 world has no intervals")?;
        }
        if self.is_hint() {
            writeln!(out, "{TOO_SHORT}")?;
        }
        if !self.paired.left_out.is_empty() {
            let count = self.paired.left_out.len();
            let are = if count == 1 { "is" } else { "are" };
            writeln!(out, "{} {are} left out: not all runs finished", counted(count, "world"))?;
        }
        writeln!(out)?;
        self.write_values(out, &self.variants, |of| &of.means)?;
        if self.variants.len() > 1 {
            writeln!(out, "in the same worlds, less {}\n", self.variants[0].variant)?;
            self.write_values(out, &self.variants[1..], |of| &of.differences)?;
        }
        self.write_legs(out)?;
        for (index, error) in &self.failed {
            writeln!(out, "run {index} failed: {}", error.lines().next().unwrap_or_default())?;
        }
        Ok(())
    }

    /// A column a variant and a row a metric that people look at.
    fn write_values(
        &self,
        out: &mut dyn Write,
        variants: &[Of],
        of: impl Fn(&Of) -> &Vec<Option<Interval>>,
    ) -> std::io::Result<()> {
        const SHOWN: [(&str, &str, usize); 8] = [
            ("goals", "goals", 1),
            ("interest_own_map", "interest, own map", 3),
            ("interest_ruler", "interest, ruler", 3),
            ("distance_m", "distance, m", 0),
            ("time_s", "time, s", 0),
            ("energy_j", "energy, J", 0),
            ("reliability", "reliability", 3),
            ("reallocations", "reallocations", 1),
        ];
        for variants in variants.chunks(ABREAST) {
            let mut table = Table::new();
            table.load_style(NOTHING);
            let name = |of: &Of| format!("{}\n{}", of.variant.rule, of.variant.policy);
            table.set_header(std::iter::once(String::new()).chain(variants.iter().map(name)));
            for (name, title, digits) in SHOWN {
                let metric = METRICS.iter().position(|metric| metric.name == name);
                let value = |variant: &Of| {
                    let Some(i) = metric.and_then(|metric| of(variant)[metric]) else {
                        return "-".to_owned();
                    };
                    if !self.has_intervals() {
                        return format!("{:.digits$} [-]", i.mean);
                    }
                    format!("{:.digits$} [{:.digits$}, {:.digits$}]", i.mean, i.low, i.high)
                };
                table.add_row(std::iter::once(title.to_owned()).chain(variants.iter().map(value)));
            }
            writeln!(out, "{}\n", table.trim_fmt())?;
        }
        Ok(())
    }

    fn write_legs(&self, out: &mut dyn Write) -> std::io::Result<()> {
        writeln!(out, "legs: predicted reliability against what happened")?;
        let mut table = Table::new();
        table.load_style(NOTHING);
        table.set_header([
            "rule",
            "policy",
            "ended",
            "arrived",
            "predicted",
            "Brier",
            "Brier\nexpected",
            "p\n(H-L)",
            "p\n(Spiegelhalter)",
            "cut\nshort",
        ]);
        for of in &self.variants {
            let Some(legs) = &of.legs else { continue };
            let chance = |p: Option<f64>| p.map_or_else(|| "-".to_owned(), chance);
            table.add_row([
                of.variant.rule.to_string(),
                of.variant.policy.to_string(),
                legs.count.to_string(),
                legs.happened.to_string(),
                format!("{:.1}", legs.mean_predicted * legs.count as f64),
                score(legs.brier.score),
                score(legs.brier.expected),
                chance(legs.hosmer_lemeshow.map(|test| test.p)),
                chance(legs.spiegelhalter.map(|test| test.p)),
                of.cut_short.to_string(),
            ]);
        }
        writeln!(out, "{}", table.trim_fmt())?;
        let left_out = |of: &Of| of.legs.as_ref().is_some_and(|l| l.hosmer_lemeshow.is_none());
        if self.variants.iter().any(left_out) {
            writeln!(
                out,
                "H-L (Hosmer-Lemeshow) is left out where fewer than 5 failures (or fewer than 5 arrivals) are expected"
            )?;
        }
        let cut: usize = self.variants.iter().map(|of| of.cut_short).sum();
        if cut > 0 {
            let (legs, were) = (counted(cut, "leg"), if cut == 1 { "was" } else { "were" });
            writeln!(
                out,
                "{legs} {were} cut short and left out; the others are no fair sample, so p is a hint and no test"
            )?;
        }
        writeln!(out)
    }
}

/// A Brier score: four decimals, or its power of ten where they would be zeros.
pub(super) fn score(score: f64) -> String {
    if score >= 1e-3 || score == 0.0 { format!("{score:.4}") } else { format!("{score:.1e}") }
}

/// A p-value: below a thousandth, how far below says nothing.
pub(super) fn chance(p: f64) -> String {
    if p < 1e-3 { "<0.001".to_owned() } else { format!("{p:.3}") }
}

/// Means by the name of their metric, with their intervals if those are `known`.
fn by_metric(intervals: &[Option<Interval>], known: bool) -> Value {
    let value = |i: &Interval| {
        if known { interval(i) } else { json!({ "mean": i.mean, "low": null, "high": null }) }
    };
    let fields: Map<String, Value> = METRICS
        .iter()
        .zip(intervals)
        .filter_map(|(metric, i)| Some((metric.name.to_owned(), value(i.as_ref()?))))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_number_is_told_as_zero_that_is_none() {
        assert_eq!(score(4e-7), "4.0e-7");
        assert_eq!(score(0.01874), "0.0187");
        assert_eq!(score(0.0), "0.0000");
        assert_eq!([chance(1e-9), chance(0.0321), chance(1.0)], ["<0.001", "0.032", "1.000"]);
    }

    #[test]
    fn one_thing_is_not_several() {
        assert_eq!([counted(1, "world"), counted(2, "run")], ["1 world", "2 runs"]);
    }
}
