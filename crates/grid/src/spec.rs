//! Where a raster lies.

use crate::{Cell, Window, cell::NEIGHBOURS};

/// The longest side a raster may have, in cells: indices stay exact in every cast this workspace makes.
pub const MAX_SIDE: usize = 65_535;

/// Shape, spacing and place of a north-up raster with square cells.
///
/// `west_m` and `north_m` are the map coordinates of the outer north-west corner (not of the first cell's
/// centre), in metres of the raster's own projection.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GridSpec {
    rows: usize,
    cols: usize,
    spacing_m: f64,
    west_m: f64,
    north_m: f64,
}

/// Why some numbers are not a grid, or two grids do not fit.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GridError {
    /// A side is zero or too long.
    #[error("a grid of {rows} x {cols} cells; each side must be 1 to {MAX_SIDE}")]
    Shape {
        /// Rows asked for.
        rows: usize,
        /// Columns asked for.
        cols: usize,
    },
    /// The spacing is not a positive number.
    #[error("cell spacing {spacing_m} m; it must be a positive number")]
    Spacing {
        /// Spacing asked for.
        spacing_m: f64,
    },
    /// The number of values is not rows × cols.
    #[error("{values} values for a grid of {rows} x {cols} cells")]
    Length {
        /// Values given.
        values: usize,
        /// Rows of the grid.
        rows: usize,
        /// Columns of the grid.
        cols: usize,
    },
    /// A window reaches over the edge.
    #[error("{window} does not lie inside a grid of {rows} x {cols} cells")]
    OutsideGrid {
        /// The window asked for.
        window: Window,
        /// Rows of the grid.
        rows: usize,
        /// Columns of the grid.
        cols: usize,
    },
}

impl GridSpec {
    /// A grid of `rows` × `cols` cells of side `spacing_m`, its south-west corner at the origin.
    ///
    /// # Errors
    /// [`GridError::Shape`] or [`GridError::Spacing`] if a side or the spacing is out of range.
    pub fn new(rows: usize, cols: usize, spacing_m: f64) -> Result<Self, GridError> {
        if rows == 0 || cols == 0 || rows > MAX_SIDE || cols > MAX_SIDE {
            return Err(GridError::Shape { rows, cols });
        }
        if !(spacing_m.is_finite() && spacing_m > 0.0) {
            return Err(GridError::Spacing { spacing_m });
        }
        Ok(Self { rows, cols, spacing_m, west_m: 0.0, north_m: rows as f64 * spacing_m })
    }

    /// The same grid with its outer north-west corner at (`west_m`, `north_m`).
    #[must_use]
    pub fn at(self, west_m: f64, north_m: f64) -> Self {
        Self { west_m, north_m, ..self }
    }

    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    #[must_use]
    pub fn cols(&self) -> usize {
        self.cols
    }

    /// Number of cells.
    #[must_use]
    pub fn len(&self) -> usize {
        self.rows * self.cols
    }

    /// Never true: a grid has at least one cell. Here because `len` is.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Side of a cell in metres.
    #[must_use]
    pub fn spacing_m(&self) -> f64 {
        self.spacing_m
    }

    /// Map coordinate of the outer west edge, metres.
    #[must_use]
    pub fn west_m(&self) -> f64 {
        self.west_m
    }

    /// Map coordinate of the outer north edge, metres.
    #[must_use]
    pub fn north_m(&self) -> f64 {
        self.north_m
    }

    /// Map coordinates (x east, y north) of a cell's centre, metres.
    #[must_use]
    pub fn centre_m(&self, cell: Cell) -> (f64, f64) {
        (
            self.west_m + (cell.col as f64 + 0.5) * self.spacing_m,
            self.north_m - (cell.row as f64 + 0.5) * self.spacing_m,
        )
    }

    /// Whether the cell lies on the grid.
    #[must_use]
    pub fn contains(&self, cell: Cell) -> bool {
        cell.row < self.rows && cell.col < self.cols
    }

    /// Row-major index of a cell.
    #[must_use]
    pub fn index(&self, cell: Cell) -> usize {
        debug_assert!(self.contains(cell), "{cell} on {} x {}", self.rows, self.cols);
        cell.row * self.cols + cell.col
    }

    /// The cell of a row-major index.
    #[must_use]
    pub fn cell(&self, index: usize) -> Cell {
        Cell { row: index / self.cols, col: index % self.cols }
    }

    /// The cell `d_row`, `d_col` steps away, if it is on the grid.
    #[must_use]
    pub fn step(&self, cell: Cell, d_row: isize, d_col: isize) -> Option<Cell> {
        let to = Cell {
            row: cell.row.checked_add_signed(d_row)?,
            col: cell.col.checked_add_signed(d_col)?,
        };
        self.contains(to).then_some(to)
    }

    /// The neighbours of a cell that are on the grid, north first, clockwise.
    pub fn neighbours(&self, cell: Cell) -> impl Iterator<Item = Cell> + '_ {
        NEIGHBOURS.iter().filter_map(move |&(d_row, d_col)| self.step(cell, d_row, d_col))
    }

    /// Every cell, row by row.
    pub fn cells(&self) -> impl Iterator<Item = Cell> + use<> {
        let (rows, cols) = (self.rows, self.cols);
        (0..rows).flat_map(move |row| (0..cols).map(move |col| Cell { row, col }))
    }

    /// The window that covers the whole grid.
    #[must_use]
    pub fn window(&self) -> Window {
        Window { row: 0, col: 0, rows: self.rows, cols: self.cols }
    }

    /// The window of all cells within `radius` cells (Chebyshev) of `centre`, cut at the edges.
    #[must_use]
    pub fn around(&self, centre: Cell, radius: usize) -> Window {
        let (row, col) = (centre.row.saturating_sub(radius), centre.col.saturating_sub(radius));
        Window {
            row,
            col,
            rows: (centre.row + radius + 1).min(self.rows) - row,
            cols: (centre.col + radius + 1).min(self.cols) - col,
        }
    }

    /// The grid of a window of this grid, at its own place.
    ///
    /// # Errors
    /// [`GridError::OutsideGrid`] if the window reaches over the edge or is empty.
    pub fn sub(&self, window: Window) -> Result<Self, GridError> {
        if window.rows == 0
            || window.cols == 0
            || window.row + window.rows > self.rows
            || window.col + window.cols > self.cols
        {
            return Err(GridError::OutsideGrid { window, rows: self.rows, cols: self.cols });
        }
        Ok(Self {
            rows: window.rows,
            cols: window.cols,
            spacing_m: self.spacing_m,
            west_m: self.west_m + window.col as f64 * self.spacing_m,
            north_m: self.north_m - window.row as f64 * self.spacing_m,
        })
    }
}
