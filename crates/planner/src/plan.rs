//! Plans and families of plans.

use wisdom_grid::Cell;

use crate::{CostVector, Route};

/// What is spent at a stop besides the drive to it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Service {
    /// Time at the stop, seconds.
    pub time_s: f64,
    /// Energy drawn at the stop, joules.
    pub energy_j: f64,
}

/// One drive of a plan and the stop at its end.
#[derive(Debug, Clone, PartialEq)]
pub struct Leg {
    /// Which of the caller's stops this is.
    pub stop: usize,
    /// Where the rover stands for it.
    pub pose: Cell,
    /// The way there from the pose before (from [`Plan::start`] for the first leg).
    pub route: Route,
    /// What is spent there.
    pub service: Service,
}

/// Legs driven one after the other.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Where the rover stands.
    pub start: Cell,
    /// The legs, in the order they are driven; none is a plan to stay.
    pub legs: Vec<Leg>,
    /// Drives and services summed; the services add time and energy, not length or hazard.
    pub total: CostVector,
}

impl Plan {
    /// A plan of these legs, its total summed leg by leg.
    #[must_use]
    pub fn new(start: Cell, legs: Vec<Leg>) -> Self {
        let total = legs
            .iter()
            .map(|leg| {
                let Service { time_s, energy_j } = leg.service;
                leg.route.cost + CostVector { time_s, energy_j, ..CostVector::ZERO }
            })
            .sum();
        Self { start, legs, total }
    }
}

/// Alternative plans, and which of them is taken.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanFamily {
    /// The plans, in the order their maker ranks them.
    pub plans: Vec<Plan>,
    /// Index of the plan taken.
    pub chosen: usize,
}

impl PlanFamily {
    /// The plan taken; none if the family is empty.
    #[must_use]
    pub fn chosen(&self) -> Option<&Plan> {
        self.plans.get(self.chosen)
    }
}
