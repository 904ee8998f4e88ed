//! What every sequence is worth by every measure, and what was missed.

use wisdom_grid::{Cell, Raster};

/// What the places of several runs are worth by one measure.
#[derive(Debug, Clone, PartialEq)]
pub struct Measure {
    /// What it is called.
    pub name: String,
    /// For each run the sum over its goals; none where the measure does not reach.
    pub totals: Vec<Option<f64>>,
}

impl Measure {
    /// What a run misses by it: the largest total less its own. None where its own is unknown.
    #[must_use]
    pub fn regret(&self, run: usize) -> Option<f64> {
        let best = self.totals.iter().flatten().copied().max_by(f64::total_cmp)?;
        Some(best - (*self.totals.get(run)?)?)
    }
}

/// Sequences of several runs held against several measures: the maps each run ended with, the common ruler, labels.
///
/// By its own map every run looks well; that is what the other columns are for. Regret here is hindsight over the runs
/// at hand (Savage 1951): none of them need be the best there is.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RegretMatrix {
    /// The runs: its rows.
    pub runs: Vec<String>,
    /// Its columns.
    pub measures: Vec<Measure>,
}

impl RegretMatrix {
    /// A matrix of some measures of some runs.
    ///
    /// # Panics
    /// If a measure has another number of totals than there are runs.
    #[must_use]
    pub fn new(runs: Vec<String>, measures: Vec<Measure>) -> Self {
        for measure in &measures {
            assert_eq!(measure.totals.len(), runs.len(), "{} has a total a run", measure.name);
        }
        Self { runs, measures }
    }

    /// A run's total by a measure, both by their place; none where the measure does not reach.
    #[must_use]
    pub fn total(&self, run: usize, measure: usize) -> Option<f64> {
        self.measures.get(measure)?.totals.get(run).copied()?
    }

    /// What a run misses by a measure, both by their place.
    #[must_use]
    pub fn regret(&self, run: usize, measure: usize) -> Option<f64> {
        self.measures.get(measure)?.regret(run)
    }
}

/// The sum of a map's values at some targets, as often as each is there; none if one lies off the map.
#[must_use]
pub fn worth_on(map: &Raster<f32>, targets: &[Cell]) -> Option<f64> {
    targets.iter().try_fold(0.0, |sum, target| Some(sum + f64::from(*map.get(*target)?)))
}

#[cfg(test)]
mod tests {
    use wisdom_grid::GridSpec;

    use super::*;

    #[test]
    fn regret_is_what_the_best_run_has_more() {
        let measure =
            |totals: &[Option<f64>]| Measure { name: "m".into(), totals: totals.to_vec() };
        let runs = vec!["a".to_owned(), "b".to_owned(), "c".to_owned()];
        let measures = vec![
            measure(&[Some(2.0), Some(3.5), None]),
            measure(&[Some(1.0), Some(0.5), Some(1.0)]),
        ];
        let matrix = RegretMatrix::new(runs, measures);
        assert_eq!(matrix.regret(0, 0), Some(1.5));
        assert_eq!(matrix.regret(1, 0), Some(0.0));
        assert_eq!(matrix.regret(2, 0), None);
        assert_eq!((matrix.regret(1, 1), matrix.regret(2, 1)), (Some(0.5), Some(0.0)));
        assert_eq!((matrix.total(1, 1), matrix.total(9, 1)), (Some(0.5), None));
    }

    #[test]
    fn a_target_off_the_map_makes_its_sum_unknown() {
        let map =
            Raster::from_fn(GridSpec::new(2, 2, 1.0).unwrap(), |c| (c.row + 2 * c.col) as f32);
        let (a, b, off) = (Cell::new(0, 1), Cell::new(1, 1), Cell::new(2, 0));
        assert_eq!(worth_on(&map, &[a, b, b]), Some(8.0));
        assert_eq!(worth_on(&map, &[]), Some(0.0));
        assert_eq!(worth_on(&map, &[a, off]), None);
    }
}
