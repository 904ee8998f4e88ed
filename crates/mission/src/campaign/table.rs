//! The numbers of a campaign, side by side: for each metric and variant one value a seed.

use std::collections::BTreeMap;

use crate::{Plan, Row, RunRow, Variant};

/// A number of a run that is compared over seeds.
#[derive(Debug, Clone, Copy)]
pub struct Metric {
    /// Its name, with its unit; the name of its column.
    pub name: &'static str,
    /// The number.
    pub of: fn(&RunRow) -> f64,
}

/// What campaigns compare.
pub const METRICS: [Metric; 11] = [
    Metric { name: "goals", of: |run| run.goals.len() as f64 },
    Metric { name: "interest_own_map", of: RunRow::interest },
    Metric { name: "interest_ruler", of: RunRow::ruler },
    Metric { name: "distance_m", of: |run| run.distance_m },
    Metric { name: "time_s", of: |run| run.time_s },
    Metric { name: "energy_j", of: |run| run.energy_j },
    Metric { name: "data_mb", of: |run| run.data_mb },
    Metric { name: "reliability", of: |run| run.reliability },
    Metric { name: "decisions", of: |run| f64::from(run.decisions) },
    Metric { name: "reallocations", of: |run| f64::from(run.reallocations) },
    Metric { name: "legs", of: |run| run.legs.len() as f64 },
];

/// The metrics of a campaign, paired: the n-th value of every variant is of the same world.
#[derive(Debug, Clone, PartialEq)]
pub struct PairedTable {
    /// The seeds of the worlds, in the campaign's order.
    pub seeds: Vec<u64>,
    /// The seeds left out because a run of theirs failed or is missing.
    pub left_out: Vec<u64>,
    /// What is compared; the first is what the others are held against.
    pub variants: Vec<Variant>,
    /// By metric (as in [`METRICS`]) and variant.
    values: Vec<Vec<Vec<f64>>>,
}

impl PairedTable {
    /// The values of a metric under a variant, one a seed, both by their place.
    ///
    /// # Panics
    /// If there is no such metric or variant.
    #[must_use]
    pub fn values(&self, metric: usize, variant: usize) -> &[f64] {
        &self.values[metric][variant]
    }
}

/// Pairs the rows of a campaign by seed; they may come in any order, and rows of other campaigns are passed over. A
/// seed counts if all its runs finished: a mean over other worlds than its neighbour's would compare the worlds.
#[must_use]
pub fn table(plan: &Plan, rows: &[Row]) -> PairedTable {
    let variants = plan.variants().to_vec();
    let runs: BTreeMap<usize, &RunRow> = rows
        .iter()
        .filter(|row| plan.case(row.index).is_some_and(|case| row.is_of(&case)))
        .filter_map(|row| Some((row.index, row.run()?)))
        .collect();
    let of_seed = |turn: usize| -> Option<Vec<&RunRow>> {
        (0..variants.len()).map(|v| runs.get(&(turn * variants.len() + v)).copied()).collect()
    };
    let (mut seeds, mut left_out) = (Vec::new(), Vec::new());
    let mut values = vec![vec![Vec::new(); variants.len()]; METRICS.len()];
    for (turn, &seed) in plan.seeds().iter().enumerate() {
        let Some(world) = of_seed(turn) else {
            left_out.push(seed);
            continue;
        };
        seeds.push(seed);
        for (metric, columns) in METRICS.iter().zip(&mut values) {
            for (run, column) in world.iter().zip(columns) {
                column.push((metric.of)(run));
            }
        }
    }
    PairedTable { seeds, left_out, variants, values }
}
