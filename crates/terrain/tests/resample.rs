//! Resampling: what stays the same, what is conserved, where nothing is known; and GDAL's answer beside ours.

use std::process::Command;

use proptest::prelude::*;
use wisdom_grid::{Cell, GridSpec, Raster};
use wisdom_terrain::format::{self, About};
use wisdom_terrain::{GridFile, Resampling, TerrainError, resample};

const ALL: [Resampling; 4] =
    [Resampling::Nearest, Resampling::Bilinear, Resampling::Average, Resampling::Mode];

fn grid(spec: GridSpec, value: impl Fn(Cell) -> Option<f32>) -> GridFile {
    GridFile {
        raster: Raster::from_fn(spec, |cell| value(cell).unwrap_or(0.0)),
        known: Raster::from_fn(spec, |cell| value(cell).is_some()),
        crs: None,
        about: About::default(),
    }
}

/// A picture: digits are values, `.` is unknown; row by row.
fn picture(rows: &[&str], spacing_m: f64) -> GridFile {
    let spec = GridSpec::new(rows.len(), rows[0].len(), spacing_m).expect("a grid");
    grid(spec, |cell| {
        let byte = rows[cell.row].as_bytes()[cell.col];
        byte.is_ascii_digit().then(|| f32::from(byte - b'0'))
    })
}

fn drawn(file: &GridFile) -> Vec<String> {
    let spec = file.raster.spec();
    let cell = |row, col| {
        let cell = Cell::new(row, col);
        if file.known[cell] { file.raster[cell].to_string() } else { ".".to_owned() }
    };
    (0..spec.rows()).map(|row| (0..spec.cols()).map(|col| cell(row, col)).collect()).collect()
}

fn bits(file: &GridFile) -> Vec<u32> {
    file.raster.values().iter().map(|value| value.to_bits()).collect()
}

fn spec(rows: usize, cols: usize, spacing_m: f64) -> GridSpec {
    GridSpec::new(rows, cols, spacing_m).expect("a grid")
}

#[test]
fn the_same_grid_gives_the_same_bits() {
    // A spacing and place that binary fractions cannot say, a negative zero, and heights of the lowest and the highest.
    let place = spec(23, 31, 0.094).at(8_142_616.3, -276_605.7);
    let heights = [-0.0, f32::MAX, -4500.123, f32::MIN_POSITIVE, 7.0, -1e38];
    let source = grid(place, |cell| {
        (!(cell.row * 31 + cell.col).is_multiple_of(5)).then(|| heights[(cell.row + cell.col) % 6])
    });
    for way in ALL {
        let same = resample(&source, place, way);
        assert_eq!(bits(&same), bits(&source), "{way}");
        assert_eq!(same.known, source.known, "{way}");
    }
}

proptest! {
    /// On any finer or shifted grid, away from the source's border.
    #[test]
    fn planes_stay_planes_under_bilinear(
        slope in (-3.0..3.0_f64, -3.0..3.0_f64),
        shift in (0.0..5.0_f64, 0.0..5.0_f64),
        spacing_m in 0.3..2.5_f64,
    ) {
        let place = spec(40, 40, 1.0).at(1000.0, 2000.0);
        let plane = |(x, y): (f64, f64)| -4500.0 + slope.0 * (x - 1000.0) + slope.1 * (y - 2000.0);
        let source = grid(place, |cell| Some(plane(place.centre_m(cell)) as f32));
        let onto = spec(9, 9, spacing_m).at(1002.0 + shift.0, 1998.0 - shift.1);
        let found = resample(&source, onto, Resampling::Bilinear);
        for (cell, &height) in found.raster.iter() {
            prop_assert!(found.known[cell]);
            // Heights near 4500 are stored to half of 0.5 mm, in the source and in the result.
            prop_assert!((f64::from(height) - plane(onto.centre_m(cell))).abs() < 6e-4);
        }
    }

    /// What covers the source whole has its sum, cell by cell of any size.
    #[test]
    fn averages_conserve_sums(
        heights in prop::collection::vec(-4600.0_f32..-4400.0, 12 * 12),
        shift in (-3.0..0.0_f64, 0.0..3.0_f64),
        spacing_m in 1.0..7.0_f64,
    ) {
        let place = spec(12, 12, 1.0);
        let source = grid(place, |cell| Some(heights[place.index(cell)]));
        let side = (15.0 / spacing_m).ceil() as usize;
        let onto = spec(side, side, spacing_m).at(shift.0, 12.0 + shift.1);
        let found = resample(&source, onto, Resampling::Average);
        // The mean is of the part that the source covers: weigh it by that part.
        let overlap = |low: f64, high: f64| (high.min(12.0) - low.max(0.0)).max(0.0);
        let mut sum = 0.0;
        for (cell, &height) in found.raster.iter() {
            let (x, y) = onto.centre_m(cell);
            let half = spacing_m / 2.0;
            let area = overlap(x - half, x + half) * overlap(y - half, y + half);
            prop_assert_eq!(found.known[cell], area > 1e-9, "{} {}", cell, area);
            sum += area * f64::from(height);
        }
        let wanted: f64 = heights.iter().map(|&height| f64::from(height)).sum();
        // f32 means are stored to 2.5e-4 m over 144 m².
        prop_assert!((sum - wanted).abs() < 0.05, "{sum} {wanted}");
    }

    /// The same bits with one thread and with many, and no value outside the source's range.
    #[test]
    fn threads_do_not_matter_and_values_stay_in_range(
        heights in prop::collection::vec(prop::option::weighted(0.8, -9.0_f32..9.0), 20 * 17),
        place in (-9.0..20.0_f64, 0.0..30.0_f64),
        spacing_m in 0.4..5.0_f64,
    ) {
        let from = spec(20, 17, 1.0);
        let source = grid(from, |cell| heights[from.index(cell)]);
        let onto = spec(13, 14, spacing_m).at(place.0, place.1);
        let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let known = || heights.iter().flatten().copied();
        let (low, high) = (known().fold(f32::MAX, f32::min), known().fold(f32::MIN, f32::max));
        for way in ALL {
            let one = pool(1).install(|| resample(&source, onto, way));
            let many = pool(4).install(|| resample(&source, onto, way));
            prop_assert_eq!(bits(&one), bits(&many));
            prop_assert_eq!(&one.known, &many.known);
            for (cell, &value) in one.raster.iter() {
                if one.known[cell] {
                    prop_assert!((low..=high).contains(&value), "{} {}", way, value);
                } else {
                    prop_assert_eq!(value, 0.0);
                }
            }
        }
    }
}

#[test]
fn nearest_takes_the_cell_around_the_centre() {
    let source = picture(&["123", "456", "789"], 2.0);
    // Twice as fine, shifted by half a cell of the source to the east and the south: beyond the edge is unknown.
    let onto = spec(6, 6, 1.0).at(1.0, 5.0);
    let found = resample(&source, onto, Resampling::Nearest);
    assert_eq!(drawn(&found), ["12233.", "45566.", "45566.", "78899.", "78899.", "......"]);
}

#[test]
fn bilinear_shifted_by_half_a_cell_is_the_mean_of_four() {
    let source = picture(&["13", "59"], 1.0);
    let found = resample(&source, spec(1, 1, 1.0).at(0.5, 1.5), Resampling::Bilinear);
    assert_eq!(drawn(&found), ["4.5"]);
    // At a corner of the source there is one centre; on its edge, two.
    let fine = resample(&source, spec(4, 4, 0.5), Resampling::Bilinear);
    assert_eq!((fine.raster[Cell::new(0, 0)], fine.raster[Cell::new(0, 1)]), (1.0, 1.5));
    assert!(fine.known.values().iter().all(|&known| known));
}

#[test]
fn bilinear_leaves_unknown_corners_out_and_is_unknown_where_the_nearest_cell_is() {
    let source = picture(&["2.", "46"], 1.0);
    let fine = resample(&source, spec(4, 4, 0.5), Resampling::Bilinear);
    for (cell, &known) in fine.known.iter() {
        assert_eq!(known, !(cell.row < 2 && cell.col >= 2), "{cell}");
    }
    // At (0.75, 1.25): weights 9, 3, 3, 1 of 16, without the unknown corner: (9·2 + 3·4 + 1·6) / 13.
    assert!((fine.raster[Cell::new(1, 1)] - 36.0 / 13.0).abs() < 1e-6);
    let all_round = picture(&["...", ".5.", "..."], 1.0);
    let fine = resample(&all_round, spec(6, 6, 0.5), Resampling::Bilinear);
    assert_eq!(drawn(&fine), ["......", "......", "..55..", "..55..", "......", "......"]);
}

#[test]
fn an_average_is_of_the_known_part() {
    let source = picture(&["13..", "5...", "....", "...7"], 1.0);
    let found = resample(&source, spec(2, 2, 2.0), Resampling::Average);
    assert_eq!(drawn(&found), ["3.", ".7"]);
    // One and a half cells wide: whole cells count twice as much as halves.
    let row = picture(&["150"], 1.0);
    let found = resample(&row, spec(1, 2, 1.5).at(0.0, 1.25), Resampling::Average);
    let wanted = [(1.0 + 5.0 * 0.5) / 1.5, 5.0 * 0.5 / 1.5].map(|mean: f64| mean as f32);
    assert_eq!(found.raster.values(), wanted);
}

/// Deep places: a mean of 10 000 heights of −4500 m that differ by millimetres loses nothing.
#[test]
fn an_average_of_deep_heights_is_exact_to_their_spacing() {
    let place = spec(100, 100, 1.0);
    let height = |cell: Cell| -4500.0 - ((cell.row * 37 + cell.col * 11) % 64) as f32 / 2048.0;
    let source = grid(place, |cell| Some(height(cell)));
    let found = resample(&source, spec(1, 1, 100.0), Resampling::Average).raster.values()[0];
    let sum: f64 = place.cells().map(|cell| f64::from(height(cell))).sum();
    assert_eq!(found, (sum / 10_000.0) as f32);
}

#[test]
fn the_mode_is_the_class_of_most_area_and_ties_go_to_the_smaller() {
    let source = picture(&["1123", "2144", "2...", "2..9"], 1.0);
    let found = resample(&source, spec(2, 2, 2.0), Resampling::Mode);
    assert_eq!(drawn(&found), ["14", "29"]);
    let tied = picture(&["12", "21"], 1.0);
    assert_eq!(drawn(&resample(&tied, spec(1, 1, 2.0), Resampling::Mode)), ["1"]);
    // 3 has one whole cell, 1 and 2 halves.
    let row = picture(&["132"], 1.0);
    let found = resample(&row, spec(1, 1, 2.0).at(0.5, 1.5), Resampling::Mode);
    assert_eq!(drawn(&found), ["3"]);
}

#[test]
fn grids_apart_share_nothing() {
    let source = picture(&["12", "34"], 1.0);
    for way in ALL {
        for (west_m, north_m) in [(2.0, 2.0), (-5.0, 2.0), (0.0, 100.0), (1e12, -1e12)] {
            let found = resample(&source, spec(3, 3, 1.0).at(west_m, north_m), way);
            let far = west_m >= 2.0 || north_m.abs() > 50.0 || west_m <= -5.0;
            assert_eq!(found.known.values().iter().all(|known| !known), far, "{way}");
        }
    }
}

#[test]
fn ways_are_known_by_their_names() {
    for way in ALL {
        assert_eq!(way.to_string().parse::<Resampling>().unwrap(), way);
    }
    let error = "cubic".parse::<Resampling>().unwrap_err();
    assert!(matches!(&error, TerrainError::Resampling { found } if found == "cubic"), "{error}");
}

/// The DEM of Marias Pass, 1 m, by `gdalwarp` onto finer, shifted and coarser grids. Away from holes (GDAL weighs
/// them by its own rules) heights agree within 2 mm, four steps of f32 there; near within 0.
#[test]
fn gdalwarp_gives_the_same_heights() {
    if Command::new("gdalwarp").arg("--version").output().is_err() {
        println!("skipped: gdalwarp_gives_the_same_heights: gdalwarp is not installed");
        return;
    }
    let path = format!("{}/../../missions/marias-pass/terrain/dem.tif", env!("CARGO_MANIFEST_DIR"));
    let source = format::read("dem.tif", &std::fs::read(&path).unwrap()).unwrap();
    let place = source.raster.spec();
    let folder = tempfile::tempdir().unwrap();
    for (way, name, spacing_m, shift_m, limit_m) in [
        (Resampling::Nearest, "near", 0.75, 0.3, 0.0),
        (Resampling::Bilinear, "bilinear", 0.5, 0.25, 0.002),
        (Resampling::Bilinear, "bilinear", 1.0, 0.5, 0.002),
        (Resampling::Average, "average", 8.0, 0.0, 0.002),
        (Resampling::Average, "average", 5.0, 2.0, 0.002),
    ] {
        let (rows, cols) = ((300.0 / spacing_m) as usize, (300.0 / spacing_m) as usize);
        let onto = spec(rows, cols, spacing_m)
            .at(place.west_m() + 10.0 + shift_m, place.north_m() - 10.0 - shift_m);
        let (east_m, south_m) =
            (onto.west_m() + cols as f64 * spacing_m, onto.north_m() - rows as f64 * spacing_m);
        let out = folder.path().join(format!("{name}-{spacing_m}.tif"));
        let step = spacing_m.to_string();
        let box_m = [onto.west_m(), south_m, east_m, onto.north_m()].map(|v| v.to_string());
        let status = Command::new("gdalwarp")
            .args(["-q", "-et", "0", "-r", name, "-tr", &step, &step, "-te"])
            .args(&box_m)
            .arg(&path)
            .arg(&out)
            .status()
            .unwrap();
        assert!(status.success());
        let theirs = format::read("gdal.tif", &std::fs::read(&out).unwrap()).unwrap();
        assert_eq!(theirs.raster.spec(), onto);
        let ours = resample(&source, onto, way);
        // All source cells that either could use are known.
        let sure = resample(
            &grid(place, |cell| {
                let near = place.around(cell, 2);
                Some(if near.cells().all(|cell| source.known[cell]) { 0.0 } else { 1.0 })
            }),
            onto,
            Resampling::Average,
        );
        let mut compared = 0;
        for (cell, &height) in ours.raster.iter() {
            if sure.known[cell] && sure.raster[cell] == 0.0 {
                assert!(ours.known[cell] && theirs.known[cell], "{name} {spacing_m} at {cell}");
                let error = (f64::from(height) - f64::from(theirs.raster[cell])).abs();
                assert!(error <= limit_m, "{name} {spacing_m} at {cell}: {error}");
                compared += 1;
            }
        }
        assert!(compared * 2 > onto.len(), "{name} {spacing_m}: {compared} compared");
    }
}
