//! The lines of the bridge, as JSON has them, and what the core makes of them. Keys that are not known are refused.

use serde::{Deserialize, Serialize};
use wisdom_autonomy::{
    Act, Decision, LayerWindow, Message, Observation, Pose, Spec, Spent, Trigger, Word,
};
use wisdom_goals::{FactSet, Term, Verdict};
use wisdom_grid::{Cell, Window};
use wisdom_planner::Route;

/// A line that comes in.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Frame {
    /// Clock, pose, resources and readings.
    Observation(ObservationLine),
    /// What came of the step that was asked for.
    Outcome(OutcomeLine),
    /// Word from the ground or from a health watch.
    Message(MessageLine),
    /// A decision is wanted now.
    Decide(DecideLine),
}

/// A cell, as its row from the north and its column from the west.
pub(crate) type CellLine = [u32; 2];

/// Where the rover stands and faces.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PoseLine {
    /// The cell.
    pub(crate) cell: CellLine,
    /// Radians clockwise from north.
    pub(crate) heading_rad: f64,
}

/// What has been spent since the mission began.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SpentLine {
    /// Seconds.
    pub(crate) time_s: f64,
    /// Joules.
    pub(crate) energy_j: f64,
    /// Megabytes.
    pub(crate) data_mb: f64,
    /// Metres.
    pub(crate) length_m: f64,
}

/// Readings of one layer.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct WindowLine {
    /// The layer.
    pub(crate) layer: String,
    /// Its north-west cell.
    pub(crate) first: CellLine,
    /// Rows.
    pub(crate) rows: u32,
    /// Columns.
    pub(crate) cols: u32,
    /// Readings, row by row.
    pub(crate) values: Vec<f32>,
    /// Their uncertainties.
    pub(crate) uncertainty: Vec<f32>,
}

/// An observation.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ObservationLine {
    /// From 0.
    pub(crate) number: u32,
    /// Where the rover stands.
    pub(crate) pose: PoseLine,
    /// What has been spent.
    pub(crate) spent: SpentLine,
    /// What was read.
    pub(crate) windows: Vec<WindowLine>,
}

/// How a step ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum ResultLine {
    /// The goal was done.
    Achieved,
    /// The way was blocked.
    Blocked,
    /// A hazard ended the drive.
    Aborted,
    /// The core asked for a decision on the way.
    Interrupted,
    /// The vantage or home was reached.
    Arrived,
    /// The drive to it ended on the way.
    Stopped,
}

/// An outcome.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct OutcomeLine {
    /// The decision answered.
    pub(crate) decision: u32,
    /// How its step ended.
    pub(crate) result: ResultLine,
    /// Operators carried out, in order.
    pub(crate) operators: Vec<String>,
    /// Where the rover stands.
    pub(crate) pose: PoseLine,
    /// What has been spent.
    pub(crate) spent: SpentLine,
    /// Cells entered, the first one included.
    pub(crate) track: Vec<CellLine>,
}

/// A message.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct MessageLine {
    /// From 0.
    pub(crate) number: u32,
    /// What it says.
    pub(crate) word: WordLine,
}

/// What a message says.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) enum WordLine {
    /// The ground wants something done at a place.
    Pursue {
        /// The command's name.
        name: String,
        /// The directive to follow.
        directive: String,
        /// The place.
        target: CellLine,
        /// What it is worth.
        prize: f64,
        /// Whether it must be done if it can.
        mandatory: bool,
    },
    /// The ground takes a command back.
    Withdraw {
        /// The command's name.
        name: String,
    },
    /// Facts changed that no operator changed.
    Facts {
        /// Facts that hold now.
        adds: Vec<String>,
        /// Facts that hold no longer.
        deletes: Vec<String>,
    },
}

/// Nothing: to ask is all.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct DecideLine {}

/// A line that goes out.
#[derive(Debug, Clone, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Reply {
    /// What to do, and why.
    Decision(Box<DecisionLine>),
    /// Something calls for a decision while a step is under way: end it and say how.
    Asks(AsksLine),
}

/// A call for the end of the step under way.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct AsksLine {
    /// The decision whose step it is.
    pub(crate) decision: u32,
    /// What calls for the next.
    pub(crate) triggers: Vec<String>,
}

/// A decision.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct DecisionLine {
    /// From 0.
    pub(crate) number: u32,
    /// Why it was due.
    pub(crate) triggers: Vec<String>,
    /// Where the rover stood.
    pub(crate) pose: PoseLine,
    /// `pursue`, `look`, `home` or `wait`.
    pub(crate) act: &'static str,
    /// The goal pursued.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) goal: Option<String>,
    /// What the goal is about.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) target: Option<CellLine>,
    /// What would end a wait.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) wake: Option<String>,
    /// Operators before the wheels turn.
    pub(crate) before: Vec<String>,
    /// Cells to drive, the first one included.
    pub(crate) route: Vec<CellLine>,
    /// Operators at the end of the route.
    pub(crate) after: Vec<String>,
    /// What the drive is expected to cost.
    pub(crate) cost: CostLine,
    /// The goals in the order they are to be done.
    pub(crate) sequence: Vec<StopLine>,
    /// What was said of every known goal.
    pub(crate) goals: Vec<GoalLine>,
}

/// What a drive is expected to cost.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct CostLine {
    /// Metres.
    pub(crate) length_m: f64,
    /// Seconds.
    pub(crate) time_s: f64,
    /// Joules.
    pub(crate) energy_j: f64,
    /// Chance to arrive.
    pub(crate) reliability: f64,
}

/// A goal of the sequence.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct StopLine {
    /// The goal.
    pub(crate) goal: String,
    /// Its target.
    pub(crate) target: CellLine,
    /// Its prize.
    pub(crate) prize: f64,
}

/// What was said of a goal.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct GoalLine {
    /// The goal.
    pub(crate) goal: String,
    /// Its target.
    pub(crate) target: CellLine,
    /// Its prize.
    pub(crate) prize: f64,
    /// What was done with it.
    pub(crate) action: &'static str,
    /// Why.
    pub(crate) reason: &'static str,
    /// The numbers compared.
    pub(crate) terms: Vec<TermLine>,
}

/// A number that was compared, and what with.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct TermLine {
    /// What it is.
    pub(crate) name: &'static str,
    /// The number; null if infinite.
    pub(crate) value: Option<f64>,
    /// What it was compared with; null if nothing or infinite.
    pub(crate) limit: Option<f64>,
}

/// A line that was refused.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Refusal {
    /// Its number, from 1.
    pub(crate) line: usize,
    /// What is wrong with it.
    pub(crate) error: String,
}

fn cell([row, col]: CellLine) -> Cell {
    Cell::new(row as usize, col as usize)
}

fn cell_line(cell: Cell) -> CellLine {
    [cell.row as u32, cell.col as u32]
}

impl From<PoseLine> for Pose {
    fn from(line: PoseLine) -> Self {
        Self { cell: cell(line.cell), heading_rad: line.heading_rad }
    }
}

impl From<SpentLine> for Spent {
    fn from(line: SpentLine) -> Self {
        let SpentLine { time_s, energy_j, data_mb, length_m } = line;
        Self { time_s, energy_j, data_mb, length_m }
    }
}

impl From<ObservationLine> for Observation {
    fn from(line: ObservationLine) -> Self {
        let window = |read: WindowLine| LayerWindow {
            layer: read.layer,
            window: Window {
                row: read.first[0] as usize,
                col: read.first[1] as usize,
                rows: read.rows as usize,
                cols: read.cols as usize,
            },
            values: read.values,
            uncertainty: read.uncertainty,
        };
        Self {
            number: line.number,
            pose: line.pose.into(),
            spent: line.spent.into(),
            windows: line.windows.into_iter().map(window).collect(),
        }
    }
}

impl OutcomeLine {
    /// The cells entered.
    pub(crate) fn track(&self) -> Vec<Cell> {
        self.track.iter().copied().map(cell).collect()
    }
}

impl From<MessageLine> for Message {
    fn from(line: MessageLine) -> Self {
        let word = match line.word {
            WordLine::Pursue { name, directive, target, prize, mandatory } => {
                Word::Pursue { name, directive, target: cell(target), prize, mandatory }
            }
            WordLine::Withdraw { name } => Word::Withdraw { name },
            WordLine::Facts { adds, deletes } => Word::Facts { adds, deletes },
        };
        Self { number: line.number, word }
    }
}

/// Triggers in words.
pub(crate) fn texts(triggers: &[Trigger]) -> Vec<String> {
    triggers.iter().map(ToString::to_string).collect()
}

fn goal_line(verdict: &Verdict) -> GoalLine {
    let finite = |number: f64| number.is_finite().then_some(number);
    let term = |term: &Term| TermLine {
        name: term.name,
        value: finite(term.value),
        limit: term.limit.and_then(finite),
    };
    GoalLine {
        goal: verdict.goal.id.to_string(),
        target: cell_line(verdict.goal.target),
        prize: verdict.goal.prize,
        action: verdict.action.name(),
        reason: verdict.reason.name(),
        terms: verdict.terms.iter().map(term).collect(),
    }
}

impl DecisionLine {
    /// A decision of a core with this spec, as a line.
    pub(crate) fn of(decision: &Decision, spec: &Spec) -> Self {
        let chosen = decision.plan();
        let names = |operators: &[usize]| -> Vec<String> {
            operators.iter().map(|&o| spec.domain.operators()[o].name.clone()).collect()
        };
        let cells = |route: &Route| route.cells.iter().copied().map(cell_line).collect();
        let goals = &decision.manager_after.goals;
        let stop = |stop: &wisdom_goals::Stop| StopLine {
            goal: stop.goal.to_string(),
            target: cell_line(goals[&stop.goal].target),
            prize: goals[&stop.goal].prize,
        };
        let mut line = Self {
            number: decision.number,
            triggers: texts(&decision.triggers),
            pose: PoseLine {
                cell: cell_line(decision.state.pose.cell),
                heading_rad: decision.state.pose.heading_rad,
            },
            act: decision.act.name(),
            goal: None,
            target: None,
            wake: None,
            before: Vec::new(),
            route: Vec::new(),
            after: Vec::new(),
            cost: CostLine {
                length_m: decision.act_cost.length_m,
                time_s: decision.act_cost.time_s,
                energy_j: decision.act_cost.energy_j,
                reliability: decision.act_cost.reliability(),
            },
            sequence: chosen.sequence.stops.iter().map(stop).collect(),
            goals: decision.verdicts.iter().map(goal_line).collect(),
        };
        match &decision.act {
            Act::Pursue(goal) => {
                line.goal = Some(goal.to_string());
                line.target = Some(cell_line(goals[goal].target));
                // What is pursued is the first stop of the plan chosen.
                if let (Some(stop), Some(leg)) =
                    (chosen.sequence.stops.first(), chosen.plan.legs.first())
                {
                    line.before = names(&stop.expansion.before);
                    line.route = cells(&leg.route);
                    line.after = names(&stop.expansion.after);
                }
            }
            Act::Look { route, .. } | Act::Home { route } => {
                // Whatever must be true before driving has to be brought about here too.
                let ready = spec.domain.expand(decision.state.facts, FactSet::EMPTY);
                line.before = ready.map(|ready| names(&ready.before)).unwrap_or_default();
                line.route = cells(route);
            }
            Act::Wait { wake } => line.wake = Some(wake.to_string()),
            _ => {}
        }
        line
    }
}
