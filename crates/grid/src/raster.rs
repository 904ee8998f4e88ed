//! A grid filled with values.

use std::ops::{Index, IndexMut};

use rayon::prelude::*;

use crate::{Cell, GridError, GridSpec, Window};

/// A value for each cell of a grid, row-major, north-west first.
#[derive(Debug, Clone, PartialEq)]
pub struct Raster<T> {
    spec: GridSpec,
    values: Vec<T>,
}

impl<T> Raster<T> {
    /// A raster from its values, row by row.
    ///
    /// # Errors
    /// [`GridError::Length`] if there are not rows × cols of them.
    pub fn from_vec(spec: GridSpec, values: Vec<T>) -> Result<Self, GridError> {
        if values.len() != spec.len() {
            return Err(GridError::Length {
                values: values.len(),
                rows: spec.rows(),
                cols: spec.cols(),
            });
        }
        Ok(Self { spec, values })
    }

    /// A raster computed cell by cell, in row order.
    pub fn from_fn(spec: GridSpec, f: impl FnMut(Cell) -> T) -> Self {
        Self { spec, values: spec.cells().map(f).collect() }
    }

    /// A raster computed cell by cell on all threads; the result does not depend on how many there are.
    pub fn par_from_fn(spec: GridSpec, f: impl Fn(Cell) -> T + Sync) -> Self
    where
        T: Send,
    {
        let values =
            (0..spec.len()).into_par_iter().with_min_len(4096).map(|i| f(spec.cell(i))).collect();
        Self { spec, values }
    }

    /// Where the raster lies.
    #[must_use]
    pub fn spec(&self) -> GridSpec {
        self.spec
    }

    /// All values, row by row.
    #[must_use]
    pub fn values(&self) -> &[T] {
        &self.values
    }

    /// The values alone, row by row.
    #[must_use]
    pub fn into_values(self) -> Vec<T> {
        self.values
    }

    /// All values, row by row, to be changed.
    pub fn values_mut(&mut self) -> &mut [T] {
        &mut self.values
    }

    /// The values of one row, west first, by the row's number.
    #[must_use]
    pub fn row(&self, row: usize) -> &[T] {
        let row = row - self.spec.first().row;
        &self.values[row * self.spec.cols()..(row + 1) * self.spec.cols()]
    }

    /// The same values in the same place, the cells numbered from `first` on.
    #[must_use]
    pub fn numbered_from(self, first: Cell) -> Self {
        Self { spec: self.spec.numbered_from(first), values: self.values }
    }

    /// The value at a cell, if the cell is on the grid.
    #[must_use]
    pub fn get(&self, cell: Cell) -> Option<&T> {
        self.spec.contains(cell).then(|| &self.values[self.spec.index(cell)])
    }

    /// A raster of the same place, each value mapped.
    pub fn map<U>(&self, f: impl FnMut(&T) -> U) -> Raster<U> {
        Raster { spec: self.spec, values: self.values.iter().map(f).collect() }
    }

    /// Cells and values, row by row.
    pub fn iter(&self) -> impl Iterator<Item = (Cell, &T)> {
        self.spec.cells().zip(&self.values)
    }
}

impl<T: Clone> Raster<T> {
    /// A raster with one value everywhere.
    pub fn filled(spec: GridSpec, value: T) -> Self {
        Self { spec, values: vec![value; spec.len()] }
    }

    /// A copy of the cells inside a window, numbered from (0, 0).
    ///
    /// # Errors
    /// [`GridError::OutsideGrid`] if the window reaches over the edge or is empty.
    pub fn crop(&self, window: Window) -> Result<Self, GridError> {
        let spec = self.spec.sub(window)?;
        let mut values = Vec::with_capacity(spec.len());
        let west = window.col - self.spec.first().col;
        for row in window.row..window.row + window.rows {
            values.extend_from_slice(&self.row(row)[west..west + window.cols]);
        }
        Ok(Self { spec, values })
    }
}

impl<T> Index<Cell> for Raster<T> {
    type Output = T;

    fn index(&self, cell: Cell) -> &T {
        &self.values[self.spec.index(cell)]
    }
}

impl<T> IndexMut<Cell> for Raster<T> {
    fn index_mut(&mut self, cell: Cell) -> &mut T {
        let index = self.spec.index(cell);
        &mut self.values[index]
    }
}
