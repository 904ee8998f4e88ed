//! Where the rover can drive, how hazardous it is, and what a step from cell to cell costs.

use rayon::prelude::*;
use wisdom_grid::{Cell, GridSpec, Raster};
use wisdom_terrain::{Kernel, Layer, Measure, measure};

use crate::{CostVector, PlannerError, Vehicle};

/// Row and column steps to the eight neighbours, in the order of their indices: the opposite of step `k` is
/// step `7 − k`, and the neighbour of the smaller `k` is the smaller [`Cell`].
pub(crate) const STEPS: [(isize, isize); 8] =
    [(-1, -1), (-1, 0), (-1, 1), (0, -1), (0, 1), (1, -1), (1, 0), (1, 1)];

/// The two orthogonal steps beside a diagonal one; an orthogonal step has none.
const BESIDE: [Option<[usize; 2]>; 8] =
    [Some([1, 3]), None, Some([1, 4]), None, None, Some([6, 3]), None, Some([6, 4])];

/// Grades below this share of the steepest need no second look: rounding is far smaller.
const SURE: f64 = 1.0 - 1e-9;

/// Ground already judged cell by cell, for callers who judge it their own way (and for tests).
#[derive(Debug, Clone, PartialEq)]
pub struct Ground {
    /// Heights in metres and their uncertainty: rises decide time and energy.
    pub elevation: Layer,
    /// Cells that cannot be entered.
    pub blocked: Raster<bool>,
    /// Share of the vehicle's limits reached, the worst of slope, step and roughness.
    pub severity: Raster<f32>,
    /// Hazard rate λ, per metre; positive.
    pub hazard_per_m: Raster<f32>,
}

/// The ground as a vehicle meets it: blocked cells, severity, hazard rate, and the cost of each step.
///
/// - **Severity** of a known cell is `max(s, h, r)`: slope over its limit, step over
///   [`Vehicle::step_limit_m`], roughness over its limit (the three checks of GESTALT; Biesiadecki and Maimone
///   2006). Slope and step reach one cell around; where the footprint is wider, their worst under it counts.
/// - **Blocked** is a cell of severity 1 or more, or on which slip reaches [`Vehicle::slip_max`].
/// - **Hazard** is [`Vehicle::hazard_per_m`] of the severity and of the larger u of height and gradient.
/// - **Unknown** cells (elevation u = 1) have severity 0 and are not blocked; u = 1 makes their hazard
///   `max(l0·(1 + k_u), λ_unknown)`. Height differences to an unknown cell count as 0.
///
/// A cell that is blocked cannot be entered, but it can be left: the rover may stand on one when newer data
/// close it. A diagonal step needs both cells beside it free. A step up on which the wheels slip
/// [`Vehicle::slip_max`] is closed in that direction only.
#[derive(Debug, Clone)]
pub struct Traversability {
    vehicle: Vehicle,
    ground: Ground,
    /// Bit `k` is set where step `k` of [`STEPS`] may be taken.
    open: Vec<u8>,
    /// Smallest and largest hazard rate of the cells that can be entered.
    hazard_range: (f32, f32),
    /// Map length of each step, metres.
    length_m: [f64; 8],
}

impl Traversability {
    /// Judges the ground from its heights.
    ///
    /// # Errors
    /// [`PlannerError::Vehicle`] if a number of the vehicle is out of range.
    pub fn new(vehicle: &Vehicle, elevation: &Layer) -> Result<Self, PlannerError> {
        vehicle.validate()?;
        let spec = elevation.spec();
        let reach = (vehicle.footprint_radius_m / spec.spacing_m()).round();
        let reach = (reach as usize).clamp(1, spec.rows().max(spec.cols()));
        let [gradient, step, roughness] = measure(
            elevation,
            [
                Measure::Gradient(Kernel::Central),
                Measure::Step,
                Measure::Roughness { radius_cells: reach },
            ],
        );

        let step_limit_m = vehicle.step_limit_m(spec.spacing_m());
        let relief = Raster::par_from_fn(spec, |cell| {
            let slope_deg = libm::atan(f64::from(gradient.value(cell))).to_degrees();
            let slope = if vehicle.slip(slope_deg) >= vehicle.slip_max {
                f64::max(1.0, slope_deg / vehicle.slope_max_deg)
            } else {
                slope_deg / vehicle.slope_max_deg
            };
            slope.max(f64::from(step.value(cell)) / step_limit_m) as f32
        });
        let relief = if reach > 1 { worst_within(&relief, reach - 1) } else { relief };
        let severity = Raster::par_from_fn(spec, |cell| {
            if elevation.is_known(cell) {
                let rough = f64::from(roughness.value(cell)) / vehicle.roughness_max_m;
                relief[cell].max(rough as f32)
            } else {
                0.0
            }
        });
        let hazard_per_m = Raster::par_from_fn(spec, |cell| {
            let u = elevation.u(cell).max(gradient.u(cell));
            vehicle.hazard_per_m(f64::from(severity[cell]), f64::from(u)) as f32
        });
        let blocked = severity.map(|&severity| severity >= 1.0);
        Self::from_ground(
            vehicle,
            Ground { elevation: elevation.clone(), blocked, severity, hazard_per_m },
        )
    }

    /// Takes over ground that was judged elsewhere.
    ///
    /// # Errors
    /// [`PlannerError::Vehicle`] if a number of the vehicle is out of range; [`PlannerError::GridMismatch`] if
    /// the rasters do not share a grid; [`PlannerError::Hazard`] or [`PlannerError::Severity`], naming the cell,
    /// if a rate is not positive or a severity negative.
    pub fn from_ground(vehicle: &Vehicle, ground: Ground) -> Result<Self, PlannerError> {
        vehicle.validate()?;
        check(&ground)?;
        let spec = ground.elevation.spec();
        let open = open_steps(vehicle, &ground);
        let hazard_range = ground
            .blocked
            .values()
            .iter()
            .zip(ground.hazard_per_m.values())
            .filter_map(|(&blocked, &hazard)| (!blocked).then_some(hazard))
            .fold((f32::INFINITY, 0.0), |(low, high), hazard| (hazard.min(low), hazard.max(high)));
        let length_m = lengths_m(spec);
        Ok(Self { vehicle: vehicle.clone(), ground, open, hazard_range, length_m })
    }

    /// Where the ground lies.
    #[must_use]
    pub fn spec(&self) -> GridSpec {
        self.ground.elevation.spec()
    }

    /// The vehicle the ground was judged for.
    #[must_use]
    pub fn vehicle(&self) -> &Vehicle {
        &self.vehicle
    }

    /// Whether a cell cannot be entered.
    ///
    /// # Panics
    /// If the cell is not on the grid, as a slice does.
    #[must_use]
    pub fn is_blocked(&self, cell: Cell) -> bool {
        self.ground.blocked[cell]
    }

    /// Hazard rate λ of a cell, per metre.
    ///
    /// # Panics
    /// If the cell is not on the grid, as a slice does.
    #[must_use]
    pub fn hazard_per_m(&self, cell: Cell) -> f32 {
        self.ground.hazard_per_m[cell]
    }

    /// Share of the vehicle's limits that a cell reaches; 0 where unknown.
    ///
    /// # Panics
    /// If the cell is not on the grid, as a slice does.
    #[must_use]
    pub fn severity(&self, cell: Cell) -> f32 {
        self.ground.severity[cell]
    }

    /// Height of a cell, metres; none where unknown.
    ///
    /// # Panics
    /// If the cell is not on the grid, as a slice does.
    #[must_use]
    pub fn height_m(&self, cell: Cell) -> Option<f32> {
        let elevation = &self.ground.elevation;
        elevation.is_known(cell).then(|| elevation.value(cell))
    }

    /// The cells that cannot be entered.
    #[must_use]
    pub fn blocked(&self) -> &Raster<bool> {
        &self.ground.blocked
    }

    /// Shares of the vehicle's limits that cells reach; 0 where unknown.
    #[must_use]
    pub fn severities(&self) -> &Raster<f32> {
        &self.ground.severity
    }

    /// Hazard rates λ, per metre.
    #[must_use]
    pub fn hazard(&self) -> &Raster<f32> {
        &self.ground.hazard_per_m
    }

    /// What the step from a cell to a neighbour costs; none if it cannot be taken, or they are not neighbours.
    ///
    /// `−ln R = length·(λ_from + λ_to)/2`; time and energy by the direction of travel ([`Vehicle::drive`]).
    #[must_use]
    pub fn edge(&self, from: Cell, to: Cell) -> Option<CostVector> {
        let spec = self.spec();
        if !spec.contains(from) || !spec.contains(to) {
            return None;
        }
        let step = STEPS.iter().position(|&(row, col)| {
            from.row.checked_add_signed(row) == Some(to.row)
                && from.col.checked_add_signed(col) == Some(to.col)
        })?;
        let (from, to) = (spec.index(from), spec.index(to));
        (self.open[from] & (1 << step) != 0).then(|| self.open_edge(from, to, step))
    }

    /// The cost of an open step between two indices.
    pub(crate) fn open_edge(&self, from: usize, to: usize, step: usize) -> CostVector {
        let length_m = self.length_m[step];
        let hazard = self.ground.hazard_per_m.values();
        let neg_ln_r = 0.5 * length_m * (f64::from(hazard[from]) + f64::from(hazard[to]));
        let (time_s, energy_j) = self
            .vehicle
            .drive(length_m, rise_m(&self.ground.elevation, from, to))
            .expect("an open step slips less than the limit");
        CostVector { length_m, time_s, energy_j, neg_ln_r }
    }

    pub(crate) fn open(&self) -> &[u8] {
        &self.open
    }

    pub(crate) fn length_m(&self) -> [f64; 8] {
        self.length_m
    }

    pub(crate) fn hazard_range(&self) -> (f32, f32) {
        self.hazard_range
    }
}

/// The change of index that a step of [`STEPS`] makes where rows begin `stride` apart.
pub(crate) fn offsets(stride: usize) -> [isize; 8] {
    STEPS.map(|(row, col)| row * stride as isize + col)
}

fn lengths_m(spec: GridSpec) -> [f64; 8] {
    BESIDE.map(|beside| match beside {
        Some(_) => spec.spacing_m() * std::f64::consts::SQRT_2,
        None => spec.spacing_m(),
    })
}

fn check(ground: &Ground) -> Result<(), PlannerError> {
    let expected = ground.elevation.spec();
    for (layer, found) in [
        ("blocked", ground.blocked.spec()),
        ("severity", ground.severity.spec()),
        ("hazard", ground.hazard_per_m.spec()),
    ] {
        if found != expected {
            return Err(PlannerError::GridMismatch { layer, found, expected });
        }
    }
    for (cell, &value) in ground.hazard_per_m.iter() {
        if !value.is_normal() || value < 0.0 {
            return Err(PlannerError::Hazard { cell, value });
        }
    }
    for (cell, &value) in ground.severity.iter() {
        if !value.is_finite() || value < 0.0 {
            return Err(PlannerError::Severity { cell, value });
        }
    }
    Ok(())
}

/// Height difference in metres, 0 where either height is unknown. Subtracted before anything else: heights of
/// thousands of metres leave an `f32` only millimetres.
fn rise_m(elevation: &Layer, from: usize, to: usize) -> f64 {
    let (z, u) = (elevation.values().values(), elevation.uncertainty().values());
    if u[from] < 1.0 && u[to] < 1.0 { f64::from(z[to]) - f64::from(z[from]) } else { 0.0 }
}

/// For each cell, the steps that may be taken from it, as bits.
fn open_steps(vehicle: &Vehicle, ground: &Ground) -> Vec<u8> {
    let spec = ground.elevation.spec();
    let (offset, length_m) = (offsets(spec.cols()), lengths_m(spec));
    let steepest = vehicle.steepest_grade();
    let blocked = ground.blocked.values();
    let steps_from = |index: usize| {
        let cell = spec.cell(index);
        let free = STEPS
            .map(|(row, col)| spec.step(cell, row, col).is_some_and(|to| !blocked[spec.index(to)]));
        let mut open = 0;
        for (k, beside) in BESIDE.iter().enumerate() {
            if !free[k] || beside.is_some_and(|[a, b]| !(free[a] && free[b])) {
                continue;
            }
            let rise = rise_m(&ground.elevation, index, index.wrapping_add_signed(offset[k]));
            if rise < length_m[k] * steepest * SURE || vehicle.drive(length_m[k], rise).is_some() {
                open |= 1 << k;
            }
        }
        open
    };
    (0..spec.len()).into_par_iter().with_min_len(4096).map(steps_from).collect()
}

/// For each cell the largest value within `radius` cells, rows and columns counted apart (a square).
fn worst_within(raster: &Raster<f32>, radius: usize) -> Raster<f32> {
    let spec = raster.spec();
    let west = spec.first().col;
    let along = Raster::par_from_fn(spec, |cell| {
        let near = spec.around(cell, radius);
        let near = near.col - west..near.col - west + near.cols;
        raster.row(cell.row)[near].iter().copied().fold(0.0, f32::max)
    });
    Raster::par_from_fn(spec, |cell| {
        let near = spec.around(cell, radius);
        (near.row..near.row + near.rows)
            .map(|row| along.row(row)[cell.col - west])
            .fold(0.0, f32::max)
    })
}
