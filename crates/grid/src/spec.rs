//! Where a raster lies.

use crate::{Cell, Window, cell::NEIGHBOURS};

/// The longest side a raster may have, in cells: indices stay exact in every cast this workspace makes.
pub const MAX_SIDE: usize = 65_535;

/// Shape, spacing and place of a north-up raster with square cells.
///
/// `west_m` and `north_m` are the map coordinates of the outer north-west corner (not of the first cell's
/// centre), in metres of the raster's own projection. Cells are numbered from the `first` one, (0, 0) unless the grid
/// is a [part](GridSpec::part) of a larger one that keeps the larger one's numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GridSpec {
    spacing_m: f64,
    west_m: f64,
    north_m: f64,
    // As narrow as any ground allows: grids are copied everywhere, and sit in errors.
    rows: u32,
    cols: u32,
    first_row: u32,
    first_col: u32,
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
        Ok(Self {
            spacing_m,
            west_m: 0.0,
            north_m: rows as f64 * spacing_m,
            rows: rows as u32,
            cols: cols as u32,
            first_row: 0,
            first_col: 0,
        })
    }

    /// The same grid with its outer north-west corner at (`west_m`, `north_m`).
    #[must_use]
    pub fn at(self, west_m: f64, north_m: f64) -> Self {
        Self { west_m, north_m, ..self }
    }

    /// The same grid in the same place, its cells numbered from `first` on.
    ///
    /// # Panics
    /// If `first` lies beyond 2³² rows or columns, where no ground is.
    #[must_use]
    pub fn numbered_from(self, first: Cell) -> Self {
        let number = |at: usize| u32::try_from(at).expect("no ground has that many cells");
        Self { first_row: number(first.row), first_col: number(first.col), ..self }
    }

    /// The north-west cell: (0, 0) unless the grid is a [part](GridSpec::part).
    #[must_use]
    pub fn first(&self) -> Cell {
        Cell { row: self.first_row as usize, col: self.first_col as usize }
    }

    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows as usize
    }

    /// Number of columns.
    #[must_use]
    pub fn cols(&self) -> usize {
        self.cols as usize
    }

    /// Number of cells.
    #[must_use]
    pub fn len(&self) -> usize {
        self.rows() * self.cols()
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
            self.west_m + (cell.col as f64 - f64::from(self.first_col) + 0.5) * self.spacing_m,
            self.north_m - (cell.row as f64 - f64::from(self.first_row) + 0.5) * self.spacing_m,
        )
    }

    /// Whether the cell lies on the grid.
    #[must_use]
    pub fn contains(&self, cell: Cell) -> bool {
        // Before the first cell the difference wraps round to a huge number.
        cell.row.wrapping_sub(self.first_row as usize) < self.rows()
            && cell.col.wrapping_sub(self.first_col as usize) < self.cols()
    }

    /// Row-major index of a cell.
    #[must_use]
    pub fn index(&self, cell: Cell) -> usize {
        debug_assert!(self.contains(cell), "{cell} on {self:?}");
        (cell.row - self.first_row as usize) * self.cols() + (cell.col - self.first_col as usize)
    }

    /// The cell of a row-major index.
    #[must_use]
    pub fn cell(&self, index: usize) -> Cell {
        Cell {
            row: self.first_row as usize + index / self.cols(),
            col: self.first_col as usize + index % self.cols(),
        }
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
        self.window().cells()
    }

    /// The window that covers the whole grid.
    #[must_use]
    pub fn window(&self) -> Window {
        let Cell { row, col } = self.first();
        Window { row, col, rows: self.rows(), cols: self.cols() }
    }

    /// The window of all cells within `radius` cells (Chebyshev) of `centre`, cut at the edges; empty if they all
    /// lie beyond.
    #[must_use]
    pub fn around(&self, centre: Cell, radius: usize) -> Window {
        let cut = |middle: usize, first: usize, count: usize| {
            let from = middle.saturating_sub(radius).max(first);
            let to = middle.saturating_add(radius).saturating_add(1).min(first + count);
            (from, to.saturating_sub(from))
        };
        let (row, rows) = cut(centre.row, self.first_row as usize, self.rows());
        let (col, cols) = cut(centre.col, self.first_col as usize, self.cols());
        Window { row, col, rows, cols }
    }

    /// The grid of a window of this grid, at its own place, its cells numbered from (0, 0).
    ///
    /// # Errors
    /// [`GridError::OutsideGrid`] if the window reaches over the edge or is empty.
    pub fn sub(&self, window: Window) -> Result<Self, GridError> {
        Ok(self.part(window)?.numbered_from(Cell::new(0, 0)))
    }

    /// The grid of a window of this grid, at its own place, its cells numbered as they are here.
    ///
    /// ```
    /// # use wisdom_grid::{Cell, GridSpec, Window};
    /// let whole = GridSpec::new(100, 100, 1.0)?;
    /// let part = whole.part(Window { row: 40, col: 50, rows: 10, cols: 10 })?;
    /// let cell = Cell::new(42, 57);
    /// assert_eq!(part.centre_m(cell), whole.centre_m(cell));
    /// assert_eq!(part.index(cell), 27);
    /// # Ok::<(), wisdom_grid::GridError>(())
    /// ```
    ///
    /// # Errors
    /// [`GridError::OutsideGrid`] if the window reaches over the edge or is empty.
    pub fn part(&self, window: Window) -> Result<Self, GridError> {
        let Window { row, col, rows, cols } = window;
        let first = self.first();
        if window.is_empty()
            || row < first.row
            || col < first.col
            || (row - first.row).saturating_add(rows) > self.rows()
            || (col - first.col).saturating_add(cols) > self.cols()
        {
            let (rows, cols) = (self.rows(), self.cols());
            return Err(GridError::OutsideGrid { window, rows, cols });
        }
        Ok(Self {
            spacing_m: self.spacing_m,
            west_m: self.west_m + (col - first.col) as f64 * self.spacing_m,
            north_m: self.north_m - (row - first.row) as f64 * self.spacing_m,
            rows: rows as u32,
            cols: cols as u32,
            first_row: row as u32,
            first_col: col as u32,
        })
    }
}
