//! The simulated world: what is true, what instruments read of it, and what driving over it does.
//!
//! Chance is counter-based: a draw is keyed by the seed, by what it is for, by where, and by the number of the
//! look, entry or operator it belongs to. No generator is shared, so the order in which draws are made does not
//! matter, nor the number of threads; two runs that drive alike meet the same chances, and hazards and slip of
//! a cell are the same for the same entry whatever was done before.

use std::collections::BTreeMap;

use wisdom_autonomy::{ELEVATION, LayerSpec, LayerWindow, Pose, Source};
use wisdom_grid::{Cell, GridSpec, Raster, Window};
use wisdom_planner::{PlannerError, Traversability, Vehicle};
use wisdom_terrain::{FieldOfView, Layer, Observer, normal_noise, unit_noise, viewshed};

use crate::file::FirstLookU;

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
}

/// How a layer is read.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum ReadingKind {
    /// A quantity: its error is normal with standard deviation `sigma`·u.
    Scalar { sigma: f64 },
    /// A class: another one of these with probability u/2.
    Class { classes: Vec<f32> },
}

/// A measured layer as it truly is.
#[derive(Debug, Clone)]
pub(crate) struct LayerTruth {
    pub layer: Layer,
    /// The data's own uncertainty, where a file gives one.
    pub site_u: Option<Raster<f32>>,
    pub kind: ReadingKind,
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
    /// Time lost when a hazard aborts a drive, seconds.
    pub recovery_s: f64,
    /// Radius in which ground that stops the rover is seen for certain, metres.
    pub hazard_camera_m: f64,
    /// The most decisions of one mission.
    pub max_decisions: u32,
}

/// The truth, and what chance makes of it.
#[derive(Debug, Clone)]
pub struct World {
    seed: u64,
    truth: BTreeMap<String, LayerTruth>,
    ground: Traversability,
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
        let ground = Traversability::new(vehicle, &truth[ELEVATION].layer)?;
        Ok(Self { seed, truth, ground, instruments, prior, execution, body_radius_m })
    }

    /// Where the world lies.
    #[must_use]
    pub fn grid(&self) -> GridSpec {
        self.ground.spec()
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

    /// True traversability.
    #[must_use]
    pub fn ground(&self) -> &Traversability {
        &self.ground
    }

    /// The instruments.
    #[must_use]
    pub fn instruments(&self) -> &[Instrument] {
        &self.instruments
    }

    /// The true layer of a name, all of it certain; what an all-knowing, noise-free rover would know.
    #[must_use]
    pub fn truth(&self, layer: &str) -> Option<&Layer> {
        self.truth.get(layer).map(|t| &t.layer)
    }

    /// What is known before the first look.
    #[must_use]
    pub fn prior(&self, layers: &[LayerSpec]) -> Vec<LayerWindow> {
        let whole = self.grid().window();
        let measured = layers.iter().filter(|l| matches!(l.source, Source::Measured(_)));
        measured
            .filter_map(|spec| {
                let truth = &self.truth[&spec.name];
                let (values, u) = match &self.prior {
                    Prior::None => return None,
                    Prior::Complete => {
                        (truth.layer.values().clone(), truth.layer.uncertainty().clone())
                    }
                    Prior::Averaged { block, u } => averaged(truth, *block, *u as f32),
                    Prior::FirstLook { uncertainty, pinned, camera_height_m } => {
                        let how = uncertainty.get(&spec.name)?;
                        let mut u = self.first_look(how, &spec.name, *camera_height_m);
                        for (_, cell, fixed) in
                            pinned.iter().filter(|(layer, _, _)| *layer == spec.name)
                        {
                            u[*cell] = *fixed;
                        }
                        let values = Raster::from_fn(self.grid(), |cell| {
                            if u[cell] < 1.0 { truth.layer.value(cell) } else { 0.0 }
                        });
                        (values, u)
                    }
                };
                Some(LayerWindow {
                    layer: spec.name.clone(),
                    window: whole,
                    values: values.values().to_vec(),
                    uncertainty: u.values().to_vec(),
                })
            })
            .collect()
    }

    /// The paper's first-look uncertainty of a layer (Figs 4 and 8).
    fn first_look(&self, how: &FirstLookU, layer: &str, camera_height_m: f64) -> Raster<f32> {
        let grid = self.grid();
        match how {
            FirstLookU::SouthToNorth => {
                let last = (grid.rows() - 1).max(1) as f64;
                Raster::from_fn(grid, |cell| ((grid.rows() - 1 - cell.row) as f64 / last) as f32)
            }
            FirstLookU::WestToEast => {
                let last = (grid.cols() - 1).max(1) as f64;
                Raster::from_fn(grid, |cell| (cell.col as f64 / last) as f32)
            }
            FirstLookU::Sight(noise) => {
                let observer = Observer {
                    body_radius_m: self.body_radius_m,
                    ..Observer::all_round(self.execution.start, camera_height_m)
                };
                let seen = viewshed(&self.truth[ELEVATION].layer, &observer);
                let layer = self.layer_number(layer);
                Raster::from_fn(grid, |cell| {
                    let hidden = f64::from(u8::from(!seen.is_visible(cell)));
                    let key =
                        [self.seed, Purpose::FirstLook as u64, layer, grid.index(cell) as u64];
                    (hidden + noise * unit_noise(&key)).min(1.0) as f32
                })
            }
        }
    }

    fn layer_number(&self, name: &str) -> u64 {
        self.truth.keys().position(|k| k == name).expect("the layer is measured") as u64
    }

    /// What the instruments read from a pose; `look` numbers the look.
    #[must_use]
    pub fn look(&self, pose: Pose, look: u32) -> Vec<LayerWindow> {
        let mut windows = Vec::new();
        for instrument in &self.instruments {
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
            let seen = viewshed(&self.truth[ELEVATION].layer, &observer);
            for layer in &instrument.layers {
                windows.push(self.read(
                    instrument,
                    layer,
                    pose.cell,
                    seen.window(),
                    look,
                    |cell| seen.is_visible(cell),
                ));
            }
        }
        windows
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
    ) -> LayerWindow {
        let truth = &self.truth[layer];
        let number = self.layer_number(layer);
        let mut values = Vec::with_capacity(window.rows * window.cols);
        let mut uncertainty = Vec::with_capacity(window.rows * window.cols);
        for cell in window.cells() {
            let share = from.distance(cell) * self.grid().spacing_m() / instrument.range_m;
            let u = (instrument.u0 + (1.0 - instrument.u0) * share * share).clamp(0.0, 1.0);
            if u >= 1.0 || !visible(cell) || !truth.layer.is_known(cell) {
                values.push(0.0);
                uncertainty.push(1.0);
                continue;
            }
            let value = truth.layer.value(cell);
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
        LayerWindow { layer: layer.to_owned(), window, values, uncertainty }
    }

    /// What the hazard cameras see around the rover: true heights, for certain. They always see far enough to
    /// judge the step that stopped it, so that no decision asks for the same step again.
    #[must_use]
    pub fn close_look(&self, cell: Cell) -> Vec<LayerWindow> {
        let spacing_m = self.grid().spacing_m();
        let asked = (self.execution.hazard_camera_m / spacing_m).ceil() as usize;
        // A cell is judged by the ground under the footprint around it, or by its neighbours.
        let footprint = (self.ground.vehicle().footprint_radius_m / spacing_m).round().max(1.0);
        let needed = 1 + footprint as usize;
        let window = self.grid().around(cell, asked.max(needed).min(wisdom_grid::MAX_SIDE));
        let truth = &self.truth[ELEVATION].layer;
        let read =
            |near: Cell| if truth.is_known(near) { (truth.value(near), 0.0) } else { (0.0, 1.0) };
        let (values, uncertainty) = window.cells().map(read).unzip();
        vec![LayerWindow { layer: ELEVATION.to_owned(), window, values, uncertainty }]
    }

    /// Whether a hazard ends the drive on the step into `cell`, which it enters for the `entry`-th time: the
    /// chance is that of the true hazard over the step, `1 − exp(−λ·length)`.
    #[must_use]
    pub fn hazard_strikes(&self, neg_ln_r: f64, cell: Cell, entry: u32) -> bool {
        let key =
            [self.seed, Purpose::Hazard as u64, self.grid().index(cell) as u64, u64::from(entry)];
        unit_noise(&key) < 1.0 - libm::exp(-neg_ln_r)
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

/// Block means of the truth, as from orbit: bilinear between the middles of the blocks for quantities (steps
/// at block edges would be cliffs to a slope expert), the commonest class of each block for classes. The
/// uncertainty is `u`, or the data's own where larger.
fn averaged(truth: &LayerTruth, block: usize, u: f32) -> (Raster<f32>, Raster<f32>) {
    let layer = &truth.layer;
    let grid = layer.spec();
    let (rows, cols) = (grid.rows().div_ceil(block), grid.cols().div_ceil(block));
    let part = |row: usize, col: usize| {
        let (row, col) = (row * block, col * block);
        Window { row, col, rows: block.min(grid.rows() - row), cols: block.min(grid.cols() - col) }
    };
    let u = Raster::from_fn(grid, |cell| {
        let own = truth.site_u.as_ref().map_or(0.0, |own| own[cell]);
        if layer.is_known(cell) { u.max(own) } else { 1.0 }
    });
    let known = |w: Window| w.cells().filter(|c| layer.is_known(*c)).collect::<Vec<_>>();
    let values = match &truth.kind {
        ReadingKind::Class { classes } => {
            let commonest = |w: Window| {
                let cells = known(w);
                let count = |class: f32| cells.iter().filter(|c| layer.value(**c) == class).count();
                let mut best = (count(0.0), 0.0f32);
                for &class in classes {
                    if count(class) > best.0 {
                        best = (count(class), class);
                    }
                }
                best.1
            };
            let blocks: Vec<f32> =
                (0..rows * cols).map(|i| commonest(part(i / cols, i % cols))).collect();
            Raster::from_fn(grid, |c| blocks[(c.row / block) * cols + c.col / block])
        }
        ReadingKind::Scalar { .. } => {
            // A block of which nothing is known has no mean, and must not be mixed into its neighbours.
            let mean = |w: Window| {
                let cells = known(w);
                let first = f64::from(layer.value(*cells.first()?));
                let above: f64 = cells.iter().map(|c| f64::from(layer.value(*c)) - first).sum();
                Some(first + above / cells.len() as f64)
            };
            let blocks: Vec<Option<f64>> =
                (0..rows * cols).map(|i| mean(part(i / cols, i % cols))).collect();
            Raster::from_fn(grid, |c| {
                let along = |at: usize, count: usize| {
                    let place =
                        ((at as f64 + 0.5) / block as f64 - 0.5).clamp(0.0, (count - 1) as f64);
                    let low = (place as usize).min(count.saturating_sub(2));
                    (low, (low + 1).min(count - 1), place - low as f64)
                };
                let ((north, south, down), (west, east, right)) =
                    (along(c.row, rows), along(c.col, cols));
                let mix = |a: Option<f64>, b: Option<f64>, share: f64| match (a, b) {
                    (Some(a), Some(b)) => Some(a + (b - a) * share),
                    (one, other) => one.or(other),
                };
                let upper = mix(blocks[north * cols + west], blocks[north * cols + east], right);
                let lower = mix(blocks[south * cols + west], blocks[south * cols + east], right);
                mix(upper, lower, down).unwrap_or(0.0) as f32
            })
        }
    };
    let seen = Raster::from_fn(grid, |cell| if u[cell] < 1.0 { values[cell] } else { 0.0 });
    (seen, u)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn block_means_of_a_plane_are_the_plane_inside() {
        let grid = GridSpec::new(24, 24, 1.0).unwrap();
        let plane = Raster::from_fn(grid, |c| c.row as f32 * 2.0 - c.col as f32);
        let truth = LayerTruth {
            layer: Layer::certain(plane.clone()).unwrap(),
            site_u: None,
            kind: ReadingKind::Scalar { sigma: 0.0 },
        };
        let (values, u) = averaged(&truth, 8, 0.6);
        for row in 4..20 {
            for col in 4..20 {
                let cell = Cell { row, col };
                assert!((values[cell] - plane[cell]).abs() < 1e-4, "{cell}");
            }
        }
        assert!(u.values().iter().all(|u| *u == 0.6));
    }

    #[test]
    fn a_block_without_data_is_not_mixed_into_its_neighbours() {
        let grid = GridSpec::new(16, 16, 1.0).expect("a grid");
        let values = Raster::from_fn(grid, |c| if c.col < 8 { -4500.0f32 } else { 0.0 });
        let u = Raster::from_fn(grid, |c| if c.col < 8 { 0.0f32 } else { 1.0 });
        let truth = LayerTruth {
            layer: Layer::new(values, u).expect("a layer"),
            site_u: None,
            kind: ReadingKind::Scalar { sigma: 0.0 },
        };
        let (values, u) = averaged(&truth, 8, 0.6);
        for cell in grid.cells() {
            let expected = if cell.col < 8 { (-4500.0, 0.6) } else { (0.0, 1.0) };
            assert_eq!((values[cell], u[cell]), expected, "{cell}");
        }
    }

    #[test]
    fn the_commonest_class_stands_for_its_block() {
        let grid = GridSpec::new(4, 4, 1.0).unwrap();
        let classes = Raster::from_fn(grid, |c| if c.col < 3 { 2.0f32 } else { 1.0 });
        let truth = LayerTruth {
            layer: Layer::certain(classes).unwrap(),
            site_u: Some(Raster::filled(grid, 0.9)),
            kind: ReadingKind::Class { classes: vec![1.0, 2.0] },
        };
        let (values, u) = averaged(&truth, 4, 0.6);
        assert!(values.values().iter().all(|c| *c == 2.0));
        assert!(u.values().iter().all(|u| *u == 0.9));
    }
}
