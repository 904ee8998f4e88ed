//! Readings with their uncertainty.

use wisdom_grid::{Cell, GridSpec, Raster, Window};

use crate::TerrainError;

/// A raster of readings (elevation in metres, gradient magnitude, texture class, temperature, ..) with the
/// uncertainty u of each in [0, 1]: how much of what an expert says of it is lost (paper section III, Eq. 4).
///
/// Where nothing is known the reading is 0 and u is 1. No reading and no u is ever NaN or infinite.
#[derive(Debug, Clone)]
pub struct Layer {
    values: Raster<f32>,
    uncertainty: Raster<f32>,
    /// The u that all cells share, if that is known: then no one needs to read the plane.
    alike: Option<f32>,
}

/// Layers are equal if their readings and their uncertainties are.
impl PartialEq for Layer {
    fn eq(&self, other: &Self) -> bool {
        self.values == other.values && self.uncertainty == other.uncertainty
    }
}

impl Layer {
    /// A layer from readings and their uncertainty, which share one grid. An unknown cell (u = 1) keeps no
    /// reading: it is set to 0.
    ///
    /// # Errors
    /// [`TerrainError::GridMismatch`] if the grids differ; [`TerrainError::Reading`] or
    /// [`TerrainError::Uncertainty`], naming the cell, if a reading is not finite or a u outside [0, 1].
    pub fn new(mut values: Raster<f32>, uncertainty: Raster<f32>) -> Result<Self, TerrainError> {
        let spec = values.spec();
        if spec != uncertainty.spec() {
            return Err(TerrainError::GridMismatch { first: spec, second: uncertainty.spec() });
        }
        let first = uncertainty.values()[0];
        let mut differ = false;
        for (index, (value, &u)) in
            values.values_mut().iter_mut().zip(uncertainty.values()).enumerate()
        {
            if !value.is_finite() {
                return Err(TerrainError::Reading { cell: spec.cell(index), value: *value });
            }
            if !(0.0..=1.0).contains(&u) {
                return Err(TerrainError::Uncertainty { cell: spec.cell(index), u });
            }
            if u == 1.0 {
                *value = 0.0;
            }
            differ |= u.to_bits() != first.to_bits();
        }
        Ok(Self { values, uncertainty, alike: (!differ).then_some(first) })
    }

    /// A layer of which nothing is known.
    #[must_use]
    pub fn unknown(spec: GridSpec) -> Self {
        let (values, uncertainty) = (Raster::filled(spec, 0.0), Raster::filled(spec, 1.0));
        Self { values, uncertainty, alike: Some(1.0) }
    }

    /// A layer of which everything is certain (u = 0): the simulated world's truth.
    ///
    /// # Errors
    /// [`TerrainError::Reading`], naming the cell, if a reading is not finite.
    pub fn certain(values: Raster<f32>) -> Result<Self, TerrainError> {
        let uncertainty = Raster::filled(values.spec(), 0.0);
        Self::new(values, uncertainty)
    }

    /// A layer certain to be 0 everywhere, to be written over. Its planes come zeroed from the allocator, so that
    /// pages nobody writes are never touched.
    pub(crate) fn zero(spec: GridSpec) -> Self {
        let (values, uncertainty) = (Raster::filled(spec, 0.0), Raster::filled(spec, 0.0));
        Self { values, uncertainty, alike: Some(0.0) }
    }

    /// The readings and their uncertainty, to be written over with what [`Layer::new`] would accept.
    pub(crate) fn planes_mut(&mut self) -> (&mut [f32], &mut [f32]) {
        (self.values.values_mut(), self.uncertainty.values_mut())
    }

    /// The u that all cells share, if that is known.
    pub(crate) fn alike(&self) -> Option<f32> {
        self.alike
    }

    /// Says what was written over the planes: the u that all cells share, or that they may differ.
    pub(crate) fn set_alike(&mut self, alike: Option<f32>) {
        self.alike = alike;
    }

    /// Where the layer lies.
    #[must_use]
    pub fn spec(&self) -> GridSpec {
        self.values.spec()
    }

    /// The readings, 0 where unknown.
    #[must_use]
    pub fn values(&self) -> &Raster<f32> {
        &self.values
    }

    /// The uncertainty of the readings, in [0, 1].
    #[must_use]
    pub fn uncertainty(&self) -> &Raster<f32> {
        &self.uncertainty
    }

    /// The reading at a cell, 0 if it is unknown.
    ///
    /// # Panics
    /// If the cell is not on the grid, as a slice does.
    #[must_use]
    pub fn value(&self, cell: Cell) -> f32 {
        self.values[cell]
    }

    /// The uncertainty at a cell.
    ///
    /// # Panics
    /// If the cell is not on the grid, as a slice does.
    #[must_use]
    pub fn u(&self, cell: Cell) -> f32 {
        self.uncertainty[cell]
    }

    /// Whether anything is known of a cell: u < 1.
    ///
    /// # Panics
    /// If the cell is not on the grid, as a slice does.
    #[must_use]
    pub fn is_known(&self, cell: Cell) -> bool {
        self.u(cell) < 1.0
    }

    /// Replaces the reading at a cell and its uncertainty; u = 1 forgets the cell.
    ///
    /// # Panics
    /// If the cell is not on the grid; in debug builds, if the reading is not finite or u not in [0, 1].
    pub fn set(&mut self, cell: Cell, value: f32, u: f32) {
        debug_assert!(value.is_finite(), "a reading of {value} at {cell}");
        debug_assert!((0.0..=1.0).contains(&u), "an uncertainty of {u} at {cell}");
        self.values[cell] = if u < 1.0 { value } else { 0.0 };
        self.uncertainty[cell] = u;
        self.alike = self.alike.filter(|alike| alike.to_bits() == u.to_bits());
    }

    /// The same layer in the same place, its cells numbered from `first` on.
    #[must_use]
    pub fn numbered_from(self, first: Cell) -> Self {
        Self {
            values: self.values.numbered_from(first),
            uncertainty: self.uncertainty.numbered_from(first),
            alike: self.alike,
        }
    }

    /// A copy of the cells inside a window, numbered from (0, 0).
    ///
    /// # Errors
    /// [`TerrainError::Grid`] if the window reaches over the edge or is empty.
    pub fn crop(&self, window: Window) -> Result<Self, TerrainError> {
        let (values, uncertainty) = (self.values.crop(window)?, self.uncertainty.crop(window)?);
        Ok(Self { values, uncertainty, alike: self.alike })
    }
}
