//! Rules that weigh a product by how well its elements overlap: Zhang and Jaccard.

use super::conjunctive::{intersection, meet, normalised};
use super::{ClosedForm, Lanes, Masses, Outcome, Sources};

/// Zhang's centre combination (1994): products times |∩| / Π|X|, then scaled up. Only I ∪ NI has two atoms,
/// so that it counts half in each source, and twice in the result.
#[derive(Clone, Copy)]
pub(crate) struct Zhang;

impl ClosedForm for Zhang {
    #[inline(always)]
    fn fuse<L: Lanes>(self, sources: &impl Sources<L>) -> Outcome<L> {
        let mut fused = halved(sources.masses(0));
        for source in 1..sources.count() {
            fused = meet(fused, halved(sources.masses(source)));
        }
        let [i, n, u, k] = fused;
        let masses = normalised([i, n, u + u, k]).masses;
        // Halves hide some of the conflict; K counts all of it.
        Outcome { masses, conflict: conflict_if_any_agrees(sources) }
    }
}

/// With half of what is on I ∪ NI.
#[inline(always)]
fn halved<L: Lanes>([i, n, u, p]: Masses<L>) -> Masses<L> {
    [i, n, u.half(), p]
}

/// The Jaccard centre: products times |∩| / |∪|, then scaled up. Of what agrees only mixtures of I (or NI) with
/// I ∪ NI have an ∩ that is half of their ∪.
#[derive(Clone, Copy)]
pub(crate) struct Jaccard;

impl ClosedForm for Jaccard {
    #[inline(always)]
    fn fuse<L: Lanes>(self, sources: &impl Sources<L>) -> Outcome<L> {
        let [first_i, first_n, mut u, p] = sources.masses(0);
        // Products of I alone and of I with I ∪ NI; the same of NI.
        let (mut i, mut mixed_i) = (first_i, p.zero_of());
        let (mut n, mut mixed_n) = (first_n, p.zero_of());
        for source in 1..sources.count() {
            let [ib, nb, ub, _] = sources.masses(source);
            mixed_i = mixed_i * (ib + ub) + i * ub + u * ib;
            mixed_n = mixed_n * (nb + ub) + n * ub + u * nb;
            (i, n, u) = (i * ib, n * nb, u * ub);
        }
        let masses = normalised([i + mixed_i.half(), n + mixed_n.half(), u, p.zero_of()]).masses;
        Outcome { masses, conflict: conflict_if_any_agrees(sources) }
    }
}

/// K, and 1 where no product agrees.
#[inline(always)]
fn conflict_if_any_agrees<L: Lanes>(sources: &impl Sources<L>) -> L {
    normalised(intersection(sources)).conflict
}
