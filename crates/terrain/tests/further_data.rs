//! Terrain files beyond those that ship: one crop in twenty containers, and the elevation models of four sites.
//!
//! The folder is named by the environment variable `WISDOM_DATA`; without it each test says that it was skipped.

use std::path::{Path, PathBuf};

use wisdom_grid::{Cell, GridSpec};
use wisdom_terrain::{GridFile, TerrainError, format, slope};

const MARS_RADIUS_M: f64 = 3_396_190.0;
const MOON_RADIUS_M: f64 = 1_737_400.0;

/// The folder of further terrain, unless there is none: then the test named says so.
#[expect(clippy::print_stdout, reason = "a test that was skipped says so in the test log")]
fn terrain(test: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("WISDOM_DATA").filter(|folder| !folder.is_empty());
    if folder.is_none() {
        println!("skipped: {test}: WISDOM_DATA is not set");
    }
    folder.map(|folder| Path::new(&folder).join("data/terrain"))
}

fn bytes(path: &Path) -> Vec<u8> {
    std::fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn name(path: &Path) -> &str {
    path.file_name().and_then(|name| name.to_str()).expect("a name in UTF-8")
}

fn read(path: &Path) -> GridFile {
    format::read(name(path), &bytes(path)).unwrap_or_else(|error| panic!("{error}"))
}

fn refusal(path: &Path) -> TerrainError {
    format::read(name(path), &bytes(path)).expect_err("a file that is not read")
}

/// The files of a folder in the order of their names.
fn listed(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let mut paths: Vec<PathBuf> =
        entries.map(|entry| entry.expect("a folder's entry").path()).collect();
    paths.sort();
    paths
}

fn with_extension(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let mut paths = listed(folder);
    paths.retain(|path| path.extension().is_some_and(|found| found == extension));
    paths
}

/// The heights that every container holds, NaN where there is none: a `NumPy` array of version 1, read here by hand.
fn reference(formats: &Path) -> Vec<f32> {
    let npy = bytes(&formats.join("ref.npy"));
    let header = 10 + usize::from(u16::from_le_bytes([npy[8], npy[9]]));
    let text = String::from_utf8_lossy(&npy[10..header]);
    assert!(text.contains("'<f4'") && text.contains("(48, 64)"), "{text}");
    let words = npy[header..].chunks_exact(4);
    words.map(|word| f32::from_le_bytes([word[0], word[1], word[2], word[3]])).collect()
}

/// `"NAME": { .. "tol": TOLERANCE .. }` of the manifest, metres.
fn tolerance(manifest: &str, name: &str) -> f64 {
    let (_, entry) =
        manifest.split_once(&format!("\"{name}\": {{")).expect("a file of the manifest");
    let (entry, _) = entry.split_once('}').expect("the end of an entry");
    let (_, number) = entry.split_once("\"tol\":").expect("a tolerance");
    number.split([',', '\n']).next().expect("a number").trim().parse().expect("a number")
}

/// What stands beside an image: nothing in the folder says it, but the manifest has scale and offset.
fn side_file(manifest: &str) -> String {
    let number = |key: &str| {
        let (_, entry) = manifest.split_once("\"height16.png\": {").expect("the image");
        let (_, number) = entry.split_once(&format!("\"{key}\":")).expect("a number");
        number.split([',', '\n']).next().expect("a number").trim().to_owned()
    };
    format!(
        "spacing-m = 1\nwest-m = 8142616\nnorth-m = -276605\nnodata = 0\nbody-radius-m = 3396190\n\
        scale = {}\noffset = {}\n",
        number("scale"),
        number("offset")
    )
}

#[test]
fn every_container_holds_the_same_heights_in_the_same_place() {
    let Some(terrain) = terrain("every_container_holds_the_same_heights_in_the_same_place") else {
        return;
    };
    let formats = terrain.join("formats");
    let manifest = String::from_utf8(bytes(&formats.join("manifest.json"))).expect("UTF-8");
    let heights = reference(&formats);
    let bare = GridSpec::new(48, 64, 1.0).unwrap();
    let side = side_file(&manifest);
    let mut count = 0;
    for path in listed(&formats) {
        let name = name(&path);
        // The samples of `pds4.xml`, the map of `grid.asc`, and three texts about the folder.
        if matches!(
            name,
            "pds4.img" | "grid.prj" | "README.md" | "make_formats.py" | "manifest.json"
        ) {
            continue;
        }
        count += 1;
        let file = format::read_with(name, &bytes(&path), &mut |beside| match beside {
            "height16.png.toml" => Some(side.clone().into_bytes()),
            _ => std::fs::read(formats.join(beside)).ok(),
        });
        let file = file.unwrap_or_else(|error| panic!("{error}"));
        // An array of numbers has no word for where it lies.
        let (place, radius) = match name {
            "ref.npy" => (bare, None),
            _ => (bare.at(8_142_616.0, -276_605.0), Some(MARS_RADIUS_M)),
        };
        assert_eq!(file.raster.spec(), place, "{name}");
        assert_eq!(file.body_radius_m(), radius, "{name}");
        let limit = tolerance(&manifest, name);
        for ((cell, &found), &height) in file.raster.iter().zip(&heights) {
            assert_eq!(file.known[cell], !height.is_nan(), "{name} at {cell}");
            if height.is_nan() {
                assert_eq!(found, 0.0, "{name} at {cell}");
            } else {
                let error = (f64::from(found) - f64::from(height)).abs();
                assert!(error <= limit, "{name} at {cell}: {found}, not {height}");
            }
        }
    }
    assert_eq!(count, 20);
    assert_eq!(heights.iter().filter(|height| height.is_nan()).count(), 6 * 5);
}

#[test]
fn the_samples_of_a_detached_label_are_of_no_known_format_by_themselves() {
    let test = "the_samples_of_a_detached_label_are_of_no_known_format_by_themselves";
    let Some(terrain) = terrain(test) else { return };
    let error = refusal(&terrain.join("formats/pds4.img"));
    assert!(matches!(error, TerrainError::Format { .. }), "{error:?}");
    let error = refusal(&terrain.join("formats/pds4.xml"));
    let wanted = "pds4.xml: its samples are in pds4.img, which is not there beside it";
    assert_eq!(error.to_string(), wanted);
}

/// As a broken download leaves them. (A text grid may end inside its last number, so it is not asked to be whole.)
#[test]
fn a_file_cut_short_is_refused_or_still_whole() {
    let Some(terrain) = terrain("a_file_cut_short_is_refused_or_still_whole") else { return };
    let mut refused = 0;
    for path in listed(&terrain.join("formats")).iter().filter(|path| path.is_file()) {
        let (name, all) = (name(path), bytes(path));
        let whole = format::read(name, &all).ok();
        for length in (0..all.len()).step_by(61) {
            match format::read(name, &all[..length]) {
                Err(_) => refused += 1,
                Ok(part) if name == "grid.asc" => assert!(part.into_layer().is_ok(), "{length}"),
                Ok(part) => assert_eq!(Some(&part), whole.as_ref(), "{name} cut to {length} bytes"),
            }
        }
    }
    assert!(refused > 0);
}

/// The least and greatest known value, and the share of cells known.
fn range(file: &GridFile) -> (f64, f64, f64) {
    let cells = file.raster.values().iter().zip(file.known.values());
    let known: Vec<f64> =
        cells.filter_map(|(&value, &known)| known.then_some(f64::from(value))).collect();
    let least = known.iter().copied().fold(f64::INFINITY, f64::min);
    let most = known.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    (least, most, known.len() as f64 / file.raster.spec().len() as f64)
}

/// What a site's description says of a layer: its range, to the digits printed, and the share of cells known.
struct Stated {
    file: &'static str,
    least: f64,
    most: f64,
    digits: f64,
    known: f64,
}

impl Stated {
    fn check(&self, found: &GridFile) {
        let (least, most, known) = range(found);
        // Half of the last digit printed; float32 of a printed limit adds a millionth.
        let slack = self.digits / 2.0 + 1e-6;
        let name = self.file;
        assert!((least - self.least).abs() <= slack, "{name}: {least}, not {}", self.least);
        assert!((most - self.most).abs() <= slack, "{name}: {most}, not {}", self.most);
        // Shares are printed to a tenth of a percent.
        assert!((known - self.known).abs() <= 0.0005, "{name}: {known} of its cells are known");
    }
}

fn stated(file: &'static str, least: f64, most: f64, digits: f64, known: f64) -> Stated {
    Stated { file, least, most, digits, known }
}

#[test]
fn the_layers_of_gale_crater_read_on_one_grid_with_their_holes() {
    let Some(terrain) = terrain("the_layers_of_gale_crater_read_on_one_grid_with_their_holes")
    else {
        return;
    };
    let site = terrain.join("gale-ctx-20m");
    let grid = GridSpec::new(1024, 512, 20.0).unwrap().at(8_139_490.0, -268_590.0);
    let layers = [
        stated("dem.tif", -4540.0, -2420.0, 1.0, 0.879),
        stated("dem_u.tif", 0.1, 1.0, 0.01, 1.0),
        stated("texture.tif", 1.0, 4.0, 0.0, 0.873),
        stated("texture_u.tif", 0.35, 1.0, 0.0, 1.0),
        stated("thermal_0500.tif", 186.085, 201.335, 0.001, 0.873),
        stated("thermal_1400.tif", 230.925, 265.015, 0.001, 0.873),
        stated("thermal_u.tif", 0.3, 1.0, 0.0, 1.0),
    ];
    assert_eq!(with_extension(&site, "tif").len(), layers.len());
    for layer in layers {
        let file = read(&site.join(layer.file));
        assert_eq!(file.raster.spec(), grid, "{}", layer.file);
        assert_eq!(file.body_radius_m(), Some(MARS_RADIUS_M), "{}", layer.file);
        layer.check(&file);
    }
}

/// The site's elevation is a crop of its source with a plane added, so both must lie where they say.
#[test]
fn gale_crater_is_its_cloud_optimised_source_on_a_tilted_plane() {
    let Some(terrain) = terrain("gale_crater_is_its_cloud_optimised_source_on_a_tilted_plane")
    else {
        return;
    };
    let site = terrain.join("gale-ctx-20m");
    let sources = with_extension(&site.join("source"), "tif");
    let (dem, source) = (read(&site.join("dem.tif")), read(&sources[0]));
    let (grid, whole) = (dem.raster.spec(), source.raster.spec());
    assert_eq!((whole.cols(), whole.rows(), whole.spacing_m()), (720, 1735, 20.0));
    assert_eq!(grid.west_m() - whole.west_m(), 78.0 * 20.0);
    assert_eq!(whole.north_m() - grid.north_m(), 205.0 * 20.0);
    for (cell, &height) in dem.raster.iter() {
        let there = Cell::new(cell.row + 205, cell.col + 78);
        assert_eq!(dem.known[cell], source.known[there], "{cell}");
        let (east, north) = grid.centre_m(cell);
        let plane = 561.350 - 19.588e-4 * (east - 8_144_000.0) + 13.031e-4 * (north + 278_000.0);
        let wanted = f64::from(source.raster[there]) + plane;
        // Heights of -4500 m step by 0.5 mm in float32.
        assert!(!dem.known[cell] || (f64::from(height) - wanted).abs() < 1e-3, "{cell}: {height}");
    }
}

/// Slope by the weighted differences of all eight neighbours (Horn 1981), degrees; none beside a hole. A cell at the
/// border stands for its missing neighbours, as in the description's own computation.
fn horn_slope(dem: &GridFile, cell: Cell) -> Option<f32> {
    let spec = dem.raster.spec();
    let height = |d_row: isize, d_col: isize| {
        let row = cell.row.saturating_add_signed(d_row).min(spec.rows() - 1);
        let col = cell.col.saturating_add_signed(d_col).min(spec.cols() - 1);
        let there = Cell::new(row, col);
        dem.known[there].then_some(f64::from(dem.raster[there]))
    };
    let line = |from: (isize, isize), step: (isize, isize)| {
        let at = |n: isize| height(from.0 + n * step.0, from.1 + n * step.1);
        Some(at(0)? + 2.0 * at(1)? + at(2)?)
    };
    height(0, 0)?;
    let east = line((-1, 1), (1, 0))? - line((-1, -1), (1, 0))?;
    let north = line((-1, -1), (0, 1))? - line((1, -1), (0, 1))?;
    Some((east.hypot(north) / (8.0 * spec.spacing_m())).atan().to_degrees() as f32)
}

/// The median and the limit that 95 % stay below.
fn quantiles(mut values: Vec<f32>) -> (f32, f32) {
    values.sort_by(f32::total_cmp);
    (values[values.len() / 2], values[values.len() * 95 / 100])
}

#[test]
fn gale_crater_is_as_steep_as_its_description_says() {
    let Some(terrain) = terrain("gale_crater_is_as_steep_as_its_description_says") else { return };
    let dem = read(&terrain.join("gale-ctx-20m/dem.tif"));
    let ours = slope(&dem.clone().into_layer().unwrap());
    let cells = || dem.raster.spec().cells().filter_map(|c| Some((c, horn_slope(&dem, c)?)));
    let (median, steep) = quantiles(cells().map(|(_, degrees)| degrees).collect());
    // Printed: median 5.4, 95 % below 21.8 degrees (21.75 in the metadata).
    assert!((median - 5.4).abs() <= 0.05 && (steep - 21.75).abs() <= 0.01, "{median}, {steep}");
    // Two neighbours an axis smooth less than six: on the same cells, a little steeper and no more.
    let (our_median, our_steep) = quantiles(cells().map(|(cell, _)| ours.value(cell)).collect());
    assert!((median..median + 0.1).contains(&our_median), "{our_median}, by Horn {median}");
    assert!((steep..steep + 0.3).contains(&our_steep), "{our_steep}, by Horn {steep}");
}

/// x = R cos(latitude of true scale) (longitude − central meridian), y = R latitude, from degrees, in metres.
fn equidistant(radius_m: f64, true_scale: f64, longitude: f64, latitude: f64) -> (f64, f64) {
    let scale = radius_m * true_scale.to_radians().cos();
    (scale * longitude.to_radians(), radius_m * latitude.to_radians())
}

#[test]
fn jezero_crater_reads_where_its_degrees_say() {
    let Some(terrain) = terrain("jezero_crater_reads_where_its_degrees_say") else { return };
    let dem = read(&terrain.join("jezero-mola-463m/dem.tif"));
    let spec = dem.raster.spec();
    assert_eq!((spec.cols(), spec.rows(), spec.spacing_m()), (255, 269, 440.0));
    let (west, north) = equidistant(MARS_RADIUS_M, 18.5, 76.21875, 19.429_687_5);
    assert!((spec.west_m() - west).abs() < 1e-3 && (spec.north_m() - north).abs() < 1e-3);
    assert_eq!(dem.body_radius_m(), Some(MARS_RADIUS_M));
    let (least, most, known) = range(&dem);
    // Interpolated between the postings of the degree grid, whose range is printed: within it, and close to it.
    assert!((-3323.0..-3300.0).contains(&least) && (-230.0..=-187.0).contains(&most));
    assert_eq!(known, 1.0);
}

#[test]
fn a_grid_in_degrees_is_refused_with_a_reason() {
    let Some(terrain) = terrain("a_grid_in_degrees_is_refused_with_a_reason") else { return };
    let error = refusal(&terrain.join("jezero-mola-463m/dem_lonlat.tif"));
    let wanted = "dem_lonlat.tif: its grid is in degrees; project it to metres first";
    assert_eq!(error.to_string(), wanted);
}

#[test]
fn the_mars_yard_reads_in_its_local_frame() {
    let Some(terrain) = terrain("the_mars_yard_reads_in_its_local_frame") else { return };
    let dem = read(&terrain.join("marsyard2021-0.094m/dem.tif"));
    let spec = dem.raster.spec();
    assert_eq!((spec.cols(), spec.rows(), spec.spacing_m()), (500, 500, 0.094));
    assert_eq!(dem.body_radius_m(), None);
    stated("dem.tif", -0.98, 5.59, 0.01, 1.0).check(&dem);
}

#[test]
fn the_pit_on_the_moon_reads_on_the_moons_sphere() {
    let Some(terrain) = terrain("the_pit_on_the_moon_reads_on_the_moons_sphere") else { return };
    let site = terrain.join("moon-tranquillitatis-pit-2m");
    let (dem, ortho) = (read(&site.join("dem.tif")), read(&site.join("ortho.tif")));
    let (heights, image) = (dem.raster.spec(), ortho.raster.spec());
    assert_eq!((heights.cols(), heights.rows(), heights.spacing_m()), (257, 257, 2.0));
    assert_eq!((image.cols(), image.rows(), image.spacing_m()), (1024, 1024, 0.5));
    assert_eq!((heights.west_m(), heights.north_m()), (image.west_m(), image.north_m()));
    assert_eq!(dem.body_radius_m(), Some(MOON_RADIUS_M));
    assert_eq!(ortho.body_radius_m(), Some(MOON_RADIUS_M));
    let (x, y) = heights.centre_m(Cell::new(128, 128));
    // The centre is printed to 0.001 degrees of longitude from the meridian of 180; half of that is 15 m.
    let (east, north) = equidistant(MOON_RADIUS_M, 8.0, 33.222 - 180.0, 8.333);
    assert!((x - east).abs() < 16.0 && (y - north).abs() < 16.0, "({x}, {y})");
    // The floor of the pit is missing: 4.2 %.
    stated("dem.tif", -19.0, -0.5, 1.0, 0.958).check(&dem);
    // An image without a nodata value is known everywhere.
    assert!(ortho.known.values().iter().all(|&known| known));
}

/// Elevation from an image of 8 bits: 119 m in 255 steps, of which 42 occur, one of them for the missing floor.
#[test]
fn the_pit_on_the_moon_is_a_staircase() {
    let Some(terrain) = terrain("the_pit_on_the_moon_is_a_staircase") else { return };
    let dem = read(&terrain.join("moon-tranquillitatis-pit-2m/dem.tif"));
    let cells = dem.raster.iter();
    let mut heights: Vec<f32> =
        cells.filter_map(|(cell, &height)| dem.known[cell].then_some(height)).collect();
    heights.sort_by(f32::total_cmp);
    heights.dedup();
    let levels = heights.iter().map(|&height| (f64::from(height) + 119.0) * 255.0 / 119.0);
    for level in levels {
        // Heights of 19 m step by 2e-6 in float32, four millionths of a level.
        assert!((level - level.round()).abs() < 1e-5, "{level}");
    }
    assert_eq!(heights.len(), 41);
}
