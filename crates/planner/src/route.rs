//! A way over the ground.

use wisdom_grid::Cell;

use crate::CostVector;

/// A chain of neighbouring cells and what it costs to drive.
#[derive(Debug, Clone, PartialEq)]
pub struct Route {
    /// The cells driven, start and end included; one cell if the two are the same.
    pub cells: Vec<Cell>,
    /// The sum over the edges, first to last.
    pub cost: CostVector,
}
