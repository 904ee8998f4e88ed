//! The summary's plots.

use std::path::Path;

use wisdom_mission::METRICS;
use wisdom_mission::statistics::Interval;

use super::counted;
use super::summary::{Of, Summary, chance, score};
use crate::chart::{Drawing, Intervals, ReliabilityDiagram};

/// What is plotted: the metric, the plot's title, its axis.
const PLOTTED: [(&str, &str, &str); 3] = [
    ("interest_ruler", "Interest gained, on the common ruler", "interest on the ruler"),
    ("goals", "Goals achieved", "goals"),
    ("distance_m", "Distance driven", "distance, m"),
];

/// Draws the summary into a folder: a plot of means a metric, one of differences where there is something to differ
/// from, and a reliability diagram a rule and policy. What there are no numbers for is not drawn.
pub(super) fn draw(folder: &Path, summary: &Summary) -> anyhow::Result<()> {
    for (metric, title, quantity) in PLOTTED {
        if let Some(drawing) = means(summary, metric, title, quantity) {
            drawing.write(folder, metric)?;
        }
        if let Some(drawing) = differences(summary, metric, title, quantity) {
            drawing.write(folder, &format!("{metric}_less_first"))?;
        }
    }
    for variant in &summary.variants {
        if let Some(drawing) = reliability(summary, variant) {
            drawing.write(folder, &reliability_name(summary, variant))?;
        }
    }
    Ok(())
}

fn means(summary: &Summary, metric: &str, title: &str, quantity: &str) -> Option<Drawing> {
    let rows = rows(summary, metric, |of| &of.means)?;
    let chart = Intervals {
        title,
        remarks: &summary.worlds(),
        quantity,
        rows: &rows,
        zero_line: false,
        whiskers: summary.has_intervals(),
    };
    Some(chart.drawing())
}

fn differences(summary: &Summary, metric: &str, title: &str, quantity: &str) -> Option<Drawing> {
    let rows = rows(summary, metric, |of| &of.differences)?;
    let title = format!("{title}: difference from {}", summary.name(&summary.variants[0]));
    let quantity = format!("{quantity}: difference");
    let chart = Intervals {
        title: &title,
        remarks: &summary.worlds(),
        quantity: &quantity,
        rows: &rows,
        zero_line: true,
        whiskers: summary.has_intervals(),
    };
    Some(chart.drawing())
}

/// The diagram of the only rule and policy has the plain name; others are told apart by theirs.
fn reliability_name(summary: &Summary, of: &Of) -> String {
    if summary.variants.len() == 1 {
        return "reliability".to_owned();
    }
    format!("reliability_{}", summary.name(of).replace(", ", "_"))
}

fn reliability(summary: &Summary, of: &Of) -> Option<Drawing> {
    let calibration = of.legs.as_ref()?;
    let brier = calibration.brier;
    let (legs, cut) = (counted(calibration.count, "leg"), of.cut_short);
    let mut remarks = vec![
        format!("{}, {}: {legs}, {cut} more cut short", summary.mission, summary.name(of)),
        format!("Brier score {}, expected {}", score(brier.score), score(brier.expected)),
    ];
    if let Some(test) = calibration.hosmer_lemeshow {
        let (statistic, degrees) = (test.statistic, test.degrees_of_freedom);
        remarks.push(format!("Hosmer-Lemeshow {statistic:.2}, {degrees} d.f., {}", p(test.p)));
    }
    if let Some(test) = calibration.spiegelhalter {
        remarks.push(format!("Spiegelhalter z = {:.2}, {}", test.z, p(test.p)));
    }
    remarks.push("Whiskers: 95 % (Wilson). Dashed: every prediction true.".to_owned());
    let chart = ReliabilityDiagram {
        title: "Leg reliability: predicted and observed",
        remarks: &remarks,
        predicted: "predicted leg reliability",
        observed: "share of legs that arrived",
        counted: "legs",
        calibration,
    };
    Some(chart.drawing())
}

/// A p-value with its letter.
fn p(value: f64) -> String {
    let chance = chance(value);
    if chance.starts_with('<') { format!("p {chance}") } else { format!("p = {chance}") }
}

/// A row a variant that has an interval of the metric; none if none has.
fn rows(
    summary: &Summary,
    metric: &str,
    of: impl Fn(&Of) -> &Vec<Option<Interval>>,
) -> Option<Vec<(String, Interval)>> {
    let place = METRICS.iter().position(|m| m.name == metric)?;
    let rows: Vec<_> = summary
        .variants
        .iter()
        .filter_map(|variant| Some((summary.name(variant), of(variant)[place]?)))
        .collect();
    (!rows.is_empty()).then_some(rows)
}
