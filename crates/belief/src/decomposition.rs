//! Canonical decompositions: a mass function as many simple ones (Smets 1995; Denœux 2008), on any model.
//!
//! Conjunctively, m is the intersection of simple mass functions that give 1 − w(A) to A and w(A) to Θ;
//! disjunctively, the union of such that give 1 − v(A) to A and v(A) to ∅. Weights above 1 stand for what
//! would have to be taken back. Only intersections (or unions) of focal elements have a weight other than 1.

use crate::closure::{join_closure, meet_closure};
use crate::{BeliefError, Element, Frame, MassFunction, Number};

/// The weights of a canonical decomposition: positive, and 1 of all elements that are not listed.
#[derive(Debug, Clone, PartialEq)]
pub struct Weights<F = f64> {
    /// Sorted by element.
    weights: Vec<(Element, F)>,
}

impl<F: Number> Weights<F> {
    /// The elements whose weight may differ from 1, in the order of elements.
    #[must_use]
    pub fn listed(&self) -> &[(Element, F)] {
        &self.weights
    }

    /// The weight of an element.
    #[must_use]
    pub fn of(&self, element: Element) -> F {
        let found = self.weights.binary_search_by_key(&element, |&(listed, _)| listed);
        found.map_or(F::one(), |index| self.weights[index].1)
    }
}

impl<F: Number> MassFunction<F> {
    /// The conjunctive weights w.
    ///
    /// ```
    /// # use wisdom_belief::{Frame, MassFunction};
    /// let frame = Frame::shafer(["A", "B", "C"])?;
    /// let m = MassFunction::parse(&frame, [("A | B", 0.5), ("Theta", 0.5)])?;
    /// assert_eq!(m.conjunctive_weights(&frame)?.of(frame.parse("A | B")?), 0.5);
    /// # Ok::<(), wisdom_belief::BeliefError>(())
    /// ```
    ///
    /// # Errors
    /// [`BeliefError::Dogmatic`] (of index 0) if m(Θ) = 0, [`BeliefError::TooManyElements`],
    /// [`BeliefError::Weight`] if m(Θ) is so small that a weight cannot be computed,
    /// [`BeliefError::ForeignElement`].
    pub fn conjunctive_weights(&self, frame: &Frame) -> Result<Weights<F>, BeliefError> {
        self.conjunctive_weights_of_source(0, frame)
    }

    /// The disjunctive weights v.
    ///
    /// # Errors
    /// [`BeliefError::Normal`] (of index 0) if m(∅) = 0, [`BeliefError::TooManyElements`],
    /// [`BeliefError::Weight`] if m(∅) is so small that a weight cannot be computed,
    /// [`BeliefError::ForeignElement`].
    pub fn disjunctive_weights(&self, frame: &Frame) -> Result<Weights<F>, BeliefError> {
        self.disjunctive_weights_of_source(0, frame)
    }

    /// The product of w over all supersets of A is m(Θ) / q(A), so large elements come first.
    pub(crate) fn conjunctive_weights_of_source(
        &self,
        index: usize,
        frame: &Frame,
    ) -> Result<Weights<F>, BeliefError> {
        self.elements().try_for_each(|element| frame.check(element))?;
        let ignorance = self.mass(frame.theta());
        if ignorance == F::zero() {
            return Err(BeliefError::Dogmatic { index });
        }
        let above = |a: Element, b: Element| a.is_subset_of(b);
        let product = |a| ignorance / self.commonality(a);
        let elements = meet_closure(self.elements())?;
        weights(&elements[1..], product, above, frame) // the first is Θ, which has no weight
    }

    /// The product of v over all subsets of A is m(∅) / b(A), so small elements come first.
    pub(crate) fn disjunctive_weights_of_source(
        &self,
        index: usize,
        frame: &Frame,
    ) -> Result<Weights<F>, BeliefError> {
        self.elements().try_for_each(|element| frame.check(element))?;
        let contradiction = self.conflict();
        if contradiction == F::zero() {
            return Err(BeliefError::Normal { index });
        }
        let below = |a: Element, b: Element| b.is_subset_of(a);
        let product = |a| contradiction / self.implicability(a);
        let elements = join_closure(self.elements())?;
        weights(&elements[1..], product, below, frame) // the first is ∅, which has no weight
    }
}

/// Weights whose product over an element and those before it that count is known.
fn weights<F: Number>(
    elements: &[Element],
    product: impl Fn(Element) -> F,
    counts: impl Fn(Element, Element) -> bool,
    frame: &Frame,
) -> Result<Weights<F>, BeliefError> {
    let mut weights: Vec<(Element, F)> = Vec::with_capacity(elements.len());
    for &a in elements {
        let before = weights.iter().filter(|&&(b, _)| counts(a, b));
        let weight = product(a) / before.fold(F::one(), |all, &(_, weight)| all * weight);
        let value = weight.to_f64();
        if value <= 0.0 || !value.is_finite() {
            return Err(BeliefError::Weight { element: frame.print(a), weight: value });
        }
        weights.push((a, weight));
    }
    weights.sort_unstable_by_key(|&(element, _)| element);
    Ok(Weights { weights })
}
