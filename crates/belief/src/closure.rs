//! Commonalities and implicabilities where they change: on the intersections, or the unions, of focal elements.
//!
//! q is the same for an element and the least intersection of focal elements that holds it, b for an element
//! and the largest union of focal elements within it; so a few values are all there is, on frames of any
//! size (focal points, after Chaveroche, Davoine and Cherfaoui 2021).

use crate::{BeliefError, Element, Frame, MassFunction, Number};

/// The most elements of a closure: steps between all pairs of them, some 10⁸, are still done in a second.
pub const MAX_CLOSURE: usize = 1 << 14;

/// The commonality q of every element of a frame, by its values on the intersections of focal elements.
#[derive(Debug, Clone, PartialEq)]
pub struct Commonalities<F = f64> {
    /// Large elements first.
    values: Vec<(Element, F)>,
}

/// The implicability b of every element of a frame, by its values on the unions of focal elements.
#[derive(Debug, Clone, PartialEq)]
pub struct Implicabilities<F = f64> {
    /// Small elements first.
    values: Vec<(Element, F)>,
}

impl<F: Number> MassFunction<F> {
    /// q of all elements at once.
    ///
    /// ```
    /// # use wisdom_belief::{Frame, MassFunction};
    /// let frame = Frame::shafer(["A", "B", "C"])?;
    /// let m = MassFunction::parse(&frame, [("A | B", 0.5), ("B | C", 0.25), ("Theta", 0.25)])?;
    /// let q = m.commonalities()?;
    /// assert_eq!(q.of(frame.parse("B")?), 1.0);
    /// assert_eq!(q.of(frame.parse("A")?), 0.75);
    /// assert_eq!(q.to_masses(&frame)?, m);
    /// # Ok::<(), wisdom_belief::BeliefError>(())
    /// ```
    ///
    /// # Errors
    /// [`BeliefError::TooManyElements`] if the focal elements have more than [`MAX_CLOSURE`] intersections.
    pub fn commonalities(&self) -> Result<Commonalities<F>, BeliefError> {
        let closure = meet_closure(self.elements())?;
        let value = |a| (a, self.commonality(a));
        Ok(Commonalities { values: closure.into_iter().map(value).collect() })
    }

    /// b of all elements at once.
    ///
    /// # Errors
    /// [`BeliefError::TooManyElements`] if the focal elements have more than [`MAX_CLOSURE`] unions.
    pub fn implicabilities(&self) -> Result<Implicabilities<F>, BeliefError> {
        let closure = join_closure(self.elements())?;
        let value = |a| (a, self.implicability(a));
        Ok(Implicabilities { values: closure.into_iter().map(value).collect() })
    }

    /// The focal elements without their masses.
    pub(crate) fn elements(&self) -> impl Iterator<Item = Element> {
        self.focal().iter().map(|&(element, _)| element)
    }
}

impl<F: Number> Commonalities<F> {
    /// The values where q changes, large elements first.
    #[must_use]
    pub fn values(&self) -> &[(Element, F)] {
        &self.values
    }

    /// q(A), in [0, 1].
    #[must_use]
    pub fn of(&self, a: Element) -> F {
        // The least of those that hold A is the last: the closure has the intersection of any two.
        let least = self.values.iter().rev().find(|(b, _)| a.is_subset_of(*b));
        least.map_or(F::zero(), |&(_, q)| q)
    }

    /// The masses whose commonalities these are.
    ///
    /// # Errors
    /// As [`MassFunction::new`]. A mass below 0 by no more than [`Number::SUM_TOLERANCE`] is a rounded 0.
    pub fn to_masses(&self, frame: &Frame) -> Result<MassFunction<F>, BeliefError> {
        from_differences(frame, mobius(&self.values, Element::is_subset_of))
    }
}

impl<F: Number> Implicabilities<F> {
    /// The values where b changes, small elements first.
    #[must_use]
    pub fn values(&self) -> &[(Element, F)] {
        &self.values
    }

    /// b(A), in [0, 1].
    #[must_use]
    pub fn of(&self, a: Element) -> F {
        let largest = self.values.iter().rev().find(|(b, _)| b.is_subset_of(a));
        largest.map_or(F::zero(), |&(_, b)| b)
    }

    /// The masses whose implicabilities these are.
    ///
    /// # Errors
    /// As [`MassFunction::new`]. A mass below 0 by no more than [`Number::SUM_TOLERANCE`] is a rounded 0.
    pub fn to_masses(&self, frame: &Frame) -> Result<MassFunction<F>, BeliefError> {
        from_differences(frame, mobius(&self.values, |a, b| b.is_subset_of(a)))
    }
}

/// Each value less the masses of those before it that count in it.
pub(crate) fn mobius<F: Number>(
    values: &[(Element, F)],
    counts_in: impl Fn(Element, Element) -> bool,
) -> Vec<(Element, F)> {
    let mut masses: Vec<(Element, F)> = Vec::with_capacity(values.len());
    for &(a, value) in values {
        let before = masses.iter().filter(|&&(b, _)| counts_in(a, b));
        let mass = before.fold(value, |rest, &(_, mass)| rest - mass);
        masses.push((a, mass));
    }
    masses
}

/// A mass function of what subtraction left: a mass below 0 by no more than sums may err is a rounded 0.
pub(crate) fn from_differences<F: Number>(
    frame: &Frame,
    masses: impl IntoIterator<Item = (Element, F)>,
) -> Result<MassFunction<F>, BeliefError> {
    let none = |mass: F| mass <= F::zero() && mass.to_f64() >= -F::SUM_TOLERANCE;
    MassFunction::new(frame, masses.into_iter().filter(|&(_, mass)| !none(mass)))
}

/// All intersections of some elements, large ones first.
pub(crate) fn meet_closure(
    elements: impl IntoIterator<Item = Element>,
) -> Result<Vec<Element>, BeliefError> {
    let mut closure = closure(elements, |a, b| a & b)?;
    closure.reverse();
    Ok(closure)
}

/// All unions of some elements, small ones first.
pub(crate) fn join_closure(
    elements: impl IntoIterator<Item = Element>,
) -> Result<Vec<Element>, BeliefError> {
    closure(elements, |a, b| a | b)
}

/// All that an operation makes of some elements, in the order of elements: a part comes before the whole.
fn closure(
    elements: impl IntoIterator<Item = Element>,
    operation: impl Fn(Element, Element) -> Element,
) -> Result<Vec<Element>, BeliefError> {
    let mut closure = std::collections::BTreeSet::new();
    for element in elements {
        let with: Vec<Element> = closure.iter().map(|&other| operation(element, other)).collect();
        closure.insert(element);
        closure.extend(with);
        check_closure(closure.len())?;
    }
    Ok(closure.into_iter().collect())
}

/// Refuses more elements than algorithms on a closure are meant for.
pub(crate) fn check_closure(elements: usize) -> Result<(), BeliefError> {
    if elements > MAX_CLOSURE {
        return Err(BeliefError::TooManyElements { limit: MAX_CLOSURE });
    }
    Ok(())
}
