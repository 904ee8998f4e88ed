//! J1: Σ prize · Π reliability up to it.

use super::{Objective, Promise, ROUNDING};

/// What was done before a failure still counts: its data have been sent. Only what would have come after is lost.
pub(super) struct ExpectedInterest;

impl Objective for ExpectedInterest {
    fn extend(&self, value: f64, prize: f64, reliability: f64) -> f64 {
        value + prize * reliability
    }

    fn optimistic(&self, value: f64, prizes: Promise, reliability: f64) -> f64 {
        (value + reliability * prizes.reliable) * ROUNDING
    }
}
