//! The number that goals read from a fused mass.

use std::{fmt, str::FromStr};

use wisdom_belief::{InterestMass, Model};

use crate::FusionError;

/// ε of `DSmP`: small enough that committed masses decide, above 0 so that elements without any still get
/// their part (Dezert and Smarandache 2008 use it in their examples).
pub const DSMP_EPSILON: f64 = 0.001;

/// Which number of a cell's fused mass is its interest.
///
/// Plausibility is none of them: under `dsmc` it is 1 everywhere, and reading its name says so.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
#[non_exhaustive]
pub enum Statistic {
    /// Bel(I), the pessimistic end (paper Eq. 3 and section III.B).
    #[default]
    Belief,
    /// BetP(I): every mass shared evenly by the Venn regions of its element (Smets 1994).
    Pignistic,
    /// `DSmP_ε(I)` with ε = [`DSMP_EPSILON`] (Dezert and Smarandache 2008).
    Dsmp,
}

impl Statistic {
    /// Every statistic there is.
    pub const ALL: [Self; 3] = [Self::Belief, Self::Pignistic, Self::Dsmp];

    /// The name that [`FromStr`] reads.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Belief => "belief",
            Self::Pignistic => "pignistic",
            Self::Dsmp => "dsmp",
        }
    }

    /// The statistic of a mass fused under `model`.
    #[must_use]
    pub fn of(self, fused: InterestMass, model: &Model) -> f64 {
        match self {
            Self::Belief => fused.belief_under(model),
            Self::Pignistic => fused.pignistic(model),
            Self::Dsmp => fused.dsmp(model, DSMP_EPSILON),
        }
    }

    pub(crate) fn known() -> String {
        Self::ALL.map(Self::name).join(", ")
    }
}

impl fmt::Display for Statistic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Statistic {
    type Err = FusionError;

    fn from_str(name: &str) -> Result<Self, FusionError> {
        let found = Self::ALL.into_iter().find(|statistic| statistic.name() == name);
        found.ok_or_else(|| match name {
            "plausibility" => FusionError::ConstantPlausibility,
            _ => FusionError::UnknownStatistic { name: name.to_owned() },
        })
    }
}
