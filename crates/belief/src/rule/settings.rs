//! What some rules ask beside their sources.

use crate::{BeliefError, Frame};

/// What some rules ask beside their sources; the default suits every rule.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Settings<'a> {
    /// Inagaki's k: 0 is Yager's rule, 1 / (1 − K) Dempster's; up to 1 / (1 − K − m(Θ)), which is never below
    /// the default of 1.
    pub inagaki_k: f64,
    /// The weight of each source in [`Rule::Average`](crate::Rule::Average), not negative, in the order of the
    /// sources; they need not sum to 1. Without, all count the same.
    pub weights: Option<&'a [f64]>,
    /// The frame on which the sources were given, if it is another model of the same atoms: what the target
    /// frame empties is then each rule's to deal with.
    pub source_frame: Option<&'a Frame>,
}

impl Default for Settings<'_> {
    fn default() -> Self {
        Self { inagaki_k: 1.0, weights: None, source_frame: None }
    }
}

impl<'a> Settings<'a> {
    /// With another k.
    #[must_use]
    pub fn with_inagaki_k(self, inagaki_k: f64) -> Self {
        Self { inagaki_k, ..self }
    }

    /// With a weight for each source.
    #[must_use]
    pub fn with_weights(self, weights: &'a [f64]) -> Self {
        Self { weights: Some(weights), ..self }
    }

    /// With sources given on another frame of the same atoms.
    #[must_use]
    pub fn with_source_frame(self, source_frame: &'a Frame) -> Self {
        Self { source_frame: Some(source_frame), ..self }
    }

    /// Refuses a k that suits no masses at all.
    pub(crate) fn check_inagaki_k(&self) -> Result<(), BeliefError> {
        let (name, value) = ("inagaki_k", self.inagaki_k);
        if value.is_finite() && value >= 0.0 {
            return Ok(());
        }
        let expected = "a finite number of at least 0".to_owned();
        Err(BeliefError::Parameter { name, value, expected })
    }

    /// Refuses weights that make no mean of so many sources.
    pub(crate) fn check_weights(&self, sources: usize) -> Result<(), BeliefError> {
        let Some(weights) = self.weights else { return Ok(()) };
        let refuse = |value, expected: String| {
            Err(BeliefError::Parameter { name: "weights", value, expected })
        };
        if weights.len() != sources {
            return refuse(weights.len() as f64, format!("as many as sources, {sources}"));
        }
        if let Some(&wrong) = weights.iter().find(|&&w| !(w.is_finite() && w >= 0.0)) {
            return refuse(wrong, "finite numbers of at least 0".to_owned());
        }
        if sources > 0 && weights.iter().all(|&weight| weight == 0.0) {
            return refuse(0.0, "one above 0 at least".to_owned());
        }
        Ok(())
    }
}
