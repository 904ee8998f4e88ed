//! Everything the core is told once: experts, rule, limits, budgets, policy.

use std::collections::BTreeMap;

use wisdom_fusion::{Expert, Fusion};
use wisdom_goals::{Directive, Domain, ManagerSpec, Policy, Preferences, PrizeScale};
use wisdom_grid::{Cell, GridSpec, Window};
use wisdom_planner::Vehicle;

/// How a new reading of a layer meets the one already known.
///
/// Two readings of one layer become one reading before any expert sees them; evidence is combined only between
/// experts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum MapUpdate {
    /// Keep the reading with the lower uncertainty; the older one on a tie.
    #[default]
    Best,
    /// Keep the newer reading.
    Latest,
    /// The mean weighted by 1/u; its u is that of two independent readings, `1/(1/u₁ + 1/u₂)`.
    Weighted,
}

/// A layer that the terrain crate derives from elevation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Derivation {
    /// Gradient magnitude, rise over run.
    Gradient,
    /// Slope, degrees.
    Slope,
    /// Largest height difference to a neighbour, metres.
    Step,
    /// Residual from a plane over the vehicle's footprint, metres (root mean square).
    Roughness,
}

/// Where a layer comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// Instruments read it.
    Measured(MapUpdate),
    /// It follows from the layer `elevation`.
    Derived(Derivation),
}

/// A layer of the mission.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LayerSpec {
    /// Its name.
    pub name: String,
    /// Its unit, as experts must name it.
    pub unit: String,
    /// Where it comes from.
    pub source: Source,
}

/// What may be spent on the mission.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Budget {
    /// Time, seconds.
    pub time_s: f64,
    /// Energy, joules.
    pub energy_j: f64,
    /// Energy never to be planned with, joules.
    pub reserve_j: f64,
    /// Data volume, megabytes (infinite if the mission sets none).
    pub data_mb: f64,
    /// Least reliability of a plan (default 0.5).
    pub min_reliability: f64,
}

/// When decisions are taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
#[non_exhaustive]
pub enum Pace {
    /// Whenever something calls for one.
    #[default]
    Event,
    /// At even intervals, and where a step ends or the leg under way is no longer safe.
    Cadence,
    /// Both.
    Hybrid,
}

impl Pace {
    /// Every pace.
    pub const ALL: [Self; 3] = [Self::Event, Self::Cadence, Self::Hybrid];

    /// The name that a mission file writes.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Event => "event",
            Self::Cadence => "cadence",
            Self::Hybrid => "hybrid",
        }
    }
}

/// What calls for a decision.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Triggers {
    /// When decisions are taken.
    pub pace: Pace,
    /// Time between two decisions at a cadence, seconds.
    pub cadence_s: f64,
    /// Change of the prize at a committed goal since the last decision.
    pub interest_change: f64,
    /// Change of the prize on the way ahead since the last decision; infinite, the default, asks for none: on real ground
    /// nearly every look changes the ground ahead.
    pub corridor_change: f64,
    /// Share of a leg's planned energy by which the actual one may be off.
    pub budget_drift: f64,
    /// Time before the window of a committed goal closes at which that calls for a decision, seconds.
    pub window_closing_s: f64,
    /// Contradiction at the target of a committed goal that calls for a decision when it is passed.
    pub conflict: f64,
    /// Time without a decision after which one is taken in any case, seconds.
    pub watchdog_s: f64,
}

impl Default for Triggers {
    fn default() -> Self {
        Self {
            pace: Pace::Event,
            cadence_s: 3600.0,
            interest_change: 0.1,
            corridor_change: f64::INFINITY,
            budget_drift: 0.25,
            window_closing_s: 900.0,
            conflict: 0.5,
            watchdog_s: f64::INFINITY,
        }
    }
}

/// What to do when no goal is worth pursuing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fallback {
    /// Looks from vantages in a row before giving up.
    pub max_looks: u32,
    /// Range of a look, metres: the instruments'.
    pub look_range_m: f64,
    /// Least mean ignorance in range for a look to be worth the drive, in [0, 1].
    pub min_ignorance: f64,
    /// Where home is.
    pub home: Cell,
    /// Whether to drive home before waiting.
    pub return_home: bool,
}

/// How goals are approached.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ApproachSpec {
    /// Height of the eye that must see the target, metres above ground.
    pub eye_height_m: f64,
    /// Poses offered for each goal.
    pub poses: usize,
}

/// How many ways are weighed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RouteSpec {
    /// Alternatives looked for on each leg: 1 is the most reliable route alone, more trade reliability for time and
    /// energy.
    pub alternatives: usize,
    /// Plans of one order of goals that a family holds at most: the chosen one and others of its front.
    pub front: usize,
}

impl Default for RouteSpec {
    fn default() -> Self {
        Self { alternatives: 1, front: 64 }
    }
}

/// Everything the core is told once.
#[derive(Debug, Clone, PartialEq)]
pub struct Spec {
    /// The mission's grid.
    pub grid: GridSpec,
    /// Side of the map the rover works on, cells, where the ground is larger than what one decision can look at: a
    /// square around the rover that moves on with it. Without it, the whole grid.
    pub working_cells: Option<usize>,
    /// Its layers; `elevation` is always among the measured ones.
    pub layers: Vec<LayerSpec>,
    /// The experts.
    pub experts: Vec<Expert>,
    /// How their evidence is fused.
    pub fusion: Fusion,
    /// How interest becomes a prize.
    pub prize: PrizeScale,
    /// The objective over sequences.
    pub policy: Policy,
    /// What it is told besides the plan.
    pub preferences: Preferences,
    /// Facts and operators.
    pub domain: Domain,
    /// The pool of directives.
    pub directives: Vec<Directive>,
    /// How the goal manager weighs.
    pub manager: ManagerSpec,
    /// The rover's limits.
    pub vehicle: Vehicle,
    /// The measured layer of classes that types of objects go by, if any.
    pub class_layer: Option<String>,
    /// The uncertainty that the best instrument leaves of each measured layer, from near; 0 where none is named. What
    /// [`wisdom_goals::Kind::LookAgain`] hopes for.
    pub close_look: BTreeMap<String, f32>,
    /// The measured layer of terrain classes that the wheels slip by, if any ([`Vehicle::slip_class`]).
    pub slip_layer: Option<String>,
    /// How many ways are weighed.
    pub routes: RouteSpec,
    /// What may be spent.
    pub budget: Budget,
    /// What calls for a decision.
    pub triggers: Triggers,
    /// What to do without a goal.
    pub fallback: Fallback,
    /// How goals are approached.
    pub approach: ApproachSpec,
}

/// The smallest working map, cells a side: goals, routes and looks need some room.
pub const MIN_WORKING_CELLS: usize = 64;

impl Spec {
    /// Whether a layer of that name is measured.
    #[must_use]
    pub fn measures(&self, layer: &str) -> bool {
        self.layers.iter().any(|l| l.name == layer && matches!(l.source, Source::Measured(_)))
    }

    /// Whether a second reading of the same ground from the same place can change what is known.
    pub(crate) fn learns_from_repeats(&self) -> bool {
        let repeats = |layer: &LayerSpec| {
            matches!(layer.source, Source::Measured(MapUpdate::Weighted | MapUpdate::Latest))
        };
        self.layers.iter().any(repeats)
    }

    /// The working map when it is laid anew around a cell: a square of [`Spec::working_cells`], cut to lie on the grid,
    /// its edges on multiples of an eighth of its side so that it moves seldom.
    #[must_use]
    pub fn working_map(&self, around: Cell) -> Window {
        let whole = self.grid.window();
        let Some(side) = self.working_cells else { return whole };
        let grain = (side / 8).max(1);
        let along = |at: usize, first: usize, count: usize| {
            let side = side.min(count);
            let from = (at - first).saturating_sub(side / 2) / grain * grain;
            (first + from.min(count - side), side)
        };
        let (row, rows) = along(around.row, whole.row, whole.rows);
        let (col, cols) = along(around.col, whole.col, whole.cols);
        Window { row, col, rows, cols }
    }

    /// Whether a rover on a cell has come so near to an edge of its working map that it is to be laid anew: nearer than
    /// a quarter of its side, at an edge that is not the ground's own.
    #[must_use]
    pub fn outgrows(&self, working: Window, cell: Cell) -> bool {
        let Some(side) = self.working_cells else { return false };
        let whole = self.grid.window();
        let near = |at: usize, first: usize, count: usize, least: usize, most: usize| {
            let margin = side / 4;
            (first > least && at < first + margin)
                || (first + count < most && at + margin >= first + count)
        };
        near(cell.row, working.row, working.rows, whole.row, whole.row + whole.rows)
            || near(cell.col, working.col, working.cols, whole.col, whole.col + whole.cols)
    }
}

/// The name of the layer that traversability and derived layers come from.
pub const ELEVATION: &str = "elevation";
