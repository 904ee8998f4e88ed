//! What experts read: one reading judged twice, and rows that none can meet.

use std::collections::BTreeSet;

use wisdom_autonomy::{Derivation, ELEVATION, Source};
use wisdom_fusion::Rows;
use wisdom_grid::{Cell, Window};
use wisdom_terrain::{Layer, TerrainError, step};

use super::{Lint, Linter, short};
use crate::fault::FaultKind;
use crate::truth::{LayerTruth, ReadingKind};
use crate::world::Prior;

/// How many standard deviations a reading may be off: one of 16 000 normal errors is further off.
const SIGMAS: f64 = 4.0;

/// The largest ground that is looked through for what a layer holds, cells.
const MOST_CELLS: usize = 1 << 24;

/// Side of the pieces in which larger ground is read, cells.
const PIECE: usize = 1024;

/// What a layer may read.
enum Readings {
    /// From the least to the largest, errors included.
    Range(f64, f64),
    /// These values, as bits of f32.
    Classes(BTreeSet<u32>),
}

impl Linter<'_> {
    /// Experts that judge the same reading.
    pub(super) fn sensors(&mut self) {
        let experts = &self.mission.spec.experts;
        for (j, second) in experts.iter().enumerate() {
            let origin = self.origin(&second.layer);
            let Some(first) = experts[..j].iter().find(|e| self.origin(&e.layer) == origin) else {
                continue;
            };
            let both = if first.layer == second.layer {
                format!("both read layer `{}`", first.layer)
            } else {
                format!(
                    "read `{}` and `{}`, which both come from {origin}",
                    first.layer, second.layer
                )
            };
            let message = format!(
                "experts `{}` and `{}` {both}: fusion takes 1 reading for 2 independent ones, and doubts count \
                 twice. Make one table of the two, or give one of them a layer of its own",
                first.name, second.name
            );
            self.warn(Lint::SensorCountedTwice, &["experts", &j.to_string()], message);
        }
    }

    /// The measurement that a layer comes from, in words.
    fn origin(&self, layer: &str) -> String {
        let layer = if self.mission.spec.measures(layer) { layer } else { ELEVATION };
        let file = self.file.layer.iter().find(|l| l.name == layer).and_then(|l| l.file.as_ref());
        match file {
            Some(file) => format!("file `{file}`"),
            None => format!("layer `{layer}`"),
        }
    }

    /// Rows of tables that no reading meets.
    pub(super) fn rows(&mut self) {
        for (i, expert) in self.mission.spec.experts.iter().enumerate() {
            // What will be handed in is not the mission's to know: its own readings are examples.
            if self.mission.world.is_handed_in(&expert.layer) {
                continue;
            }
            let readings = match self.readings(&expert.layer) {
                Ok(readings) => readings,
                Err(reason) => {
                    let message = format!("row-never-read of expert `{}`: {reason}", expert.name);
                    self.warn(Lint::NotChecked, &["experts", &i.to_string()], message);
                    continue;
                }
            };
            let file = &self.file.experts[i].clone();
            let unit = expert.table.unit();
            let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
            let unmet: Vec<(&str, usize, String)> = match (expert.table.rows(), &readings) {
                (Rows::Bands(bands), Readings::Range(least, most)) => bands
                    .iter()
                    .enumerate()
                    .filter(|(_, band)| band.lo > *most || band.hi <= *least)
                    .map(|(row, band)| {
                        let found = format!("[{}, {})", band.lo, band.hi);
                        ("band", row, format!("{found}{unit} holds no reading"))
                    })
                    .collect(),
                (Rows::Bands(bands), Readings::Classes(known)) => bands
                    .iter()
                    .enumerate()
                    .filter(|(_, band)| {
                        let holds = |bits: &u32| {
                            (band.lo as f32..band.hi as f32).contains(&f32::from_bits(*bits))
                        };
                        !known.iter().any(holds)
                    })
                    .map(|(row, band)| {
                        ("band", row, format!("[{}, {}) holds no class", band.lo, band.hi))
                    })
                    .collect(),
                (Rows::Classes(classes), _) => classes
                    .iter()
                    .enumerate()
                    .filter(|(_, row)| match &readings {
                        Readings::Classes(known) => !known.contains(&(row.class as f32).to_bits()),
                        Readings::Range(least, most) => {
                            !(*least..=*most).contains(&f64::from(row.class))
                        }
                    })
                    .map(|(row, class)| ("class", row, format!("{} is no reading", class.class)))
                    .collect(),
            };
            let all = match &readings {
                Readings::Range(least, most) => format!(
                    "it reads from {} to {}, with {SIGMAS} sigma of error",
                    short(*least),
                    short(*most)
                ),
                Readings::Classes(known) => {
                    let known: Vec<String> =
                        known.iter().map(|bits| f32::from_bits(*bits).to_string()).collect();
                    format!("it has {}", known.join(", "))
                }
            };
            for (kind, row, found) in unmet {
                let message = format!(
                    "{found} of layer `{}` in this mission: {all}. Drop the row, or correct it",
                    expert.layer
                );
                let path = [kind, &row.to_string()];
                self.warn_in(file.clone(), Lint::RowNeverRead, &path, message);
            }
        }
    }

    /// What a layer may read on this mission's ground, or why that is not known.
    fn readings(&self, layer: &str) -> Result<Readings, String> {
        let spec = &self.mission.spec;
        let source = spec.layers.iter().find(|l| l.name == layer).map(|l| l.source);
        match source {
            Some(Source::Derived(derivation)) => self.derived(derivation),
            _ => self.measured(self.truth(layer)?, layer == ELEVATION),
        }
    }

    fn truth(&self, layer: &str) -> Result<&LayerTruth, String> {
        let truth = self.mission.world.layer_truth(layer).ok_or("nothing is known of its layer")?;
        if !truth.is_at_hand() {
            return Err("the file of its layer is not at hand".to_owned());
        }
        if truth.grid.len() > MOST_CELLS {
            let cells = truth.grid.len();
            return Err(format!("its ground of {cells} cells is larger than {MOST_CELLS}"));
        }
        Ok(truth)
    }

    fn measured(&self, truth: &LayerTruth, is_elevation: bool) -> Result<Readings, String> {
        match &truth.kind {
            ReadingKind::Scalar { sigma } => {
                let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
                each_known(truth, |value| {
                    least = least.min(f64::from(value));
                    most = most.max(f64::from(value));
                })
                .map_err(|e| e.to_string())?;
                let off = SIGMAS * sigma + if is_elevation { self.bias_m() } else { 0.0 };
                Ok(Readings::Range(least - off, most + off))
            }
            ReadingKind::Class { classes } => {
                let mut known: BTreeSet<u32> =
                    classes.iter().map(|class| class.to_bits()).collect();
                each_known(truth, |class| {
                    known.insert(class.to_bits());
                })
                .map_err(|e| e.to_string())?;
                Ok(Readings::Classes(known))
            }
        }
    }

    /// Bounds of a derived layer, whatever part of the ground is known and however its heights are off within their
    /// errors: from 0 to more than any map of it holds.
    fn derived(&self, derivation: Derivation) -> Result<Readings, String> {
        let truth = self.truth(ELEVATION)?;
        let heights =
            truth.in_memory().ok_or("its layer comes from ground that is read in pieces")?;
        let off_m = self.height_error_m(truth, heights).map_err(|e| e.to_string())?;
        let width_m = truth.grid.spacing_m();
        let highest_step_m = || most_known(&step(heights)) + 2.0 * off_m;
        let gradient = || steepest(heights) + 2.0 * std::f64::consts::SQRT_2 * off_m / width_m;
        let most = match derivation {
            Derivation::Gradient => gradient(),
            Derivation::Slope => libm::atan(gradient()).to_degrees(),
            Derivation::Step => highest_step_m(),
            // No residual is larger than the heights under the footprint differ.
            _ => {
                let radius_m = self.mission.spec.vehicle.footprint_radius_m;
                2.0 * (radius_m / width_m).round().max(1.0) * highest_step_m()
            }
        };
        Ok(Readings::Range(0.0, most))
    }

    /// How far a height that the rover knows may be off, metres: errors, faults, and what a view from orbit blurs.
    fn height_error_m(&self, truth: &LayerTruth, heights: &Layer) -> Result<f64, TerrainError> {
        let sigma = match &truth.kind {
            ReadingKind::Scalar { sigma } => *sigma,
            ReadingKind::Class { .. } => 0.0,
        };
        let blur_m = match self.mission.world.known_before() {
            Prior::Averaged { block, u } => {
                let (blurred, u) = truth.averaged(*block, *u as f32, truth.grid.window())?;
                let known = truth.grid.cells().filter(|c| u[*c] < 1.0 && heights.is_known(*c));
                known.fold(0.0, |most: f64, cell| {
                    most.max(f64::from((blurred[cell] - heights.value(cell)).abs()))
                })
            }
            _ => 0.0,
        };
        Ok(SIGMAS * sigma + self.bias_m() + blur_m)
    }

    fn bias_m(&self) -> f64 {
        let faults = &self.mission.world.execution().faults;
        let biases = faults.iter().map(|fault| match fault.kind {
            FaultKind::DemBias { bias_m } => bias_m.abs(),
            _ => 0.0,
        });
        biases.sum()
    }
}

/// Every known value of a layer, piece by piece.
fn each_known(truth: &LayerTruth, mut visit: impl FnMut(f32)) -> Result<(), TerrainError> {
    let (rows, cols) = (truth.grid.rows(), truth.grid.cols());
    for row in (0..rows).step_by(PIECE) {
        for col in (0..cols).step_by(PIECE) {
            let window =
                Window { row, col, rows: PIECE.min(rows - row), cols: PIECE.min(cols - col) };
            let layer = truth.window(window)?;
            for cell in window.cells().filter(|cell| layer.is_known(*cell)) {
                visit(layer.value(cell));
            }
        }
    }
    Ok(())
}

fn most_known(layer: &Layer) -> f64 {
    let known = layer.spec().cells().filter(|cell| layer.is_known(*cell));
    known.fold(0.0, |most: f64, cell| most.max(f64::from(layer.value(cell))))
}

/// The steepest gradient that any part of the neighbours can make, rise over run.
fn steepest(heights: &Layer) -> f64 {
    let spec = heights.spec();
    let known = |row: usize, col: usize| {
        let cell = Cell { row, col };
        (spec.contains(cell) && heights.is_known(cell)).then(|| f64::from(heights.value(cell)))
    };
    let mut most = 0.0_f64;
    for Cell { row, col } in spec.cells() {
        let Some(here) = known(row, col) else { continue };
        let rise = |neighbours: [Option<f64>; 2]| {
            let rises = neighbours.into_iter().flatten().map(|there| (there - here).abs());
            rises.fold(0.0, f64::max)
        };
        let down = rise([row.checked_sub(1).and_then(|row| known(row, col)), known(row + 1, col)]);
        let across =
            rise([col.checked_sub(1).and_then(|col| known(row, col)), known(row, col + 1)]);
        most = most.max(libm::hypot(down, across));
    }
    most / spec.spacing_m()
}
