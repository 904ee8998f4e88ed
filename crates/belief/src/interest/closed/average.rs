//! Means of the sources, and Dempster's rule on copies of them: average, Murphy, Deng.

use super::conjunctive::{intersection, meet, normalised};
use super::{ClosedForm, Lanes, Masses, Outcome, Sources};

/// The mean of the sources, weighted if weights are given; they are not negative and not all 0.
#[derive(Clone, Copy)]
pub(crate) struct Mean<'a> {
    pub weights: Option<&'a [f64]>,
}

impl ClosedForm for Mean<'_> {
    #[inline(always)]
    fn fuse<L: Lanes>(self, sources: &impl Sources<L>) -> Outcome<L> {
        let conflict = intersection(sources)[3];
        let mut sums = Sums::none(conflict);
        for source in 0..sources.count() {
            let weight = match self.weights {
                Some(weights) => conflict.value(weights[source]),
                None => conflict.one_of(),
            };
            sums = sums.and(weight, sources.masses(source));
        }
        Outcome { masses: sums.mean(), conflict }
    }
}

/// Murphy's rule (2000): Dempster's rule on S copies of the mean.
#[derive(Clone, Copy)]
pub(crate) struct Murphy;

impl ClosedForm for Murphy {
    #[inline(always)]
    fn fuse<L: Lanes>(self, sources: &impl Sources<L>) -> Outcome<L> {
        let conflict = intersection(sources)[3];
        let mut sums = Sums::none(conflict);
        for source in 0..sources.count() {
            sums = sums.and(conflict.one_of(), sources.masses(source));
        }
        Outcome { masses: copies(sums.mean(), sources.count()), conflict }
    }
}

/// Deng's rule (Deng, Shi, Zhu and Liu 2004): as Murphy's, each source weighted by its similarity to the others,
/// 1 less its distance (Jousselme, Grenier and Bossé 2001). Two sources that have none, and one alone, count the
/// same.
#[derive(Clone, Copy)]
pub(crate) struct Deng;

impl ClosedForm for Deng {
    #[inline(always)]
    fn fuse<L: Lanes>(self, sources: &impl Sources<L>) -> Outcome<L> {
        let conflict = intersection(sources)[3];
        let mut total = conflict.zero_of();
        for source in 0..sources.count() {
            total = total + support(sources, source);
        }
        let mut sums = Sums::none(conflict);
        for source in 0..sources.count() {
            let weight = total.where_positive(support(sources, source), conflict.one_of());
            sums = sums.and(weight, sources.masses(source));
        }
        Outcome { masses: copies(sums.mean(), sources.count()), conflict }
    }
}

/// Weighted sums of masses, and of the weights.
#[derive(Clone, Copy)]
struct Sums<L> {
    masses: Masses<L>,
    weight: L,
}

impl<L: Lanes> Sums<L> {
    #[inline(always)]
    fn none(like: L) -> Self {
        Self { masses: [like.zero_of(); 4], weight: like.zero_of() }
    }

    #[inline(always)]
    fn and(self, weight: L, [ib, nb, ub, pb]: Masses<L>) -> Self {
        let [i, n, u, p] = self.masses;
        let masses = [i + weight * ib, n + weight * nb, u + weight * ub, p + weight * pb];
        Self { masses, weight: self.weight + weight }
    }

    #[inline(always)]
    fn mean(self) -> Masses<L> {
        let ([i, n, u, p], weight) = (self.masses, self.weight);
        [i / weight, n / weight, u / weight, p / weight]
    }
}

/// Dempster's rule on some copies of one mass function.
#[inline(always)]
fn copies<L: Lanes>(masses: Masses<L>, count: usize) -> Masses<L> {
    let mut fused = masses;
    for _ in 1..count {
        fused = meet(fused, masses);
    }
    normalised(fused).masses
}

/// How similar the other sources are to one.
#[inline(always)]
fn support<L: Lanes>(sources: &impl Sources<L>, source: usize) -> L {
    let one = sources.masses(source);
    let mut sum = one[0].zero_of();
    for other in 0..sources.count() {
        if other != source {
            sum = sum + similarity(one, sources.masses(other));
        }
    }
    sum
}

/// 1 − d, d² = ((i − i′)² + (n − n′)²) / 2 for masses without any on ∅; as (1 − d²) / (1 + d), where 1 − d² is a
/// sum of positive terms, so that a distance near 1 does not cancel.
#[inline(always)]
fn similarity<L: Lanes>([i, n, u, _]: Masses<L>, [ib, nb, ub, _]: Masses<L>) -> L {
    let (by_i, by_n) = (i - ib, n - nb);
    let distance = (by_i * by_i + by_n * by_n).half().root();
    let within = i * n + ib * nb + ((i + n) * u + (ib + nb) * ub).half();
    let common = i * ib + n * nb + u * ub + ((i + n) * ub + u * (ib + nb)).half();
    (within + common) / (i.one_of() + distance)
}
