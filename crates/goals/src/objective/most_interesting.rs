//! LEX: Σ prize, then reliability.

use super::{Objective, Promise};

/// The most interesting set of goals, whatever its risk above the floor; reliability only breaks ties.
pub(super) struct MostInteresting;

impl Objective for MostInteresting {
    fn extend(&self, value: f64, prize: f64, _reliability: f64) -> f64 {
        value + prize
    }

    fn optimistic(&self, value: f64, prizes: Promise, _reliability: f64) -> f64 {
        value + prizes.plain
    }
}
