//! From a mass function to probabilities of single Venn regions.

use crate::entropy::{log2, shannon};
use crate::measure::share;
use crate::number::sum;
use crate::{BeliefError, Element, Frame, MassFunction, Number, Region};

/// A probability for each Venn region of a frame: each in [0, 1], together 1 but for rounding.
///
/// ```
/// # use wisdom_belief::{Frame, MassFunction};
/// let frame = Frame::free(["A", "B"])?;
/// let m = MassFunction::parse(&frame, [("A", 0.5), ("Theta", 0.5)])?;
/// let betp = m.pignistic_distribution(&frame)?;
/// let both: f64 = betp.of(frame.region(&["A", "B"])?);
/// assert!((both - (0.5 / 2.0 + 0.5 / 3.0)).abs() < 1e-12);
/// assert_eq!(betp.probability(frame.parse("A")?), m.pignistic(frame.parse("A")?));
/// # Ok::<(), wisdom_belief::BeliefError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Distribution<F = f64> {
    regions: Vec<(Region, F)>,
}

impl<F: Number> Distribution<F> {
    /// The regions, in rising order of their bits, each with its probability (0 among them).
    #[must_use]
    pub fn regions(&self) -> &[(Region, F)] {
        &self.regions
    }

    /// The probability of one region; 0 of a region that the frame does not have.
    #[must_use]
    pub fn of(&self, region: Region) -> F {
        let found = self.regions.binary_search_by_key(&region, |&(region, _)| region);
        found.map_or(F::zero(), |index| self.regions[index].1)
    }

    /// The probability of an element: that of its regions together.
    #[must_use]
    pub fn probability(&self, element: Element) -> F {
        let inside = self.regions.iter().filter(|(region, _)| region.is_within(element));
        sum(inside.map(|&(_, probability)| probability))
    }

    /// Shannon's entropy in bits (1948): from 0 to the logarithm of the number of regions.
    #[must_use]
    pub fn entropy(&self) -> f64 {
        shannon(self.regions.iter().map(|&(_, probability)| probability.to_f64()))
    }

    /// The probabilistic information content (Sudano 2002): 1 less the entropy as a share of the most it could
    /// be. 1 when a single region is certain, 0 when all are equally likely; 1 where there is only one region.
    #[must_use]
    pub fn information_content(&self) -> f64 {
        let most = log2(self.regions.len() as f64);
        if most > 0.0 { 1.0 - self.entropy() / most } else { 1.0 }
    }
}

impl<F: Number> MassFunction<F> {
    /// `BetP` of a single region (Smets 1994); 0 if all mass is on ∅.
    #[must_use]
    pub fn pignistic_region(&self, region: Region) -> F {
        self.pignistic(region.mask())
    }

    /// `DSmP_ε` of a single region (Dezert and Smarandache 2008); 0 if all mass is on ∅. ε ≥ 0.
    #[must_use]
    pub fn dsmp_region(&self, region: Region, epsilon: F) -> F {
        self.dsmp(region.mask(), epsilon)
    }

    /// The contour function: Pl of a single region (Shafer 1976), in [0, 1].
    #[must_use]
    pub fn contour(&self, region: Region) -> F {
        self.plausibility(region.mask())
    }

    /// The pignistic transform: `BetP` of every region (Smets 1994).
    ///
    /// # Errors
    /// [`BeliefError::NothingPossible`] if all mass is on ∅.
    pub fn pignistic_distribution(&self, frame: &Frame) -> Result<Distribution<F>, BeliefError> {
        self.distribution(frame, |region| self.pignistic_region(region))
    }

    /// The transform `DSmP_ε`, for every region (Dezert and Smarandache 2008).
    ///
    /// # Errors
    /// [`BeliefError::NothingPossible`] if all mass is on ∅; [`BeliefError::Parameter`] if ε is not a number of
    /// at least 0.
    pub fn dsmp_distribution(
        &self,
        epsilon: F,
        frame: &Frame,
    ) -> Result<Distribution<F>, BeliefError> {
        check_epsilon(epsilon)?;
        self.distribution(frame, |region| self.dsmp_region(region, epsilon))
    }

    /// The plausibility transform: the contour function, scaled to sum to 1 (Voorbraak 1989; Cobb and Shenoy
    /// 2006). Mass on ∅ does not matter to it.
    ///
    /// # Errors
    /// [`BeliefError::NothingPossible`] if all mass is on ∅.
    pub fn plausibility_distribution(&self, frame: &Frame) -> Result<Distribution<F>, BeliefError> {
        let whole = sum(frame.regions().map(|region| self.contour(region)));
        self.distribution(frame, |region| share(self.contour(region), whole))
    }

    /// Refuses mass that no region could share: all of it on ∅.
    pub(crate) fn check_possible(&self) -> Result<(), BeliefError> {
        if self.focal().iter().any(|(element, _)| !element.is_empty()) {
            return Ok(());
        }
        Err(BeliefError::NothingPossible)
    }

    fn distribution(
        &self,
        frame: &Frame,
        of: impl Fn(Region) -> F,
    ) -> Result<Distribution<F>, BeliefError> {
        self.focal().iter().try_for_each(|&(element, _)| frame.check(element))?;
        self.check_possible()?;
        Ok(Distribution { regions: frame.regions().map(|region| (region, of(region))).collect() })
    }
}

pub(crate) fn check_epsilon<F: Number>(epsilon: F) -> Result<(), BeliefError> {
    let value = epsilon.to_f64();
    if (0.0..=MAX_EPSILON).contains(&value) {
        return Ok(());
    }
    let expected = format!("from 0 to {MAX_EPSILON:e}");
    Err(BeliefError::Parameter { name: "epsilon", value, expected })
}

/// The largest ε: beyond, sums with it would overflow, and long before that all masses count for nothing.
const MAX_EPSILON: f64 = 1e30;
