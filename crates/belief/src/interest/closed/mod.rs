//! The rules on {I, NI} in closed form, for one cell or for many side by side.
//!
//! Everything here is inlined into its caller, so that a map's sweep is compiled as a whole for each
//! instruction set; nothing rounds differently for that, since no step is a fused multiply-add. A closure, or
//! what the standard library makes of one, may be left out of that: here are loops instead.
#![expect(
    clippy::inline_always,
    reason = "code for an instruction set is compiled only where it is inlined"
)]

mod average;
mod cautious;
mod centre;
mod conjunctive;
mod counted;
mod disjunctive;
mod exponential;
mod hybrid;
mod lanes;
mod proportional;
mod quadrature;
mod redistribution;

use crate::{ParadoxPolicy, Rule, Settings};

pub(crate) use average::{Deng, Mean, Murphy};
pub(crate) use cautious::{Bold, Cautious};
pub(crate) use centre::{Jaccard, Zhang};
pub(crate) use conjunctive::{Conjunctive, Dempster, Dsmc, Inagaki, Yager, supported};
pub(crate) use counted::Purr;
pub(crate) use disjunctive::{Disjunctive, Florea};
pub(crate) use exponential::{Binary, Format, exponential};
pub(crate) use hybrid::Dsmh;
pub(crate) use lanes::Lanes;
pub(crate) use proportional::{Pcr1, Pcr2, Pcr4, Urr};
pub(crate) use redistribution::Redistribution;

/// m(I), m(NI), m(I ∪ NI), m(I ∩ NI); under Shafer's model the last is m(∅).
pub(crate) type Masses<L> = [L; 4];

/// What a closed form gives: the fused masses and K.
#[derive(Clone, Copy)]
pub(crate) struct Outcome<L> {
    pub masses: Masses<L>,
    pub conflict: L,
}

/// The sources of a cell, or of some cells side by side; at least one.
pub(crate) trait Sources<L> {
    /// Whether they are cells of a map, for which some sums are taken in a faster way that rounds a little
    /// differently.
    const MAP: bool;

    /// How many.
    fn count(&self) -> usize;

    /// The masses of one, after the paradox policy.
    fn masses(&self, source: usize) -> Masses<L>;
}

/// A rule on {I, NI}.
pub(crate) trait ClosedForm: Copy {
    /// Whether I ∩ NI may be true.
    const FREE: bool = false;

    /// All sources at once.
    fn fuse<L: Lanes>(self, sources: &impl Sources<L>) -> Outcome<L>;

    /// Bel(I) of what came out.
    #[inline(always)]
    fn belief<L: Lanes>(self, _sources: &impl Sources<L>, fused: Masses<L>) -> L {
        fused[0]
    }
}

/// Whoever wants a rule's closed form, whichever type it has.
pub(crate) trait Visitor<'a> {
    /// What comes of it.
    type Output;

    /// Takes the closed form.
    fn visit(self, form: impl ClosedForm + 'a) -> Self::Output;
}

impl Rule {
    /// Hands over the closed form of the rule.
    #[inline(always)]
    pub(crate) fn closed_form<'a, V: Visitor<'a>>(
        self,
        settings: &Settings<'a>,
        visitor: V,
    ) -> V::Output {
        match self {
            Self::Dsmc => visitor.visit(Dsmc),
            Self::Dempster | Self::MinC => visitor.visit(Dempster),
            Self::Conjunctive => visitor.visit(Conjunctive),
            Self::Disjunctive => visitor.visit(Disjunctive),
            Self::Yager | Self::DuboisPrade => visitor.visit(Yager),
            Self::Inagaki => visitor.visit(Inagaki { k: settings.inagaki_k }),
            Self::Dsmh => visitor.visit(Dsmh),
            Self::Pcr1 => visitor.visit(Pcr1),
            Self::Pcr2 | Self::Pcr3 => visitor.visit(Pcr2),
            Self::Pcr4 => visitor.visit(Pcr4),
            Self::Pcr5 => visitor.visit(Redistribution::<false, true>),
            Self::Pcr6 => visitor.visit(Redistribution::<true, true>),
            // On two atoms the most specific elements of a conflict are those that took part in it.
            Self::Pcr5Plus | Self::Pcr5Canonical => visitor.visit(Redistribution::<false, false>),
            Self::Pcr6Plus | Self::Pcr6Canonical => visitor.visit(Redistribution::<true, false>),
            Self::Florea => visitor.visit(Florea),
            Self::Average => visitor.visit(Mean { weights: settings.weights }),
            Self::Murphy => visitor.visit(Murphy),
            Self::Deng => visitor.visit(Deng),
            Self::Zhang => visitor.visit(Zhang),
            Self::Jaccard => visitor.visit(Jaccard),
            Self::Cautious => visitor.visit(Cautious),
            Self::Bold => visitor.visit(Bold),
            Self::Urr => visitor.visit(Urr),
            Self::Purr => visitor.visit(Purr),
        }
    }
}

impl ParadoxPolicy {
    /// The masses as a rule on Shafer's model takes them.
    #[inline(always)]
    pub(crate) fn moved<L: Lanes>(self, masses: Masses<L>) -> Masses<L> {
        let [i, n, u, p] = masses;
        match self {
            Self::ToIgnorance => [i, n, u + p, p.zero_of()],
            Self::Split => [i + p.half(), n + p.half(), u, p.zero_of()],
            Self::Renormalise => {
                // The division is not made where it would change nothing, which it might by rounding.
                let [by_i, by_n, by_u, zero] = scaled_up([i, n, u, p]);
                [
                    p.where_positive(by_i, i),
                    p.where_positive(by_n, n),
                    p.where_positive(by_u, u),
                    zero,
                ]
            }
            Self::KeepForDsmh | Self::ToEmpty => masses,
        }
    }
}

/// The masses but the last, divided by their sum; vacuous if there are none.
#[inline(always)]
pub(crate) fn scaled_up<L: Lanes>([i, n, u, p]: Masses<L>) -> Masses<L> {
    let rest = i + n + u;
    [
        i.share_of(rest),
        n.share_of(rest),
        rest.where_positive(u.share_of(rest), p.one_of()),
        p.zero_of(),
    ]
}

/// The masses where `defined` is above 0; elsewhere nothing is known.
#[inline(always)]
pub(crate) fn vacuous_unless<L: Lanes>(defined: L, [i, n, u, p]: Masses<L>) -> Masses<L> {
    let (zero, one) = (p.zero_of(), p.one_of());
    [
        defined.where_positive(i, zero),
        defined.where_positive(n, zero),
        defined.where_positive(u, one),
        defined.where_positive(p, zero),
    ]
}
