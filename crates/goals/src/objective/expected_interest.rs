//! J1: Σ prize · Π reliability up to it.

use super::{Gains, Objective, Served};

/// What was done before a failure still counts: its data have been sent. Only what would have come after is lost.
pub(super) struct ExpectedInterest;

impl Objective for ExpectedInterest {
    fn gain(&self, served: Served) -> f64 {
        served.prize * served.reliability
    }

    fn gains(&self) -> Gains {
        Gains::Chance
    }
}
