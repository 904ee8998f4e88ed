//! Many runs of the same worlds: one mission under several rules and seeds, and how their goal sequences
//! differ.

mod plan;
mod row;
mod table;

use rayon::prelude::*;
use wisdom_goals::Action;
use wisdom_grid::Cell;

use crate::{Memory, Mission, RunError, RunSummary, run};

pub use plan::{CampaignError, Case, MAX_RUNS, MAX_SEED, Plan, Variant};
pub use row::{GoalRow, LegRow, ROW_VERSION, Row, RowResult, RunRow};
pub use table::{METRICS, Metric, PairedTable, table};

/// One finished run.
#[derive(Debug, Clone)]
pub struct CampaignRun {
    /// The mission it ran.
    pub mission: Mission,
    /// What it came to.
    pub summary: RunSummary,
    /// Its decisions and outcomes.
    pub record: Memory,
}

/// Runs every mission to its end, in parallel; the results are in the missions' order and do not depend on
/// the number of threads.
///
/// `done` is told the index of each run that ends, in whatever order they end.
///
/// # Errors
/// The first [`RunError`], in the missions' order.
pub fn run_all(
    missions: Vec<Mission>,
    done: impl Fn(usize) + Sync,
) -> Result<Vec<CampaignRun>, RunError> {
    missions
        .into_par_iter()
        .enumerate()
        .map(|(index, mission)| {
            let mut record = Memory::default();
            let summary = run(&mission, &mut record, &mut |_| true)?;
            done(index);
            Ok(CampaignRun { mission, summary, record })
        })
        .collect::<Vec<_>>()
        .into_iter()
        .collect()
}

/// Goal sequences of several runs over one set of places.
///
/// Goals of different runs are the same place if their targets lie within a radius of each other; a place is
/// numbered when a run first reaches it, runs in order.
#[derive(Debug, Clone, PartialEq)]
pub struct Places {
    /// Where each place is: the target of the first goal reached there.
    pub places: Vec<Cell>,
    /// For each run, the places it reached, in order.
    pub sequences: Vec<Vec<usize>>,
}

impl Places {
    /// Finds the places that some runs reached.
    #[must_use]
    pub fn of(runs: &[&CampaignRun]) -> Self {
        let told: Vec<(f64, Vec<Cell>)> = runs
            .iter()
            .map(|run| {
                let spec = &run.mission.spec;
                let radius_cells = spec.manager.identity_radius_m / spec.grid.spacing_m();
                (radius_cells, run.summary.achieved.iter().map(|goal| goal.target).collect())
            })
            .collect();
        Self::among(&told)
    }

    /// Finds the places of some sequences of targets, each with the radius in cells within which its targets are the
    /// same place.
    ///
    /// ```
    /// use wisdom_grid::Cell;
    /// use wisdom_mission::Places;
    ///
    /// let runs = [(3.0, vec![Cell::new(0, 0), Cell::new(9, 9)]), (3.0, vec![Cell::new(9, 8)])];
    /// assert_eq!(Places::among(&runs).sequences, [vec![0, 1], vec![1]]);
    /// ```
    #[must_use]
    pub fn among(runs: &[(f64, Vec<Cell>)]) -> Self {
        let mut places: Vec<Cell> = Vec::new();
        let sequences = runs
            .iter()
            .map(|(radius_cells, targets)| {
                let mut sequence = Vec::new();
                for &target in targets {
                    let near =
                        |(_, place): &(usize, &Cell)| place.distance(target) <= *radius_cells;
                    let nearest = places.iter().enumerate().filter(near).min_by(|a, b| {
                        a.1.distance(target).total_cmp(&b.1.distance(target)).then(a.0.cmp(&b.0))
                    });
                    let known = nearest.map(|(index, _)| index);
                    let place = known.unwrap_or_else(|| {
                        places.push(target);
                        places.len() - 1
                    });
                    sequence.push(place);
                }
                sequence
            })
            .collect();
        Self { places, sequences }
    }
}

/// Size of the intersection over the size of the union of two sequences' sets; 1 if both are empty.
#[must_use]
pub fn jaccard(a: &[usize], b: &[usize]) -> f64 {
    let set = |s: &[usize]| s.iter().copied().collect::<std::collections::BTreeSet<_>>();
    let (a, b) = (set(a), set(b));
    let union = a.union(&b).count();
    if union == 0 { 1.0 } else { a.intersection(&b).count() as f64 / union as f64 }
}

/// Kendall's tau over the items that both sequences hold (first visits): concordant less discordant pairs
/// over all pairs; none with fewer than two items in common (Kendall 1938).
#[must_use]
pub fn kendall_tau(a: &[usize], b: &[usize]) -> Option<f64> {
    let turn = |s: &[usize], item: usize| s.iter().position(|x| *x == item);
    let mut common: Vec<(usize, usize)> = Vec::new();
    for &item in a {
        if let (Some(i), Some(j)) = (turn(a, item), turn(b, item))
            && !common.contains(&(i, j))
        {
            common.push((i, j));
        }
    }
    let (mut agree, mut pairs) = (0i64, 0i64);
    for (k, x) in common.iter().enumerate() {
        for y in &common[k + 1..] {
            pairs += 1;
            agree += if (x.0 < y.0) == (x.1 < y.1) { 1 } else { -1 };
        }
    }
    (pairs > 0).then(|| agree as f64 / pairs as f64)
}

/// The turn (from 0) at which two sequences first differ; none if they are equal.
#[must_use]
pub fn first_difference(a: &[usize], b: &[usize]) -> Option<usize> {
    (0..a.len().max(b.len())).find(|&i| a.get(i) != b.get(i))
}

/// The first decision at which two runs chose differently: another act, or another order of targets; none if
/// all decisions that both took agree.
#[must_use]
pub fn first_divergent_decision(a: &Memory, b: &Memory) -> Option<u32> {
    let choice = |memory: &Memory, n: usize| {
        let decision = &memory.decisions[n];
        let mut order: Vec<(usize, Cell)> = decision
            .verdicts
            .iter()
            .filter(|v| v.action != Action::Achieve && v.action != Action::Drop)
            .filter_map(|v| v.turn.map(|turn| (turn, v.goal.target)))
            .collect();
        order.sort_unstable();
        (decision.act.name(), order)
    };
    let both = a.decisions.len().min(b.decisions.len());
    let differs = (0..both).find(|&n| choice(a, n) != choice(b, n));
    let unequal = a.decisions.len() != b.decisions.len();
    differs.or_else(|| unequal.then_some(both)).map(|n| n as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sequences_are_compared_by_set_order_and_first_difference() {
        let (a, b) = ([0, 1, 2, 3], [0, 2, 1, 4]);
        assert!((jaccard(&a, &b) - 3.0 / 5.0).abs() < 1e-12);
        // Pairs 0-1, 0-2 agree, 1-2 does not.
        assert!((kendall_tau(&a, &b).unwrap() - 1.0 / 3.0).abs() < 1e-12);
        assert_eq!(first_difference(&a, &b), Some(1));
        assert_eq!(first_difference(&a, &a), None);
        assert_eq!(first_difference(&a, &a[..2]), Some(2));
        assert_eq!(kendall_tau(&[1], &[1]), None);
        assert_eq!(kendall_tau(&[3, 2, 1], &[1, 2, 3]), Some(-1.0));
        assert_eq!(jaccard(&[], &[]), 1.0);
    }
}
