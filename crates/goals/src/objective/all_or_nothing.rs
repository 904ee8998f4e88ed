//! J2: Σ prize · Π reliability of the whole.

use super::{Gains, Objective, Served};

/// One failure loses everything, what came before it too.
pub(super) struct AllOrNothing;

impl Objective for AllOrNothing {
    fn gain(&self, served: Served) -> f64 {
        served.prize
    }

    fn gains(&self) -> Gains {
        Gains::Prize
    }

    fn value(&self, gain: f64, _charge: f64, reliability: f64) -> f64 {
        gain * reliability
    }
}
