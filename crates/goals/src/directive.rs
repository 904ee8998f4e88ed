//! The pool of high-level directives from which every goal comes.

use crate::{FactSet, Fade};

/// One entry of the pool: what to look for, and what to do there.
///
/// Goals come only from directives, so the rover can want nothing it was not built for (paper, section I).
#[derive(Debug, Clone, PartialEq)]
pub struct Directive {
    /// Name, unique in the pool.
    pub name: String,
    /// Experts (by index) of which at least one must carry [`Directive::min_credit`] of a site's interest;
    /// empty means any site will do.
    pub experts: Vec<usize>,
    /// Least share of the site's interest that comes from those experts together, in [0, 1].
    pub min_credit: f64,
    /// Least interest (not prize) of a site, in [0, 1].
    pub min_interest: f64,
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
    /// Whether a sequence with its goal is better than any without.
    pub mandatory: bool,
    /// How its prize fades, seconds since the mission began, for [`crate::Policy::Utility`].
    pub fade: Option<Fade>,
}

impl Directive {
    /// Whether a site with this interest and these shares of credit is what the directive looks for.
    #[must_use]
    pub fn accepts(&self, interest: f64, credit: &[f64]) -> bool {
        let share: f64 = self.experts.iter().filter_map(|&e| credit.get(e)).sum();
        interest >= self.min_interest && (self.experts.is_empty() || share >= self.min_credit)
    }
}
