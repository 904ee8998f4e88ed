//! Rules that need no more of the sources than their intersection: DSmC, Dempster, Yager, Inagaki.

use super::{ClosedForm, Lanes, Masses, Outcome, Sources, scaled_up};

/// Intersects all sources; the paradox of the result is the conflict, if the sources have none.
///
/// Only sums and products of masses, so that small results keep all their digits: m(I ∩ NI) as one minus the
/// rest would not.
#[inline(always)]
pub(crate) fn intersection<L: Lanes>(sources: &impl Sources<L>) -> Masses<L> {
    let mut fused = sources.masses(0);
    for source in 1..sources.count() {
        fused = meet(fused, sources.masses(source));
    }
    fused
}

/// Intersects two.
#[inline(always)]
pub(crate) fn meet<L: Lanes>([i, n, u, p]: Masses<L>, [ib, nb, ub, pb]: Masses<L>) -> Masses<L> {
    [
        i * (ib + ub) + u * ib,
        n * (nb + ub) + u * nb,
        u * ub,
        p + i * (nb + pb) + n * (ib + pb) + u * pb,
    ]
}

/// The classic rule of DSmT on the free model, where nothing is in conflict (Dezert 2002; paper Eq. 2).
#[derive(Clone, Copy)]
pub(crate) struct Dsmc;

impl ClosedForm for Dsmc {
    const FREE: bool = true;

    #[inline(always)]
    fn fuse<L: Lanes>(self, sources: &impl Sources<L>) -> Outcome<L> {
        let masses = intersection(sources);
        Outcome { masses, conflict: masses[3].zero_of() }
    }

    /// As [`supported`], so that it is the same whatever else is asked for.
    #[inline(always)]
    fn belief<L: Lanes>(self, sources: &impl Sources<L>, fused: Masses<L>) -> L {
        let mut belief = fused[0].zero_of();
        for source in 0..sources.count() {
            let [i, _, _, p] = sources.masses(source);
            belief = supported(belief, i + p);
        }
        belief
    }
}

/// Bel(I) under DSmC with one more source, of which `support` is m(I) + m(I ∩ NI): what doubts I multiplies,
/// 1 − Π(1 − support), grown by positive terms so that little belief keeps its digits.
#[inline(always)]
pub(crate) fn supported<L: Lanes>(belief: L, support: L) -> L {
    belief + support * (belief.one_of() - belief)
}

/// The conjunctive rule: conflict stays on ∅ (Smets 1990).
#[derive(Clone, Copy)]
pub(crate) struct Conjunctive;

impl ClosedForm for Conjunctive {
    #[inline(always)]
    fn fuse<L: Lanes>(self, sources: &impl Sources<L>) -> Outcome<L> {
        let masses = intersection(sources);
        Outcome { masses, conflict: masses[3] }
    }
}

/// Dempster's rule (paper Eq. 5), and minC, which on two atoms is the same.
#[derive(Clone, Copy)]
pub(crate) struct Dempster;

impl ClosedForm for Dempster {
    #[inline(always)]
    fn fuse<L: Lanes>(self, sources: &impl Sources<L>) -> Outcome<L> {
        normalised(intersection(sources))
    }
}

/// Divides by the sum of what survives: 1 − K would lose its digits near total conflict. Where nothing
/// survives the result is vacuous and K is 1.
#[inline(always)]
pub(crate) fn normalised<L: Lanes>(met: Masses<L>) -> Outcome<L> {
    let [i, n, u, k] = met;
    let rest = i + n + u;
    Outcome { masses: scaled_up(met), conflict: rest.where_positive(k, k.one_of()) }
}

/// Yager's rule (1987): all conflict to I ∪ NI. On two atoms this is Dubois and Prade's rule (1988), too.
#[derive(Clone, Copy)]
pub(crate) struct Yager;

impl ClosedForm for Yager {
    #[inline(always)]
    fn fuse<L: Lanes>(self, sources: &impl Sources<L>) -> Outcome<L> {
        let [i, n, u, k] = intersection(sources);
        Outcome { masses: [i, n, u + k, k.zero_of()], conflict: k }
    }
}

/// Inagaki's family (1991): m(I) and m(NI) grow by the factor 1 + kK, the rest of K goes to I ∪ NI.
///
/// k reaches to the value at which nothing of K is left for I ∪ NI, 1 / (m(I) + m(NI)); a larger one counts as
/// that.
#[derive(Clone, Copy)]
pub(crate) struct Inagaki {
    pub k: f64,
}

impl ClosedForm for Inagaki {
    #[inline(always)]
    fn fuse<L: Lanes>(self, sources: &impl Sources<L>) -> Outcome<L> {
        let [i, n, u, conflict] = intersection(sources);
        let (one, both) = (i.one_of(), i + n);
        let k = both.where_positive(one.share_of(both), i.value(self.k)).lower(i.value(self.k));
        let left = (one - k * both).upper(i.zero_of());
        let grown = one + k * conflict;
        let masses = [i * grown, n * grown, u + conflict * left, conflict.zero_of()];
        Outcome { masses, conflict }
    }
}
