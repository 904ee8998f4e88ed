//! The pool of high-level directives from which every goal comes.

use crate::lifecycle::named;
use crate::{FactSet, Fade, Window};

named! {
    /// What a directive looks for in the fused evidence of a place.
    Kind {
        /// What is interesting: go there and work. Reads the prize map.
        Inspect = "inspect",
        /// What ignorance hides: a place that would be interesting if its readings could be trusted. Reads the promise map,
        /// the prize that certain readings would give, less the prize there is.
        LookAgain = "look-again",
        /// What the experts contradict each other about. Reads the contradiction map.
        Adjudicate = "adjudicate",
    }
}

impl Kind {
    /// Whether a goal of this kind that is done leaves nothing to do around it for one of another kind.
    #[must_use]
    pub fn closes(self, other: Self) -> bool {
        matches!((self, other), (Self::Inspect, _) | (_, Self::LookAgain)) || self == other
    }
}

impl std::str::FromStr for Kind {
    type Err = UnknownKind;

    fn from_str(name: &str) -> Result<Self, UnknownKind> {
        Self::ALL
            .iter()
            .copied()
            .find(|kind| kind.name() == name)
            .ok_or_else(|| UnknownKind(name.to_owned()))
    }
}

/// A name that is no kind.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is no kind of directive; expected `inspect`, `look-again` or `adjudicate`")]
pub struct UnknownKind(pub String);

/// One entry of the pool: what to look for, and what to do there.
///
/// Goals come only from directives, so the rover can want nothing it was not built for (paper, section I).
#[derive(Debug, Clone, PartialEq)]
pub struct Directive {
    /// Name, unique in the pool.
    pub name: String,
    /// What it looks for.
    pub kind: Kind,
    /// Experts (by index) of which at least one must carry [`Directive::min_credit`] of a site's interest;
    /// empty means any site will do.
    pub experts: Vec<usize>,
    /// Least share of the site's interest that comes from those experts together, in [0, 1].
    pub min_credit: f64,
    /// Least interest (not prize) of a site, in [0, 1]; for [`Kind::LookAgain`] the interest promised.
    pub min_interest: f64,
    /// Least value of what its kind reads at a site, in [0, 1].
    pub min_signal: f64,
    /// The type of object it is for, by index in the [`crate::Taxonomy`]; any if none.
    pub object: Option<usize>,
    /// Factor on the prize.
    pub weight: f64,
    /// Facts that must hold before the goal's turn, besides its operators' own preconditions.
    pub requires: FactSet,
    /// Facts that make the goal achieved.
    pub achieves: FactSet,
    /// How far from the target it can be done, metres.
    pub standoff_m: f64,
    /// How many tries a goal gets (default 2).
    pub max_attempts: u32,
    /// Around an achieved goal, no further goal of any directive within this distance, metres.
    pub exclusion_radius_m: f64,
    /// The directive (by index) that a goal erodes to once an attempt has failed, if any.
    pub substitute: Option<usize>,
    /// How far away another of its kind may be that takes the place of a target that cannot be reached, metres; 0: none
    /// may.
    pub generalise_m: f64,
    /// When work may begin, seconds since the mission began; at any time if none.
    pub window: Option<Window>,
    /// Whether a sequence with its goal is better than any without.
    pub mandatory: bool,
    /// How its prize fades, seconds since the mission began, for [`crate::Policy::Utility`].
    pub fade: Option<Fade>,
}

impl Directive {
    /// A directive without conditions: any site will do, from its own cell, twice, until it is done.
    #[must_use]
    pub fn new(name: &str, achieves: FactSet) -> Self {
        Self {
            name: name.to_owned(),
            kind: Kind::Inspect,
            experts: Vec::new(),
            min_credit: 0.0,
            min_interest: 0.0,
            min_signal: 0.0,
            object: None,
            weight: 1.0,
            requires: FactSet::EMPTY,
            achieves,
            standoff_m: 0.0,
            max_attempts: 2,
            exclusion_radius_m: 0.0,
            substitute: None,
            generalise_m: 0.0,
            window: None,
            mandatory: false,
            fade: None,
        }
    }

    /// Whether a site with this interest and these shares of credit is what the directive looks for.
    #[must_use]
    pub fn accepts(&self, interest: f64, credit: &[f64]) -> bool {
        let share: f64 = self.experts.iter().filter_map(|&e| credit.get(e)).sum();
        interest >= self.min_interest && (self.experts.is_empty() || share >= self.min_credit)
    }
}
