//! What can be wrong with tables, experts and the way to fuse them.

use wisdom_belief::{BeliefError, ParadoxPolicy, Rule};
use wisdom_grid::GridSpec;

use crate::Statistic;

/// Why a table is refused, experts cannot judge, or a fusion is not defined.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FusionError {
    /// A table without rows.
    #[error("table `{table}` has no rows; it needs at least one besides `outside`")]
    NoRows {
        /// The table.
        table: String,
    },
    /// A row's masses are not an opinion.
    #[error("table `{table}`, row {row}: {source}")]
    Opinion {
        /// The table.
        table: String,
        /// The row, as its band, class or `outside`.
        row: String,
        /// What is wrong with the masses.
        source: Box<BeliefError>,
    },
    /// A band that holds no reading.
    #[error(
        "table `{table}`, band [{lo}, {hi}): the first bound must lie below the second (as f32)"
    )]
    Band {
        /// The table.
        table: String,
        /// Lower bound.
        lo: f64,
        /// Upper bound.
        hi: f64,
    },
    /// Two bands claim the same readings.
    #[error(
        "table `{table}`: bands [{}, {}) and [{}, {}) overlap",
        first.0, first.1, second.0, second.1
    )]
    Overlap {
        /// The table.
        table: String,
        /// Bounds of the lower band.
        first: (f64, f64),
        /// Bounds of the band that starts inside it.
        second: (f64, f64),
    },
    /// A class has two rows.
    #[error("table `{table}`: class {class} has two rows")]
    RepeatedClass {
        /// The table.
        table: String,
        /// The class.
        class: i32,
    },
    /// A class that no reading can name exactly.
    #[error(
        "table `{table}`: class {class}; classes lie within ±16777216, which readings hold exactly"
    )]
    ClassRange {
        /// The table.
        table: String,
        /// The class.
        class: i32,
    },
    /// Nobody judges.
    #[error("no experts; at least one must judge")]
    NoExperts,
    /// Two experts have the same name.
    #[error("expert `{name}` is named twice")]
    RepeatedExpert {
        /// The name.
        name: String,
    },
    /// An expert's layer does not exist.
    #[error("expert `{expert}` reads layer `{layer}`, which does not exist; known: {known}")]
    MissingLayer {
        /// The expert.
        expert: String,
        /// The layer it reads.
        layer: String,
        /// The layers there are.
        known: String,
    },
    /// Two layers do not lie on the same grid.
    #[error(
        "layers `{first}` and `{second}` must share one grid: {} against {}",
        described(&grids.0),
        described(&grids.1)
    )]
    GridMismatch {
        /// One layer.
        first: String,
        /// The other layer.
        second: String,
        /// Their grids.
        grids: Box<(GridSpec, GridSpec)>,
    },
    /// A rule without a closed form was given too many experts.
    #[error("{experts} experts; rule {rule} takes at most {limit}")]
    TooManyExperts {
        /// Experts given.
        experts: usize,
        /// The most the rule takes.
        limit: usize,
        /// The rule.
        rule: Rule,
    },
    /// A rule that maps cannot be made with.
    #[error(
        "rule {rule} cannot make a map: each of its sources must doubt the frame itself, which none does of a \
         cell that it has not seen"
    )]
    NotOnMaps {
        /// The rule.
        rule: Rule,
    },
    /// A paradox policy that the rule gives no meaning.
    #[error("paradox policy {policy} means nothing to rule {rule}; it takes {admitted}")]
    PolicyNotAdmitted {
        /// The policy.
        policy: ParadoxPolicy,
        /// The rule.
        rule: Rule,
        /// The policies that the rule takes.
        admitted: String,
    },
    /// Inagaki's k is not in [0, 1].
    #[error("inagaki-k is {k}; it lies in [0, 1], where it suits every cell")]
    InagakiK {
        /// The value found.
        k: f64,
    },
    /// The plausibility of *interesting* was asked for as a statistic.
    #[error(
        "plausibility is no statistic to choose by: under dsmc Pl(I) is constant 1 on every cell; known: {}",
        Statistic::known()
    )]
    ConstantPlausibility,
    /// A name that is no statistic.
    #[error("unknown statistic `{name}`; known: {}", Statistic::known())]
    UnknownStatistic {
        /// The name found.
        name: String,
    },
}

fn described(grid: &GridSpec) -> String {
    format!(
        "{} x {} cells of {} m with its north-west corner at ({}, {}) m",
        grid.rows(),
        grid.cols(),
        grid.spacing_m(),
        grid.west_m(),
        grid.north_m()
    )
}
