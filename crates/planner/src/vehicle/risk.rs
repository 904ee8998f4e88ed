//! How far beyond its mean a quantity is judged: conditional value at risk.

/// `CVaR_a` of the standard normal, `φ(Φ⁻¹(a))/(1 − a)`: the mean of the worst share 1 − a of its draws
/// (Rockafellar and Uryasev 2000). It grows with `a` in [0, 1) from 0, the mean, without bound.
pub(crate) fn cvar_of_standard_normal(a: f64) -> f64 {
    if a == 0.0 {
        return 0.0;
    }
    // The density is the same at both tails; the smaller one keeps its digits.
    let x = upper_quantile(a.min(1.0 - a));
    let density = libm::exp(-0.5 * x * x) / libm::sqrt(2.0 * std::f64::consts::PI);
    density / (1.0 - a)
}

/// The x ≥ 0 above which a standard normal lies with a probability of `tail`, at most 1/2: by bisection, until
/// the bounds are neighbours.
fn upper_quantile(tail: f64) -> f64 {
    // Beyond 40 the tail is smaller than any f64.
    let (mut low, mut high) = (0.0, 40.0);
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return middle;
        }
        if 0.5 * libm::erfc(middle * std::f64::consts::FRAC_1_SQRT_2) > tail {
            low = middle;
        } else {
            high = middle;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Printed tables of the normal's expected shortfall: 0.9 and 0.95 are 1.755 and 2.063, a half √(2/π).
    #[test]
    fn the_worst_tenth_of_a_normal_lies_1755_sigma_out() {
        assert_eq!(cvar_of_standard_normal(0.0), 0.0);
        assert!((cvar_of_standard_normal(0.5) - (2.0 / std::f64::consts::PI).sqrt()).abs() < 1e-12);
        assert!((cvar_of_standard_normal(0.9) - 1.754_983_319_324_868).abs() < 1e-12);
        assert!((cvar_of_standard_normal(0.95) - 2.062_712_807_507_3).abs() < 1e-9);
        assert!((cvar_of_standard_normal(0.99) - 2.665_214_220_345_8).abs() < 1e-9);
    }

    /// By definition: the mean of the worst draws, summed over the tail.
    #[test]
    fn the_closed_form_is_the_mean_of_the_tail() {
        for a in [0.01_f64, 0.2, 0.5, 0.8, 0.999] {
            let tail = a.min(1.0 - a);
            let x = upper_quantile(tail);
            let from = if a < 0.5 { -x } else { x };
            let width = 1e-4;
            let density = |t: f64| (-0.5 * t * t).exp() / (2.0 * std::f64::consts::PI).sqrt();
            let steps = ((12.0 - from) / width) as usize;
            let sum: f64 = (0..steps)
                .map(|i| from + (i as f64 + 0.5) * width)
                .map(|t| t * density(t) * width)
                .sum();
            assert!((cvar_of_standard_normal(a) - sum / (1.0 - a)).abs() < 1e-6, "{a}");
        }
    }

    #[test]
    fn the_margin_is_finite_and_grows_over_the_whole_range() {
        let levels =
            [0.0, 5e-324, 1e-300, 1e-9, 0.1, 0.5, 0.9, 0.999_999, 1.0 - f64::EPSILON / 2.0];
        let margins = levels.map(cvar_of_standard_normal);
        assert!(margins.windows(2).all(|pair| pair[0] <= pair[1]), "{margins:?}");
        assert!(margins[8] > 8.0 && margins[8] < 9.0);
    }
}
