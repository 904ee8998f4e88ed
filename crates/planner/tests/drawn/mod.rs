//! Ground drawn at random, and what a search over it may assume.
#![allow(dead_code, reason = "each test file uses its own part")]

use pathfinding::num_traits::Zero;
use proptest::prelude::*;
use wisdom_grid::{Cell, GridSpec, Raster};
use wisdom_planner::{CostVector, Ground, Traversability, Vehicle};
use wisdom_terrain::Layer;

/// A sum that orders, as `pathfinding` asks for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Total(pub(crate) f64);

impl Eq for Total {}

impl PartialOrd for Total {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Total {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}

impl std::ops::Add for Total {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

impl Zero for Total {
    fn zero() -> Self {
        Self(0.0)
    }

    fn is_zero(&self) -> bool {
        self.0 == 0.0
    }
}

/// Hazards as powers of ten above the floor: all equal, a few values (many ties), many, or a span for the heap.
pub(crate) fn any_ground() -> impl Strategy<Value = Ground> {
    (1..13usize, 1..13usize, 0..4usize).prop_flat_map(|(rows, cols, kind)| {
        let cells = rows * cols;
        (
            prop::collection::vec(0.0..1.0f32, cells),
            prop::collection::vec(prop::bool::weighted(0.25), cells),
            prop::collection::vec(0.0..0.2f32, cells),
        )
            .prop_map(move |(draws, blocked, heights)| {
                let spec = GridSpec::new(rows, cols, 0.5).expect("a small grid");
                let hazard = |draw: f32| match kind {
                    0 => 1e-4,
                    1 => 1e-4 * (1.0 + (3.0 * draw).floor()),
                    2 => 1e-4 * (1.0 + 99.0 * draw),
                    _ => 1e-6 * 10f32.powf(6.0 * draw),
                };
                let hazard_per_m = Raster::from_vec(spec, draws.into_iter().map(hazard).collect());
                Ground {
                    elevation: Layer::certain(
                        Raster::from_vec(spec, heights).expect("a height a cell"),
                    )
                    .expect("heights are finite"),
                    blocked: Raster::from_vec(spec, blocked).expect("a value a cell"),
                    severity: Raster::filled(spec, 0.0),
                    hazard_per_m: hazard_per_m.expect("a hazard a cell"),
                }
            })
    })
}

pub(crate) fn with_ground(ground: Ground) -> Traversability {
    Traversability::from_ground(&Vehicle::default(), ground).expect("hazards are positive")
}

/// A cell of the grid, from a draw in [0, 1).
pub(crate) fn pick(ground: &Traversability, draw: f64) -> Cell {
    ground.spec().cell((draw * ground.spec().len() as f64) as usize)
}

/// The steps that may be taken from a cell, and what they cost.
pub(crate) fn open_steps(ground: &Traversability, from: Cell) -> Vec<(Cell, CostVector)> {
    let spec = ground.spec();
    spec.neighbours(from).filter_map(|to| Some((to, ground.edge(from, to)?))).collect()
}

/// A raster turned by a quarter: the first column, read upwards, becomes the first row.
pub(crate) fn turned<T: Copy>(raster: &Raster<T>) -> Raster<T> {
    let spec = raster.spec();
    let (rows, cols) = (spec.rows(), spec.cols());
    let spec = GridSpec::new(cols, rows, spec.spacing_m()).expect("a small grid");
    Raster::from_fn(spec, |cell| raster[Cell::new(rows - 1 - cell.col, cell.row)])
}

pub(crate) fn mirrored<T: Copy>(raster: &Raster<T>) -> Raster<T> {
    let cols = raster.spec().cols();
    Raster::from_fn(raster.spec(), |cell| raster[Cell::new(cell.row, cols - 1 - cell.col)])
}
