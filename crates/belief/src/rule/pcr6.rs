//! Proportional conflict redistribution no. 6, all sources at once (Martin and Osswald 2006).

use std::collections::BTreeMap;

use super::{Rule, check_frame, check_none_on_empty};
use crate::{BeliefError, Element, Frame, MassFunction};

/// The most products of focal elements visited: some seconds of work, beyond which a caller has lost count.
const MAX_PRODUCTS: u64 = 1 << 26;

pub(super) fn combine(
    sources: &[MassFunction],
    frame: &Frame,
) -> Result<MassFunction, BeliefError> {
    check_frame(sources, frame)?;
    check_none_on_empty(Rule::Pcr6, sources)?;
    let products = sources
        .iter()
        .fold(1_u64, |products, source| products.saturating_mul(source.focal().len() as u64));
    if products > MAX_PRODUCTS {
        return Err(BeliefError::TooManyProducts {
            products,
            limit: MAX_PRODUCTS,
            rule: Rule::Pcr6,
        });
    }
    let mut walk =
        Walk { sources, chosen: Vec::with_capacity(sources.len()), fused: BTreeMap::new() };
    walk.choose(frame.theta(), 1.0);
    Ok(MassFunction::from_map(walk.fused))
}

/// A walk over every way to choose one focal element from each source.
struct Walk<'a> {
    sources: &'a [MassFunction],
    chosen: Vec<(Element, f64)>,
    fused: BTreeMap<Element, f64>,
}

impl Walk<'_> {
    /// Chooses for the sources that are left; `meet` and `product` are those of the choices made so far.
    fn choose(&mut self, meet: Element, product: f64) {
        let sources = self.sources;
        let Some(source) = sources.get(self.chosen.len()) else {
            return self.give(meet, product);
        };
        for &(element, mass) in source.focal() {
            self.chosen.push((element, mass));
            self.choose(meet & element, product * mass);
            self.chosen.pop();
        }
    }

    /// Gives a product to the intersection, or back to those who made it if there is none.
    fn give(&mut self, meet: Element, product: f64) {
        if !meet.is_empty() {
            *self.fused.entry(meet).or_default() += product;
            return;
        }
        let sum: f64 = self.chosen.iter().map(|&(_, mass)| mass).sum();
        for &(element, mass) in &self.chosen {
            *self.fused.entry(element).or_default() += product * mass / sum;
        }
    }
}
