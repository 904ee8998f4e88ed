//! Cost of one route between two cells, beside `pathfinding::astar` on the same ground, question by question in turn.
//!
//! `cargo bench -p wisdom-planner --bench astar [-- ROUNDS]`: medians over rounds of 20 questions (9 unless told).
#![expect(clippy::disallowed_methods, reason = "a bench measures time")]
#![expect(clippy::print_stdout, reason = "a bench prints what it measured")]

use std::cell::Cell as Counter;
use std::hint::black_box;
use std::time::Instant;

use pathfinding::prelude::astar;
use wisdom_grid::{Cell, GridSpec, Raster};
use wisdom_planner::{Ground, Router, Traversability, Vehicle};
use wisdom_terrain::Layer;

/// Flat ground with hazards spread evenly over 1 to 100 times the floor (a fixed hash of the index).
fn random_ground(side: usize) -> Traversability {
    let spec = GridSpec::new(side, side, 1.0).expect("a bench size");
    let hash = |i: usize| (i as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 40;
    let ground = Ground {
        elevation: Layer::certain(Raster::filled(spec, 0.0)).expect("flat ground"),
        blocked: Raster::filled(spec, false),
        severity: Raster::filled(spec, 0.0),
        hazard_per_m: Raster::from_fn(spec, |cell| {
            1e-4 * (1 + hash(spec.index(cell)) % 100) as f32
        }),
    };
    Traversability::from_ground(&Vehicle::default(), ground).expect("hazards are positive")
}

/// Rolling ground: heights of three waves, so that slopes reach a third of the limit.
fn rolling_ground(side: usize) -> Traversability {
    let spec = GridSpec::new(side, side, 1.0).expect("a bench size");
    let height = |cell: Cell| {
        let (x, y) = (cell.col as f64, cell.row as f64);
        (4.0 * (x / 40.0).sin() + 3.0 * (y / 31.0).cos() + 0.2 * ((x + 2.0 * y) / 5.0).sin()) as f32
    };
    let heights = Layer::certain(Raster::from_fn(spec, height)).expect("heights are finite");
    Traversability::new(&Vehicle::default(), &heights).expect("a sound vehicle")
}

/// Pairs of cells all over a ground of this side.
fn questions(side: usize) -> Vec<(Cell, Cell)> {
    let at = |a: usize, b: usize| Cell::new(a % side, b % side);
    (0..20)
        .map(|i| (at(i * 97 + 13, i * 211 + 31), at(i * 151 + side / 2, i * 61 + side / 3)))
        .collect()
}

/// The same question for the peer: indices, and costs as integers (a float cost would need a wrapper). Gives the
/// cost and the number of expansions.
fn peer(ground: &Traversability, from: Cell, to: Cell) -> Option<(f64, u64)> {
    const UNIT: f64 = 1e10;
    let spec = ground.spec();
    let lowest = ground.hazard().values().iter().copied().fold(f32::INFINITY, f32::min);
    let count = Counter::new(0);
    let successors = |&at: &usize| {
        count.set(count.get() + 1);
        let cell = spec.cell(at);
        spec.neighbours(cell).filter_map(move |next| {
            let here = f64::from(ground.hazard()[cell]);
            let straight = |a: Cell, b: Cell| a.row == b.row || a.col == b.col;
            let free = |row, col| !ground.is_blocked(Cell::new(row, col));
            let length_m = match straight(cell, next) {
                true => 1.0,
                false if free(cell.row, next.col) && free(next.row, cell.col) => {
                    std::f64::consts::SQRT_2
                }
                false => return None,
            };
            let cost = 0.5 * length_m * (here + f64::from(ground.hazard()[next]));
            free(next.row, next.col).then_some((spec.index(next), (cost * UNIT) as u64))
        })
    };
    let bound = |&at: &usize| {
        let cell = spec.cell(at);
        let (rows, cols) = (cell.row.abs_diff(to.row), cell.col.abs_diff(to.col));
        let octile =
            rows.max(cols) as f64 + (std::f64::consts::SQRT_2 - 1.0) * rows.min(cols) as f64;
        (octile * f64::from(lowest) * UNIT) as u64
    };
    let goal = spec.index(to);
    let (_, cost) = astar(&spec.index(from), successors, bound, |&at| at == goal)?;
    Some((cost as f64 / UNIT, count.get()))
}

/// Nanoseconds on the processor since some moment: other programs' turns do not count where the system keeps books.
fn clock_ns(begin: Instant) -> f64 {
    let booked = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let booked = booked.and_then(|text| text.split(' ').next()?.parse().ok());
    booked.unwrap_or_else(|| begin.elapsed().as_nanos() as f64)
}

fn median(mut of: Vec<f64>) -> f64 {
    of.sort_by(f64::total_cmp);
    of[of.len() / 2]
}

/// What one side took for all questions.
#[derive(Clone, Copy, Default)]
struct Taken {
    ns: f64,
    expansions: u64,
}

impl Taken {
    fn ns_an_expansion(self) -> f64 {
        self.ns / self.expansions as f64
    }
}

fn compare(name: &str, ground: &Traversability, rounds: usize) {
    let questions = questions(ground.spec().rows());
    let mut router = Router::new(ground);
    let begin = Instant::now();
    let mut taken = Vec::new();
    for _ in 0..rounds {
        let (mut ours, mut theirs) = (Taken::default(), Taken::default());
        for &(from, to) in &questions {
            let start = clock_ns(begin);
            let found = router.route(black_box(from), to).expect("open ground");
            let between = clock_ns(begin);
            let (cost, expansions) = peer(ground, black_box(from), to).expect("open ground");
            theirs.ns += clock_ns(begin) - between;
            theirs.expansions += expansions;
            ours.ns += between - start;
            ours.expansions += found.expansions;
            // Whole units: every edge may lose one.
            let lost = 1e-10 * found.route.cells.len() as f64;
            assert!((found.route.cost.neg_ln_r - cost).abs() <= lost, "{from} to {to}");
        }
        taken.push((ours, theirs));
    }
    let median_of = |of: fn(&(Taken, Taken)) -> f64| median(taken.iter().map(of).collect());
    println!(
        "{name:13} {:6.1} ns an expansion, pathfinding {:6.1}; {} expansions, pathfinding {}; {:.1} times as fast",
        median_of(|(ours, _)| ours.ns_an_expansion()),
        median_of(|(_, theirs)| theirs.ns_an_expansion()),
        taken[0].0.expansions,
        taken[0].1.expansions,
        median_of(|(ours, theirs)| theirs.ns / ours.ns),
    );
}

fn main() {
    // Cargo passes flags of its own.
    let rounds = std::env::args().find_map(|word| word.parse().ok()).unwrap_or(9);
    for side in [512, 1024] {
        compare(&format!("random/{side}"), &random_ground(side), rounds);
        compare(&format!("rolling/{side}"), &rolling_ground(side), rounds);
    }
}
