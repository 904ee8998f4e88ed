//! Exact rationals as a [`Number`]: laws hold or fail on them, nothing rounds.

use std::cell::RefCell;
use std::fmt;
use std::ops::{Add, AddAssign, Div, Mul, Sub};

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{FromPrimitive, One, ToPrimitive, Zero};
use wisdom_belief::Number;

/// The values that live numbers of this thread stand for, and how often they were forgotten.
struct Store {
    values: Vec<BigRational>,
    age: u32,
}

thread_local! {
    static STORE: RefCell<Store> = const { RefCell::new(Store { values: Vec::new(), age: 0 }) };
}

/// A rational number of any size. [`Number`] asks for `Copy`, so this is a place in a store of the thread,
/// which [`Exact::forget_all`] empties between cases.
#[derive(Clone, Copy)]
pub(crate) struct Exact {
    place: usize,
    age: u32,
}

impl Exact {
    /// `numerator / denominator`.
    pub(crate) fn ratio(numerator: u32, denominator: u32) -> Self {
        Self::count(numerator) / Self::count(denominator)
    }

    /// Empties the store: numbers made before must not be used again, and panic if they are.
    pub(crate) fn forget_all() {
        STORE.with_borrow_mut(|store| {
            store.values.clear();
            store.age += 1;
        });
    }

    fn keep(value: BigRational) -> Self {
        STORE.with_borrow_mut(|store| {
            store.values.push(value);
            Self { place: store.values.len() - 1, age: store.age }
        })
    }

    fn with<T>(self, other: Self, operation: impl FnOnce(&BigRational, &BigRational) -> T) -> T {
        STORE.with_borrow(|store| {
            assert!(self.age == store.age && other.age == store.age, "a number was forgotten");
            operation(&store.values[self.place], &store.values[other.place])
        })
    }
}

impl fmt::Debug for Exact {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.with(*self, |value, _| write!(f, "{value}"))
    }
}

impl PartialEq for Exact {
    fn eq(&self, other: &Self) -> bool {
        self.with(*other, |a, b| a == b)
    }
}

impl PartialOrd for Exact {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        self.with(*other, BigRational::partial_cmp)
    }
}

impl Add for Exact {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self::keep(self.with(other, |a, b| a + b))
    }
}

impl Sub for Exact {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self::keep(self.with(other, |a, b| a - b))
    }
}

impl Mul for Exact {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        Self::keep(self.with(other, |a, b| a * b))
    }
}

impl Div for Exact {
    type Output = Self;

    /// A division by zero panics, where floating point would go on with NaN.
    fn div(self, other: Self) -> Self {
        Self::keep(self.with(other, |a, b| a / b))
    }
}

impl AddAssign for Exact {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Number for Exact {
    const SUM_TOLERANCE: f64 = 0.0;

    fn zero() -> Self {
        Self::keep(BigRational::zero())
    }

    fn one() -> Self {
        Self::keep(BigRational::one())
    }

    fn count(n: u32) -> Self {
        Self::keep(BigRational::from_u32(n).expect("a whole number"))
    }

    fn from_f64(value: f64) -> Self {
        Self::keep(BigRational::from_float(value).expect("a finite number"))
    }

    fn to_f64(self) -> f64 {
        self.with(self, |value, _| value.to_f64().expect("some nearest number"))
    }

    /// The only inexact operation, since roots need not be rational: off by less than 2^-128.
    fn sqrt(self) -> Self {
        let bits = 128_usize;
        let scaled =
            self.with(self, |value, _| (value * (BigInt::one() << (2 * bits))).to_integer());
        Self::keep(BigRational::new(scaled.sqrt(), BigInt::one() << bits))
    }
}
