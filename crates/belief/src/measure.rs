//! What a mass function says of an element.

use crate::number::sum;
use crate::{Element, MassFunction, Number};

impl<F: Number> MassFunction<F> {
    /// Bel(A): the mass of what implies A (paper Eq. 3).
    #[must_use]
    pub fn belief(&self, a: Element) -> F {
        self.sum_where(|b| !b.is_empty() && b.is_subset_of(a))
    }

    /// Pl(A): the mass of what is compatible with A (paper Eq. 3).
    #[must_use]
    pub fn plausibility(&self, a: Element) -> F {
        self.sum_where(|b| !(b & a).is_empty())
    }

    /// q(A): the mass that is free to move to any part of A (Shafer 1976).
    #[must_use]
    pub fn commonality(&self, a: Element) -> F {
        self.sum_where(|b| a.is_subset_of(b))
    }

    /// b(A): the mass of what implies A, with that on ∅, which implies everything (Smets 1990).
    #[must_use]
    pub fn implicability(&self, a: Element) -> F {
        self.sum_where(|b| b.is_subset_of(a))
    }

    /// The mass on the empty element: K, when this is the outcome of the conjunctive rule.
    #[must_use]
    pub fn conflict(&self) -> F {
        self.mass(Element::EMPTY)
    }

    /// BetP(A): each focal element's mass shared evenly by its Venn regions (Smets 1994; by `DSm` cardinality,
    /// Dezert and Smarandache 2004), mass on ∅ taken out. 0 if all mass is on ∅.
    #[must_use]
    pub fn pignistic(&self, a: Element) -> F {
        self.spread(|b| share(F::count((a & b).cardinality()), F::count(b.cardinality())))
    }

    /// `DSmP_ε(A)`: each focal element's mass shared by its Venn regions in proportion to the masses already
    /// committed to single regions, plus ε each (Dezert and Smarandache 2008), mass on ∅ taken out. ε ≥ 0 and finite;
    /// where nothing is committed, and with ε = 0, the shares are even (the limit ε → 0).
    #[must_use]
    pub fn dsmp(&self, a: Element, epsilon: F) -> F {
        let weight = |x: Element| {
            let single = self.sum_where(|b| b.cardinality() == 1 && b.is_subset_of(x));
            single + epsilon * F::count(x.cardinality())
        };
        self.spread(|b| {
            let whole = weight(b);
            if whole > F::zero() {
                return weight(a & b) / whole;
            }
            share(F::count((a & b).cardinality()), F::count(b.cardinality()))
        })
    }

    pub(crate) fn sum_where(&self, counts: impl Fn(Element) -> bool) -> F {
        sum(self.focal().iter().filter(|&&(b, _)| counts(b)).map(|&(_, mass)| mass))
    }

    fn spread(&self, part: impl Fn(Element) -> F) -> F {
        let possible = self.focal().iter().filter(|(b, _)| !b.is_empty());
        let sum = sum(possible.map(|&(b, mass)| mass * part(b)));
        if self.conflict() == F::zero() {
            return sum;
        }
        share(sum, self.sum_where(|b| !b.is_empty()))
    }
}

/// `part / whole`, and 0 of nothing.
pub(crate) fn share<F: Number>(part: F, whole: F) -> F {
    if whole > F::zero() { part / whole } else { F::zero() }
}
