//! Lines of sight: pictures, laws, and an oracle that walks the definition another way.

use std::f64::consts::{FRAC_PI_2, TAU};

use proptest::prelude::*;
use wisdom_grid::{Cell, GridSpec, Raster};
use wisdom_terrain::{
    FieldOfView, Layer, Method, Observer, line_of_sight, unit_noise, viewshed, viewshed_by,
};

/// Heights as digits, `?` unknown; the camera stands on the first cell; seen `.`, hidden `#`.
fn check(ground: &[&str], height_m: f64, expected: &[&str]) {
    let spec = GridSpec::new(ground.len(), ground[0].len(), 1.0).expect("a small picture");
    let mut layer = Layer::unknown(spec);
    for (row, line) in ground.iter().enumerate() {
        for (col, height) in line.chars().enumerate() {
            if let Some(height) = height.to_digit(10) {
                layer.set(Cell { row, col }, height as f32, 0.0);
            }
        }
    }
    let shed = viewshed(&layer, &Observer::all_round(Cell::new(0, 0), height_m));
    let seen: Vec<String> = (0..spec.rows())
        .map(|row| {
            let mark = |col| if shed.is_visible(Cell { row, col }) { '.' } else { '#' };
            (0..spec.cols()).map(mark).collect()
        })
        .collect();
    assert_eq!(seen, expected, "ground {ground:?} from {height_m} m");
}

#[test]
fn a_wall_hides_what_lies_behind_it() {
    check(&["00900"], 1.0, &["...##"]);
}

#[test]
fn a_higher_camera_looks_over_the_wall() {
    check(&["00900"], 40.0, &["....."]);
    check(&["00200"], 4.0, &["...#."]);
}

#[test]
fn a_rock_casts_a_widening_shadow() {
    check(
        &["00000", "00000", "00900", "00000", "00000"],
        2.0,
        &[".....", ".....", "...#.", "..###", "...##"],
    );
}

#[test]
fn a_line_that_grazes_the_ground_is_free() {
    check(&["00000", "00000"], 0.0, &[".....", "....."]);
    check(&["33333", "33333", "33333"], 0.0, &[".....", ".....", "....."]);
    check(&["01234", "12345", "23456"], 0.0, &[".....", ".....", "....."]);
}

#[test]
fn unknown_ground_neither_blocks_nor_is_seen() {
    check(&["00?00"], 1.0, &["..#.."]);
    check(&["00?00", "00900", "00?00"], 1.0, &["..#..", ".....", "..###"]);
}

#[test]
fn a_camera_on_unknown_ground_sees_nothing() {
    check(&["?00"], 1.0, &["###"]);
}

#[test]
fn a_mast_behind_the_wall_is_seen_before_the_ground_is() {
    let spec = GridSpec::new(1, 5, 1.0).unwrap();
    let heights = vec![0.0, 0.0, 2.0, 0.0, 0.0];
    let layer = Layer::certain(Raster::from_vec(spec, heights).unwrap()).unwrap();
    let (from, to) = (Cell::new(0, 0), Cell::new(0, 4));
    assert!(!line_of_sight(&layer, from, 2.0, to, 1.9));
    assert!(line_of_sight(&layer, from, 2.0, to, 2.0));
    let observer = Observer { target_height_m: 2.0, ..Observer::all_round(from, 2.0) };
    assert!(viewshed(&layer, &observer).is_visible(to));
}

#[test]
fn range_is_a_circle_in_metres_between_centres() {
    let layer = Layer::certain(Raster::filled(GridSpec::new(21, 21, 2.0).unwrap(), 0.0)).unwrap();
    let centre = Cell::new(10, 10);
    let observer = Observer { range_m: Some(10.0), ..Observer::all_round(centre, 1.0) };
    let shed = viewshed(&layer, &observer);
    assert_eq!((shed.window().row, shed.window().rows), (5, 11));
    for cell in layer.spec().cells() {
        assert_eq!(shed.is_visible(cell), centre.distance(cell) <= 5.0, "{cell}");
    }
    assert_eq!(shed.cells().count(), 81);
}

#[test]
fn a_field_of_view_is_a_sector_clockwise_from_north() {
    let layer = Layer::certain(Raster::filled(GridSpec::new(9, 9, 1.0).unwrap(), 0.0)).unwrap();
    let centre = Cell::new(4, 4);
    let seen = |azimuth_rad, width_rad| {
        let field_of_view = Some(FieldOfView { azimuth_rad, width_rad });
        let observer = Observer { field_of_view, ..Observer::all_round(centre, 1.0) };
        viewshed(&layer, &observer)
    };
    // A right angle about east, its edges between cell diagonals.
    let east = seen(FRAC_PI_2, FRAC_PI_2 - 0.01);
    for cell in layer.spec().cells() {
        let (d_col, d_row) = (cell.col as i64 - 4, cell.row as i64 - 4);
        assert_eq!(east.is_visible(cell), cell == centre || d_col > d_row.abs(), "{cell}");
    }
    assert_eq!(east, seen(FRAC_PI_2 - 3.0 * TAU, FRAC_PI_2 - 0.01));
    // South-west of west and north of it: a sector across the cut of atan2.
    assert!(
        seen(-3.1, 0.4).is_visible(Cell::new(8, 4)) && seen(3.1, 0.4).is_visible(Cell::new(8, 4))
    );
    assert_eq!(seen(1.0, TAU).cells().count(), 81);
}

/// At distance d the ground of a body of radius R lies d²/2R lower: 100 m away on a ball of 1 km it is 5 m down.
#[test]
fn curvature_hides_the_far_ground() {
    let layer = Layer::certain(Raster::filled(GridSpec::new(1, 101, 1.0).unwrap(), 0.0)).unwrap();
    let ball =
        Observer { body_radius_m: Some(1000.0), ..Observer::all_round(Cell::new(0, 0), 2.0) };
    // The horizon lies at sqrt(2 R h) = 63.2 m.
    let shed = viewshed(&layer, &ball);
    assert!(shed.is_visible(Cell::new(0, 63)));
    assert!(!shed.is_visible(Cell::new(0, 66)));
    assert_eq!(viewshed(&layer, &Observer { body_radius_m: None, ..ball }).cells().count(), 101);
}

#[test]
fn one_thread_and_many_see_the_same() {
    let layer = ground(60, 3, 0.1);
    let look = || viewshed(&layer, &Observer::all_round(Cell::new(30, 30), 3.0));
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap().install(look);
    let many = rayon::ThreadPoolBuilder::new().num_threads(5).build().unwrap().install(look);
    assert_eq!(one, many);
}

/// Random ground with a share of holes. Heights are irrational-looking, so no line grazes by accident.
fn ground(side: usize, seed: u64, holes: f64) -> Layer {
    let spec = GridSpec::new(side, side, 1.0).expect("a small grid");
    let mut layer = Layer::unknown(spec);
    for cell in spec.cells() {
        let i = spec.index(cell) as u64;
        if unit_noise(&[seed, 1, i]) >= holes {
            layer.set(cell, (5.0 * unit_noise(&[seed, 2, i])) as f32, 0.0);
        }
    }
    layer
}

/// The definition in plain coordinates: every place where the segment meets a grid line, in order of distance,
/// with the ground there by linear interpolation between the floor and the ceiling of its fraction.
fn oracle(layer: &Layer, from: Cell, from_m: f64, to: Cell, to_m: f64) -> bool {
    if !layer.is_known(from) || !layer.is_known(to) {
        return false;
    }
    let (r0, c0) = (from.row as f64, from.col as f64);
    let (r1, c1) = (to.row as f64, to.col as f64);
    let (z0, z1) = (f64::from(layer.value(from)) + from_m, f64::from(layer.value(to)) + to_m);
    let mut places = Vec::new();
    for row in from.row.min(to.row) + 1..from.row.max(to.row) {
        places.push((row as f64 - r0) / (r1 - r0));
    }
    for col in from.col.min(to.col) + 1..from.col.max(to.col) {
        places.push((col as f64 - c0) / (c1 - c0));
    }
    places.into_iter().all(|t| {
        // To 1e-9: crossings are rationals with denominators below 20.
        let whole = |v: f64| if (v - v.round()).abs() < 1e-9 { v.round() } else { v };
        let (row, col) = (whole(r0 + t * (r1 - r0)), whole(c0 + t * (c1 - c0)));
        let near = Cell::new(row.floor() as usize, col.floor() as usize);
        let far = Cell::new(row.ceil() as usize, col.ceil() as usize);
        if !layer.is_known(near) || !layer.is_known(far) {
            return true;
        }
        let share = (row - row.floor()) + (col - col.floor());
        let height =
            f64::from(layer.value(near)) * (1.0 - share) + f64::from(layer.value(far)) * share;
        height <= z0 + t * (z1 - z0)
    })
}

proptest! {
    #[test]
    fn the_viewshed_is_the_definition_cell_by_cell(
        seed in any::<u64>(), row in 0..17_usize, col in 0..17_usize,
        height_m in 0.5..9.0_f64, target_height_m in 0.0..1.0_f64, holes in 0.0..0.4_f64,
    ) {
        let layer = ground(17, seed, holes);
        let cell = Cell { row, col };
        let observer = Observer { target_height_m, ..Observer::all_round(cell, height_m) };
        let shed = viewshed(&layer, &observer);
        for to in layer.spec().cells() {
            prop_assert_eq!(shed.is_visible(to), oracle(&layer, cell, height_m, to, target_height_m));
        }
    }

    #[test]
    fn sight_is_mutual(seed in any::<u64>(), a in 0..169_usize, b in 0..169_usize, h in 0.0..4.0_f64) {
        let layer = ground(13, seed, 0.1);
        let (a, b) = (layer.spec().cell(a), layer.spec().cell(b));
        prop_assert_eq!(line_of_sight(&layer, a, h, b, 1.0), line_of_sight(&layer, b, 1.0, a, h));
    }

    #[test]
    fn a_higher_target_is_never_harder_to_see(seed in any::<u64>(), h in 0.0..4.0_f64, more in 0.0..4.0_f64) {
        let layer = ground(13, seed, 0.0);
        let from = Cell::new(6, 6);
        for to in layer.spec().cells() {
            let low = line_of_sight(&layer, from, 2.0, to, h);
            prop_assert!(!low || line_of_sight(&layer, from, 2.0, to, h + more));
        }
    }
}

#[test]
fn a_part_of_the_ground_is_seen_as_the_same_ground_numbered_from_nought() {
    let noise = |cell: Cell| wisdom_terrain::unit_noise(&[3, cell.row as u64, cell.col as u64]);
    let spec = GridSpec::new(60, 70, 2.0).unwrap();
    let first = Cell::new(1000, 300);
    let values = Raster::from_fn(spec, |cell| (noise(cell) * 3.0) as f32);
    let u = Raster::from_fn(spec, |cell| if noise(cell) < 0.05 { 1.0 } else { 0.25 });
    let here = Layer::new(values, u).unwrap();
    let there = here.clone().numbered_from(first);
    let at = |cell: Cell| Cell::new(cell.row + first.row, cell.col + first.col);
    let stand = Cell::new(20, 33);
    for method in [Method::Exact, Method::Fast] {
        for range_m in [None, Some(25.0)] {
            let observer = Observer { range_m, ..Observer::all_round(stand, 4.0) };
            let moved = Observer { cell: at(stand), ..observer };
            let near = viewshed_by(method, &here, &observer);
            let far = viewshed_by(method, &there, &moved);
            assert!(near.cells().map(at).eq(far.cells()), "{method}, {range_m:?}");
            assert!(near.cells().count() > 100);
        }
    }
    for cell in spec.cells() {
        assert_eq!(
            line_of_sight(&here, stand, 1.0, cell, 0.5),
            line_of_sight(&there, at(stand), 1.0, at(cell), 0.5),
            "{cell}"
        );
    }
}
