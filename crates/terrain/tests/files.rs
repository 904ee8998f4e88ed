//! Terrain files: one grid in many containers, hostile bytes, and the ground of Marias Pass.

use std::path::Path;

use proptest::prelude::*;
use wisdom_grid::{Cell, GridSpec};
use wisdom_terrain::{GridFile, Projection, TerrainError, format, slope};

const COLS: usize = 64;
const ROWS: usize = 48;

fn bytes(name: &str) -> Vec<u8> {
    let path = format!("{}/tests/data/{name}", env!("CARGO_MANIFEST_DIR"));
    std::fs::read(path).expect("a file of tests/data")
}

/// A file of `tests/data`, read from disk with those beside it.
fn fixture(name: &str) -> GridFile {
    let path = format!("{}/tests/data/{name}", env!("CARGO_MANIFEST_DIR"));
    format::read_file(Path::new(&path)).expect("a sound file")
}

const EXACT: [&str; 12] = [
    "f32_tiled_deflate_p3.tif",
    "f32_tiled_deflate_p3_nan.tif",
    "f32_tiled_deflate_p3_bigtiff.tif",
    "f32_tiled_deflate_p1_bigendian.tif",
    "f32_tiled_zstd_p3.tif",
    "f32_pixel_is_point.tif",
    "f32_cog.tif",
    "f32_strip_lzw_p3.tif",
    "f64_tiled_deflate_p3.tif",
    "pds3_hirise_style.img",
    "pds4.xml",
    "isis.cub",
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
fn an_image_of_sixteen_bits_is_placed_and_scaled_by_its_side_file() {
    let (image, exact) = (fixture("height16.png"), fixture("f32_tiled_deflate_p3.tif"));
    assert_eq!(image.raster.spec(), exact.raster.spec());
    assert_eq!(image.known, exact.known);
    assert_eq!(image.body_radius_m(), Some(3_396_190.0));
    // Half a level is 2.5e-5 m, a twentieth of the spacing of f32 near -4450: rounding finds the very height.
    assert_eq!(image.raster, exact.raster);
}

#[test]
fn a_bare_array_has_cells_of_one_metre_from_the_origin() {
    let (array, exact) = (fixture("ref.npy"), fixture("f32_tiled_deflate_p3.tif"));
    assert_eq!(array.raster.spec(), GridSpec::new(ROWS, COLS, 1.0).unwrap());
    assert_eq!((array.raster.values(), &array.crs), (exact.raster.values(), &None));
    assert_eq!(array.known.values(), exact.known.values());
}

#[test]
fn a_file_says_how_it_is_stored() {
    let facts = |name: &str| {
        let about = fixture(name).about;
        (about.format, about.storage, about.nodata.unwrap_or_default(), about.scale, about.offset)
    };
    let plain = |format, storage: &str, nodata: &str| {
        (format, storage.to_owned(), nodata.to_owned(), 1.0, 0.0)
    };
    let float = "float32, little-endian";
    assert_eq!(facts("pds3_hirise_style.img"), plain("PDS3 image", float, "16#FF7FFFFB#"));
    assert_eq!(facts("pds4.xml"), plain("PDS4 array", float, "-32767"));
    assert_eq!(facts("ref.npy"), plain("NumPy array", float, ""));
    let cube = format!("{float}, band after band");
    assert_eq!(facts("isis.cub"), plain("ISIS cube", &cube, "ISIS special pixels"));
    let scaled = (4.924_984_073_152_867_5e-5, -4_458.100_146_906_091);
    let wanted = ("PNG image", "uint16, big-endian, deflate".to_owned(), "0".to_owned());
    assert_eq!(facts("height16.png"), (wanted.0, wanted.1, wanted.2, scaled.0, scaled.1));
}

/// All were made from one grid: equidistant cylindrical on the sphere, parallel and meridian 0.
#[test]
fn labels_and_projection_files_say_the_same_map() {
    for name in ["grid.asc", "pds3_hirise_style.img", "pds4.xml", "isis.cub"] {
        let crs = fixture(name).crs.expect(name);
        assert_eq!(crs.radius_m, Some(3_396_190.0), "{name}");
        assert_eq!(crs.polar_radius_m, Some(3_396_190.0), "{name}");
        let cylinder = Projection::Equirectangular {
            centre_lon_deg: 0.0,
            standard_parallel_deg: 0.0,
            false_easting_m: 0.0,
            false_northing_m: 0.0,
        };
        assert_eq!(crs.projection, cylinder, "{name}");
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
    // An ASCII grid has no word for the body; the `.prj` beside it has.
    assert_eq!(format::read("grid.asc", &bytes("grid.asc")).unwrap().body_radius_m(), None);
    assert_eq!(fixture("grid.asc").body_radius_m(), Some(3_396_190.0));
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
        message("dem.h5", b"\x89HDF\r\n\x1a\n"),
        "dem.h5 is an HDF5 file; GeoTIFF, PDS3, PDS4, ISIS, PNG, NumPy and ESRI ASCII grids are read"
    );
    assert_eq!(
        message("dem.img", b"PDS_VERSION_ID = PDS3"),
        "dem.img: its label has no END in 1 lines"
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
        which in 0..11_usize,
        cut in prop::option::of(0.0..1.0_f64),
        flips in prop::collection::vec((0.0..1.0_f64, 0..8_u8), 0..6),
        in_header in any::<bool>(),
    ) {
        let all = [&EXACT[..9], &["i16_tiled_deflate_p2.tif", "grid.asc"]].concat();
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
