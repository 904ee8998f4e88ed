//! Bel(I) alone under DSmC: 1 − Π(1 − m(I) − m(I ∩ NI)), which asks no more of the sources than what supports I.

use super::MapNumber;
use super::number::Job;
use super::source::{Planes, Step, sweep_again};
use super::width::Width;
use crate::Number;
use crate::interest::closed::supported;

/// Fuses planes to Bel(I); m(NI) is not looked at.
pub(super) struct DsmcBelief<'a, F> {
    pub planes: &'a [Planes<'a, F>],
    pub belief: &'a mut [F],
}

impl<F: MapNumber> Job<F> for DsmcBelief<'_, F> {
    #[inline(always)]
    fn run<W: Width<F>>(self, width: W) {
        sweep_again(width, self.belief.len(), self);
    }
}

impl<F: Number> Step<F> for DsmcBelief<'_, F> {
    #[inline(always)]
    fn step<W: Width<F>>(&mut self, width: W, at: usize) {
        let mut belief = width.splat(F::zero());
        for planes in self.planes {
            let mut support = width.load(planes.interesting, at);
            if let Some(paradox) = planes.paradox {
                support = support + width.load(paradox, at);
            }
            belief = supported(belief, support);
        }
        width.store(belief, self.belief, at);
    }
}
