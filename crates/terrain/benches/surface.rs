//! What the shape of the ground costs: a mission pays for it each time heights come in.
//!
//! Each measure on 512² and 2048² cells, on one thread and on two: into fresh layers (which pays for their memory)
//! and into layers that are there (`into`). Heights are certain, but for `uncertain`, where u differs from cell to
//! cell, and `holes`, where one cell in a thousand is unknown. Criterion's throughput is in cells: 1 Gelem/s is
//! 1 ns a cell.
//!
//! `gdal_surface.py` beside this file measures GDAL and numpy on the same sizes, for ratios in one sitting.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use rayon::{ThreadPool, ThreadPoolBuilder};
use wisdom_grid::{Cell, GridSpec, Raster};
use wisdom_terrain::{Kernel, Layer, Measure, hillshade, measure, measure_into, unit_noise};

const SIDES: [usize; 2] = [512, 2048];

/// Smooth hills under a decimetre of noise.
fn heights(side: usize) -> Raster<f32> {
    let spec = GridSpec::new(side, side, 1.0).expect("a grid");
    Raster::from_fn(spec, |Cell { row, col }| {
        let (x, y) = (col as f64 / 97.0, row as f64 / 61.0);
        let noise = unit_noise(&[row as u64, col as u64]);
        (-4500.0 + 20.0 * (x.sin() + y.cos()) + 0.1 * noise) as f32
    })
}

fn with_u(heights: Raster<f32>, u: impl Fn(Cell) -> f32) -> Layer {
    let uncertainty = Raster::from_fn(heights.spec(), u);
    Layer::new(heights, uncertainty).expect("a layer")
}

fn noise_of(cell: Cell) -> f32 {
    unit_noise(&[cell.row as u64, cell.col as u64, 1]) as f32
}

fn pools() -> [(usize, ThreadPool); 2] {
    [1, 2].map(|threads| {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        (threads, pool)
    })
}

const GRADIENT: [Measure; 1] = [Measure::Gradient(Kernel::Central)];

fn every_hazard(radius_cells: usize) -> [Measure; 4] {
    [
        Measure::Gradient(Kernel::Central),
        Measure::SlopeDeg(Kernel::Central),
        Measure::Step,
        Measure::Roughness { radius_cells },
    ]
}

/// The same measures into fresh layers and into old ones.
fn both_ways<const N: usize>(c: &mut Criterion, name: &str, ground: &Layer, wanted: [Measure; N]) {
    let side = ground.spec().cols();
    let mut group = c.benchmark_group(name);
    group.throughput(Throughput::Elements((side * side) as u64)).sample_size(20);
    let mut layers = measure(ground, wanted);
    for (threads, pool) in pools() {
        let id = |way: &str| BenchmarkId::new(format!("{way}/threads_{threads}"), side);
        group.bench_function(id("fresh"), |bench| {
            pool.install(|| bench.iter(|| measure(black_box(ground), wanted)));
        });
        group.bench_function(id("into"), |bench| {
            pool.install(|| {
                bench.iter(|| measure_into(black_box(ground), wanted, layers.each_mut()));
            });
        });
    }
    group.finish();
}

fn gradients(c: &mut Criterion) {
    for side in SIDES {
        let certain = Layer::certain(heights(side)).expect("finite heights");
        let uncertain = with_u(heights(side), |cell| 0.9 * noise_of(cell));
        let holes = with_u(heights(side), |cell| f32::from(u8::from(noise_of(cell) < 0.001)));
        both_ways(c, "gradient_central", &certain, GRADIENT);
        both_ways(c, "gradient_central_uncertain", &uncertain, GRADIENT);
        both_ways(c, "gradient_central_holes", &holes, GRADIENT);
        both_ways(c, "gradient_horn", &certain, [Measure::Gradient(Kernel::Horn)]);
    }
}

fn hazards(c: &mut Criterion) {
    for side in SIDES {
        let certain = Layer::certain(heights(side)).expect("finite heights");
        let uncertain = with_u(heights(side), |cell| 0.9 * noise_of(cell));
        let holes = with_u(heights(side), |cell| f32::from(u8::from(noise_of(cell) < 0.001)));
        for radius in [1, 2] {
            both_ways(c, &format!("hazards_r{radius}"), &certain, every_hazard(radius));
        }
        both_ways(c, "hazards_r2_uncertain", &uncertain, every_hazard(2));
        both_ways(c, "hazards_r2_holes", &holes, every_hazard(2));
    }
}

/// Figures are shaded once each.
fn shades(c: &mut Criterion) {
    let mut group = c.benchmark_group("hillshade");
    for side in SIDES {
        let ground = Layer::certain(heights(side)).expect("heights are finite");
        group.throughput(Throughput::Elements((side * side) as u64)).sample_size(20);
        for (threads, pool) in pools() {
            group.bench_function(BenchmarkId::new(format!("threads_{threads}"), side), |bench| {
                pool.install(|| bench.iter(|| hillshade(black_box(&ground), 5.5, 0.8)));
            });
        }
    }
    group.finish();
}

criterion_group!(benches, gradients, hazards, shades);
criterion_main!(benches);
