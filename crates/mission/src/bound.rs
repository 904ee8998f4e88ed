//! How many decisions a mission can take at most.

use wisdom_goals::FactSet;

use crate::{FaultKind, Mission};

/// A bound on the decisions of one mission, and what it is made of.
///
/// Every decision but the first follows the end of a step, a look or a message, and nearly each of those costs time or
/// energy, of which there is only so much:
///
/// - at least one cell was entered since the last one: at most [`DecisionBound::steps`] times;
/// - a goal was achieved where the rover stood: at most [`DecisionBound::services`] times, for operators take time;
/// - a drive was blocked at its first cell: each blocked edge once where the rover stands, eight of them, and for goals no
///   more often than tries are allowed at all places there can be ([`DecisionBound::tries`]);
/// - the first look from where the rover stands called for it: once where it stands;
/// - it looked again from where it stood: once between two of the others;
/// - a message came, or a window opened while it slept: [`DecisionBound::messages`], [`DecisionBound::windows`].
///
/// Costs scatter down to half of what is planned, which is counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DecisionBound {
    /// Cells that can be entered before time or energy is spent.
    pub steps: u64,
    /// Services that fit the time.
    pub services: u64,
    /// Tries allowed at all places there is room for.
    pub tries: u64,
    /// Messages and readings to come, and messages that tell of faults.
    pub messages: u64,
    /// Windows that open.
    pub windows: u64,
}

/// The least that costs can scatter down to, as a share.
const LEAST_FACTOR: f64 = 0.5;

/// So many times one fits the other, rounded up; nothing fits what costs nothing.
fn fits(budget: f64, cost: f64) -> u64 {
    if cost > 0.0 { (budget / cost).ceil() as u64 } else { u64::MAX }
}

impl DecisionBound {
    /// The bound of a mission.
    #[must_use]
    pub fn of(mission: &Mission) -> Self {
        let (spec, execution) = (&mission.spec, mission.world.execution());
        let spacing_m = spec.grid.spacing_m();
        // No step is cheaper than a straight one on level ground without slip.
        let (step_s, step_j) =
            spec.vehicle.drive_slipping(spacing_m, 0.0, 0.0).unwrap_or((0.0, 0.0));
        let energy_j = spec.budget.energy_j - spec.budget.reserve_j;
        let steps = fits(spec.budget.time_s, LEAST_FACTOR * step_s)
            .min(fits(energy_j, LEAST_FACTOR * step_j));
        // Some operator must bring about what a directive wants, whatever else is needed.
        let operators = spec.domain.operators();
        let bringing = |wanted: FactSet| {
            operators.iter().filter(move |o| o.adds.meets(wanted)).map(|o| o.cost.time_s)
        };
        let least = spec.directives.iter().flat_map(|d| bringing(d.achieves)).reduce(f64::min);
        let service_s = LEAST_FACTOR * least.unwrap_or(0.0);
        let cells = spec.grid.len() as u64;
        // Each place once for every kind, and again when another expert speaks of it.
        let places_done = cells.saturating_mul(3 * (1 + spec.experts.len() as u64));
        let services = fits(spec.budget.time_s, service_s).min(places_done);
        // Places lie further apart than the identity radius: discs of half of it do not overlap.
        let radius_m = spec.manager.identity_radius_m / 2.0;
        let room_m2 = (spec.grid.rows() as f64 * spacing_m + 2.0 * radius_m)
            * (spec.grid.cols() as f64 * spacing_m + 2.0 * radius_m);
        let places = fits(room_m2, std::f64::consts::PI * radius_m * radius_m).min(cells);
        let attempts = spec.directives.iter().map(|d| d.max_attempts).max().unwrap_or(0);
        let each = u64::from(attempts) * (1 + u64::from(spec.manager.max_reopenings));
        let told =
            execution.faults.iter().filter(|f| matches!(f.kind, FaultKind::FactsLost { .. }));
        let handed_in = (execution.commands.len() + execution.readings.len()) as u64;
        Self {
            steps,
            services,
            tries: places.saturating_mul(each),
            messages: handed_in + 2 * told.count() as u64,
            windows: spec.directives.iter().filter(|d| d.window.is_some()).count() as u64,
        }
    }

    /// The bound itself; the mission's own limit ([`crate::Execution::max_decisions`]) may end it before.
    #[must_use]
    pub fn decisions(self) -> u64 {
        /// Edges that leave a cell.
        const EDGES: u64 = 8;
        let Self { steps, services, tries, messages, windows } = self;
        // Where it stands at first, after each step, and one more: the budget is looked at after a step.
        let stands = steps.saturating_add(2);
        let blocked = EDGES.saturating_mul(stands);
        let others = stands
            .saturating_add(services)
            .saturating_add(blocked.min(tries))
            .saturating_add(stands)
            .saturating_add(blocked)
            .saturating_add(messages)
            .saturating_add(windows);
        others.saturating_mul(2)
    }
}
