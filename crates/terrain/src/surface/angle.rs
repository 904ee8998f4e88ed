//! Angles of many gradients at once.

use super::width::{Job, Single, Width};

/// Degrees of atan(t) = t·P(t²) for t in [0, 1], P's coefficients from the lowest power on: a minimax fit by
/// Lawson's weights, off by at most 3.8e-8 rad before rounding.
const ATAN_DEG: [f32; 8] = [
    57.295_742,
    -19.096_603,
    11.428_54,
    -7.969_057,
    5.524_571_4,
    -3.203_539_6,
    1.252_654_8,
    -0.232_309_46,
];

/// Rises over run, not negative, to be turned into the degrees of their slope: off by at most 2e-7 rad; level ground has
/// 0 and a rise of one 45 exactly.
pub(super) struct Degrees<'a>(pub(super) &'a mut [f32]);

impl Job for Degrees<'_> {
    #[inline(always)]
    fn run<W: Width>(self, w: W) {
        let mut col = 0;
        while col + W::CELLS <= self.0.len() {
            w.store(degrees_of(w, w.load(self.0, col)), self.0, col);
            col += W::CELLS;
        }
        for value in &mut self.0[col..] {
            *value = degrees_of(Single, *value);
        }
    }
}

#[inline(always)]
fn degrees_of<W: Width>(w: W, rise: W::Lanes) -> W::Lanes {
    let one = w.splat(1.0);
    // Beyond 45 degrees the complement is taken: atan(x) = 90° − atan(1/x).
    let t = w.smaller(rise, one) / w.larger(rise, one);
    let square = t * t;
    let [lower @ .., highest] = ATAN_DEG;
    let mut sum = w.splat(highest);
    for coefficient in lower.into_iter().rev() {
        sum = sum * square + w.splat(coefficient);
    }
    let angle = sum * t;
    w.where_above(rise, one, w.splat(90.0) - angle, angle)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn degrees_single(rise: f32) -> f64 {
        f64::from(degrees_of(Single, rise))
    }

    /// The bound that the docs state, over every scale: each float's high bits with some of its low ones.
    #[test]
    fn an_angle_is_within_2e_7_rad_of_the_arctangent() {
        for high in 0..=0x7f7f_u32 {
            for low in [0, 0x0123, 0x5555, 0x8000, 0xcccc, 0xffff] {
                let rise = f32::from_bits(high << 16 | low);
                let off = degrees_single(rise) - libm::atan(f64::from(rise)).to_degrees();
                assert!(off.to_radians().abs() < 2e-7, "{rise} is off by {off} degrees");
            }
        }
    }

    #[test]
    fn level_ground_a_rise_of_one_and_a_wall_have_exact_angles() {
        for (rise, expected) in [(0.0, 0.0), (1.0, 45.0), (f32::MAX, 90.0)] {
            assert_eq!(degrees_single(rise), expected);
        }
    }
}
