//! How far two points of an instance are apart, as its source counts.

/// Lengths are whole multiples of a unit wherever the source rounds them, so that sums are exact and a budget that fits
/// to the last digit is not lost.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Metric {
    /// Straight, not rounded (Tsiligirides 1984; Chao, Golden, Wasil 1996).
    Exact,
    /// Straight, to the nearest whole number: `EUC_2D` (TSPLIB, Reinelt 1991).
    Nearest,
    /// Straight, up to a whole number: `CEIL_2D` (TSPLIB).
    Up,
    /// Straight over √10, up to a whole number: `ATT` (TSPLIB).
    PseudoEuclidean,
    /// Kilometres on a sphere between points given as degrees.minutes: `GEO` (TSPLIB).
    Geographical,
    /// Straight, down to tenths; the unit is a tenth (windows after Solomon: Righini, Salani 2009).
    DownToTenths,
    /// Straight, down to hundredths; the unit is a hundredth (windows after Cordeau).
    DownToHundredths,
}

/// Added before rounding down. A straight line can be a whole number of units, and floating point a bit less. Points of at
/// most three decimals miss a whole number by more than 1e-8 if their lines are shorter than 100 000.
const WHOLE: f64 = 1e-9;

impl Metric {
    /// How many units are 1 in the file.
    pub(crate) fn units_per_one(self) -> f64 {
        match self {
            Self::DownToTenths => 10.0,
            Self::DownToHundredths => 100.0,
            _ => 1.0,
        }
    }

    /// A number of the file (a limit, a time) in units; whole if it is whole but for the rounding of decimals.
    pub(crate) fn units(self, value: f64) -> f64 {
        let units = value * self.units_per_one();
        let whole = units.round();
        if (units - whole).abs() <= f64::EPSILON * whole.abs() { whole } else { units }
    }

    /// From point to point (x, y), in units.
    pub(crate) fn length(self, from: (f64, f64), to: (f64, f64)) -> f64 {
        let (dx, dy) = (from.0 - to.0, from.1 - to.1);
        let squared = dx * dx + dy * dy;
        match self {
            Self::Exact => squared.sqrt(),
            Self::Nearest => (squared.sqrt() + 0.5).floor(),
            Self::Up => squared.sqrt().ceil(),
            Self::PseudoEuclidean => {
                let length = (squared / 10.0).sqrt();
                let nearest = (length + 0.5).floor();
                if nearest < length { nearest + 1.0 } else { nearest }
            }
            Self::Geographical => geographical(from, to),
            Self::DownToTenths | Self::DownToHundredths => {
                (squared.sqrt() * self.units_per_one() + WHOLE).floor()
            }
        }
    }
}

/// The library's own formula, with its own values of π and the radius: others give other whole numbers.
fn geographical(from: (f64, f64), to: (f64, f64)) -> f64 {
    const RADIUS_KM: f64 = 6378.388;
    let ((latitude, longitude), (other_latitude, other_longitude)) = (angles(from), angles(to));
    let q1 = libm::cos(longitude - other_longitude);
    let q2 = libm::cos(latitude - other_latitude);
    let q3 = libm::cos(latitude + other_latitude);
    // Rounding may pass one by a bit, where the arc cosine ends.
    let cosine = (0.5 * ((1.0 + q1) * q2 - (1.0 - q1) * q3)).clamp(-1.0, 1.0);
    (RADIUS_KM * libm::acos(cosine) + 1.0).floor()
}

/// Latitude and longitude in radians; 38.24 means 38 degrees and 24 minutes.
fn angles((latitude, longitude): (f64, f64)) -> (f64, f64) {
    #[expect(clippy::approx_constant, reason = "the lengths are defined with this value of π")]
    const PI: f64 = 3.141_592;
    let radians = |given: f64| {
        let degrees = given.trunc();
        PI * (degrees + 5.0 * (given - degrees) / 3.0) / 180.0
    };
    (radians(latitude), radians(longitude))
}

#[cfg(test)]
mod tests {
    use super::*;

    const O: (f64, f64) = (0.0, 0.0);

    #[test]
    fn lengths_round_as_their_source_says() {
        for (metric, to, length) in [
            (Metric::Exact, (3.0, 4.0), 5.0),
            (Metric::Exact, (1.0, 1.0), std::f64::consts::SQRT_2),
            (Metric::Nearest, (1.0, 1.0), 1.0),
            (Metric::Nearest, (1.5, 2.0), 3.0), // 2.5: halves go up
            (Metric::Up, (1.0, 1.0), 2.0),
            (Metric::Up, (3.0, 4.0), 5.0),
            (Metric::PseudoEuclidean, (30.0, 10.0), 10.0),
            (Metric::PseudoEuclidean, (33.0, 10.0), 11.0), // 10.9
            (Metric::PseudoEuclidean, (31.0, 10.0), 11.0), // 10.3 rounds to 10, which is less
            (Metric::DownToTenths, (1.0, 1.0), 14.0),
            (Metric::DownToTenths, (3.0, 4.0), 50.0),
            (Metric::DownToHundredths, (1.0, 1.0), 141.0),
            (Metric::DownToHundredths, (0.003, 0.004), 0.0),
            (Metric::DownToHundredths, (0.042, 0.056), 7.0), // 0.07 to the digit
        ] {
            assert_eq!(metric.length(O, to), length, "{metric:?} to {to:?}");
            assert_eq!(metric.length(to, O), length, "{metric:?} from {to:?}");
        }
    }

    /// `ulysses16` of TSPLIB: the length of its optimal tour is published as 6859.
    #[test]
    fn the_shortest_way_of_ulysses_is_as_long_as_published() {
        const TOUR: [(f64, f64); 16] = [
            (38.24, 20.42),
            (37.51, 15.17),
            (38.15, 15.35),
            (38.47, 15.13),
            (38.42, 13.11),
            (37.56, 12.19),
            (35.49, 14.32),
            (33.48, 10.54),
            (36.08, -5.21),
            (41.23, 9.10),
            (41.17, 13.05),
            (39.36, 19.56),
            (40.56, 25.32),
            (39.57, 26.15),
            (36.26, 23.12),
            (37.52, 20.44),
        ];
        let leg = |i: usize| Metric::Geographical.length(TOUR[i], TOUR[(i + 1) % TOUR.len()]);
        assert_eq!((0..TOUR.len()).map(leg).sum::<f64>(), 6859.0);
    }

    #[test]
    fn a_time_of_decimals_is_a_whole_number_of_units() {
        assert_eq!(Metric::DownToTenths.units(1.1), 11.0);
        assert_eq!(Metric::DownToHundredths.units(0.29), 29.0);
        assert_eq!(Metric::DownToTenths.units(0.25), 2.5);
        assert_eq!(Metric::Exact.units(0.1), 0.1);
    }
}
