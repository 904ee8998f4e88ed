//! What a decision was searched in, kept for whoever asks about it afterwards.

use wisdom_goals::{
    Candidate, FactSet, GoalId, Limits, ManagerState, Poses, Problem, Selection, Shortlist, Verdict,
};
use wisdom_grid::Cell;
use wisdom_planner::TravelMatrix;

use crate::Spec;

/// The problem behind the latest decision: what would have been decided under other limits or prizes can be worked out
/// from it, and outside planners can be given it.
#[derive(Debug, Clone)]
pub struct Deliberation {
    /// The goals that were sequenced.
    pub candidates: Vec<Candidate>,
    /// Costs and routes between the nodes.
    pub travel: TravelMatrix,
    /// Cells of the matrix's nodes: where the rover stood, then the poses.
    pub nodes: Vec<Cell>,
    /// Facts that held.
    pub facts: FactSet,
    /// What was left to spend, and the reliability floor.
    pub limits: Limits,
    /// The sequence committed to before.
    pub agenda: Vec<GoalId>,
    /// The goal that the sequences were asked to begin with.
    pub pinned: Option<GoalId>,
    /// What was chosen.
    pub selection: Selection,
    /// Which goals were sequenced, and which were cut.
    pub shortlist: Shortlist,
    /// Poses of every open goal.
    pub poses: Poses,
    /// What was said of every known goal.
    pub verdicts: Vec<Verdict>,
    /// What the goal manager remembered afterwards.
    pub manager: ManagerState,
    /// Median interest over seen ground.
    pub background: f64,
    /// How long the mission had lasted, seconds.
    pub spent_s: f64,
}

impl Deliberation {
    /// The problem as the search met it; `spec` is the core's.
    #[must_use]
    pub fn problem<'a>(&'a self, spec: &'a Spec) -> Problem<'a> {
        problem(spec, &self.candidates, &self.travel, self.facts, self.limits)
    }
}

/// What the search is asked.
pub(crate) fn problem<'a>(
    spec: &'a Spec,
    candidates: &'a [Candidate],
    travel: &'a TravelMatrix,
    facts: FactSet,
    limits: Limits,
) -> Problem<'a> {
    Problem {
        candidates,
        travel,
        ends: &[],
        domain: &spec.domain,
        directives: &spec.directives,
        facts,
        limits,
        // A rover that waits keeps everything on but its drives.
        waiting_w: spec.vehicle.hotel_power_w,
        policy: spec.policy,
        preferences: spec.preferences,
    }
}
