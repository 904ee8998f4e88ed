//! Discounting: the less sure a sensor, the more of what it says becomes ignorance (paper Eq. 4; Shafer 1976).

use std::collections::BTreeMap;

use crate::closure::check_closure;
use crate::condition::gathered;
use crate::{BeliefError, Element, Frame, InterestMass, MassFunction, Number};

/// How much of an opinion is lost because its sensor cannot be sure: none at 0, all at 1. (Reliability is 1 − u.)
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct Uncertainty(f64);

impl Uncertainty {
    /// Nothing is lost.
    pub const CERTAIN: Self = Self(0.0);

    /// All is lost.
    pub const UNKNOWN: Self = Self(1.0);

    /// An uncertainty in [0, 1].
    ///
    /// # Errors
    /// [`BeliefError::Uncertainty`] if it is outside or not a number.
    pub fn new(value: f64) -> Result<Self, BeliefError> {
        if (0.0..=1.0).contains(&value) {
            Ok(Self(value))
        } else {
            Err(BeliefError::Uncertainty { value })
        }
    }

    /// The share itself.
    #[must_use]
    pub const fn get(self) -> f64 {
        self.0
    }
}

impl<F: Number> InterestMass<F> {
    /// The same opinion from a sensor of uncertainty `u`: each mass shrinks by that share, and ignorance gains
    /// what they lose (paper Eq. 4).
    ///
    /// ```
    /// # use wisdom_belief::{BeliefError, InterestMass, Opinion, Uncertainty};
    /// // The infrared expert of Table 6, whose camera is unsure by 0.19.
    /// let dull = Opinion { paradox: 0.2, not_interesting: 0.8, interesting: 0.0 };
    /// let mass = InterestMass::try_from(dull)?.discounted(Uncertainty::new(0.19)?);
    /// assert!((mass.not_interesting() - 0.648).abs() < 1e-12);
    /// assert!((mass.ignorance() - 0.19).abs() < 1e-12); // nothing was unknown before
    /// # Ok::<(), BeliefError>(())
    /// ```
    #[must_use]
    pub fn discounted(self, Uncertainty(u): Uncertainty) -> Self {
        let u = F::from_f64(u);
        let kept = F::one() - u;
        Self {
            interesting: self.interesting * kept,
            not_interesting: self.not_interesting * kept,
            paradox: self.paradox * kept,
            ignorance: self.ignorance * kept + u,
        }
    }
}

impl<F: Number> MassFunction<F> {
    /// Discounts on any frame: each mass gives the share `u` of itself to Θ (Shafer 1976; the paper's Eq. 4).
    #[must_use]
    pub fn discounted(&self, Uncertainty(u): Uncertainty, frame: &Frame) -> Self {
        let u = F::from_f64(u);
        let mut masses: BTreeMap<Element, F> =
            self.focal().iter().map(|&(element, mass)| (element, mass * (F::one() - u))).collect();
        *masses.entry(frame.theta()).or_insert_with(F::zero) += u;
        Self::from_map(masses)
    }

    /// Takes a discount back: the mass function whose [`MassFunction::discounted`] by `u` this is.
    ///
    /// # Errors
    /// [`BeliefError::NotDiscounted`] if Θ has less than `u`, or `u` is 1, which leaves nothing to restore.
    pub fn undiscounted(&self, u: Uncertainty, frame: &Frame) -> Result<Self, BeliefError> {
        let (theta, lost) = (frame.theta(), F::from_f64(u.0));
        let ignorance = self.mass(theta);
        if ignorance < lost || lost >= F::one() {
            let ignorance = ignorance.to_f64();
            return Err(BeliefError::NotDiscounted { ignorance, uncertainty: u.0 });
        }
        let mut masses: BTreeMap<Element, F> = self.focal().iter().copied().collect();
        masses.insert(theta, ignorance - lost);
        let restored =
            masses.into_iter().map(|(element, mass)| (element, mass / (F::one() - lost)));
        Ok(gathered(restored))
    }

    /// Contextual discounting: a source that is reliable only so far where a context holds cannot exclude that
    /// context so firmly. For each context C of reliability β, the share 1 − β of every mass moves from its
    /// element to the union with C (Mercier, Quost and Denœux 2008, for contexts that partition Θ; any set of
    /// contexts will do, after Pichon, Mercier, Lefèvre and Delmotte 2016). Contexts of reliability 1 may be
    /// left out.
    ///
    /// ```
    /// # use wisdom_belief::{Frame, MassFunction};
    /// // A sensor that takes helicopters for rockets, and only so: reliable by 0.75 when a helicopter comes.
    /// let frame = Frame::shafer(["aeroplane", "helicopter", "rocket"])?;
    /// let m = MassFunction::parse(&frame, [("rocket", 1.0)])?;
    /// let unsure = m.contextually_discounted(&[(frame.parse("helicopter")?, 0.75)], &frame)?;
    /// assert_eq!(unsure.mass(frame.parse("helicopter | rocket")?), 0.25);
    /// # Ok::<(), wisdom_belief::BeliefError>(())
    /// ```
    ///
    /// # Errors
    /// [`BeliefError::Parameter`] for a reliability outside [0, 1], [`BeliefError::RepeatedElement`] for a
    /// context given twice, [`BeliefError::ForeignElement`].
    pub fn contextually_discounted(
        &self,
        contexts: &[(Element, F)],
        frame: &Frame,
    ) -> Result<Self, BeliefError> {
        self.corrected(contexts, frame, |a, context| a | context)
    }

    /// Contextual reinforcement, the conjunctive dual: for each context C and β, the share 1 − β of every mass
    /// moves from its element to the intersection with C, which may be ∅ (Mercier, Denœux and Masson 2010).
    ///
    /// # Errors
    /// As [`MassFunction::contextually_discounted`].
    pub fn contextually_reinforced(
        &self,
        contexts: &[(Element, F)],
        frame: &Frame,
    ) -> Result<Self, BeliefError> {
        self.corrected(contexts, frame, |a, context| a & context)
    }

    fn corrected(
        &self,
        contexts: &[(Element, F)],
        frame: &Frame,
        moved: impl Fn(Element, Element) -> Element,
    ) -> Result<Self, BeliefError> {
        self.elements().try_for_each(|element| frame.check(element))?;
        check_contexts(contexts, frame)?;
        contexts.iter().try_fold(self.clone(), |m, &(context, kept)| {
            let halves = m.focal().iter().flat_map(|&(a, mass)| {
                [(a, mass * kept), (moved(a, context), mass * (F::one() - kept))]
            });
            let corrected = gathered(halves);
            check_closure(corrected.focal().len())?;
            Ok(corrected)
        })
    }
}

fn check_contexts<F: Number>(contexts: &[(Element, F)], frame: &Frame) -> Result<(), BeliefError> {
    for (index, &(context, reliability)) in contexts.iter().enumerate() {
        frame.check(context)?;
        if !(F::zero()..=F::one()).contains(&reliability) {
            let (value, expected) = (reliability.to_f64(), "in [0, 1]");
            return Err(BeliefError::Parameter {
                name: "reliability",
                value,
                expected: expected.to_owned(),
            });
        }
        if contexts[..index].iter().any(|&(other, _)| other == context) {
            return Err(BeliefError::RepeatedElement { element: frame.print(context) });
        }
    }
    Ok(())
}
