//! What comes into the core: observations and outcomes. All chance enters here.

use wisdom_goals::GoalId;
use wisdom_grid::{Cell, Window};

/// Where the rover stands and which way it faces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// The cell.
    pub cell: Cell,
    /// Heading, radians clockwise from north.
    pub heading_rad: f64,
}

/// What has been spent since the mission began.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Spent {
    /// Time, seconds: the mission clock.
    pub time_s: f64,
    /// Energy, joules.
    pub energy_j: f64,
    /// Data volume, megabytes.
    pub data_mb: f64,
    /// Way driven, metres.
    pub length_m: f64,
}

/// Readings of one layer in a window: exactly the numbers the core is to use, noise included.
#[derive(Debug, Clone, PartialEq)]
pub struct LayerWindow {
    /// The layer read.
    pub layer: String,
    /// The cells read.
    pub window: Window,
    /// Readings, row by row, in the layer's unit; 0 where nothing was read.
    pub values: Vec<f32>,
    /// Uncertainties in [0, 1], row by row; 1 where nothing was read.
    pub uncertainty: Vec<f32>,
}

/// One observation: clock, pose, resources, and windows of readings.
#[derive(Debug, Clone, PartialEq)]
pub struct Observation {
    /// Number of the observation, from 0.
    pub number: u32,
    /// Where the rover stands.
    pub pose: Pose,
    /// What has been spent so far.
    pub spent: Spent,
    /// What was read.
    pub windows: Vec<LayerWindow>,
}

/// Word that reaches the core: from the ground, or from the rover's own health watch.
#[derive(Debug, Clone, PartialEq)]
pub struct Message {
    /// Number of the message, from 0.
    pub number: u32,
    /// What it says.
    pub word: Word,
}

/// What a message says.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Word {
    /// The ground wants something done at a place.
    Pursue {
        /// The command's name, by which it can be taken back.
        name: String,
        /// The directive to follow, by name.
        directive: String,
        /// The place.
        target: Cell,
        /// What it is worth, in the place of the map's prize.
        prize: f64,
        /// Whether a sequence with it is better than any without.
        mandatory: bool,
    },
    /// The ground takes a command back.
    Withdraw {
        /// The command's name.
        name: String,
    },
    /// Facts changed that no operator changed: something broke, or works again.
    Facts {
        /// Facts that hold now.
        adds: Vec<String>,
        /// Facts that hold no longer.
        deletes: Vec<String>,
    },
}

/// How the step that a decision asked for ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum StepResult {
    /// The goal's operators were all carried out.
    Achieved(GoalId),
    /// The way to the goal was blocked by ground that the map did not know.
    Blocked(GoalId),
    /// The drive was aborted by a hazard.
    Aborted(GoalId),
    /// The core asked for a decision while the leg was under way.
    Interrupted(GoalId),
    /// The vantage or home cell was reached.
    Arrived,
    /// The drive to the vantage or home cell ended on the way.
    Stopped,
}

/// How the step last decided went.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// The decision it answers.
    pub decision: u32,
    /// How it ended.
    pub result: StepResult,
    /// Operators carried out, by name, in order (the drive among them once wheels turned).
    pub operators: Vec<String>,
    /// Where the rover stands.
    pub pose: Pose,
    /// What has been spent so far.
    pub spent: Spent,
    /// Predicted reliability of the leg when it was decided, to be held against what happened; 1 if the
    /// step was not a drive.
    pub predicted_reliability: f64,
    /// Cells entered, in order, the starting cell first.
    pub track: Vec<Cell>,
}
