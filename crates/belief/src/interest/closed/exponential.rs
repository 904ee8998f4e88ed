//! eˣ from + − × and the exponent bits: the same bits in every lane and on every machine.

use super::lanes::Lanes;

/// Lanes whose exponent can be moved.
pub(crate) trait Binary: Lanes {
    /// The constants of its format.
    const FORMAT: &'static Format;

    /// `self · 2ⁿ`, where n are the last bits of `shifted`, a sum of n and [`Format::shifter`].
    fn scaled(self, shifted: Self) -> Self;
}

/// What eˣ needs to know of a floating-point format.
#[derive(Debug)]
pub(crate) struct Format {
    /// Bits of the mantissa that are stored.
    mantissa_bits: u32,
    /// 1.5 times two to the mantissa's length: adding it rounds to a whole number.
    shifter: f64,
    /// ln 2 to so few bits that its product with any exponent is exact.
    ln_2_high: f64,
    /// The rest of ln 2.
    ln_2_low: f64,
    /// Below it eˣ is (all but) the smallest normal number, and taken for this one's.
    lowest: f64,
    /// Degree of the Taylor polynomial: its first missing term is below half a unit in the last place
    /// at |x| = ln 2 / 2.
    degree: u32,
}

impl Format {
    /// How far to shift a whole number to add it to the exponent.
    #[inline(always)]
    pub(crate) fn mantissa_bits(&self) -> u32 {
        self.mantissa_bits
    }
}

/// f32: 24 bits.
const SINGLE: Format = Format {
    mantissa_bits: 23,
    shifter: 12_582_912.0,
    ln_2_high: 0.693_359_375,
    ln_2_low: -2.121_944_400_546_905_8e-4,
    lowest: -86.0,
    degree: 7,
};

/// f64: 53 bits.
const DOUBLE: Format = Format {
    mantissa_bits: 52,
    shifter: 6_755_399_441_055_744.0,
    ln_2_high: 0.693_145_751_953_125,
    ln_2_low: 1.428_606_820_309_417_2e-6,
    lowest: -700.0,
    degree: 13,
};

impl Binary for f32 {
    const FORMAT: &'static Format = &SINGLE;

    #[inline(always)]
    fn scaled(self, shifted: Self) -> Self {
        Self::from_bits(self.to_bits().wrapping_add(shifted.to_bits() << SINGLE.mantissa_bits))
    }
}

impl Binary for f64 {
    const FORMAT: &'static Format = &DOUBLE;

    #[inline(always)]
    fn scaled(self, shifted: Self) -> Self {
        Self::from_bits(self.to_bits().wrapping_add(shifted.to_bits() << DOUBLE.mantissa_bits))
    }
}

/// eˣ for x ≤ 0, within 2 units in the last place down to [`Format::lowest`].
#[inline(always)]
pub(crate) fn exponential<L: Binary>(x: L) -> L {
    let Format { shifter, ln_2_high, ln_2_low, lowest, degree, .. } = *L::FORMAT;
    let x = x.upper(x.value(lowest));
    let shifter = x.value(shifter);
    let shifted = x * x.value(std::f64::consts::LOG2_E) + shifter;
    let exponent = shifted - shifter;
    let rest = (x - exponent * x.value(ln_2_high)) - exponent * x.value(ln_2_low);
    taylor(rest, degree).scaled(shifted)
}

/// 1 + x(1 + x/2 (1 + x/3 (…))), with the reciprocal factorials as constants.
#[inline(always)]
fn taylor<L: Lanes>(x: L, degree: u32) -> L {
    let mut sum = x.value(RECIPROCAL_FACTORIALS[degree as usize]);
    for term in (0..degree).rev() {
        sum = sum * x + x.value(RECIPROCAL_FACTORIALS[term as usize]);
    }
    sum
}

const RECIPROCAL_FACTORIALS: [f64; 14] = {
    let mut terms = [1.0; 14];
    let mut n = 1;
    let mut factorial = 1.0;
    while n < 14 {
        factorial *= n as f64;
        terms[n] = 1.0 / factorial;
        n += 1;
    }
    terms
};

#[cfg(test)]
mod tests {
    use super::exponential;

    #[test]
    fn e_to_the_x_is_within_two_units_in_the_last_place() {
        for step in 0..700_000 {
            let x = -f64::from(step) * 1e-3 - 1e-4 * f64::from(step % 7);
            if x < -700.0 {
                break;
            }
            let exact = libm::exp(x);
            assert!((exponential(x) - exact).abs() <= 2.0 * f64::EPSILON * exact, "{x}");
        }
    }

    #[test]
    fn e_to_the_x_in_single_precision_is_within_two_units_in_the_last_place() {
        for step in 0..86_000 {
            let x = -(step as f32) * 1e-3;
            let exact = libm::exp(f64::from(x));
            let error = (f64::from(exponential(x)) - exact).abs();
            assert!(error <= 2.0 * f64::from(f32::EPSILON) * exact, "{x}");
        }
    }

    #[test]
    fn e_to_the_minus_much_is_almost_nothing() {
        assert!(exponential(-1e9_f64) < 1e-300 && exponential(-1e9_f32) < 1e-37);
        assert_eq!((exponential(0.0_f64), exponential(0.0_f32)), (1.0, 1.0));
    }
}
