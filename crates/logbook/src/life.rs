//! The life of one goal, as a log tells it.

use crate::LogReader;
use crate::record::{Decision, Transition, Verdict};

/// What one deliberation made of a goal.
#[derive(Debug, Clone, PartialEq)]
pub struct Weighing {
    /// The decision.
    pub decision: u32,
    /// Mission time, seconds.
    pub time_s: f64,
    /// What was said of it, with the goal as it stood afterwards.
    pub verdict: Verdict,
    /// The steps it took.
    pub steps: Vec<Transition>,
}

/// Everything a log says of one goal.
#[derive(Debug, Clone, PartialEq)]
pub struct GoalLife {
    /// Its number: 7 is G7.
    pub goal: u32,
    /// Every deliberation that spoke of it, in order; at least one.
    pub weighings: Vec<Weighing>,
}

impl GoalLife {
    /// The life of a goal; none if no decision of the log speaks of it.
    #[must_use]
    pub fn of(log: &LogReader, goal: u32) -> Option<Self> {
        let weighings: Vec<Weighing> =
            log.decisions().filter_map(|decision| weighing(decision, goal)).collect();
        (!weighings.is_empty()).then_some(Self { goal, weighings })
    }

    /// The deliberation that formulated it, or the first that speaks of it if the log begins later.
    #[must_use]
    pub fn birth(&self) -> &Weighing {
        &self.weighings[0]
    }

    /// The deliberation that ended it; none if it was open when the log ended.
    #[must_use]
    pub fn end(&self) -> Option<&Weighing> {
        let last = self.weighings.last()?;
        let ended = |status: &str| matches!(status, "finished" | "dropped");
        let goal = last.verdict.goal.as_ref();
        goal.is_some_and(|goal| ended(&goal.status)).then_some(last)
    }
}

fn weighing(decision: &Decision, goal: u32) -> Option<Weighing> {
    let choice = decision.choice.as_ref()?;
    let of_it = |verdict: &&Verdict| verdict.goal.as_ref().is_some_and(|g| g.id == goal);
    let verdict = choice.verdicts.iter().find(of_it)?.clone();
    let steps = choice.transitions.iter().filter(|step| step.goal == goal).cloned().collect();
    let spent = decision.state.as_ref().and_then(|state| state.spent);
    let time_s = spent.map_or(0.0, |spent| spent.time_s);
    Some(Weighing { decision: decision.number, time_s, verdict, steps })
}
