//! Rules for sources that may share their evidence: cautious and bold.

use super::conjunctive::intersection;
use super::{ClosedForm, Lanes, Masses, Outcome, Sources, vacuous_unless};

/// The least weights of the sources' canonical decompositions, on I, NI, and on what both contain (∅) or what
/// contains both (I ∪ NI). `rest_…` is 1 − `weight_…`, without its cancellation.
#[derive(Clone, Copy)]
struct Weights<L> {
    weight_i: L,
    rest_i: L,
    weight_n: L,
    rest_n: L,
    weight_both: L,
    /// Above 0 if every source can be decomposed.
    defined: L,
}

impl<L: Lanes> Weights<L> {
    /// By the mass `d` that must not be 0: m(I ∪ NI) of the cautious rule, m(∅) of the bold one.
    #[inline(always)]
    fn of(i: L, n: L, d: L) -> Self {
        let (with_i, with_n) = (i + d, n + d);
        Self {
            weight_i: d.share_of(with_i),
            rest_i: i.share_of(with_i),
            weight_n: d.share_of(with_n),
            rest_n: n.share_of(with_n),
            weight_both: (with_i * with_n).share_of(d),
            defined: d,
        }
    }

    #[inline(always)]
    fn least(self, other: Self) -> Self {
        Self {
            weight_i: self.weight_i.lower(other.weight_i),
            rest_i: self.rest_i.upper(other.rest_i),
            weight_n: self.weight_n.lower(other.weight_n),
            rest_n: self.rest_n.upper(other.rest_n),
            weight_both: self.weight_both.lower(other.weight_both),
            defined: self.defined.lower(other.defined),
        }
    }

    /// m(I), m(NI), the mass of the pivot `d`, and the rest.
    #[inline(always)]
    fn masses(self) -> [L; 4] {
        let (by_i, by_n) = (self.weight_i * self.weight_both, self.weight_n * self.weight_both);
        let pivot = by_i * self.weight_n;
        let (i, n) = (by_n * self.rest_i, by_i * self.rest_n);
        // 0 in exact arithmetic if the sources leave nothing; rounding must not make it negative.
        let rest = (pivot.one_of() - (pivot + i + n)).upper(pivot.zero_of());
        [i, n, pivot, rest]
    }

    /// `masses` where they are defined: also not where a pivot is so small that its weight has no number.
    #[inline(always)]
    fn where_defined(self, masses: Masses<L>, conflict: L) -> Outcome<L> {
        let in_range = self.weight_both.value(LARGEST_WEIGHT) - self.weight_both;
        let defined = self.defined.lower(in_range);
        Outcome {
            masses: vacuous_unless(defined, masses),
            conflict: defined.where_positive(conflict, conflict.one_of()),
        }
    }
}

/// Beyond it a product of weights leaves the range of single precision.
const LARGEST_WEIGHT: f64 = 1e36;

/// The cautious conjunctive rule (Denœux 2008); every source needs m(I ∪ NI) > 0.
#[derive(Clone, Copy)]
pub(crate) struct Cautious;

impl ClosedForm for Cautious {
    #[inline(always)]
    fn fuse<L: Lanes>(self, sources: &impl Sources<L>) -> Outcome<L> {
        let [i, n, u, _] = sources.masses(0);
        let mut least = Weights::of(i, n, u);
        for source in 1..sources.count() {
            let [i, n, u, _] = sources.masses(source);
            least = least.least(Weights::of(i, n, u));
        }
        let [i, n, u, empty] = least.masses();
        least.where_defined([i, n, u, empty], intersection(sources)[3])
    }
}

/// The bold disjunctive rule (Denœux 2008); every source needs m(∅) > 0.
#[derive(Clone, Copy)]
pub(crate) struct Bold;

impl ClosedForm for Bold {
    #[inline(always)]
    fn fuse<L: Lanes>(self, sources: &impl Sources<L>) -> Outcome<L> {
        let [i, n, _, empty] = sources.masses(0);
        let mut least = Weights::of(i, n, empty);
        for source in 1..sources.count() {
            let [i, n, _, empty] = sources.masses(source);
            least = least.least(Weights::of(i, n, empty));
        }
        let [i, n, empty, u] = least.masses();
        least.where_defined([i, n, u, empty], intersection(sources)[3])
    }
}
