//! Sums over all conflicting assignments in one pass: how much of each product belongs to whom.

use super::{ClosedForm, Lanes, Masses, Outcome, Sources};

/// The products of all ways to choose I, NI or I ∪ NI from each source so far, by what they chose: only
/// I ∪ NI (`u`), I and no NI (`i`), NI and no I (`n`), both (`k`: in conflict). `x_of_y` is the sum of the
/// products of kind `x`, each times the worth of those who chose Y. Only positive terms are added.
#[derive(Clone, Copy)]
pub(super) struct Counted<L> {
    u: L,
    i: L,
    n: L,
    pub(super) k: L,
    i_of_i: L,
    pub(super) k_of_i: L,
    n_of_n: L,
    pub(super) k_of_n: L,
    u_of_u: L,
    i_of_u: L,
    n_of_u: L,
    pub(super) k_of_u: L,
}

impl<L: Lanes> Counted<L> {
    /// One source: what it gives to I, NI and I ∪ NI, and what each choice is worth to its chooser.
    #[inline(always)]
    pub(super) fn one([i, n, u]: [L; 3], [worth_i, worth_n, worth_u]: [L; 3]) -> Self {
        let zero = u.zero_of();
        Self {
            u,
            i,
            n,
            k: zero,
            i_of_i: i * worth_i,
            k_of_i: zero,
            n_of_n: n * worth_n,
            k_of_n: zero,
            u_of_u: u * worth_u,
            i_of_u: zero,
            n_of_u: zero,
            k_of_u: zero,
        }
    }

    /// With one more source.
    #[inline(always)]
    pub(super) fn and(self, [i, n, u]: [L; 3], [worth_i, worth_n, worth_u]: [L; 3]) -> Self {
        let (not_n, not_i, any) = (i + u, n + u, i + n + u);
        let (by_i, by_n, by_u) = (i * worth_i, n * worth_n, u * worth_u);
        Self {
            u: self.u * u,
            i: self.i * not_n + self.u * i,
            n: self.n * not_i + self.u * n,
            k: self.k * any + self.i * n + self.n * i,
            i_of_i: self.i_of_i * not_n + (self.i + self.u) * by_i,
            k_of_i: self.k_of_i * any + self.i_of_i * n + (self.k + self.n) * by_i,
            n_of_n: self.n_of_n * not_i + (self.n + self.u) * by_n,
            k_of_n: self.k_of_n * any + self.n_of_n * i + (self.k + self.i) * by_n,
            u_of_u: self.u_of_u * u + self.u * by_u,
            i_of_u: self.i_of_u * not_n + self.u_of_u * i + self.i * by_u,
            n_of_u: self.n_of_u * not_i + self.u_of_u * n + self.n * by_u,
            k_of_u: self.k_of_u * any + self.i_of_u * n + self.n_of_u * i + self.k * by_u,
        }
    }
}

/// Partially uniform redistribution (Smarandache 2004): each conflicting product in S equal parts to what the
/// S sources chose.
#[derive(Clone, Copy)]
pub(crate) struct Purr;

impl ClosedForm for Purr {
    #[inline(always)]
    fn fuse<L: Lanes>(self, sources: &impl Sources<L>) -> Outcome<L> {
        let [i, n, u, _] = sources.masses(0);
        let worth = [u.one_of(); 3];
        let mut counted = Counted::one([i, n, u], worth);
        for source in 1..sources.count() {
            let [i, n, u, _] = sources.masses(source);
            counted = counted.and([i, n, u], worth);
        }
        let of = counted.k.count(sources.count() as u32);
        let masses: Masses<L> = [
            counted.i + counted.k_of_i / of,
            counted.n + counted.k_of_n / of,
            counted.u + counted.k_of_u / of,
            counted.k.zero_of(),
        ];
        Outcome { masses, conflict: counted.k }
    }
}
