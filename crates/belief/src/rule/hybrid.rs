//! Rules that send each product to the intersection of its elements if that exists, else to a union.

use super::accumulate::Accumulator;
use super::bodies::Bodies;
use super::mask::Mask;
use super::walk::{Choice, Odometer};
use super::{Rule, conjunctive};
use crate::{BeliefError, Number};

/// What the elements of a choice are together.
fn union<M: Mask, F: Number>(bodies: &Bodies<M, F>, places: &[usize]) -> M {
    places.iter().fold(M::EMPTY, |all, &place| all | bodies.focal()[place].0)
}

/// Dubois and Prade's rule (1988). On a model that empties all the elements of a product, it is lost.
pub(super) fn dubois_prade<M: Mask, F: Number>(
    bodies: &Bodies<M, F>,
    theta: M,
    odometer: &mut Odometer<M, F>,
    sums: &mut Accumulator<M, F>,
) {
    sums.take(M::EMPTY);
    odometer.each_choice(bodies, bodies.len(), theta, |Choice { places, meet, product }| {
        let union = union(bodies, places);
        if meet.is_empty() && !union.is_empty() {
            sums.add(union, product);
        }
    });
}

/// The hybrid rule of DSmT (Dezert and Smarandache 2004), S1 + S2 + S3. `sums` holds S1, the intersections that
/// exist. A product of elements that are all empty goes to the union of the atoms they were made of, or to Θ
/// if these are empty too (S2); any other goes to the union of its elements (S3).
pub(super) fn dsmh<M: Mask, F: Number>(
    bodies: &Bodies<M, F>,
    theta: M,
    odometer: &mut Odometer<M, F>,
    sums: &mut Accumulator<M, F>,
) {
    sums.take(M::EMPTY);
    odometer.each_choice(bodies, bodies.len(), theta, |Choice { places, meet, product }| {
        if !meet.is_empty() {
            return;
        }
        let union = union(bodies, places);
        if !union.is_empty() {
            return sums.add(union, product);
        }
        let named = places.iter().map(|&place| bodies.named(place));
        let named = named.fold(M::EMPTY, |all, atoms| all | atoms);
        sums.add(if named.is_empty() { theta } else { named }, product);
    });
}

/// The Jaccard centre: each product times |∩| / |∪|, scaled to sum to 1.
pub(super) fn jaccard<M: Mask, F: Number>(
    bodies: &Bodies<M, F>,
    theta: M,
    odometer: &mut Odometer<M, F>,
    sums: &mut Accumulator<M, F>,
) -> Result<(), BeliefError> {
    sums.clear();
    odometer.each_choice(bodies, bodies.len(), theta, |Choice { places, meet, product }| {
        if !meet.is_empty() {
            let union = F::count(union(bodies, places).cardinality());
            sums.add(meet, product * F::count(meet.cardinality()) / union);
        }
    });
    conjunctive::normalise(sums, bodies.len(), Rule::Jaccard)
}

/// minC (after Daniel 2000), in one step: each conflicting product goes to the parts of its union that the
/// conjunctive rule supports, in proportion to that support; to the union itself if it supports none.
pub(super) fn minc<M: Mask, F: Number>(
    bodies: &Bodies<M, F>,
    theta: M,
    odometer: &mut Odometer<M, F>,
    sums: &mut Accumulator<M, F>,
) {
    sums.take(M::EMPTY);
    let mut conflicts = Accumulator::new();
    odometer.each_choice(bodies, bodies.len(), theta, |Choice { places, meet, product }| {
        if meet.is_empty() {
            conflicts.add(union(bodies, places), product);
        }
    });
    let met: Vec<_> = sums.entries().iter().copied().filter(|(x, _)| !x.is_empty()).collect();
    for &(union, conflict) in conflicts.entries() {
        let parts = || met.iter().filter(|(part, _)| part.is_subset_of(union));
        let support = crate::number::sum(parts().map(|&(_, mass)| mass));
        if support > F::zero() {
            parts().for_each(|&(part, mass)| sums.add(part, conflict * (mass / support)));
        } else {
            sums.add(if union.is_empty() { theta } else { union }, conflict);
        }
    }
}
