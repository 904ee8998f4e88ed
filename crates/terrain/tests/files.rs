//! Terrain files: one grid in many containers, hostile bytes, and the ground of Marias Pass.

use proptest::prelude::*;
use wisdom_grid::Cell;
use wisdom_terrain::{GridFile, TerrainError, format, slope};

const COLS: usize = 64;
const ROWS: usize = 48;

fn bytes(name: &str) -> Vec<u8> {
    let path = format!("{}/tests/data/{name}", env!("CARGO_MANIFEST_DIR"));
    std::fs::read(path).expect("a file of tests/data")
}

fn fixture(name: &str) -> GridFile {
    format::read(name, &bytes(name)).expect("a sound file")
}

const EXACT: [&str; 6] = [
    "f32_tiled_deflate_p3.tif",
    "f32_tiled_deflate_p3_nan.tif",
    "f32_tiled_deflate_p3_bigtiff.tif",
    "f32_tiled_deflate_p1_bigendian.tif",
    "f32_tiled_zstd_p3.tif",
    "f32_pixel_is_point.tif",
];

/// The text grid is read by an independent path and has six decimals: it is the reference for the rest.
#[test]
fn every_container_holds_the_same_heights_in_the_same_place() {
    let reference = fixture("grid.asc");
    for name in EXACT {
        let file = fixture(name);
        assert_eq!(file.raster.spec(), reference.raster.spec(), "{name}");
        assert_eq!(file.known, reference.known, "{name}");
        for (cell, &height) in reference.raster.iter() {
            assert_eq!(file.raster[cell], height, "{name} at {cell}");
        }
    }
}

#[test]
fn the_grid_lies_where_its_maker_put_it() {
    let spec = fixture("f32_pixel_is_point.tif").raster.spec();
    assert_eq!((spec.rows(), spec.cols(), spec.spacing_m()), (ROWS, COLS, 1.0));
    assert_eq!((spec.west_m(), spec.north_m()), (8_142_616.0, -276_605.0));
}

#[test]
fn scale_and_offset_turn_integers_into_metres() {
    let (whole, exact) = (fixture("i16_tiled_deflate_p2.tif"), fixture("f32_tiled_deflate_p3.tif"));
    assert_eq!(whole.known, exact.known);
    for (cell, &height) in exact.raster.iter() {
        // Half the quantum of 0.01 m, and the spacing of f32 near -4450.
        assert!((whole.raster[cell] - height).abs() <= 0.0051, "{cell}");
    }
}

#[test]
fn the_hole_is_unknown_and_nothing_else_is() {
    for name in EXACT {
        for (cell, &known) in fixture(name).known.iter() {
            let hole = (20..25).contains(&cell.row) && (30..36).contains(&cell.col);
            assert_eq!(known, !hole, "{name} at {cell}");
        }
    }
    let layer = fixture("f32_tiled_deflate_p3_nan.tif").into_layer().unwrap();
    assert_eq!((layer.value(Cell::new(22, 33)), layer.u(Cell::new(22, 33))), (0.0, 1.0));
}

#[test]
fn the_sphere_of_mars_is_read_from_the_geo_keys() {
    assert_eq!(fixture("f32_tiled_deflate_p3.tif").body_radius_m(), Some(3_396_190.0));
    assert_eq!(fixture("grid.asc").body_radius_m(), None);
}

#[test]
fn an_ascii_grid_may_name_the_centre_of_its_corner_cell() {
    let asc = "NCOLS 2\nNROWS 2\nXLLCENTER 10\nYLLCENTER 20\nCELLSIZE 4\n1 2\n3 nan\n";
    let file = format::read("dem.ASC", asc.as_bytes()).unwrap();
    assert_eq!((file.raster.spec().west_m(), file.raster.spec().north_m()), (8.0, 26.0));
    assert_eq!(file.raster.values(), [1.0, 2.0, 3.0, 0.0]);
    assert_eq!(file.known.values(), [true, true, true, false]);
}

/// The special pixels of ISIS and PDS3 are reserved by bit pattern, whatever the nodata tag says.
#[test]
fn a_hirise_missing_pixel_is_unknown() {
    let missing = f32::from_bits(0xFF7F_FFFB);
    let asc = format!("ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n{missing:e} 7\n");
    assert_eq!(format::read("a.asc", asc.as_bytes()).unwrap().known.values(), [false, true]);
}

#[test]
fn what_cannot_be_read_is_named() {
    let message = |name: &str, bytes: &[u8]| format::read(name, bytes).unwrap_err().to_string();
    assert_eq!(
        message("dem.img", b"PDS_VERSION_ID = PDS3"),
        "dem.img is a PDS3 product; GeoTIFF and ESRI ASCII grids are read"
    );
    assert!(message("x.asc", b"ncols 2\nnrows 2\ncellsize 1\n1 2 3 4").contains("no xllcorner"));
    let short = b"ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2 3";
    assert_eq!(message("x.asc", short), "x.asc: fewer values than 2 x 2");
    let skewed = b"ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ndx 1\ndy 2\n1 2 3 4";
    assert!(message("x.asc", skewed).contains("\"dx\""));
}

/// A header that promises 65 535 x 65 535 cells is refused for what it says.
#[test]
fn a_grid_too_large_is_refused_before_it_is_made() {
    let asc = b"ncols 65535\nnrows 65535\nxllcorner 0\nyllcorner 0\ncellsize 1\n1";
    let error = format::read("x.asc", asc).unwrap_err();
    assert!(matches!(error, TerrainError::TooLarge { rows: 65535, cols: 65535, .. }), "{error}");
    // A header and one directory: a single strip of one byte that is said to hold the whole image.
    let entries: [[u32; 3]; 9] = [
        [256, 4, 65_535],
        [257, 4, 65_535],
        [258, 3, 32],
        [259, 3, 1],
        [262, 3, 1],
        [273, 4, 8],
        [277, 3, 1],
        [278, 4, 65_535],
        [279, 4, 1],
    ];
    let mut tif = b"II\x2a\0\x08\0\0\0\x09\0".to_vec();
    for [tag, kind, value] in entries {
        tif.extend_from_slice(&(tag as u16).to_le_bytes());
        tif.extend_from_slice(&(kind as u16).to_le_bytes());
        tif.extend_from_slice(&1_u32.to_le_bytes());
        tif.extend_from_slice(&value.to_le_bytes());
    }
    tif.extend_from_slice(&[0; 4]);
    let error = format::read("x.tif", &tif).unwrap_err();
    assert!(matches!(error, TerrainError::TooLarge { rows: 65535, cols: 65535, .. }), "{error}");
}

proptest! {
    /// No damage to a file makes its reading panic, and what still reads holds only finite values.
    #[test]
    fn damaged_files_never_panic(
        which in 0..8_usize,
        cut in prop::option::of(0.0..1.0_f64),
        flips in prop::collection::vec((0.0..1.0_f64, 0..8_u8), 0..6),
        in_header in any::<bool>(),
    ) {
        let all = [&EXACT[..], &["i16_tiled_deflate_p2.tif", "grid.asc"]].concat();
        let mut bytes = bytes(all[which]);
        let span = if in_header { 600.min(bytes.len()) } else { bytes.len() };
        for (place, bit) in flips {
            bytes[(place * span as f64) as usize] ^= 1 << bit;
        }
        if let Some(cut) = cut {
            bytes.truncate((cut * bytes.len() as f64) as usize);
        }
        if let Ok(files) = format::read_bands(all[which], &bytes) {
            for file in files {
                prop_assert!(file.into_layer().is_ok());
            }
        }
    }
}

fn site(name: &str) -> GridFile {
    let path = format!("{}/../../missions/marias-pass/terrain/{name}", env!("CARGO_MANIFEST_DIR"));
    format::read(name, &std::fs::read(path).expect("a file of the mission")).expect("a sound file")
}

/// Each layer of the site: one grid, and the range its credits give.
#[test]
fn marias_pass_reads_on_one_grid_with_its_stated_ranges() {
    for (name, least, most) in [
        ("dem.tif", -4472.67, -4437.88),
        ("dem_u.tif", 0.0, 1.0),
        ("texture.tif", 1.0, 4.0),
        ("texture_u.tif", 0.0, 1.0),
        ("thermal_0500.tif", 185.8, 203.8),
        ("thermal_u.tif", 0.0, 1.0),
    ] {
        let file = site(name);
        let spec = file.raster.spec();
        assert_eq!((spec.cols(), spec.rows(), spec.spacing_m()), (348, 337, 1.0), "{name}");
        assert_eq!((spec.west_m(), spec.north_m()), (8_142_406.0, -276_455.0), "{name}");
        let known: Vec<f32> = file
            .raster
            .values()
            .iter()
            .zip(file.known.values())
            .filter_map(|(&value, &known)| known.then_some(value))
            .collect();
        let low = known.iter().copied().fold(f32::INFINITY, f32::min);
        let high = known.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        // The ranges are printed to 0.1 (temperature) and 0.01 (elevation).
        assert!(
            f64::from(low) >= least - 0.06 && f64::from(high) <= most + 0.06,
            "{name}: {low} {high}"
        );
        assert!(known.len() * 10 >= spec.len() * 9, "{name}: {} known", known.len());
    }
}

#[test]
fn marias_pass_is_as_steep_as_its_credits_say() {
    let slopes = slope(&site("dem.tif").into_layer().unwrap());
    let mut degrees = slopes.values().values().to_vec();
    degrees.sort_by(f32::total_cmp);
    // Printed: median 6.7, 95 % below 17.8 degrees.
    assert!((degrees[degrees.len() / 2] - 6.7).abs() < 0.1);
    assert!((degrees[degrees.len() * 95 / 100] - 17.8).abs() < 0.1);
}

#[test]
fn a_colour_image_has_three_bands_and_is_no_layer() {
    let name = "ortho_rgb.tif";
    let path = format!("{}/../../missions/marias-pass/terrain/{name}", env!("CARGO_MANIFEST_DIR"));
    let bytes = std::fs::read(path).expect("a file of the mission");
    let bands = format::read_bands(name, &bytes).unwrap();
    assert_eq!(bands.len(), 3);
    assert_eq!((bands[0].raster.spec().cols(), bands[0].raster.spec().rows()), (348, 337));
    let error = format::read(name, &bytes).unwrap_err();
    assert!(matches!(error, TerrainError::Bands { bands: 3, .. }), "{error}");
}
