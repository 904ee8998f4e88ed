//! What makes one goal sequence better than another. Each objective is one file.

mod expected_interest;
mod most_interesting;

use std::fmt;
use std::str::FromStr;

use expected_interest::ExpectedInterest;
use most_interesting::MostInteresting;

/// The mission's objective over goal sequences, all subject to the budgets and the reliability floor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
#[non_exhaustive]
pub enum Policy {
    /// J1: the sum of each prize times the chance of getting that far; a result is safe once taken
    /// (Jorgensen et al. 2017).
    #[default]
    ExpectedInterest,
    /// LEX, the paper's sentence: the most interesting set, then its most reliable plan.
    MostInteresting,
}

impl Policy {
    /// Every policy, in the order of the documentation.
    pub const ALL: [Self; 2] = [Self::ExpectedInterest, Self::MostInteresting];

    /// The objective behind the name.
    #[must_use]
    pub fn objective(self) -> &'static dyn Objective {
        match self {
            Self::ExpectedInterest => &ExpectedInterest,
            Self::MostInteresting => &MostInteresting,
        }
    }
}

impl fmt::Display for Policy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::ExpectedInterest => "expected-interest",
            Self::MostInteresting => "most-interesting",
        })
    }
}

/// A name that is no policy.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is not a policy; expected `expected-interest` or `most-interesting`")]
pub struct UnknownPolicy(pub String);

impl FromStr for Policy {
    type Err = UnknownPolicy;

    fn from_str(name: &str) -> Result<Self, UnknownPolicy> {
        Self::ALL
            .into_iter()
            .find(|p| p.to_string() == name)
            .ok_or_else(|| UnknownPolicy(name.to_owned()))
    }
}

/// A value that grows stop by stop. Sequences compare by value, then reliability, then time, then ids.
pub trait Objective: Sync {
    /// The value once a goal of this prize is reached with the reliability of everything up to it.
    fn extend(&self, value: f64, prize: f64, reliability: f64) -> f64;

    /// A value that no continuation can exceed, if all that can still be collected from here is `prizes`
    /// (a sum of prize times the best chance of each leg that could lead to it, or more).
    fn optimistic(&self, value: f64, prizes: Promise, reliability: f64) -> f64;
}

/// Sums in another order differ by some units in the last place; bounds are raised by more than that.
pub(crate) const ROUNDING: f64 = 1.0 + 1e-12;

/// What is at most left to collect, in the two forms that objectives ask for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Promise {
    /// Sum of prizes.
    pub plain: f64,
    /// Sum of prizes, each times the best reliability of a leg that leads to it.
    pub reliable: f64,
}
