//! The exact viewshed against the definition walked plainly, cell by cell, in whole numbers.

use proptest::prelude::*;
use wisdom_grid::{Cell, GridSpec, Raster};
use wisdom_terrain::{FieldOfView, Layer, Observer, Viewshed, unit_noise, viewshed, viewshed_fast};

/// Heights in quarters of a metre, `None` where unknown: numbers that `f32` and `f64` hold exactly.
#[derive(Debug, Clone)]
struct Ground {
    rows: usize,
    cols: usize,
    quarters: Vec<Option<i32>>,
}

impl Ground {
    fn from_fn(rows: usize, cols: usize, height: impl Fn(usize, usize) -> Option<i32>) -> Self {
        let quarters = (0..rows * cols).map(|i| height(i / cols, i % cols)).collect();
        Self { rows, cols, quarters }
    }

    fn layer(&self) -> Layer {
        let spec = GridSpec::new(self.rows, self.cols, 1.0).expect("a small grid");
        let mut layer = Layer::unknown(spec);
        for (index, height) in self.quarters.iter().enumerate() {
            if let Some(quarters) = height {
                layer.set(spec.cell(index), *quarters as f32 / 4.0, 0.5);
            }
        }
        layer
    }

    fn at(&self, row: i128, col: i128) -> Option<i128> {
        self.quarters[row as usize * self.cols + col as usize].map(i128::from)
    }
}

/// Whether the cell of a row and a column is unknown.
type IsHole = Box<dyn Fn(usize, usize) -> bool>;

/// A camera in quarters of a metre.
#[derive(Debug, Clone, Copy)]
struct Eye {
    row: usize,
    col: usize,
    height: i32,
    target: i32,
}

/// Whether the eye sees a cell, all in whole numbers: every crossing as a fraction of the way, each fraction compared over its denominator.
fn sees(ground: &Ground, eye: Eye, row: usize, col: usize) -> bool {
    let (r0, c0, r1, c1) = (eye.row as i128, eye.col as i128, row as i128, col as i128);
    let (Some(from), Some(to)) = (ground.at(r0, c0), ground.at(r1, c1)) else { return false };
    let (z0, z1) = (from + i128::from(eye.height), to + i128::from(eye.target));
    let mut places: Vec<(i128, i128)> = Vec::new();
    for line in r0.min(r1) + 1..r0.max(r1) {
        places.push(((line - r0) * (r1 - r0).signum(), (r1 - r0).abs()));
    }
    for line in c0.min(c1) + 1..c0.max(c1) {
        places.push(((line - c0) * (c1 - c0).signum(), (c1 - c0).abs()));
    }
    places.into_iter().all(|(k, n)| {
        // The place times n: one coordinate is whole, the other may not be.
        let (y, x) = (r0 * n + (r1 - r0) * k, c0 * n + (c1 - c0) * k);
        let (top, left) = (y.div_euclid(n), x.div_euclid(n));
        let (down, right) = (y.rem_euclid(n), x.rem_euclid(n));
        let share = down + right;
        let near = ground.at(top, left);
        let far = if share == 0 {
            near
        } else {
            ground.at(top + i128::from(down > 0), left + i128::from(right > 0))
        };
        let (Some(near), Some(far)) = (near, far) else { return true };
        near * (n - share) + far * share <= z0 * (n - k) + z1 * k
    })
}

fn observer(eye: Eye) -> Observer {
    Observer {
        target_height_m: f64::from(eye.target) / 4.0,
        ..Observer::all_round(Cell::new(eye.row, eye.col), f64::from(eye.height) / 4.0)
    }
}

/// The first cell at which a viewshed and a truth differ.
fn difference(shed: &Viewshed, spec: GridSpec, truth: impl Fn(Cell) -> bool) -> Option<Cell> {
    spec.cells().find(|&cell| shed.is_visible(cell) != truth(cell))
}

#[track_caller]
fn check(name: &str, ground: &Ground, eye: Eye) {
    let layer = ground.layer();
    let shed = viewshed(&layer, &observer(eye));
    let truth = |cell: Cell| sees(ground, eye, cell.row, cell.col);
    assert_eq!(difference(&shed, layer.spec(), truth), None, "{name}, from {eye:?}");
}

fn noise(seed: u64, row: usize, col: usize) -> f64 {
    unit_noise(&[seed, row as u64, col as u64])
}

/// A cell in each corner, at each edge and inside.
fn posts(rows: usize, cols: usize) -> Vec<(usize, usize)> {
    let (r, c) = (rows - 1, cols - 1);
    vec![
        (0, 0),
        (0, c),
        (r, 0),
        (r, c),
        (0, c / 2),
        (r, c / 3),
        (r / 2, 0),
        (r / 3, c),
        (r / 2, c / 2),
        (r / 3, 2 * c / 3),
    ]
}

#[test]
fn every_shape_of_ground_is_seen_as_the_definition_says() {
    let (rows, cols) = (29, 34);
    let grounds: Vec<(&str, Ground)> = vec![
        ("flat", Ground::from_fn(rows, cols, |_, _| Some(0))),
        ("plane", Ground::from_fn(rows, cols, |row, col| Some(3 * row as i32 - 2 * col as i32))),
        ("steps", Ground::from_fn(rows, cols, |row, col| Some(4 * ((row + col) / 3 % 4) as i32))),
        (
            "cone",
            Ground::from_fn(rows, cols, |row, col| {
                Some(80 - 3 * (row.abs_diff(14).max(col.abs_diff(17))) as i32)
            }),
        ),
        (
            "pit",
            Ground::from_fn(rows, cols, |row, col| {
                Some(2 * (row.abs_diff(14) + col.abs_diff(17)) as i32)
            }),
        ),
        (
            "bowl",
            Ground::from_fn(rows, cols, |row, col| {
                Some((row.abs_diff(14).pow(2) + col.abs_diff(17).pow(2)) as i32)
            }),
        ),
        ("cliff", Ground::from_fn(rows, cols, |_, col| Some(if col > 17 { 100 } else { 0 }))),
        (
            "spikes",
            Ground::from_fn(rows, cols, |row, col| {
                Some(if noise(1, row, col) < 0.05 { 40 } else { 0 })
            }),
        ),
        ("ties", Ground::from_fn(rows, cols, |row, col| Some((2.0 * noise(2, row, col)) as i32))),
        ("rough", Ground::from_fn(rows, cols, |row, col| Some((90.0 * noise(3, row, col)) as i32))),
        (
            "deep",
            Ground::from_fn(rows, cols, |row, col| {
                Some(-18_000 + (9.0 * noise(4, row, col)) as i32)
            }),
        ),
    ];
    let holes: Vec<(&str, IsHole)> = vec![
        ("whole", Box::new(|_, _| false)),
        ("one hole", Box::new(|row, col| (row, col) == (9, 12))),
        ("rows", Box::new(|row, _| row % 3 == 1)),
        ("columns", Box::new(|_, col| col % 2 == 1)),
        ("chequers", Box::new(|row, col| (row + col) % 2 == 1)),
        ("lattice of lone cells", Box::new(|row, col| row % 2 == 1 || col % 2 == 1)),
        (
            "border",
            Box::new(move |row, col| row < 2 || col < 2 || row + 2 >= rows || col + 2 >= cols),
        ),
        ("few", Box::new(|row, col| noise(5, row, col) < 0.1)),
        ("half", Box::new(|row, col| noise(6, row, col) < 0.5)),
        ("most", Box::new(|row, col| noise(7, row, col) < 0.85)),
    ];
    for (name, ground) in &grounds {
        for (hole, is_hole) in &holes {
            for (row, col) in posts(rows, cols) {
                let mut holed = ground.clone();
                for (index, height) in holed.quarters.iter_mut().enumerate() {
                    let at = (index / cols, index % cols);
                    if at != (row, col) && is_hole(at.0, at.1) {
                        *height = None;
                    }
                }
                for (height, target) in [(0, 0), (5, 0), (40, 1)] {
                    check(&format!("{name}, {hole}"), &holed, Eye { row, col, height, target });
                }
            }
        }
    }
}

#[test]
fn maps_of_one_row_or_one_column_are_seen_as_the_definition_says() {
    for (rows, cols) in [(1, 1), (1, 40), (40, 1), (2, 40), (40, 2)] {
        for holes in [0.0, 0.3] {
            let ground = Ground::from_fn(rows, cols, |row, col| {
                (noise(8, row, col) >= holes).then(|| (20.0 * noise(9, row, col)) as i32)
            });
            for (row, col) in [(0, 0), (rows - 1, cols - 1), (rows / 2, cols / 2)] {
                for height in [0, 3, 30] {
                    check("a strip", &ground, Eye { row, col, height, target: 0 });
                }
            }
        }
    }
}

#[test]
fn a_camera_on_unknown_ground_sees_nothing() {
    let ground = Ground::from_fn(9, 9, |row, col| ((row, col) != (4, 4)).then_some(1));
    let eye = Eye { row: 4, col: 4, height: 40, target: 40 };
    assert_eq!(viewshed(&ground.layer(), &observer(eye)).cells().count(), 0);
}

#[test]
fn a_range_that_is_no_number_or_nothing_is_taken_as_the_definition_takes_it() {
    let layer = Ground::from_fn(9, 9, |_, _| Some(1)).layer();
    let from = Observer::all_round(Cell::new(4, 4), 2.0);
    for (range_m, seen) in [(f64::NAN, 0), (0.0, 1), (0.99, 1), (1.0, 5), (f64::INFINITY, 81)] {
        let near = Observer { range_m: Some(range_m), ..from };
        assert_eq!(viewshed(&layer, &near).cells().count(), seen, "{range_m} m");
        assert_eq!(viewshed_fast(&layer, &near).cells().count(), seen, "{range_m} m, fast");
    }
}

#[test]
fn heights_beyond_all_measure_are_left_to_the_definition() {
    let spec = GridSpec::new(7, 7, 1.0).unwrap();
    let layer = Layer::certain(Raster::from_fn(spec, |cell| {
        (9.0 * unit_noise(&[11, cell.row as u64, cell.col as u64])) as f32
    }))
    .unwrap();
    for (height_m, target_height_m, body_radius_m) in [
        (1e300, 0.0, None),
        (f64::NAN, 0.0, None),
        (2.0, f64::INFINITY, None),
        (2.0, 0.0, Some(0.0)),
        (2.0, 0.0, Some(1e-290)),
    ] {
        let camera = Observer {
            target_height_m,
            body_radius_m,
            ..Observer::all_round(Cell::new(2, 3), height_m)
        };
        let shed = viewshed(&layer, &camera);
        assert_eq!(
            difference(&shed, spec, |cell| as_written(&layer, &camera, cell)),
            None,
            "{camera:?}"
        );
    }
}

/// The definition in floating point, crossing by crossing as it is written, for what whole numbers cannot hold.
fn as_written(layer: &Layer, camera: &Observer, to: Cell) -> bool {
    let from = camera.cell;
    if !layer.is_known(from) || !layer.is_known(to) {
        return false;
    }
    let height = |cell: Cell| {
        let height = f64::from(layer.value(cell));
        let Some(radius_m) = camera.body_radius_m else { return height };
        let distance_m = from.distance(cell) * layer.spec().spacing_m();
        height - distance_m * distance_m / (2.0 * radius_m)
    };
    let (eye, mark) = (height(from) + camera.height_m, height(to) + camera.target_height_m);
    let rows = to.row as i64 - from.row as i64;
    let cols = to.col as i64 - from.col as i64;
    let is_clear = |along: i64, across: i64, cell: &dyn Fn(i64, i64) -> Cell| {
        let n = along.abs();
        (1..n).all(|k| {
            let (whole, m) = ((across * k).div_euclid(n), (across * k).rem_euclid(n));
            let near = cell(k * along.signum(), whole);
            let far = if m == 0 { near } else { cell(k * along.signum(), whole + 1) };
            if !layer.is_known(near) || !layer.is_known(far) {
                return true;
            }
            let ground = if m == 0 {
                height(near) * n as f64
            } else {
                height(near) * (n - m) as f64 + height(far) * m as f64
            };
            ground <= eye * (n - k) as f64 + mark * k as f64
        })
    };
    let moved = |from: usize, steps: i64| (from as i64 + steps) as usize;
    is_clear(rows, cols, &|a, b| Cell::new(moved(from.row, a), moved(from.col, b)))
        && is_clear(cols, rows, &|a, b| Cell::new(moved(from.row, b), moved(from.col, a)))
}

/// Rolling ground with spikes and holes, 0.25 m cells, heights far below zero.
fn rolling(side: usize, seed: u64, holes: f64) -> Layer {
    let spec = GridSpec::new(side, side + 9, 0.25).expect("a small grid");
    let mut layer = Layer::unknown(spec);
    for cell in spec.cells() {
        let (x, y) = (cell.col as f64, cell.row as f64);
        let spike = if noise(seed, cell.row, cell.col) < 0.01 { 1.5 } else { 0.0 };
        let height = -4500.0
            + 2.0 * libm::sin(x / 17.0 + seed as f64)
            + 1.5 * libm::cos(y / 11.0)
            + 0.2 * noise(seed + 1, cell.row, cell.col)
            + spike;
        if noise(seed + 2, cell.row, cell.col) >= holes {
            layer.set(cell, height as f32, 0.0);
        }
    }
    layer
}

#[test]
fn a_large_map_is_seen_as_the_definition_says() {
    for (seed, holes, body_radius_m) in [
        (1, 0.0, None),
        (2, 0.05, None),
        (3, 0.0, Some(500.0)),
        (4, 0.3, Some(90.0)),
        (5, 0.0, Some(-300.0)),
    ] {
        let layer = rolling(120, seed, holes);
        for (cell, height_m) in [((60, 60), 2.0), ((0, 128), 6.0), ((119, 40), 0.0)] {
            let cell = Cell::new(cell.0, cell.1);
            let camera = Observer {
                body_radius_m,
                target_height_m: 0.1,
                ..Observer::all_round(cell, height_m)
            };
            let shed = viewshed(&layer, &camera);
            let truth = |to| as_written(&layer, &camera, to);
            assert_eq!(difference(&shed, layer.spec(), truth), None, "seed {seed}, {camera:?}");
        }
    }
}

#[test]
fn any_number_of_threads_sees_the_same() {
    let layer = rolling(90, 6, 0.1);
    let camera = Observer::all_round(Cell::new(31, 70), 3.0);
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| viewshed(&layer, &camera))
    };
    let one = with(1);
    for threads in [2, 3, 8] {
        assert_eq!(one, with(threads), "{threads} threads");
    }
}

fn any_ground() -> impl Strategy<Value = Ground> {
    (
        1..26_usize,
        1..26_usize,
        prop_oneof![Just(2), Just(5), Just(60)],
        prop_oneof![Just(0.0), 0.0..0.9],
        any::<u64>(),
    )
        .prop_map(|(rows, cols, tallest, holes, seed)| {
            Ground::from_fn(rows, cols, |row, col| {
                (noise(seed, row, col) >= holes)
                    .then(|| (f64::from(tallest) * noise(seed ^ 1, row, col)) as i32)
            })
        })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn random_ground_is_seen_as_the_definition_says(
        ground in any_ground(), at in any::<prop::sample::Index>(), height in 0..70, target in 0..9,
        range in prop::option::of(0..30_usize),
        sector in prop::option::of((-7.0..7.0_f64, 0.0..7.0_f64)),
    ) {
        let at = at.index(ground.quarters.len());
        let eye = Eye { row: at / ground.cols, col: at % ground.cols, height, target };
        let layer = ground.layer();
        let camera = Observer {
            range_m: range.map(|range| range as f64),
            field_of_view: sector.map(|(azimuth_rad, width_rad)| FieldOfView { azimuth_rad, width_rad }),
            ..observer(eye)
        };
        let shed = viewshed(&layer, &camera);
        for cell in layer.spec().cells() {
            let (rows, cols) = (cell.row.abs_diff(eye.row), cell.col.abs_diff(eye.col));
            let in_range = range.is_none_or(|range| rows * rows + cols * cols <= range * range);
            let in_sector = sector.is_none_or(|(azimuth, width)| {
                let (east, north) = (cell.col as f64 - eye.col as f64, eye.row as f64 - cell.row as f64);
                let off = (east.atan2(north) - azimuth).rem_euclid(std::f64::consts::TAU);
                let off = off.min(std::f64::consts::TAU - off);
                (rows, cols) == (0, 0) || off <= width / 2.0
            });
            let expected = in_range && in_sector && sees(&ground, eye, cell.row, cell.col);
            prop_assert_eq!(shed.is_visible(cell), expected, "{} of {:?}", cell, camera);
        }
    }

    #[test]
    fn random_ground_on_a_ball_is_seen_as_the_definition_says(
        ground in any_ground(), at in any::<prop::sample::Index>(), height_m in 0.0..9.0_f64,
        target_height_m in -0.5..2.0_f64, radius in 5.0..2000.0_f64,
        range_m in prop::option::of(0.0..30.0_f64),
    ) {
        let at = at.index(ground.quarters.len());
        let layer = ground.layer();
        let camera = Observer {
            range_m,
            target_height_m,
            body_radius_m: Some(radius),
            ..Observer::all_round(layer.spec().cell(at), height_m)
        };
        let shed = viewshed(&layer, &camera);
        let truth = |cell: Cell| {
            range_m.is_none_or(|range_m| {
                let (rows, cols) = (cell.row.abs_diff(camera.cell.row), cell.col.abs_diff(camera.cell.col));
                (rows * rows + cols * cols) as f64 <= range_m * range_m
            }) && as_written(&layer, &camera, cell)
        };
        prop_assert_eq!(difference(&shed, layer.spec(), truth), None);
    }
}
