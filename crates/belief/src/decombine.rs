//! Decombination: taking back a source that was combined (Smets 1995).

use crate::closure::{meet_closure, mobius};
use crate::condition::gathered;
use crate::{BeliefError, Element, Frame, MassFunction, Number};

impl<F: Number> MassFunction<F> {
    /// What this mass function was before `part` was combined into it by the conjunctive rule (unnormalised):
    /// commonalities are divided. For what Dempster's rule made, see
    /// [`MassFunction::decombined_normalised`].
    ///
    /// ```
    /// # use wisdom_belief::{Frame, MassFunction};
    /// let frame = Frame::shafer(["A", "B"])?;
    /// let part = MassFunction::parse(&frame, [("A", 0.5), ("Theta", 0.5)])?;
    /// let fused = MassFunction::parse(&frame, [("empty", 0.25), ("A", 0.25), ("B", 0.25), ("Theta", 0.25)])?;
    /// let rest = MassFunction::parse(&frame, [("B", 0.5), ("Theta", 0.5)])?;
    /// assert_eq!(fused.decombined(&part, &frame)?, rest);
    /// # Ok::<(), wisdom_belief::BeliefError>(())
    /// ```
    ///
    /// # Errors
    /// [`BeliefError::Dogmatic`] (of index 1) if `part` gives nothing to Θ: it then left no trace of some of
    /// what it met. [`BeliefError::NotDecombinable`] if no mass function, combined with `part`, gives this one.
    /// [`BeliefError::TooManyElements`], [`BeliefError::ForeignElement`].
    pub fn decombined(&self, part: &Self, frame: &Frame) -> Result<Self, BeliefError> {
        let masses = self.divided(part, frame)?;
        masses.iter().try_for_each(|&(element, mass)| check(element, mass, frame))?;
        Ok(gathered(masses.into_iter()))
    }

    /// What this mass function was before `part` was combined into it by Dempster's rule, as a mass function
    /// without mass on ∅. ([`MassFunction::decombined`] would find a negative mass there, for the conflict that
    /// was dropped.)
    ///
    /// # Errors
    /// As [`MassFunction::decombined`].
    pub fn decombined_normalised(&self, part: &Self, frame: &Frame) -> Result<Self, BeliefError> {
        let mut masses = self.divided(part, frame)?;
        masses.retain(|(element, _)| !element.is_empty());
        let whole = masses.iter().fold(F::zero(), |whole, &(_, mass)| whole + mass);
        if whole <= F::zero() {
            return Err(BeliefError::NothingPossible);
        }
        let scaled = masses.into_iter().map(|(element, mass)| (element, mass / whole));
        let masses: Vec<(Element, F)> = scaled.collect();
        masses.iter().try_for_each(|&(element, mass)| check(element, mass, frame))?;
        Ok(gathered(masses.into_iter()))
    }

    /// The quotient of the commonalities as masses, some of which may be negative.
    fn divided(&self, part: &Self, frame: &Frame) -> Result<Vec<(Element, F)>, BeliefError> {
        self.elements().chain(part.elements()).try_for_each(|element| frame.check(element))?;
        if part.mass(frame.theta()) == F::zero() {
            return Err(BeliefError::Dogmatic { index: 1 });
        }
        // Both commonalities, and so their quotient, change on the intersections of all focal elements only.
        let closure = meet_closure(self.elements().chain(part.elements()))?;
        let quotient = |a| (a, self.commonality(a) / part.commonality(a));
        let quotients: Vec<(Element, F)> = closure.into_iter().map(quotient).collect();
        // What differs from 0 by no more than the rounding of so many differences is 0.
        let noise = DIGITS_LOST * F::SUM_TOLERANCE * quotients.len() as f64
            / part.mass(frame.theta()).to_f64();
        let mut masses = mobius(&quotients, Element::is_subset_of);
        masses.retain(|&(_, mass)| mass.to_f64().abs() > noise);
        Ok(masses)
    }
}

/// The rounding of one commonality beside what a sum of masses read from outside may err: some 1e-14 in double
/// precision, nothing where numbers are exact.
const DIGITS_LOST: f64 = 1e-5;

/// A mass below 0 by no more than sums of masses may err is a rounded 0, which is dropped.
fn check<F: Number>(element: Element, mass: F, frame: &Frame) -> Result<(), BeliefError> {
    let mass = mass.to_f64();
    if mass >= -F::SUM_TOLERANCE {
        return Ok(());
    }
    Err(BeliefError::NotDecombinable { element: frame.print(element), mass })
}
