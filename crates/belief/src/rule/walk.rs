//! Every way to choose one focal element from each source.

use super::Rule;
use super::bodies::Bodies;
use super::mask::Mask;
use crate::{BeliefError, Number};

/// The most products of focal elements visited: some seconds of work, beyond which a caller has lost count.
const MAX_PRODUCTS: u64 = 1 << 26;

/// The most sources whose products are visited: what a product costs grows with them, up to their square.
const MAX_WALKED_SOURCES: usize = 1 << 12;

/// Refuses to visit more products than anyone waits for.
pub(super) fn check_products<M: Mask, F: Number>(
    rule: Rule,
    bodies: &Bodies<M, F>,
) -> Result<(), BeliefError> {
    check_sources(rule, bodies.len())?;
    let products = bodies.products();
    if products > MAX_PRODUCTS {
        return Err(BeliefError::TooManyProducts { products, limit: MAX_PRODUCTS, rule });
    }
    Ok(())
}

/// Refuses more sources than a rule can compare with each other in the time that anyone waits.
pub(super) fn check_sources(rule: Rule, sources: usize) -> Result<(), BeliefError> {
    if sources > MAX_WALKED_SOURCES {
        return Err(BeliefError::TooManySources { sources, limit: MAX_WALKED_SOURCES, rule });
    }
    Ok(())
}

/// One focal element of each of some sources.
#[derive(Debug)]
pub(super) struct Choice<'a, M, F> {
    /// The places of the chosen elements among all focal elements.
    pub(super) places: &'a [usize],
    /// Their intersection.
    pub(super) meet: M,
    /// The product of their masses.
    pub(super) product: F,
}

/// Where a walk stands: an odometer, and what its first wheels come to. Memory used again.
#[derive(Debug, Clone)]
pub(super) struct Odometer<M, F> {
    places: Vec<usize>,
    /// The intersection and the product of the first 0, 1, 2… chosen elements.
    so_far: Vec<(M, F)>,
}

impl<M: Mask, F: Number> Odometer<M, F> {
    pub(super) fn new() -> Self {
        Self { places: Vec::new(), so_far: Vec::new() }
    }

    /// Visits every choice of one focal element from each of the first `sources` sources, the last one's
    /// fastest. (No recursion: there may be as many sources as the caller likes.)
    pub(super) fn each_choice(
        &mut self,
        bodies: &Bodies<M, F>,
        sources: usize,
        theta: M,
        mut visit: impl FnMut(Choice<'_, M, F>),
    ) {
        let Self { places, so_far } = self;
        if (0..sources).any(|source| bodies.range(source).is_empty()) {
            return;
        }
        places.clear();
        so_far.clear();
        so_far.push((theta, F::one()));
        loop {
            while places.len() < sources {
                places.push(bodies.range(places.len()).start);
                choose(bodies, places, so_far);
            }
            let (meet, product) = so_far[sources];
            visit(Choice { places, meet, product });
            loop {
                let Some(place) = places.pop() else { return };
                so_far.pop();
                if place + 1 < bodies.range(places.len()).end {
                    places.push(place + 1);
                    choose(bodies, places, so_far);
                    break;
                }
            }
        }
    }
}

/// Adds what the last chosen element brings.
#[inline]
fn choose<M: Mask, F: Number>(bodies: &Bodies<M, F>, places: &[usize], so_far: &mut Vec<(M, F)>) {
    let (element, mass) = bodies.focal()[places[places.len() - 1]];
    let (meet, product) = so_far[places.len() - 1];
    so_far.push((meet & element, product * mass));
}
