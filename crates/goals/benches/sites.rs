//! Cost of the sites of a prize map, beside the textbook's way of sorting all cells; a decision pays it once a look.

#[path = "../tests/by_sorting/mod.rs"]
mod by_sorting;

use std::hint::black_box;

use by_sorting::sites_by_sorting;
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use wisdom_goals::{Extraction, MergeTree, sites};
use wisdom_grid::{Cell, GridSpec, Raster};

/// Evenly spread over [0, 1), a fixed hash of the cell.
fn noise(cell: Cell) -> f64 {
    let mixed =
        (cell.row as u64 * 65_536 + cell.col as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    let mixed = (mixed ^ (mixed >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    (mixed >> 40) as f64 / f64::from(1 << 24)
}

/// Hills some 100 cells apart, in [0, 0.9].
fn hills(cell: Cell) -> f64 {
    let (x, y) = (cell.col as f64, cell.row as f64);
    let waves = (x / 17.0).sin() + (y / 13.0).cos() + ((x + 2.0 * y) / 40.0).sin();
    0.15 * (waves + 3.0)
}

/// Smooth hills under noise, noise alone, and hills in eight steps.
fn maps(side: usize) -> [(&'static str, Raster<f32>); 3] {
    let spec = GridSpec::new(side, side, 1.0).expect("a bench size");
    let map = |of: fn(Cell) -> f64| Raster::from_fn(spec, |cell| of(cell) as f32);
    [
        ("hills", map(|cell| hills(cell) + 0.1 * noise(cell))),
        ("noise", map(noise)),
        ("plateaus", map(|cell| (8.0 * hills(cell) + noise(cell)).floor() / 8.0)),
    ]
}

fn whole_maps(c: &mut Criterion) {
    let mut group = c.benchmark_group("sites");
    group.sample_size(10);
    let extraction = Extraction::default();
    let upper_half = Extraction { percentile_floor: Some(50.0), ..Extraction::default() };
    for side in [64, 256, 1024] {
        group.throughput(Throughput::Elements((side * side) as u64));
        for (name, map) in maps(side) {
            group.bench_function(BenchmarkId::new(name, side), |bench| {
                bench.iter(|| sites(black_box(&map), &extraction));
            });
            group.bench_function(BenchmarkId::new(format!("{name}_upper_half"), side), |bench| {
                bench.iter(|| sites(black_box(&map), &upper_half));
            });
            group.bench_function(BenchmarkId::new(format!("{name}_by_sorting"), side), |bench| {
                bench.iter(|| sites_by_sorting(black_box(&map), &extraction));
            });
        }
    }
    group.finish();
}

/// One window of 64 × 64 cells changes, across four tiles of the tree; then the sites anew.
fn one_window(c: &mut Criterion) {
    let mut group = c.benchmark_group("sites_after_a_window");
    group.sample_size(10);
    let extraction = Extraction::default();
    for (name, map) in maps(1024) {
        let mut changed = map.clone();
        for row in 500..564 {
            for col in 300..364 {
                changed[Cell::new(row, col)] = 0.5 * map[Cell::new(row, col + 7)];
            }
        }
        let mut tree = MergeTree::new(&map);
        let mut turn = [&changed, &map].into_iter().cycle();
        group.bench_function(BenchmarkId::new(name, 1024), |bench| {
            bench.iter(|| {
                let map = turn.next().expect("turns never end");
                tree.update(black_box(map));
                tree.sites(map, &extraction)
            });
        });
    }
    group.finish();
}

criterion_group!(benches, whole_maps, one_window);
criterion_main!(benches);
