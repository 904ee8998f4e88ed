//! The ground that is measured, and what it is measured beside.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use pathfinding::prelude::dijkstra_all;
use wisdom_grid::{GridSpec, Raster};
use wisdom_planner::{Ground, Traversability, Vehicle};
use wisdom_terrain::Layer;

/// Smallest hazard of the random ground, per metre; the largest is 100 times as much.
pub(crate) const FLOOR: f32 = 1e-4;

/// Hazards spread evenly over 1 to 100 floors (a fixed hash of the index).
pub(crate) fn random_costs(cells: usize) -> Vec<u32> {
    let hash = |i: u64| (i ^ i >> 29).wrapping_mul(0xBF58_476D_1CE4_E5B9) >> 32;
    (0..cells as u64)
        .map(|i| 1 + (hash((i + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15)) % 100) as u32)
        .collect()
}

/// Flat ground with the hazards of [`random_costs`].
pub(crate) fn random_ground(side: usize) -> Traversability {
    let spec = GridSpec::new(side, side, 1.0).expect("a bench size");
    let hazard = random_costs(side * side).into_iter().map(|cost| FLOOR * cost as f32).collect();
    let ground = Ground {
        elevation: Layer::certain(Raster::filled(spec, 0.0)).expect("flat ground"),
        blocked: Raster::filled(spec, false),
        severity: Raster::filled(spec, 0.0),
        hazard_per_m: Raster::from_vec(spec, hazard).expect("a hazard a cell"),
    };
    Traversability::from_ground(&Vehicle::default(), ground).expect("hazards are positive")
}

/// `pathfinding` asked the same question: indices, and costs as integers (a float cost would need a wrapper).
pub(crate) fn pathfinding_reached(ground: &Traversability, start: usize) -> usize {
    let spec = ground.spec();
    dijkstra_all(&start, |&at| {
        let here = ground.hazard().values()[at];
        let cell = spec.cell(at);
        spec.neighbours(cell).map(move |to| {
            let mean = f32::midpoint(here, ground.hazard()[to]);
            let straight = to.row == cell.row || to.col == cell.col;
            let length = if straight { 1.0 } else { std::f32::consts::SQRT_2 };
            (spec.index(to), (mean * length * 1e7) as u64)
        })
    })
    .len()
}

/// The simplest programs that do the work: a square of costs within a rim that is never entered, distances, and a
/// queue. No blocked cells, no routes, no rule for ties.
#[derive(Debug)]
pub(crate) struct Flat<T> {
    /// Cells in a row, the rim included.
    width: usize,
    costs: Vec<T>,
}

/// Numbers of buckets: above the ratio of the largest to the smallest step.
const BUCKETS: usize = 256;

impl<T: Copy> Flat<T> {
    /// The costs of a square, `rim` around them.
    pub(crate) fn new(side: usize, cost: impl Fn(usize) -> T, rim: T) -> Self {
        let width = side + 2;
        let mut costs = vec![rim; width * width];
        for row in 0..side {
            for col in 0..side {
                costs[(row + 1) * width + col + 1] = cost(row * side + col);
            }
        }
        Self { width, costs }
    }

    /// Where a cell of the square lies.
    pub(crate) fn at(&self, row: usize, col: usize) -> usize {
        (row + 1) * self.width + col + 1
    }

    fn offsets(&self) -> [isize; 8] {
        let w = self.width as isize;
        [-w - 1, -w, -w + 1, -1, 1, w - 1, w, w + 1]
    }
}

impl Flat<f32> {
    /// Distances from a cell by a ring of buckets, in `f32`.
    pub(crate) fn ring(&self, start: usize) -> Vec<f32> {
        const DIAGONAL: f32 = 0.5 * std::f32::consts::SQRT_2;
        let half = [DIAGONAL, 0.5, DIAGONAL, 0.5, 0.5, DIAGONAL, 0.5, DIAGONAL];
        let offsets = self.offsets();
        // Narrower than the smallest step by more than the rounding of an f32.
        let per_width = 1.0 / (0.9 * FLOOR);
        let mut found = vec![f32::INFINITY; self.costs.len()];
        let mut ring: Vec<Vec<u32>> = vec![Vec::new(); BUCKETS];
        found[start] = 0.0;
        ring[0].push(start as u32);
        let (mut now, mut waiting) = (0, 1);
        while waiting > 0 {
            let mut bucket = std::mem::take(&mut ring[now % BUCKETS]);
            waiting -= bucket.len();
            for &at in &bucket {
                let at = at as usize;
                let base = found[at];
                if (base * per_width) as usize != now {
                    continue;
                }
                let here = self.costs[at];
                for k in 0..8 {
                    let to = at.wrapping_add_signed(offsets[k]);
                    let offer = base + half[k] * (here + self.costs[to]);
                    if offer < found[to] {
                        found[to] = offer;
                        ring[(offer * per_width) as usize % BUCKETS].push(to as u32);
                        waiting += 1;
                    }
                }
            }
            bucket.clear();
            ring[now % BUCKETS] = bucket;
            now += 1;
        }
        found
    }
}

/// Halved steps in integers: a diagonal is 7/5 of a straight one.
const HALF: [u32; 8] = [7, 5, 7, 5, 5, 7, 5, 7];

impl Flat<u32> {
    /// Distances from a cell by a ring of buckets, in `u32`.
    pub(crate) fn ring(&self, start: usize) -> Vec<u32> {
        let offsets = self.offsets();
        let mut found = self.nothing_found(start);
        let mut ring: Vec<Vec<u32>> = vec![Vec::new(); BUCKETS];
        ring[0].push(start as u32);
        let (mut now, mut waiting) = (0, 1);
        while waiting > 0 {
            let mut bucket = std::mem::take(&mut ring[now % BUCKETS]);
            waiting -= bucket.len();
            for &at in &bucket {
                let at = at as usize;
                let base = found[at];
                // Eight is the largest power of two below the smallest step, which is ten.
                if (base / 8) as usize != now {
                    continue;
                }
                let here = self.costs[at];
                for k in 0..8 {
                    let to = at.wrapping_add_signed(offsets[k]);
                    let offer = base + HALF[k] * (here + self.costs[to]);
                    if offer < found[to] {
                        found[to] = offer;
                        ring[(offer / 8) as usize % BUCKETS].push(to as u32);
                        waiting += 1;
                    }
                }
            }
            bucket.clear();
            ring[now % BUCKETS] = bucket;
            now += 1;
        }
        found
    }

    /// Distances from a cell by the standard library's heap.
    pub(crate) fn heap(&self, start: usize) -> Vec<u32> {
        let offsets = self.offsets();
        let mut found = self.nothing_found(start);
        let mut heap = BinaryHeap::from([Reverse((0, start as u32))]);
        while let Some(Reverse((base, at))) = heap.pop() {
            let at = at as usize;
            if base != found[at] {
                continue;
            }
            for k in 0..8 {
                let to = at.wrapping_add_signed(offsets[k]);
                let offer = base + HALF[k] * (self.costs[at] + self.costs[to]);
                if offer < found[to] {
                    found[to] = offer;
                    heap.push(Reverse((offer, to as u32)));
                }
            }
        }
        found
    }

    /// No distance is found yet but the start's; the rim's are 0, so that nothing improves them.
    fn nothing_found(&self, start: usize) -> Vec<u32> {
        let mut found = vec![u32::MAX; self.costs.len()];
        for at in 0..self.width {
            let (last, row) = (self.width - 1, self.width);
            for rim in [at, last * row + at, at * row, at * row + last] {
                found[rim] = 0;
            }
        }
        found[start] = 0;
        found
    }
}
