//! What can be wrong with ground that comes from outside.

use wisdom_grid::{Cell, GridError, GridSpec};

/// Why rasters are not a layer, a file not a grid, or a description not a landscape.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TerrainError {
    /// Two rasters of one layer do not lie on the same grid.
    #[error(
        "the readings lie on {first:?}, their uncertainty on {second:?}; one layer has one grid"
    )]
    GridMismatch {
        /// Grid of the readings.
        first: GridSpec,
        /// Grid of the uncertainty.
        second: GridSpec,
    },
    /// A reading is NaN or infinite.
    #[error("the reading at {cell} is {value}; readings are finite, an unknown cell has u = 1")]
    Reading {
        /// Where.
        cell: Cell,
        /// The rejected reading.
        value: f32,
    },
    /// An uncertainty is not a share.
    #[error("the uncertainty at {cell} is {u}; it lies in [0, 1]")]
    Uncertainty {
        /// Where.
        cell: Cell,
        /// The rejected uncertainty.
        u: f32,
    },
    /// A terrain file of a format that is not read.
    #[error(
        "{name} is {found}; GeoTIFF, PDS3, PDS4, ISIS, PNG, NumPy and ESRI ASCII grids are read"
    )]
    Format {
        /// The file.
        name: String,
        /// What it seems to be.
        found: &'static str,
    },
    /// A terrain file whose content is damaged, or is no north-up grid of square cells in metres.
    #[error("{name}: {reason}")]
    File {
        /// The file.
        name: String,
        /// What was found in it, and what is wanted.
        reason: String,
    },
    /// A terrain file has not exactly one band.
    #[error("{name} has {bands} bands; a layer has one")]
    Bands {
        /// The file.
        name: String,
        /// Bands found.
        bands: usize,
    },
    /// A terrain file says it has more cells than are read.
    #[error(
        "{name} says it has {rows} x {cols} cells; at most {} are read",
        crate::format::MAX_CELLS
    )]
    TooLarge {
        /// The file.
        name: String,
        /// Rows it says it has.
        rows: usize,
        /// Columns it says it has.
        cols: usize,
    },
    /// The system refused to read or write a file.
    #[error("{name}: cannot {action} it: {source}")]
    Io {
        /// The file.
        name: String,
        /// What was tried: `open`, `write`, ..
        action: &'static str,
        /// The system's reason.
        source: std::io::Error,
    },
    /// A way of resampling that is not known.
    #[error("\"{found}\" is no way of resampling; nearest, bilinear, average and mode are")]
    Resampling {
        /// The word found.
        found: String,
    },
    /// Numbers that are not a grid, or a window that does not fit one.
    #[error(transparent)]
    Grid(#[from] GridError),
}
