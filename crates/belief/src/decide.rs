//! Which of some alternatives to take, by what a mass function says of them.

use crate::transform::check_epsilon;
use crate::{BeliefError, Element, Frame, MassFunction, Number};

/// What makes an alternative good.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Criterion<F = f64> {
    /// Bel: the cautious choice.
    Belief,
    /// Pl: the bold choice.
    Plausibility,
    /// `BetP`: the most probable one when ignorance is shared evenly (Smets 1994).
    Pignistic,
    /// `DSmP_ε` (Dezert and Smarandache 2008).
    Dsmp {
        /// ε ≥ 0.
        epsilon: F,
    },
    /// α Bel + (1 − α) Pl, between the two (Hurwicz 1951; Jaffray 1989 for belief functions).
    Hurwicz {
        /// The weight α of the worst case, in [0, 1].
        pessimism: F,
    },
}

/// An alternative that was chosen.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice<F = f64> {
    /// Its place in the list of alternatives.
    pub index: usize,
    /// What the criterion says of it.
    pub value: F,
    /// Those that came later in the list and are as good, as far as rounding can tell.
    pub ties: Vec<usize>,
}

impl Frame {
    /// The atoms as alternatives, but for those the model empties.
    #[must_use]
    pub fn alternatives(&self) -> Vec<Element> {
        let atoms = (0..self.atoms().len()).filter_map(|atom| self.atom(atom));
        atoms.filter(|atom| !atom.is_empty()).collect()
    }
}

impl<F: Number> MassFunction<F> {
    /// The best of some alternatives; the first in the list of those that are equally good, which are reported.
    /// Values closer than [`Number::SUM_TOLERANCE`] are equal: masses are no more exact than that.
    ///
    /// ```
    /// # use wisdom_belief::{Criterion, Frame, MassFunction};
    /// let frame = Frame::shafer(["A", "B", "C"])?;
    /// let m = MassFunction::parse(&frame, [("A", 0.4), ("B", 0.3), ("B | C", 0.3)])?;
    /// let alternatives = frame.alternatives();
    /// assert_eq!(m.decide(&alternatives, Criterion::Belief, &frame)?.index, 0);
    /// assert_eq!(m.decide(&alternatives, Criterion::Plausibility, &frame)?.index, 1);
    /// # Ok::<(), wisdom_belief::BeliefError>(())
    /// ```
    ///
    /// # Errors
    /// [`BeliefError::NoAlternatives`] for an empty list, [`BeliefError::NothingPossible`] if all mass is on ∅,
    /// [`BeliefError::Parameter`] for an ε or α out of range, [`BeliefError::ForeignElement`].
    #[expect(clippy::missing_panics_doc, reason = "a maximum equals one of the values")]
    pub fn decide(
        &self,
        alternatives: &[Element],
        criterion: Criterion<F>,
        frame: &Frame,
    ) -> Result<Choice<F>, BeliefError> {
        criterion.check()?;
        self.check_alternatives(alternatives, frame)?;
        let values: Vec<F> =
            alternatives.iter().map(|&element| self.value(element, criterion)).collect();
        let best = values.iter().fold(values[0], |best, &value| best.greatest(value));
        let equal = |value: F| (best - value).to_f64() <= F::SUM_TOLERANCE;
        let mut good = (0..values.len()).filter(|&index| equal(values[index]));
        let index = good.next().expect("the best is as good as itself");
        Ok(Choice { index, value: values[index], ties: good.collect() })
    }

    /// The places of the alternatives that no other dominates: A is dominated if the belief in another one
    /// exceeds Pl(A), so that it is better for every probability within the bounds (Troffaes 2007). At least one
    /// remains.
    ///
    /// # Errors
    /// As [`MassFunction::decide`], but for parameters.
    pub fn non_dominated(
        &self,
        alternatives: &[Element],
        frame: &Frame,
    ) -> Result<Vec<usize>, BeliefError> {
        self.check_alternatives(alternatives, frame)?;
        let beliefs = alternatives.iter().map(|&element| self.belief(element));
        let surest = beliefs.fold(F::zero(), F::greatest);
        let possible = |index: &usize| self.plausibility(alternatives[*index]) >= surest;
        Ok((0..alternatives.len()).filter(possible).collect())
    }

    /// What a criterion says of an element.
    fn value(&self, element: Element, criterion: Criterion<F>) -> F {
        match criterion {
            Criterion::Belief => self.belief(element),
            Criterion::Plausibility => self.plausibility(element),
            Criterion::Pignistic => self.pignistic(element),
            Criterion::Dsmp { epsilon } => self.dsmp(element, epsilon),
            Criterion::Hurwicz { pessimism } => {
                let (worst, best) = (self.belief(element), self.plausibility(element));
                pessimism * worst + (F::one() - pessimism) * best
            }
        }
    }

    fn check_alternatives(
        &self,
        alternatives: &[Element],
        frame: &Frame,
    ) -> Result<(), BeliefError> {
        if alternatives.is_empty() {
            return Err(BeliefError::NoAlternatives);
        }
        alternatives.iter().try_for_each(|&element| frame.check(element))?;
        self.focal().iter().try_for_each(|&(element, _)| frame.check(element))?;
        self.check_possible()
    }
}

impl<F: Number> Criterion<F> {
    fn check(self) -> Result<(), BeliefError> {
        match self {
            Self::Dsmp { epsilon } => check_epsilon(epsilon),
            Self::Hurwicz { pessimism } if !(F::zero()..=F::one()).contains(&pessimism) => {
                let (value, expected) = (pessimism.to_f64(), "in [0, 1]");
                Err(BeliefError::Parameter {
                    name: "pessimism",
                    value,
                    expected: expected.to_owned(),
                })
            }
            _ => Ok(()),
        }
    }
}
