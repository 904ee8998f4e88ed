//! Means of the sources, and rules that combine a mean with itself.

use super::accumulate::Accumulator;
use super::bodies::Bodies;
use super::mask::Mask;
use super::{Rule, Settings, conjunctive};
use crate::number::sum;
use crate::{BeliefError, MassFunction, Number};

/// The weighted mean of the sources; weights need not sum to 1.
pub(super) fn average<M: Mask, F: Number>(
    bodies: &Bodies<M, F>,
    weights: &[F],
    sums: &mut Accumulator<M, F>,
) {
    sums.clear();
    let whole = sum(weights.iter().copied());
    for (body, &weight) in bodies.iter().zip(weights) {
        for &(element, mass) in body {
            sums.add(element, mass * weight);
        }
    }
    sums.scale(|_, mass| mass / whole);
}

/// The weights of a weighted mean; without any given, all sources count the same.
pub(super) fn weights<F: Number>(
    sources: usize,
    settings: &Settings<'_>,
) -> Result<Vec<F>, BeliefError> {
    settings.check_weights(sources)?;
    let Some(given) = settings.weights else { return Ok(vec![F::one(); sources]) };
    // Only their ratios count; the largest becomes 1, so that no sum of them is too large for a number.
    let largest = F::from_f64(given.iter().fold(0.0, |largest, &weight| weight.max(largest)));
    Ok(given.iter().map(|&weight| F::from_f64(weight) / largest).collect())
}

/// The mean in `sums`, combined with itself by Dempster's rule as often as there are sources (Murphy 2000).
pub(super) fn with_itself<M: Mask, F: Number>(
    rule: Rule,
    sources: usize,
    so_far: &mut Vec<(M, F)>,
    sums: &mut Accumulator<M, F>,
) -> Result<(), BeliefError> {
    let mut mean = Vec::new();
    sums.drain_into(&mut mean);
    let copies = std::iter::repeat_n(mean.as_slice(), sources);
    conjunctive::gather_survivors(copies, so_far, sums)?;
    conjunctive::normalise(sums, sources, rule)
}

/// How much each source is believed, for agreeing with the others (Deng et al. 2004): Σ (1 − d) over the others, d
/// the distance of Jousselme, Grenier and Bossé (2001). Sources none of whom agrees with any other count the
/// same.
pub(super) fn credibility<M: Mask, F: Number>(bodies: &Bodies<M, F>) -> Vec<F> {
    let sources: Vec<MassFunction<F>> = bodies.mass_functions().collect();
    let support = |index: usize| {
        let others = sources.iter().enumerate().filter(|&(other, _)| other != index);
        sum(others.map(|(_, other)| sources[index].jousselme_agreement(other)))
    };
    let support: Vec<F> = (0..sources.len()).map(support).collect();
    if support.iter().any(|&support| support > F::zero()) {
        return support;
    }
    vec![F::one(); sources.len()]
}
