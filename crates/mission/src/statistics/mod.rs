//! What a campaign's numbers are worth: whether stated probabilities come true ([`Calibration`]), and intervals
//! for means and paired differences ([`mean_interval`], [`paired_difference`]).
//!
//! Everything here is a pure function of its arguments: same numbers, same bits, at any thread count.
//!
//! ```
//! use wisdom_mission::statistics::{Calibration, Forecast, paired_difference};
//!
//! // Sixty legs said to arrive with a chance of 0.75, and 45 that did.
//! let legs: Vec<Forecast> =
//!     (0..60).map(|leg| Forecast { predicted: 0.75, happened: leg % 4 != 0 }).collect();
//! let calibration = Calibration::of(&legs, 10).expect("there are legs");
//! assert_eq!(calibration.happened, 45);
//! // As good as true forecasts can be: the score is what it should be, p(1 − p).
//! assert!((calibration.brier.score - 0.1875).abs() < 1e-12);
//! assert!((calibration.brier.expected - 0.1875).abs() < 1e-12);
//!
//! // Two rules in the same five worlds.
//! let gain = paired_difference(&[3.0, 5.0, 4.0, 6.0, 2.0], &[2.0, 4.5, 3.0, 5.0, 1.5], 1000, 7);
//! assert!(gain.is_some_and(|gain| gain.low > 0.0));
//! ```

mod bootstrap;
mod calibration;
mod distribution;

pub use bootstrap::{mean_interval, paired_difference};
pub use calibration::{Bin, Brier, Calibration, Forecast, HosmerLemeshow, Spiegelhalter, brier};
pub use distribution::{chi_square_survival, normal_two_sided, wilson};

/// A mean or a share with its 95 % confidence interval, in the unit of what was averaged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// The mean, or the share observed.
    pub mean: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}
