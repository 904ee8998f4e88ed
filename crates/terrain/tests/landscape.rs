//! Synthetic scenes: each feature has the form its description says, and no other.

use wisdom_grid::{Cell, GridSpec, Raster};
use wisdom_terrain::{Landscape, SceneLayer};

fn scene(text: &str) -> Landscape {
    toml::from_str(text).expect("a sound scene")
}

fn layer(text: &str, name: &str, seed: u64) -> Raster<f32> {
    let spec = GridSpec::new(21, 21, 2.0).expect("a small grid");
    scene(text).render(spec, seed).remove(name).expect("a layer of the landscape")
}

fn at(raster: &Raster<f32>, row: usize, col: usize) -> f32 {
    raster[Cell { row, col }]
}

#[test]
fn the_base_plane_rises_east_and_north_per_metre() {
    let plane =
        layer("base = { elevation_m = 100.0, rise_east = 0.5, rise_north = 0.25 }", "elevation", 1);
    assert_eq!(at(&plane, 0, 0), 100.0);
    assert_eq!(at(&plane, 0, 3), 103.0); // three cells of 2 m
    assert_eq!(at(&plane, 4, 0), 98.0);
}

#[test]
fn a_ramp_wall_rises_evenly_and_rocks_do_not_pile_up() {
    let rock = r#"[[rock]]
        centre = [10.0, 10.0]
        half-axes = [6.0, 6.0]
        height_m = 8.0
        wall = "ramp"
        wall_cells = 4.0
    "#;
    let heights = layer(&rock.repeat(2), "elevation", 1);
    let profile: Vec<f32> = (4..=10).map(|col| at(&heights, 10, col)).collect();
    assert_eq!(profile, [0.0, 2.0, 4.0, 6.0, 8.0, 8.0, 8.0]);
}

#[test]
fn walls_differ_in_form_not_in_height_or_foot() {
    let mid = |wall: &str| {
        let text = format!(
            "[[rock]]\ncentre = [10.0, 10.0]\nhalf-axes = [8.0, 8.0]\nheight_m = 8.0\nwall = \"{wall}\"\nwall_cells = 4.0"
        );
        let heights = layer(&text, "elevation", 1);
        assert_eq!((at(&heights, 10, 2), at(&heights, 10, 6)), (0.0, 8.0), "{wall}");
        at(&heights, 10, 4)
    };
    assert_eq!(mid("ramp"), 4.0);
    assert_eq!(mid("smooth"), 4.0);
    assert!((mid("dome") - 8.0 * 0.75_f32.sqrt()).abs() < 1e-5);
}

#[test]
fn a_rock_turns_clockwise_from_above() {
    let text = r#"[[rock]]
        centre = [10.0, 10.0]
        half-axes = [8.0, 2.0]
        turned_deg = 45.0
        height_m = 5.0
        wall = "ramp"
        wall_cells = 0.5
    "#;
    let heights = layer(text, "elevation", 1);
    // Its long axis pointed east; turned clockwise it points south-east.
    assert_eq!((at(&heights, 14, 14), at(&heights, 6, 14)), (5.0, 0.0));
}

#[test]
fn a_crater_is_deepest_in_the_middle_highest_on_the_rim_and_fades() {
    let text = "[[crater]]\ncentre = [10.0, 10.0]\nradius_cells = 5.0\ndepth_m = 3.0\nrim_m = 1.0";
    let heights = layer(text, "elevation", 1);
    assert_eq!((at(&heights, 10, 10), at(&heights, 10, 15)), (-3.0, 1.0));
    assert!((at(&heights, 10, 20) - 0.125).abs() < 1e-6, "an eighth at twice the radius");
}

#[test]
fn a_ridge_is_level_along_its_crest_and_ends_at_its_foot() {
    let text =
        "[[ridge]]\nfrom = [5.0, 10.0]\nto = [15.0, 10.0]\nhalf_width_cells = 4.0\nheight_m = 2.0";
    let heights = layer(text, "elevation", 1);
    assert!((5..=15).all(|col| at(&heights, 10, col) == 2.0));
    assert_eq!((at(&heights, 8, 10), at(&heights, 6, 10), at(&heights, 10, 19)), (1.0, 0.0, 0.0));
}

const ROUGH: &str =
    "[roughness]\namplitude_m = 2.0\nwavelength_cells = 4.0\noctaves = 3\ngain = 0.5";

#[test]
fn roughness_moves_with_the_seed_alone_and_stays_in_its_bounds() {
    let (one, again, other) =
        (layer(ROUGH, "elevation", 1), layer(ROUGH, "elevation", 1), layer(ROUGH, "elevation", 2));
    assert_eq!(one, again);
    assert_ne!(one, other);
    // 2 (1 + 1/2 + 1/4) metres at most; and it is no plane.
    assert!(one.values().iter().all(|h| h.abs() <= 3.5));
    assert!(one.values().iter().any(|h| h.abs() > 0.5));
}

#[test]
fn a_larger_map_holds_the_same_ground() {
    let small = scene(ROUGH).render(GridSpec::new(9, 9, 1.0).unwrap(), 5);
    let large = scene(ROUGH).render(GridSpec::new(30, 40, 1.0).unwrap(), 5);
    for (cell, height) in small["elevation"].iter() {
        assert_eq!(*height, large["elevation"][cell], "{cell}");
    }
}

const FIELD: &str = "\
[[scatter]]
per_1000_cells = 6.0
radius_cells = [1.0, 5.0]
exponent = 2.0
height_m_per_cell = 0.5
class = 4
";

#[test]
fn scattered_rocks_are_as_many_and_as_large_as_asked_for() {
    let spec = GridSpec::new(1000, 1000, 1.0).unwrap();
    let layers = scene(FIELD).render(spec, 3);
    let (heights, textures) = (&layers["elevation"], &layers["texture"]);
    assert!(heights.values().iter().all(|&h| (0.0..=2.5).contains(&h)));
    for (cell, &height) in heights.iter() {
        assert_eq!(textures[cell] == 4.0, height > 0.0, "{cell}");
    }
    // Cells whose centre lies in a rock of radius r: pi r^2 of it, on average. Of a law that falls with r^-2 between 1
    // and 5, the mean of r^2 is 2 ln 5 / (1 - 1/25) = 3.35, so that 6 rocks on a thousand cells cover 6.1 % of them,
    // overlaps taken off.
    let covered = heights.values().iter().filter(|&&h| h > 0.0).count() as f64 / spec.len() as f64;
    let expected = 1.0 - (-6.0e-3 * std::f64::consts::PI * 3.353_f64).exp();
    assert!((covered / expected - 1.0).abs() < 0.05, "{covered} against {expected}");
    assert_ne!(layers, scene(FIELD).render(spec, 4), "another seed has other rocks");
}

#[test]
fn a_part_of_a_scene_is_that_part_of_the_whole() {
    let text = format!(
        "{ROUGH}\n{FIELD}\n[[rock]]\ncentre = [20.0, 30.0]\nhalf-axes = [4.0, 3.0]\nheight_m = 5.0\nwall = \"dome\"\n\
         wall_cells = 3.0\n[[rock]]\ncentre = [5.0, 50.0]\nhalf-axes = [2.0, 2.0]\nheight_m = -1.0\nwall = \"ramp\"\n\
         wall_cells = 1.0\n[[hot_spot]]\ncentre = [30.0, 30.0]\nradius_cells = 9.0\nedge_cells = 4.0\npeak = 9.0\n"
    );
    let spec = GridSpec::new(60, 50, 2.0).unwrap();
    let whole = scene(&text).render(spec, 8);
    for window in [
        wisdom_grid::Window { row: 0, col: 0, rows: 7, cols: 50 },
        wisdom_grid::Window { row: 45, col: 3, rows: 10, cols: 5 },
        wisdom_grid::Window { row: 25, col: 15, rows: 35, cols: 35 },
    ] {
        for layer in SceneLayer::ALL {
            let part = scene(&text).render_layer(layer, spec.part(window).unwrap(), 8);
            for (cell, value) in part.iter() {
                assert_eq!(*value, whole[&layer.to_string()][cell], "{layer} at {cell}");
            }
        }
    }
}

#[test]
fn patches_lie_over_one_another_in_the_order_they_are_written() {
    let texture = layer(
        r"
        base = { texture = 9 }
        [[patch]]
        class = 1
        shape = { rectangle = { from = [2.0, 2.0], to = [12.0, 12.0] } }
        [[patch]]
        class = 2
        shape = { disc = { centre = [12.0, 12.0], radius_cells = 3.0 } }
        [[patch]]
        class = 3
        shape = { polygon = { corners = [[0.5, 15.5], [4.5, 15.5], [4.5, 19.5]] } }
        [[patch]]
        class = 4
        shape = { face = { centre = [16.0, 4.0], radius_cells = 3.0, towards = [0.0, 4.0], beyond_cells = 1.0 } }
        ",
        "texture",
        1,
    );
    assert_eq!(at(&texture, 0, 0), 9.0);
    assert_eq!((at(&texture, 2, 2), at(&texture, 12, 9)), (1.0, 2.0));
    assert_eq!((at(&texture, 12, 15), at(&texture, 12, 16)), (2.0, 9.0));
    assert_eq!((at(&texture, 16, 3), at(&texture, 18, 1)), (3.0, 9.0));
    assert_eq!((at(&texture, 4, 15), at(&texture, 4, 16), at(&texture, 4, 13)), (4.0, 9.0, 4.0));
}

#[test]
fn a_hot_spot_is_at_its_peak_inside_and_at_the_background_outside() {
    let text = "base = { temperature = 3.0 }\n[[hot_spot]]\ncentre = [10.0, 10.0]\nradius_cells = 8.0\nedge_cells = 4.0\npeak = 83.0";
    let heat = layer(text, "temperature", 1);
    assert_eq!((at(&heat, 10, 10), at(&heat, 10, 14)), (83.0, 83.0));
    assert_eq!((at(&heat, 10, 16), at(&heat, 10, 18), at(&heat, 0, 0)), (43.0, 3.0, 3.0));
}

#[test]
fn a_slip_in_a_description_is_an_error_that_names_it() {
    let error = |text: &str| toml::from_str::<Landscape>(text).unwrap_err().to_string();
    assert!(error("[[rokc]]\nname = \"A\"").contains("rokc"));
    assert!(error("base = { elevation_m = nan }").contains("NaN where a finite number"));
    let flat =
        "[[hot_spot]]\ncentre = [1.0, 1.0]\nradius_cells = 0.0\nedge_cells = 1.0\npeak = 1.0";
    assert!(error(flat).contains("a length of 0; it must be above 0"));
    let line = "[[patch]]\nclass = 1\nshape = { polygon = { corners = [[0.0, 0.0], [1.0, 1.0]] } }";
    assert!(error(line).contains("a polygon of 2 corners"));
}
