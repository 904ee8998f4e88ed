//! Exact rational numbers, to prove laws that rounding would blur; and small mass functions made of them.

use std::ops::{Add, AddAssign, Div, Mul, Sub};

use proptest::prelude::*;
use wisdom_belief::{Element, Frame, MassFunction, Number};

/// A fraction of 128 bits; overflow panics, as tests are built, so that none passes by it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd)]
pub(crate) struct Ratio(num_rational::Ratio<i128>);

impl Ratio {
    pub(crate) fn new(above: i128, below: i128) -> Self {
        Self(num_rational::Ratio::new(above, below))
    }
}

macro_rules! arithmetic {
    ($($operation:ident $function:ident),*) => {$(
        impl $operation for Ratio {
            type Output = Self;

            fn $function(self, other: Self) -> Self {
                Self(self.0.$function(other.0))
            }
        }
    )*};
}

arithmetic!(Add add, Sub sub, Mul mul, Div div);

impl AddAssign for Ratio {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Number for Ratio {
    const SUM_TOLERANCE: f64 = 0.0;

    fn zero() -> Self {
        Self::new(0, 1)
    }

    fn one() -> Self {
        Self::new(1, 1)
    }

    fn count(n: u32) -> Self {
        Self::new(n.into(), 1)
    }

    /// Exact, for numbers of few binary digits.
    fn from_f64(value: f64) -> Self {
        const UNIT: f64 = (1_u64 << 40) as f64;
        let scaled = value * UNIT;
        assert!(scaled.fract() == 0.0, "{value} has too many digits");
        Self::new(scaled as i128, UNIT as i128)
    }

    fn to_f64(self) -> f64 {
        *self.0.numer() as f64 / *self.0.denom() as f64
    }

    /// Of squares only.
    fn sqrt(self) -> Self {
        let (above, below) = (self.0.numer().isqrt(), self.0.denom().isqrt());
        let root = Self::new(above, below);
        assert!(root * root == self, "not a square");
        root
    }
}

/// Frames of every model, with few enough elements to try all.
pub(crate) fn frames() -> Vec<Frame> {
    let abcd = ["A", "B", "C", "D"];
    [
        Frame::free(["A", "B"]),
        Frame::free(["A", "B", "C"]),
        Frame::shafer(abcd),
        Frame::with_empty(abcd, &["A & B", "A & C & D"]),
        Frame::with_empty(abcd, &["A & B", "C"]),
    ]
    .map(|frame| frame.expect("a frame"))
    .into()
}

/// A frame, and for so many sources a few numbers to make masses of.
pub(crate) fn any_bodies(
    sources: usize,
) -> impl Strategy<Value = (Frame, Vec<Vec<(prop::sample::Index, i128)>>)> {
    let focal = (any::<prop::sample::Index>(), 1..5_i128);
    let bodies = prop::collection::vec(prop::collection::vec(focal, 1..4), sources);
    (prop::sample::select(frames()), bodies)
}

/// A mass function from such numbers, with some more for elements that must be focal.
pub(crate) fn body(
    frame: &Frame,
    numbers: &[(prop::sample::Index, i128)],
    and: &[Element],
) -> MassFunction<Ratio> {
    let elements: Vec<Element> = frame.elements().filter(|element| !element.is_empty()).collect();
    let mut counts = std::collections::BTreeMap::<Element, i128>::new();
    for &(index, count) in numbers {
        *counts.entry(*index.get(&elements)).or_default() += count;
    }
    for &element in and {
        *counts.entry(element).or_default() += 2;
    }
    let whole: i128 = counts.values().sum();
    let masses = counts.into_iter().map(|(element, count)| (element, Ratio::new(count, whole)));
    MassFunction::new(frame, masses).expect("masses of sum 1")
}
