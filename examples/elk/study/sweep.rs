//! The sweep: one reading from 40 to 80 % silica, under rules, prizes and policies.

use std::path::Path;

use rayon::prelude::*;
use wisdom_belief::Rule;
use wisdom_fusion::{Expert, Rows};
use wisdom_goals::{Policy, PrizeScale};
use wisdom_mission::{Mission, Override};

use super::fate::{Fate, Spot, Until, fate};

/// What is swept, per cent silica.
pub(crate) const RANGE: (f64, f64) = (40.0, 80.0);

/// Thresholds are found to this, per cent silica.
const TOLERANCE: f64 = 0.1;

/// Later than any mission ends: the reading is never handed in.
const NEVER_S: &str = "1e12";

/// Where the rover is when the mission begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Condition {
    /// Short name.
    pub(crate) name: &'static str,
    /// What it is.
    pub(crate) about: &'static str,
    /// What it changes in the mission.
    changes: &'static [(&'static str, &'static str)],
}

/// The mission as it ships, and the same from further on.
pub(crate) const CONDITIONS: [Condition; 2] = [
    Condition {
        name: "sol-992",
        about: "the mission as it ships, from the stop of sol 992",
        changes: &[],
    },
    Condition {
        name: "sol-997",
        about: "from the stop of sol 997 in the south, where Curiosity stood until sol 1030",
        changes: &[("rover.start", "[256, 160]"), ("rover.heading-deg", "140.5")],
    },
];

/// One way of deciding.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Way {
    /// Where the rover starts.
    pub(crate) condition: Condition,
    /// Rule of combination.
    pub(crate) rule: Rule,
    /// How interest becomes a prize.
    pub(crate) prize: PrizeScale,
    /// Objective.
    pub(crate) policy: Policy,
}

/// From which value on the plan holds a goal at the place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Threshold {
    /// At no value.
    Never,
    /// At every value, and without the reading too.
    Always,
    /// At every value, and not without the reading.
    Any,
    /// From between these two values on, which the bisection left.
    Between(f64, f64),
    /// From this edge of the expert's table on, the only place between two bands where anything can change.
    Edge(f64),
    /// At some values and again not at higher ones.
    NotMonotone,
}

/// How a threshold between two bands is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Search {
    /// It is the edge between them.
    Edges,
    /// By runs, without being told of the edges.
    Bisection,
}

/// What one way of deciding makes of the reading.
#[derive(Debug, Clone)]
pub(crate) struct Answer {
    /// The way.
    pub(crate) way: Way,
    /// Without the reading.
    pub(crate) control: Fate,
    /// With it, one value for each band of the expert's table, rising.
    pub(crate) at: Vec<(f64, Fate)>,
    /// From which value on.
    pub(crate) threshold: Threshold,
}

/// Values from the first to the second that share a fate.
pub(crate) type Stretch = (f64, f64, Fate);

/// The sweep and what it is run on.
pub(crate) struct Sweep<'a> {
    /// The mission's folder.
    pub(crate) folder: &'a Path,
    /// The place of the reading.
    pub(crate) spot: Spot,
    /// Where the answer can change: the ends of the expert's bands inside the range.
    pub(crate) edges: Vec<f64>,
}

impl<'a> Sweep<'a> {
    /// The sweep of a mission's first reading.
    pub(crate) fn new(folder: &'a Path) -> anyhow::Result<Self> {
        let mission = Mission::load(folder, &[])?;
        let none = || anyhow::anyhow!("{}: no reading is handed in", folder.display());
        let spot = Spot::of(&mission).ok_or_else(none)?;
        let layer = &mission.world.execution().readings[0].layer;
        let experts = mission.spec.experts.iter().filter(|expert| expert.layer == *layer);
        Ok(Self { folder, spot, edges: edges(experts) })
    }

    /// The middle of every stretch of the range that the expert's table tells nothing apart in.
    pub(crate) fn middles(&self) -> Vec<f64> {
        let mut ends = vec![RANGE.0];
        ends.extend(&self.edges);
        ends.push(RANGE.1);
        ends.windows(2).map(|pair| f64::midpoint(pair[0], pair[1])).collect()
    }

    /// The mission of one way with one value, or without the reading.
    pub(crate) fn mission(&self, way: &Way, value: Option<f64>) -> anyhow::Result<Mission> {
        let mut changes: Vec<Override> =
            way.condition.changes.iter().map(|(key, value)| Override::new(*key, *value)).collect();
        changes.push(Override::new("rule", way.rule.to_string()));
        changes.push(Override::new("prize", way.prize.to_string()));
        changes.push(Override::new("policy", way.policy.to_string()));
        changes.push(match value {
            Some(value) => Override::new("reading.0.value", format!("{value:?}")),
            None => Override::new("reading.0.at-s", NEVER_S),
        });
        Ok(Mission::load(self.folder, &changes)?)
    }

    /// What becomes of the place in a run of one way, with a value or without the reading.
    pub(crate) fn fate(&self, way: &Way, value: Option<f64>, until: Until) -> anyhow::Result<Fate> {
        Ok(fate(&self.mission(way, value)?, &self.spot, until)?)
    }

    /// What one way makes of the reading. The threshold is an edge of the table, or found by bisection.
    pub(crate) fn answer(&self, way: &Way, search: Search) -> anyhow::Result<Answer> {
        let values: Vec<Option<f64>> =
            std::iter::once(None).chain(self.middles().into_iter().map(Some)).collect();
        let mut fates: Vec<Fate> = values
            .par_iter()
            .map(|value| self.fate(way, *value, Until::Done))
            .collect::<anyhow::Result<_>>()?;
        let control = fates.remove(0);
        let at: Vec<(f64, Fate)> = self.middles().into_iter().zip(fates).collect();
        let threshold = self.threshold(way, &control, &at, search)?;
        Ok(Answer { way: *way, control, at, threshold })
    }

    fn threshold(
        &self,
        way: &Way,
        control: &Fate,
        at: &[(f64, Fate)],
        search: Search,
    ) -> anyhow::Result<Threshold> {
        let planned: Vec<bool> = at.iter().map(|(_, fate)| fate.turn().is_some()).collect();
        let Some(first) = planned.iter().position(|planned| *planned) else {
            return Ok(Threshold::Never);
        };
        if planned[first..].iter().any(|planned| !planned) {
            return Ok(Threshold::NotMonotone);
        }
        if first == 0 {
            let anyway = control.turn().is_some();
            return Ok(if anyway { Threshold::Always } else { Threshold::Any });
        }
        if search == Search::Edges {
            return Ok(Threshold::Edge(self.edges[first - 1]));
        }
        let (mut low, mut high) = (at[first - 1].0, at[first].0);
        while high - low > TOLERANCE {
            let middle = f64::midpoint(low, high);
            match self.fate(way, Some(middle), Until::Decision)?.turn() {
                Some(_) => high = middle,
                None => low = middle,
            }
        }
        Ok(Threshold::Between(low, high))
    }

    /// The first decision with the reading, from one end of the range to the other by steps: values in a row with the
    /// same fate.
    pub(crate) fn stretches(&self, way: &Way, step: f64) -> anyhow::Result<Vec<Stretch>> {
        let steps = ((RANGE.1 - RANGE.0) / step) as u32;
        let values: Vec<f64> = (0..=steps).map(|n| RANGE.0 + f64::from(n) * step).collect();
        let fates: Vec<Fate> = values
            .par_iter()
            .map(|value| self.fate(way, Some(*value), Until::Decision))
            .collect::<anyhow::Result<_>>()?;
        let mut stretches: Vec<Stretch> = Vec::new();
        for (value, fate) in values.into_iter().zip(fates) {
            match stretches.last_mut() {
                Some((_, last, same)) if *same == fate => *last = value,
                _ => stretches.push((value, value, fate)),
            }
        }
        Ok(stretches)
    }
}

/// The ends of bands inside the range, rising.
fn edges<'e>(experts: impl Iterator<Item = &'e Expert>) -> Vec<f64> {
    let ends = |expert: &Expert| match expert.table.rows() {
        Rows::Bands(bands) => bands.iter().flat_map(|band| [band.lo, band.hi]).collect(),
        Rows::Classes(_) => Vec::new(),
    };
    let mut edges: Vec<f64> = experts.flat_map(ends).collect();
    edges.retain(|edge| (RANGE.0..RANGE.1).contains(edge) && *edge > RANGE.0);
    edges.sort_by(f64::total_cmp);
    edges.dedup();
    edges
}
