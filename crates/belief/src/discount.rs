//! Discounting: an uncertain instrument moves mass to ignorance (paper Eq. 4; Shafer 1976).

use std::collections::BTreeMap;

use crate::{BeliefError, Element, Frame, InterestMass, MassFunction};

/// The share u of an opinion that the sensor loses: 0 is certain, 1 knows nothing. (Reliability is 1 − u.)
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
    /// Moves the share `u` of every committed mass to ignorance (paper Eq. 4).
    ///
    /// ```
    /// # use wisdom_belief::{InterestMass, Opinion, Uncertainty};
    /// // Paper Table 6: texture 4, seen with u = 0.66.
    /// let texture = Opinion { interesting: 0.95, not_interesting: 0.0, paradox: 0.05 };
    /// let seen = InterestMass::try_from(texture)?.discounted(Uncertainty::new(0.66)?);
    /// assert!((seen.interesting() - 0.323).abs() < 1e-12);
    /// # Ok::<(), wisdom_belief::BeliefError>(())
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
    /// Moves the share `u` of every mass to Θ (Shafer 1976); the paper's Eq. 4 on any frame.
    #[must_use]
    pub fn discounted(&self, Uncertainty(u): Uncertainty, frame: &Frame) -> Self {
        let mut masses: BTreeMap<Element, f64> =
            self.focal().iter().map(|&(element, mass)| (element, mass * (1.0 - u))).collect();
        *masses.entry(frame.theta()).or_default() += u;
        Self::from_map(masses)
    }
}
