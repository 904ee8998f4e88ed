//! How much the wheels slip, by slope and by what they roll on.

use schemars::JsonSchema;
use serde::Deserialize;

use super::{BELOW_ONE, NOT_NEGATIVE, Vehicle};
use crate::PlannerError;

/// Largest class, either sign, that a reading (an `f32`) holds exactly.
const MAX_CLASS: u32 = 1 << 24;

/// Slopes below this share of where slip reaches its limit need no second look: rounding is far smaller.
const SURE: f64 = 1.0 - 1e-9;

/// A base closer to the limit than this (ln of their ratio) leaves [`SURE`] too little room.
const LEAST_ROOM: f64 = 1e-4;

/// Slopes steeper than this are always looked at: their grade outgrows what [`SURE`] allows for.
const MOST_SURE_DEG: f64 = 89.0;

/// Slip on the ground of one terrain class, in place of [`Vehicle::slip_base`] and
/// [`Vehicle::slip_growth_per_deg`].
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct SlipClass {
    /// The class, as readings of the class layer give it.
    pub class: i32,
    /// What the class is, for people; may be empty.
    #[serde(default)]
    pub name: String,
    /// Slip on flat ground, as a share of the wheels' way.
    pub base: f64,
    /// Growth rate of slip with the slope, per degree.
    pub growth_per_deg: f64,
}

/// `min(1, base·exp(growth·slope))`.
#[derive(Debug, Clone, Copy)]
struct Curve {
    base: f64,
    growth_per_deg: f64,
}

impl Curve {
    fn slip(self, slope_deg: f64) -> f64 {
        (self.base * libm::exp(self.growth_per_deg * slope_deg)).min(1.0)
    }

    /// A slope in degrees below which slip stays under a limit, whatever the rounding; infinite if it always does.
    fn sure_deg(self, slip_max: f64) -> f64 {
        if self.growth_per_deg == 0.0 {
            return f64::INFINITY;
        }
        let room = libm::log(slip_max / self.base);
        if room < LEAST_ROOM { 0.0 } else { SURE * (room / self.growth_per_deg).min(MOST_SURE_DEG) }
    }
}

impl Vehicle {
    /// Slip on a slope, as a share of the wheels' way: `min(1, base·exp(growth·slope))`. Slopes driven down
    /// are negative and slip less than flat ground. Holds where nothing is said of classes.
    #[must_use]
    pub fn slip(&self, slope_deg: f64) -> f64 {
        self.default_curve().slip(slope_deg)
    }

    /// Slip on a slope where ground of a class was read with uncertainty `u`, as a share of the wheels' way:
    /// `(1 − u)·slip of the class + u·the worst slip of all curves at that slope`.
    ///
    /// Classes not listed in [`Vehicle::slip_class`] slip as [`Vehicle::slip`]. It grows with the slope and with
    /// `u`: what a class is not known to be, it is taken to be at its worst, so knowing more never hurts. (Mixing
    /// classes by their probability follows Inotsume et al. 2020 and Endo et al. 2023; giving all the
    /// rest to the worst is the bound that holds whatever the others' probabilities are.)
    ///
    /// ```
    /// use wisdom_planner::{SlipClass, Vehicle};
    ///
    /// let sand = SlipClass { class: 3, name: "loose sand".into(), base: 0.035, growth_per_deg: 0.17 };
    /// let vehicle = Vehicle { slip_class: vec![sand], ..Vehicle::default() };
    /// // Class 1 is not listed; half known, it slips half as the default and half as sand.
    /// let slip = vehicle.slip_on(1.0, 0.5, 0.0);
    /// assert!((slip - (0.5 * 0.01 + 0.5 * 0.035)).abs() < 1e-12);
    /// ```
    #[must_use]
    pub fn slip_on(&self, class: f32, u: f32, slope_deg: f64) -> f64 {
        let (class, u) = (f64::from(class), f64::from(u));
        let known = self.curve_of(class).slip(slope_deg);
        if u == 0.0 {
            return known;
        }
        let worst = self.curves().map(|curve| curve.slip(slope_deg)).fold(known, f64::max);
        if u == 1.0 {
            return worst;
        }
        // In this form rounding cannot make slip fall where u grows.
        (known + u * (worst - known)).min(worst)
    }

    fn default_curve(&self) -> Curve {
        Curve { base: self.slip_base, growth_per_deg: self.slip_growth_per_deg }
    }

    fn curve_of(&self, class: f64) -> Curve {
        let listed = self.slip_class.iter().find(|listed| f64::from(listed.class) == class);
        listed.map_or_else(|| self.default_curve(), SlipClass::curve)
    }

    /// Every curve, the default's first.
    fn curves(&self) -> impl Iterator<Item = Curve> {
        std::iter::once(self.default_curve()).chain(self.slip_class.iter().map(SlipClass::curve))
    }

    /// A slope in degrees below which slip stays under [`Vehicle::slip_max`] by [`Vehicle::slip`].
    pub(crate) fn sure_deg(&self) -> f64 {
        self.default_curve().sure_deg(self.slip_max)
    }

    /// A slope in degrees below which slip stays under [`Vehicle::slip_max`] on every class.
    pub(crate) fn sure_on_any_class_deg(&self) -> f64 {
        let sure = self.curves().map(|curve| curve.sure_deg(self.slip_max));
        sure.fold(f64::INFINITY, f64::min)
    }

    pub(super) fn check_slip_classes(&self) -> Result<(), PlannerError> {
        for (row, listed) in self.slip_class.iter().enumerate() {
            let class = listed.class;
            if class.unsigned_abs() > MAX_CLASS {
                return Err(PlannerError::ClassRange { class });
            }
            if self.slip_class[..row].iter().any(|earlier| earlier.class == class) {
                return Err(PlannerError::RepeatedClass { class });
            }
            let refused =
                |field, value, limit| Err(PlannerError::SlipClass { class, field, value, limit });
            let (base, growth) = (listed.base, listed.growth_per_deg);
            if !(BELOW_ONE.0)(base) {
                return refused("base", base, BELOW_ONE.1);
            }
            if base >= self.slip_max {
                return refused("base", base, "below slip-max");
            }
            if !(NOT_NEGATIVE.0)(growth) {
                return refused("growth-per-deg", growth, NOT_NEGATIVE.1);
            }
        }
        Ok(())
    }
}

impl SlipClass {
    fn curve(&self) -> Curve {
        Curve { base: self.base, growth_per_deg: self.growth_per_deg }
    }
}
