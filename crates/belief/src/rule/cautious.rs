//! The cautious and the bold rule: sources that share evidence, of which each piece counts once (Denœux 2008).
//!
//! Of each weight of the canonical decompositions the smallest is kept. So the outcome is the first source,
//! combined with simple mass functions that bring its weights down to the smallest: all ratios are at most 1,
//! all terms positive, and nothing cancels.

use std::collections::{BTreeMap, BTreeSet};

use crate::closure::check_closure;
use crate::condition::gathered;
use crate::decomposition::Weights;
use crate::{BeliefError, Element, Frame, MassFunction, Number};

/// The cautious conjunctive rule. Unnormalised: conflict stays on ∅. Without sources: total ignorance.
///
/// # Errors
/// [`BeliefError::Dogmatic`] if a source gives nothing to Θ, and as [`MassFunction::conjunctive_weights`].
pub(super) fn cautious<F: Number>(
    sources: &[MassFunction<F>],
    frame: &Frame,
) -> Result<MassFunction<F>, BeliefError> {
    let weights =
        |(index, m): (usize, &MassFunction<F>)| m.conjunctive_weights_of_source(index, frame);
    let weights = sources.iter().enumerate().map(weights).collect::<Result<Vec<_>, _>>()?;
    let Some(first) = sources.first() else { return Ok(MassFunction::vacuous(frame)) };
    combine_smallest(first, &weights, |a, b| a & b)
}

/// The bold disjunctive rule. Without sources: total ignorance.
///
/// # Errors
/// [`BeliefError::Normal`] if a source gives nothing to ∅, and as [`MassFunction::disjunctive_weights`].
pub(super) fn bold<F: Number>(
    sources: &[MassFunction<F>],
    frame: &Frame,
) -> Result<MassFunction<F>, BeliefError> {
    let weights =
        |(index, m): (usize, &MassFunction<F>)| m.disjunctive_weights_of_source(index, frame);
    let weights = sources.iter().enumerate().map(weights).collect::<Result<Vec<_>, _>>()?;
    let Some(first) = sources.first() else { return Ok(MassFunction::vacuous(frame)) };
    combine_smallest(first, &weights, |a, b| a | b)
}

/// The first source, its weights brought down to the smallest of all sources.
fn combine_smallest<F: Number>(
    first: &MassFunction<F>,
    weights: &[Weights<F>],
    operation: impl Fn(Element, Element) -> Element,
) -> Result<MassFunction<F>, BeliefError> {
    let listed: BTreeSet<Element> =
        weights.iter().flat_map(Weights::listed).map(|&(element, _)| element).collect();
    let mut fused: BTreeMap<Element, F> = first.focal().iter().copied().collect();
    for element in listed {
        let own = weights[0].of(element);
        let smallest = weights.iter().fold(own, |least, source| least.least(source.of(element)));
        if smallest < own {
            with_simple(&mut fused, element, smallest / own, &operation);
            check_closure(fused.len())?;
        }
    }
    Ok(gathered(fused.into_iter()))
}

/// Combines with the simple mass function that gives `weight` to the operation's neutral element, and the rest
/// to `element`.
fn with_simple<F: Number>(
    fused: &mut BTreeMap<Element, F>,
    element: Element,
    weight: F,
    operation: impl Fn(Element, Element) -> Element,
) {
    let moved = F::one() - weight;
    let mut next = BTreeMap::new();
    for (&other, &mass) in &*fused {
        *next.entry(other).or_insert_with(F::zero) += mass * weight;
        *next.entry(operation(element, other)).or_insert_with(F::zero) += mass * moved;
    }
    *fused = next;
}
