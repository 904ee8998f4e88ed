//! All conflict shared at once by what each element got in all: PCR1 to PCR4, and in equal parts: URR.

use super::conjunctive::intersection;
use super::{ClosedForm, Lanes, Masses, Outcome, Sources};

/// What the sources give each element in all.
#[inline(always)]
fn column_sums<L: Lanes>(sources: &impl Sources<L>) -> Masses<L> {
    let [mut i, mut n, mut u, mut p] = sources.masses(0);
    for source in 1..sources.count() {
        let [ib, nb, ub, pb] = sources.masses(source);
        (i, n, u, p) = (i + ib, n + nb, u + ub, p + pb);
    }
    [i, n, u, p]
}

/// PCR1 (Smarandache and Dezert 2005): K in proportion to the column sums, I ∪ NI included.
#[derive(Clone, Copy)]
pub(crate) struct Pcr1;

impl ClosedForm for Pcr1 {
    #[inline(always)]
    fn fuse<L: Lanes>(self, sources: &impl Sources<L>) -> Outcome<L> {
        let ([i, n, u, k], [si, sn, su, _]) = (intersection(sources), column_sums(sources));
        let share = k / k.count(sources.count() as u32);
        let masses = [i + share * si, n + share * sn, u + share * su, k.zero_of()];
        Outcome { masses, conflict: k }
    }
}

/// PCR2 (Smarandache and Dezert 2005): K in proportion to the column sums of I and NI, the only elements that can
/// be in conflict. For the same reason it is PCR3, too.
#[derive(Clone, Copy)]
pub(crate) struct Pcr2;

impl ClosedForm for Pcr2 {
    #[inline(always)]
    fn fuse<L: Lanes>(self, sources: &impl Sources<L>) -> Outcome<L> {
        let ([i, n, u, k], [si, sn, ..]) = (intersection(sources), column_sums(sources));
        let share = k.share_of(si + sn);
        Outcome { masses: [i + share * si, n + share * sn, u, k.zero_of()], conflict: k }
    }
}

/// PCR4 (Smarandache and Dezert 2005): K in proportion to the conjunctive m(I) and m(NI); to the column sums, as
/// PCR2, if one of them is 0.
#[derive(Clone, Copy)]
pub(crate) struct Pcr4;

impl ClosedForm for Pcr4 {
    #[inline(always)]
    fn fuse<L: Lanes>(self, sources: &impl Sources<L>) -> Outcome<L> {
        let ([i, n, u, k], [si, sn, ..]) = (intersection(sources), column_sums(sources));
        let both = i.lower(n);
        let (to_i, to_n) = (both.where_positive(i, si), both.where_positive(n, sn));
        let share = k.share_of(to_i + to_n);
        Outcome { masses: [i + share * to_i, n + share * to_n, u, k.zero_of()], conflict: k }
    }
}

/// Uniform redistribution (Smarandache 2004): K in equal parts to every element that some source gives mass.
#[derive(Clone, Copy)]
pub(crate) struct Urr;

impl ClosedForm for Urr {
    #[inline(always)]
    fn fuse<L: Lanes>(self, sources: &impl Sources<L>) -> Outcome<L> {
        let ([i, n, u, k], [si, sn, su, _]) = (intersection(sources), column_sums(sources));
        let (zero, one) = (k.zero_of(), k.one_of());
        let focal_i = si.where_positive(one, zero);
        let focal_n = sn.where_positive(one, zero);
        let focal_u = su.where_positive(one, zero);
        let share = k.share_of(focal_i + focal_n + focal_u);
        let masses = [i + share * focal_i, n + share * focal_n, u + share * focal_u, zero];
        Outcome { masses, conflict: k }
    }
}
