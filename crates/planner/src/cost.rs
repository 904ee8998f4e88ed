//! What a drive costs.

use std::iter::Sum;
use std::ops::{Add, AddAssign};

/// What a drive costs: four sums over its edges.
///
/// Costs add; reliability multiplies, which is why it is carried as −ln R (R = exp(−Σ λ·length); Jorgensen,
/// Chen, Milam and Pavone, *The Team Surviving Orienteers Problem*, 2016).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CostVector {
    /// Length on the map, metres (between cell centres, rises not counted).
    pub length_m: f64,
    /// Time driven, seconds.
    pub time_s: f64,
    /// Energy drawn while driving, joules (the avionics' share included).
    pub energy_j: f64,
    /// −ln of the probability of arriving, dimensionless and never negative.
    pub neg_ln_r: f64,
}

impl CostVector {
    /// The cost of not moving.
    pub const ZERO: Self = Self { length_m: 0.0, time_s: 0.0, energy_j: 0.0, neg_ln_r: 0.0 };

    /// The probability of arriving, in (0, 1]. (Above a −ln R of about 745 it is too small for an `f64`: 0.)
    #[must_use]
    pub fn reliability(self) -> f64 {
        libm::exp(-self.neg_ln_r)
    }
}

impl Add for CostVector {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            length_m: self.length_m + other.length_m,
            time_s: self.time_s + other.time_s,
            energy_j: self.energy_j + other.energy_j,
            neg_ln_r: self.neg_ln_r + other.neg_ln_r,
        }
    }
}

impl AddAssign for CostVector {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Sum for CostVector {
    fn sum<I: Iterator<Item = Self>>(costs: I) -> Self {
        costs.fold(Self::ZERO, Add::add)
    }
}
