//! J1: Σ prize · Π reliability up to it.

use super::{Objective, Promise, ROUNDING};

/// Each result is safe once taken (relayed on arrival), so a late failure costs only what comes after.
pub(super) struct ExpectedInterest;

impl Objective for ExpectedInterest {
    fn extend(&self, value: f64, prize: f64, reliability: f64) -> f64 {
        value + prize * reliability
    }

    fn optimistic(&self, value: f64, prizes: Promise, reliability: f64) -> f64 {
        (value + reliability * prizes.reliable) * ROUNDING
    }
}
