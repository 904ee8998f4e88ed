//! Cost of one field, beside `pathfinding::dijkstra_all` on the same ground; a decision pays one field a pose.

mod peers;

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use peers::{FLOOR, Flat, pathfinding_reached, random_costs, random_ground};
use wisdom_grid::{Cell, GridSpec, Raster};
use wisdom_planner::{
    FieldOptions, Limits, TravelCache, TravelOptions, Traversability, Vehicle, WeighedGround,
    Weights, field, travel_alternatives, travel_matrix,
};
use wisdom_terrain::Layer;

/// Rolling ground: heights of three waves, so that slopes reach a third of the limit.
fn rolling_heights(side: usize) -> Layer {
    let spec = GridSpec::new(side, side, 1.0).expect("a bench size");
    let height = |cell: Cell| {
        let (x, y) = (cell.col as f64, cell.row as f64);
        (4.0 * (x / 40.0).sin() + 3.0 * (y / 31.0).cos() + 0.2 * ((x + 2.0 * y) / 5.0).sin()) as f32
    };
    Layer::certain(Raster::from_fn(spec, height)).expect("heights are finite")
}

fn fields(c: &mut Criterion) {
    let mut group = c.benchmark_group("field");
    group.sample_size(10);
    for side in [512, 1024, 2048] {
        group.throughput(Throughput::Elements((side * side) as u64));
        let ground = random_ground(side);
        let (source, far) = (Cell::new(side / 2, side / 2), Cell::new(0, 0));
        group.bench_function(BenchmarkId::new("random", side), |bench| {
            bench
                .iter(|| field(&ground, black_box(source), &FieldOptions::default()).neg_ln_r(far));
        });
        let costs = random_costs(side * side);
        let floats = Flat::new(side, |i| FLOOR * costs[i] as f32, f32::INFINITY);
        let integers = Flat::new(side, |i| costs[i], 1 << 24);
        let start = floats.at(source.row, source.col);
        group.bench_function(BenchmarkId::new("random_minimal_ring_f32", side), |bench| {
            bench.iter(|| floats.ring(black_box(start)));
        });
        group.bench_function(BenchmarkId::new("random_minimal_ring_u32", side), |bench| {
            bench.iter(|| integers.ring(black_box(start)));
        });
        group.bench_function(BenchmarkId::new("random_flat_heap_u32", side), |bench| {
            bench.iter(|| integers.heap(black_box(start)));
        });
        if side < 2048 {
            group.bench_function(BenchmarkId::new("random_pathfinding", side), |bench| {
                bench.iter(|| pathfinding_reached(&ground, black_box(ground.spec().index(source))));
            });
        }
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
        let binding = FieldOptions {
            limits: Limits { max_time_s: 20.0 * side as f64, max_energy_j: f64::INFINITY },
            ..FieldOptions::default()
        };
        group.bench_function(BenchmarkId::new("rolling_limited_to_half", side), |bench| {
            bench.iter(|| field(&rolling, black_box(source), &binding).neg_ln_r(far));
        });
        let weights = Weights::sweep(&rolling, 3)[2];
        let weighed = WeighedGround::new(&rolling, weights);
        group.bench_function(BenchmarkId::new("rolling_weighed", side), |bench| {
            bench.iter(|| weighed.field(black_box(source), &FieldOptions::default()).weighed(far));
        });
        group.bench_function(BenchmarkId::new("rolling_weighed_ground", side), |bench| {
            bench.iter(|| WeighedGround::new(black_box(&rolling), weights));
        });
        group.bench_function(BenchmarkId::new("traversability", side), |bench| {
            bench.iter(|| Traversability::new(&Vehicle::default(), black_box(&heights)));
        });
    }
    group.finish();
}

/// A matrix of 50 poses, as many as a busy map has goals; again with alternatives, and after a small change of the
/// map when the last one was kept.
fn matrix(c: &mut Criterion) {
    let ground = random_ground(512);
    let nodes: Vec<Cell> =
        (0..50).map(|i| Cell::new((i * 97) % 512, (i * 211 + 31) % 512)).collect();
    let mut group = c.benchmark_group("travel_matrix");
    group.sample_size(10);
    group.bench_function("50_poses/512", |bench| {
        bench.iter(|| travel_matrix(&ground, black_box(&nodes), Limits::NONE));
    });
    let weights = Weights::sweep(&ground, 4);
    let options = TravelOptions { weights: &weights, ..TravelOptions::default() };
    group.bench_function("50_poses_4_weights/512", |bench| {
        bench.iter(|| travel_alternatives(&ground, black_box(&nodes), &options));
    });
    // Two clusters of poses far apart: what changes beside one leaves the other's routes alone.
    let near = |corner: usize| {
        (0..25).map(move |i| Cell::new(corner + (i * 7) % 60, corner + (i * 11) % 60))
    };
    let mut cache = TravelCache::new();
    let options = TravelOptions::default();
    for corner in [20, 430] {
        let nodes: Vec<Cell> = near(corner).collect();
        let _ = cache.travel(&ground, &nodes, &options);
    }
    let nodes: Vec<Cell> = near(20).collect();
    group.bench_function("25_poses_kept/512", |bench| {
        bench.iter(|| cache.travel(&ground, black_box(&nodes), &options));
    });
    group.finish();
}

criterion_group!(benches, fields, matrix);
criterion_main!(benches);
