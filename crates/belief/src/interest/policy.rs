//! What a source's paradox means to a rule that knows none (paper Table 8).

use std::{fmt, str::FromStr};

use crate::{BeliefError, InterestMass};

/// Where m(I ∩ NI) goes, source by source, before a rule on Shafer's model.
///
/// The choice matters: on the paper's point (67, 20) Dempster's m(I) is 0.688, 0.754 or 0.844.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
#[non_exhaustive]
pub enum ParadoxPolicy {
    /// To I ∪ NI, as in the paper's Table 8.
    #[default]
    ToIgnorance,
    /// Half to I, half to NI.
    Split,
    /// Dropped, and the other masses scaled up to sum to 1. (A source that is all paradox becomes vacuous.)
    Renormalise,
}

impl ParadoxPolicy {
    /// Every policy there is.
    pub const ALL: [Self; 3] = [Self::ToIgnorance, Self::Split, Self::Renormalise];

    /// The name that [`FromStr`] reads.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::ToIgnorance => "to-ignorance",
            Self::Split => "split",
            Self::Renormalise => "renormalise",
        }
    }

    /// The mass function without its paradox.
    #[must_use]
    pub fn apply(self, mass: InterestMass) -> InterestMass {
        let InterestMass { interesting, not_interesting, ignorance, paradox } = mass;
        if paradox == 0.0 {
            return mass;
        }
        match self {
            Self::ToIgnorance => {
                InterestMass { ignorance: ignorance + paradox, paradox: 0.0, ..mass }
            }
            Self::Split => InterestMass {
                interesting: interesting + paradox / 2.0,
                not_interesting: not_interesting + paradox / 2.0,
                paradox: 0.0,
                ..mass
            },
            Self::Renormalise => mass.without_paradox(),
        }
    }
}

impl InterestMass {
    /// The other masses scaled to sum to 1; vacuous if there are none.
    pub(super) fn without_paradox(self) -> Self {
        let rest = self.interesting + self.not_interesting + self.ignorance;
        if rest == 0.0 {
            return Self::VACUOUS;
        }
        Self {
            interesting: self.interesting / rest,
            not_interesting: self.not_interesting / rest,
            ignorance: self.ignorance / rest,
            paradox: 0.0,
        }
    }
}

impl fmt::Display for ParadoxPolicy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for ParadoxPolicy {
    type Err = BeliefError;

    fn from_str(name: &str) -> Result<Self, BeliefError> {
        Self::ALL.into_iter().find(|policy| policy.name() == name).ok_or_else(|| {
            BeliefError::UnknownName {
                what: "paradox policy",
                name: name.to_owned(),
                known: Self::ALL.map(Self::name).join(", "),
            }
        })
    }
}
