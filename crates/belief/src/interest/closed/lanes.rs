//! One number, or several side by side: what a closed form is written in, once for cells and for maps.

use std::ops::{Add, Div, Mul, Sub};

use crate::Number;

/// A number, or a vector register of them that are worked on together.
///
/// There are no branches on values, only choices between them, so that all lanes take the same steps and
/// give the same bits as one number alone.
pub trait Lanes:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// Whether a lane is in single precision.
    const SINGLE: bool;

    /// A whole number in every lane of another value's kind.
    fn count(self, n: u32) -> Self;

    /// The same number in every lane.
    fn value(self, value: f64) -> Self;

    /// Half of it.
    fn half(self) -> Self;

    /// `then` where it is above 0, elsewhere `otherwise`.
    fn where_positive(self, then: Self, otherwise: Self) -> Self;

    /// `then` where it is at least `bound`, elsewhere (and where it is not a number) `otherwise`.
    fn where_at_least(self, bound: Self, then: Self, otherwise: Self) -> Self;

    /// The smaller of two.
    fn lower(self, other: Self) -> Self;

    /// The larger of two.
    fn upper(self, other: Self) -> Self;

    /// The square root.
    fn root(self) -> Self;

    /// eˣ, x ≤ 0.
    fn power_of_e(self) -> Self;

    /// 0 in every lane.
    #[inline(always)]
    fn zero_of(self) -> Self {
        self.count(0)
    }

    /// 1 in every lane.
    #[inline(always)]
    fn one_of(self) -> Self {
        self.count(1)
    }

    /// `self / whole`, and 0 of nothing.
    #[inline(always)]
    fn share_of(self, whole: Self) -> Self {
        whole.where_positive(self / whole, whole.zero_of())
    }
}

/// One lane. A division whose quotient is not chosen is not made: an exact type may refuse it.
impl<F: Number> Lanes for F {
    /// Exact types are wider than four bytes.
    const SINGLE: bool = size_of::<F>() <= size_of::<f32>();

    #[inline(always)]
    fn count(self, n: u32) -> Self {
        <F as Number>::count(n)
    }

    #[inline(always)]
    fn value(self, value: f64) -> Self {
        F::from_f64(value)
    }

    #[inline(always)]
    fn half(self) -> Self {
        self / <F as Number>::count(2)
    }

    #[inline(always)]
    fn where_positive(self, then: Self, otherwise: Self) -> Self {
        if self > F::zero() { then } else { otherwise }
    }

    #[inline(always)]
    fn where_at_least(self, bound: Self, then: Self, otherwise: Self) -> Self {
        if self >= bound { then } else { otherwise }
    }

    #[inline(always)]
    fn lower(self, other: Self) -> Self {
        self.least(other)
    }

    #[inline(always)]
    fn upper(self, other: Self) -> Self {
        self.greatest(other)
    }

    #[inline(always)]
    fn root(self) -> Self {
        self.sqrt()
    }

    #[inline(always)]
    fn power_of_e(self) -> Self {
        self.exp()
    }

    #[inline(always)]
    fn share_of(self, whole: Self) -> Self {
        if whole > F::zero() { self / whole } else { F::zero() }
    }
}
