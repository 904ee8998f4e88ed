//! Readings that are handed in: found by an instrument that the rover does not simulate, or answered late.

use std::collections::BTreeMap;

use wisdom_autonomy::{LayerSpec, LayerWindow, Source};
use wisdom_grid::{Cell, GridSpec};

use crate::MissionError;
use crate::mission::{FAR_M, LATEST_S, Reader, shown};
use crate::truth::{LayerTruth, ReadingKind};

/// A reading of one place that reaches the rover at a given time, wherever the rover is by then.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// The measured layer it is of.
    pub layer: String,
    /// The place.
    pub cell: Cell,
    /// What was read, in the layer's unit: exactly what the rover is told, no noise is added.
    pub value: f32,
    /// Uncertainty at the place, in [0, 1).
    pub u: f64,
    /// Cells nearer than this get the reading too, metres; 0 for the place alone. As with an instrument's range,
    /// their uncertainty grows to 1 there, `u + (1 − u)·(d/radius)²`.
    pub radius_m: f64,
    /// From which mission time on it is known, seconds.
    pub at_s: f64,
}

impl Reading {
    /// The reading as an observation holds it.
    pub(crate) fn window(&self, grid: GridSpec) -> LayerWindow {
        let window = grid.around(self.cell, (self.radius_m / grid.spacing_m()) as usize);
        let (values, uncertainty) = window
            .cells()
            .map(|cell| {
                let distance_m = self.cell.distance(cell) * grid.spacing_m();
                // At the place itself no radius is asked for, it may be 0.
                let share = if cell == self.cell { 0.0 } else { distance_m / self.radius_m };
                let u = self.u + (1.0 - self.u) * share * share;
                // Nearly 1 may round to 1 as f32, which would mean unseen.
                if u < 1.0 { (self.value, (u as f32).min(1.0 - f32::EPSILON)) } else { (0.0, 1.0) }
            })
            .unzip();
        LayerWindow { layer: self.layer.clone(), window, values, uncertainty }
    }
}

impl Reader<'_> {
    /// Whether nothing is known of a layer but what is handed in.
    pub(crate) fn is_handed_in(&self, name: &str) -> bool {
        self.file.layer.iter().any(|layer| layer.handed_in && layer.name == name)
    }

    /// What is handed in, the earliest first; of the same time, as the file has them.
    pub(crate) fn readings(
        &self,
        grid: GridSpec,
        layers: &[LayerSpec],
        truth: &BTreeMap<String, LayerTruth>,
    ) -> Result<Vec<Reading>, MissionError> {
        let mut readings = Vec::new();
        for (i, file) in self.file.reading.iter().enumerate() {
            let index = i.to_string();
            let error = |key: &str, message: String| self.error(&["reading", &index, key], message);
            let number = |key: &str, value, low, high| {
                self.within(&["reading", &index, key], value, low, high)
            };
            let measured = |l: &&LayerSpec| matches!(l.source, Source::Measured(_));
            if !layers.iter().filter(measured).any(|layer| layer.name == file.layer) {
                let known: Vec<&str> =
                    layers.iter().filter(measured).map(|l| l.name.as_str()).collect();
                let known = known.join(", ");
                let message = format!("`{}` is no measured layer; there are {known}", file.layer);
                return Err(error("layer", message));
            }
            let [row, col] = file.cell[..] else {
                let found = file.cell.len();
                return Err(error("cell", format!("{found} numbers; expected two, [row, col]")));
            };
            let cell = Cell { row, col };
            if !grid.contains(cell) {
                return Err(error("cell", format!("{cell} is off {}", shown(grid))));
            }
            let value = number("value", file.value, -f64::from(f32::MAX), f64::from(f32::MAX))?;
            let value = value as f32;
            if let ReadingKind::Class { classes } = &truth[&file.layer].kind
                && !classes.contains(&value)
            {
                let known: Vec<String> = classes.iter().map(ToString::to_string).collect();
                let known = known.join(", ");
                let message = format!("{value}; `{}` has the classes {known}", file.layer);
                return Err(error("value", message));
            }
            readings.push(Reading {
                layer: file.layer.clone(),
                cell,
                value,
                u: number("u", file.u, 0.0, 0.999)?,
                radius_m: number("radius-m", file.radius_m, 0.0, FAR_M)?,
                at_s: number("at-s", file.at_s, 0.0, LATEST_S)?,
            });
        }
        readings.sort_by(|a, b| a.at_s.total_cmp(&b.at_s));
        Ok(readings)
    }
}
