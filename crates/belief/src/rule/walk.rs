//! Every way to choose one focal element from each source.

use super::Rule;
use super::bodies::Bodies;
use super::mask::Mask;
use crate::{BeliefError, Number};

/// The most products of focal elements visited: some seconds of work, beyond which a caller has lost count.
const MAX_PRODUCTS: u64 = 1 << 26;

/// Refuses to visit more products than anyone waits for.
pub(super) fn check_products<M: Mask, F: Number>(
    rule: Rule,
    bodies: &Bodies<M, F>,
) -> Result<(), BeliefError> {
    let products = bodies.products();
    if products > MAX_PRODUCTS {
        return Err(BeliefError::TooManyProducts { products, limit: MAX_PRODUCTS, rule });
    }
    Ok(())
}

/// One focal element of each source.
#[derive(Debug)]
pub(super) struct Choice<'a, M, F> {
    /// The places of the chosen elements among all focal elements.
    pub(super) places: &'a [usize],
    /// Their intersection.
    pub(super) meet: M,
    /// The product of their masses.
    pub(super) product: F,
}

/// Visits every choice of one focal element from each source, the last source's fastest.
pub(super) fn each_choice<M: Mask, F: Number>(
    bodies: &Bodies<M, F>,
    theta: M,
    places: &mut Vec<usize>,
    visit: &mut impl FnMut(Choice<'_, M, F>),
) {
    places.clear();
    choose(bodies, theta, F::one(), places, visit);
}

fn choose<M: Mask, F: Number>(
    bodies: &Bodies<M, F>,
    meet: M,
    product: F,
    places: &mut Vec<usize>,
    visit: &mut impl FnMut(Choice<'_, M, F>),
) {
    if places.len() == bodies.len() {
        return visit(Choice { places, meet, product });
    }
    for place in bodies.range(places.len()) {
        let (element, mass) = bodies.focal()[place];
        places.push(place);
        choose(bodies, meet & element, product * mass, places, visit);
        places.pop();
    }
}
