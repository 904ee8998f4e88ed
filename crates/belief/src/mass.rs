//! Mass functions on any frame.

use std::collections::BTreeMap;

use crate::number::sum;
use crate::{BeliefError, Element, Frame, Number};

/// How far a sum of masses may be from 1: masses are written with a few decimals, whose rounding to binary
/// and adding up errs by some 1e-16 each, while the smallest slip of a pen is 1e-6.
pub const SUM_TOLERANCE: f64 = 1e-9;

/// A mass function m (the paper's gbba or bpa): its focal elements, sorted, each with its mass.
///
/// Masses lie in [0, 1] and sum to 1 within [`Number::SUM_TOLERANCE`]; nothing is ever renormalised to make
/// them. The empty element may carry mass (an open world; the conflict of the conjunctive rule); rules that
/// give it no meaning refuse it. One rule breaks the sum by its definition:
/// [`Rule::DuboisPrade`](crate::Rule::DuboisPrade) loses mass where a model empties all that sources said.
///
/// ```
/// # use wisdom_belief::{Frame, MassFunction};
/// let frame = Frame::free(["I", "NI"])?;
/// let m = MassFunction::parse(&frame, [("I", 0.8_f64), ("NI", 0.05), ("I & NI", 0.15)])?;
/// assert!((m.belief(frame.parse("I")?) - 0.95).abs() < 1e-12);
/// # Ok::<(), wisdom_belief::BeliefError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct MassFunction<F = f64> {
    pub(crate) focal: Vec<(Element, F)>,
}

/// Whether a mass lies in [0, 1]; above 1 by as much as a sum may, since a fused mass can round so.
pub(crate) fn in_range<F: Number>(mass: F) -> bool {
    mass >= F::zero() && mass.to_f64() <= 1.0 + F::SUM_TOLERANCE
}

impl<F: Number> MassFunction<F> {
    /// A mass function from elements of `frame` and their masses, in any order; zeros are dropped.
    ///
    /// # Errors
    /// [`BeliefError::ForeignElement`], [`BeliefError::RepeatedElement`], [`BeliefError::OutOfRange`] or
    /// [`BeliefError::SumNotOne`].
    pub fn new(
        frame: &Frame,
        masses: impl IntoIterator<Item = (Element, F)>,
    ) -> Result<Self, BeliefError> {
        let mut focal = BTreeMap::new();
        for (element, mass) in masses {
            frame.check(element)?;
            if !in_range(mass) {
                let element = frame.print(element);
                return Err(BeliefError::OutOfRange { element, mass: mass.to_f64() });
            }
            if focal.insert(element, mass).is_some() {
                return Err(BeliefError::RepeatedElement { element: frame.print(element) });
            }
        }
        let mass = Self::from_map(focal);
        let sum = mass.sum().to_f64();
        if (sum - 1.0).abs() > F::SUM_TOLERANCE {
            return Err(BeliefError::SumNotOne { sum });
        }
        Ok(mass)
    }

    /// A mass function from expressions and their masses.
    ///
    /// # Errors
    /// As [`MassFunction::new`] and [`Frame::parse`].
    pub fn parse<'a>(
        frame: &Frame,
        masses: impl IntoIterator<Item = (&'a str, F)>,
    ) -> Result<Self, BeliefError> {
        let read = |(text, mass)| Ok((frame.parse(text)?, mass));
        let masses: Vec<_> = masses.into_iter().map(read).collect::<Result<_, BeliefError>>()?;
        Self::new(frame, masses)
    }

    /// Total ignorance: all mass on Θ.
    #[must_use]
    pub fn vacuous(frame: &Frame) -> Self {
        Self { focal: vec![(frame.theta(), F::one())] }
    }

    /// The result of a rule, whose masses sum to 1 because its sources' do.
    pub(crate) fn from_map(masses: BTreeMap<Element, F>) -> Self {
        Self { focal: masses.into_iter().filter(|&(_, mass)| mass > F::zero()).collect() }
    }

    /// The same from a list in which each element comes up once.
    pub(crate) fn from_sums(mut sums: Vec<(Element, F)>) -> Self {
        sums.retain(|&(_, mass)| mass > F::zero());
        sums.sort_unstable_by_key(|&(element, _)| element);
        Self { focal: sums }
    }

    /// The focal elements in their order, the smallest first, with their masses (all above 0).
    #[must_use]
    pub fn focal(&self) -> &[(Element, F)] {
        &self.focal
    }

    /// m(element); 0 if it is not focal.
    #[must_use]
    pub fn mass(&self, element: Element) -> F {
        let found = self.focal.binary_search_by_key(&element, |&(focal, _)| focal);
        found.map_or(F::zero(), |index| self.focal[index].1)
    }

    /// The sum of all masses: 1 but for rounding, and less where a rule lost some.
    #[must_use]
    pub fn sum(&self) -> F {
        sum(self.focal.iter().map(|&(_, mass)| mass))
    }
}
