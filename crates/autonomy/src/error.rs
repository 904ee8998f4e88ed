//! What can be wrong with what the core is given.

use wisdom_grid::{Cell, Window};

/// Why the core refuses a spec, an observation or an outcome.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AutonomyError {
    /// A window or an expert names a layer that no instrument measures.
    #[error("layer `{layer}` is not one that the mission measures")]
    NotMeasured {
        /// The layer.
        layer: String,
    },
    /// The mission has no measured elevation.
    #[error("the mission measures no layer `elevation`; routes need one")]
    NoElevation,
    /// An expert's table speaks of another unit than its layer.
    #[error("expert `{expert}` reads `{layer}` in `{table}`, but the layer is in `{unit}`")]
    Unit {
        /// The expert.
        expert: String,
        /// Its layer.
        layer: String,
        /// Unit of the table.
        table: String,
        /// Unit of the layer.
        unit: String,
    },
    /// An expert reads a layer that the mission does not have.
    #[error("expert `{expert}` reads layer `{layer}`, which the mission does not have")]
    NoLayer {
        /// The expert.
        expert: String,
        /// The layer it names.
        layer: String,
    },
    /// Slip is to depend on a layer that is not measured.
    #[error("slip is to depend on layer `{layer}`, which the mission does not measure")]
    SlipLayer {
        /// The layer named.
        layer: String,
    },
    /// More experts than the goal manager can tell apart.
    #[error("{found} experts; at most {limit} can be told apart where goals ended")]
    TooManyExperts {
        /// Experts found.
        found: usize,
        /// The most there may be.
        limit: usize,
    },
    /// A window has another number of values than cells.
    #[error("`{layer}`, {window}: {values} values and {uncertainties} uncertainties")]
    WindowLength {
        /// The layer.
        layer: String,
        /// The window.
        window: Window,
        /// Values given.
        values: usize,
        /// Uncertainties given.
        uncertainties: usize,
    },
    /// A reading is not a number, or its uncertainty is outside [0, 1].
    #[error("`{layer}` at {cell}: reading {value} with uncertainty {uncertainty}")]
    Reading {
        /// The layer.
        layer: String,
        /// The cell.
        cell: Cell,
        /// The reading.
        value: f32,
        /// Its uncertainty.
        uncertainty: f32,
    },
    /// Observations must come in order.
    #[error("observation {found} came where {expected} was due")]
    ObservationOrder {
        /// Number due.
        expected: u32,
        /// Number found.
        found: u32,
    },
    /// An outcome answers another decision than the last.
    #[error("the outcome answers decision {found}; the last one is {expected}")]
    OutcomeOrder {
        /// The last decision.
        expected: u32,
        /// The decision the outcome names.
        found: u32,
    },
    /// Messages must come in order.
    #[error("message {found} came where {expected} was due")]
    MessageOrder {
        /// Number due.
        expected: u32,
        /// Number found.
        found: u32,
    },
    /// A message names something that there is not, or asks for what cannot be.
    #[error("message {number}: {why}")]
    Message {
        /// Number of the message.
        number: u32,
        /// What is wrong with it.
        why: String,
    },
    /// A moment speaks of something that the spec does not have.
    #[error("decision {number} cannot be taken again: {why}")]
    Moment {
        /// Number of the decision.
        number: u32,
        /// What is wrong with it.
        why: String,
    },
    /// An outcome names an operator that the domain does not have, or one whose preconditions do not hold.
    #[error("operator `{operator}` cannot have been carried out: {why}")]
    Operator {
        /// The operator.
        operator: String,
        /// What is wrong with it.
        why: &'static str,
    },
    /// A decision was asked for before anything was observed.
    #[error("a decision was asked for before the first observation")]
    NothingObserved,
    /// The rover stands off the grid.
    #[error("the rover stands at {cell}, off the grid of {rows} x {cols} cells")]
    OffGrid {
        /// Where it stands.
        cell: Cell,
        /// Rows of the grid.
        rows: usize,
        /// Columns of the grid.
        cols: usize,
    },
    /// The working map is too small to work on.
    #[error(
        "a working map of {side} cells a side; at least {} are needed",
        crate::MIN_WORKING_CELLS
    )]
    WorkingCells {
        /// The side asked for.
        side: usize,
    },
    /// A plan or its operators failed the independent check: a bug of ours, reported rather than driven.
    #[error("the plan about to be chosen is not valid: {why}")]
    InvalidPlan {
        /// What the check found.
        why: String,
    },
    /// Experts and layers do not fit.
    #[error(transparent)]
    Fusion(#[from] wisdom_fusion::FusionError),
    /// A layer cannot be derived or read.
    #[error(transparent)]
    Terrain(#[from] wisdom_terrain::TerrainError),
    /// Traversability cannot be derived.
    #[error(transparent)]
    Planner(#[from] wisdom_planner::PlannerError),
    /// Facts, operators and directives do not fit.
    #[error(transparent)]
    Domain(#[from] wisdom_goals::DomainError),
    /// A window leaves the grid.
    #[error(transparent)]
    Grid(#[from] wisdom_grid::GridError),
}
