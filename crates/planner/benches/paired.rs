//! A field beside a minimal program and `pathfinding`, taking turns in one process: ratios that other work on the
//! machine disturbs little. `cargo bench --bench paired -- [SIDE ...]`; 512 and 2048 by default.
#![expect(clippy::print_stdout, reason = "a program that reports measurements")]
#![expect(clippy::disallowed_methods, reason = "a program that takes time")]

mod peers;

use std::hint::black_box;
use std::time::Instant;

use peers::{FLOOR, Flat, pathfinding_reached, random_costs, random_ground};
use wisdom_grid::Cell;
use wisdom_planner::{FieldOptions, WeighedGround, Weights, field};

/// Nanoseconds that this thread was running where the system tells (other programs take none of them), else of the
/// clock on the wall.
fn now_ns(started: Instant) -> f64 {
    std::fs::read_to_string("/proc/thread-self/schedstat")
        .ok()
        .and_then(|text| text.split(' ').next()?.parse().ok())
        .unwrap_or_else(|| started.elapsed().as_nanos() as f64)
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn main() {
    let asked: Vec<usize> = std::env::args().skip(1).filter_map(|arg| arg.parse().ok()).collect();
    let started = Instant::now();
    for side in if asked.is_empty() { vec![512, 2048] } else { asked } {
        let (cells, middle) = (side * side, side / 2);
        let (ground, costs) = (random_ground(side), random_costs(side * side));
        let floats = Flat::new(side, |i| FLOOR * costs[i] as f32, f32::INFINITY);
        let integers = Flat::new(side, |i| costs[i], 1 << 24);
        let start = floats.at(middle, middle);
        let source = Cell::new(middle, middle);
        let weights = Weights::new(1.0, 1e-6, 1e-9).expect("positive weights");
        let weighed = WeighedGround::new(&ground, weights);
        let everything = FieldOptions::default();

        let programs: [(&str, &dyn Fn() -> usize); 7] = [
            ("field", &|| usize::from(field(&ground, source, &everything).source() == source)),
            ("minimal ring, f32", &|| floats.ring(start).len()),
            ("minimal ring, u32", &|| integers.ring(start).len()),
            ("flat heap, u32", &|| integers.heap(start).len()),
            ("pathfinding::dijkstra_all", &|| {
                pathfinding_reached(&ground, ground.spec().index(source))
            }),
            ("weighed field", &|| {
                usize::from(weighed.field(source, &everything).source() == source)
            }),
            ("field again", &|| {
                usize::from(field(&ground, source, &everything).source() == source)
            }),
        ];
        // Short runs are repeated to be longer than the clock's tick; the slow peer gets one turn in three.
        let repeats = 1 + (1 << 20) / cells;
        let mut taken = vec![Vec::new(); programs.len()];
        for turn in 0..7 {
            for ((name, program), taken) in programs.iter().zip(&mut taken) {
                if name.starts_with("pathfinding") && turn % 3 != 0 {
                    continue;
                }
                let before = now_ns(started);
                for _ in 0..repeats {
                    black_box(program());
                }
                taken.push((now_ns(started) - before) / (cells * repeats) as f64);
            }
        }
        let far = field(&ground, source, &everything).neg_ln_r(Cell::new(0, 0)).unwrap_or_default();
        println!("{side}²  first cell {:.3}", far / f64::from(FLOOR));
        for ((name, _), times) in programs.iter().zip(&taken) {
            let ratios = times.iter().zip(&taken[0]).map(|(peer, ours)| peer / ours).collect();
            println!(
                "{side}²  {name:26} {:7.1} ns a cell   {:6.2} times the field",
                median(times.clone()),
                median(ratios)
            );
        }
    }
}
