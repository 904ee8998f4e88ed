//! Credit: which expert made a cell interesting.

use wisdom_belief::{InterestMass, Rule};
use wisdom_grid::Cell;

use crate::{Evidence, Fusion};

/// A smaller doubt counts as this one, so that one certain expert does not silence all others for good: a
/// millionth is beyond what any table claims to know.
const LEAST_DOUBT: f64 = 1e-6;

/// Interest that differs from that of ignorance by less than this is rounding, and nobody's credit.
const LEAST_INTEREST: f64 = 1e-12;

/// Each expert's share in the interest of a cell, in the experts' order. Shares sum to one; all are zero
/// where there is no interest to share.
///
/// Under `dsmc` what no expert doubts is interesting, `1 − Bel = Π (1 − Bel_s)`, so that −ln(1 − Bel) is a sum
/// over experts: the share is an expert's part in it (no doubt is taken to be smaller than 1e-6).
///
/// Under any other rule the share is the expert's Shapley value in the statistic (Shapley 1953: its mean
/// contribution over all orders in which the experts could speak), divided by the sum of all, which is the
/// cell's interest less that of ignorance. An expert who speaks against the outcome has a negative share; it
/// stays signed, and the others' shares exceed one by as much.
///
/// # Panics
/// If the cell is not on the grid, as a slice does; if [`Fusion::check`] refuses as many experts.
#[must_use]
pub fn credit(evidence: &Evidence, fusion: &Fusion, cell: Cell) -> Vec<f64> {
    fusion.assert_admits(evidence);
    let sources: Vec<InterestMass> = evidence.at(cell).collect();
    credit_of(&sources, fusion)
}

/// Each source's share in the interest of what they say together: [`credit`] of a cell where the experts say this.
///
/// # Panics
/// If [`Fusion::check`] refuses as many experts.
#[must_use]
pub fn credit_of(sources: &[InterestMass], fusion: &Fusion) -> Vec<f64> {
    match fusion.rule {
        Rule::Dsmc => shares(sources.iter().map(weight_of_evidence).collect()),
        _ => shares(shapley_values(sources, |some| fusion.interest(some))),
    }
}

/// −ln(1 − Bel(I)) of one expert.
fn weight_of_evidence(source: &InterestMass) -> f64 {
    // From the belief, not the doubt: small beliefs keep their digits.
    -libm::log1p(-source.belief().min(1.0 - LEAST_DOUBT))
}

fn shares(values: Vec<f64>) -> Vec<f64> {
    let sum: f64 = values.iter().sum();
    if sum.abs() < LEAST_INTEREST {
        return vec![0.0; values.len()];
    }
    values.into_iter().map(|value| value / sum).collect()
}

/// Shapley values of the sources in a game whose worth is `worth` of the sources taking part.
fn shapley_values(sources: &[InterestMass], worth: impl Fn(&[InterestMass]) -> f64) -> Vec<f64> {
    let n = sources.len();
    let mut members = Vec::with_capacity(n);
    let worths: Vec<f64> = (0..1_usize << n)
        .map(|coalition| {
            members.clear();
            members.extend((0..n).filter(|s| coalition >> s & 1 == 1).map(|s| sources[s]));
            worth(&members)
        })
        .collect();
    let chances = chances(n);
    let value = |s: usize| {
        let without = (0..worths.len()).filter(|coalition| coalition >> s & 1 == 0);
        without
            .map(|coalition| {
                let gain = worths[coalition | 1 << s] - worths[coalition];
                chances[coalition.count_ones() as usize] * gain
            })
            .sum()
    };
    (0..n).map(value).collect()
}

/// For each size k below n, the chance k! (n − k − 1)! / n! that exactly some given k of n players speak
/// before another given one.
fn chances(n: usize) -> Vec<f64> {
    let factorial = |k: usize| (1..=k).map(|i| i as f64).product::<f64>();
    (0..n).map(|k| factorial(k) * factorial(n - k - 1) / factorial(n)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_order_in_which_players_speak_counts_once() {
        // Σ over coalitions without one player: C(n − 1, k) of size k.
        for n in 1..=8_usize {
            let mut ways = 1.0;
            let mut sum = 0.0;
            for (k, chance) in chances(n).into_iter().enumerate() {
                sum += ways * chance;
                ways = ways * (n - 1 - k) as f64 / (k + 1) as f64;
            }
            assert!((sum - 1.0).abs() < 1e-14, "{n} players: {sum}");
        }
    }
}
