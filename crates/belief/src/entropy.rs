//! How much a mass function leaves open, in bits.
//!
//! Two kinds of doubt: focal elements may be large (nonspecificity) and may contradict each other (the others).
//! |A| is the `DSm` cardinality, the number of Venn regions, so that Shafer's model gives the published
//! measures. All of them are for a closed world: mass on ∅, whose terms would be log 0, is refused; condition
//! on Θ first ([`MassFunction::conditioned`]) to spread it.

use crate::measure::share;
use crate::{BeliefError, Element, Frame, MassFunction, Number};

impl<F: Number> MassFunction<F> {
    /// Nonspecificity, the generalised Hartley measure: Σ m(A) log₂|A| (Dubois and Prade 1985). From 0, when
    /// only single regions are focal, to log₂|Θ|.
    ///
    /// # Errors
    /// [`BeliefError::EmptyHasMass`] if there is mass on ∅.
    pub fn nonspecificity(&self) -> Result<f64, BeliefError> {
        self.expected("nonspecificity", |a, _| log2(f64::from(a.cardinality())))
    }

    /// Deng entropy: −Σ m(A) log₂(m(A) / (2^|A| − 1)) (Deng 2016). Shannon's entropy when only single regions
    /// are focal, at least 0.
    ///
    /// ```
    /// # use wisdom_belief::{Frame, MassFunction};
    /// let frame = Frame::shafer(["A", "B"])?;
    /// let entropy = MassFunction::<f64>::vacuous(&frame).deng_entropy()?;
    /// assert!((entropy - 3_f64.log2()).abs() < 1e-12);
    /// # Ok::<(), wisdom_belief::BeliefError>(())
    /// ```
    ///
    /// # Errors
    /// [`BeliefError::EmptyHasMass`] if there is mass on ∅.
    pub fn deng_entropy(&self) -> Result<f64, BeliefError> {
        let parts = |a: Element| ((1_u128 << a.cardinality()) - 1) as f64;
        self.expected("Deng entropy", |a, mass| log2(parts(a)) - log2(mass))
    }

    /// Nguyen's entropy: −Σ m(A) log₂ m(A) (Nguyen 1987). At least 0.
    ///
    /// # Errors
    /// [`BeliefError::EmptyHasMass`] if there is mass on ∅.
    pub fn nguyen_entropy(&self) -> Result<f64, BeliefError> {
        self.expected("Nguyen's entropy", |_, mass| -log2(mass))
    }

    /// Confusion: −Σ m(A) log₂ Bel(A) (Höhle 1982). At least 0.
    ///
    /// # Errors
    /// [`BeliefError::EmptyHasMass`] if there is mass on ∅.
    pub fn confusion(&self) -> Result<f64, BeliefError> {
        self.expected("confusion", |a, _| -log2(self.belief(a).to_f64()))
    }

    /// Dissonance: −Σ m(A) log₂ Pl(A) (Yager 1983). 0 when all focal elements meet pairwise.
    ///
    /// # Errors
    /// [`BeliefError::EmptyHasMass`] if there is mass on ∅.
    pub fn dissonance(&self) -> Result<f64, BeliefError> {
        self.expected("dissonance", |a, _| -log2(self.plausibility(a).to_f64()))
    }

    /// Discord: −Σ m(A) log₂ Σ m(B) |A ∩ B| / |B| (Klir and Ramer 1990). At least 0.
    ///
    /// # Errors
    /// [`BeliefError::EmptyHasMass`] if there is mass on ∅.
    pub fn discord(&self) -> Result<f64, BeliefError> {
        self.expected("discord", |a, _| -log2(self.agreement(a, |_, b| b)))
    }

    /// Strife: −Σ m(A) log₂ Σ m(B) |A ∩ B| / |A| (Klir and Parviz 1992). At least 0.
    ///
    /// # Errors
    /// [`BeliefError::EmptyHasMass`] if there is mass on ∅.
    pub fn strife(&self) -> Result<f64, BeliefError> {
        self.expected("strife", |a, _| -log2(self.agreement(a, |a, _| a)))
    }

    /// Ambiguity: Shannon's entropy of `BetP` (Jousselme, Liu, Grenier and Bossé 2006). From 0 to log₂|Θ|.
    ///
    /// # Errors
    /// [`BeliefError::EmptyHasMass`] if there is mass on ∅; [`BeliefError::ForeignElement`].
    pub fn ambiguity(&self, frame: &Frame) -> Result<f64, BeliefError> {
        self.check_closed("ambiguity")?;
        Ok(self.pignistic_distribution(frame)?.entropy())
    }

    /// Jiroušek and Shenoy's entropy (2018): Shannon's entropy of the plausibility transform, and
    /// nonspecificity. From 0 to 2 log₂|Θ|, which only total ignorance has.
    ///
    /// # Errors
    /// [`BeliefError::EmptyHasMass`] if there is mass on ∅; [`BeliefError::ForeignElement`].
    pub fn jirousek_shenoy_entropy(&self, frame: &Frame) -> Result<f64, BeliefError> {
        self.check_closed("Jiroušek and Shenoy's entropy")?;
        Ok(self.plausibility_distribution(frame)?.entropy() + self.nonspecificity()?)
    }

    /// Σ m(A) f(A, m(A)).
    fn expected(
        &self,
        measure: &'static str,
        f: impl Fn(Element, f64) -> f64,
    ) -> Result<f64, BeliefError> {
        self.check_closed(measure)?;
        let masses = self.focal().iter().map(|&(a, mass)| (a, mass.to_f64()));
        Ok(masses.fold(0.0, |sum, (a, mass)| sum + mass * f(a, mass)))
    }

    /// Σ m(B) |A ∩ B| over |A| or |B|, whichever is asked for.
    fn agreement(&self, a: Element, of: impl Fn(f64, f64) -> f64) -> f64 {
        let part = |&(b, mass): &(Element, F)| {
            let [a_size, b_size, both] = [a, b, a & b].map(|x| f64::from(x.cardinality()));
            mass.to_f64() * share(both, of(a_size, b_size))
        };
        self.focal().iter().fold(0.0, |sum, focal| sum + part(focal))
    }

    fn check_closed(&self, measure: &'static str) -> Result<(), BeliefError> {
        if self.conflict() == F::zero() {
            return Ok(());
        }
        Err(BeliefError::EmptyHasMass { measure, mass: self.conflict().to_f64() })
    }
}

/// −Σ p log₂ p, where 0 log 0 is 0.
pub(crate) fn shannon(probabilities: impl Iterator<Item = f64>) -> f64 {
    probabilities.filter(|&p| p > 0.0).fold(0.0, |sum, p| sum - p * log2(p))
}

/// From a library of our own choice, so that the bits do not hang on the platform.
pub(crate) fn log2(x: f64) -> f64 {
    libm::log2(x)
}
