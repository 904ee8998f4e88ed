//! CC: Σ prize, subject to Π reliability ≥ the stated confidence.

use super::{Gains, Objective, Preferences, Served};

/// The most interesting set that can be done with confidence.
pub(super) struct ChanceConstrained;

impl Objective for ChanceConstrained {
    fn gain(&self, served: Served) -> f64 {
        served.prize
    }

    fn gains(&self) -> Gains {
        Gains::Prize
    }

    fn floor(&self, preferences: &Preferences) -> f64 {
        preferences.confidence
    }
}
