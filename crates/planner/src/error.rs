//! What can be wrong with the inputs of the planner.

use wisdom_grid::{Cell, GridSpec};

/// Why the planner cannot work with what it was given.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlannerError {
    /// A number of the vehicle is out of range.
    #[error("vehicle {field} is {value}; it must be {limit}")]
    Vehicle {
        /// The field, as a mission file writes it.
        field: &'static str,
        /// The value found.
        value: f64,
        /// The range it must lie in.
        limit: &'static str,
    },
    /// A number of a slip class is out of range.
    #[error("vehicle slip-class of class {class}: {field} is {value}; it must be {limit}")]
    SlipClass {
        /// The class.
        class: i32,
        /// The field, as a mission file writes it.
        field: &'static str,
        /// The value found.
        value: f64,
        /// The range it must lie in.
        limit: &'static str,
    },
    /// A slip class that no reading can name exactly.
    #[error(
        "vehicle slip-class of class {class}; classes lie within ±16777216, which readings hold exactly"
    )]
    ClassRange {
        /// The class.
        class: i32,
    },
    /// A class has two slip curves.
    #[error("vehicle slip-class lists class {class} twice; a class has one curve")]
    RepeatedClass {
        /// The class.
        class: i32,
    },
    /// There is no preset of that name.
    #[error("no preset is named `{name}`; there are {known}")]
    UnknownPreset {
        /// The name asked for.
        name: String,
        /// The names there are.
        known: String,
    },
    /// Two rasters of the same ground lie in different places.
    #[error("{layer} lies on {found:?}, the elevation on {expected:?}; they must share one grid")]
    GridMismatch {
        /// The raster that does not fit.
        layer: &'static str,
        /// Where it lies.
        found: GridSpec,
        /// Where the elevation lies.
        expected: GridSpec,
    },
    /// A hazard rate is zero, negative, too small for its type, or not a number.
    #[error("hazard of {cell} is {value} per metre; it must be at least {limit} and finite", limit = f32::MIN_POSITIVE)]
    Hazard {
        /// The cell.
        cell: Cell,
        /// The rate found, per metre.
        value: f32,
    },
    /// A severity is negative or not a number.
    #[error("severity of {cell} is {value}; it must be finite and at least 0")]
    Severity {
        /// The cell.
        cell: Cell,
        /// The severity found.
        value: f32,
    },
}
