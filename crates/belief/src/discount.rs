//! Discounting: the less sure a sensor, the more of what it says becomes ignorance (paper Eq. 4; Shafer 1976).

use std::collections::BTreeMap;

use crate::{BeliefError, Element, Frame, InterestMass, MassFunction};

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

impl InterestMass {
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
        let kept = 1.0 - u;
        Self {
            interesting: self.interesting * kept,
            not_interesting: self.not_interesting * kept,
            paradox: self.paradox * kept,
            ignorance: self.ignorance * kept + u,
        }
    }
}

impl MassFunction {
    /// Discounts on any frame: each mass gives the share `u` of itself to Θ (Shafer 1976; the paper's Eq. 4).
    #[must_use]
    pub fn discounted(&self, Uncertainty(u): Uncertainty, frame: &Frame) -> Self {
        let mut masses: BTreeMap<Element, f64> =
            self.focal().iter().map(|&(element, mass)| (element, mass * (1.0 - u))).collect();
        *masses.entry(frame.theta()).or_default() += u;
        Self::from_map(masses)
    }
}
