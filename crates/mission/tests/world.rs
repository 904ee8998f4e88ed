//! The simulated world: what instruments read, how wrong they are, what is known beforehand, and that chance
//! does not depend on the order in which it is asked.

mod small;

use wisdom_autonomy::{LayerWindow, Pose};
use wisdom_grid::Cell;
use wisdom_mission::{Mission, Override, World};
use wisdom_terrain::{Observer, viewshed};

/// A rock between the rover and the west edge.
const ROCK: &str = r#"
[base]
elevation_m = 0.0
rise_east = 0.0
rise_north = 0.0
texture = 2
temperature = 3.0

[[rock]]
centre = [13.0, 20.0]
half-axes = [2.0, 4.0]
height_m = 12.0
wall = "ramp"
wall_cells = 1.1
"#;

const MIDDLE: Cell = Cell { row: 20, col: 20 };

fn level() -> String {
    small::LEVEL.replace("texture = 0", "texture = 2")
}

fn mission(landscape: &str, changes: &[(&str, &str)]) -> Mission {
    small::mission(landscape, changes).expect("the small mission is sound")
}

fn pose(cell: Cell) -> Pose {
    Pose { cell, heading_rad: 0.0 }
}

fn of<'a>(windows: &'a [LayerWindow], layer: &str) -> &'a LayerWindow {
    windows.iter().find(|w| w.layer == layer).expect("the layer is read")
}

/// Cell, reading and uncertainty, one by one.
fn readings(window: &LayerWindow) -> impl Iterator<Item = (Cell, f32, f32)> + '_ {
    window
        .window
        .cells()
        .zip(window.values.iter().zip(&window.uncertainty))
        .map(|(cell, (value, u))| (cell, *value, *u))
}

#[test]
fn uncertainty_grows_with_the_square_of_the_distance() {
    let world = mission(&level(), &[]).world;
    let windows = world.look(pose(MIDDLE), 0).expect("it is in memory");
    assert_eq!(windows.len(), 3);
    for window in &windows {
        let mut seen = 0;
        for (cell, value, u) in readings(window) {
            let (down, right) = (cell.row as f64 - 20.0, cell.col as f64 - 20.0);
            let squared = down * down + right * right;
            if squared < 15.0 * 15.0 {
                let expected = 0.02 + 0.98 * squared / (15.0 * 15.0);
                assert!((f64::from(u) - expected).abs() < 1e-6, "{cell}: {u}, not {expected}");
                seen += 1;
            } else {
                assert_eq!((value, u), (0.0, 1.0), "{cell} is out of range");
            }
        }
        assert!(seen > 650, "{seen} cells within 15 m");
    }
}

#[test]
fn hidden_cells_stay_unknown_in_every_layer() {
    let world = mission(ROCK, &[]).world;
    let elevation = world.truth("elevation").expect("it is measured");
    let observer = Observer { range_m: Some(15.0), ..Observer::all_round(MIDDLE, 3.0) };
    let sight = viewshed(elevation, &observer);
    let mut hidden = 0;
    for window in world.look(pose(MIDDLE), 0).expect("it is in memory") {
        for (cell, value, u) in readings(&window) {
            let near = cell.distance(MIDDLE) < 15.0;
            assert_eq!(near && sight.is_visible(cell), u < 1.0, "{}: {cell}", window.layer);
            if u == 1.0 {
                assert_eq!(value, 0.0, "{}: {cell}", window.layer);
                hidden += u32::from(near);
            }
        }
    }
    assert!(hidden > 60, "the rock hides {hidden} cells in three layers");
}

#[test]
fn a_narrow_camera_sees_only_ahead() {
    let narrow = ("u0 = 0.02", "u0 = 0.02\nfield-of-view-deg = 90.0");
    let world = mission(&level(), &[narrow]).world;
    let east = Pose { cell: MIDDLE, heading_rad: std::f64::consts::FRAC_PI_2 };
    let windows = world.look(east, 0).expect("it is in memory");
    let seen = |cell: Cell| {
        readings(of(&windows, "elevation")).any(|(near, _, u)| near == cell && u < 1.0)
    };
    assert!(seen(Cell { row: 20, col: 28 }) && seen(Cell { row: 23, col: 28 }));
    assert!(!seen(Cell { row: 20, col: 12 }) && !seen(Cell { row: 10, col: 22 }));
}

#[test]
fn readings_depend_on_seed_cell_and_look_and_on_nothing_else() {
    let world = mission(ROCK, &[]).world;
    let ask = |look: u32| world.look(pose(MIDDLE), look).expect("it is in memory");
    let forwards: Vec<_> = (0..4).map(ask).collect();
    let mut backwards: Vec<_> = (0..4).rev().map(ask).collect();
    backwards.reverse();
    assert_eq!(forwards, backwards);
    assert_ne!(forwards[0], forwards[1], "another look has other errors");
    let other = mission(ROCK, &[("seed = 1", "seed = 2")]).world;
    assert_ne!(
        other.look(pose(MIDDLE), 0).expect("it is in memory"),
        forwards[0],
        "another seed has other errors"
    );
    // From another place the same draw is scaled by another u.
    let there = world.look(pose(Cell { row: 24, col: 21 }), 0).expect("it is in memory");
    let errors = |windows: &[LayerWindow]| {
        readings(of(windows, "temperature"))
            .filter(|(_, _, u)| *u < 1.0)
            .map(|(cell, value, u)| (cell, (value - 3.0) / u))
            .collect::<Vec<_>>()
    };
    let here = errors(&forwards[0]);
    let mut compared = 0;
    for (cell, error) in errors(&there) {
        if let Some((_, same)) = here.iter().find(|(c, _)| *c == cell) {
            // Readings near 3 are rounded to 2.4e-7, which a u of 0.02 turns into 1.2e-5.
            assert!((error - same).abs() < 3e-5, "{cell}: {error} and {same}");
            compared += 1;
        }
    }
    assert!(compared > 300, "{compared} cells seen from both");
}

/// What `look`s 0 to `count` read of a layer, known cells only, with the true value subtracted where it is one.
fn many(world: &World, layer: &str, count: u32) -> Vec<(f64, f64)> {
    (0..count)
        .flat_map(|look| {
            let windows = world.look(pose(MIDDLE), look).expect("it is in memory");
            readings(of(&windows, layer))
                .filter(|(_, _, u)| *u < 1.0)
                .map(|(_, value, u)| (f64::from(value), f64::from(u)))
                .collect::<Vec<_>>()
        })
        .collect()
}

#[test]
fn classes_are_wrong_with_half_of_their_uncertainty() {
    let world = mission(&level(), &[]).world;
    let read = many(&world, "texture", 60);
    let near: Vec<_> = read.iter().filter(|(_, u)| *u < 0.4).collect();
    let far: Vec<_> = read.iter().filter(|(_, u)| *u >= 0.4).collect();
    for part in [near, far] {
        let expected: f64 = part.iter().map(|(_, u)| u / 2.0).sum();
        let variance: f64 = part.iter().map(|(_, u)| u / 2.0 * (1.0 - u / 2.0)).sum();
        let wrong = part.iter().filter(|(class, _)| *class != 2.0).count() as f64;
        // Five standard deviations: one in two million.
        assert!((wrong - expected).abs() < 5.0 * variance.sqrt(), "{wrong} of {expected}");
    }
    // The wrong ones are the other classes, evenly.
    let count = |class: f64| read.iter().filter(|(c, _)| *c == class).count() as f64;
    let others = [count(1.0), count(3.0), count(4.0)];
    let mean = others.iter().sum::<f64>() / 3.0;
    assert!(others.iter().all(|n| (n - mean).abs() < 5.0 * mean.sqrt()), "{others:?}");
    assert_eq!(read.len() as f64, count(2.0) + others.iter().sum::<f64>());
}

#[test]
fn quantities_are_off_by_sigma_times_their_uncertainty() {
    let world = mission(&level(), &[]).world;
    for (layer, truth, sigma) in [("elevation", 0.0, 0.1), ("temperature", 3.0, 1.0)] {
        let scaled: Vec<f64> = many(&world, layer, 40)
            .into_iter()
            .map(|(value, u)| (value - truth) / (sigma * u))
            .collect();
        let n = scaled.len() as f64;
        let mean = scaled.iter().sum::<f64>() / n;
        let variance = scaled.iter().map(|z| z * z).sum::<f64>() / n;
        // Standard errors of the mean and of the variance of n normal numbers, five times.
        assert!(mean.abs() < 5.0 / n.sqrt(), "{layer}: mean {mean}");
        assert!((variance - 1.0).abs() < 5.0 * (2.0 / n).sqrt(), "{layer}: variance {variance}");
    }
}

fn prior(mission: &Mission) -> Vec<LayerWindow> {
    let whole = mission.spec.grid.window();
    mission.world.prior(&mission.spec.layers, whole).expect("it is in memory")
}

#[test]
fn what_is_known_beforehand_is_nothing_everything_or_block_means() {
    let none = mission(ROCK, &[("kind = \"averaged\"\nblock = 8\nu = 0.6", "kind = \"none\"")]);
    assert!(prior(&none).is_empty());

    let complete = mission(ROCK, &[("kind = \"averaged\"", "kind = \"complete\"")]);
    let windows = prior(&complete);
    assert_eq!(windows.len(), 3, "derived layers are not told");
    for window in &windows {
        let truth = complete.world.truth(&window.layer).expect("it is measured");
        assert!(readings(window).all(|(cell, value, u)| value == truth.value(cell) && u == 0.0));
    }

    let averaged = mission(ROCK, &[]);
    let windows = prior(&averaged);
    for window in &windows {
        assert_eq!(window.window, averaged.spec.grid.window());
        assert!(window.uncertainty.iter().all(|u| *u == 0.6), "{}", window.layer);
    }
    let heights = of(&windows, "elevation");
    let highest = heights.values.iter().copied().fold(0.0f32, f32::max);
    let truth = averaged.world.truth("elevation").expect("it is measured");
    let top = truth.values().values().iter().copied().fold(0.0f32, f32::max);
    assert!(highest > 0.5 && highest < top / 2.0, "from orbit {highest} m of {top} m are left");
}

#[test]
fn the_paper_s_first_look_has_its_printed_uncertainties() {
    let paper = Mission::load(&small::shipped("paper"), &[]).expect("it ships");
    let windows = prior(&paper);
    let u =
        |layer: &str, x: usize, y: usize| of(&windows, layer).uncertainty[(101 - y) * 101 + x - 1];
    // Table 6, at (67, 20).
    assert!((u("temperature", 67, 20) - 0.19).abs() < 1e-6);
    assert!((u("texture", 67, 20) - 0.66).abs() < 1e-6);
    assert_eq!(u("elevation", 67, 20), 0.0);
    // The ramps run over the whole scene, whatever is in sight.
    for k in 1..=101 {
        let share = (k - 1) as f32 / 100.0;
        assert!((u("temperature", 5, k) - share).abs() < 1e-6, "y = {k}");
        assert!((u("texture", k, 5) - share).abs() < 1e-6, "x = {k}");
    }
    // The DEM is seen or not, with noise in [0, 0.2) on both.
    let observer = Observer::all_round(Cell { row: 50, col: 50 }, 40.0);
    let sight = viewshed(paper.world.truth("elevation").expect("it is measured"), &observer);
    let (mut seen, mut hidden) = (0, 0);
    for (cell, _, u) in readings(of(&windows, "elevation")) {
        if sight.is_visible(cell) {
            assert!(u < 0.2, "{cell}: {u}");
            seen += 1;
        } else {
            assert_eq!(u, 1.0, "{cell}");
            hidden += 1;
        }
    }
    assert!(seen > 8000 && hidden > 1000, "{seen} in sight, {hidden} hidden");
    let other = Mission::load(&small::shipped("paper"), &[Override::new("seed", "2")]);
    assert_ne!(prior(&other.expect("it ships")), windows, "the noise follows the seed");
}

#[test]
fn hazards_strike_with_the_chance_of_the_ground_and_of_the_entry() {
    let world = mission(&level(), &[]).world;
    let cells: Vec<Cell> = world.grid().cells().collect();
    for chance in [0.02f64, 0.3] {
        let neg_ln_r = -(1.0 - chance).ln();
        let struck = |entry: u32| {
            cells.iter().filter(|c| world.hazard_strikes(neg_ln_r, **c, entry)).count()
        };
        let total: usize = (1..=20).map(struck).sum();
        let n = (cells.len() * 20) as f64;
        let spread = 5.0 * (n * chance * (1.0 - chance)).sqrt();
        assert!((total as f64 - n * chance).abs() < spread, "{total} of {n} at {chance}");
    }
    // Common random numbers: what strikes on safe ground strikes on ground less safe.
    for cell in cells {
        assert!(!world.hazard_strikes(0.01, cell, 1) || world.hazard_strikes(0.2, cell, 1));
        assert!(!world.hazard_strikes(0.0, cell, 1));
    }
}

#[test]
fn the_hazard_cameras_judge_the_step_that_stopped_the_rover() {
    let wide = (
        "[rover.vehicle]",
        "[execution]\nhazard-camera-m = 0.0\n\n[rover.vehicle]\nfootprint-radius-m = 3.0",
    );
    let world = mission(ROCK, &[wide]).world;
    let windows = world.close_look(MIDDLE).expect("it is in memory");
    assert_eq!(windows.len(), 1);
    let seen = of(&windows, "elevation");
    // One step, and the footprint around where it leads.
    assert_eq!((seen.window.rows, seen.window.cols), (9, 9));
    let truth = world.truth("elevation").expect("it is measured");
    assert!(readings(seen).all(|(cell, value, u)| u == 0.0 && value == truth.value(cell)));
}
