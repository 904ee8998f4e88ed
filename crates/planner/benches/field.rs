//! Cost of one field, beside `pathfinding::dijkstra_all` on the same ground; a decision pays one field a pose.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use pathfinding::prelude::dijkstra_all;
use wisdom_grid::{Cell, GridSpec, Raster};
use wisdom_planner::{FieldOptions, Ground, Limits, Traversability, Vehicle, field, travel_matrix};
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
fn rolling_heights(side: usize) -> Layer {
    let spec = GridSpec::new(side, side, 1.0).expect("a bench size");
    let height = |cell: Cell| {
        let (x, y) = (cell.col as f64, cell.row as f64);
        (4.0 * (x / 40.0).sin() + 3.0 * (y / 31.0).cos() + 0.2 * ((x + 2.0 * y) / 5.0).sin()) as f32
    };
    Layer::certain(Raster::from_fn(spec, height)).expect("heights are finite")
}

/// The same question for the peer: indices, and costs as integers (a float cost would need a wrapper).
fn peer(ground: &Traversability, start: usize) -> usize {
    let spec = ground.spec();
    dijkstra_all(&start, |&at| {
        let here = ground.hazard().values()[at];
        let cell = spec.cell(at);
        spec.neighbours(cell).map(move |to| {
            let mean = f32::midpoint(here, ground.hazard()[to]);
            let length = if to.row == cell.row || to.col == cell.col {
                1.0
            } else {
                std::f32::consts::SQRT_2
            };
            (spec.index(to), (mean * length * 1e7) as u64)
        })
    })
    .len()
}

fn fields(c: &mut Criterion) {
    let mut group = c.benchmark_group("field");
    group.sample_size(10);
    for side in [512, 1024] {
        group.throughput(Throughput::Elements((side * side) as u64));
        let ground = random_ground(side);
        let (source, far) = (Cell::new(side / 2, side / 2), Cell::new(0, 0));
        group.bench_function(BenchmarkId::new("random", side), |bench| {
            bench
                .iter(|| field(&ground, black_box(source), &FieldOptions::default()).neg_ln_r(far));
        });
        group.bench_function(BenchmarkId::new("random_pathfinding", side), |bench| {
            bench.iter(|| peer(&ground, black_box(ground.spec().index(source))));
        });
        let heights = rolling_heights(side);
        let rolling = Traversability::new(&Vehicle::default(), &heights).expect("a sound vehicle");
        group.bench_function(BenchmarkId::new("rolling", side), |bench| {
            bench.iter(|| {
                field(&rolling, black_box(source), &FieldOptions::default()).neg_ln_r(far)
            });
        });
        let limited = FieldOptions {
            limits: Limits { max_time_s: 1e9, max_energy_j: f64::INFINITY },
            ..FieldOptions::default()
        };
        group.bench_function(BenchmarkId::new("rolling_limited", side), |bench| {
            bench.iter(|| field(&rolling, black_box(source), &limited).neg_ln_r(far));
        });
        group.bench_function(BenchmarkId::new("traversability", side), |bench| {
            bench.iter(|| Traversability::new(&Vehicle::default(), black_box(&heights)));
        });
    }
    group.finish();
}

/// A matrix of 50 poses, as many as a busy map has goals.
fn matrix(c: &mut Criterion) {
    let ground = random_ground(512);
    let nodes: Vec<Cell> =
        (0..50).map(|i| Cell::new((i * 97) % 512, (i * 211 + 31) % 512)).collect();
    let mut group = c.benchmark_group("travel_matrix");
    group.sample_size(10);
    group.bench_function("50_poses/512", |bench| {
        bench.iter(|| travel_matrix(&ground, black_box(&nodes), Limits::NONE));
    });
    group.finish();
}

criterion_group!(benches, fields, matrix);
criterion_main!(benches);
