//! Unions: the disjunctive rule, and Florea's mixture of it with the conjunctive one.

use super::conjunctive::intersection;
use super::{ClosedForm, Lanes, Masses, Outcome, Sources};

/// Unites all sources: P = Πp, m(I) = Π(p + i) − P, m(NI) likewise, the rest to I ∪ NI; p is the mass of ∅
/// under Shafer's model. As a fold of positive terms.
#[inline(always)]
fn union<L: Lanes>(sources: &impl Sources<L>) -> Masses<L> {
    let [mut i, mut n, mut u, mut p] = sources.masses(0);
    for source in 1..sources.count() {
        let [ib, nb, ub, pb] = sources.masses(source);
        u = u * (ib + nb + ub + pb) + i * (nb + ub) + n * (ib + ub) + p * ub;
        i = i * (ib + pb) + p * ib;
        n = n * (nb + pb) + p * nb;
        p = p * pb;
    }
    [i, n, u, p]
}

/// The disjunctive rule (Dubois and Prade 1986): at least one source is right.
#[derive(Clone, Copy)]
pub(crate) struct Disjunctive;

impl ClosedForm for Disjunctive {
    #[inline(always)]
    fn fuse<L: Lanes>(self, sources: &impl Sources<L>) -> Outcome<L> {
        Outcome { masses: union(sources), conflict: intersection(sources)[3] }
    }
}

/// The robust combination rule (Florea, Jousselme, Bossé and Grenier 2009): K / (1 − K + K²) of the
/// disjunction and (1 − K) / (1 − K + K²) of the conjunction.
#[derive(Clone, Copy)]
pub(crate) struct Florea;

impl ClosedForm for Florea {
    #[inline(always)]
    fn fuse<L: Lanes>(self, sources: &impl Sources<L>) -> Outcome<L> {
        let ([i, n, u, k], [di, dn, du, _]) = (intersection(sources), union(sources));
        // What survives is 1 − K without its cancellation, and the divisor is never below 3/4.
        let agreed = i + n + u;
        let whole = agreed + k * k;
        let (alpha, beta) = (k / whole, agreed / whole);
        let masses =
            [alpha * di + beta * i, alpha * dn + beta * n, alpha * du + beta * u, k.zero_of()];
        Outcome { masses, conflict: k }
    }
}
