//! Where Curiosity stopped, and what its team named: read for comparison, never by the mission.

use std::path::Path;

use anyhow::Context;
use serde_json::Value;
use wisdom_grid::{Cell, GridSpec};

/// A point on the mission's ground, in cells from its north-west corner.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Point {
    /// Cells to the south.
    pub(crate) row: f64,
    /// Cells to the east.
    pub(crate) col: f64,
}

impl Point {
    /// The middle of a cell.
    pub(crate) fn middle(cell: Cell) -> Self {
        Self { row: cell.row as f64 + 0.5, col: cell.col as f64 + 0.5 }
    }

    /// The cell it lies in.
    pub(crate) fn cell(self) -> Cell {
        Cell { row: self.row as usize, col: self.col as usize }
    }

    /// Distance, cells.
    pub(crate) fn distance(self, other: Self) -> f64 {
        let (down, across) = (self.row - other.row, self.col - other.col);
        (down * down + across * across).sqrt()
    }
}

/// A place with the sol it belongs to.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Place {
    /// The target's name; of a stop, empty.
    pub(crate) name: String,
    /// The sol of the stop, or on which the target was named.
    pub(crate) sol: u32,
    /// Where it is.
    pub(crate) at: Point,
}

/// The real stops and targets of a site.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Places {
    /// Where drives ended.
    pub(crate) stops: Vec<Place>,
    /// What was looked at.
    pub(crate) targets: Vec<Place>,
}

impl Places {
    /// Reads `rover_stops.geojson` and `science_targets.geojson` of a folder.
    pub(crate) fn read(folder: &Path, grid: GridSpec) -> anyhow::Result<Self> {
        let of = |name: &str| {
            let path = folder.join(name);
            places(&path, grid).with_context(|| path.display().to_string())
        };
        Ok(Self { stops: of("rover_stops.geojson")?, targets: of("science_targets.geojson")? })
    }

    /// The index of the nearest stop, and how far it is, cells.
    pub(crate) fn nearest_stop(&self, at: Point) -> (usize, f64) {
        nearest(&self.stops, at)
    }

    /// How far the nearest target is, cells.
    pub(crate) fn to_target(&self, at: Point) -> f64 {
        nearest(&self.targets, at).1
    }
}

fn nearest(places: &[Place], at: Point) -> (usize, f64) {
    let distances = places.iter().map(|place| place.at.distance(at)).enumerate();
    distances.min_by(|a, b| a.1.total_cmp(&b.1)).expect("a site has stops and targets")
}

fn places(path: &Path, grid: GridSpec) -> anyhow::Result<Vec<Place>> {
    let object: Value = serde_json::from_slice(&std::fs::read(path)?)?;
    let features = object["features"].as_array().context("no features")?;
    anyhow::ensure!(!features.is_empty(), "no features");
    features
        .iter()
        .map(|feature| {
            let told = &feature["properties"];
            let number = |key: &str| {
                told[key].as_f64().with_context(|| format!("`{key}` is no number: {told}"))
            };
            let at = Point { row: number("row")?, col: number("col")? };
            anyhow::ensure!(grid.contains(at.cell()), "off the ground: {told}");
            let sol = told["sol"].as_str().and_then(|sol| sol.parse().ok());
            Ok(Place {
                name: told["target_plan"].as_str().unwrap_or_default().to_owned(),
                sol: sol.with_context(|| format!("no sol: {told}"))?,
                at,
            })
        })
        .collect()
}
