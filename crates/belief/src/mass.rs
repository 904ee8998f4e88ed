//! Mass functions on any frame.

use std::collections::BTreeMap;

use crate::{BeliefError, Element, Frame};

/// How far a sum of masses may be from 1: masses are written with a few decimals, whose rounding to binary
/// and adding up errs by some 1e-16 each, while the smallest slip of a pen is 1e-6.
pub const SUM_TOLERANCE: f64 = 1e-9;

/// A mass function m (the paper's gbba or bpa): its focal elements, sorted, each with its mass.
///
/// Masses lie in [0, 1] and sum to 1 within [`SUM_TOLERANCE`]; nothing is ever renormalised to make them. The empty element may carry
/// mass (an open world; the conflict of [`rule::conjunctive`](crate::rule::conjunctive)); rules that give it
/// no meaning refuse it.
///
/// ```
/// # use wisdom_belief::{Frame, MassFunction};
/// let frame = Frame::free(["I", "NI"])?;
/// let m = MassFunction::parse(&frame, [("I", 0.8), ("NI", 0.05), ("I & NI", 0.15)])?;
/// assert!((m.belief(frame.parse("I")?) - 0.95).abs() < 1e-12);
/// # Ok::<(), wisdom_belief::BeliefError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct MassFunction {
    focal: Vec<(Element, f64)>,
}

/// Whether a mass lies in [0, 1]; above 1 by as much as a sum may, since a fused mass can round so.
pub(crate) fn in_range(mass: f64) -> bool {
    (0.0..=1.0 + SUM_TOLERANCE).contains(&mass)
}

impl MassFunction {
    /// A mass function from elements of `frame` and their masses, in any order; zeros are dropped.
    ///
    /// # Errors
    /// [`BeliefError::ForeignElement`], [`BeliefError::RepeatedElement`], [`BeliefError::OutOfRange`] or
    /// [`BeliefError::SumNotOne`].
    pub fn new(
        frame: &Frame,
        masses: impl IntoIterator<Item = (Element, f64)>,
    ) -> Result<Self, BeliefError> {
        let mut focal = BTreeMap::new();
        for (element, mass) in masses {
            frame.check(element)?;
            if !in_range(mass) {
                return Err(BeliefError::OutOfRange { element: frame.print(element), mass });
            }
            if focal.insert(element, mass).is_some() {
                return Err(BeliefError::RepeatedElement { element: frame.print(element) });
            }
        }
        let sum: f64 = focal.values().sum();
        if (sum - 1.0).abs() > SUM_TOLERANCE {
            return Err(BeliefError::SumNotOne { sum });
        }
        Ok(Self::from_map(focal))
    }

    /// A mass function from expressions and their masses.
    ///
    /// # Errors
    /// As [`MassFunction::new`] and [`Frame::parse`].
    pub fn parse<'a>(
        frame: &Frame,
        masses: impl IntoIterator<Item = (&'a str, f64)>,
    ) -> Result<Self, BeliefError> {
        let read = |(text, mass)| Ok((frame.parse(text)?, mass));
        let masses: Vec<_> = masses.into_iter().map(read).collect::<Result<_, BeliefError>>()?;
        Self::new(frame, masses)
    }

    /// Total ignorance: all mass on Θ.
    #[must_use]
    pub fn vacuous(frame: &Frame) -> Self {
        Self { focal: vec![(frame.theta(), 1.0)] }
    }

    /// The result of a rule, whose masses sum to 1 because its sources' do.
    pub(crate) fn from_map(masses: BTreeMap<Element, f64>) -> Self {
        Self { focal: masses.into_iter().filter(|&(_, mass)| mass > 0.0).collect() }
    }

    /// The focal elements, in rising order of their bit masks, with their masses (all above 0).
    #[must_use]
    pub fn focal(&self) -> &[(Element, f64)] {
        &self.focal
    }

    /// m(element); 0 if it is not focal.
    #[must_use]
    pub fn mass(&self, element: Element) -> f64 {
        let found = self.focal.binary_search_by_key(&element, |&(focal, _)| focal);
        found.map_or(0.0, |index| self.focal[index].1)
    }
}
