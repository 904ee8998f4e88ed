//! The hybrid rule of DSmT: I ∩ NI turns out empty only when the sources have spoken.

use super::conjunctive::intersection;
use super::{ClosedForm, Lanes, Outcome, Sources};

/// `DSmH` (Dezert and Smarandache 2004) from the free model to Shafer's. Products without paradox that agree go
/// where they agree; of paradox and I (and nothing else) to I; of paradox and NI to NI; the rest to I ∪ NI:
/// m(I) = A − C + Π(i + p) − Πi − Πp. As a fold of positive terms, by what a product is made of so far.
/// Without paradox it is Dubois and Prade's rule.
#[derive(Clone, Copy)]
pub(crate) struct Dsmh;

impl ClosedForm for Dsmh {
    #[inline(always)]
    fn fuse<L: Lanes>(self, sources: &impl Sources<L>) -> Outcome<L> {
        let [mut i, mut n, mut u, mut p] = sources.masses(0);
        let zero = p.zero_of();
        // I with I ∪ NI, I with the paradox; the same of NI; anything else.
        let (mut i_u, mut i_p, mut n_u, mut n_p, mut other) = (zero, zero, zero, zero, zero);
        for source in 1..sources.count() {
            let [ib, nb, ub, pb] = sources.masses(source);
            other = other * (ib + nb + ub + pb)
                + i * nb
                + n * ib
                + i_u * (nb + pb)
                + n_u * (ib + pb)
                + i_p * (nb + ub)
                + n_p * (ib + ub)
                + u * pb
                + p * ub;
            i_u = i_u * (ib + ub) + i * ub + u * ib;
            n_u = n_u * (nb + ub) + n * ub + u * nb;
            i_p = i_p * (ib + pb) + i * pb + p * ib;
            n_p = n_p * (nb + pb) + n * pb + p * nb;
            (i, n, u, p) = (i * ib, n * nb, u * ub, p * pb);
        }
        let masses = [i + i_u + i_p, n + n_u + n_p, u + p + other, zero];
        Outcome { masses, conflict: intersection(sources)[3] }
    }
}
