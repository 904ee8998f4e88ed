//! Rules of combination: several sources, one mass function.
//!
//! [`combine`] is the definition on any frame; [`Rule::fuse`] the closed form on the paper's frame {I, NI},
//! which maps are made with. All sources are always taken at once: some rules depend on the order otherwise.

mod conjunctive;
mod dempster;
mod dsmc;
mod pcr6;

use std::{fmt, str::FromStr};

use crate::{BeliefError, Frame, MassFunction, Model};

pub use conjunctive::{conflict, conjunctive};

/// The most sources that a rule without a closed form (`pcr6`) is meant to take on a map: it visits 3^S
/// assignments a cell, 6561 for eight.
pub const MAX_SOURCES: usize = 8;

/// A rule of combination.
///
/// ```
/// # use wisdom_belief::Rule;
/// let rule: Rule = "dempster".parse()?;
/// assert_eq!(rule, Rule::Dempster);
/// # Ok::<(), wisdom_belief::BeliefError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
#[non_exhaustive]
pub enum Rule {
    /// The classic rule of DSmT (Dezert 2002; paper Eq. 2): opposite opinions meet in their intersection.
    #[default]
    Dsmc,
    /// Dempster's rule (Dempster 1967, Shafer 1976; paper Eq. 5): conflict is dropped, the rest scaled up.
    Dempster,
    /// Proportional conflict redistribution no. 6 (Martin and Osswald 2006): each conflicting product goes
    /// back to those who made it, in proportion to their masses.
    Pcr6,
}

impl Rule {
    /// Every rule there is.
    pub const ALL: [Self; 3] = [Self::Dsmc, Self::Dempster, Self::Pcr6];

    /// The name that [`FromStr`] reads.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Dsmc => "dsmc",
            Self::Dempster => "dempster",
            Self::Pcr6 => "pcr6",
        }
    }

    /// What it does, on one line.
    #[must_use]
    pub const fn summary(self) -> &'static str {
        match self {
            Self::Dsmc => "opposite opinions meet in the paradox; free model (paper Eq. 2)",
            Self::Dempster => {
                "conflict is dropped and the rest scaled up; exclusive model (paper Eq. 5)"
            }
            Self::Pcr6 => {
                "each conflict goes back to its makers; exclusive model (Martin and Osswald 2006)"
            }
        }
    }

    /// The model under which the rule reads the frame {I, NI}.
    #[must_use]
    pub const fn model(self) -> Model {
        match self {
            Self::Dsmc => Model::Free,
            Self::Dempster | Self::Pcr6 => Model::Shafer,
        }
    }
}

impl fmt::Display for Rule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Rule {
    type Err = BeliefError;

    fn from_str(name: &str) -> Result<Self, BeliefError> {
        Self::ALL.into_iter().find(|rule| rule.name() == name).ok_or_else(|| {
            BeliefError::UnknownName {
                what: "rule",
                name: name.to_owned(),
                known: Self::ALL.map(Self::name).join(", "),
            }
        })
    }
}

/// Combines all sources at once by a rule, on any frame. Without sources the result is vacuous.
///
/// ```
/// # use wisdom_belief::{BeliefError, Frame, MassFunction, Rule, rule};
/// // Zadeh's two physicians: they agree only on what both find unlikely.
/// let frame = Frame::shafer(["meningitis", "concussion", "tumour"])?;
/// let first = MassFunction::parse(&frame, [("meningitis", 0.99), ("tumour", 0.01)])?;
/// let second = MassFunction::parse(&frame, [("concussion", 0.99), ("tumour", 0.01)])?;
/// let fused = rule::combine(Rule::Dempster, &[first, second], &frame)?;
/// assert_eq!(fused.mass(frame.parse("tumour")?), 1.0);
/// # Ok::<(), BeliefError>(())
/// ```
///
/// # Errors
/// [`BeliefError::ForeignElement`] if a source is not of this frame; [`BeliefError::NotFreeModel`] for
/// `dsmc` where some intersection is empty; [`BeliefError::MassOnEmpty`] for `dsmc` and `pcr6`;
/// [`BeliefError::TotalConflict`] for `dempster`; [`BeliefError::TooManyProducts`] for `pcr6`.
pub fn combine(
    rule: Rule,
    sources: &[MassFunction],
    frame: &Frame,
) -> Result<MassFunction, BeliefError> {
    match rule {
        Rule::Dsmc => dsmc::combine(sources, frame),
        Rule::Dempster => dempster::combine(sources, frame),
        Rule::Pcr6 => pcr6::combine(sources, frame),
    }
}

fn check_frame(sources: &[MassFunction], frame: &Frame) -> Result<(), BeliefError> {
    sources.iter().flat_map(MassFunction::focal).try_for_each(|&(element, _)| frame.check(element))
}

/// Refuses sources that commit mass to the empty element.
fn check_none_on_empty(rule: Rule, sources: &[MassFunction]) -> Result<(), BeliefError> {
    match sources.iter().position(|source| source.conflict() > 0.0) {
        None => Ok(()),
        Some(index) => {
            Err(BeliefError::MassOnEmpty { index, mass: sources[index].conflict(), rule })
        }
    }
}
