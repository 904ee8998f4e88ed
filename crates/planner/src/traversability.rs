//! Where the rover can drive, how hazardous it is, and what a step from cell to cell costs.

use rayon::prelude::*;
use wisdom_grid::{Cell, GridSpec, Raster};
use wisdom_terrain::{Kernel, Layer, Measure, measure};

use crate::vehicle::{grade, slope_of_travel_deg};
use crate::{CostVector, PlannerError, Vehicle};

/// Row and column steps to the eight neighbours, in the order of their indices: the opposite of step `k` is
/// step `7 − k`, and the neighbour of the smaller `k` is the smaller [`Cell`].
pub(crate) const STEPS: [(isize, isize); 8] =
    [(-1, -1), (-1, 0), (-1, 1), (0, -1), (0, 1), (1, -1), (1, 0), (1, 1)];

/// The two orthogonal steps beside a diagonal one; an orthogonal step has none.
const BESIDE: [Option<[usize; 2]>; 8] =
    [Some([1, 3]), None, Some([1, 4]), None, None, Some([6, 3]), None, Some([6, 4])];

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
/// - **Risk**: above [`Vehicle::risk_level`] 0 each of the three is judged at `mean + σ·φ(Φ⁻¹(a))/(1 − a)`, the
///   conditional value at risk of a normal (Fan et al. 2021, STEP; Rockafellar and Uryasev 2000). Heights err
///   independently, by e = [`Vehicle::height_sigma_m`]·u; u is the largest of the heights a measure is made of. On
///   cells of spacing w, σ is `e/(√2·w)` for the rise over run of a central difference and `√2·e/w` for a one-sided
///   one (at the map's edge and beside unknown cells), `√2·e` for a step and e for roughness. These bound what
///   independent errors do: the magnitude of a gradient errs no more than its worse axis; each difference of a step
///   is judged alone; the residual of n heights errs by `e/√n`, and its mean rises by less than e. A measure that is
///   unknown gets no margin: a high level may close flat
///   ground that is barely known, while ground never seen stays open at [`Vehicle::unknown_severity`]. The level says
///   how sure the rover must be of what it has seen.
/// - **Slip** is [`Vehicle::slip`], or with a layer of terrain classes [`Vehicle::slip_on`] the cell's class and its
///   u. A step slips as the worse of its two cells does, in its direction of travel.
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
    /// Terrain classes and their uncertainty.
    classes: Option<Layer>,
    /// Bit `k` is set where step `k` of [`STEPS`] may be taken.
    open: Vec<u8>,
    /// Smallest and largest hazard rate of the cells that can be entered.
    hazard_range: (f32, f32),
    /// Map length of each step, metres.
    length_m: [f64; 8],
}

impl Traversability {
    /// Judges the ground from its heights. It slips by [`Vehicle::slip`] everywhere.
    ///
    /// # Errors
    /// [`PlannerError::Vehicle`], or one of its slip classes' errors, if a number of the vehicle is out of range.
    pub fn new(vehicle: &Vehicle, elevation: &Layer) -> Result<Self, PlannerError> {
        Self::on_classes(vehicle, elevation, None)
    }

    /// Judges the ground from its heights and its terrain classes, whose readings [`Vehicle::slip_class`] lists.
    /// Without a layer of classes it is [`Traversability::new`].
    ///
    /// ```
    /// use wisdom_grid::{Cell, GridSpec, Raster};
    /// use wisdom_planner::{SlipClass, Traversability, Vehicle};
    /// use wisdom_terrain::Layer;
    ///
    /// // A slope of 20 degrees: sand in the west, in the east a class that is not known.
    /// let spec = GridSpec::new(9, 9, 1.0)?;
    /// let heights = Layer::certain(Raster::from_fn(spec, |cell| 0.364 * cell.row as f32))?;
    /// let mut classes = Layer::certain(Raster::filled(spec, 1.0))?;
    /// for cell in spec.cells().filter(|cell| cell.col > 4) {
    ///     classes.set(cell, 0.0, 1.0);
    /// }
    /// let sand = SlipClass { class: 1, name: "sand".into(), base: 0.035, growth_per_deg: 0.17 };
    /// let rover = Vehicle { slip_class: vec![sand], ..Vehicle::default() };
    ///
    /// let ground = Traversability::on_classes(&rover, &heights, Some(&classes))?;
    /// assert!(ground.is_blocked(Cell::new(4, 1)) && ground.is_blocked(Cell::new(4, 7)));
    /// assert!(!Traversability::new(&rover, &heights)?.is_blocked(Cell::new(4, 1)));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`PlannerError::Vehicle`], or one of its slip classes' errors, if a number of the vehicle is out of range;
    /// [`PlannerError::GridMismatch`] if the classes do not lie on the elevation's grid.
    pub fn on_classes(
        vehicle: &Vehicle,
        elevation: &Layer,
        classes: Option<&Layer>,
    ) -> Result<Self, PlannerError> {
        vehicle.validate()?;
        let spec = elevation.spec();
        check_grid("classes", classes.map(Layer::spec), spec)?;
        let reach = (vehicle.footprint_radius_m / spec.spacing_m()).round();
        let reach = (reach as usize).clamp(1, spec.rows().max(spec.cols()));
        let measures = measure(
            elevation,
            [
                Measure::Gradient(Kernel::Central),
                Measure::Step,
                Measure::Roughness { radius_cells: reach },
            ],
        );
        let judge = Judge::new(vehicle, elevation, classes, &measures);
        let relief = Raster::par_from_fn(spec, |cell| judge.relief(cell));
        let relief = if reach > 1 { worst_within(&relief, reach - 1) } else { relief };
        let severity = Raster::par_from_fn(spec, |cell| {
            if elevation.is_known(cell) { relief[cell].max(judge.roughness(cell)) } else { 0.0 }
        });
        let gradient = &measures[0];
        let hazard_per_m = Raster::par_from_fn(spec, |cell| {
            let u = elevation.u(cell).max(gradient.u(cell));
            vehicle.hazard_per_m(f64::from(severity[cell]), f64::from(u)) as f32
        });
        let blocked = severity.map(|&severity| severity >= 1.0);
        let ground = Ground { elevation: elevation.clone(), blocked, severity, hazard_per_m };
        Self::from_ground_on_classes(vehicle, ground, classes)
    }

    /// Takes over ground that was judged elsewhere. It slips by [`Vehicle::slip`] everywhere.
    ///
    /// # Errors
    /// [`PlannerError::Vehicle`], or one of its slip classes' errors, if a number of the vehicle is out of range;
    /// [`PlannerError::GridMismatch`] if the rasters do not share a grid; [`PlannerError::Hazard`] or
    /// [`PlannerError::Severity`], naming the cell, if a rate is not positive or a severity negative.
    pub fn from_ground(vehicle: &Vehicle, ground: Ground) -> Result<Self, PlannerError> {
        Self::from_ground_on_classes(vehicle, ground, None)
    }

    /// Takes over ground that was judged elsewhere, with terrain classes by which its steps slip.
    ///
    /// # Errors
    /// As [`Traversability::from_ground`]; the classes must lie on the ground's grid too.
    pub fn from_ground_on_classes(
        vehicle: &Vehicle,
        ground: Ground,
        classes: Option<&Layer>,
    ) -> Result<Self, PlannerError> {
        vehicle.validate()?;
        check(&ground)?;
        let spec = ground.elevation.spec();
        check_grid("classes", classes.map(Layer::spec), spec)?;
        let open = open_steps(vehicle, &ground, classes);
        let hazard_range = ground
            .blocked
            .values()
            .iter()
            .zip(ground.hazard_per_m.values())
            .filter_map(|(&blocked, &hazard)| (!blocked).then_some(hazard))
            .fold((f32::INFINITY, 0.0), |(low, high), hazard| (hazard.min(low), hazard.max(high)));
        let (vehicle, classes) = (vehicle.clone(), classes.cloned());
        Ok(Self { vehicle, ground, classes, open, hazard_range, length_m: lengths_m(spec) })
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

    /// The terrain classes that the ground was judged with, and their uncertainty.
    #[must_use]
    pub fn classes(&self) -> Option<&Layer> {
        self.classes.as_ref()
    }

    /// Slip of a cell's ground on a slope, in degrees and negative downhill, as a share of the wheels' way.
    ///
    /// # Panics
    /// If there are classes and the cell is not on the grid, as a slice does.
    #[must_use]
    pub fn slip(&self, cell: Cell, slope_deg: f64) -> f64 {
        match &self.classes {
            Some(classes) => self.vehicle.slip_on(classes.value(cell), classes.u(cell), slope_deg),
            None => self.vehicle.slip(slope_deg),
        }
    }

    /// What the step from a cell to a neighbour costs; none if it cannot be taken, or they are not neighbours.
    ///
    /// `−ln R = length·(λ_from + λ_to)/2`; time and energy by the direction of travel ([`Vehicle::drive`]), with
    /// the slip of the worse of the two cells.
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
        let rise = rise_m(&self.ground.elevation, from, to);
        let (time_s, energy_j) =
            drive_step(&self.vehicle, self.classes.as_ref(), (from, to), length_m, rise)
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

/// A vehicle's eye on the measures of a ground, cell by cell.
struct Judge<'a> {
    vehicle: &'a Vehicle,
    elevation: &'a Layer,
    classes: Option<&'a Layer>,
    gradient: &'a Layer,
    step: &'a Layer,
    roughness: &'a Layer,
    spacing_m: f64,
    step_limit_m: f64,
    /// Slopes below this slip less than the limit, degrees.
    sure_deg: f64,
    /// [`Vehicle::risk_margin_m`].
    margin_m: f64,
}

impl<'a> Judge<'a> {
    fn new(
        vehicle: &'a Vehicle,
        elevation: &'a Layer,
        classes: Option<&'a Layer>,
        [gradient, step, roughness]: &'a [Layer; 3],
    ) -> Self {
        let spacing_m = elevation.spec().spacing_m();
        Self {
            vehicle,
            elevation,
            classes,
            gradient,
            step,
            roughness,
            spacing_m,
            step_limit_m: vehicle.step_limit_m(spacing_m),
            sure_deg: sure_deg(vehicle, classes),
            margin_m: vehicle.risk_margin_m(),
        }
    }

    /// Slope and step as shares of their limits, the worse of the two; at least 1 where the wheels slip too much.
    fn relief(&self, cell: Cell) -> f32 {
        let slope_deg = libm::atan(self.gradient(cell)).to_degrees();
        let share = slope_deg / self.vehicle.slope_max_deg;
        let slope = if self.slips_too_much(cell, slope_deg) { share.max(1.0) } else { share };
        let step = self.at_risk(self.step, cell, std::f64::consts::SQRT_2);
        slope.max(step / self.step_limit_m) as f32
    }

    /// Roughness as a share of its limit.
    fn roughness(&self, cell: Cell) -> f32 {
        (self.at_risk(self.roughness, cell, 1.0) / self.vehicle.roughness_max_m) as f32
    }

    fn gradient(&self, cell: Cell) -> f64 {
        if self.margin_m == 0.0 {
            return f64::from(self.gradient.value(cell));
        }
        let sigmas = if self.is_one_sided(cell) {
            std::f64::consts::SQRT_2
        } else {
            std::f64::consts::FRAC_1_SQRT_2
        };
        self.at_risk(self.gradient, cell, sigmas / self.spacing_m)
    }

    /// A measure that errs by `sigmas` times the error of a height.
    fn at_risk(&self, measure: &Layer, cell: Cell, sigmas: f64) -> f64 {
        let mean = f64::from(measure.value(cell));
        if self.margin_m > 0.0 && measure.is_known(cell) {
            mean + self.margin_m * f64::from(measure.u(cell)) * sigmas
        } else {
            mean
        }
    }

    /// Whether one of the four cells of a central difference is off the map or unknown.
    fn is_one_sided(&self, cell: Cell) -> bool {
        let spec = self.elevation.spec();
        [(-1, 0), (1, 0), (0, -1), (0, 1)].into_iter().any(|(row, col)| {
            !spec.step(cell, row, col).is_some_and(|beside| self.elevation.is_known(beside))
        })
    }

    fn slips_too_much(&self, cell: Cell, slope_deg: f64) -> bool {
        if slope_deg < self.sure_deg {
            return false;
        }
        let slip = match self.classes {
            Some(classes) => self.vehicle.slip_on(classes.value(cell), classes.u(cell), slope_deg),
            None => self.vehicle.slip(slope_deg),
        };
        slip >= self.vehicle.slip_max
    }
}

/// A slope below which nothing slips too much, degrees.
fn sure_deg(vehicle: &Vehicle, classes: Option<&Layer>) -> f64 {
    if classes.is_some() { vehicle.sure_on_any_class_deg() } else { vehicle.sure_deg() }
}

/// Time in seconds and energy in joules of a step between two indices; none if its worse cell slips too much.
fn drive_step(
    vehicle: &Vehicle,
    classes: Option<&Layer>,
    (from, to): (usize, usize),
    length_m: f64,
    rise_m: f64,
) -> Option<(f64, f64)> {
    let Some(classes) = classes else { return vehicle.drive(length_m, rise_m) };
    let slope_deg = slope_of_travel_deg(length_m, rise_m);
    let (class, u) = (classes.values().values(), classes.uncertainty().values());
    let slip = [from, to]
        .map(|index| vehicle.slip_on(class[index], u[index], slope_deg))
        .into_iter()
        .fold(0.0, f64::max);
    vehicle.drive_slipping(length_m, rise_m, slip)
}

fn check_grid(
    layer: &'static str,
    found: Option<GridSpec>,
    expected: GridSpec,
) -> Result<(), PlannerError> {
    match found {
        Some(found) if found != expected => {
            Err(PlannerError::GridMismatch { layer, found, expected })
        }
        _ => Ok(()),
    }
}

fn check(ground: &Ground) -> Result<(), PlannerError> {
    let expected = ground.elevation.spec();
    for (layer, found) in [
        ("blocked", ground.blocked.spec()),
        ("severity", ground.severity.spec()),
        ("hazard", ground.hazard_per_m.spec()),
    ] {
        check_grid(layer, Some(found), expected)?;
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
fn open_steps(vehicle: &Vehicle, ground: &Ground, classes: Option<&Layer>) -> Vec<u8> {
    let spec = ground.elevation.spec();
    let (offset, length_m) = (offsets(spec.cols()), lengths_m(spec));
    let sure = grade(sure_deg(vehicle, classes));
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
            let to = index.wrapping_add_signed(offset[k]);
            let rise = rise_m(&ground.elevation, index, to);
            if rise < length_m[k] * sure
                || drive_step(vehicle, classes, (index, to), length_m[k], rise).is_some()
            {
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
