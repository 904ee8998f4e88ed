//! The area under the receiver operating characteristic: the chance that a target scores above ground.

use std::collections::BTreeMap;

use rayon::prelude::*;
use wisdom_terrain::unit_noise;

/// First word of every key drawn here.
const RESAMPLING: u64 = 0xE1C;

/// Share of the resampled values left out at either end of a 95 % interval.
const TAIL: f64 = 0.025;

/// Something with a score, in a group of which the members stand and fall together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Scored {
    /// The score.
    pub(crate) score: f64,
    /// Its group.
    pub(crate) group: usize,
}

/// The ends of a 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Ends {
    /// Lower end.
    pub(crate) low: f64,
    /// Upper end.
    pub(crate) high: f64,
}

/// How targets score against ground: the chance that a random target scores above random ground, ties counted half
/// (Mann and Whitney 1947). None without targets or ground.
pub(crate) fn auc(targets: &[f64], ground: &[f64]) -> Option<f64> {
    let mut sorted = ground.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let wins: f64 = targets.iter().map(|score| above(*score, &sorted)).sum();
    let pairs = targets.len() as f64 * ground.len() as f64;
    (pairs > 0.0).then(|| wins / pairs)
}

/// How many of some sorted scores lie below one, those equal to it counted half.
fn above(score: f64, sorted: &[f64]) -> f64 {
    let below = sorted.partition_point(|other| *other < score);
    let not_above = sorted.partition_point(|other| *other <= score);
    (below + not_above) as f64 / 2.0
}

/// 95 % interval of the AUC by the percentile bootstrap (Efron 1979), targets and ground resampled one by one as if each
/// were an independent draw. They are not: it is too short by far where they cluster.
pub(crate) fn by_cell(
    targets: &[f64],
    ground: &[f64],
    resamples: usize,
    seed: u64,
) -> Option<Ends> {
    let mut levels: Vec<f64> = targets.iter().chain(ground).copied().collect();
    levels.sort_unstable_by(f64::total_cmp);
    levels.dedup();
    let level = |scores: &[f64]| -> Vec<usize> {
        scores.iter().map(|score| levels.partition_point(|other| other < score)).collect()
    };
    let (targets, ground) = (level(targets), level(ground));
    if targets.is_empty() || ground.is_empty() {
        return None;
    }
    let drawn: Vec<f64> = (0..resamples as u64)
        .into_par_iter()
        .map(|resample| {
            let mut counts = vec![[0_u32; 2]; levels.len()];
            for (side, of) in [&targets, &ground].into_iter().enumerate() {
                for n in 0..of.len() {
                    let key = [RESAMPLING, seed, resample, side as u64, n as u64];
                    counts[of[index(unit_noise(&key), of.len())]][side] += 1;
                }
            }
            let (mut wins, mut below) = (0.0, 0.0);
            for [hit, missed] in counts {
                wins += f64::from(hit) * (below + f64::from(missed) / 2.0);
                below += f64::from(missed);
            }
            wins / (targets.len() as f64 * ground.len() as f64)
        })
        .collect();
    ends(drawn)
}

/// What is drawn anew in a bootstrap of groups.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Groups {
    /// Targets and ground have the same groups, drawn together: what lies about one stop comes or stays away as one.
    Shared,
    /// Each side has its own.
    Apart,
}

/// The AUC in resamples of the bootstrap of groups (Field and Welsh 2007), for [`ends`]: whole groups are drawn with
/// replacement, all their members with them. The draws hang on the groups and the seed alone, so that two scores of the
/// same targets and ground are resampled alike, and their differences can be taken one by one.
pub(crate) fn by_group(
    targets: &[Scored],
    ground: &[Scored],
    groups: Groups,
    resamples: usize,
    seed: u64,
) -> Vec<f64> {
    let (targets, ground) = (grouped(targets), grouped(ground));
    // Shared groups are all there are: one with ground and no target is drawn as well.
    let all: Vec<usize> = {
        let mut all: Vec<usize> = targets.keys().chain(ground.keys()).copied().collect();
        all.sort_unstable();
        all.dedup();
        all
    };
    let keys = |of: &BTreeMap<usize, Vec<f64>>| -> Vec<usize> {
        if groups == Groups::Shared { all.clone() } else { of.keys().copied().collect() }
    };
    let (target_keys, ground_keys) = (keys(&targets), keys(&ground));
    let members = |of: &BTreeMap<usize, Vec<f64>>, keys: &[usize]| -> Vec<Vec<f64>> {
        keys.iter().map(|key| of.get(key).cloned().unwrap_or_default()).collect()
    };
    let (targets, ground) = (members(&targets, &target_keys), members(&ground, &ground_keys));
    let wins: Vec<Vec<f64>> = targets
        .par_iter()
        .map(|hits| {
            let over = |missed: &Vec<f64>| hits.iter().map(|score| above(*score, missed)).sum();
            ground.iter().map(over).collect()
        })
        .collect();
    let count = |of: &[Vec<f64>]| -> Vec<f64> { of.iter().map(|g| g.len() as f64).collect() };
    let (hits, misses) = (count(&targets), count(&ground));
    (0..resamples as u64)
        .into_par_iter()
        .filter_map(|resample| {
            let weights = |side: u64, groups: usize| {
                let mut weights = vec![0.0; groups];
                for n in 0..groups as u64 {
                    let unit = unit_noise(&[RESAMPLING, seed, resample, side, n]);
                    weights[index(unit, groups)] += 1.0;
                }
                weights
            };
            let of_targets = weights(2, targets.len());
            let of_ground = if groups == Groups::Shared {
                of_targets.clone()
            } else {
                weights(3, ground.len())
            };
            let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            let pairs = dot(&of_targets, &hits) * dot(&of_ground, &misses);
            let won: f64 = of_targets
                .iter()
                .zip(&wins)
                .map(|(weight, row)| weight * dot(row, &of_ground))
                .sum();
            // All groups drawn may be without a target.
            (pairs > 0.0).then(|| won / pairs)
        })
        .collect()
}

/// The scores of each group, sorted.
fn grouped(scored: &[Scored]) -> BTreeMap<usize, Vec<f64>> {
    let mut groups: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
    for Scored { score, group } in scored {
        groups.entry(*group).or_default().push(*score);
    }
    for scores in groups.values_mut() {
        scores.sort_unstable_by(f64::total_cmp);
    }
    groups
}

/// 95 % interval of a share by the bootstrap of groups: of each group how many are counted, and how many of them hit.
pub(crate) fn share_by_group(
    groups: &[(usize, usize)],
    resamples: usize,
    seed: u64,
) -> Option<Ends> {
    let drawn = (0..resamples as u64)
        .filter_map(|resample| {
            let (mut hits, mut count) = (0, 0);
            for n in 0..groups.len() as u64 {
                let unit = unit_noise(&[RESAMPLING, seed, resample, 4, n]);
                let (all, hit) = groups[index(unit, groups.len())];
                count += all;
                hits += hit;
            }
            (count > 0).then(|| hits as f64 / count as f64)
        })
        .collect();
    ends(drawn)
}

fn index(unit: f64, count: usize) -> usize {
    // The product may round up to the count.
    ((unit * count as f64) as usize).min(count - 1)
}

/// The middle 95 % of some resampled values; none without any.
pub(crate) fn ends(mut drawn: Vec<f64>) -> Option<Ends> {
    drawn.sort_unstable_by(f64::total_cmp);
    let outside = (TAIL * drawn.len() as f64) as usize;
    let last = drawn.len().checked_sub(1)?;
    Some(Ends { low: drawn[outside], high: drawn[last - outside] })
}
