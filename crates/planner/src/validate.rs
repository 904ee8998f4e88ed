//! Whether a plan is what it says: checked from the ground up, sharing no arithmetic with the search.

use wisdom_grid::Cell;

use crate::{CostVector, Plan, Traversability, Vehicle};

/// What a plan may spend and must promise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Budget {
    /// Time for drives and services, seconds.
    pub time_s: f64,
    /// Energy for drives and services, joules.
    pub energy_j: f64,
    /// Least probability that every drive succeeds.
    pub min_reliability: f64,
}

/// How far a stated cost may be from the one summed here, as a share of the larger of it and one: the two are
/// computed by different formulas, each good to 1e-15 an edge, over at most some 1e5 edges.
pub const RELATIVE_TOLERANCE: f64 = 1e-9;

/// What is wrong with a plan.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Violation {
    /// A route has no cells.
    #[error("leg {leg} has no cells")]
    EmptyRoute {
        /// The leg, from 0.
        leg: usize,
    },
    /// A route does not begin where the leg before ended.
    #[error("leg {leg} begins at {found}, the rover stands at {expected}")]
    WrongStart {
        /// The leg, from 0.
        leg: usize,
        /// Where the rover stands.
        expected: Cell,
        /// The route's first cell.
        found: Cell,
    },
    /// A route does not end at its leg's pose.
    #[error("leg {leg} ends at {found}, its pose is {expected}")]
    WrongEnd {
        /// The leg, from 0.
        leg: usize,
        /// The pose.
        expected: Cell,
        /// The route's last cell.
        found: Cell,
    },
    /// A route leaves the map.
    #[error("leg {leg} leaves the grid at {cell}")]
    OffGrid {
        /// The leg, from 0.
        leg: usize,
        /// The cell that is not on the grid.
        cell: Cell,
    },
    /// Two cells in a row are not neighbours.
    #[error("leg {leg} jumps from {from} to {to}")]
    Jump {
        /// The leg, from 0.
        leg: usize,
        /// The cell before.
        from: Cell,
        /// The cell after.
        to: Cell,
    },
    /// A blocked cell is entered.
    #[error("leg {leg} enters {cell}, which is blocked")]
    Blocked {
        /// The leg, from 0.
        leg: usize,
        /// The blocked cell.
        cell: Cell,
    },
    /// A diagonal step brushes a blocked cell.
    #[error("leg {leg} cuts the corner of {corner}, which is blocked, from {from} to {to}")]
    CutCorner {
        /// The leg, from 0.
        leg: usize,
        /// The cell before.
        from: Cell,
        /// The cell after.
        to: Cell,
        /// The blocked cell beside the step.
        corner: Cell,
    },
    /// The wheels would slip too much on a step.
    #[error("leg {leg} slips {slip} from {from} to {to}; the limit is {limit}")]
    Slip {
        /// The leg, from 0.
        leg: usize,
        /// The cell before.
        from: Cell,
        /// The cell after.
        to: Cell,
        /// Slip found, as a share of the wheels' way.
        slip: f64,
        /// The vehicle's limit.
        limit: f64,
    },
    /// A leg does not cost what it says.
    #[error("leg {leg} states a {quantity} of {stated}; its route sums to {found}")]
    LegCost {
        /// The leg, from 0.
        leg: usize,
        /// Which of the costs.
        quantity: &'static str,
        /// What the leg says.
        stated: f64,
        /// What its route sums to.
        found: f64,
    },
    /// A service is negative or not a number.
    #[error(
        "service of leg {leg} states a {quantity} of {stated}; it must be finite and at least 0"
    )]
    ServiceCost {
        /// The leg, from 0.
        leg: usize,
        /// Which of the costs.
        quantity: &'static str,
        /// What the service says.
        stated: f64,
    },
    /// The plan does not cost what it says.
    #[error("the plan states a {quantity} of {stated}; its legs sum to {found}")]
    TotalCost {
        /// Which of the costs.
        quantity: &'static str,
        /// What the plan says.
        stated: f64,
        /// What its legs sum to.
        found: f64,
    },
    /// The plan takes too long.
    #[error("the plan takes {found_s} s; the budget is {limit_s} s")]
    OverTime {
        /// Time found, seconds.
        found_s: f64,
        /// The budget, seconds.
        limit_s: f64,
    },
    /// The plan draws too much energy.
    #[error("the plan draws {found_j} J; the budget is {limit_j} J")]
    OverEnergy {
        /// Energy found, joules.
        found_j: f64,
        /// The budget, joules.
        limit_j: f64,
    },
    /// The plan is too likely to fail.
    #[error("the plan succeeds with probability {found}; at least {limit} is asked for")]
    Unreliable {
        /// Reliability found.
        found: f64,
        /// The floor.
        limit: f64,
    },
}

/// Checks a plan against the ground, the vehicle and the budget: each route goes from neighbour to neighbour from
/// where the rover stands to its pose, enters no blocked cell, cuts no corner and does not slip; stated costs are those
/// of the routes; the sums found here (not those stated) keep the budget.
///
/// Slopes are driven by angle here and by rise in [`Vehicle::drive`], so that a slip in one shows in the other; what
/// the wheels slip by class is worked out here again from the vehicle's curves and the ground's classes.
///
/// # Errors
/// The first [`Violation`] found, legs first, in order.
pub fn validate(
    plan: &Plan,
    ground: &Traversability,
    vehicle: &Vehicle,
    budget: &Budget,
) -> Result<(), Violation> {
    let mut stands = plan.start;
    let mut total = CostVector::ZERO;
    for (number, leg) in plan.legs.iter().enumerate() {
        let cells = &leg.route.cells;
        let (&[first, ..], &[.., last]) = (cells.as_slice(), cells.as_slice()) else {
            return Err(Violation::EmptyRoute { leg: number });
        };
        if first != stands {
            return Err(Violation::WrongStart { leg: number, expected: stands, found: first });
        }
        if last != leg.pose {
            return Err(Violation::WrongEnd { leg: number, expected: leg.pose, found: last });
        }
        if let Some(&cell) = cells.iter().find(|&&cell| !ground.spec().contains(cell)) {
            return Err(Violation::OffGrid { leg: number, cell });
        }
        let found = drive(number, cells, ground, vehicle)?;
        if let Some((quantity, stated, found)) = difference(leg.route.cost, found) {
            return Err(Violation::LegCost { leg: number, quantity, stated, found });
        }
        for (quantity, stated) in
            [("time_s", leg.service.time_s), ("energy_j", leg.service.energy_j)]
        {
            if !stated.is_finite() || stated < 0.0 {
                return Err(Violation::ServiceCost { leg: number, quantity, stated });
            }
        }
        total += found;
        total.time_s += leg.service.time_s;
        total.energy_j += leg.service.energy_j;
        stands = last;
    }
    if let Some((quantity, stated, found)) = difference(plan.total, total) {
        return Err(Violation::TotalCost { quantity, stated, found });
    }
    keeps(total, budget)
}

/// Whether the sums keep the budget. Rounding is on the plan's side: a plan that fills its budget exactly is
/// good. A budget that is not a number is kept by nothing.
fn keeps(total: CostVector, budget: &Budget) -> Result<(), Violation> {
    let within = |found: f64, limit: f64| found <= limit * (1.0 + RELATIVE_TOLERANCE);
    if !within(total.time_s, budget.time_s) {
        return Err(Violation::OverTime { found_s: total.time_s, limit_s: budget.time_s });
    }
    if !within(total.energy_j, budget.energy_j) {
        return Err(Violation::OverEnergy { found_j: total.energy_j, limit_j: budget.energy_j });
    }
    let found = libm::exp(-total.neg_ln_r);
    if !within(budget.min_reliability, found) {
        return Err(Violation::Unreliable { found, limit: budget.min_reliability });
    }
    Ok(())
}

/// Drives a route cell by cell.
fn drive(
    leg: usize,
    cells: &[Cell],
    ground: &Traversability,
    vehicle: &Vehicle,
) -> Result<CostVector, Violation> {
    let mut sum = CostVector::ZERO;
    for pair in cells.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        if !from.touches(to) {
            return Err(Violation::Jump { leg, from, to });
        }
        if ground.is_blocked(to) {
            return Err(Violation::Blocked { leg, cell: to });
        }
        if from.row != to.row && from.col != to.col {
            for corner in [Cell::new(from.row, to.col), Cell::new(to.row, from.col)] {
                if ground.is_blocked(corner) {
                    return Err(Violation::CutCorner { leg, from, to, corner });
                }
            }
        }
        let length = from.distance(to) * ground.spec().spacing_m();
        let rise = match (ground.height_m(from), ground.height_m(to)) {
            (Some(below), Some(above)) => f64::from(above) - f64::from(below),
            _ => 0.0,
        };
        let t = libm::atan2(rise, length);
        let slip = slip_at(from, t, ground, vehicle).max(slip_at(to, t, ground, vehicle));
        if slip >= vehicle.slip_max * (1.0 + RELATIVE_TOLERANCE) {
            return Err(Violation::Slip { leg, from, to, slip, limit: vehicle.slip_max });
        }
        let wheel_way = length / libm::cos(t) / (1.0 - slip);
        let force = vehicle.mass_kg
            * vehicle.gravity_m_s2
            * (vehicle.rolling_resistance * libm::cos(t) + libm::sin(t).max(0.0));
        let time = wheel_way / vehicle.speed_m_s;
        let mean_hazard =
            f64::midpoint(f64::from(ground.hazard_per_m(from)), f64::from(ground.hazard_per_m(to)));
        sum.length_m += length;
        sum.time_s += time;
        sum.energy_j += force * wheel_way / vehicle.drive_efficiency + vehicle.hotel_power_w * time;
        sum.neg_ln_r += mean_hazard * length;
    }
    Ok(sum)
}

/// Slip at a cell on a slope of `t` radians: of its class as far as that is known, of the worst curve for the rest.
fn slip_at(cell: Cell, t: f64, ground: &Traversability, vehicle: &Vehicle) -> f64 {
    let degrees = t * (180.0 / std::f64::consts::PI);
    let curve = |base: f64, growth: f64| base * libm::exp(growth * degrees);
    let unlisted = curve(vehicle.slip_base, vehicle.slip_growth_per_deg);
    let Some(classes) = ground.classes() else { return unlisted };
    let (class, u) = (classes.value(cell), f64::from(classes.u(cell)));
    let (mut own, mut worst) = (unlisted, unlisted);
    for listed in &vehicle.slip_class {
        let slip = curve(listed.base, listed.growth_per_deg);
        worst = worst.max(slip);
        if listed.class as f32 == class {
            own = slip;
        }
    }
    // Wheels do not slip more than all their way.
    own.min(1.0) * (1.0 - u) + worst.min(1.0) * u
}

/// The first quantity in which a stated cost is off, with what was stated and what was found.
fn difference(stated: CostVector, found: CostVector) -> Option<(&'static str, f64, f64)> {
    [
        ("length_m", stated.length_m, found.length_m),
        ("time_s", stated.time_s, found.time_s),
        ("energy_j", stated.energy_j, found.energy_j),
        ("neg_ln_r", stated.neg_ln_r, found.neg_ln_r),
    ]
    .into_iter()
    .find(|&(_, stated, found)| !agree(stated, found))
}

/// Whether two costs are the same up to rounding; NaN agrees with nothing.
fn agree(stated: f64, found: f64) -> bool {
    (stated - found).abs() <= RELATIVE_TOLERANCE * found.max(1.0)
}
