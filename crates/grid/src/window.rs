//! Rectangles of cells.

use std::fmt;

use crate::Cell;

/// A rectangle of cells: its north-west cell and its shape.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Window {
    /// First row.
    pub row: usize,
    /// First column.
    pub col: usize,
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub cols: usize,
}

impl Window {
    /// Whether no cell lies inside.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.rows == 0 || self.cols == 0
    }

    /// Whether the cell lies inside.
    #[must_use]
    pub fn contains(&self, cell: Cell) -> bool {
        cell.row >= self.row
            && cell.col >= self.col
            && cell.row < self.row + self.rows
            && cell.col < self.col + self.cols
    }

    /// Every cell, row by row.
    pub fn cells(&self) -> impl Iterator<Item = Cell> + use<> {
        let Window { row, col, rows, cols } = *self;
        (row..row + rows).flat_map(move |row| (col..col + cols).map(move |col| Cell { row, col }))
    }

    /// The smallest window that holds both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        let (row, col) = (self.row.min(other.row), self.col.min(other.col));
        Window {
            row,
            col,
            rows: (self.row + self.rows).max(other.row + other.rows) - row,
            cols: (self.col + self.cols).max(other.col + other.cols) - col,
        }
    }

    /// The cells that do not lie in the other: up to four windows that do not overlap, from north to south and west to
    /// east.
    #[must_use]
    pub fn minus(self, other: Self) -> Vec<Self> {
        let Some(cut) = self.intersection(other) else { return vec![self] };
        let (south, east) = (cut.row + cut.rows, cut.col + cut.cols);
        let parts = [
            Window { rows: cut.row - self.row, ..self },
            Window { row: cut.row, rows: cut.rows, cols: cut.col - self.col, ..self },
            Window { col: east, cols: self.col + self.cols - east, ..cut },
            Window { row: south, rows: self.row + self.rows - south, ..self },
        ];
        parts.into_iter().filter(|part| !part.is_empty()).collect()
    }

    /// The cells that lie in both, if any.
    #[must_use]
    pub fn intersection(self, other: Self) -> Option<Self> {
        let (row, col) = (self.row.max(other.row), self.col.max(other.col));
        let (south, east) = (
            (self.row + self.rows).min(other.row + other.rows),
            (self.col + self.cols).min(other.col + other.cols),
        );
        (south > row && east > col).then(|| Window {
            row,
            col,
            rows: south - row,
            cols: east - col,
        })
    }
}

impl fmt::Display for Window {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "window of {} x {} cells at (row {}, col {})",
            self.rows, self.cols, self.row, self.col
        )
    }
}
