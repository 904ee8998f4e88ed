//! Tail probabilities, and the interval of a share.

use std::f64::consts::SQRT_2;

use super::Interval;

/// Φ⁻¹(0.975): 95 % of a normal variable lies within this many standard deviations of its mean.
const Z_95: f64 = 1.959_963_984_540_054;

/// Chance that a chi-square variable with `degrees_of_freedom` exceeds `x`: 1 for `x` ≤ 0, and 0 for any other `x`
/// without degrees of freedom.
///
/// By the finite sums for a whole number of degrees of freedom (Abramowitz and Stegun 1964, 26.4.4 and 26.4.5). With
/// h = x/2 they are Σ hⁱe⁻ʰ/Γ(i + 1), over i = 0, 1, … below k/2 for even k; over i = 1/2, 3/2, … for odd k, with
/// erfc √h on top. No term is negative, so nothing cancels.
///
/// ```
/// # use wisdom_mission::statistics::chi_square_survival;
/// // The 5 % point of ten degrees of freedom (Abramowitz and Stegun 1964, table 26.8).
/// assert!((chi_square_survival(18.3070, 10) - 0.05).abs() < 1e-6);
/// ```
#[must_use]
pub fn chi_square_survival(x: f64, degrees_of_freedom: usize) -> f64 {
    if x <= 0.0 {
        return 1.0;
    }
    if x == f64::INFINITY {
        return 0.0;
    }
    let half = 0.5 * x;
    let odd = degrees_of_freedom % 2 == 1;
    let (start, begin) = if odd { (libm::erfc(libm::sqrt(half)), 0.5) } else { (0.0, 0.0) };
    let log = libm::log(half);
    let terms = (0..degrees_of_freedom / 2).map(|i| {
        let power = i as f64 + begin;
        libm::exp(power * log - half - libm::lgamma(power + 1.0))
    });
    // The sum may round past 1.
    terms.fold(start, |sum, term| sum + term).min(1.0)
}

/// Chance that a standard normal variable lies further from 0 than `z`, on either side: erfc(|z|/√2).
#[must_use]
pub fn normal_two_sided(z: f64) -> f64 {
    libm::erfc(libm::fabs(z) / SQRT_2)
}

/// The share `happened / count` with its score interval at 95 % (Wilson 1927); none if `count` is 0.
///
/// Its ends are the shares that a test at the 5 % level would just not reject, `(p + z²/2n ± z·√(p(1−p)/n + z²/4n²)) /
/// (1 + z²/n)`. They stay in [0, 1], and it keeps its width where all or nothing happened.
///
/// # Panics
/// If more happened than was counted.
#[must_use]
pub fn wilson(happened: usize, count: usize) -> Option<Interval> {
    assert!(happened <= count, "{happened} of {count} happened");
    if count == 0 {
        return None;
    }
    let n = count as f64;
    let share = happened as f64 / n;
    let square = Z_95 * Z_95 / n;
    let middle = share + 0.5 * square;
    let reach = libm::sqrt(square * (share * (1.0 - share) + 0.25 * square));
    // All and nothing are their own ends; rounding must not move them past.
    let low = if happened == 0 { 0.0 } else { (middle - reach) / (1.0 + square) };
    let high = if happened == count { 1.0 } else { (middle + reach) / (1.0 + square) };
    Some(Interval { mean: share, low, high })
}
