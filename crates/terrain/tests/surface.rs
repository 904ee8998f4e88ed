//! Gradient, slope, step, roughness and hillshade on ground whose answers are known.

use proptest::prelude::*;
use wisdom_grid::{Cell, GridSpec, Raster, Window};
use wisdom_terrain::{
    Hazards, Kernel, Layer, Measure, TerrainError, gradient, hazards, hillshade, measure,
    measure_into, normal_noise, roughness, slope, step, unit_noise,
};

fn spec(rows: usize, cols: usize, spacing_m: f64) -> GridSpec {
    GridSpec::new(rows, cols, spacing_m).expect("a small grid")
}

fn known(spec: GridSpec, height: impl FnMut(Cell) -> f32) -> Layer {
    Layer::certain(Raster::from_fn(spec, height)).expect("finite heights")
}

/// Heights as digits, `?` unknown.
fn picture(rows: &[&str]) -> Layer {
    let mut layer = Layer::unknown(spec(rows.len(), rows[0].len(), 1.0));
    for (row, line) in rows.iter().enumerate() {
        for (col, height) in line.chars().enumerate() {
            if let Some(height) = height.to_digit(10) {
                layer.set(Cell { row, col }, height as f32, 0.0);
            }
        }
    }
    layer
}

#[test]
fn a_plane_has_its_own_gradient_everywhere_borders_included() {
    let plane = known(spec(7, 9, 2.0), |c| 6.0 * c.col as f32 - 8.0 * c.row as f32);
    assert!(gradient(&plane).values().values().iter().all(|&g| g == 5.0));
    let degrees = slope(&plane).value(Cell::new(3, 3));
    assert!((degrees - 78.690_07).abs() < 1e-4, "{degrees}");
}

/// In f32 the heights near -4500 m step by 0.5 mm; the difference of two is exact.
#[test]
fn deep_ground_keeps_its_small_slopes() {
    let deep = known(spec(5, 5, 1.0), |c| -4500.0 + c.col as f32 / 1024.0);
    assert!(gradient(&deep).values().values().iter().all(|&g| g == 1.0 / 1024.0));
}

#[test]
fn a_cell_beside_shadow_keeps_its_gradient_by_a_one_sided_difference() {
    let g = gradient(&picture(&["048", "04?", "048"]));
    assert_eq!(g.value(Cell::new(1, 1)), 4.0);
    assert_eq!(g.u(Cell::new(1, 1)), 0.0);
}

#[test]
fn an_axis_without_a_known_neighbour_leaves_the_gradient_unknown() {
    let g = gradient(&picture(&["0?0", "048", "0?0"]));
    assert_eq!((g.value(Cell::new(1, 1)), g.u(Cell::new(1, 1))), (0.0, 1.0));
    // A grid of one row has no neighbours along columns at all.
    assert!(!gradient(&picture(&["0123"])).is_known(Cell::new(0, 1)));
}

/// The central difference does not touch the cell itself; a one-sided one cannot do without it.
#[test]
fn a_gap_of_one_cell_is_bridged_but_its_edge_is_not_invented() {
    assert_eq!(gradient(&picture(&["024", "0?4", "024"])).value(Cell::new(1, 1)), 2.0);
    assert!(!gradient(&picture(&["02?", "0??", "02?"])).is_known(Cell::new(1, 1)));
}

#[test]
fn a_gradient_is_as_uncertain_as_its_worst_cell() {
    let mut layer = picture(&["000", "000", "000"]);
    layer.set(Cell::new(0, 1), 0.0, 0.3);
    layer.set(Cell::new(1, 1), 0.0, 0.9);
    let g = gradient(&layer);
    // The middle takes its four neighbours, not itself; a border cell takes the middle one.
    assert_eq!((g.u(Cell::new(1, 1)), g.u(Cell::new(1, 0))), (0.3, 0.9));
}

#[test]
fn a_step_is_the_largest_difference_to_a_known_neighbour() {
    let s = step(&picture(&["900", "05?", "000"]));
    assert_eq!(s.value(Cell::new(1, 1)), 5.0);
    assert_eq!(s.value(Cell::new(0, 0)), 9.0);
    assert_eq!(s.value(Cell::new(2, 2)), 5.0);
    assert!(!s.is_known(Cell::new(1, 2)));
    assert!(!step(&picture(&["?", "1", "?"])).is_known(Cell::new(1, 0)));
}

#[test]
fn a_tilted_plane_is_not_rough() {
    let plane = known(spec(9, 9, 1.0), |c| -4500.0 + 0.5 * c.col as f32 + 0.25 * c.row as f32);
    for (cell, &rms_m) in roughness(&plane, 2).values().iter() {
        assert!(rms_m < 1e-9, "{rms_m} at {cell}");
    }
}

/// By symmetry the fit is level at h/n, so the squares sum to h²(1 − 1/n) and their mean is h²(n − 1)/n².
#[test]
fn a_stone_in_the_middle_gives_the_residual_of_a_level_fit() {
    let stone = known(spec(9, 9, 1.0), |c| if c == Cell::new(4, 4) { 1.0 } else { 0.0 });
    let cells = 13.0_f64; // within two cells of the centre
    let expected = ((cells - 1.0) / (cells * cells)).sqrt();
    let rms_m = f64::from(roughness(&stone, 2).value(Cell::new(4, 4)));
    assert!((rms_m - expected).abs() < 1e-7, "{rms_m} {expected}");
}

#[test]
fn too_few_cells_for_a_plane_are_unknown_not_smooth() {
    assert!(!roughness(&picture(&["1?", "11"]), 1).is_known(Cell::new(1, 0)));
    assert!(!roughness(&picture(&["123456"]), 3).is_known(Cell::new(0, 3)));
}

#[test]
fn a_slope_facing_the_light_is_brighter_than_level_ground_and_one_turned_away_darker() {
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};
    let shade = |rise: f32| {
        let ramp = Raster::from_fn(spec(5, 5, 1.0), |c| rise * c.col as f32);
        let ramp = Layer::certain(ramp).unwrap();
        hillshade(&ramp, 3.0 * FRAC_PI_2, FRAC_PI_4)[Cell::new(2, 2)] // light from the west
    };
    assert!((shade(1.0) - 1.0).abs() < 1e-6, "ground that rises away from the light faces it");
    assert!((shade(0.0) - FRAC_PI_4.sin() as f32).abs() < 1e-6);
    assert!(shade(-1.0).abs() < 1e-6);
}

/// Horn's formula in double precision, edges repeated.
#[test]
fn shading_is_the_cosine_between_light_and_normal() {
    let (azimuth_rad, altitude_rad) = (5.5_f64, 0.8_f64);
    for (rows, cols) in [(1, 1), (1, 40), (40, 1), (2, 2), (9, 70)] {
        let heights = Raster::from_fn(spec(rows, cols, 0.5), |c| {
            -4500.0 + normal_noise(&[c.row as u64, c.col as u64]) as f32
        });
        let ground = Layer::certain(heights.clone()).unwrap();
        for (cell, &bright) in hillshade(&ground, azimuth_rad, altitude_rad).iter() {
            let z = |d_row: usize, d_col: usize| {
                let row = (cell.row + d_row).saturating_sub(1).min(rows - 1);
                let col = (cell.col + d_col).saturating_sub(1).min(cols - 1);
                f64::from(heights[Cell { row, col }])
            };
            let east = z(0, 2) + 2.0 * z(1, 2) + z(2, 2) - z(0, 0) - 2.0 * z(1, 0) - z(2, 0);
            let north = z(0, 0) + 2.0 * z(0, 1) + z(0, 2) - z(2, 0) - 2.0 * z(2, 1) - z(2, 2);
            let (east, north) = (east / 4.0, north / 4.0); // eight cells of half a metre
            let level = east * azimuth_rad.sin() + north * azimuth_rad.cos();
            let towards = altitude_rad.sin() - level * altitude_rad.cos();
            let expected = (towards / (1.0 + east * east + north * north).sqrt()).max(0.0);
            assert!((f64::from(bright) - expected).abs() < 1e-6, "{bright} {expected} at {cell}");
        }
    }
}

#[test]
fn one_thread_and_many_give_the_same_bits() {
    let layer =
        known(spec(90, 120, 1.0), |c| normal_noise(&[1, c.row as u64, c.col as u64]) as f32);
    let all = || (gradient(&layer), slope(&layer), step(&layer), roughness(&layer, 3));
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap().install(all);
    let many = rayon::ThreadPoolBuilder::new().num_threads(5).build().unwrap().install(all);
    assert_eq!(one, many);
}

#[test]
fn a_layer_refuses_what_is_not_a_reading() {
    let spec = spec(1, 2, 1.0);
    let raster = |values: [f32; 2]| Raster::from_vec(spec, values.to_vec()).unwrap();
    let zero = raster([0.0, 0.0]);
    let nan = Layer::new(raster([0.0, f32::NAN]), zero.clone()).unwrap_err();
    assert!(matches!(nan, TerrainError::Reading { cell: Cell { row: 0, col: 1 }, .. }));
    let u = Layer::new(zero.clone(), raster([1.5, 0.0])).unwrap_err();
    assert_eq!(u.to_string(), "the uncertainty at (row 0, col 0) is 1.5; it lies in [0, 1]");
    assert!(Layer::new(zero.clone(), raster([f32::NAN, 0.0])).is_err());
    let elsewhere = Raster::filled(spec.at(5.0, 5.0), 0.0);
    assert!(matches!(Layer::new(zero, elsewhere), Err(TerrainError::GridMismatch { .. })));
}

#[test]
fn an_unknown_cell_keeps_no_reading() {
    let mut layer = picture(&["12", "34"]);
    layer.set(Cell::new(0, 1), 7.0, 1.0);
    assert_eq!(layer.value(Cell::new(0, 1)), 0.0);
    let crop = layer.crop(Window { row: 0, col: 1, rows: 2, cols: 1 }).unwrap();
    assert_eq!((crop.is_known(Cell::new(0, 0)), crop.value(Cell::new(1, 0))), (false, 4.0));
}

proptest! {
    /// Turning the ground by a quarter turns the gradient and the step with it, and changes no value.
    #[test]
    fn a_quarter_turn_changes_no_gradient(seed in any::<u64>(), holes in 0.0..0.5_f64) {
        let side = 8;
        let reading = |row: usize, col: usize| {
            let key = [seed, row as u64, col as u64];
            let hole = unit_noise(&[key[0], key[1], key[2], 1]) < holes;
            ((unit_noise(&key) * 9.0) as f32, if hole { 1.0 } else { 0.0 })
        };
        let build = |turned: bool| {
            let mut layer = Layer::unknown(spec(side, side, 1.0));
            for cell in layer.spec().cells() {
                let (value, u) =
                    if turned { reading(cell.col, side - 1 - cell.row) } else { reading(cell.row, cell.col) };
                layer.set(cell, value, u);
            }
            layer
        };
        let (upright, turned) = (build(false), build(true));
        for (a, b) in [(gradient(&upright), gradient(&turned)), (step(&upright), step(&turned))] {
            for cell in turned.spec().cells() {
                let from = Cell::new(cell.col, side - 1 - cell.row);
                prop_assert_eq!((b.value(cell), b.u(cell)), (a.value(from), a.u(from)));
            }
        }
    }
}

#[test]
fn a_part_of_the_ground_has_the_shape_of_the_same_ground_numbered_from_nought() {
    let spec = GridSpec::new(30, 41, 2.0).unwrap();
    let noise = |cell: Cell| wisdom_terrain::unit_noise(&[7, cell.row as u64, cell.col as u64]);
    let values = Raster::from_fn(spec, |cell| (noise(cell) * 3.0) as f32);
    let u = Raster::from_fn(spec, |cell| if noise(cell) < 0.05 { 1.0 } else { 0.25 });
    let here = Layer::new(values, u).unwrap();
    let there = here.clone().numbered_from(Cell::new(500, 9000));
    let (a, b) = (hazards(&here, 2), hazards(&there, 2));
    for (near, far) in [
        (a.gradient, b.gradient),
        (a.slope_deg, b.slope_deg),
        (a.step_m, b.step_m),
        (a.roughness_m, b.roughness_m),
    ] {
        assert_eq!(far.spec(), there.spec());
        assert_eq!(near, far.numbered_from(Cell::new(0, 0)));
    }
    let (near, far) = (hillshade(&here, 0.7, 0.5), hillshade(&there, 0.7, 0.5));
    assert_eq!(near, far.numbered_from(Cell::new(0, 0)));
}

#[test]
fn nothing_depends_on_whether_a_layer_knows_that_its_u_is_alike() {
    for u in [0.0, 0.4, 1.0] {
        let spec = GridSpec::new(40, 55, 1.0).unwrap();
        let heights = Raster::from_fn(spec, |c| (c.row * 7 % 11 + c.col * 5 % 13) as f32);
        let known = Layer::new(heights, Raster::filled(spec, u)).unwrap();
        let mut touched = known.clone();
        let corner = Cell::new(0, 0);
        touched.set(corner, 3.0, 0.7);
        touched.set(corner, known.value(corner), u);
        assert_eq!(known, touched);
        let all = |layer: &Layer| {
            let Hazards { gradient, slope_deg, step_m, roughness_m } = hazards(layer, 1);
            [gradient, slope_deg, step_m, roughness_m]
        };
        assert_eq!(all(&known), all(&touched));
        // Written over what held another u, and over what holds the same.
        let mut reused = [Layer::unknown(spec), known.clone()];
        let [first, second] = &mut reused;
        let measures = [Measure::Step, Measure::Gradient(Kernel::Horn)];
        measure_into(&known, measures, [first, second]);
        assert_eq!(reused, measure(&touched, measures));
        let [first, second] = &mut reused;
        measure_into(&touched, measures, [first, second]);
        assert_eq!(reused, measure(&known, measures));
    }
}

#[test]
fn a_hole_casts_no_frame_of_shadow_around_itself() {
    let spec = spec(30, 60, 1.0);
    let heights = Raster::filled(spec, -4500.0);
    let hole = |c: Cell| (10..15).contains(&c.row) && (20..30).contains(&c.col);
    let u = Raster::from_fn(spec, |c| if hole(c) { 1.0 } else { 0.0 });
    let ground = Layer::new(heights.clone(), u).unwrap();
    let level = hillshade(&Layer::certain(heights).unwrap(), 5.5, 0.8);
    assert_eq!(hillshade(&ground, 5.5, 0.8), level, "level ground is as bright beside a hole");
}
