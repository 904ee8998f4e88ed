//! The shape of `mission.toml` and of an expert's table. Unknown keys are errors; defaults are DESIGN.md's.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Deserialize;
use wisdom_autonomy::RouteSpec;
use wisdom_planner::Vehicle;

use crate::mission::{
    DEAR, FAR_M, LATEST_S, MAX_ALTERNATIVES, MAX_COST, MAX_FAMILY, MAX_FRONT, MAX_KNOWN, MAX_POSES,
};
use crate::schema;

/// `mission.toml`.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) struct MissionFile {
    /// Name of the mission: letters, digits, `.`, `_` and `-`; logs are called after it.
    #[schemars(regex(pattern = "^[A-Za-z0-9_-][A-Za-z0-9._-]*$"))]
    pub name: String,
    /// One line on what the mission is. Default: empty.
    #[serde(default)]
    pub summary: String,
    /// Seed of everything random in the world. Default: 1.
    #[serde(default = "one")]
    pub seed: u64,
    /// Rule of combination that fuses what the experts say; `wisdom rules` explains each. Default: `dsmc`, the
    /// paper's.
    #[serde(default)]
    #[schemars(schema_with = "schema::rules")]
    pub rule: Option<String>,
    /// Where a source's paradox goes before a rule on Shafer's model. Default: the rule's.
    #[serde(default)]
    #[schemars(schema_with = "schema::paradox_policies")]
    pub paradox: Option<String>,
    /// The number of a fused cell that goals read as its interest. Default: `belief`.
    #[serde(default)]
    #[schemars(schema_with = "schema::statistics")]
    pub statistic: Option<String>,
    /// k of the rule `inagaki`, 0 to 1; other rules do not ask. Default: 1.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub inagaki_k: Option<f64>,
    /// Objective over sequences of goals. Default: `expected-interest`.
    #[serde(default)]
    #[schemars(schema_with = "schema::policies")]
    pub policy: Option<String>,
    /// What the policy is told besides the plan.
    #[serde(default)]
    pub objective: ObjectiveFile,
    /// How interest becomes the prize of a goal. Default: `contrast`.
    #[serde(default)]
    #[schemars(schema_with = "schema::prizes")]
    pub prize: Option<String>,
    /// The ground: its size and where it comes from.
    pub terrain: TerrainFile,
    /// The layers of readings; one is named `elevation`.
    pub layer: Vec<LayerFile>,
    /// Files of the experts' tables, relative to the mission's folder.
    #[schemars(length(min = 1))]
    pub experts: Vec<String>,
    /// What is known of the ground before the first look.
    #[serde(default)]
    pub prior: PriorFile,
    /// The instruments, each of which reads one or more layers. Default: none.
    #[serde(default)]
    pub instrument: Vec<InstrumentFile>,
    /// Where the rover starts, how it looks and what it is.
    pub rover: RoverFile,
    /// What may be spent on the whole mission.
    pub budget: BudgetFile,
    /// How maxima of the interest become goals, and how much is searched.
    #[serde(default)]
    pub goals: GoalsFile,
    /// How many ways and plans are weighed.
    #[serde(default)]
    pub routes: RoutesFile,
    /// What calls for a decision while a leg is driven.
    #[serde(default)]
    pub triggers: TriggersFile,
    /// What to do when no goal is worth pursuing.
    #[serde(default)]
    pub fallback: FallbackFile,
    /// The layer of classes that types of objects go by. Default: none.
    #[serde(default)]
    pub class_layer: Option<String>,
    /// Types of objects. Default: none.
    #[serde(default, rename = "type")]
    pub types: Vec<TypeFile>,
    /// What the ground will ask for. Default: nothing.
    #[serde(default)]
    pub command: Vec<CommandFile>,
    /// Facts that hold when the mission starts. Default: none.
    #[serde(default)]
    pub facts: Vec<String>,
    /// Objects that facts speak of. Default: none.
    #[serde(default)]
    pub object: Vec<ObjectFile>,
    /// STRIPS operators: what the rover can do; one is named `drive`.
    pub operator: Vec<OperatorFile>,
    /// The pool of directives that goals are made of.
    #[schemars(length(min = 1))]
    pub directive: Vec<DirectiveFile>,
    /// How the world treats the rover, which is told none of it.
    #[serde(default)]
    pub execution: ExecutionFile,
    /// What may break. Default: nothing.
    #[serde(default)]
    pub fault: Vec<FaultFile>,
    /// Readings handed in while the mission goes on. Default: none.
    #[serde(default)]
    pub reading: Vec<ReadingFile>,
    /// Places known to be worth a visit, for scoring; the rover is told none of them. Default: none.
    #[serde(default)]
    pub label: Vec<LabelFile>,
}

fn one() -> u64 {
    1
}

/// The ground: its size and where it comes from.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) struct TerrainFile {
    /// File of a synthetic landscape; it needs `rows` and `cols`. Default: none, layers come from files.
    pub landscape: Option<String>,
    /// Rows of the landscape's grid, cells.
    #[schemars(range(min = 1))]
    pub rows: Option<usize>,
    /// Columns of the landscape's grid, cells.
    #[schemars(range(min = 1))]
    pub cols: Option<usize>,
    /// Side of a cell of the landscape's grid, metres. Default: 1.
    #[schemars(range(min = 1e-3, max = FAR_M))]
    pub spacing_m: Option<f64>,
    /// Radius of the body, metres: far ground sinks below the horizon. Default: the elevation file's, or a plane.
    #[schemars(range(min = 1.0))]
    pub body_radius_m: Option<f64>,
    /// Side of the map the rover works on, cells: it moves with the rover over ground that is read piece by piece.
    /// Default: the whole ground.
    #[schemars(range(min = wisdom_autonomy::MIN_WORKING_CELLS, max = crate::ground::MAX_WORKING_CELLS))]
    pub working_cells: Option<usize>,
}

/// What a layer holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Kind {
    /// A quantity.
    Scalar,
    /// Numbered classes.
    Class,
}

/// What becomes of a second reading of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum UpdateName {
    /// The less uncertain of the two is kept.
    Best,
    /// The newer of the two is kept.
    Latest,
    /// Their mean, weighted by 1/u.
    Weighted,
}

/// What a layer is derived as from the elevation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum DerivedName {
    /// Gradient magnitude, rise over run.
    Gradient,
    /// Slope, degrees.
    Slope,
    /// Largest height difference to a neighbour, metres.
    Step,
    /// Root mean square residual from a plane over the footprint, metres.
    Roughness,
}

/// A layer of readings: measured, from the landscape or a file, or derived from the elevation.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) struct LayerFile {
    /// Its name; experts and instruments speak of it by that.
    pub name: String,
    /// Its unit, which must be that of the tables that read it. Default: none.
    #[serde(default)]
    pub unit: String,
    /// File of the true values. Default: the landscape.
    pub file: Option<String>,
    /// File of the data's own uncertainty, in [0, 1]. Default: none.
    pub uncertainty_file: Option<String>,
    /// What it is derived as from the elevation. Default: it is measured.
    pub derived: Option<DerivedName>,
    /// Whether all that is ever known of it is handed in. Default: false.
    #[serde(default)]
    pub handed_in: bool,
    /// Whether readings are quantities or classes. Default: `scalar`.
    pub kind: Option<Kind>,
    /// What becomes of a second reading of a cell. Default: `best`.
    pub update: Option<UpdateName>,
    /// Standard deviation of a reading with u = 1, in the layer's unit; it scales with u. Classes have none.
    /// Default: 0.
    #[schemars(range(min = 0.0))]
    pub sigma: Option<f64>,
    /// Classes that a wrong reading may take, at least two; needed by a layer of classes.
    #[schemars(length(min = 2))]
    pub classes: Option<Vec<u16>>,
    /// How a file on another grid is brought onto the elevation's. Default: grids must agree.
    #[serde(default)]
    #[schemars(schema_with = "schema::resamplings")]
    pub resample: Option<String>,
}

/// What is known before the first look.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema, Default)]
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

/// What is known of the ground before the first look.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields, default)]
#[derive(Default)]
pub(crate) struct PriorFile {
    /// What is known. Default: `none`.
    pub kind: PriorKind,
    /// For `averaged`: side of the blocks whose means are known, cells. Default: 8.
    #[schemars(range(min = 1))]
    pub block: Option<usize>,
    /// For `averaged`: uncertainty of the means. Default: 0.6.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub u: Option<f64>,
    /// For `first-look`: how the uncertainty of each layer runs, by its name. Default: nothing is known of a layer.
    pub uncertainty: BTreeMap<String, FirstLookU>,
    /// For `first-look`: cells whose uncertainty is given. Default: none.
    pub pinned: Vec<PinnedFile>,
    /// For `first-look`: height of the camera, metres above ground. Default: the rover's eye.
    #[schemars(range(min = 0.0, max = FAR_M))]
    pub camera_height_m: Option<f64>,
}

/// How the uncertainty of a layer runs over the first look.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) enum FirstLookU {
    /// (y − 1) / 100, whatever is in sight.
    SouthToNorth,
    /// (x − 1) / 100, whatever is in sight.
    WestToEast,
    /// 0 in sight and 1 out of sight, plus noise uniform in [0, this), cut at 1.
    Sight(#[schemars(range(min = 0.0, max = 1.0))] f64),
}

/// A cell whose first-look uncertainty is fixed.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) struct PinnedFile {
    /// The measured layer.
    pub layer: String,
    /// Row of the cell, from the north, from 0.
    pub row: usize,
    /// Column of the cell, from the west, from 0.
    pub col: usize,
    /// Its uncertainty.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub u: f64,
}

/// An instrument: a look reads each cell in sight and range with u = u0 + (1 − u0)·(d/range)².
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) struct InstrumentFile {
    /// Its name.
    pub name: String,
    /// The measured layers it reads.
    pub layers: Vec<String>,
    /// Height above ground, metres.
    #[schemars(range(min = 0.0, max = FAR_M))]
    pub height_m: f64,
    /// How far it reads, metres.
    #[schemars(range(min = 1e-3, max = FAR_M))]
    pub range_m: f64,
    /// Uncertainty at no distance. Default: 0.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 0.999))]
    pub u0: f64,
    /// Field of view about the heading, degrees. Default: 360.
    #[serde(default = "full_circle")]
    #[schemars(range(min = 1.0, max = 360.0))]
    pub field_of_view_deg: f64,
}

fn full_circle() -> f64 {
    360.0
}

/// Where the rover starts, how it looks and what it is.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) struct RoverFile {
    /// Where it starts, `[row, col]`; also home.
    #[schemars(length(equal = 2))]
    pub start: Vec<usize>,
    /// Heading at the start, degrees clockwise from north. Default: 0.
    #[serde(default)]
    #[schemars(range(min = -360.0, max = 360.0))]
    pub heading_deg: f64,
    /// Way between two looks, metres. Default: 5.
    #[serde(default = "five")]
    #[schemars(range(min = 1e-3, max = FAR_M))]
    pub look_every_m: f64,
    /// Height of the eye that must see a goal's target from its pose, metres. Default: 2.
    #[serde(default = "two")]
    #[schemars(range(min = 0.0, max = FAR_M))]
    pub eye_height_m: f64,
    /// Poses tried for each goal. Default: 2.
    #[serde(default = "two_poses")]
    #[schemars(range(min = 1, max = MAX_POSES))]
    pub poses: usize,
    /// A built-in vehicle that `vehicle` changes single keys of, or NAME of `presets/NAME.toml` in the mission's
    /// folder. Default: none.
    #[serde(default)]
    #[schemars(schema_with = "schema::presets")]
    pub preset: Option<String>,
    /// The measured layer of terrain classes that `slip-class` speaks of. Default: none.
    pub slip_layer: Option<String>,
    /// Limits, hazard model and drive model; keys given here go over those of the preset.
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

/// What may be spent on the whole mission.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) struct BudgetFile {
    /// Time, seconds.
    #[schemars(range(min = 0.0))]
    pub time_s: f64,
    /// Energy, joules.
    #[schemars(range(min = 0.0))]
    pub energy_j: f64,
    /// Energy never planned with, joules. Default: 0.
    #[serde(default)]
    #[schemars(range(min = 0.0))]
    pub reserve_j: f64,
    /// Data volume, megabytes. Default: no limit.
    #[schemars(range(min = 0.0))]
    pub data_mb: Option<f64>,
    /// Least chance that every drive of a plan succeeds. Default: 0.5.
    #[serde(default = "half")]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub min_reliability: f64,
}

fn half() -> f64 {
    0.5
}

/// How maxima of the interest become goals, and how much is searched.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields, default)]
pub(crate) struct GoalsFile {
    /// Least prominence of a maximum, on the scale of the prize. Default: 0.1.
    #[schemars(range(min = 1e-6, max = 1.0))]
    pub min_prominence: f64,
    /// Least distance of two maxima, metres. Default: 5.
    #[schemars(range(min = 0.0, max = FAR_M))]
    pub min_separation_m: f64,
    /// Only maxima above this percentile of the prize map count. Default: none.
    #[schemars(range(min = 0.0, max = 100.0))]
    pub percentile_floor: Option<f64>,
    /// The most goals known at once. Default: 100.
    #[schemars(range(min = 1, max = MAX_KNOWN))]
    pub max_known: usize,
    /// The most goals sequenced. Default: 14.
    #[schemars(range(min = 1, max = wisdom_goals::MAX_SEQUENCED))]
    pub max_sequenced: usize,
    /// Share by which a new sequence must be better than the present one. Default: 0.05.
    #[schemars(range(min = 0.0, max = 10.0))]
    pub hysteresis: f64,
    /// Maxima this near are the same goal, metres. Default: 8.
    #[schemars(range(min = 0.0, max = FAR_M))]
    pub identity_radius_m: f64,
    /// Sets of goals in the family of plans. Default: 5.
    #[schemars(range(min = 1, max = MAX_FAMILY))]
    pub family: usize,
    /// Effort of one search: labels expanded, goals inserted, steps of the bound. Default: 50000.
    #[schemars(range(min = 1))]
    pub expansions: u64,
    /// How often a place given up may be tried again. Default: 1.
    pub max_reopenings: u32,
    /// Uncertainty from which on a class is only known by its parent type. Default: 0.5.
    #[schemars(range(min = 0.0, max = 1.0))]
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

/// How many ways and plans are weighed.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields, default)]
pub(crate) struct RoutesFile {
    /// Ways of each leg: 1 is the most reliable alone, more trade reliability for time and energy. Default: 1.
    #[schemars(range(min = 1, max = MAX_ALTERNATIVES))]
    pub alternatives: usize,
    /// Plans of one order of goals that the family holds at most. Default: 64.
    #[schemars(range(min = 1, max = MAX_FRONT))]
    pub front: usize,
}

impl Default for RoutesFile {
    fn default() -> Self {
        let RouteSpec { alternatives, front } = RouteSpec::default();
        Self { alternatives, front }
    }
}

/// What calls for a decision while a leg is driven.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields, default)]
pub(crate) struct TriggersFile {
    /// When decisions are taken. Default: event.
    #[serde(default)]
    #[schemars(schema_with = "crate::schema::paces")]
    pub pace: Option<String>,
    /// Time between decisions at a cadence, seconds. Default: 3600.
    #[schemars(range(min = 1.0))]
    pub cadence_s: f64,
    /// Change of a goal's prize that asks for a decision. Default: 0.1.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub interest_change: f64,
    /// Change of the prize on the way ahead that asks for a decision. Default: none does.
    #[schemars(range(min = 0.0))]
    pub corridor_change: Option<f64>,
    /// Share of a leg's planned energy by which the actual one may be off. Default: 0.25.
    #[schemars(range(min = 0.0))]
    pub budget_drift: f64,
    /// Time before the window of a goal of the sequence closes that asks for a decision, seconds. Default: 900.
    #[schemars(range(min = 0.0))]
    pub window_closing_s: f64,
    /// Contradiction at a goal of the sequence that asks for a decision when it is passed. Default: 0.5.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub conflict: f64,
    /// Longest time without a decision, seconds. Default: any.
    #[schemars(range(min = 1.0))]
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

/// What to do when no goal is worth pursuing.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields, default)]
pub(crate) struct FallbackFile {
    /// Looks from vantages in a row before giving up. Default: 3.
    pub max_looks: u32,
    /// Reach of such a look, metres. Default: 20.
    #[schemars(range(min = 0.0, max = FAR_M))]
    pub look_range_m: f64,
    /// Least mean ignorance in reach for a look to be worth the drive. Default: 0.25.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub min_ignorance: f64,
    /// Whether to drive home before waiting. Default: true.
    pub return_home: bool,
}

impl Default for FallbackFile {
    fn default() -> Self {
        Self { max_looks: 3, look_range_m: 20.0, min_ignorance: 0.25, return_home: true }
    }
}

/// An object that facts speak of.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) struct ObjectFile {
    /// Its name.
    pub name: String,
    /// Its type.
    #[serde(rename = "type")]
    pub kind: String,
}

/// A STRIPS operator.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) struct OperatorFile {
    /// Its name, unique; `drive` is the one that moves the rover.
    pub name: String,
    /// `?i - instrument`: the operator is one for each choice of objects. Default: none.
    #[serde(default)]
    pub parameters: Vec<String>,
    /// Facts that must hold before. Default: none.
    #[serde(default)]
    pub preconditions: Vec<String>,
    /// Facts that hold afterwards. Default: none.
    #[serde(default)]
    pub adds: Vec<String>,
    /// Facts that cease to hold. Default: none.
    #[serde(default)]
    pub deletes: Vec<String>,
    /// Time it takes, seconds. Default: 0.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = MAX_COST))]
    pub time_s: f64,
    /// Energy it takes, joules. Default: 0.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = MAX_COST))]
    pub energy_j: f64,
    /// Data it makes, megabytes. Default: 0.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = MAX_COST))]
    pub data_mb: f64,
}

/// What the policy is told besides the plan.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields, default)]
pub(crate) struct ObjectiveFile {
    /// Least chance of success that `chance-constrained` asks of a plan. Default: 0.8.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub confidence: f64,
    /// λ: price of a unit of −ln R in units of prize, for `net-benefit` and `utility`. Default: 1.
    #[schemars(range(min = 0.0, max = DEAR))]
    pub risk_price: f64,
    /// μ: price of a kilojoule in units of prize, for `net-benefit` and `utility`. Default: 0.
    #[schemars(range(min = 0.0, max = DEAR))]
    pub price_per_kj: f64,
    /// Price of an hour in units of prize, for `utility`. Default: 0.
    #[schemars(range(min = 0.0, max = DEAR))]
    pub price_per_h: f64,
    /// Price of a megabyte in units of prize, for `utility`. Default: 0.
    #[schemars(range(min = 0.0, max = DEAR))]
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

/// What to look for, and what to do there.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) struct DirectiveFile {
    /// Its name, unique in the pool.
    pub name: String,
    /// What it looks for. Default: inspect.
    #[serde(default)]
    #[schemars(schema_with = "crate::schema::kinds")]
    pub kind: Option<String>,
    /// Least value of what its kind reads. Default: 0.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub min_signal: f64,
    /// The type of object it is for. Default: any.
    pub object: Option<String>,
    /// How far away another of its kind may be that takes the place of a target nothing reaches, metres. Default: 0.
    #[serde(default)]
    #[schemars(range(min = 0.0))]
    pub generalise_m: f64,
    /// Mission times between which work may begin, seconds. Default: any time.
    pub window_s: Option<[f64; 2]>,
    /// Experts that must have the credit of a site together. Default: any site will do.
    #[serde(default)]
    pub experts: Vec<String>,
    /// Least share of the interest that those experts must have. Default: 0.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub min_credit: f64,
    /// Least interest (not prize) of a site. Default: 0.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub min_interest: f64,
    /// Factor on the prize. Default: 1.
    #[serde(default = "unit_weight")]
    #[schemars(range(min = 1e-6, max = 1e3))]
    pub weight: f64,
    /// Facts that must hold before the goal's turn. Default: none.
    #[serde(default)]
    pub requires: Vec<String>,
    /// Facts that make the goal achieved.
    #[schemars(length(min = 1))]
    pub achieves: Vec<String>,
    /// From how far it can be done, metres.
    #[schemars(range(min = 0.0, max = 1e4))]
    pub standoff_m: f64,
    /// Tries a goal gets. Default: 2.
    #[serde(default = "two_attempts")]
    #[schemars(range(min = 1, max = 1000))]
    pub max_attempts: u32,
    /// Around an achieved goal no other is made within this distance, metres.
    #[schemars(range(min = 0.0, max = FAR_M))]
    pub exclusion_radius_m: f64,
    /// The directive that a goal becomes once a try has failed. Default: none.
    pub substitute: Option<String>,
    /// Whether a sequence with its goal is better than any without. Default: false.
    #[serde(default)]
    pub mandatory: bool,
    /// For `utility`, seconds of the mission: the last at which the whole prize counts, and the first at which
    /// nothing of it does. Default: it does not fade.
    #[schemars(inner(range(min = 0.0)))]
    pub fade_s: Option<[f64; 2]>,
}

/// A type of objects.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) struct TypeFile {
    /// Its name.
    pub name: String,
    /// The type it is a kind of, given before it. Default: none.
    pub parent: Option<String>,
    /// Classes of the ground that are of this type. Default: none.
    #[serde(default)]
    pub classes: Vec<u16>,
}

/// Something that the ground asks for.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) struct CommandFile {
    /// Its name.
    pub name: String,
    /// When it arrives, mission time in seconds.
    #[schemars(range(min = 0.0))]
    pub at_s: f64,
    /// The directive to follow.
    pub directive: String,
    /// The place, [row, col].
    pub target: Vec<usize>,
    /// What it is worth, in the place of the map's prize.
    #[schemars(range(min = 1e-6, max = 1e3))]
    pub prize: f64,
    /// Whether a sequence with it is better than any without. Default: false.
    #[serde(default)]
    pub mandatory: bool,
    /// When it is taken back, mission time in seconds. Default: never.
    #[schemars(range(min = 0.0))]
    pub withdraw_at_s: Option<f64>,
}

/// A place known to be worth a visit. Runs are scored with it; the rover is not told.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) struct LabelFile {
    /// Its name.
    pub name: String,
    /// The place, [row, col].
    pub at: Vec<usize>,
    /// A goal within this distance has found it, metres.
    #[schemars(range(min = 0.0, max = FAR_M))]
    pub radius_m: f64,
    /// What finding it is worth. Default: 1.
    #[serde(default = "unit_weight")]
    #[schemars(range(min = 0.0, max = 1e3))]
    pub worth: f64,
}

fn unit_weight() -> f64 {
    1.0
}

fn two_attempts() -> u32 {
    2
}

/// How the world treats the rover, which is told none of it.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields, default)]
pub(crate) struct ExecutionFile {
    /// Scatter of slip on a step: the cost of an edge is multiplied by 1 + this × a standard normal, cut at
    /// half and double. Default: 0.1.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub slip_scatter: f64,
    /// Scatter of an operator's costs, alike. Default: 0.05.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub operator_scatter: f64,
    /// Factor on the true hazard: what the rover's own hazard model is wrong by. Default: 1.
    #[schemars(range(min = 0.0, max = 1e3))]
    pub hazard_factor: f64,
    /// Time lost when a hazard aborts a drive, seconds. Default: 1800.
    #[schemars(range(min = 0.0))]
    pub recovery_s: f64,
    /// Radius within which the hazard cameras see ground that stops the rover, metres. Default: 3.
    #[schemars(range(min = 0.0, max = FAR_M))]
    pub hazard_camera_m: f64,
    /// The most decisions of one mission. Default: 500.
    #[schemars(range(min = 1, max = 1_000_000))]
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

/// What breaks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum FaultName {
    /// An instrument reads nothing.
    InstrumentLost,
    /// Driving takes more time and energy.
    WheelDrag,
    /// Every height read is wrong by the same amount.
    DemBias,
    /// Facts cease to hold; the rover is told.
    FactsLost,
    /// The rover waits after every drive that ended early.
    CommDelay,
}

/// What may break: `kind` says which of the last five keys it needs.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) struct FaultFile {
    /// Its name, unique, without `;`.
    pub name: String,
    /// What breaks.
    pub kind: FaultName,
    /// Chance that it strikes in a mission.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub probability: f64,
    /// From when to when it may strike, mission time in seconds. Default: the whole time budget.
    #[schemars(inner(range(min = 0.0, max = LATEST_S)))]
    pub between_s: Option<[f64; 2]>,
    /// How long it lasts, seconds. Default: for good.
    #[schemars(range(min = 0.0, max = LATEST_S))]
    pub lasts_s: Option<f64>,
    /// For `instrument-lost`, which needs it: the instrument.
    pub instrument: Option<String>,
    /// For `wheel-drag`, which needs it: factor on time and energy of driving.
    #[schemars(range(min = 1.0, max = 1e3))]
    pub factor: Option<f64>,
    /// For `dem-bias`, which needs it: added to every height read, metres.
    #[schemars(range(min = -1e4, max = 1e4))]
    pub bias_m: Option<f64>,
    /// For `comm-delay`, which needs it: the wait, seconds.
    #[schemars(range(min = 0.0, max = LATEST_S))]
    pub delay_s: Option<f64>,
    /// For `facts-lost`, which needs it: the facts that cease to hold.
    pub facts: Option<Vec<String>>,
}

/// A reading that is handed in.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) struct ReadingFile {
    /// The layer read.
    pub layer: String,
    /// The cell, [row, col].
    pub cell: Vec<usize>,
    /// What was read, in the layer's unit.
    pub value: f64,
    /// Its uncertainty.
    #[schemars(range(min = 0.0, max = 0.999))]
    pub u: f64,
    /// Cells nearer than this get the reading too, the further the less certain, metres. Default: 0.
    #[serde(default)]
    #[schemars(range(min = 0.0))]
    pub radius_m: f64,
    /// When it is handed in, mission time in seconds.
    #[schemars(range(min = 0.0))]
    pub at_s: f64,
}

/// An expert's table.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) struct ExpertFile {
    /// Name of the expert, by which it gets its credit.
    pub name: String,
    /// The layer it reads.
    pub layer: String,
    /// What it reads, in words.
    pub quantity: String,
    /// Unit of what it reads; must be the layer's. Default: none.
    #[serde(default)]
    pub unit: String,
    /// Rows by half-open band of readings.
    #[serde(default)]
    pub band: Vec<BandFile>,
    /// Rows by class.
    #[serde(default)]
    pub class: Vec<ClassFile>,
    /// Row for readings that no band or class holds.
    pub outside: OpinionFile,
}

/// What the expert says of readings from `from` up to, but not with, `to`; what the masses leave to 1 is ignorance.
#[derive(Debug, Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) struct BandFile {
    /// The least reading of the band, in the table's unit. Default: no limit.
    #[serde(default = "minus_infinity")]
    pub from: f64,
    /// The least reading above the band, in the table's unit. Default: no limit.
    #[serde(default = "infinity")]
    pub to: f64,
    /// m(I ∩ NI): mass of both at once, in [0, 1].
    #[schemars(range(min = 0.0, max = 1.0))]
    pub paradox: f64,
    /// m(NI): mass of *not interesting*, in [0, 1].
    #[schemars(range(min = 0.0, max = 1.0))]
    pub not_interesting: f64,
    /// m(I): mass of *interesting*, in [0, 1].
    #[schemars(range(min = 0.0, max = 1.0))]
    pub interesting: f64,
}

fn minus_infinity() -> f64 {
    f64::NEG_INFINITY
}

fn infinity() -> f64 {
    f64::INFINITY
}

/// What the expert says of a class; what the masses leave to 1 is ignorance.
#[derive(Debug, Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) struct ClassFile {
    /// The class.
    pub value: i32,
    /// m(I ∩ NI): mass of both at once, in [0, 1].
    #[schemars(range(min = 0.0, max = 1.0))]
    pub paradox: f64,
    /// m(NI): mass of *not interesting*, in [0, 1].
    #[schemars(range(min = 0.0, max = 1.0))]
    pub not_interesting: f64,
    /// m(I): mass of *interesting*, in [0, 1].
    #[schemars(range(min = 0.0, max = 1.0))]
    pub interesting: f64,
}

/// What the expert says of all other readings; what the masses leave to 1 is ignorance.
#[derive(Debug, Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) struct OpinionFile {
    /// m(I ∩ NI): mass of both at once, in [0, 1].
    #[schemars(range(min = 0.0, max = 1.0))]
    pub paradox: f64,
    /// m(NI): mass of *not interesting*, in [0, 1].
    #[schemars(range(min = 0.0, max = 1.0))]
    pub not_interesting: f64,
    /// m(I): mass of *interesting*, in [0, 1].
    #[schemars(range(min = 0.0, max = 1.0))]
    pub interesting: f64,
}
