//! What the losses of a rule come to.

use wisdom_mission::statistics::{Interval, mean_interval, paired_difference};

use super::rule::Rule;
use super::{Found, OPTIMAL};

/// Samples of the bootstrap.
const RESAMPLES: usize = 10_000;

/// One rule over all instances of a generator. Losses are shares of the optimum's J1.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Summary {
    /// The rule.
    pub(crate) rule: Rule,
    /// Instances in which it loses nothing.
    pub(crate) optimal: usize,
    /// Share of the instances in which no other rule but J1 does better; where several are best, each has its part.
    /// None for J1.
    pub(crate) best_of_rest: Option<f64>,
    /// Mean loss with its 95 % interval by the bootstrap.
    pub(crate) mean: Interval,
    /// Median loss: of the ordered losses the first that half of them do not exceed.
    pub(crate) median: f64,
    /// Loss that 95 % of the instances do not exceed.
    pub(crate) percentile_95: f64,
    /// Greatest loss.
    pub(crate) worst: f64,
    /// Mean reliability of its plans.
    pub(crate) reliability: f64,
    /// Mean number of goals in its plans.
    pub(crate) goals: f64,
    /// Instances in which its plan is proven best in its own terms.
    pub(crate) proven: usize,
}

/// Two rules that follow each other by mean loss.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Step {
    /// The one that loses less.
    pub(crate) better: Rule,
    /// The one that loses more.
    pub(crate) worse: Rule,
    /// How much more, on average over the same instances, with its 95 % interval.
    pub(crate) difference: Interval,
}

impl Step {
    /// Whether the two are told apart: the interval of the difference leaves out 0.
    pub(crate) fn is_clear(&self) -> bool {
        self.difference.low > 0.0
    }
}

/// One summary a rule, in the order of [`Rule::ALL`].
///
/// # Panics
/// Without instances.
pub(crate) fn summaries(found: &[Vec<Found>], seed: u64) -> Vec<Summary> {
    let rest = best_of_rest(found);
    let count = found.len() as f64;
    let summary = |(index, rule): (usize, Rule)| {
        let of: Vec<Found> = found.iter().map(|instance| instance[index]).collect();
        let losses = losses(found, index);
        let mut ordered = losses.clone();
        ordered.sort_by(f64::total_cmp);
        let mean = |value: fn(&Found) -> f64| of.iter().map(value).sum::<f64>() / count;
        Summary {
            rule,
            optimal: losses.iter().filter(|loss| **loss <= OPTIMAL).count(),
            best_of_rest: (index > 0).then(|| rest[index]),
            mean: mean_interval(&losses, RESAMPLES, seed).expect("there are instances"),
            median: quantile(&ordered, 0.5),
            percentile_95: quantile(&ordered, 0.95),
            worst: quantile(&ordered, 1.0),
            reliability: mean(|found| found.drive.reliability),
            goals: mean(|found| found.goals as f64),
            proven: of.iter().filter(|found| found.proven).count(),
        }
    };
    Rule::ALL.into_iter().enumerate().map(summary).collect()
}

/// The rules by mean loss, each with the next.
///
/// # Panics
/// Without instances.
pub(crate) fn ranking(found: &[Vec<Found>], seed: u64) -> Vec<Step> {
    let mean = |index: usize| losses(found, index).iter().sum::<f64>();
    let mut ranks: Vec<(f64, usize)> = (0..Rule::ALL.len()).map(|i| (mean(i), i)).collect();
    ranks.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let step = |pair: &[(f64, usize)]| {
        let (better, worse) = (pair[0].1, pair[1].1);
        let (more, less) = (losses(found, worse), losses(found, better));
        let difference = paired_difference(&more, &less, RESAMPLES, seed);
        Step {
            better: Rule::ALL[better],
            worse: Rule::ALL[worse],
            difference: difference.expect("there are instances"),
        }
    };
    ranks.windows(2).map(step).collect()
}

/// Loss of the rule of this index in every instance.
fn losses(found: &[Vec<Found>], index: usize) -> Vec<f64> {
    found.iter().map(|instance| instance[index].loss).collect()
}

/// Of ordered values the first that this share of them does not exceed.
fn quantile(ordered: &[f64], share: f64) -> f64 {
    let rank = (share * ordered.len() as f64).ceil() as usize;
    ordered[rank.max(1) - 1]
}

/// For every rule the share of instances in which it is the best but for J1.
fn best_of_rest(found: &[Vec<Found>]) -> Vec<f64> {
    let mut shares = vec![0.0; Rule::ALL.len()];
    for instance in found {
        let least = instance[1..].iter().map(|found| found.loss).fold(f64::INFINITY, f64::min);
        let is_best = |found: &Found| found.loss <= least + OPTIMAL;
        let best = instance[1..].iter().filter(|found| is_best(found)).count();
        for (share, _) in shares[1..].iter_mut().zip(&instance[1..]).filter(|(_, f)| is_best(f)) {
            *share += 1.0 / best as f64 / found.len() as f64;
        }
    }
    shares
}
