//! The shape of `mission.toml` and of an expert's table. Unknown keys are errors; defaults are DESIGN.md's.

use std::collections::BTreeMap;

use serde::Deserialize;
use wisdom_autonomy::RouteSpec;
use wisdom_planner::Vehicle;

/// `mission.toml`.
#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) struct MissionFile {
    pub name: String,
    #[serde(default)]
    pub summary: String,
    #[serde(default = "one")]
    pub seed: u64,
    #[serde(default)]
    pub rule: Option<String>,
    #[serde(default)]
    pub paradox: Option<String>,
    #[serde(default)]
    pub statistic: Option<String>,
    #[serde(default)]
    pub inagaki_k: Option<f64>,
    #[serde(default)]
    pub policy: Option<String>,
    #[serde(default)]
    pub objective: ObjectiveFile,
    #[serde(default)]
    pub prize: Option<String>,
    pub terrain: TerrainFile,
    pub layer: Vec<LayerFile>,
    pub experts: Vec<String>,
    #[serde(default)]
    pub prior: PriorFile,
    #[serde(default)]
    pub instrument: Vec<InstrumentFile>,
    pub rover: RoverFile,
    pub budget: BudgetFile,
    #[serde(default)]
    pub goals: GoalsFile,
    #[serde(default)]
    pub routes: RoutesFile,
    #[serde(default)]
    pub triggers: TriggersFile,
    #[serde(default)]
    pub fallback: FallbackFile,
    /// The layer of classes that types of objects go by.
    #[serde(default)]
    pub class_layer: Option<String>,
    /// Types of objects.
    #[serde(default, rename = "type")]
    pub types: Vec<TypeFile>,
    /// What the ground will ask for.
    #[serde(default)]
    pub command: Vec<CommandFile>,
    #[serde(default)]
    pub facts: Vec<String>,
    pub operator: Vec<OperatorFile>,
    pub directive: Vec<DirectiveFile>,
    #[serde(default)]
    pub execution: ExecutionFile,
    #[serde(default)]
    pub fault: Vec<FaultFile>,
}

fn one() -> u64 {
    1
}

#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) struct TerrainFile {
    /// A landscape description; with it, rows, cols and spacing are needed.
    pub landscape: Option<String>,
    pub rows: Option<usize>,
    pub cols: Option<usize>,
    pub spacing_m: Option<f64>,
    /// Radius of the body, metres; without it the ground is a plane.
    pub body_radius_m: Option<f64>,
    /// Side of the map the rover works on, cells: it moves with the rover over ground that is read piece by piece.
    pub working_cells: Option<usize>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Kind {
    Scalar,
    Class,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum UpdateName {
    Best,
    Latest,
    Weighted,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum DerivedName {
    Gradient,
    Slope,
    Step,
    Roughness,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) struct LayerFile {
    pub name: String,
    #[serde(default)]
    pub unit: String,
    /// The true values, for terrain from files.
    pub file: Option<String>,
    /// The site's own uncertainty of them.
    pub uncertainty_file: Option<String>,
    pub derived: Option<DerivedName>,
    pub kind: Option<Kind>,
    pub update: Option<UpdateName>,
    /// Error of a reading with u = 1, in the layer's unit (normal); for classes, unused.
    pub sigma: Option<f64>,
    /// Classes that a wrong reading may take.
    pub classes: Option<Vec<u16>>,
    /// How files on another grid are brought onto that of the elevation.
    pub resample: Option<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Default)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum PriorKind {
    /// Nothing is known.
    #[default]
    None,
    /// Block means of the truth, as from orbit.
    Averaged,
    /// The paper's first look.
    FirstLook,
    /// The whole noise-free world: the control.
    Complete,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields, default)]
#[derive(Default)]
pub(crate) struct PriorFile {
    pub kind: PriorKind,
    pub block: Option<usize>,
    pub u: Option<f64>,
    /// First look: the uncertainty of each layer.
    pub uncertainty: BTreeMap<String, FirstLookU>,
    pub pinned: Vec<PinnedFile>,
    pub camera_height_m: Option<f64>,
}

/// How the uncertainty of a layer runs over the first look.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) enum FirstLookU {
    /// (y − 1) / 100, whatever is in sight.
    SouthToNorth,
    /// (x − 1) / 100, whatever is in sight.
    WestToEast,
    /// 0 in sight and 1 out of sight, plus noise uniform in [0, this), cut at 1.
    Sight(f64),
}

/// A cell whose first-look uncertainty is fixed.
#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) struct PinnedFile {
    pub layer: String,
    pub row: usize,
    pub col: usize,
    pub u: f64,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) struct InstrumentFile {
    pub name: String,
    pub layers: Vec<String>,
    pub height_m: f64,
    pub range_m: f64,
    #[serde(default)]
    pub u0: f64,
    #[serde(default = "full_circle")]
    pub field_of_view_deg: f64,
}

fn full_circle() -> f64 {
    360.0
}

#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) struct RoverFile {
    pub start: Vec<usize>,
    #[serde(default)]
    pub heading_deg: f64,
    #[serde(default = "five")]
    pub look_every_m: f64,
    #[serde(default = "two")]
    pub eye_height_m: f64,
    #[serde(default = "two_poses")]
    pub poses: usize,
    /// A built-in vehicle that `vehicle` changes single keys of.
    pub preset: Option<String>,
    /// The layer of terrain classes that slip depends on.
    pub slip_layer: Option<String>,
    #[serde(default)]
    pub vehicle: Vehicle,
}

fn five() -> f64 {
    5.0
}

fn two() -> f64 {
    2.0
}

fn two_poses() -> usize {
    2
}

#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) struct BudgetFile {
    pub time_s: f64,
    pub energy_j: f64,
    #[serde(default)]
    pub reserve_j: f64,
    pub data_mb: Option<f64>,
    #[serde(default = "half")]
    pub min_reliability: f64,
}

fn half() -> f64 {
    0.5
}

#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields, default)]
pub(crate) struct GoalsFile {
    pub min_prominence: f64,
    pub min_separation_m: f64,
    pub percentile_floor: Option<f64>,
    pub max_known: usize,
    pub max_sequenced: usize,
    pub hysteresis: f64,
    pub identity_radius_m: f64,
    pub family: usize,
    pub expansions: u64,
    pub max_reopenings: u32,
    /// Uncertainty from which on a class is only known by its parent type.
    pub clear_below: f64,
}

impl Default for GoalsFile {
    fn default() -> Self {
        Self {
            min_prominence: 0.1,
            min_separation_m: 5.0,
            percentile_floor: None,
            max_known: 100,
            max_sequenced: 14,
            hysteresis: 0.05,
            identity_radius_m: 8.0,
            family: 5,
            expansions: 50_000,
            max_reopenings: 1,
            clear_below: 0.5,
        }
    }
}

#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields, default)]
pub(crate) struct RoutesFile {
    pub alternatives: usize,
    pub front: usize,
}

impl Default for RoutesFile {
    fn default() -> Self {
        let RouteSpec { alternatives, front } = RouteSpec::default();
        Self { alternatives, front }
    }
}

#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields, default)]
pub(crate) struct TriggersFile {
    /// When decisions are taken: event, cadence or hybrid.
    pub pace: Option<String>,
    /// Time between decisions at a cadence, seconds.
    pub cadence_s: f64,
    pub interest_change: f64,
    /// Change of the prize on the way ahead; without it, none calls for a decision.
    pub corridor_change: Option<f64>,
    pub budget_drift: f64,
    /// Time before a window closes, seconds.
    pub window_closing_s: f64,
    /// Contradiction at a committed goal.
    pub conflict: f64,
    /// Longest time without a decision, seconds; without it, any.
    pub watchdog_s: Option<f64>,
}

impl Default for TriggersFile {
    fn default() -> Self {
        let defaults = wisdom_autonomy::Triggers::default();
        Self {
            pace: None,
            cadence_s: defaults.cadence_s,
            interest_change: defaults.interest_change,
            corridor_change: None,
            budget_drift: defaults.budget_drift,
            window_closing_s: defaults.window_closing_s,
            conflict: defaults.conflict,
            watchdog_s: None,
        }
    }
}

#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields, default)]
pub(crate) struct FallbackFile {
    pub max_looks: u32,
    pub look_range_m: f64,
    pub min_ignorance: f64,
    pub return_home: bool,
}

impl Default for FallbackFile {
    fn default() -> Self {
        Self { max_looks: 3, look_range_m: 20.0, min_ignorance: 0.25, return_home: true }
    }
}

#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) struct OperatorFile {
    pub name: String,
    #[serde(default)]
    pub preconditions: Vec<String>,
    #[serde(default)]
    pub adds: Vec<String>,
    #[serde(default)]
    pub deletes: Vec<String>,
    #[serde(default)]
    pub time_s: f64,
    #[serde(default)]
    pub energy_j: f64,
    #[serde(default)]
    pub data_mb: f64,
}

/// What the policy is told besides the plan.
#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields, default)]
pub(crate) struct ObjectiveFile {
    pub confidence: f64,
    pub risk_price: f64,
    pub price_per_kj: f64,
    pub price_per_h: f64,
    pub price_per_mb: f64,
}

impl Default for ObjectiveFile {
    fn default() -> Self {
        Self {
            confidence: 0.8,
            risk_price: 1.0,
            price_per_kj: 0.0,
            price_per_h: 0.0,
            price_per_mb: 0.0,
        }
    }
}

#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) struct DirectiveFile {
    pub name: String,
    /// What it looks for: inspect, look-again or adjudicate.
    pub kind: Option<String>,
    /// Least value of what its kind reads.
    #[serde(default)]
    pub min_signal: f64,
    /// The type of object it is for.
    pub object: Option<String>,
    /// How far away another of its kind may be that takes the place of a target that cannot be reached, metres.
    #[serde(default)]
    pub generalise_m: f64,
    /// Mission times between which work may begin, seconds.
    pub window_s: Option<[f64; 2]>,
    #[serde(default)]
    pub experts: Vec<String>,
    #[serde(default)]
    pub min_credit: f64,
    #[serde(default)]
    pub min_interest: f64,
    #[serde(default = "unit_weight")]
    pub weight: f64,
    #[serde(default)]
    pub requires: Vec<String>,
    pub achieves: Vec<String>,
    pub standoff_m: f64,
    #[serde(default = "two_attempts")]
    pub max_attempts: u32,
    pub exclusion_radius_m: f64,
    pub substitute: Option<String>,
    #[serde(default)]
    pub mandatory: bool,
    pub fade_s: Option<[f64; 2]>,
}

/// A type of objects.
#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) struct TypeFile {
    pub name: String,
    /// The type it is a kind of, given before it.
    pub parent: Option<String>,
    /// Classes of the ground that are of this type.
    #[serde(default)]
    pub classes: Vec<u16>,
}

/// Something that the ground asks for.
#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) struct CommandFile {
    pub name: String,
    /// When it arrives, mission time in seconds.
    pub at_s: f64,
    /// The directive to follow.
    pub directive: String,
    /// The place, [row, col].
    pub target: Vec<usize>,
    /// What it is worth, in the place of the map's prize.
    pub prize: f64,
    /// Whether a sequence with it is better than any without.
    #[serde(default)]
    pub mandatory: bool,
    /// When it is taken back, mission time in seconds; never by default.
    pub withdraw_at_s: Option<f64>,
}

fn unit_weight() -> f64 {
    1.0
}

fn two_attempts() -> u32 {
    2
}

#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields, default)]
pub(crate) struct ExecutionFile {
    /// Scatter of slip on a step: the cost of an edge is multiplied by 1 + this × a standard normal, cut at
    /// half and double.
    pub slip_scatter: f64,
    /// Scatter of an operator's costs, alike.
    pub operator_scatter: f64,
    /// Factor on the true hazard: what the rover's own hazard model is wrong by.
    pub hazard_factor: f64,
    /// Time lost when a hazard aborts a drive, seconds.
    pub recovery_s: f64,
    /// Radius within which the hazard cameras see ground that stops the rover, metres.
    pub hazard_camera_m: f64,
    /// The most decisions of one mission.
    pub max_decisions: u32,
}

impl Default for ExecutionFile {
    fn default() -> Self {
        Self {
            slip_scatter: 0.1,
            operator_scatter: 0.05,
            hazard_factor: 1.0,
            recovery_s: 1800.0,
            hazard_camera_m: 3.0,
            max_decisions: 500,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum FaultName {
    InstrumentLost,
    WheelDrag,
    DemBias,
    FactsLost,
    CommDelay,
}

/// What may break: `kind` says which of the last five keys it needs.
#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) struct FaultFile {
    pub name: String,
    pub kind: FaultName,
    /// Chance that it strikes in a mission.
    pub probability: f64,
    /// From when to when it may strike, mission time in seconds; the whole time budget by default.
    pub between_s: Option<[f64; 2]>,
    /// How long it lasts; for good by default.
    pub lasts_s: Option<f64>,
    pub instrument: Option<String>,
    pub factor: Option<f64>,
    pub bias_m: Option<f64>,
    pub delay_s: Option<f64>,
    pub facts: Option<Vec<String>>,
}

/// An expert's table.
#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) struct ExpertFile {
    pub name: String,
    pub layer: String,
    pub quantity: String,
    #[serde(default)]
    pub unit: String,
    #[serde(default)]
    pub band: Vec<BandFile>,
    #[serde(default)]
    pub class: Vec<ClassFile>,
    pub outside: OpinionFile,
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) struct BandFile {
    #[serde(default = "minus_infinity")]
    pub from: f64,
    #[serde(default = "infinity")]
    pub to: f64,
    pub paradox: f64,
    pub not_interesting: f64,
    pub interesting: f64,
}

fn minus_infinity() -> f64 {
    f64::NEG_INFINITY
}

fn infinity() -> f64 {
    f64::INFINITY
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) struct ClassFile {
    pub value: i32,
    pub paradox: f64,
    pub not_interesting: f64,
    pub interesting: f64,
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) struct OpinionFile {
    pub paradox: f64,
    pub not_interesting: f64,
    pub interesting: f64,
}
