//! Percentile bootstrap (Efron 1979): what a mean would be, had other worlds been drawn.

use rayon::prelude::*;
use wisdom_terrain::unit_noise;

use super::Interval;

/// First word of every key drawn here, so that no draw is one of a world's with the same seed.
const RESAMPLING: u64 = 0xB007;

/// Share of the resampled means left out at either end of a 95 % interval.
const TAIL: f64 = 0.025;

/// The mean of some values, with its 95 % interval by the percentile bootstrap (Efron 1979); in the values' unit.
///
/// Each of `resamples` samples draws as many values as there are, with replacement; the interval holds the middle 95 %
/// of their means. It takes the values for independent draws from one distribution, and is a little short for few of
/// them: for 50 normal values it covers the true mean in 94 % of cases. A thousand resamples steady its ends to
/// about a tenth of its width. A single value makes an interval of no width.
///
/// The n-th draw of a resample is keyed by `seed`, the resample's number and n, so the interval has the same bits at
/// any thread count.
///
/// None without values or resamples, or if a value is not finite.
#[must_use]
pub fn mean_interval(values: &[f64], resamples: usize, seed: u64) -> Option<Interval> {
    if values.is_empty() || resamples == 0 || !values.iter().all(|value| value.is_finite()) {
        return None;
    }
    let count = values.len();
    let drawn = |resample: usize, n: usize| {
        let unit = unit_noise(&[RESAMPLING, seed, resample as u64, n as u64]);
        // The product may round up to the count.
        values[((unit * count as f64) as usize).min(count - 1)]
    };
    let mut means: Vec<f64> = (0..resamples)
        .into_par_iter()
        .map(|resample| mean((0..count).map(|n| drawn(resample, n)), count))
        .collect();
    means.sort_unstable_by(f64::total_cmp);
    let outside = (TAIL * resamples as f64) as usize;
    Some(Interval {
        mean: mean(values.iter().copied(), count),
        low: means[outside],
        high: means[resamples - 1 - outside],
    })
}

/// The mean of `a − b` over pairs, with its 95 % interval by [`mean_interval`] of the differences; in the values' unit.
///
/// Pairs are two runs in the same world: what the world adds to both falls out of the difference, and the interval is
/// shorter than that of two means held side by side. An interval without 0 says that the two differ.
///
/// None without pairs or resamples, or if a difference is not finite.
///
/// # Panics
/// If `a` and `b` differ in length: then they are no pairs.
#[must_use]
pub fn paired_difference(a: &[f64], b: &[f64], resamples: usize, seed: u64) -> Option<Interval> {
    assert_eq!(a.len(), b.len(), "pairs have two sides");
    let differences: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
    mean_interval(&differences, resamples, seed)
}

fn mean(values: impl Iterator<Item = f64>, count: usize) -> f64 {
    values.fold(0.0, |sum, value| sum + value) / count as f64
}
