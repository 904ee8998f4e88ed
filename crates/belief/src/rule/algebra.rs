//! Which laws a rule obeys.

use super::Rule;

/// The laws that tell whether the order and the number of sources matter. Every rule commutes when all sources
/// are combined at once.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Algebra {
    /// Two at a time, in any grouping, gives what all at once gives: [`fold`](super::fold) is
    /// [`combine`](super::combine).
    pub associative: bool,
    /// A source that knows nothing changes nothing.
    pub vacuous_is_neutral: bool,
    /// A source combined with itself says the same.
    pub idempotent: bool,
}

impl Rule {
    /// The laws the rule obeys on every model it works on.
    #[must_use]
    pub const fn algebra(self) -> Algebra {
        let (associative, vacuous_is_neutral, idempotent) = match self {
            Self::Conjunctive | Self::Dsmc | Self::Dempster | Self::Zhang => (true, true, false),
            Self::Disjunctive => (true, false, false),
            Self::Cautious | Self::Bold => (true, false, true),
            Self::Yager
            | Self::Inagaki
            | Self::Pcr2
            | Self::Pcr3
            | Self::Pcr4
            | Self::Pcr5Plus
            | Self::Pcr6Plus
            | Self::Pcr5Canonical
            | Self::Pcr6Canonical => (false, true, false),
            Self::Average => (false, false, true),
            Self::DuboisPrade
            | Self::Dsmh
            | Self::Pcr1
            | Self::Pcr5
            | Self::Pcr6
            | Self::MinC
            | Self::Florea
            | Self::Murphy
            | Self::Deng
            | Self::Jaccard
            | Self::Urr
            | Self::Purr => (false, false, false),
        };
        Algebra { associative, vacuous_is_neutral, idempotent }
    }
}
