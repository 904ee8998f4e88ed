//! The arithmetic of masses: binary floating point in use, exact rationals where a law is to be proved.

use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, Sub};

use crate::interest::exponential;

/// A number that masses can be: `f64` by default, `f32` on map planes.
///
/// Only + − × ÷ and √ of IEEE 754 are asked for, which give the same bits on every machine. Anything that
/// computes exactly (a rational) can take its place: the rules then have no rounding at all, but for those
/// that take a square root ([`Rule::Deng`](crate::Rule::Deng)).
pub trait Number:
    Copy
    + PartialOrd
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + AddAssign
    + 'static
{
    /// How far a sum of masses that were read from outside may be from 1.
    const SUM_TOLERANCE: f64;

    /// 0.
    fn zero() -> Self;

    /// 1.
    fn one() -> Self;

    /// A whole number.
    fn count(n: u32) -> Self;

    /// The value nearest to a floating-point number.
    fn from_f64(value: f64) -> Self;

    /// The nearest floating-point number.
    fn to_f64(self) -> f64;

    /// The square root of a number that is not negative.
    #[must_use]
    fn sqrt(self) -> Self;

    /// eˣ of a number that is not above 0, the same bits on every machine. Only PCR6 and PCR6⁺ of many sources
    /// ask for it; an exact type may round here.
    #[must_use]
    fn exp(self) -> Self {
        Self::from_f64(exponential(self.to_f64()))
    }

    /// The smaller of two.
    #[must_use]
    fn least(self, other: Self) -> Self {
        if other < self { other } else { self }
    }

    /// The larger of two.
    #[must_use]
    fn greatest(self, other: Self) -> Self {
        if other > self { other } else { self }
    }
}

impl Number for f64 {
    const SUM_TOLERANCE: f64 = crate::SUM_TOLERANCE;

    #[inline]
    fn zero() -> Self {
        0.0
    }

    #[inline]
    fn one() -> Self {
        1.0
    }

    #[inline]
    fn count(n: u32) -> Self {
        Self::from(n)
    }

    #[inline]
    fn from_f64(value: f64) -> Self {
        value
    }

    #[inline]
    fn to_f64(self) -> f64 {
        self
    }

    #[inline]
    fn sqrt(self) -> Self {
        Self::sqrt(self)
    }

    #[inline]
    fn exp(self) -> Self {
        exponential(self)
    }
}

impl Number for f32 {
    /// Five decimals: what is left of f64's tolerance in single precision, with some terms added up.
    const SUM_TOLERANCE: f64 = 1e-5;

    #[inline]
    fn zero() -> Self {
        0.0
    }

    #[inline]
    fn one() -> Self {
        1.0
    }

    #[inline]
    fn count(n: u32) -> Self {
        n as Self
    }

    #[inline]
    fn from_f64(value: f64) -> Self {
        value as Self
    }

    #[inline]
    fn to_f64(self) -> f64 {
        f64::from(self)
    }

    #[inline]
    fn sqrt(self) -> Self {
        Self::sqrt(self)
    }

    #[inline]
    fn exp(self) -> Self {
        exponential(self)
    }
}

/// The sum of some numbers, from the first to the last.
pub(crate) fn sum<F: Number>(numbers: impl IntoIterator<Item = F>) -> F {
    numbers.into_iter().fold(F::zero(), |sum, number| sum + number)
}
