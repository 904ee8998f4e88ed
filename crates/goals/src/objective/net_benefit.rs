//! NET: Σ prize − λ·(−ln R) − μ·energy.

use super::{Gains, Objective, Preferences, Prices, Served};

/// Additive in legs and goals, which is what planners of PDDL can do.
pub(super) struct NetBenefit;

impl Objective for NetBenefit {
    fn gain(&self, served: Served) -> f64 {
        served.prize
    }

    fn gains(&self) -> Gains {
        Gains::Prize
    }

    fn prices(&self, preferences: &Preferences) -> Prices {
        let Prices { risk, energy_per_j, .. } = preferences.prices;
        Prices { risk, energy_per_j, ..Prices::NONE }
    }
}
