//! What a mass function says of an element.

use crate::{Element, MassFunction};

impl MassFunction {
    /// Bel(A): the mass of what implies A (paper Eq. 3).
    #[must_use]
    pub fn belief(&self, a: Element) -> f64 {
        self.sum_where(|b| !b.is_empty() && b.is_subset_of(a))
    }

    /// Pl(A): the mass of what is compatible with A (paper Eq. 3).
    #[must_use]
    pub fn plausibility(&self, a: Element) -> f64 {
        self.sum_where(|b| !(b & a).is_empty())
    }

    /// q(A): the mass that is free to move to any part of A (Shafer 1976).
    #[must_use]
    pub fn commonality(&self, a: Element) -> f64 {
        self.sum_where(|b| a.is_subset_of(b))
    }

    /// The mass on the empty element: K, when this is the outcome of the conjunctive rule.
    #[must_use]
    pub fn conflict(&self) -> f64 {
        self.mass(Element::EMPTY)
    }

    /// BetP(A): each focal element's mass shared evenly by its Venn regions (Smets 1994; by `DSm` cardinality,
    /// Dezert and Smarandache 2004), mass on ∅ taken out. 0 if all mass is on ∅.
    #[must_use]
    pub fn pignistic(&self, a: Element) -> f64 {
        self.spread(|b| share(f64::from((a & b).cardinality()), f64::from(b.cardinality())))
    }

    /// `DSmP_ε(A)`: each focal element's mass shared by its Venn regions in proportion to the masses already
    /// committed to single regions, plus ε each (Dezert and Smarandache 2008), mass on ∅ taken out. ε ≥ 0;
    /// where nothing is committed, and with ε = 0, the shares are even (the limit ε → 0).
    #[must_use]
    pub fn dsmp(&self, a: Element, epsilon: f64) -> f64 {
        let weight = |x: Element| {
            let single = self.sum_where(|b| b.cardinality() == 1 && b.is_subset_of(x));
            single + epsilon * f64::from(x.cardinality())
        };
        self.spread(|b| match weight(b) {
            0.0 => share(f64::from((a & b).cardinality()), f64::from(b.cardinality())),
            whole => share(weight(a & b), whole),
        })
    }

    fn sum_where(&self, counts: impl Fn(Element) -> bool) -> f64 {
        self.focal().iter().filter(|&&(b, _)| counts(b)).map(|&(_, mass)| mass).sum()
    }

    fn spread(&self, part: impl Fn(Element) -> f64) -> f64 {
        let possible = self.focal().iter().filter(|(b, _)| !b.is_empty());
        let sum: f64 = possible.map(|&(b, mass)| mass * part(b)).sum();
        match self.conflict() {
            0.0 => sum,
            _ => share(sum, self.sum_where(|b| !b.is_empty())),
        }
    }
}

/// `part / whole`, and 0 of nothing.
pub(crate) fn share(part: f64, whole: f64) -> f64 {
    if whole > 0.0 { part / whole } else { 0.0 }
}
