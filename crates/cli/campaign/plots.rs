//! The summary's plots.

use std::path::Path;

use wisdom_mission::METRICS;
use wisdom_mission::statistics::Interval;

use super::summary::{Of, Summary};
use crate::chart::{Drawing, Intervals, ReliabilityDiagram};

/// What is plotted: the metric, the plot's title, its axis.
const PLOTTED: [(&str, &str, &str); 3] = [
    ("interest_ruler", "Interest gained, on the common ruler", "interest on the ruler"),
    ("goals", "Goals achieved", "goals"),
    ("distance_m", "Way driven", "distance, m"),
];

/// Draws the summary into a folder: a plot of means a metric, one of differences where there is something to differ
/// from, and the reliability diagram of all legs. What there are no numbers for is not drawn.
pub(super) fn draw(folder: &Path, summary: &Summary) -> anyhow::Result<()> {
    for (metric, title, quantity) in PLOTTED {
        if let Some(drawing) = means(summary, metric, title, quantity) {
            drawing.write(folder, metric)?;
        }
        if let Some(drawing) = differences(summary, metric, title, quantity) {
            drawing.write(folder, &format!("{metric}_less_first"))?;
        }
    }
    if let Some(drawing) = reliability(summary) {
        drawing.write(folder, "reliability")?;
    }
    Ok(())
}

fn means(summary: &Summary, metric: &str, title: &str, quantity: &str) -> Option<Drawing> {
    let rows = rows(summary, metric, |of| &of.means)?;
    let remarks = [summary.worlds()];
    let chart = Intervals { title, remarks: &remarks, quantity, rows: &rows, zero_line: false };
    Some(chart.drawing())
}

fn differences(summary: &Summary, metric: &str, title: &str, quantity: &str) -> Option<Drawing> {
    let rows = rows(summary, metric, |of| &of.differences)?;
    let title = format!("{title}: less {}", summary.name(&summary.variants[0]));
    let quantity = format!("{quantity}: difference");
    let chart = Intervals {
        title: &title,
        remarks: &[summary.worlds()],
        quantity: &quantity,
        rows: &rows,
        zero_line: true,
    };
    Some(chart.drawing())
}

fn reliability(summary: &Summary) -> Option<Drawing> {
    let calibration = summary.legs.as_ref()?;
    let brier = calibration.brier;
    let remarks = [
        format!("{}: legs that ended by themselves, all runs", summary.mission),
        format!("Brier score {:.4}; {:.4} if every word were kept", brier.score, brier.expected),
    ];
    let chart = ReliabilityDiagram {
        title: "Leg reliability: predicted and observed",
        remarks: &remarks,
        predicted: "predicted reliability",
        observed: "share that arrived",
        counted: "legs",
        calibration,
    };
    Some(chart.drawing())
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
