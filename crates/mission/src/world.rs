//! The simulated world: what is true, what instruments read of it, and what driving over it does.
//!
//! Chance is counter-based: a draw is keyed by the seed, by what it is for, by where, and by the number of the
//! look, entry or operator it belongs to. No generator is shared, so the order in which draws are made does not
//! matter, nor the number of threads; two runs that drive alike meet the same chances, and hazards and slip of
//! a cell are the same for the same entry whatever was done before.

use std::borrow::Cow;
use std::collections::BTreeMap;

use wisdom_autonomy::{ELEVATION, LayerSpec, LayerWindow, Pose, Source, Word};
use wisdom_grid::{Cell, GridSpec, Raster, Window};
use wisdom_planner::{CostVector, PlannerError, Traversability, Vehicle};
use wisdom_terrain::{
    FieldOfView, Layer, Observer, TerrainError, normal_noise, unit_noise, viewshed,
};

use crate::fault::{Fault, Faults};
use crate::file::FirstLookU;
use crate::reading::Reading;
use crate::truth::{LayerTruth, ReadingKind};

/// What a draw is for. The numbers are part of every seed's world: never renumber them.
#[derive(Debug, Clone, Copy)]
enum Purpose {
    Reading = 1,
    WrongClass = 2,
    WhichClass = 3,
    FirstLook = 4,
    Hazard = 5,
    Slip = 6,
    Service = 7,
    Fault = 8,
    FaultTime = 9,
}

/// A camera or spectrometer.
#[derive(Debug, Clone, PartialEq)]
pub struct Instrument {
    /// Its name.
    pub name: String,
    /// The layers it reads.
    pub layers: Vec<String>,
    /// Height above the ground, metres.
    pub height_m: f64,
    /// Range, metres.
    pub range_m: f64,
    /// Uncertainty at no distance; it grows to 1 at the range, `u0 + (1 − u0)·(d/range)²`.
    pub u0: f64,
    /// Field of view about the heading, radians; 2π for all round.
    pub field_of_view_rad: f64,
}

/// What is known before the first look.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Prior {
    None,
    Complete,
    Averaged {
        block: usize,
        u: f64,
    },
    FirstLook {
        uncertainty: BTreeMap<String, FirstLookU>,
        pinned: Vec<(String, Cell, f32)>,
        camera_height_m: f64,
    },
}

/// How the simulated rover moves and works.
#[derive(Debug, Clone, PartialEq)]
pub struct Execution {
    /// Where it starts, which is home.
    pub start: Cell,
    /// Which way it faces at first, radians clockwise from north.
    pub heading_rad: f64,
    /// Way between two looks, metres.
    pub look_every_m: f64,
    /// Scatter of what a step costs, as a share (standard deviation).
    pub slip_scatter: f64,
    /// Scatter of what an operator costs, as a share (standard deviation).
    pub operator_scatter: f64,
    /// Factor on the true hazard: 1 if the vehicle's hazard model is right.
    pub hazard_factor: f64,
    /// Time lost when a hazard aborts a drive, seconds.
    pub recovery_s: f64,
    /// Radius in which ground that stops the rover is seen for certain, metres.
    pub hazard_camera_m: f64,
    /// The most decisions of one mission.
    pub max_decisions: u32,
    /// The layer of terrain classes that the wheels truly slip by, if any.
    pub slip_layer: Option<String>,
    /// What the ground will ask for and take back, by mission time in seconds.
    pub commands: Vec<(f64, Word)>,
    /// What may break.
    pub faults: Vec<Fault>,
    /// Readings that are handed in, the earliest first.
    pub readings: Vec<Reading>,
}

/// One step over the true ground, before chance has its say.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// What it costs, by the true hazard ([`Execution::hazard_factor`]).
    pub cost: CostVector,
    /// Slip of the wheels, as a share of their way.
    pub slip: f64,
}

/// The truth, and what chance makes of it.
///
/// The true layers lie in memory, or are read and drawn piece by piece as they are asked for: then only the ground near
/// the rover is ever looked at, and everything that reads may fail.
#[derive(Debug, Clone)]
pub struct World {
    seed: u64,
    grid: GridSpec,
    truth: BTreeMap<String, LayerTruth>,
    vehicle: Vehicle,
    /// True traversability of the whole ground, where all of it lies in memory.
    ground: Option<Traversability>,
    instruments: Vec<Instrument>,
    prior: Prior,
    execution: Execution,
    body_radius_m: Option<f64>,
}

impl World {
    pub(crate) fn new(
        seed: u64,
        truth: BTreeMap<String, LayerTruth>,
        vehicle: &Vehicle,
        instruments: Vec<Instrument>,
        prior: Prior,
        execution: Execution,
        body_radius_m: Option<f64>,
    ) -> Result<Self, PlannerError> {
        let elevation = &truth[ELEVATION];
        let classes = execution.slip_layer.as_ref().map(|name| truth[name].in_memory());
        // Neither layer, or both, lie in memory: else the ground is judged piece by piece.
        let ground = match (elevation.in_memory(), classes) {
            (Some(elevation), None) => Some((elevation, None)),
            (Some(elevation), Some(Some(classes))) => Some((elevation, Some(classes))),
            _ => None,
        };
        let ground = ground
            .map(|(elevation, classes)| Traversability::on_classes(vehicle, elevation, classes))
            .transpose()?;
        Ok(Self {
            seed,
            grid: elevation.grid,
            vehicle: vehicle.clone(),
            truth,
            ground,
            instruments,
            prior,
            execution,
            body_radius_m,
        })
    }

    /// Where the world lies.
    #[must_use]
    pub fn grid(&self) -> GridSpec {
        self.grid
    }

    /// What is known before the first look.
    pub(crate) fn known_before(&self) -> &Prior {
        &self.prior
    }

    /// A measured layer as it truly is; none if the mission measures none of that name.
    pub(crate) fn layer_truth(&self, layer: &str) -> Option<&LayerTruth> {
        self.truth.get(layer)
    }

    /// The seed of its chance.
    #[must_use]
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// How the rover moves and works.
    #[must_use]
    pub fn execution(&self) -> &Execution {
        &self.execution
    }

    /// True traversability of the whole ground; none if that does not lie in memory.
    #[must_use]
    pub fn ground(&self) -> Option<&Traversability> {
        self.ground.as_ref()
    }

    /// What the step from a cell to a neighbour truly costs; none if it cannot be taken ([`Traversability::edge`]).
    ///
    /// # Errors
    /// [`TerrainError`] if the ground there cannot be read or judged.
    pub fn edge(&self, from: Cell, to: Cell) -> Result<Option<CostVector>, TerrainError> {
        Ok(self.step(from, to)?.map(|step| step.cost))
    }

    /// What the step from a cell to a neighbour truly does; none if it cannot be taken.
    ///
    /// # Errors
    /// [`TerrainError`] if the ground there cannot be read or judged.
    pub fn step(&self, from: Cell, to: Cell) -> Result<Option<Step>, TerrainError> {
        let near;
        let ground = if let Some(ground) = &self.ground {
            ground
        } else {
            near = self.judged_near(from)?;
            &near
        };
        let Some(cost) = ground.edge(from, to) else { return Ok(None) };
        let rise_m = match (ground.height_m(from), ground.height_m(to)) {
            (Some(below), Some(above)) => f64::from(above) - f64::from(below),
            _ => 0.0,
        };
        let slope_deg = libm::atan2(rise_m, cost.length_m).to_degrees();
        Ok(Some(Step {
            cost: CostVector { neg_ln_r: self.execution.hazard_factor * cost.neg_ln_r, ..cost },
            slip: ground.slip(from, slope_deg).max(ground.slip(to, slope_deg)),
        }))
    }

    /// True traversability of a cell and those around it.
    fn judged_near(&self, from: Cell) -> Result<Traversability, TerrainError> {
        // The cells beside the step are judged too, each by what lies under the rover there.
        let near = self.grid.around(from, 2 + self.footprint_cells());
        let elevation = self.truth[ELEVATION].window(near)?;
        let cut = |layer: Cow<'_, Layer>| {
            if layer.spec().window() == near {
                return Ok(layer.into_owned());
            }
            let first = Cell { row: near.row, col: near.col };
            Ok::<_, TerrainError>(layer.crop(near)?.numbered_from(first))
        };
        let elevation = cut(elevation)?;
        let classes = match &self.execution.slip_layer {
            Some(name) => Some(cut(self.truth[name].window(near)?)?),
            None => None,
        };
        Traversability::on_classes(&self.vehicle, &elevation, classes.as_ref()).map_err(|error| {
            // Heights that no vehicle's limits can be held against, for instance.
            TerrainError::File { name: format!("the ground at {from}"), reason: error.to_string() }
        })
    }

    /// Cells under the rover, to each side of the middle one.
    fn footprint_cells(&self) -> usize {
        (self.vehicle.footprint_radius_m / self.grid.spacing_m()).round().max(1.0) as usize
    }

    /// Whether the true ground is at hand: a log tells of ground larger than memory only what it is.
    #[must_use]
    pub fn is_at_hand(&self) -> bool {
        self.truth.values().all(LayerTruth::is_at_hand)
    }

    /// The classes that readings of a layer may take; none if it holds no classes, or there is no such layer.
    #[must_use]
    pub fn classes(&self, layer: &str) -> Option<&[f32]> {
        match &self.truth.get(layer)?.kind {
            ReadingKind::Class { classes } => Some(classes),
            ReadingKind::Scalar { .. } => None,
        }
    }

    /// Whether nothing is known of a layer but what is handed in ([`Execution::readings`]).
    #[must_use]
    pub fn is_handed_in(&self, layer: &str) -> bool {
        self.truth.get(layer).is_some_and(LayerTruth::is_handed_in)
    }

    /// The instruments.
    #[must_use]
    pub fn instruments(&self) -> &[Instrument] {
        &self.instruments
    }

    /// The true layer of a name, all of it certain; what an all-knowing, noise-free rover would know. None if there
    /// is no such layer in memory.
    #[must_use]
    pub fn truth(&self, layer: &str) -> Option<&Layer> {
        self.truth.get(layer)?.in_memory()
    }

    /// A window of a true layer, its cells numbered as the world's; at least the window, where more is at hand.
    ///
    /// # Errors
    /// [`TerrainError`] if it cannot be read.
    ///
    /// # Panics
    /// If the world has no such layer.
    pub fn truth_near(&self, layer: &str, window: Window) -> Result<Cow<'_, Layer>, TerrainError> {
        self.truth[layer].window(window)
    }

    /// What is known of a window of the ground before the first look.
    ///
    /// # Errors
    /// [`TerrainError`] if the ground cannot be read.
    pub fn prior(
        &self,
        layers: &[LayerSpec],
        window: Window,
    ) -> Result<Vec<LayerWindow>, TerrainError> {
        let measured = layers.iter().filter(|l| matches!(l.source, Source::Measured(_)));
        let mut known = Vec::new();
        for spec in measured {
            let truth = &self.truth[&spec.name];
            if truth.is_handed_in() {
                continue;
            }
            let part = self.grid.part(window)?;
            let (values, u) =
                match &self.prior {
                    Prior::None => continue,
                    Prior::Complete => {
                        let layer = truth.window(window)?;
                        (
                            Raster::from_fn(part, |cell| layer.value(cell)),
                            Raster::from_fn(part, |cell| layer.u(cell)),
                        )
                    }
                    Prior::Averaged { block, u } => truth.averaged(*block, *u as f32, window)?,
                    Prior::FirstLook { uncertainty, pinned, camera_height_m } => {
                        let Some(how) = uncertainty.get(&spec.name) else { continue };
                        let mut u = self.first_look(how, &spec.name, *camera_height_m, part)?;
                        for (_, cell, fixed) in pinned
                            .iter()
                            .filter(|(layer, cell, _)| *layer == spec.name && part.contains(*cell))
                        {
                            u[*cell] = *fixed;
                        }
                        let layer = truth.window(window)?;
                        let values = Raster::from_fn(part, |cell| {
                            if u[cell] < 1.0 { layer.value(cell) } else { 0.0 }
                        });
                        (values, u)
                    }
                };
            known.push(LayerWindow {
                layer: spec.name.clone(),
                window,
                values: values.into_values(),
                uncertainty: u.into_values(),
            });
        }
        Ok(known)
    }

    /// The paper's first-look uncertainty of a layer (Figs 4 and 8).
    fn first_look(
        &self,
        how: &FirstLookU,
        layer: &str,
        camera_height_m: f64,
        part: GridSpec,
    ) -> Result<Raster<f32>, TerrainError> {
        let grid = self.grid;
        Ok(match how {
            FirstLookU::SouthToNorth => {
                let last = (grid.rows() - 1).max(1) as f64;
                Raster::from_fn(part, |cell| ((grid.rows() - 1 - cell.row) as f64 / last) as f32)
            }
            FirstLookU::WestToEast => {
                let last = (grid.cols() - 1).max(1) as f64;
                Raster::from_fn(part, |cell| (cell.col as f64 / last) as f32)
            }
            FirstLookU::Sight(noise) => {
                let observer = Observer {
                    body_radius_m: self.body_radius_m,
                    ..Observer::all_round(self.execution.start, camera_height_m)
                };
                // No limit of range: all that lies between the camera and the window may hide it.
                let start = self.execution.start;
                let sight = part.window().union(grid.around(start, 0));
                let seen = viewshed(&*self.truth[ELEVATION].window(sight)?, &observer);
                let layer = self.layer_number(layer);
                Raster::from_fn(part, |cell| {
                    let hidden = f64::from(u8::from(!seen.is_visible(cell)));
                    let key =
                        [self.seed, Purpose::FirstLook as u64, layer, grid.index(cell) as u64];
                    (hidden + noise * unit_noise(&key)).min(1.0) as f32
                })
            }
        })
    }

    fn layer_number(&self, name: &str) -> u64 {
        // Layers that are handed in draw nothing, and change nothing of what is drawn for the others.
        let mut drawn = self.truth.iter().filter(|(_, truth)| !truth.is_handed_in());
        drawn.position(|(known, _)| known == name).expect("the layer is measured") as u64
    }

    /// What the instruments read from a pose; `look` numbers the look.
    ///
    /// # Errors
    /// [`TerrainError`] if the ground cannot be read.
    pub fn look(&self, pose: Pose, look: u32) -> Result<Vec<LayerWindow>, TerrainError> {
        self.look_despite(&Faults::default(), 0.0, pose, look)
    }

    /// What the instruments read from a pose at a mission time, with what has broken by then.
    pub(crate) fn look_despite(
        &self,
        faults: &Faults,
        time_s: f64,
        pose: Pose,
        look: u32,
    ) -> Result<Vec<LayerWindow>, TerrainError> {
        let mut windows = Vec::new();
        let works = |instrument: &&Instrument| !faults.has_lost(&instrument.name, time_s);
        let bias_m = faults.bias_m(time_s) as f32;
        for instrument in self.instruments.iter().filter(works) {
            let full = instrument.field_of_view_rad >= std::f64::consts::TAU;
            let observer = Observer {
                cell: pose.cell,
                height_m: instrument.height_m,
                range_m: Some(instrument.range_m),
                target_height_m: 0.0,
                body_radius_m: self.body_radius_m,
                field_of_view: (!full).then_some(FieldOfView {
                    azimuth_rad: pose.heading_rad,
                    width_rad: instrument.field_of_view_rad,
                }),
            };
            let range_cells = (instrument.range_m / self.grid.spacing_m()) as usize;
            let in_range = self.grid.around(pose.cell, range_cells);
            let seen = viewshed(&*self.truth[ELEVATION].window(in_range)?, &observer);
            for layer in &instrument.layers {
                let mut read =
                    self.read(instrument, layer, pose.cell, seen.window(), look, |cell| {
                        seen.is_visible(cell)
                    })?;
                if layer == ELEVATION && bias_m != 0.0 {
                    let read_at_all = read.values.iter_mut().zip(&read.uncertainty);
                    read_at_all.filter(|(_, u)| **u < 1.0).for_each(|(z, _)| *z += bias_m);
                }
                windows.push(read);
            }
        }
        Ok(windows)
    }

    /// What one instrument reads of one layer.
    fn read(
        &self,
        instrument: &Instrument,
        layer: &str,
        from: Cell,
        window: Window,
        look: u32,
        visible: impl Fn(Cell) -> bool,
    ) -> Result<LayerWindow, TerrainError> {
        let truth = &self.truth[layer];
        let ground = truth.window(window)?;
        let number = self.layer_number(layer);
        let mut values = Vec::with_capacity(window.rows * window.cols);
        let mut uncertainty = Vec::with_capacity(window.rows * window.cols);
        for cell in window.cells() {
            let share = from.distance(cell) * self.grid().spacing_m() / instrument.range_m;
            let u = (instrument.u0 + (1.0 - instrument.u0) * share * share).clamp(0.0, 1.0);
            if u >= 1.0 || !visible(cell) || !ground.is_known(cell) {
                values.push(0.0);
                uncertainty.push(1.0);
                continue;
            }
            let value = ground.value(cell);
            let key = |purpose: Purpose| {
                [self.seed, purpose as u64, number, self.grid().index(cell) as u64, u64::from(look)]
            };
            let read = match &truth.kind {
                ReadingKind::Scalar { sigma } => {
                    (f64::from(value) + sigma * u * normal_noise(&key(Purpose::Reading))) as f32
                }
                ReadingKind::Class { classes } => {
                    let others: Vec<f32> =
                        classes.iter().copied().filter(|c| *c != value).collect();
                    if unit_noise(&key(Purpose::WrongClass)) < u / 2.0 && !others.is_empty() {
                        let which = unit_noise(&key(Purpose::WhichClass)) * others.len() as f64;
                        others[(which as usize).min(others.len() - 1)]
                    } else {
                        value
                    }
                }
            };
            values.push(read);
            // The sum may round to 1 as f32, which would mean unseen.
            uncertainty.push((u as f32).min(1.0 - f32::EPSILON));
        }
        Ok(LayerWindow { layer: layer.to_owned(), window, values, uncertainty })
    }

    /// What the hazard cameras see around the rover: true heights, and classes where slip depends on them, for certain. They always see far enough to
    /// judge the step that stopped it, so that no decision asks for the same step again.
    ///
    /// # Errors
    /// [`TerrainError`] if the ground cannot be read.
    pub fn close_look(&self, cell: Cell) -> Result<Vec<LayerWindow>, TerrainError> {
        let spacing_m = self.grid().spacing_m();
        let asked = (self.execution.hazard_camera_m / spacing_m).ceil() as usize;
        // A cell is judged by the ground under the footprint around it, or by its neighbours.
        let needed = 1 + self.footprint_cells();
        let window = self.grid().around(cell, asked.max(needed).min(wisdom_grid::MAX_SIDE));
        // What the wheels slip by is seen too: a class the map is wrong about may be what stopped it.
        std::iter::once(ELEVATION)
            .chain(self.execution.slip_layer.as_deref())
            .map(|layer| {
                let truth = self.truth[layer].window(window)?;
                let read = |near: Cell| {
                    if truth.is_known(near) { (truth.value(near), 0.0) } else { (0.0, 1.0) }
                };
                let (values, uncertainty) = window.cells().map(read).unzip();
                Ok(LayerWindow { layer: layer.to_owned(), window, values, uncertainty })
            })
            .collect()
    }

    /// Whether a hazard ends the drive on the step into `cell`, which it enters for the `entry`-th time: the
    /// chance is that of the true hazard over the step, `1 − exp(−λ·length)`.
    #[must_use]
    pub fn hazard_strikes(&self, neg_ln_r: f64, cell: Cell, entry: u32) -> bool {
        let key =
            [self.seed, Purpose::Hazard as u64, self.grid().index(cell) as u64, u64::from(entry)];
        unit_noise(&key) < 1.0 - libm::exp(-neg_ln_r)
    }

    /// The faults that strike in this world.
    pub(crate) fn faults(&self) -> Faults {
        // By name: a fault added to the file changes nothing of the others.
        Faults::new(&self.execution.faults, |name, what| {
            let purpose = if what == 0 { Purpose::Fault } else { Purpose::FaultTime };
            let digest = blake3::hash(name.as_bytes());
            let word = digest.as_bytes()[..8].try_into().expect("a digest has 32 bytes");
            unit_noise(&[self.seed, purpose as u64, u64::from_le_bytes(word)])
        })
    }

    /// The factor on what the step into `cell` costs, entered for the `entry`-th time.
    #[must_use]
    pub fn slip_factor(&self, cell: Cell, entry: u32) -> f64 {
        let key =
            [self.seed, Purpose::Slip as u64, self.grid().index(cell) as u64, u64::from(entry)];
        (1.0 + self.execution.slip_scatter * normal_noise(&key)).clamp(0.5, 2.0)
    }

    /// The factor on what the `n`-th operator of the mission costs.
    #[must_use]
    pub fn service_factor(&self, n: u32) -> f64 {
        let key = [self.seed, Purpose::Service as u64, u64::from(n)];
        (1.0 + self.execution.operator_scatter * normal_noise(&key)).clamp(0.5, 2.0)
    }
}
