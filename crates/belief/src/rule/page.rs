//! The page of each rule.

use super::Rule;

impl Rule {
    /// The rule's page, in Markdown: formula, model, order-dependence, source, and what it does to two examples.
    #[must_use]
    pub const fn page(self) -> &'static str {
        match self {
            Self::Dsmc => include_str!("../../rules/dsmc.md"),
            Self::Dempster => include_str!("../../rules/dempster.md"),
            Self::Conjunctive => include_str!("../../rules/conjunctive.md"),
            Self::Disjunctive => include_str!("../../rules/disjunctive.md"),
            Self::Yager => include_str!("../../rules/yager.md"),
            Self::DuboisPrade => include_str!("../../rules/dubois-prade.md"),
            Self::Inagaki => include_str!("../../rules/inagaki.md"),
            Self::Dsmh => include_str!("../../rules/dsmh.md"),
            Self::Pcr1 => include_str!("../../rules/pcr1.md"),
            Self::Pcr2 => include_str!("../../rules/pcr2.md"),
            Self::Pcr3 => include_str!("../../rules/pcr3.md"),
            Self::Pcr4 => include_str!("../../rules/pcr4.md"),
            Self::Pcr5 => include_str!("../../rules/pcr5.md"),
            Self::Pcr6 => include_str!("../../rules/pcr6.md"),
            Self::Pcr5Plus => include_str!("../../rules/pcr5-plus.md"),
            Self::Pcr6Plus => include_str!("../../rules/pcr6-plus.md"),
            Self::Pcr5Canonical => include_str!("../../rules/pcr5-canonical.md"),
            Self::Pcr6Canonical => include_str!("../../rules/pcr6-canonical.md"),
            Self::MinC => include_str!("../../rules/minc.md"),
            Self::Florea => include_str!("../../rules/florea-rcr.md"),
            Self::Average => include_str!("../../rules/average.md"),
            Self::Murphy => include_str!("../../rules/murphy.md"),
            Self::Deng => include_str!("../../rules/deng.md"),
            Self::Zhang => include_str!("../../rules/zhang.md"),
            Self::Jaccard => include_str!("../../rules/jaccard-centre.md"),
            Self::Cautious => include_str!("../../rules/cautious.md"),
            Self::Bold => include_str!("../../rules/bold.md"),
            Self::Urr => include_str!("../../rules/urr.md"),
            Self::Purr => include_str!("../../rules/purr.md"),
        }
    }
}
