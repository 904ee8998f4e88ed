//! One cell of a grid.

use std::fmt;

/// A cell, counted from the north-west corner: `row` grows to the south, `col` to the east.
///
/// Cells order row by row, which is the order in which ties are broken everywhere.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct Cell {
    /// Row, 0 in the north.
    pub row: usize,
    /// Column, 0 in the west.
    pub col: usize,
}

/// Row and column steps to the eight neighbours of a cell, north first, clockwise.
pub const NEIGHBOURS: [(isize, isize); 8] =
    [(-1, 0), (-1, 1), (0, 1), (1, 1), (1, 0), (1, -1), (0, -1), (-1, -1)];

impl Cell {
    /// A cell at `row`, `col`.
    #[must_use]
    pub const fn new(row: usize, col: usize) -> Self {
        Self { row, col }
    }

    /// Distance between the centres of two cells, in cells.
    #[must_use]
    pub fn distance(self, other: Self) -> f64 {
        let (rows, cols) =
            (self.row.abs_diff(other.row) as f64, self.col.abs_diff(other.col) as f64);
        (rows * rows + cols * cols).sqrt()
    }

    /// Whether `other` is one of the eight neighbours.
    #[must_use]
    pub fn touches(self, other: Self) -> bool {
        self != other && self.row.abs_diff(other.row) <= 1 && self.col.abs_diff(other.col) <= 1
    }
}

impl fmt::Display for Cell {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "(row {}, col {})", self.row, self.col)
    }
}
