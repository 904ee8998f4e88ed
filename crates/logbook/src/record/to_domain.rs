//! Records back into domain types, checked field by field.

use wisdom_autonomy as core;
use wisdom_goals::{self as goals, GoalId, Reason, Status};
use wisdom_grid as grid;

use super::{
    Cell, Decision, Goal, LayerWindow, ManagerState, Message, Observation, Outcome, Pose, Retired,
    Spent, State, Trigger,
};
use crate::LogError;

/// The record being read, to be named if it is malformed.
struct Reading<'a> {
    kind: &'a str,
    number: u32,
}

impl Reading<'_> {
    fn malformed(&self, field: &str, found: &dyn ToString, limit: &'static str) -> LogError {
        LogError::Malformed {
            record: format!("{} {}", self.kind, self.number),
            field: field.to_owned(),
            found: found.to_string(),
            limit,
        }
    }

    fn present<T>(&self, field: &str, value: Option<T>) -> Result<T, LogError> {
        value.ok_or_else(|| self.malformed(field, &"absent", "there"))
    }

    fn finite(&self, field: &str, value: f64) -> Result<f64, LogError> {
        if value.is_finite() { Ok(value) } else { Err(self.malformed(field, &value, "finite")) }
    }

    fn cell(&self, field: &str, cell: Option<&Cell>) -> Result<grid::Cell, LogError> {
        let cell = self.present(field, cell)?;
        Ok(grid::Cell::new(self.side(field, cell.row)?, self.side(field, cell.col)?))
    }

    /// A row, a column, or a number of them.
    fn side(&self, field: &str, value: u32) -> Result<usize, LogError> {
        let value = value as usize;
        if value <= grid::MAX_SIDE {
            Ok(value)
        } else {
            Err(self.malformed(field, &value, "at most the longest side of a grid, 65535"))
        }
    }

    fn pose(&self, pose: Option<&Pose>) -> Result<core::Pose, LogError> {
        let pose = self.present("pose", pose)?;
        Ok(core::Pose {
            cell: self.cell("pose.cell", pose.cell.as_ref())?,
            heading_rad: self.finite("pose.heading_rad", pose.heading_rad)?,
        })
    }

    fn spent(&self, spent: Option<&Spent>) -> Result<core::Spent, LogError> {
        let spent = self.present("spent", spent)?;
        Ok(core::Spent {
            time_s: self.finite("spent.time_s", spent.time_s)?,
            energy_j: self.finite("spent.energy_j", spent.energy_j)?,
            data_mb: self.finite("spent.data_mb", spent.data_mb)?,
            length_m: self.finite("spent.length_m", spent.length_m)?,
        })
    }

    fn window(&self, reading: &LayerWindow) -> Result<core::LayerWindow, LogError> {
        let side =
            |field: &str, value: u32| self.side(&format!("{}.{field}", reading.layer), value);
        let window = grid::Window {
            row: side("row", reading.row)?,
            col: side("col", reading.col)?,
            rows: side("rows", reading.rows)?,
            cols: side("cols", reading.cols)?,
        };
        let cells = window.rows * window.cols;
        for (field, values) in [("values", &reading.values), ("uncertainty", &reading.uncertainty)]
        {
            let field = format!("{}.{field}", reading.layer);
            if values.len() != cells {
                let found = format!("{} numbers for {window}", values.len());
                return Err(self.malformed(&field, &found, "one for each cell of the window"));
            }
            if let Some(value) = values.iter().find(|value| !value.is_finite()) {
                return Err(self.malformed(&field, &value, "finite"));
            }
        }
        if let Some(u) = reading.uncertainty.iter().find(|u| !(0.0..=1.0).contains(*u)) {
            return Err(self.malformed(&format!("{}.uncertainty", reading.layer), &u, "in [0, 1]"));
        }
        Ok(core::LayerWindow {
            layer: reading.layer.clone(),
            window,
            values: reading.values.clone(),
            uncertainty: reading.uncertainty.clone(),
        })
    }

    fn reason(&self, field: &str, name: &str) -> Result<Reason, LogError> {
        Reason::ALL
            .iter()
            .copied()
            .find(|reason| reason.to_string() == name)
            .ok_or_else(|| self.malformed(field, &name, "the name of a reason"))
    }

    fn goal(&self, goal: &Goal) -> Result<goals::Goal, LogError> {
        let field = |name: &str| format!("manager.goals[G{}].{name}", goal.id);
        let finite = |name: &str, value: f64| self.finite(&field(name), value);
        for (index, &share) in goal.credit.iter().enumerate() {
            finite(&format!("credit[{index}]"), share)?;
        }
        let status = Status::ALL.iter().copied().find(|status| status.name() == goal.status);
        let status = status.ok_or_else(|| {
            self.malformed(&field("status"), &goal.status, "the name of a goal's status")
        })?;
        let first = self.cell(&field("extent_first"), goal.extent_first.as_ref())?;
        let side = |name: &str, value: u32| self.side(&field(name), value);
        let order = match &goal.order {
            None => None,
            Some(order) => Some(goals::Order {
                name: order.name.clone(),
                prize: finite("order.prize", order.prize)?,
                mandatory: order.mandatory,
                before: match (order.directive_before, &order.target_before) {
                    (Some(directive), target @ Some(_)) => {
                        let target = self.cell(&field("order.target_before"), target.as_ref())?;
                        Some((directive as usize, target))
                    }
                    _ => None,
                },
            }),
        };
        let pose = match &goal.pose {
            None => None,
            pose => Some(self.cell(&field("pose"), pose.as_ref())?),
        };
        Ok(goals::Goal {
            id: GoalId(goal.id),
            directive: goal.directive as usize,
            target: self.cell(&field("target"), goal.target.as_ref())?,
            interest: finite("interest", goal.interest)?,
            prize: finite("prize", goal.prize)?,
            prominence: finite("prominence", goal.prominence)?,
            ignorance: finite("ignorance", goal.ignorance)?,
            paradox: finite("paradox", goal.paradox)?,
            credit: goal.credit.clone(),
            region_cells: goal.region_cells as usize,
            attempts: goal.attempts,
            born: goal.born,
            contradiction: finite("contradiction", goal.contradiction)?,
            extent: grid::Window {
                row: first.row,
                col: first.col,
                rows: side("extent_rows", goal.extent_rows)?,
                cols: side("extent_cols", goal.extent_cols)?,
            },
            doubt: finite("doubt", goal.doubt)?,
            parent: goal.parent.map(GoalId),
            order,
            pose,
            operators: goal.operators.iter().map(|&index| index as usize).collect(),
            life: goals::Life::recorded(status),
        })
    }

    fn trigger(&self, trigger: &Trigger) -> Result<core::Trigger, LogError> {
        use core::Trigger as Why;
        let field = |name: &str| format!("triggers.{}.{name}", trigger.name);
        let number = |name: &str, value: Option<f64>| {
            self.finite(&field(name), self.present(&field(name), value)?)
        };
        let goal = || self.present(&field("goal"), trigger.goal).map(GoalId);
        let cell = || self.cell(&field("cell"), trigger.cell.as_ref());
        let before = || number("before", trigger.before);
        let after = || number("after", trigger.after);
        let seconds = || number("seconds", trigger.seconds);
        let message = || self.present(&field("message"), trigger.message);
        Ok(match trigger.name.as_str() {
            "start" => Why::Start,
            "woken" => Why::Woken,
            "arrived" => Why::Arrived,
            "stopped" => Why::Stopped,
            "goal-ended" => Why::GoalEnded(goal()?),
            "leg-failed" => Why::LegFailed(goal()?),
            "leg-interrupted" => Why::LegInterrupted(goal()?),
            "interest-changed" => {
                Why::InterestChanged { goal: goal()?, before: before()?, after: after()? }
            }
            "conflict" => Why::Conflict { goal: goal()?, before: before()?, after: after()? },
            "new-candidate" => {
                Why::NewCandidate { cell: cell()?, prize: number("prize", trigger.prize)? }
            }
            "budget-drift" => Why::BudgetDrift { share: number("share", trigger.share)? },
            "risk" => Why::Risk {
                reliability: number("reliability", trigger.reliability)?,
                floor: number("floor", trigger.floor)?,
            },
            "corridor-changed" => {
                Why::CorridorChanged { cell: cell()?, before: before()?, after: after()? }
            }
            "window-closing" => Why::WindowClosing { goal: goal()?, left_s: seconds()? },
            "command" => Why::Command { number: message()? },
            "facts" => Why::Facts { number: message()? },
            "cadence" => Why::Cadence { since_s: seconds()? },
            "watchdog" => Why::Watchdog { since_s: seconds()? },
            "route-blocked" => Why::RouteBlocked(cell()?),
            other => return Err(self.malformed("triggers", &other, "the name of a trigger")),
        })
    }

    fn retired(&self, place: &Retired) -> Result<goals::Retired, LogError> {
        let field = |name: &str| format!("manager.retired[G{}].{name}", place.goal);
        Ok(goals::Retired {
            goal: GoalId(place.goal),
            kind: place.kind.parse().map_err(|_| {
                self.malformed(&field("kind"), &place.kind, "inspect, look-again or adjudicate")
            })?,
            target: self.cell(&field("target"), place.target.as_ref())?,
            radius_m: self.finite(&field("radius_m"), place.radius_m)?,
            reason: self.reason(&field("reason"), &place.reason)?,
            heard: place.heard,
            ground: place.ground,
            reopenings: place.reopenings,
            closed: place.closed,
        })
    }
}

impl From<Cell> for grid::Cell {
    fn from(cell: Cell) -> Self {
        Self::new(cell.row as usize, cell.col as usize)
    }
}

impl Decision {
    /// Where the rover stood and what it had spent, checked.
    pub(crate) fn whereabouts(&self) -> Result<(core::Pose, core::Spent), LogError> {
        let reading = Reading { kind: "decision", number: self.number };
        let state = reading.present("state", self.state.as_ref())?;
        Ok((reading.pose(state.pose.as_ref())?, reading.spent(state.spent.as_ref())?))
    }

    /// What the record says the decision was taken from. Directives, operators and experts are those of the run, by
    /// index; facts are numbered by `facts`.
    pub(crate) fn moment(
        &self,
        facts: impl FnOnce(&[String]) -> Result<goals::FactSet, goals::DomainError>,
    ) -> Result<core::Moment, LogError> {
        let reading = Reading { kind: "decision", number: self.number };
        let (pose, spent) = self.whereabouts()?;
        let State { facts: names, underway, idle_looks, manager, .. } =
            reading.present("state", self.state.as_ref())?;
        let manager = reading.present("state.manager", manager.as_ref())?;
        let facts = facts(names)
            .map_err(|error| reading.malformed("state.facts", &error, "facts of the mission"))?;
        let frame = reading.present("frame", self.frame.as_ref())?;
        let triggers = self.triggers.iter().map(|trigger| reading.trigger(trigger));
        Ok(core::Moment {
            number: self.number,
            triggers: triggers.collect::<Result<_, _>>()?,
            state: core::RoverState {
                pose,
                spent,
                facts,
                underway: underway.map(GoalId),
                idle_looks: *idle_looks,
                manager: manager.try_into()?,
            },
            map_changed: frame.map_changed,
        })
    }
}

impl TryFrom<&Observation> for core::Observation {
    type Error = LogError;

    fn try_from(record: &Observation) -> Result<Self, LogError> {
        let reading = Reading { kind: "observation", number: record.number };
        Ok(Self {
            number: record.number,
            pose: reading.pose(record.pose.as_ref())?,
            spent: reading.spent(record.spent.as_ref())?,
            windows: record
                .windows
                .iter()
                .map(|window| reading.window(window))
                .collect::<Result<_, _>>()?,
        })
    }
}

impl TryFrom<&Outcome> for core::Outcome {
    type Error = LogError;

    fn try_from(record: &Outcome) -> Result<Self, LogError> {
        use core::StepResult as Step;
        let reading = Reading { kind: "outcome of decision", number: record.decision };
        let goal = || reading.present("goal", record.goal).map(GoalId);
        let result = match record.result.as_str() {
            "achieved" => Step::Achieved(goal()?),
            "blocked" => Step::Blocked(goal()?),
            "aborted" => Step::Aborted(goal()?),
            "interrupted" => Step::Interrupted(goal()?),
            "arrived" => Step::Arrived,
            "stopped" => Step::Stopped,
            other => {
                return Err(reading.malformed("result", &other, "the name of a step's result"));
            }
        };
        Ok(Self {
            decision: record.decision,
            result,
            operators: record.operators.clone(),
            pose: reading.pose(record.pose.as_ref())?,
            spent: reading.spent(record.spent.as_ref())?,
            predicted_reliability: reading
                .finite("predicted_reliability", record.predicted_reliability)?,
            track: record
                .track
                .iter()
                .map(|cell| reading.cell("track", Some(cell)))
                .collect::<Result<_, _>>()?,
        })
    }
}

impl TryFrom<&ManagerState> for goals::ManagerState {
    type Error = LogError;

    /// The memory of a goal manager, to take a decision again from where it was taken.
    fn try_from(record: &ManagerState) -> Result<Self, LogError> {
        let reading = Reading { kind: "decision", number: record.decision };
        let event = |event: &super::Event| match event.kind.as_str() {
            "achieved" => Ok((GoalId(event.goal), goals::Event::Achieved)),
            "failed" => Ok((GoalId(event.goal), goals::Event::Failed)),
            other => Err(reading.malformed("manager.events.kind", &other, "achieved or failed")),
        };
        let tries = |tries: &super::Tries| {
            let target = reading.cell("manager.tries.target", tries.target.as_ref())?;
            Ok::<_, LogError>(goals::Tries { target, failed: tries.failed })
        };
        let command = |command: &super::Command| {
            let wish = match command.directive {
                None => goals::Wish::Withdraw,
                Some(directive) => goals::Wish::Pursue {
                    directive: directive as usize,
                    target: reading.cell("manager.commands.target", command.target.as_ref())?,
                    prize: reading.finite("manager.commands.prize", command.prize)?,
                    mandatory: command.mandatory,
                },
            };
            Ok::<_, LogError>(goals::Command { name: command.name.clone(), wish })
        };
        let mut known = std::collections::BTreeMap::new();
        for record in &record.goals {
            let goal = reading.goal(record)?;
            if let Some(twice) = known.insert(goal.id, goal) {
                return Err(reading.malformed("manager.goals", &twice.id, "there once"));
            }
        }
        Ok(Self {
            goals: known,
            agenda: record.agenda.iter().map(|&id| GoalId(id)).collect(),
            retired: record
                .retired
                .iter()
                .map(|place| reading.retired(place))
                .collect::<Result<_, _>>()?,
            events: record.events.iter().map(event).collect::<Result<_, _>>()?,
            commands: record.commands.iter().map(command).collect::<Result<_, _>>()?,
            tries: record.tries.iter().map(tries).collect::<Result<_, _>>()?,
            next_id: record.next_id,
            decision: record.decision,
        })
    }
}

impl TryFrom<&Message> for core::Message {
    type Error = LogError;

    fn try_from(record: &Message) -> Result<Self, LogError> {
        let reading = Reading { kind: "message", number: record.number };
        let name = record.name.clone();
        let word = match record.kind.as_str() {
            "pursue" => core::Word::Pursue {
                name,
                directive: record.directive.clone(),
                target: reading.cell("target", record.target.as_ref())?,
                prize: reading.finite("prize", reading.present("prize", record.prize)?)?,
                mandatory: record.mandatory,
            },
            "withdraw" => core::Word::Withdraw { name },
            "facts" => {
                core::Word::Facts { adds: record.adds.clone(), deletes: record.deletes.clone() }
            }
            other => {
                return Err(reading.malformed("kind", &other, "pursue, withdraw or facts"));
            }
        };
        Ok(Self { number: record.number, word })
    }
}
