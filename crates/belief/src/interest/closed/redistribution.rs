//! Conflict given back, product by product, to those who made it: PCR5, PCR6 and their "plus" forms.
//!
//! An assignment lets each source say I, NI or I ∪ NI; it is in conflict if someone says I and someone NI.

use super::conjunctive::intersection;
use super::{ClosedForm, Lanes, Masses, Outcome, Sources, quadrature};
use crate::MAX_SOURCES;

/// PCR6 (`SUMS`; Martin and Osswald 2006): each conflicting product goes to I, NI and I ∪ NI in proportion to
/// the sums of the masses that chose them. PCR5 (Smarandache and Dezert 2005): to the products of those
/// masses. Without `IGNORANCE` those who said I ∪ NI, and so took no part, have no share (PCR5⁺ and PCR6⁺;
/// Dezert, Dezert and Smarandache 2021).
#[derive(Clone, Copy)]
pub(crate) struct Redistribution<const SUMS: bool, const IGNORANCE: bool>;

/// The most sources whose assignments are visited one by one where the integral is another way: in a cell as
/// many as can be; on a map in double precision until the integral is faster, as the bench `maps` measures it; in
/// single precision not the 180 products of five, whose sum rounds more than the integral errs.
#[inline(always)]
const fn enumerated(map: bool, single: bool) -> usize {
    match (map, single) {
        (false, _) => MAX_SOURCES,
        (true, true) => 4,
        (true, false) => 6,
    }
}

impl<const SUMS: bool, const IGNORANCE: bool> ClosedForm for Redistribution<SUMS, IGNORANCE> {
    #[inline(always)]
    fn fuse<L: Lanes>(self, sources: &impl Sources<L>) -> Outcome<L> {
        Self::fused(sources)
    }
}

impl<const SUMS: bool, const IGNORANCE: bool> Redistribution<SUMS, IGNORANCE> {
    #[inline(always)]
    fn fused<L: Lanes, M: Sources<L>>(sources: &M) -> Outcome<L> {
        let count = sources.count();
        if M::MAP && count == 2 {
            return two(sources.masses(0), sources.masses(1));
        }
        if M::MAP && SUMS && IGNORANCE && count == 3 {
            return three(sources.masses(0), sources.masses(1), sources.masses(2));
        }
        let [i, n, u, conflict] = intersection(sources);
        let agreed = [i, n, u];
        let [i, n, u] = if SUMS && count > enumerated(M::MAP, L::SINGLE) {
            quadrature::redistributed::<L, M, IGNORANCE>(sources, agreed)
        } else if M::MAP || count <= MAX_SOURCES {
            branch_by_branch::<L, SUMS, IGNORANCE>(sources, agreed)
        } else {
            leaf_by_leaf::<L, SUMS, IGNORANCE>(sources, agreed)
        };
        Outcome { masses: [i, n, u, conflict.zero_of()], conflict }
    }
}

/// What some of the sources have chosen so far: their product, and for each of I, NI and I ∪ NI the sum or the
/// product of the masses that chose it, and whether there were any.
#[derive(Clone, Copy)]
struct Choice<L, const SUMS: bool> {
    product: L,
    groups: [L; 3],
    chosen: [bool; 3],
}

impl<L: Lanes, const SUMS: bool> Choice<L, SUMS> {
    /// Nobody has chosen.
    #[inline(always)]
    fn none(one: L) -> Self {
        let empty = if SUMS { one.zero_of() } else { one };
        Self { product: one, groups: [empty; 3], chosen: [false; 3] }
    }

    /// One more source chooses.
    #[inline(always)]
    fn and(mut self, element: usize, masses: Masses<L>) -> Self {
        let mass = masses[element];
        let group = self.groups[element];
        self.product = self.product * mass;
        self.groups[element] = if SUMS { group + mass } else { group * mass };
        self.chosen[element] = true;
        self
    }

    /// Gives the product back, if it is in conflict.
    #[inline(always)]
    fn redistribute<const IGNORANCE: bool>(self, [i, n, u]: [L; 3]) -> [L; 3] {
        let [of_i, of_n, of_u] = self.groups;
        let [some_i, some_n, some_u] = self.chosen;
        if !(some_i && some_n) {
            return [i, n, u];
        }
        let takes_part = of_i + of_n;
        if IGNORANCE && some_u {
            let share = self.product.share_of(takes_part + of_u);
            return [i + share * of_i, n + share * of_n, u + share * of_u];
        }
        let share = self.product.share_of(takes_part);
        [i + share * of_i, n + share * of_n, u]
    }
}

/// Walks all assignments, the last source's choice changing fastest, and keeps what the sources before have
/// chosen.
#[inline(always)]
fn branch_by_branch<L: Lanes, const SUMS: bool, const IGNORANCE: bool>(
    sources: &impl Sources<L>,
    mut fused: [L; 3],
) -> [L; 3] {
    let count = sources.count();
    let first = sources.masses(0);
    let mut masses = [first; MAX_SOURCES];
    for (source, slot) in masses.iter_mut().enumerate().take(count).skip(1) {
        *slot = sources.masses(source);
    }
    let mut choices = [Choice::<L, SUMS>::none(first[0].one_of()); MAX_SOURCES + 1];
    let mut elements = [0_usize; MAX_SOURCES];
    let mut changed = 0;
    loop {
        for source in changed..count - 1 {
            choices[source + 1] = choices[source].and(elements[source], masses[source]);
        }
        for element in 0..3 {
            let choice = choices[count - 1].and(element, masses[count - 1]);
            fused = choice.redistribute::<IGNORANCE>(fused);
        }
        let Some(next) = (0..count - 1).rev().find(|&source| elements[source] < 2) else {
            return fused;
        };
        elements[next] += 1;
        elements[next + 1..count].fill(0);
        changed = next;
    }
}

/// Walks all assignments, each from its start: for more sources than choices are kept of.
#[inline(always)]
fn leaf_by_leaf<L: Lanes, const SUMS: bool, const IGNORANCE: bool>(
    sources: &impl Sources<L>,
    mut fused: [L; 3],
) -> [L; 3] {
    let one = fused[0].one_of();
    let assignments = 3_u128.saturating_pow(sources.count() as u32);
    let mut assignment = 0;
    while assignment < assignments {
        let mut choice = Choice::<L, SUMS>::none(one);
        let mut rest = assignment;
        for source in 0..sources.count() {
            choice = choice.and((rest % 3) as usize, sources.masses(source));
            rest /= 3;
        }
        fused = choice.redistribute::<IGNORANCE>(fused);
        assignment += 1;
    }
    fused
}

/// Added to denominators that may be 0, so that they can be multiplied by four and divided by: its fourth
/// power is a normal number, and what it changes is far below rounding. Products of masses that small are
/// nothing.
#[inline(always)]
fn tiny<L: Lanes>(like: L) -> L {
    like.value(if L::SINGLE { 1e-9 } else { 1e-75 })
}

/// All four rules of two sources: i₁²n₂/(i₁ + n₂) and the like, without branches.
#[inline(always)]
fn two<L: Lanes>([i, n, u, _]: Masses<L>, [ib, nb, ub, _]: Masses<L>) -> Outcome<L> {
    let tiny = tiny(i);
    let (with_i, with_n) = (i + nb + tiny, n + ib + tiny);
    let inverse = i.one_of() / (with_i * with_n);
    let (product_i, product_n) = (i * nb, n * ib);
    let (share_i, share_n) = (product_i * (with_n * inverse), product_n * (with_i * inverse));
    let masses = [
        i * (ib + ub) + u * ib + share_i * i + share_n * ib,
        n * (nb + ub) + u * nb + share_i * nb + share_n * n,
        u * ub,
        u.zero_of(),
    ];
    Outcome { masses, conflict: product_i + product_n }
}

/// PCR6 of three sources: the twelve conflicting assignments, four to a division.
#[inline(always)]
fn three<L: Lanes>(a: Masses<L>, b: Masses<L>, c: Masses<L>) -> Outcome<L> {
    let ([ia, na, ua, _], [ib, nb, ub, _], [ic, nc, uc, _]) = (a, b, c);
    let (iab, nab) = (ia * (ib + ub) + ua * ib, na * (nb + ub) + ua * nb);
    let (uab, kab) = (ua * ub, ia * nb + na * ib);
    let conflict = kab + iab * nc + nab * ic;
    // One source each for I, NI and I ∪ NI.
    let [abc, acb, bac, bca] = shares([ia, nb, uc], [ia, nc, ub], [ib, na, uc], [ib, nc, ua]);
    // The last two of those; a and b, then b and c for I against the third.
    let [cab, cba, not_c, not_a] = shares([ic, na, ub], [ic, nb, ua], [ia, nc, ib], [ib, na, ic]);
    // a and c for I, then each alone for I.
    let [not_b, only_c, only_a, only_b] =
        shares([ic, nb, ia], [ic, na, nb], [ia, nb, nc], [ib, nc, na]);
    // Each mass is paid by all products that it is in.
    let i = iab * (ic + uc)
        + uab * ic
        + ia * (abc + acb + not_c + not_b + only_a)
        + ib * (bac + bca + not_c + not_a + only_b)
        + ic * (cab + cba + not_a + not_b + only_c);
    let n = nab * (nc + uc)
        + uab * nc
        + na * (bac + cab + not_a + only_b + only_c)
        + nb * (abc + cba + not_b + only_a + only_c)
        + nc * (acb + bca + not_c + only_a + only_b);
    let u = uab * uc + ua * (bca + cba) + ub * (acb + cab) + uc * (abc + bac);
    Outcome { masses: [i, n, u, u.zero_of()], conflict }
}

/// Each product of three masses by their sum, with one division for all four.
#[inline(always)]
fn shares<L: Lanes>(a: [L; 3], b: [L; 3], c: [L; 3], d: [L; 3]) -> [L; 4] {
    let (sum_a, sum_b, sum_c, sum_d) = (made_by(a), made_by(b), made_by(c), made_by(d));
    let (ab, cd) = (sum_a * sum_b, sum_c * sum_d);
    let inverse = ab.one_of() / (ab * cd);
    let (by_ab, by_cd) = (cd * inverse, ab * inverse);
    [
        a[0] * a[1] * a[2] * (sum_b * by_ab),
        b[0] * b[1] * b[2] * (sum_a * by_ab),
        c[0] * c[1] * c[2] * (sum_d * by_cd),
        d[0] * d[1] * d[2] * (sum_c * by_cd),
    ]
}

/// The sum of three masses, never 0.
#[inline(always)]
fn made_by<L: Lanes>([x, y, z]: [L; 3]) -> L {
    (x + y) + (z + tiny(z))
}
