//! What makes one goal sequence better than another. Each objective is one file.
//!
//! A plan's value is a function of three numbers: its gain (a sum over its goals), its charge (a price on every
//! resource it uses) and the reliability of the whole. An objective says what a goal adds to the gain, what resources
//! cost, and how the three make a value; the sequencer needs no more, neither to search nor to bound.

mod all_or_nothing;
mod chance_constrained;
mod expected_interest;
mod most_interesting;
mod net_benefit;
mod utility;

use std::fmt;
use std::str::FromStr;

use all_or_nothing::AllOrNothing;
use chance_constrained::ChanceConstrained;
use expected_interest::ExpectedInterest;
use most_interesting::MostInteresting;
use net_benefit::NetBenefit;
use utility::Utility;

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
    /// J2: the sum of the prizes times the reliability of the whole; nothing counts unless all of it succeeds, as when
    /// samples must come home.
    AllOrNothing,
    /// CC: the most interesting set among the plans that succeed with a stated confidence.
    ChanceConstrained,
    /// NET: prizes less a price on risk and on energy (net benefit, van den Briel et al. 2004).
    NetBenefit,
    /// UTIL: prizes that fade after a deadline, less a price on every resource (Williamson and Hanks 1994).
    Utility,
}

impl Policy {
    /// Every policy, in the order of the documentation.
    pub const ALL: [Self; 6] = [
        Self::ExpectedInterest,
        Self::MostInteresting,
        Self::AllOrNothing,
        Self::ChanceConstrained,
        Self::NetBenefit,
        Self::Utility,
    ];

    /// The objective behind the name.
    #[must_use]
    pub fn objective(self) -> &'static dyn Objective {
        match self {
            Self::ExpectedInterest => &ExpectedInterest,
            Self::MostInteresting => &MostInteresting,
            Self::AllOrNothing => &AllOrNothing,
            Self::ChanceConstrained => &ChanceConstrained,
            Self::NetBenefit => &NetBenefit,
            Self::Utility => &Utility,
        }
    }
}

impl fmt::Display for Policy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::ExpectedInterest => "expected-interest",
            Self::MostInteresting => "most-interesting",
            Self::AllOrNothing => "all-or-nothing",
            Self::ChanceConstrained => "chance-constrained",
            Self::NetBenefit => "net-benefit",
            Self::Utility => "utility",
        })
    }
}

/// A name that is no policy.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{0}` is not a policy; expected `expected-interest`, `most-interesting`, `all-or-nothing`, `chance-constrained`, \
     `net-benefit` or `utility`"
)]
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

/// A price for each resource of a plan, in units of prize; none is negative.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Prices {
    /// λ: price of a unit of −ln R.
    pub risk: f64,
    /// μ: price of a joule.
    pub energy_per_j: f64,
    /// Price of a second.
    pub time_per_s: f64,
    /// Price of a megabyte.
    pub data_per_mb: f64,
}

impl Prices {
    /// Everything is free.
    pub const NONE: Self = Self { risk: 0.0, energy_per_j: 0.0, time_per_s: 0.0, data_per_mb: 0.0 };
}

/// What an objective is told besides the plan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Preferences {
    /// Least chance of success that [`Policy::ChanceConstrained`] asks of a plan, in [0, 1] (default 0.8).
    pub confidence: f64,
    /// Prices of [`Policy::NetBenefit`] (risk and energy) and [`Policy::Utility`] (all four); by default λ = 1 and
    /// everything else is free.
    pub prices: Prices,
}

impl Default for Preferences {
    fn default() -> Self {
        Self { confidence: 0.8, prices: Prices { risk: 1.0, ..Prices::NONE } }
    }
}

/// One goal at the moment it is done.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Served {
    /// Its prize.
    pub prize: f64,
    /// Chance of having got there, in [0, 1].
    pub reliability: f64,
    /// What is left of its prize at that time, in [0, 1]: 1 before its deadline ([`crate::Fade`]).
    pub freshness: f64,
}

/// What a goal's gain hangs on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Gains {
    /// Its prize alone.
    Prize,
    /// Its prize times the chance of having got there.
    Chance,
    /// Anything else.
    Other,
}

/// What a sequence is worth. Sequences compare by value, then reliability, then time, then ids.
///
/// Searches and bounds rest on three promises: [`Objective::gain`] never falls when reliability or freshness rise,
/// [`Objective::value`] never falls when gain or reliability rise, and never rises with the charge.
pub trait Objective: Sync {
    /// What a goal adds to the plan's gain; never negative.
    fn gain(&self, served: Served) -> f64;

    /// What the gain hangs on. Says nothing that [`Objective::gain`] does not, but lets the sequencer weigh an insertion
    /// without going through all that follows it.
    fn gains(&self) -> Gains {
        Gains::Other
    }

    /// The prices that this objective heeds.
    fn prices(&self, _preferences: &Preferences) -> Prices {
        Prices::NONE
    }

    /// Least reliability of a whole plan that this objective asks for, besides the mission's floor.
    fn floor(&self, _preferences: &Preferences) -> f64 {
        0.0
    }

    /// The value of a plan with this gain, charge (resources times prices) and reliability of the whole.
    fn value(&self, gain: f64, charge: f64, _reliability: f64) -> f64 {
        gain - charge
    }
}

/// Sums in another order differ by some units in the last place; bounds are raised by more than that.
pub(crate) const ROUNDING: f64 = 1.0 + 1e-12;
