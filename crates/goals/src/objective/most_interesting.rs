//! LEX: Σ prize, then reliability.

use super::{Gains, Objective, Served};

/// The most interesting set of goals, whatever its risk above the floor; reliability only breaks ties.
pub(super) struct MostInteresting;

impl Objective for MostInteresting {
    fn gain(&self, served: Served) -> f64 {
        served.prize
    }

    fn gains(&self) -> Gains {
        Gains::Prize
    }
}
