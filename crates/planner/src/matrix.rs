//! What it costs to drive between poses.

use rayon::prelude::*;
use wisdom_grid::Cell;

use crate::field::follow;
use crate::{CostVector, FieldOptions, Limits, Route, Traversability, field};

/// Costs and routes between poses, in both directions: climbing costs more than coming down.
///
/// An entry is a list of alternatives, none of them better than another in everything; empty if there is no way.
/// Today there is at most one, the most reliable.
#[derive(Debug, Clone, PartialEq)]
pub struct TravelMatrix {
    nodes: Vec<Cell>,
    entries: Vec<Vec<Entry>>,
}

/// Alternatives of one leg: costs, and the steps driven, a byte each.
#[derive(Debug, Clone, PartialEq, Default)]
struct Entry {
    costs: Vec<CostVector>,
    steps: Vec<Vec<u8>>,
}

/// Works out the travel between all pairs of poses, all threads at once; the result does not depend on how many.
///
/// `nodes[0]` is where the rover stands. `limits` bound every single leg, as in [`field()`]. A node in a blocked
/// cell is reached from nowhere but itself, though it can be left.
///
/// # Panics
/// If a node is not on the grid.
#[must_use]
pub fn travel_matrix(ground: &Traversability, nodes: &[Cell], limits: Limits) -> TravelMatrix {
    let options = FieldOptions { targets: Some(nodes), limits };
    let entries = nodes
        .par_iter()
        .map(|&source| {
            let field = field(ground, source, &options);
            let entry = |&target: &Cell| {
                let steps = field.steps(target)?;
                let cost = follow(ground, source, &steps).cost;
                Some(Entry { costs: vec![cost], steps: vec![steps] })
            };
            nodes.iter().map(|target| entry(target).unwrap_or_default()).collect()
        })
        .collect();
    TravelMatrix { nodes: nodes.to_vec(), entries }
}

impl TravelMatrix {
    /// The poses, in the caller's order.
    #[must_use]
    pub fn nodes(&self) -> &[Cell] {
        &self.nodes
    }

    /// Costs of the alternatives from one pose to another, by their indices; empty if there is no way.
    ///
    /// # Panics
    /// If there is no such pose, as a slice does.
    #[must_use]
    pub fn alternatives(&self, from: usize, to: usize) -> &[CostVector] {
        &self.entries[from][to].costs
    }

    /// The route of an alternative; none if there is no such alternative.
    ///
    /// # Panics
    /// If there is no such pose, as a slice does.
    #[must_use]
    pub fn route(&self, from: usize, to: usize, alternative: usize) -> Option<Route> {
        let entry = &self.entries[from][to];
        let (steps, cost) = (entry.steps.get(alternative)?, *entry.costs.get(alternative)?);
        let mut at = self.nodes[from];
        let cells = std::iter::once(at).chain(steps.iter().map(|&step| {
            at = stepped(at, step);
            at
        }));
        Some(Route { cells: cells.collect(), cost })
    }
}

fn stepped(cell: Cell, step: u8) -> Cell {
    let (row, col) = crate::traversability::STEPS[usize::from(step)];
    Cell::new(cell.row.wrapping_add_signed(row), cell.col.wrapping_add_signed(col))
}
