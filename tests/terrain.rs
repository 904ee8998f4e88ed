//! `wisdom terrain` as a user runs it, and a mission on ground that stays in its files.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;
use wisdom_grid::{Cell, GridSpec, Raster, Window};
use wisdom_logbook::LogReader;
use wisdom_terrain::format::{GridFile, read_file, write_geotiff};
use wisdom_terrain::{
    Layer, Method, Observer, Resampling, hazards, hillshade, resample, viewshed_by,
};

fn wisdom(args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_wisdom"));
    command.current_dir(env!("CARGO_MANIFEST_DIR")).args(args);
    command
}

fn done(args: &[&str]) -> String {
    let output = wisdom(args).output().expect("the command runs");
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{args:?}\n{text}\n{errors}");
    text
}

fn refused(args: &[&str]) -> String {
    let Output { status, stderr, .. } = wisdom(args).output().expect("the command runs");
    assert_eq!(status.code(), Some(2), "{args:?}");
    String::from_utf8_lossy(&stderr).into_owned()
}

const DEM: &str = "crates/terrain/tests/data/f32_tiled_deflate_p3.tif";

/// A folder for what a test writes, and paths in it as text.
struct Place(tempfile::TempDir);

impl Place {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a folder"))
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn text(&self, name: &str) -> String {
        self.path(name).to_str().expect("UTF-8").to_owned()
    }

    fn read(&self, name: &str) -> GridFile {
        read_file(&self.path(name)).expect("what was written can be read")
    }
}

fn dem() -> Layer {
    read_file(Path::new(DEM)).expect("it ships").into_layer().expect("readings are finite")
}

/// Values and holes of a file against a layer, bit for bit.
fn same(file: &GridFile, layer: &Layer) {
    assert_eq!(file.raster.spec(), layer.spec());
    for cell in layer.spec().cells() {
        assert_eq!(file.known[cell], layer.is_known(cell), "{cell}");
        assert_eq!(file.raster[cell], layer.value(cell), "{cell}");
    }
}

#[test]
fn info_says_the_same_of_the_same_ground_in_any_format() {
    for name in ["f32_tiled_deflate_p3.tif", "pds3_hirise_style.img", "pds4.xml", "isis.cub"] {
        let file = format!("crates/terrain/tests/data/{name}");
        let told: Value = serde_json::from_str(&done(&["terrain", "info", &file, "--json"]))
            .expect("one JSON object");
        for (key, expected) in [
            ("rows", 48.0),
            ("cols", 64.0),
            ("spacing_m", 1.0),
            ("west_m", 8_142_616.0),
            ("north_m", -276_605.0),
            ("body_radius_m", 3_396_190.0),
            ("known_cells", 48.0 * 64.0 - 30.0),
        ] {
            assert_eq!(told[key].as_f64(), Some(expected), "{name}: {key}");
        }
        let (lon, lat) = (&told["centre_lon_lat_deg"][0], &told["centre_lon_lat_deg"][1]);
        assert!((lon.as_f64().expect("a number") - 137.371_397).abs() < 1e-5, "{name}: {lon}");
        assert!((lat.as_f64().expect("a number") + 4.666_898).abs() < 1e-5, "{name}: {lat}");
    }
    let text = done(&["terrain", "info", "crates/terrain/tests/data/i16_tiled_deflate_p2.tif"]);
    for words in ["GeoTIFF", "stored x 0.01 - 4450", "48 rows x 64 columns of 1 m", "-32768"] {
        assert!(text.contains(words), "{text}");
    }
}

#[test]
fn derived_layers_are_those_of_the_library_at_the_same_place() {
    let (place, dem) = (Place::new(), dem());
    let of_library = hazards(&dem, 2);
    let shade = hillshade(&dem, 315f64.to_radians(), 45f64.to_radians());
    let shade = Layer::new(shade, dem.uncertainty().clone()).expect("a layer");
    for (command, more, layer) in [
        ("gradient", &[][..], &of_library.gradient),
        ("slope", &[], &of_library.slope_deg),
        ("step", &[], &of_library.step_m),
        ("roughness", &["--footprint-m", "2"], &of_library.roughness_m),
        ("hillshade", &[], &shade),
    ] {
        let out = place.text(&format!("{command}.tif"));
        let told = done(&[&["terrain", command, DEM, "-o", &out], more].concat());
        assert_eq!(told.trim_end(), out);
        let file = place.read(&format!("{command}.tif"));
        same(&file, layer);
        assert_eq!(file.body_radius_m(), Some(3_396_190.0), "{command}");
    }
    // The edges of a part see what lies beyond them.
    let out = place.text("part.tif");
    let part = ["--footprint-m", "2", "--window", "5,9,20,30"];
    done(&[&["terrain", "roughness", DEM, "-o", &out][..], &part].concat());
    let window = Window { row: 5, col: 9, rows: 20, cols: 30 };
    same(&place.read("part.tif"), &of_library.roughness_m.crop(window).expect("it lies inside"));
    // Central differences and Horn's part ways on rough ground.
    let out = place.text("horn.tif");
    done(&["terrain", "gradient", DEM, "-o", &out, "--kernel", "horn"]);
    assert_ne!(place.read("horn.tif").raster, place.read("gradient.tif").raster);
}

#[test]
fn traversability_says_what_a_vehicle_can_cross() {
    let place = Place::new();
    std::fs::write(place.path("small.toml"), "slope-max-deg = 6.0\n").expect("it is written");
    let (out, small) = (place.text("blocked.tif"), place.text("small.toml"));
    let blocked = |vehicle: &[&str]| {
        let args = ["terrain", "traversability", DEM, "-o", &out, "--what", "blocked"];
        done(&[&args, vehicle].concat());
        let file = place.read("blocked.tif");
        assert!(file.raster.values().iter().all(|v| *v == 0.0 || *v == 1.0));
        file.raster.values().iter().filter(|v| **v == 1.0).count()
    };
    let (large, small) = (blocked(&[]), blocked(&["--vehicle", &small]));
    assert!(small > large && small < 48 * 64, "{large} and {small}");
    let severity = place.text("severity.tif");
    done(&["terrain", "traversability", DEM, "-o", &severity]);
    let over = place.read("severity.tif").raster.values().iter().filter(|v| **v >= 1.0).count();
    assert_eq!(over, large);
    std::fs::write(place.path("odd.toml"), "slope-max = 6.0\n").expect("it is written");
    let odd = place.text("odd.toml");
    let error = refused(&["terrain", "traversability", DEM, "-o", &severity, "--vehicle", &odd]);
    assert!(error.contains("slope-max") && error.contains("odd.toml"), "{error}");
}

#[test]
fn a_viewshed_is_that_of_the_library_and_keeps_its_limits() {
    let (place, dem) = (Place::new(), dem());
    for method in [Method::Exact, Method::Fast] {
        let out = place.text("seen.tif");
        let name = method.to_string();
        let args = ["terrain", "viewshed", DEM, "-o", &out, "--observer", "20,30", "--height", "1"];
        done(&[&args[..], &["--method", &name, "--range", "25"]].concat());
        let observer =
            Observer { range_m: Some(25.0), ..Observer::all_round(Cell { row: 30, col: 20 }, 1.0) };
        let seen = viewshed_by(method, &dem, &observer);
        let file = place.read("seen.tif");
        for cell in dem.spec().cells() {
            assert_eq!(file.known[cell], dem.is_known(cell), "{cell}");
            assert_eq!(file.raster[cell] == 1.0, seen.is_visible(cell), "{method} at {cell}");
        }
    }
    let out = place.text("seen.png");
    for (more, words) in [
        (["--observer", "64,0"], "--observer 64,0"),
        (["--observer", "33,22"], "nothing is known of the ground there"),
        (["--observer", "3"], "expected COL,ROW"),
    ] {
        let error = refused(&[&["terrain", "viewshed", DEM, "-o", &out][..], &more].concat());
        assert!(error.contains(words), "{error}");
    }
    done(&["terrain", "viewshed", DEM, "-o", &out, "--observer", "20,30", "--radius-m", "file"]);
    assert!(std::fs::read(place.path("seen.png")).expect("a picture").starts_with(b"\x89PNG"));
}

#[test]
fn a_file_is_cut_and_brought_onto_other_grids() {
    let place = Place::new();
    let cut = place.text("cut.tif");
    done(&["terrain", "convert", DEM, &cut, "--window", "4,10,20,30"]);
    let whole = read_file(Path::new(DEM)).expect("it ships");
    let window = Window { row: 4, col: 10, rows: 20, cols: 30 };
    let file = place.read("cut.tif");
    assert_eq!(file.raster, whole.raster.crop(window).expect("it lies inside"));
    assert_eq!(file.known, whole.known.crop(window).expect("it lies inside"));
    assert!(
        file.crs.expect("it was kept").same_projection(&whole.crs.clone().expect("a Mars map"))
    );

    let coarse = place.text("coarse.tif");
    done(&["terrain", "convert", DEM, &coarse, "--resample", "average", "--spacing-m", "4"]);
    let spec = GridSpec::new(12, 16, 4.0).expect("a grid").at(8_142_616.0, -276_605.0);
    let expected = resample(&whole, spec, Resampling::Average);
    let file = place.read("coarse.tif");
    assert_eq!((file.raster, file.known), (expected.raster, expected.known));

    let like = place.text("like.tif");
    done(&["terrain", "convert", &coarse, &like, "--resample", "nearest", "--like", &cut]);
    assert_eq!(place.read("like.tif").raster.spec(), place.read("cut.tif").raster.spec());

    for (args, words) in [
        (vec!["terrain", "convert", DEM, DEM], "it is read here"),
        (vec!["terrain", "convert", DEM, "Cargo.toml"], "ends in .tif"),
        (vec!["terrain", "convert", DEM, &cut, "--window", "40,0,9,9"], "--window"),
        (vec!["terrain", "convert", DEM, &cut, "--resample", "average"], "--spacing-m M or --like"),
        (
            vec!["terrain", "convert", "README.md", &cut],
            "README.md is bytes of no format known here",
        ),
        (vec!["terrain", "slope", DEM, "-o", "Cargo.lock"], "ends in .tif"),
        (vec!["terrain", "slope", "nowhere.tif", "-o", &cut], "nowhere.tif"),
    ] {
        let error = refused(&args);
        assert!(error.contains(words), "{args:?}: {error}");
    }
    // No file that is read is written over, by whatever name.
    let own = place.text("own.tif");
    std::fs::copy(DEM, place.path("own.tif")).expect("it is copied");
    let roundabout = place.text("./own.tif");
    for args in [
        vec!["terrain", "slope", &own, "-o", &own],
        vec!["terrain", "hillshade", &own, "-o", &roundabout],
        vec!["terrain", "viewshed", &own, "--observer", "5,5", "-o", &own],
        vec!["terrain", "traversability", DEM, "--uncertainty", &own, "-o", &own],
        vec!["terrain", "convert", DEM, &own, "--resample", "mode", "--like", &own],
    ] {
        assert!(refused(&args).contains("it is read here"), "{args:?}");
    }
    assert_eq!(std::fs::read(&own).expect("it is there"), std::fs::read(DEM).expect("it ships"));
    let nowhere = place.text("none/out.tif");
    assert!(refused(&["terrain", "slope", DEM, "-o", &nowhere]).contains("there is no folder"));
    // What is there and is no GeoTIFF stays.
    let note = place.path("note.tif");
    std::fs::write(&note, "keep me").expect("it is written");
    let note_text = place.text("note.tif");
    assert!(refused(&["terrain", "slope", DEM, "-o", &note_text]).contains("is no GeoTIFF"));
    assert_eq!(std::fs::read_to_string(note).expect("it is there"), "keep me");
}

#[test]
fn pictures_are_drawn_as_maps_and_as_surfaces() {
    let place = Place::new();
    let slope = place.text("slope.tif");
    done(&["terrain", "slope", DEM, "-o", &slope]);
    for (name, more) in [
        ("map.png", &[][..]),
        ("drape.png", &["--drape", &slope]),
        ("surface.png", &["--surface", "--exaggerate", "2", "--drape", &slope]),
    ] {
        let out = place.text(name);
        done(&[&["terrain", "figure", DEM, "-o", &out][..], more].concat());
        assert!(std::fs::read(place.path(name)).expect("it is there").starts_with(b"\x89PNG"));
    }
    assert!(refused(&["terrain", "figure", DEM, "-o", &slope]).contains(".png"));
}

const SCENE: &str = r"
base = { elevation_m = -4500.0, texture = 1, temperature = 3.0 }
roughness = { amplitude_m = 2.0, wavelength_cells = 90.0, octaves = 3, gain = 0.4 }
[[scatter]]
per_1000_cells = 2.5
radius_cells = [1.5, 4.0]
exponent = 2.0
height_m_per_cell = 0.7
class = 4
";

/// The files of a scene, as GeoTIFF.
fn synthesize(place: &Place, side: &str) {
    std::fs::write(place.path("scene.toml"), SCENE).expect("it is written");
    let scene = place.text("scene.toml");
    for layer in ["elevation", "texture", "temperature"] {
        let out = place.text(&format!("{layer}.tif"));
        let args = ["terrain", "synthesize", &scene, "-o", &out, "--rows", side, "--cols", side];
        done(&[&args[..], &["--layer", layer, "--seed", "5"]].concat());
    }
}

/// The paper's mission moved onto ground from files, with a working map.
fn mission(place: &Place, start: &str) -> PathBuf {
    let text = std::fs::read_to_string("missions/paper/mission.toml").expect("it ships");
    let mut document: toml::Table = text.parse().expect("it is TOML");
    let terrain: toml::Table = "working-cells = 128".parse().expect("TOML");
    document.insert("terrain".to_owned(), terrain.into());
    let prior: toml::Table = "kind = \"averaged\"\nblock = 8\nu = 0.6".parse().expect("TOML");
    document.insert("prior".to_owned(), prior.into());
    for layer in document["layer"].as_array_mut().expect("layers") {
        let layer = layer.as_table_mut().expect("a table");
        if !layer.contains_key("derived") {
            let name = layer["name"].as_str().expect("a name").to_owned();
            layer.insert("file".to_owned(), format!("{name}.tif").into());
        }
    }
    let rover = document["rover"].as_table_mut().expect("a table");
    rover.insert(
        "start".to_owned(),
        format!("{start} ").trim().parse::<toml::Value>().expect("TOML"),
    );
    for expert in document["experts"].as_array_mut().expect("experts") {
        let path = expert.as_str().expect("a path").to_owned();
        let from = Path::new("missions/paper").join(&path);
        std::fs::create_dir_all(place.path("experts")).expect("a folder");
        std::fs::copy(from, place.path(&path)).expect("it is copied");
    }
    let path = place.path("mission.toml");
    std::fs::write(&path, document.to_string()).expect("it is written");
    path
}

#[test]
fn a_mission_runs_on_ground_that_stays_in_its_files_and_is_logged_by_digest() {
    let place = Place::new();
    synthesize(&place, "700");
    let path = mission(&place, "[350, 350]");
    let (mission, log) = (path.to_str().expect("UTF-8"), place.text("run.mcap"));
    let short = ["--set", "budget.energy-j=1.2e6", "--set", "goals.expansions=5000"];
    let run = done(&[&["run", mission, "--log", &log, "--json"][..], &short].concat());
    let run: Value = serde_json::from_str(&run).expect("one JSON object");
    assert!(!run["goals"].as_array().expect("goals").is_empty(), "{run}");

    // The log carries no terrain, only what the files are.
    let read = LogReader::open(Path::new(&log)).expect("a log");
    let names: Vec<&str> = read.attachments.iter().map(|a| a.name.as_str()).collect();
    assert!(
        names.iter().all(|name| Path::new(name).extension().is_none_or(|e| e != "tif")),
        "{names:?}"
    );
    let reference = read
        .attachments
        .iter()
        .find(|a| a.name.ends_with("elevation.tif.reference.toml"))
        .expect("what the elevation is");
    let reference = String::from_utf8(reference.data.clone()).expect("text");
    let bytes = std::fs::read(place.path("elevation.tif")).expect("it is there");
    assert!(reference.contains(&format!("bytes = {}", bytes.len())), "{reference}");
    assert!(reference.contains(&blake3::hash(&bytes).to_hex().to_string()), "{reference}");

    // It can be told, verified and drawn without the ground.
    for layer in ["elevation", "texture", "temperature"] {
        std::fs::remove_file(place.path(&format!("{layer}.tif"))).expect("it was there");
    }
    assert!(done(&["verify", &log]).contains("identical"), "verify");
    assert!(done(&["replay", &log]).contains("Decision 0"));
    let picture = place.text("map.png");
    done(&["show", &log, "-o", &picture]);
    assert!(std::fs::read(place.path("map.png")).expect("a picture").starts_with(b"\x89PNG"));
    // A map of a decision lies where the rover was, at most a working map wide.
    let map = read.map(wisdom_logbook::topic::INTEREST, 0).expect("it was logged");
    let spec = map.spec();
    assert_eq!((spec.rows(), spec.cols()), (128, 128));
    assert!(spec.contains(Cell { row: 350, col: 350 }), "{spec:?}");

    // Without its files the mission cannot run, and says which is missing.
    assert!(refused(&["check", mission]).contains("elevation.tif"));
}

#[test]
fn layers_on_other_grids_are_brought_together_where_the_mission_asks() {
    let place = Place::new();
    let grid = |rows, cols, spacing_m| GridSpec::new(rows, cols, spacing_m).expect("a grid");
    let write = |name: &str, spec: GridSpec, value: &dyn Fn(Cell) -> f32| {
        let mut file = GridFile::unknown(spec);
        file.raster = Raster::from_fn(spec, value);
        file.known = Raster::filled(spec, true);
        write_geotiff(&place.path(name), &file).expect("it is written");
    };
    write("elevation.tif", grid(60, 60, 1.0), &|c| (c.row % 7) as f32 * 0.01);
    write("temperature.tif", grid(20, 20, 3.0), &|c| c.col as f32);
    write("texture.tif", grid(30, 30, 2.0), &|c| if c.col < 15 { 1.0 } else { 4.0 });
    let path = mission(&place, "[30, 30]");
    let text = std::fs::read_to_string(&path).expect("it is there");
    let text = text.replace("working-cells = 128", "");
    std::fs::write(&path, &text).expect("it is written");
    let error = refused(&["check", path.to_str().expect("UTF-8")]);
    assert!(error.contains("`resample`") && error.contains("20 x 20"), "{error}");
    let mut document: toml::Table = text.parse().expect("TOML");
    for layer in document["layer"].as_array_mut().expect("layers") {
        let layer = layer.as_table_mut().expect("a table");
        let way = match layer["name"].as_str() {
            Some("temperature") => "bilinear",
            Some("texture") => "nearest",
            _ => continue,
        };
        layer.insert("resample".to_owned(), way.into());
    }
    std::fs::write(&path, document.to_string()).expect("it is written");
    let mission = wisdom_mission::Mission::load(&path, &[]).expect("the layers fit now");
    let temperature = mission.world.truth("temperature").expect("it is in memory");
    // Between the middles of cells 3 m wide the values rise by a third a metre.
    assert!(
        (temperature.value(Cell { row: 30, col: 30 }) - (30.5 / 3.0 - 0.5) as f32).abs() < 1e-6
    );
    let texture = mission.world.truth("texture").expect("it is in memory");
    assert_eq!([29, 30].map(|col| texture.value(Cell { row: 7, col })), [1.0, 4.0]);
    // Classes have no mean.
    let wrong = document.to_string().replace("\"nearest\"", "\"average\"");
    std::fs::write(&path, wrong).expect("it is written");
    assert!(refused(&["check", path.to_str().expect("UTF-8")]).contains("classes have no mean"));
}
