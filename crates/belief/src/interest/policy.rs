//! What a source's paradox means to a rule that knows none (paper Table 8).

use std::{fmt, str::FromStr};

use crate::{BeliefError, InterestMass, Number};

/// Where m(I ∩ NI) goes, source by source, before a rule on Shafer's model.
///
/// The choice matters: on the paper's point (67, 20) Dempster's m(I) is 0.688, 0.754 or 0.844. Not every rule gives
/// every policy a meaning: see [`Rule::admits`](crate::Rule::admits).
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
    /// Kept, for the hybrid rule of DSmT, which learns that I ∩ NI is empty only when the sources have spoken.
    KeepForDsmh,
    /// To ∅: what a source says of both at once it says against the frame (an open world; Smets 1990).
    ToEmpty,
}

impl ParadoxPolicy {
    /// Every policy there is.
    pub const ALL: [Self; 5] =
        [Self::ToIgnorance, Self::Split, Self::Renormalise, Self::KeepForDsmh, Self::ToEmpty];

    /// The name that [`FromStr`] reads.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::ToIgnorance => "to-ignorance",
            Self::Split => "split",
            Self::Renormalise => "renormalise",
            Self::KeepForDsmh => "keep-for-dsmh",
            Self::ToEmpty => "to-empty",
        }
    }

    /// The mass function as a rule on Shafer's model takes it: without paradox, but for the last two policies,
    /// under which it stays where it is and has another meaning (m(∅), under [`ParadoxPolicy::ToEmpty`]).
    #[must_use]
    pub fn apply<F: Number>(self, mass: InterestMass<F>) -> InterestMass<F> {
        if mass.paradox == F::zero() {
            return mass;
        }
        InterestMass::from_array(self.moved(mass.masses()))
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
