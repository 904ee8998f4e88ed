//! Rules of combination: several sources, one mass function.
//!
//! [`combine`] is the definition on any frame; [`Rule::fuse`] the closed form on the paper's frame {I, NI},
//! which maps are made with. All sources are always taken at once, since for most rules the result of two at
//! a time depends on the order; [`fold`] takes them so, for those who want just that.

mod accumulate;
mod algebra;
mod average;
mod bodies;
mod cautious;
mod conjunctive;
mod engine;
mod hybrid;
mod mask;
mod page;
mod proportional;
mod settings;
mod walk;

use std::{fmt, str::FromStr};

use crate::{BeliefError, Model};

pub use algebra::Algebra;
pub use conjunctive::{conflict, conjunctive};
pub use engine::{Workspace, combine, combine_with, fold};
pub use settings::Settings;

/// The most sources that a rule which visits 3^S assignments of a cell is meant to take on a map: 6561 for
/// eight.
pub const MAX_SOURCES: usize = 8;

/// A rule of combination.
///
/// ```
/// # use wisdom_belief::Rule;
/// let rule: Rule = "dubois-prade".parse()?;
/// assert_eq!(rule, Rule::DuboisPrade);
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
    /// The conjunctive rule of the transferable belief model (Smets 1990): conflict stays on ∅.
    Conjunctive,
    /// The disjunctive rule (Dubois and Prade 1986): at least one source is right, so products go to unions.
    Disjunctive,
    /// Yager's rule (1987): all conflict becomes ignorance.
    Yager,
    /// Dubois and Prade's rule (1988): each conflicting product goes to the union of what made it.
    DuboisPrade,
    /// Inagaki's family (1991): from Yager's rule at k = 0 towards Dempster's, by [`Settings::inagaki_k`].
    Inagaki,
    /// The hybrid rule of DSmT (Dezert and Smarandache 2004): for a model learned after the sources spoke.
    Dsmh,
    /// Proportional conflict redistribution no. 1 (Smarandache and Dezert 2005), the same as the weighted average
    /// operator (Jøsang, Daniel and Vannoorenberghe 2003).
    Pcr1,
    /// Proportional conflict redistribution no. 2: all conflict to the elements in conflict (Smarandache and Dezert 2005).
    Pcr2,
    /// Proportional conflict redistribution no. 3: each conflict by column sums (Smarandache and Dezert 2005).
    Pcr3,
    /// Proportional conflict redistribution no. 4: each conflict by conjunctive masses (Smarandache and Dezert 2005).
    Pcr4,
    /// Proportional conflict redistribution no. 5 (Smarandache and Dezert 2005): each conflicting product back to its
    /// elements, by the product of the masses that each was given.
    Pcr5,
    /// Proportional conflict redistribution no. 6 (Martin and Osswald 2006): each conflicting product goes
    /// back to those who made it, in proportion to their masses.
    Pcr6,
    /// PCR5⁺ (Dezert, Dezert and Smarandache 2021): as PCR5, and nothing to elements that took no part in the conflict.
    Pcr5Plus,
    /// PCR6⁺ (Dezert, Dezert and Smarandache 2021): as PCR6, and nothing to elements that took no part in the conflict.
    Pcr6Plus,
    /// PCR5 as in the worked examples of 2006: only the most specific elements of a conflict share it.
    Pcr5Canonical,
    /// PCR6 in the manner of [`Rule::Pcr5Canonical`]: only the most specific elements of a conflict share it.
    Pcr6Canonical,
    /// minC (after Daniel 2000), in one step: each conflict to all parts of its union, by their conjunctive mass.
    MinC,
    /// The robust combination rule (Florea, Jousselme, Bossé and Grenier 2009): disjunctive and conjunctive mixed by K.
    Florea,
    /// The mean of the sources, weighted by [`Settings::weights`] if given.
    Average,
    /// Murphy's rule (2000): the mean of the sources, combined with itself by Dempster's rule S − 1 times.
    Murphy,
    /// Deng's rule (Deng, Shi, Zhu and Liu 2004): as Murphy's, the mean weighted by each source's agreement with the others.
    Deng,
    /// Zhang's centre combination (1994): products weighted by |∩| / Π|X|, then scaled up.
    Zhang,
    /// The Jaccard centre (Smarandache and Dezert 2015): products weighted by |∩| / |∪|, then scaled up.
    Jaccard,
    /// The cautious conjunctive rule (Denœux 2008): sources may share evidence; what is said twice counts once.
    Cautious,
    /// The bold disjunctive rule (Denœux 2008), the dual of the cautious one; needs mass on ∅.
    Bold,
    /// Uniform redistribution (Smarandache 2004): all conflict in equal shares to all focal elements.
    Urr,
    /// Partially uniform redistribution (Smarandache 2004): each conflict in equal shares to those who made it.
    Purr,
}

impl Rule {
    /// Every rule there is.
    pub const ALL: [Self; 29] = [
        Self::Dsmc,
        Self::Dempster,
        Self::Conjunctive,
        Self::Disjunctive,
        Self::Yager,
        Self::DuboisPrade,
        Self::Inagaki,
        Self::Dsmh,
        Self::Pcr1,
        Self::Pcr2,
        Self::Pcr3,
        Self::Pcr4,
        Self::Pcr5,
        Self::Pcr6,
        Self::Pcr5Plus,
        Self::Pcr6Plus,
        Self::Pcr5Canonical,
        Self::Pcr6Canonical,
        Self::MinC,
        Self::Florea,
        Self::Average,
        Self::Murphy,
        Self::Deng,
        Self::Zhang,
        Self::Jaccard,
        Self::Cautious,
        Self::Bold,
        Self::Urr,
        Self::Purr,
    ];

    /// The name that [`FromStr`] reads (with `-` or `_`).
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Dsmc => "dsmc",
            Self::Dempster => "dempster",
            Self::Conjunctive => "conjunctive",
            Self::Disjunctive => "disjunctive",
            Self::Yager => "yager",
            Self::DuboisPrade => "dubois-prade",
            Self::Inagaki => "inagaki",
            Self::Dsmh => "dsmh",
            Self::Pcr1 => "pcr1",
            Self::Pcr2 => "pcr2",
            Self::Pcr3 => "pcr3",
            Self::Pcr4 => "pcr4",
            Self::Pcr5 => "pcr5",
            Self::Pcr6 => "pcr6",
            Self::Pcr5Plus => "pcr5-plus",
            Self::Pcr6Plus => "pcr6-plus",
            Self::Pcr5Canonical => "pcr5-canonical",
            Self::Pcr6Canonical => "pcr6-canonical",
            Self::MinC => "minc",
            Self::Florea => "florea-rcr",
            Self::Average => "average",
            Self::Murphy => "murphy",
            Self::Deng => "deng",
            Self::Zhang => "zhang",
            Self::Jaccard => "jaccard-centre",
            Self::Cautious => "cautious",
            Self::Bold => "bold",
            Self::Urr => "urr",
            Self::Purr => "purr",
        }
    }

    /// What it does, on one line.
    #[must_use]
    pub const fn summary(self) -> &'static str {
        match self {
            Self::Dsmc => "opposite opinions meet in the paradox; free model (paper Eq. 2)",
            Self::Dempster => "conflict is dropped and the rest scaled up (paper Eq. 5)",
            Self::Conjunctive => "conflict stays on the empty element (Smets 1990)",
            Self::Disjunctive => {
                "at least one source is right: products go to unions (Dubois and Prade 1986)"
            }
            Self::Yager => "all conflict becomes ignorance (Yager 1987)",
            Self::DuboisPrade => {
                "each conflict goes to the union of what made it (Dubois and Prade 1988)"
            }
            Self::Inagaki => "a family between Yager and Dempster, by a parameter k (Inagaki 1991)",
            Self::Dsmh => {
                "conflict goes to unions, by the hybrid model (Dezert and Smarandache 2004)"
            }
            Self::Pcr1 => {
                "all conflict shared by what each element got in all (Smarandache and Dezert 2005)"
            }
            Self::Pcr2 => {
                "all conflict shared by the elements in conflict (Smarandache and Dezert 2005)"
            }
            Self::Pcr3 => {
                "each conflict shared by its elements, by column sums (Smarandache and Dezert 2005)"
            }
            Self::Pcr4 => {
                "each conflict shared by its elements, by conjunctive mass (Smarandache and Dezert 2005)"
            }
            Self::Pcr5 => {
                "each conflict back to its elements, by the products of their masses (Smarandache and Dezert 2005)"
            }
            Self::Pcr6 => {
                "each conflict back to its elements, by the sums of their masses (Martin and Osswald 2006)"
            }
            Self::Pcr5Plus => {
                "as pcr5, and nothing to elements that took no part in the conflict (Dezert et al. 2021)"
            }
            Self::Pcr6Plus => {
                "as pcr6, and nothing to elements that took no part in the conflict (Dezert et al. 2021)"
            }
            Self::Pcr5Canonical => {
                "as pcr5, only the most specific elements of a conflict share it (Smarandache and Dezert 2006)"
            }
            Self::Pcr6Canonical => {
                "as pcr6, only the most specific elements of a conflict share it"
            }
            Self::MinC => {
                "conflict goes to all parts of its union, by conjunctive mass (after Daniel 2000)"
            }
            Self::Florea => {
                "disjunctive and conjunctive mixed, by the conflict (Florea et al. 2009)"
            }
            Self::Average => "the mean of the sources",
            Self::Murphy => {
                "the mean of the sources, taken to its S-th power by Dempster's rule (Murphy 2000)"
            }
            Self::Deng => "as murphy, the mean weighted by agreement (Deng et al. 2004)",
            Self::Zhang => "products weighted by the share of overlap (Zhang 1994)",
            Self::Jaccard => "products weighted by overlap over union",
            Self::Cautious => {
                "what is said twice counts once; sources may share evidence (Denœux 2008)"
            }
            Self::Bold => "the disjunctive twin of cautious (Denœux 2008)",
            Self::Urr => "all conflict in equal shares over all that was said (Smarandache 2004)",
            Self::Purr => "each conflict in equal shares to those who made it (Smarandache 2004)",
        }
    }

    /// The model under which the rule reads the frame {I, NI} on maps.
    #[must_use]
    pub const fn model(self) -> Model {
        match self {
            Self::Dsmc => Model::Free,
            _ => Model::Shafer,
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
        let hyphened = name.replace('_', "-");
        Self::ALL.into_iter().find(|rule| rule.name() == hyphened).ok_or_else(|| {
            BeliefError::UnknownName {
                what: "rule",
                name: name.to_owned(),
                known: Self::ALL.map(Self::name).join(", "),
            }
        })
    }
}
