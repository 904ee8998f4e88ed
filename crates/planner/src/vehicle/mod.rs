//! What the rover can drive over, and what driving costs it.

mod risk;
mod slip;

use schemars::JsonSchema;
use serde::Deserialize;

use crate::PlannerError;
pub use slip::SlipClass;

/// Limits, hazard model and drive model of a rover. A mission file may set any field; unknown keys are errors.
///
/// The defaults describe a 900 kg rover on Mars. The hazard numbers are fitted so that 100 m of flat ground
/// cost one per cent of reliability and ground at a limit is 70 times as hazardous; slip is the bedrock curve
/// through Heverly et al. (2013). `risk_level` is 0: heights are taken as they read, whatever their uncertainty, and
/// no terrain class slips on its own. They are configuration, not measurements of a flown rover.
///
/// ```
/// use wisdom_planner::Vehicle;
///
/// let vehicle = Vehicle::default();
/// vehicle.validate()?;
/// // 100 m of flat, certain ground: R = 0.99.
/// assert!((100.0 * vehicle.hazard_per_m(0.0, 0.0) - 0.01).abs() < 1e-12);
/// # Ok::<(), wisdom_planner::PlannerError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", default, deny_unknown_fields)]
pub struct Vehicle {
    /// Steepest slope driven, degrees.
    #[schemars(extend("exclusiveMinimum" = 0.0, "exclusiveMaximum" = 90.0))]
    pub slope_max_deg: f64,
    /// Highest step climbed, metres; see [`Vehicle::step_limit_m`].
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 1e9))]
    pub step_max_m: f64,
    /// Roughest ground driven: root mean square residual from the plane under the rover, metres.
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 1e9))]
    pub roughness_max_m: f64,
    /// Radius of the ground the rover stands on, metres.
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 1e9))]
    pub footprint_radius_m: f64,
    /// l0: hazard rate of flat, certain ground, per metre.
    #[schemars(range(min = 1e-12, max = 1e3))]
    pub hazard_floor_per_m: f64,
    /// k: the hazard rate grows by e^k from flat ground to ground at a limit.
    #[schemars(range(min = 0.0, max = 20.0))]
    pub hazard_exponent: f64,
    /// `k_u`: share by which total uncertainty raises the hazard rate.
    #[schemars(range(min = 0.0, max = 1e6))]
    pub hazard_uncertainty_gain: f64,
    /// Severity assumed of ground never seen, as a share of the limits.
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 1.0))]
    pub unknown_severity: f64,
    /// a: slope, step and roughness are judged by the mean of their worst share 1 − a (conditional value at risk)
    /// over the uncertainty of the heights, in [0, 1); 0, the default, judges them as they read.
    #[schemars(extend("minimum" = 0.0, "exclusiveMaximum" = 1.0))]
    pub risk_level: f64,
    /// Standard deviation of a height with u = 1, metres; with u it is u times that. Asked for by risk levels
    /// above 0 only.
    #[schemars(range(min = 0.0, max = 1e9))]
    pub height_sigma_m: f64,
    /// Speed of the wheels, metres a second; slip is taken off it.
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 1e9))]
    pub speed_m_s: f64,
    /// Mass, kilograms.
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 1e9))]
    pub mass_kg: f64,
    /// Gravity, metres a second squared.
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 1e9))]
    pub gravity_m_s2: f64,
    /// Rolling resistance, as a share of the weight.
    #[schemars(range(min = 0.0, max = 1e9))]
    pub rolling_resistance: f64,
    /// Share of the electric energy of the drives that reaches the wheels.
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 1.0))]
    pub drive_efficiency: f64,
    /// Power of everything but the drives, drawn for every second of driving, watts.
    #[schemars(range(min = 0.0, max = 1e9))]
    pub hotel_power_w: f64,
    /// Slip on flat ground, as a share of the wheels' way.
    #[schemars(extend("exclusiveMinimum" = 0.0, "exclusiveMaximum" = 1.0))]
    pub slip_base: f64,
    /// Growth rate of slip with the slope, per degree.
    #[schemars(range(min = 0.0, max = 1e9))]
    pub slip_growth_per_deg: f64,
    /// Slip from which ground counts as blocked.
    #[schemars(extend("exclusiveMinimum" = 0.0, "exclusiveMaximum" = 1.0))]
    pub slip_max: f64,
    /// Slip by terrain class, for ground judged with a layer of classes; classes not listed slip by `slip_base`
    /// and `slip_growth_per_deg`. None by default.
    pub slip_class: Vec<SlipClass>,
}

impl Default for Vehicle {
    fn default() -> Self {
        Self {
            slope_max_deg: 25.0,
            step_max_m: 0.25,
            roughness_max_m: 0.10,
            footprint_radius_m: 1.0,
            hazard_floor_per_m: 1e-4,
            hazard_exponent: 4.25,
            hazard_uncertainty_gain: 4.0,
            unknown_severity: 0.6,
            risk_level: 0.0,
            height_sigma_m: 0.1,
            speed_m_s: 0.04,
            mass_kg: 900.0,
            gravity_m_s2: 3.71,
            rolling_resistance: 0.15,
            drive_efficiency: 0.6,
            hotel_power_w: 100.0,
            slip_base: 0.01,
            slip_growth_per_deg: 0.10,
            slip_max: 0.9,
            slip_class: Vec::new(),
        }
    }
}

/// Half-open or closed range of a vehicle's field, with its wording.
type Allowed = (fn(f64) -> bool, &'static str);

const POSITIVE: Allowed = (|x| x > 0.0 && x <= 1e9, "in (0, 1e9]");
const NOT_NEGATIVE: Allowed = (|x| (0.0..=1e9).contains(&x), "in [0, 1e9]");
const SHARE: Allowed = (|x| x > 0.0 && x <= 1.0, "in (0, 1]");
const BELOW_ONE: Allowed = (|x| x > 0.0 && x < 1.0, "in (0, 1)");
const LEVEL: Allowed = (|x| (0.0..1.0).contains(&x), "in [0, 1)");
const ANGLE: Allowed = (|x| x > 0.0 && x < 90.0, "in (0, 90)");
/// Hazard rates are kept as `f32`: floor, exponent and gain are bounded so that none overflows or vanishes.
const FLOOR: Allowed = (|x| (1e-12..=1e3).contains(&x), "in [1e-12, 1e3]");
const EXPONENT: Allowed = (|x| (0.0..=20.0).contains(&x), "in [0, 20]");
const GAIN: Allowed = (|x| (0.0..=1e6).contains(&x), "in [0, 1e6]");

impl Vehicle {
    /// Checks every field against its range.
    ///
    /// # Errors
    /// [`PlannerError::Vehicle`] with the first field out of range, its value and the range;
    /// [`PlannerError::SlipClass`], [`PlannerError::ClassRange`] or [`PlannerError::RepeatedClass`] with the first
    /// slip class that is wrong.
    pub fn validate(&self) -> Result<(), PlannerError> {
        let fields: [(&'static str, f64, Allowed); 19] = [
            ("slope-max-deg", self.slope_max_deg, ANGLE),
            ("step-max-m", self.step_max_m, POSITIVE),
            ("roughness-max-m", self.roughness_max_m, POSITIVE),
            ("footprint-radius-m", self.footprint_radius_m, POSITIVE),
            ("hazard-floor-per-m", self.hazard_floor_per_m, FLOOR),
            ("hazard-exponent", self.hazard_exponent, EXPONENT),
            ("hazard-uncertainty-gain", self.hazard_uncertainty_gain, GAIN),
            ("unknown-severity", self.unknown_severity, SHARE),
            ("risk-level", self.risk_level, LEVEL),
            ("height-sigma-m", self.height_sigma_m, NOT_NEGATIVE),
            ("speed-m-s", self.speed_m_s, POSITIVE),
            ("mass-kg", self.mass_kg, POSITIVE),
            ("gravity-m-s2", self.gravity_m_s2, POSITIVE),
            ("rolling-resistance", self.rolling_resistance, NOT_NEGATIVE),
            ("drive-efficiency", self.drive_efficiency, SHARE),
            ("hotel-power-w", self.hotel_power_w, NOT_NEGATIVE),
            ("slip-base", self.slip_base, BELOW_ONE),
            ("slip-growth-per-deg", self.slip_growth_per_deg, NOT_NEGATIVE),
            ("slip-max", self.slip_max, BELOW_ONE),
        ];
        for (field, value, (allows, limit)) in fields {
            if !allows(value) {
                return Err(PlannerError::Vehicle { field, value, limit });
            }
        }
        if self.slip_base >= self.slip_max {
            let (field, value) = ("slip-base", self.slip_base);
            return Err(PlannerError::Vehicle { field, value, limit: "below slip-max" });
        }
        self.check_slip_classes()
    }

    /// Hazard rate λ per metre of ground of a severity (share of the limits) known with uncertainty `u`:
    /// `λ = max(l0·exp(k·severity)·(1 + k_u·u), u·λ_unknown)` with `λ_unknown = l0·exp(k·unknown_severity)`.
    ///
    /// It grows with both arguments. From severity 1 on it stays at its value there: such ground is blocked.
    #[must_use]
    pub fn hazard_per_m(&self, severity: f64, u: f64) -> f64 {
        let of = |severity: f64| {
            self.hazard_floor_per_m * libm::exp(self.hazard_exponent * severity.min(1.0))
        };
        let seen = of(severity) * (1.0 + self.hazard_uncertainty_gain * u);
        seen.max(u * of(self.unknown_severity))
    }

    /// The height difference between neighbouring cells that stops the rover, metres, on a grid of a spacing.
    ///
    /// It is `step_max_m` and what the steepest slope allowed explains over the diagonal of a cell: cells of
    /// a metre cannot tell a step of a quarter metre from a slope of 14°, and a slope must not be blocked
    /// by being sampled coarsely. On cells much smaller than the step it is the step.
    #[must_use]
    pub fn step_limit_m(&self, spacing_m: f64) -> f64 {
        let steepest = libm::tan(self.slope_max_deg.to_radians());
        self.step_max_m + std::f64::consts::SQRT_2 * spacing_m * steepest
    }

    /// How far beyond its reading a height with u = 1 is judged, metres: `σ_z·φ(Φ⁻¹(a))/(1 − a)`, the conditional
    /// value at risk of a normal error with [`Vehicle::height_sigma_m`] at [`Vehicle::risk_level`] (Rockafellar and
    /// Uryasev 2000; for traversability Fan et al. 2021, STEP). 0 at level 0.
    ///
    /// ```
    /// use wisdom_planner::Vehicle;
    ///
    /// let careful = Vehicle { risk_level: 0.9, height_sigma_m: 0.2, ..Vehicle::default() };
    /// assert!((careful.risk_margin_m() - 0.2 * 1.755).abs() < 1e-4);
    /// assert_eq!(Vehicle::default().risk_margin_m(), 0.0);
    /// ```
    #[must_use]
    pub fn risk_margin_m(&self) -> f64 {
        self.height_sigma_m * risk::cvar_of_standard_normal(self.risk_level)
    }

    /// Time in seconds and energy in joules of a straight drive over `length_m` on the map that rises by
    /// `rise_m`; none if the wheels slip [`Vehicle::slip_max`] or more. Slip is [`Vehicle::slip`]'s.
    ///
    /// The wheels turn `ground length / (1 − slip)` at [`Vehicle::speed_m_s`]. Per metre of ground they work
    /// `m·g·(c_rr·cos t + max(0, sin t)) / (η·(1 − slip))`, t being the slope in the direction of travel; over
    /// the edge that is `m·g·(c_rr·length + max(0, rise))` on top of the division. Going down gives nothing back.
    #[must_use]
    pub fn drive(&self, length_m: f64, rise_m: f64) -> Option<(f64, f64)> {
        let slip = if rise_m == 0.0 {
            self.slip_base
        } else {
            self.slip(slope_of_travel_deg(length_m, rise_m))
        };
        self.drive_slipping(length_m, rise_m, slip)
    }

    /// Time in seconds and energy in joules of a drive as [`Vehicle::drive`] has it, with a slip found elsewhere:
    /// that of [`Vehicle::slip_on`] at `atan(rise/length)`, say.
    #[must_use]
    pub fn drive_slipping(&self, length_m: f64, rise_m: f64, slip: f64) -> Option<(f64, f64)> {
        if slip >= self.slip_max {
            return None;
        }
        let kept = 1.0 - slip;
        let ground_m = (length_m * length_m + rise_m * rise_m).sqrt();
        let time_s = ground_m / (self.speed_m_s * kept);
        let force_way = self.rolling_resistance * length_m + rise_m.max(0.0);
        let drive_j = self.mass_kg * self.gravity_m_s2 * force_way / (self.drive_efficiency * kept);
        Some((time_s, drive_j + self.hotel_power_w * time_s))
    }
}

/// The slope in the direction of travel, degrees; negative downhill.
pub(crate) fn slope_of_travel_deg(length_m: f64, rise_m: f64) -> f64 {
    libm::atan(rise_m / length_m).to_degrees()
}

/// Rise over run of a slope in degrees; infinite from 90 on.
pub(crate) fn grade(slope_deg: f64) -> f64 {
    if slope_deg >= 90.0 { f64::INFINITY } else { libm::tan(slope_deg.to_radians()) }
}
