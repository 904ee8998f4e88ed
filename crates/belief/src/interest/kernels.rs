//! The rules on {I, NI} in closed form: what a map pays for each cell.

use crate::{InterestMass, ParadoxPolicy, Rule};

/// What all sources together say of one cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fused {
    /// The fused masses.
    pub mass: InterestMass,
    /// K: the mass that fell on ∅ before the rule dealt with it; 0 under `dsmc`, where nothing is empty. 1 is
    /// total conflict: nothing survives, and under `dempster` the fused mass is then vacuous.
    pub conflict: f64,
}

impl Rule {
    /// Fuses all sources of one cell at once; the same as [`combine`](crate::rule::combine) on {I, NI} under
    /// [`Rule::model`]. The policy is applied to each source if that model is Shafer's. No sources: vacuous.
    ///
    /// The cost grows with the number of sources, under `pcr6` with 3 to its power: see
    /// [`MAX_SOURCES`](crate::MAX_SOURCES).
    ///
    /// ```
    /// # use wisdom_belief::{InterestMass, Opinion, ParadoxPolicy, Rule};
    /// // Paper Tables 4 and 5: flat ground (dull) with a very interesting texture.
    /// let sure = 0.99;
    /// let sources = [
    ///     InterestMass::try_from(Opinion { interesting: sure, ..Opinion::default() })?,
    ///     InterestMass::try_from(Opinion { not_interesting: sure, ..Opinion::default() })?,
    /// ];
    /// let belief = |rule: Rule| rule.fuse(&sources, ParadoxPolicy::ToIgnorance).mass.belief();
    /// assert!((belief(Rule::Dsmc) - 0.99).abs() < 1e-12);
    /// assert!((belief(Rule::Dempster) - 0.4975).abs() < 1e-4);
    /// # Ok::<(), wisdom_belief::BeliefError>(())
    /// ```
    #[must_use]
    pub fn fuse(self, sources: &[InterestMass], policy: ParadoxPolicy) -> Fused {
        match self {
            Self::Dsmc => Fused { mass: conjunctive(sources.iter().copied()), conflict: 0.0 },
            Self::Dempster => dempster(sources, policy),
            Self::Pcr6 => pcr6(sources, policy),
        }
    }
}

/// Intersects all sources; the paradox of the result is the conflict, if the sources have none.
///
/// Only sums and products of masses, so that small results keep all their digits: m(I ∩ NI) as one minus the
/// rest would not.
fn conjunctive(sources: impl Iterator<Item = InterestMass>) -> InterestMass {
    sources.fold(InterestMass::VACUOUS, |a, b| {
        let (i, n, u, p) = (a.interesting, a.not_interesting, a.ignorance, a.paradox);
        let (ib, nb, ub, pb) = (b.interesting, b.not_interesting, b.ignorance, b.paradox);
        InterestMass {
            interesting: i * (ib + ub) + u * ib,
            not_interesting: n * (nb + ub) + u * nb,
            ignorance: u * ub,
            paradox: p + i * (nb + pb) + n * (ib + pb) + u * pb,
        }
    })
}

fn dempster(sources: &[InterestMass], policy: ParadoxPolicy) -> Fused {
    let met = conjunctive(sources.iter().map(|&source| policy.apply(source)));
    if met.interesting + met.not_interesting + met.ignorance == 0.0 {
        return Fused { mass: InterestMass::VACUOUS, conflict: 1.0 };
    }
    // Divides by the sum of what survives: 1 − K would lose its digits near total conflict.
    Fused { mass: met.without_paradox(), conflict: met.paradox }
}

fn pcr6(sources: &[InterestMass], policy: ParadoxPolicy) -> Fused {
    let met = conjunctive(sources.iter().map(|&source| policy.apply(source)));
    let mut mass = InterestMass { paradox: 0.0, ..met };
    if met.paradox > 0.0 {
        redistribute(sources, policy, Choice { product: 1.0, i: 0.0, n: 0.0, u: 0.0 }, &mut mass);
    }
    Fused { mass, conflict: met.paradox }
}

/// One element chosen from each source so far: their product, and the sums of the masses on I, NI and I ∪ NI.
#[derive(Clone, Copy)]
struct Choice {
    product: f64,
    i: f64,
    n: f64,
    u: f64,
}

/// Walks every assignment of I, NI or I ∪ NI to the sources left, and gives each conflicting product back in
/// proportion to the masses that made it (Martin and Osswald 2006). Only chosen masses above 0 are followed,
/// so a sum above 0 tells that its element was chosen at all.
fn redistribute(
    left: &[InterestMass],
    policy: ParadoxPolicy,
    choice: Choice,
    fused: &mut InterestMass,
) {
    let Choice { product, i, n, u } = choice;
    let Some((&source, left)) = left.split_first() else {
        if i > 0.0 && n > 0.0 {
            let share = product / (i + n + u);
            fused.interesting += share * i;
            fused.not_interesting += share * n;
            fused.ignorance += share * u;
        }
        return;
    };
    let m = policy.apply(source);
    let (mi, mn, mu) = (m.interesting, m.not_interesting, m.ignorance);
    for next in [
        (mi > 0.0).then_some(Choice { product: product * mi, i: i + mi, ..choice }),
        (mn > 0.0).then_some(Choice { product: product * mn, n: n + mn, ..choice }),
        (mu > 0.0).then_some(Choice { product: product * mu, u: u + mu, ..choice }),
    ]
    .into_iter()
    .flatten()
    {
        redistribute(left, policy, next, fused);
    }
}
