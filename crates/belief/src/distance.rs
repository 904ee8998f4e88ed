//! How far two mass functions are apart, and how much they or one of them conflict.

use std::collections::BTreeMap;

use crate::closure::check_closure;
use crate::number::sum;
use crate::{BeliefError, Element, MassFunction, Number};

impl<F: Number> MassFunction<F> {
    /// K of two: the mass of pairs that exclude each other, Σ m₁(A) m₂(B) over A ∩ B = ∅ (Shafer 1976). In
    /// [0, 1]; mass on ∅ excludes everything.
    #[must_use]
    pub fn conflict_with(&self, other: &Self) -> F {
        let against = |a: Element| other.sum_where(|b| (a & b).is_empty());
        sum(self.focal().iter().map(|&(a, mass)| mass * against(a)))
    }

    /// Auto-conflict: m(∅) after `order` copies of the source are combined by intersection (Osswald and Martin
    /// 2006). In [0, 1], rising with the order; of order 1 it is m(∅) itself, of order 0 (nothing said) 0.
    ///
    /// ```
    /// # use wisdom_belief::{Frame, MassFunction};
    /// let frame = Frame::shafer(["A", "B"])?;
    /// let m = MassFunction::parse(&frame, [("A", 0.5), ("B", 0.5)])?;
    /// assert_eq!([m.auto_conflict(1)?, m.auto_conflict(2)?, m.auto_conflict(3)?], [0.0, 0.5, 0.75]);
    /// # Ok::<(), wisdom_belief::BeliefError>(())
    /// ```
    ///
    /// # Errors
    /// [`BeliefError::TooManyElements`] if the focal elements have too many intersections.
    pub fn auto_conflict(&self, order: u32) -> Result<F, BeliefError> {
        if order == 0 {
            return Ok(F::zero());
        }
        let mut fused: BTreeMap<Element, F> = self.focal().iter().copied().collect();
        for _ in 1..order {
            let mut next = BTreeMap::new();
            for (&a, &of_a) in &fused {
                for &(b, of_b) in self.focal() {
                    *next.entry(a & b).or_insert_with(F::zero) += of_a * of_b;
                }
                check_closure(next.len())?;
            }
            fused = next;
        }
        Ok(fused.get(&Element::EMPTY).copied().unwrap_or_else(F::zero))
    }

    /// Jousselme's distance d = √(½ Δᵀ D Δ), Δ = m₁ − m₂, D(A, B) = |A ∩ B| / |A ∪ B| (Jousselme, Grenier and
    /// Bossé 2001; with `DSm` cardinality on overlapping atoms). In [0, 1]; a metric. D(∅, ∅) is 1.
    #[must_use]
    pub fn jousselme_distance(&self, other: &Self) -> F {
        self.jousselme_square(other).sqrt()
    }

    /// The square of [`MassFunction::jousselme_distance`], which needs no root.
    #[must_use]
    pub fn jousselme_square(&self, other: &Self) -> F {
        let difference = self.minus(other);
        let mut square = F::zero();
        for (index, &(a, of_a)) in difference.iter().enumerate() {
            square += of_a * of_a * jaccard(a, a);
            for &(b, of_b) in &difference[..index] {
                square += F::count(2) * of_a * of_b * jaccard(a, b);
            }
        }
        // D is positive definite, so only rounding can go below 0.
        (square / F::count(2)).greatest(F::zero())
    }

    /// 1 − d, without the cancellation of 1 and a distance near it: 1 − d² is a sum of positive terms, since
    /// each source's masses sum to 1, and 1 − d = (1 − d²) / (1 + d).
    pub(crate) fn jousselme_agreement(&self, other: &Self) -> F {
        let spread = |a: &[(Element, F)], b: &[(Element, F)], part: fn(F) -> F| {
            let mut sum = F::zero();
            for &(x, of_x) in a {
                for &(y, of_y) in b {
                    sum += of_x * of_y * part(jaccard(x, y));
                }
            }
            sum
        };
        let within = |m: &Self| spread(m.focal(), m.focal(), |part| F::one() - part);
        let common = spread(self.focal(), other.focal(), |part| part);
        let less = (within(self) + within(other)) / F::count(2) + common;
        less / (F::one() + self.jousselme_distance(other))
    }

    /// m₁ − m₂ on the focal elements of both.
    fn minus(&self, other: &Self) -> Vec<(Element, F)> {
        let mut difference: BTreeMap<Element, F> = self.focal().iter().copied().collect();
        for &(b, mass) in other.focal() {
            let of_b = difference.entry(b).or_insert_with(F::zero);
            *of_b = *of_b - mass;
        }
        difference.into_iter().collect()
    }
}

/// |A ∩ B| / |A ∪ B|, and 1 of ∅ and itself.
fn jaccard<F: Number>(a: Element, b: Element) -> F {
    if a == b {
        return F::one();
    }
    F::count((a & b).cardinality()) / F::count((a | b).cardinality())
}
