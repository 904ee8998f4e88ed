//! Labelled truth: places that are known to be worth a visit. Runs are scored with it; no rover is told of it.

use wisdom_grid::{Cell, GridSpec};

/// A place that is known to be worth a visit, whatever any map says.
#[derive(Debug, Clone, PartialEq)]
pub struct Label {
    /// Its name.
    pub name: String,
    /// The cell.
    pub at: Cell,
    /// A goal within this distance of it has found it, metres.
    pub radius_m: f64,
    /// What finding it is worth.
    pub worth: f64,
}

/// Which label each goal of a run finds, by index, in the order in which the goals were reached; none for a goal that
/// finds nothing.
///
/// A goal finds the label of the largest worth of those whose radius it lies in and that no goal before it found; of
/// equal ones the nearest, then the one the mission names first. So no label counts twice in a run.
///
/// ```
/// use wisdom_grid::{Cell, GridSpec};
/// use wisdom_mission::{Label, labels_found};
///
/// let grid = GridSpec::new(10, 10, 2.0)?;
/// let label = Label { name: "vein".into(), at: Cell::new(5, 5), radius_m: 4.0, worth: 1.0 };
/// let goals = [Cell::new(0, 0), Cell::new(5, 7), Cell::new(5, 5)];
/// assert_eq!(labels_found(&[label], grid, &goals), [None, Some(0), None]);
/// # Ok::<(), wisdom_grid::GridError>(())
/// ```
#[must_use]
pub fn labels_found(labels: &[Label], grid: GridSpec, targets: &[Cell]) -> Vec<Option<usize>> {
    let mut found = vec![false; labels.len()];
    targets
        .iter()
        .map(|&target| {
            let off_m = |label: &Label| label.at.distance(target) * grid.spacing_m();
            let best = labels
                .iter()
                .enumerate()
                .filter(|(index, label)| !found[*index] && off_m(label) <= label.radius_m)
                .min_by(|(_, a), (_, b)| {
                    b.worth.total_cmp(&a.worth).then(off_m(a).total_cmp(&off_m(b)))
                })
                .map(|(index, _)| index)?;
            found[best] = true;
            Some(best)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn label(col: usize, worth: f64) -> Label {
        Label { name: format!("{col}"), at: Cell::new(0, col), radius_m: 3.0, worth }
    }

    #[test]
    fn the_dearest_label_in_reach_is_found_first_and_each_only_once() {
        let grid = GridSpec::new(1, 30, 1.0).unwrap();
        let labels = [label(10, 1.0), label(12, 2.0), label(14, 1.0), label(25, 1.0)];
        let goals = [11, 11, 13, 13, 20].map(|col| Cell::new(0, col));
        let found = labels_found(&labels, grid, &goals);
        assert_eq!(found, [Some(1), Some(0), Some(2), None, None]);
    }

    #[test]
    fn of_equal_labels_the_nearest_is_found() {
        let grid = GridSpec::new(1, 30, 0.5).unwrap();
        let labels = [label(10, 1.0), label(12, 1.0)];
        assert_eq!(labels_found(&labels, grid, &[Cell::new(0, 13)]), [Some(1)]);
        assert_eq!(labels_found(&labels, grid, &[Cell::new(0, 11)]), [Some(0)]);
        assert!(labels_found(&labels, grid, &[]).is_empty());
    }
}
