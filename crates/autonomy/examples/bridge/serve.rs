//! The bridge itself: one core, lines in, lines out.

use std::io::{self, BufRead, Write};

use serde::Serialize;
use wisdom_autonomy::{Act, Autonomy, AutonomyError, Decision, Outcome, Spec, StepResult};

use crate::lines::{
    AsksLine, DecisionLine, Frame, OutcomeLine, PoseLine, Refusal, Reply, ResultLine, texts,
};

/// What a refused line does to the rest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Refusals {
    /// The core is as it was before the line; the next one is read.
    GoOn,
    /// Nothing more is read.
    End,
}

/// A core and the step it waits for.
pub(crate) struct Bridge {
    core: Autonomy,
    underway: Option<Underway>,
}

/// A step that was asked for and whose outcome has not come.
struct Underway {
    decision: u32,
    act: Act,
    reliability: f64,
}

impl Bridge {
    /// A bridge to a core that has seen nothing.
    ///
    /// # Errors
    /// [`AutonomyError`] if the spec does not hold together.
    pub(crate) fn new(spec: Spec) -> Result<Self, AutonomyError> {
        Ok(Self { core: Autonomy::new(spec)?, underway: None })
    }

    /// Takes in a line. What it is answered with, if it calls for an answer.
    ///
    /// # Errors
    /// Why the line is refused, in words. The core is then as it was before.
    pub(crate) fn take(&mut self, line: &[u8]) -> Result<Option<Reply>, String> {
        let frame: Frame = serde_json::from_slice(line).map_err(|error| error.to_string())?;
        let told = |error: AutonomyError| error.to_string();
        match frame {
            Frame::Observation(line) => {
                heading(line.pose)?;
                self.core.observe(&line.into()).map_err(told)?;
                self.answer().map_err(told)
            }
            Frame::Message(line) => {
                self.core.hear(&line.into()).map_err(told)?;
                // Before the first observation there is nothing to decide on.
                if self.core.maps().is_none() { Ok(None) } else { self.answer().map_err(told) }
            }
            Frame::Outcome(line) => {
                self.outcome(&line)?;
                Ok(None)
            }
            Frame::Decide(_) => match &self.underway {
                Some(step) => Err(format!(
                    "a decision was asked for while the step of decision {} is under way; its outcome comes first",
                    step.decision
                )),
                None => self.decide().map(Some).map_err(told),
            },
        }
    }

    /// Decides if something calls for it; if the rover is busy, says so.
    fn answer(&mut self) -> Result<Option<Reply>, AutonomyError> {
        if self.core.triggers().is_empty() {
            return Ok(None);
        }
        match &self.underway {
            Some(step) => {
                let triggers = texts(self.core.triggers());
                Ok(Some(Reply::Asks(AsksLine { decision: step.decision, triggers })))
            }
            None => self.decide().map(Some),
        }
    }

    fn decide(&mut self) -> Result<Reply, AutonomyError> {
        let decision: Decision = self.core.decide()?;
        let line = DecisionLine::of(&decision, self.core.spec());
        let waits = matches!(decision.act, Act::Wait { .. });
        self.underway = (!waits).then_some(Underway {
            decision: decision.number,
            reliability: decision.act_cost.reliability(),
            act: decision.act,
        });
        Ok(Reply::Decision(Box::new(line)))
    }

    fn outcome(&mut self, line: &OutcomeLine) -> Result<(), String> {
        heading(line.pose)?;
        let Some(step) = &self.underway else {
            return Err(format!(
                "an outcome of decision {} came while no step is under way",
                line.decision
            ));
        };
        let outcome = Outcome {
            decision: line.decision,
            result: result(line.result, &step.act)?,
            operators: line.operators.clone(),
            pose: line.pose.into(),
            spent: line.spent.into(),
            predicted_reliability: step.reliability,
            track: line.track(),
        };
        self.core.report(&outcome).map_err(|error| error.to_string())?;
        self.underway = None;
        Ok(())
    }
}

/// The result of a step, if such a step can end so.
fn result(line: ResultLine, act: &Act) -> Result<StepResult, String> {
    match (line, act) {
        (ResultLine::Achieved, Act::Pursue(goal)) => Ok(StepResult::Achieved(*goal)),
        (ResultLine::Blocked, Act::Pursue(goal)) => Ok(StepResult::Blocked(*goal)),
        (ResultLine::Aborted, Act::Pursue(goal)) => Ok(StepResult::Aborted(*goal)),
        (ResultLine::Interrupted, Act::Pursue(goal)) => Ok(StepResult::Interrupted(*goal)),
        (ResultLine::Arrived, Act::Look { .. } | Act::Home { .. }) => Ok(StepResult::Arrived),
        (ResultLine::Stopped, Act::Look { .. } | Act::Home { .. }) => Ok(StepResult::Stopped),
        _ => Err(format!(
            "{line:?} is no end of the act `{}`; pursue ends achieved, blocked, aborted or interrupted, look and home end arrived or stopped",
            act.name()
        )),
    }
}

/// A heading is an angle: JSON has no infinity, but a number may be too large to be turned by.
fn heading(pose: PoseLine) -> Result<(), String> {
    const TURN: f64 = std::f64::consts::TAU;
    if pose.heading_rad.abs() <= TURN {
        return Ok(());
    }
    Err(format!("a heading of {} rad; expected at most one turn, {TURN:.4}", pose.heading_rad))
}

/// Reads frames until the input ends and answers each at once. The number of lines refused.
///
/// # Errors
/// What reading or writing says; [`AutonomyError`], as an [`io::Error`], if the spec does not hold together.
pub(crate) fn serve(
    spec: Spec,
    mut input: impl BufRead,
    mut output: impl Write,
    mut errors: impl Write,
    refusals: Refusals,
) -> io::Result<usize> {
    let mut bridge = Bridge::new(spec).map_err(io::Error::other)?;
    let (mut number, mut refused) = (0, 0);
    let mut line = Vec::new();
    loop {
        line.clear();
        if input.read_until(b'\n', &mut line)? == 0 {
            return Ok(refused);
        }
        number += 1;
        if line.trim_ascii().is_empty() {
            continue;
        }
        match bridge.take(&line) {
            Ok(None) => {}
            Ok(Some(reply)) => write_line(&mut output, &reply)?,
            Err(error) => {
                refused += 1;
                write_line(&mut errors, &Refusal { line: number, error })?;
                if refusals == Refusals::End {
                    return Ok(refused);
                }
            }
        }
    }
}

/// A line of JSON, on its way before the next frame is read.
fn write_line(to: &mut impl Write, line: &impl Serialize) -> io::Result<()> {
    serde_json::to_writer(&mut *to, line)?;
    to.write_all(b"\n")?;
    to.flush()
}
