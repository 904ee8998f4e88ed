//! Counter-based noise: a pure function of its key, with no generator state to carry or to share.
//!
//! The key's words are absorbed one by one, each followed by the finaliser of `SplitMix64` (Steele, Lea and
//! Flood, 2014), whose constants are Stafford's variant 13. A number therefore depends on its key
//! alone: not on the order of calls, the number of threads, or what else was drawn.

/// The odd 64-bit integer nearest 2⁶⁴ / golden ratio: `SplitMix64`'s increment.
const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;

/// 2⁻⁵³, the spacing of the numbers [`unit_noise`] returns.
const UNIT_STEP: f64 = 1.0 / 9_007_199_254_740_992.0;

/// A uniform number in [0, 1), fixed by its key, such as `[seed, purpose, layer, cell, look]`.
///
/// ```
/// # use wisdom_terrain::unit_noise;
/// assert_eq!(unit_noise(&[7, 1, 2]), unit_noise(&[7, 1, 2]));
/// assert_ne!(unit_noise(&[7, 1, 2]), unit_noise(&[7, 2, 1]));
/// ```
#[must_use]
pub fn unit_noise(key: &[u64]) -> f64 {
    unit(absorb(key))
}

/// A normal number of mean 0 and standard deviation 1, fixed by its key (Box and Muller, 1958).
///
/// Its largest magnitude is 8.6, as the uniform number under the logarithm is at least 2⁻⁵³.
#[must_use]
pub fn normal_noise(key: &[u64]) -> f64 {
    let state = absorb(key);
    let radius = libm::sqrt(-2.0 * libm::log(1.0 - unit(mix(state, 1))));
    radius * libm::cos(std::f64::consts::TAU * unit(mix(state, 2)))
}

fn absorb(key: &[u64]) -> u64 {
    key.iter().fold(0, |state, &word| mix(state, word))
}

fn unit(bits: u64) -> f64 {
    (bits >> 11) as f64 * UNIT_STEP
}

/// One word taken into the state. The increment keeps a zero word from leaving a zero state alone.
fn mix(state: u64, word: u64) -> u64 {
    let mut z = (state ^ word.wrapping_mul(GOLDEN)).wrapping_add(GOLDEN);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    const DRAWS: u64 = 100_000;

    #[test]
    fn the_finaliser_is_splitmix64() {
        // First output of SplitMix64 from state 0, as published with its reference implementation.
        assert_eq!(mix(0, 0), 0xE220_A839_7B1D_CDAF);
    }

    #[test]
    fn unit_noise_is_uniform_over_neighbouring_keys() {
        let mut bins = [0_u32; 20];
        for i in 0..DRAWS {
            bins[(unit_noise(&[3, 1, i]) * 20.0) as usize] += 1;
        }
        // Chi-squared with 19 degrees of freedom exceeds 50 with a probability below 2e-4.
        let expected = DRAWS as f64 / 20.0;
        let chi: f64 = bins.iter().map(|&n| (f64::from(n) - expected).powi(2) / expected).sum();
        assert!(chi < 50.0, "chi-squared {chi}");
    }

    #[test]
    fn seeds_and_cells_that_differ_by_one_bit_are_uncorrelated() {
        for (a, b) in [([1, 0], [2, 0]), ([1, 0], [1, 1]), ([0, 5], [0, 4])] {
            let sum: f64 = (0..DRAWS)
                .map(|i| {
                    (unit_noise(&[a[0], a[1], i]) - 0.5) * (unit_noise(&[b[0], b[1], i]) - 0.5)
                })
                .sum();
            // The correlation's standard error is 1/sqrt(DRAWS) = 0.003; 0.015 is five of them.
            let correlation = sum / DRAWS as f64 * 12.0;
            assert!(correlation.abs() < 0.015, "{a:?} {b:?}: {correlation}");
        }
    }

    #[test]
    fn normal_noise_has_mean_zero_variance_one_and_normal_tails() {
        let draws: Vec<f64> = (0..DRAWS).map(|i| normal_noise(&[9, i])).collect();
        let n = DRAWS as f64;
        let mean = draws.iter().sum::<f64>() / n;
        let variance = draws.iter().map(|z| z * z).sum::<f64>() / n;
        let tail = draws.iter().filter(|z| z.abs() > 1.959_964).count() as f64 / n;
        assert!(mean.abs() < 0.016 && (variance - 1.0).abs() < 0.023, "{mean} {variance}");
        assert!((tail - 0.05).abs() < 0.0035, "{tail}");
    }

    #[test]
    fn an_empty_key_is_a_key_too() {
        assert!((0.0..1.0).contains(&unit_noise(&[])));
        assert!(normal_noise(&[]).is_finite());
    }
}
