//! PCR6 and PCR6⁺ of many sources in linear time, by an integral.
//!
//! 1/D is the integral of e^(−Dt) over t > 0, and D, a sum of masses, becomes a product: with
//! f = i e^(−ti), g = n e^(−tn) and h = u e^(−tu) of each source the sum over all 3^S assignments is, at each t,
//! one pass over the sources.

use std::sync::LazyLock;

use super::counted::Counted;
use super::{Lanes, Masses, Sources};
use crate::map::MAX_MAP_SOURCES;

/// A node of the integral and its weight.
type Node = (f64, f64);

/// t = exp(x − exp(−x)) at equally spaced x turns the integral into one that the trapezoidal rule sums with
/// an error that falls exponentially (Takahasi and Mori 1974).
fn nodes<const N: usize>([from, to]: [f64; 2]) -> [Node; N] {
    let step = (to - from) / (N - 1) as f64;
    std::array::from_fn(|index| {
        let x = from + step * index as f64;
        let decay = libm::exp(-x);
        let t = libm::exp(x - decay);
        (t, step * t * (1.0 + decay))
    })
}

/// Errs by less than 2e-7, as much as single precision rounds.
static SINGLE: LazyLock<[Node; 24]> = LazyLock::new(|| nodes([-2.44, 6.47]));

/// Errs by less than 1e-12.
static DOUBLE: LazyLock<[Node; 64]> = LazyLock::new(|| nodes([-3.15, 12.92]));

/// Adds to the agreed masses of I, NI and I ∪ NI what each gets back of the conflict.
#[inline(always)]
pub(super) fn redistributed<L: Lanes, M: Sources<L>, const IGNORANCE: bool>(
    sources: &M,
    agreed: [L; 3],
) -> [L; 3] {
    if M::MAP {
        return integrated::<L, IGNORANCE>(&Kept::new(sources), agreed);
    }
    integrated::<L, IGNORANCE>(sources, agreed)
}

/// Masses of a map's sources that were read once, for all nodes.
struct Kept<L> {
    masses: [Masses<L>; MAX_MAP_SOURCES],
    count: usize,
}

impl<L: Lanes> Kept<L> {
    #[inline(always)]
    fn new(sources: &impl Sources<L>) -> Self {
        let count = sources.count();
        let mut masses = [sources.masses(0); MAX_MAP_SOURCES];
        for (source, slot) in masses.iter_mut().enumerate().take(count).skip(1) {
            *slot = sources.masses(source);
        }
        Self { masses, count }
    }
}

impl<L: Lanes> Sources<L> for Kept<L> {
    const MAP: bool = true;

    #[inline(always)]
    fn count(&self) -> usize {
        self.count
    }

    #[inline(always)]
    fn masses(&self, source: usize) -> Masses<L> {
        self.masses[source]
    }
}

#[inline(always)]
fn integrated<L: Lanes, const IGNORANCE: bool>(
    sources: &impl Sources<L>,
    agreed: [L; 3],
) -> [L; 3] {
    let nodes: &[Node] = if L::SINGLE { &*SINGLE } else { &*DOUBLE };
    let [mut i, mut n, mut u] = agreed;
    for &(t, weight) in nodes {
        let at = at_node::<L, IGNORANCE>(sources, i.value(-t));
        let weight = i.value(weight);
        i = i + weight * at.k_of_i;
        n = n + weight * at.k_of_n;
        if IGNORANCE {
            u = u + weight * at.k_of_u;
        }
    }
    [i, n, u]
}

/// The integrand at one node: every product of a conflict, weighted, times the masses that chose each element.
#[inline(always)]
fn at_node<L: Lanes, const IGNORANCE: bool>(sources: &impl Sources<L>, minus_t: L) -> Counted<L> {
    let [i, n, u, _] = sources.masses(0);
    let mut counted = Counted::one(decayed::<L, IGNORANCE>([i, n, u], minus_t), [i, n, u]);
    for source in 1..sources.count() {
        let [i, n, u, _] = sources.masses(source);
        counted = counted.and(decayed::<L, IGNORANCE>([i, n, u], minus_t), [i, n, u]);
    }
    counted
}

/// f, g and h of a source; without a share for ignorance h is u alone.
#[inline(always)]
fn decayed<L: Lanes, const IGNORANCE: bool>([i, n, u]: [L; 3], minus_t: L) -> [L; 3] {
    let f = i * (minus_t * i).power_of_e();
    let g = n * (minus_t * n).power_of_e();
    let h = if IGNORANCE { u * (minus_t * u).power_of_e() } else { u };
    [f, g, h]
}
