//! What a viewshed costs: a look of the rover pays one exact one of its range, a map of the whole site a fast one.
//!
//! Ground, observer and limits are those that GDAL's own viewshed is run with at the end (`gdal_viewshed.py`, with the Python named by
//! the variable `PYTHON`, or `python3`), in turns with ours, so that the ratios come from one sitting.
#![expect(
    clippy::disallowed_methods,
    clippy::print_stdout,
    reason = "a bench reads the clock and prints what it finds"
)]

#[path = "../tests/viewshed_ground/mod.rs"]
mod viewshed_ground;

use std::hint::black_box;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use rayon::ThreadPool;
use viewshed_ground::rocky_relief;
use wisdom_grid::Cell;
use wisdom_terrain::{Layer, Observer, viewshed, viewshed_fast};

/// The centre cell, 40 units up (paper Fig. 3).
fn observer(side: usize) -> Observer {
    Observer::all_round(Cell::new(side / 2, side / 2), 40.0)
}

fn pool(threads: usize) -> ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads")
}

fn exact(c: &mut Criterion) {
    let ground = rocky_relief(512);
    let look = observer(512);
    let near = Observer { range_m: Some(200.0), ..look };
    let mut group = c.benchmark_group("viewshed/exact");
    group.sample_size(10);
    for threads in [1, 2] {
        let pool = pool(threads);
        group.bench_function(format!("512/{threads} threads"), |bench| {
            bench.iter(|| pool.install(|| viewshed(black_box(&ground), &look)));
        });
        group.bench_function(format!("range 200/{threads} threads"), |bench| {
            bench.iter(|| pool.install(|| viewshed(black_box(&ground), &near)));
        });
    }
}

fn fast(c: &mut Criterion) {
    let mut group = c.benchmark_group("viewshed/fast");
    group.sample_size(20);
    for side in [512, 1024, 2048, 4096] {
        let ground = rocky_relief(side);
        let look = observer(side);
        group.throughput(Throughput::Elements((side * side) as u64));
        for threads in [1, 2] {
            let pool = pool(threads);
            group.bench_with_input(
                BenchmarkId::new(format!("{threads} threads"), side),
                &ground,
                |bench, ground| {
                    bench.iter(|| pool.install(|| viewshed_fast(black_box(ground), &look)));
                },
            );
        }
    }
}

/// Turns taken by each of the two, and calls of each in a turn.
const TURNS: usize = 7;
const CALLS: usize = 7;

fn beside_gdal(_: &mut Criterion) {
    println!(
        "side  seen %  wrong %: fast   GDAL   median ms: fast 1 thread  2 threads    GDAL   ratios"
    );
    for side in [512, 1024, 2048] {
        let ground = rocky_relief(side);
        let truth = viewshed(&ground, &observer(side));
        let fast = viewshed_fast(&ground, &observer(side));
        let cells = ground.spec().len() as f64;
        let differ = |&cell: &Cell| truth.is_visible(cell) != fast.is_visible(cell);
        let wrong = 100.0 * ground.spec().cells().filter(differ).count() as f64 / cells;
        let seen = 100.0 * truth.cells().count() as f64 / cells;

        let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
        let heights: Vec<u8> =
            ground.values().values().iter().flat_map(|height| height.to_le_bytes()).collect();
        let exact: Vec<u8> =
            ground.spec().cells().map(|cell| truth.is_visible(cell).into()).collect();
        std::fs::write(folder.join(format!("{side}.f32")), heights).expect("room for a map");
        std::fs::write(folder.join(format!("{side}.u8")), exact).expect("room for a map");

        let (one, two) = (pool(1), pool(2));
        let (mut ones, mut twos, mut gdals, mut gdal_wrong) = (vec![], vec![], vec![], None);
        for _ in 0..TURNS {
            ones.push(median_ms(&one, &ground, side));
            twos.push(median_ms(&two, &ground, side));
            if let Some((ms, wrong)) = gdal(folder, side) {
                gdals.push(ms);
                gdal_wrong = Some(wrong);
            }
        }
        let (one_ms, two_ms) = (median(&mut ones), median(&mut twos));
        match gdal_wrong {
            Some(gdal_wrong) => {
                let gdal_ms = median(&mut gdals);
                println!(
                    "{side:4} {seen:7.2} {wrong:14.3} {gdal_wrong:6.3} {one_ms:25.2} {two_ms:10.2} {gdal_ms:7.2}   {:.1}x {:.1}x",
                    gdal_ms / one_ms,
                    gdal_ms / two_ms,
                );
            }
            None => println!(
                "{side:4} {seen:7.2} {wrong:14.3}      - {one_ms:25.2} {two_ms:10.2}       -   no Python with GDAL"
            ),
        }
    }
}

fn median_ms(pool: &ThreadPool, ground: &Layer, side: usize) -> f64 {
    let look = observer(side);
    let time = || {
        let start = Instant::now();
        black_box(pool.install(|| viewshed_fast(black_box(ground), &look)));
        start.elapsed().as_secs_f64() * 1e3
    };
    median(&mut (0..CALLS).map(|_| time()).collect::<Vec<f64>>())
}

fn median(times: &mut [f64]) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

/// Median milliseconds of GDAL and the percentage of cells it has wrong.
fn gdal(folder: &Path, side: usize) -> Option<(f64, f64)> {
    let python = std::env::var("PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/gdal_viewshed.py");
    let output = Command::new(python)
        .arg(script)
        .arg(folder)
        .args([side.to_string(), CALLS.to_string()])
        .output()
        .ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    let (ms, wrong) = text.trim().split_once(' ')?;
    Some((ms.parse().ok()?, wrong.parse().ok()?))
}

criterion_group!(benches, exact, fast, beside_gdal);
criterion_main!(benches);
