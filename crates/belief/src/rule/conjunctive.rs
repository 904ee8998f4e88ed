//! Products that go to the intersection or the union of what was said, and what is left of them.

use super::accumulate::Accumulator;
use super::bodies::Bodies;
use super::mask::Mask;
use super::{Rule, Workspace};
use crate::number::sum;
use crate::{BeliefError, Frame, MassFunction, Number};

/// Combines all sources by intersection; what falls on ∅ stays there ([`Rule::Conjunctive`]).
///
/// # Errors
/// [`BeliefError::ForeignElement`] if a source is not of this frame.
pub fn conjunctive<F: Number>(
    sources: &[MassFunction<F>],
    frame: &Frame,
) -> Result<MassFunction<F>, BeliefError> {
    super::combine(Rule::Conjunctive, sources, frame)
}

/// K: the mass that falls on ∅ when all sources are combined by intersection.
///
/// # Errors
/// As [`conjunctive`].
pub fn conflict<F: Number>(sources: &[MassFunction<F>], frame: &Frame) -> Result<F, BeliefError> {
    let mut workspace = Workspace::new();
    Ok(workspace.combine(Rule::Conjunctive, sources, frame)?.conflict())
}

/// The most focal elements that are combined with a further source: a hundred megabytes of them.
const MAX_FOCAL: usize = 1 << 20;

/// Products are scaled when the largest is below this or above its inverse: far within what f32 can hold,
/// times itself or not.
const SMALL: f64 = 1e-12;

/// Adds up the products of all sources at their intersections or unions. Either operation is associative, so
/// one source after another is the same as all at once and visits far fewer products.
pub(super) fn gather<'a, M: Mask + 'a, F: Number>(
    bodies: impl Iterator<Item = &'a [(M, F)]>,
    operation: impl Fn(M, M) -> M,
    so_far: &mut Vec<(M, F)>,
    sums: &mut Accumulator<M, F>,
) -> Result<(), BeliefError> {
    gather_prepared(bodies, operation, |_| {}, so_far, sums)
}

/// The conjunctive rule up to a factor and without ∅, for rules that scale what survives: with very many sources
/// the products themselves would fall below the least number there is.
pub(super) fn gather_survivors<'a, M: Mask + 'a, F: Number>(
    bodies: impl Iterator<Item = &'a [(M, F)]>,
    so_far: &mut Vec<(M, F)>,
    sums: &mut Accumulator<M, F>,
) -> Result<(), BeliefError> {
    gather_prepared(bodies, |x, y| x & y, rescale, so_far, sums)
}

/// Drops ∅, and scales the rest where it is far from 1. (Either way: Zhang's factors are above 1.)
fn rescale<M: Mask, F: Number>(so_far: &mut Vec<(M, F)>) {
    so_far.retain(|(element, _)| !element.is_empty());
    let largest = so_far.iter().fold(F::zero(), |largest, &(_, mass)| largest.greatest(mass));
    if largest > F::zero() && !(SMALL..1.0 / SMALL).contains(&largest.to_f64()) {
        for (_, mass) in so_far {
            *mass = *mass / largest;
        }
    }
}

/// [`gather`], with what came of the sources so far prepared before the next one is combined.
fn gather_prepared<'a, M: Mask + 'a, F: Number>(
    mut bodies: impl Iterator<Item = &'a [(M, F)]>,
    operation: impl Fn(M, M) -> M,
    prepare: impl Fn(&mut Vec<(M, F)>),
    so_far: &mut Vec<(M, F)>,
    sums: &mut Accumulator<M, F>,
) -> Result<(), BeliefError> {
    sums.clear();
    sums.add_each(bodies.next().unwrap_or(&[]), |element, mass| (element, mass));
    for body in bodies {
        sums.drain_into(so_far);
        prepare(so_far);
        for &(x, of_x) in so_far.iter() {
            sums.add_each(body, |y, of_y| (operation(x, y), of_x * of_y));
            if sums.entries().len() > MAX_FOCAL {
                return Err(BeliefError::TooManyElements { limit: MAX_FOCAL });
            }
        }
    }
    Ok(())
}

/// Scales what was added up so that it sums to 1, without ∅ (Dempster 1967): by the sum of what survives, since
/// 1 − K would lose every digit near total conflict.
pub(super) fn normalise<M: Mask, F: Number>(
    sums: &mut Accumulator<M, F>,
    sources: usize,
    rule: Rule,
) -> Result<(), BeliefError> {
    sums.take(M::EMPTY);
    let left = sum(sums.entries().iter().map(|&(_, mass)| mass));
    if left > F::zero() {
        sums.scale(|_, mass| mass / left);
        return Ok(());
    }
    Err(BeliefError::TotalConflict { sources, rule })
}

/// Yager's rule (1987) at k = 0 and Inagaki's family (1991) beyond: what fell on ∅ goes to Θ, and the share k of
/// it to all in proportion to what they have.
pub(super) fn inagaki<M: Mask, F: Number>(
    sums: &mut Accumulator<M, F>,
    theta: M,
    k: f64,
) -> Result<(), BeliefError> {
    let conflict = sums.take(M::EMPTY);
    let committed = sums.entries().iter().filter(|&&(element, _)| element != theta);
    let committed = sum(committed.map(|&(_, mass)| mass)).to_f64();
    // As close above the limit as the division that made k may round.
    if !(k >= 0.0 && k * committed <= 1.0 + F::SUM_TOLERANCE.max(4.0 * f64::EPSILON)) {
        return Err(BeliefError::Parameter {
            name: "inagaki_k",
            value: k,
            expected: format!("0 to 1 / (1 - K - m(Theta)) = {}", 1.0 / committed),
        });
    }
    let (one, k) = (F::one(), F::from_f64(k));
    let scale = one + k * conflict;
    sums.scale(|_, mass| mass * scale);
    sums.add(theta, (scale - k) * conflict);
    Ok(())
}

/// Zhang's centre combination (1994): each product times |∩| / Π|X|, which factors over the sources.
pub(super) fn zhang<M: Mask, F: Number>(
    bodies: &Bodies<M, F>,
    theta: M,
    so_far: &mut Vec<(M, F)>,
    sums: &mut Accumulator<M, F>,
) -> Result<(), BeliefError> {
    let thinned: Vec<Vec<(M, F)>> = bodies
        .iter()
        .map(|body| {
            let possible = body.iter().filter(|(element, _)| !element.is_empty());
            // Times |Θ|, which is a factor of all: a source that knows nothing then changes nothing at all.
            let weight = |x: M| F::count(theta.cardinality()) / F::count(x.cardinality());
            possible.map(|&(x, mass)| (x, mass * weight(x))).collect()
        })
        .collect();
    gather_survivors(thinned.iter().map(Vec::as_slice), so_far, sums)?;
    sums.scale(|x, mass| mass * F::count(x.cardinality()));
    normalise(sums, bodies.len(), Rule::Zhang)
}

/// The robust combination rule (Florea et al. 2009): α of the disjunctive rule and β of the conjunctive one,
/// α = K / (1 − K + K²) and β = (1 − K) / (1 − K + K²), with 1 − K as the sum of what survives.
pub(super) fn florea<M: Mask, F: Number>(
    bodies: &Bodies<M, F>,
    so_far: &mut Vec<(M, F)>,
    sums: &mut Accumulator<M, F>,
) -> Result<(), BeliefError> {
    gather(bodies.iter(), |x, y| x & y, so_far, sums)?;
    let conflict = sums.take(M::EMPTY);
    let mut met = Vec::new();
    sums.drain_into(&mut met);
    let survives = sum(met.iter().map(|&(_, mass)| mass));
    let whole = survives + conflict * conflict;
    gather(bodies.iter(), |x, y| x | y, so_far, sums)?;
    sums.take(M::EMPTY);
    sums.scale(|_, mass| mass * (conflict / whole));
    for (element, mass) in met {
        sums.add(element, mass * (survives / whole));
    }
    Ok(())
}
