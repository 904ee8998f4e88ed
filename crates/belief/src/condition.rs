//! Conditioning: what a mass function says once an element is known to hold.

use std::collections::BTreeMap;

use crate::{BeliefError, Element, Frame, MassFunction, Number};

impl<F: Number> MassFunction<F> {
    /// Dempster's conditioning: each mass goes to what its element and B have in common, and what contradicts
    /// B is dropped and the rest scaled up (Dempster 1967). Mass on ∅ is dropped as well.
    ///
    /// ```
    /// # use wisdom_belief::{Frame, MassFunction};
    /// let frame = Frame::shafer(["A", "B", "C"])?;
    /// let m = MassFunction::parse(&frame, [("A", 0.5), ("A | B", 0.25), ("Theta", 0.25)])?;
    /// let known = m.conditioned(frame.parse("B | C")?, &frame)?;
    /// assert_eq!(known.mass(frame.parse("B")?), 0.5);
    /// # Ok::<(), wisdom_belief::BeliefError>(())
    /// ```
    ///
    /// # Errors
    /// [`BeliefError::Implausible`] if Pl(B) is 0; [`BeliefError::ForeignElement`] if B or a focal element is
    /// not of this frame.
    pub fn conditioned(&self, on: Element, frame: &Frame) -> Result<Self, BeliefError> {
        self.check_condition(on, frame)?;
        let plausibility = self.plausibility(on);
        if plausibility > F::zero() {
            let possible = self.focal().iter().map(|&(a, mass)| (a & on, mass / plausibility));
            return Ok(gathered(possible.filter(|(a, _)| !a.is_empty())));
        }
        Err(BeliefError::Implausible { element: frame.print(on) })
    }

    /// Unnormalised conditioning: each mass goes to what its element and B have in common, if that is ∅ too
    /// (Smets 1990).
    ///
    /// # Errors
    /// [`BeliefError::ForeignElement`] if B or a focal element is not of this frame.
    pub fn conditioned_unnormalised(
        &self,
        on: Element,
        frame: &Frame,
    ) -> Result<Self, BeliefError> {
        self.check_condition(on, frame)?;
        Ok(gathered(self.focal().iter().map(|&(a, mass)| (a & on, mass))))
    }

    fn check_condition(&self, on: Element, frame: &Frame) -> Result<(), BeliefError> {
        frame.check(on)?;
        self.focal().iter().try_for_each(|&(element, _)| frame.check(element))
    }
}

/// The masses, those of the same element added up.
pub(crate) fn gathered<F: Number>(masses: impl Iterator<Item = (Element, F)>) -> MassFunction<F> {
    let mut sums = BTreeMap::new();
    for (element, mass) in masses {
        *sums.entry(element).or_insert_with(F::zero) += mass;
    }
    MassFunction::from_map(sums)
}
