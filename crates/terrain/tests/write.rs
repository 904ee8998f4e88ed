//! GeoTIFF as this crate writes it: the same bits back, and GDAL's opinion of it.

use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::process::Command;

use proptest::prelude::*;
use wisdom_grid::{Cell, GridSpec, Raster};
use wisdom_terrain::format::{self, About, GeoTiffOptions, GeoTiffWriter, GridReader, Sample};
use wisdom_terrain::{Crs, GridFile, Layer, Projection, TerrainError};

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)
}

fn grid(spec: GridSpec, cells: &[Option<f32>]) -> GridFile {
    let value = |cell: Cell| cells[spec.index(cell) % cells.len()];
    GridFile {
        raster: Raster::from_fn(spec, |cell| value(cell).unwrap_or(0.0)),
        known: Raster::from_fn(spec, |cell| value(cell).is_some()),
        crs: None,
        about: About::default(),
    }
}

fn bits(raster: &Raster<f32>) -> Vec<u32> {
    raster.values().iter().map(|value| value.to_bits()).collect()
}

/// The bytes of a grid, given to the writer `rows` at a time.
fn written(
    file: &GridFile,
    options: &GeoTiffOptions,
    rows: usize,
) -> Result<Vec<u8>, TerrainError> {
    let (spec, crs) = (file.raster.spec(), file.crs.as_ref());
    let out = Cursor::new(Vec::new());
    let mut writer = GeoTiffWriter::new("x.tif", out, spec, crs, options)?;
    let step = rows * spec.cols();
    for (values, known) in file.raster.values().chunks(step).zip(file.known.values().chunks(step)) {
        writer.write_rows(values, known)?;
    }
    Ok(writer.finish()?.into_inner())
}

fn assert_comes_back(file: &GridFile, options: &GeoTiffOptions, rows: usize) {
    let bytes = written(file, options, rows).expect("values that can be stored");
    let back = format::read("x.tif", &bytes).expect("a sound file");
    assert_eq!(bits(&back.raster), bits(&file.raster));
    assert_eq!(back.raster.spec(), file.raster.spec());
    assert_eq!(back.known, file.known);
    assert_eq!(back.crs, file.crs);
}

/// Every finite float but nodata and the bit patterns reserved for missing pixels.
fn any_height() -> impl Strategy<Value = f32> {
    let any_bits = any::<u32>().prop_map(f32::from_bits);
    let usable = |value: &f32| {
        value.is_finite()
            && *value != -32767.0
            && !(0xFF7F_FFFA..=0xFF7F_FFFF).contains(&value.to_bits())
    };
    prop_oneof![
        any_bits.prop_filter("a value that can be stored", usable),
        -4500.0_f32..-4400.0,
        prop::sample::select(vec![
            0.0,
            -0.0,
            f32::MAX,
            f32::MIN_POSITIVE,
            -3.4e38,
            1e-45,
            -32768.0
        ]),
    ]
}

proptest! {
    #[test]
    fn floats_come_back_bit_by_bit(
        rows in 1..70_usize,
        cols in 1..70_usize,
        at_once in 1..80_usize,
        tile in 1..5_usize,
        place in (-1e7..1e7_f64, -1e7..1e7_f64, 0.01..500.0_f64),
        big_tiff in any::<bool>(),
        nodata in prop::option::of(Just(-32767.0)),
        cells in prop::collection::vec(prop::option::weighted(0.8, any_height()), 1..300),
    ) {
        let spec = GridSpec::new(rows, cols, place.2).unwrap().at(place.0, place.1);
        let options = GeoTiffOptions {
            tile_side: 16 * tile,
            big_tiff,
            nodata,
            ..GeoTiffOptions::new(Sample::F32)
        };
        assert_comes_back(&grid(spec, &cells), &options, at_once);
    }

    #[test]
    fn bytes_come_back(
        rows in 1..70_usize,
        cols in 1..70_usize,
        at_once in 1..80_usize,
        cells in prop::collection::vec(prop::option::weighted(0.8, 0..255_u8), 1..300),
    ) {
        let cells: Vec<Option<f32>> = cells.into_iter().map(|class| class.map(f32::from)).collect();
        let spec = GridSpec::new(rows, cols, 1.0).unwrap();
        let options = GeoTiffOptions { tile_side: 32, ..GeoTiffOptions::new(Sample::U8) };
        assert_comes_back(&grid(spec, &cells), &options, at_once);
    }
}

#[test]
fn the_bytes_do_not_depend_on_the_number_of_threads_or_of_rows_at_once() {
    let spec = GridSpec::new(300, 210, 1.0).unwrap();
    let cells: Vec<Option<f32>> =
        (0..7919).map(|i| (i % 13 != 0).then_some((i * i % 1009) as f32 * 0.01)).collect();
    let (file, options) =
        (grid(spec, &cells), GeoTiffOptions { tile_side: 64, ..GeoTiffOptions::new(Sample::F32) });
    let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let one = pool(1).install(|| written(&file, &options, 300).unwrap());
    for (threads, rows) in [(2, 300), (4, 1), (8, 77)] {
        assert_eq!(one, pool(threads).install(|| written(&file, &options, rows).unwrap()));
    }
}

#[test]
fn a_file_says_what_it_holds() {
    let file = grid(GridSpec::new(3, 4, 1.0).unwrap(), &[Some(1.0), None]);
    let about = |options: &GeoTiffOptions| {
        format::read("x.tif", &written(&file, options, 3).unwrap()).unwrap().about
    };
    let options = GeoTiffOptions::new(Sample::F32);
    let float = about(&options);
    assert_eq!(float.storage, "float32, tiles of 256 x 256, deflate, predictor 3, little endian");
    assert_eq!(float.nodata.as_deref(), Some("-32767"));
    let byte = about(&GeoTiffOptions { big_tiff: true, ..GeoTiffOptions::new(Sample::U8) });
    assert_eq!(
        byte.storage,
        "uint8, tiles of 256 x 256, deflate, predictor 2, little endian, BigTIFF"
    );
    assert_eq!(byte.nodata.as_deref(), Some("255"));
    assert_eq!(about(&GeoTiffOptions { nodata: None, ..options }).nodata, None);
}

#[test]
fn what_could_not_be_read_back_is_refused() {
    let refusal = |cells: &[Option<f32>], options: &GeoTiffOptions| {
        let file = grid(GridSpec::new(2, 2, 1.0).unwrap(), cells);
        written(&file, options, 2).unwrap_err().to_string()
    };
    let (float, byte) = (GeoTiffOptions::new(Sample::F32), GeoTiffOptions::new(Sample::U8));
    assert_eq!(
        refusal(&[Some(1.0), Some(-32767.0)], &float),
        "x.tif: the value -32767 at (row 0, col 1) is the file's nodata; another nodata is wanted"
    );
    assert!(refusal(&[Some(f32::NAN)], &float).contains("is not finite"));
    assert!(refusal(&[Some(f32::MIN)], &float).contains("is reserved for missing pixels"));
    assert!(refusal(&[Some(3.5)], &byte).contains("no whole number of 0 to 255"));
    assert!(refusal(&[Some(256.0)], &byte).contains("no whole number of 0 to 255"));
    assert!(refusal(&[Some(255.0)], &byte).contains("is the file's nodata"));
    let none = GeoTiffOptions { nodata: None, ..byte.clone() };
    assert!(refusal(&[None], &none).contains("is unknown"));
    for (side, nodata) in [(0, 1.0), (100, 1.0), (8192, 1.0), (256, 0.5), (256, -1.0)] {
        let options = GeoTiffOptions { tile_side: side, nodata: Some(nodata), ..byte.clone() };
        assert!(refusal(&[Some(7.0)], &options).starts_with("x.tif: "));
    }
}

#[test]
fn rows_that_are_not_whole_too_many_or_missing_are_errors() {
    let spec = GridSpec::new(3, 4, 1.0).unwrap();
    let writer = || {
        let out = Cursor::new(Vec::new());
        GeoTiffWriter::new("x.tif", out, spec, None, &GeoTiffOptions::new(Sample::F32)).unwrap()
    };
    assert!(writer().write_rows(&[0.0; 5], &[true; 5]).is_err());
    assert!(writer().write_rows(&[0.0; 4], &[true; 8]).is_err());
    assert!(writer().write_rows(&[0.0; 16], &[true; 16]).is_err());
    let mut short = writer();
    short.write_rows(&[0.0; 8], &[true; 8]).unwrap();
    let error = short.finish().err().unwrap().to_string();
    assert_eq!(error, "x.tif: 2 rows were written of 3");
}

/// Until the end the first bytes are zeros.
#[test]
fn half_a_file_is_no_tiff() {
    let spec = GridSpec::new(64, 16, 1.0).unwrap();
    let options = GeoTiffOptions { tile_side: 16, ..GeoTiffOptions::new(Sample::F32) };
    let mut out = Cursor::new(Vec::new());
    let mut writer = GeoTiffWriter::new("x.tif", &mut out, spec, None, &options).unwrap();
    writer.write_rows(&[5.0; 48 * 16], &[true; 48 * 16]).unwrap();
    drop(writer);
    let half = out.into_inner();
    assert!(half.len() > 400);
    assert!(matches!(format::read("x.tif", &half), Err(TerrainError::Format { .. })));
}

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    entries
        .map(|entry| entry.expect("an entry").file_name().into_string().expect("a name in UTF-8"))
        .collect()
}

#[test]
fn a_failed_write_leaves_what_was_there_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("dem.tif");
    let spec = GridSpec::new(40, 40, 1.0).unwrap();
    let good = grid(spec, &[Some(1.0), None]);
    format::write_geotiff(&path, &good).unwrap();
    assert_eq!(names(folder.path()), ["dem.tif"]);
    let before = std::fs::read(&path).unwrap();
    // The last cell cannot be stored.
    let mut bad = grid(spec, &[Some(2.0)]);
    bad.raster.values_mut()[1599] = f32::INFINITY;
    let error = format::write_geotiff(&path, &bad).unwrap_err().to_string();
    assert!(error.contains("dem.tif: the value inf at (row 39, col 39)"), "{error}");
    assert_eq!(names(folder.path()), ["dem.tif"]);
    assert_eq!(std::fs::read(&path).unwrap(), before);
    format::write_geotiff(&path, &grid(spec, &[Some(2.0)])).unwrap();
    assert_ne!(std::fs::read(&path).unwrap(), before);
    assert_eq!(names(folder.path()), ["dem.tif"]);
    let nowhere = folder.path().join("none/dem.tif");
    let error = format::write_geotiff(&nowhere, &good).unwrap_err();
    assert!(matches!(&error, TerrainError::Io { action: "create", .. }), "{error}");
    assert!(error.to_string().contains("none/dem.tif: cannot create it: "), "{error}");
}

#[test]
fn another_nodata_stands_in_where_the_usual_one_is_a_value() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("dem.tif");
    let file = grid(GridSpec::new(5, 5, 1.0).unwrap(), &[Some(-32767.0), None, Some(3.0)]);
    format::write_geotiff(&path, &file).unwrap();
    let back = GridReader::open(&path).unwrap().read(file.raster.spec().window()).unwrap();
    assert_eq!((back.raster, back.known), (file.raster, file.known));
}

#[test]
fn a_layer_is_written_where_it_is_known() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("layer.tif");
    let spec = GridSpec::new(3, 2, 0.5).unwrap().at(10.0, 20.0);
    let mut layer = Layer::unknown(spec);
    layer.set(Cell::new(1, 1), 4.25, 0.3);
    layer.set(Cell::new(2, 0), -1.0, 0.0);
    let crs = Crs {
        name: "Moon".to_owned(),
        body: String::new(),
        radius_m: Some(1_737_400.0),
        polar_radius_m: Some(1_737_400.0),
        projection: Projection::PolarStereographic {
            centre_lon_deg: 0.0,
            pole_lat_deg: -90.0,
            scale_at_pole: 1.0,
            false_easting_m: 0.0,
            false_northing_m: 0.0,
        },
    };
    format::write_layer(&path, &layer, Some(&crs)).unwrap();
    let back = GridReader::open(&path).unwrap().read(spec.window()).unwrap();
    let told = back.crs.expect("it was written");
    assert!(told.body.contains("1737400"), "a body without a name is called by its radius");
    assert_eq!(Crs { body: String::new(), ..told }, crs);
    assert_eq!(back.known.values(), [false, false, false, true, true, false]);
    assert_eq!(back.raster.values(), layer.values().values());
}

/// Whether a program of GDAL runs here; if not, the test named says so.
#[expect(clippy::print_stdout, reason = "a test that was skipped says so in the test log")]
fn has(program: &str, test: &str) -> bool {
    let runs = Command::new(program).arg("--version").output().is_ok();
    if !runs {
        println!("skipped: {test}: {program} is not installed");
    }
    runs
}

fn output(command: &mut Command) -> String {
    let output = command.output().expect("a program of GDAL");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    // A warning about a tag would be one about us.
    assert!(output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("UTF-8")
}

/// What `gdalinfo` says of projection and body (as PROJ writes them), place, spacing, size and nodata.
fn gdalinfo(path: &Path) -> Vec<String> {
    let text = output(Command::new("gdalinfo").arg("-proj4").arg(path));
    let lines = text.lines().map(str::trim);
    let wanted = [
        "Size is",
        "'+proj",
        "+proj",
        "Origin =",
        "Pixel Size =",
        "NoData Value=",
        "Unit Type",
        "Description",
    ];
    lines
        .filter(|line| wanted.iter().any(|start| line.starts_with(start)))
        .map(str::to_owned)
        .collect()
}

/// All cells as `gdal_translate` gives them: raw little-endian floats.
fn gdal_floats(path: &Path, folder: &Path) -> Vec<u32> {
    let raw = folder.join("raw.bin");
    output(
        Command::new("gdal_translate")
            .args(["-q", "-of", "ENVI", "-ot", "Float32"])
            .arg(path)
            .arg(&raw),
    );
    let bytes = std::fs::read(&raw).expect("the raw cells");
    let words = bytes.chunks_exact(4);
    words.map(|word| u32::from_le_bytes([word[0], word[1], word[2], word[3]])).collect()
}

/// The flavours that ship, and the further ones where `WISDOM_DATA` names their folder.
#[expect(clippy::print_stdout, reason = "a test that was skipped in part says so in the test log")]
fn flavours(test: &str) -> Vec<PathBuf> {
    let mut folders = vec![data("")];
    match std::env::var_os("WISDOM_DATA").filter(|folder| !folder.is_empty()) {
        Some(folder) => folders.push(Path::new(&folder).join("data/terrain/formats")),
        None => println!("skipped: {test}: the further flavours: WISDOM_DATA is not set"),
    }
    let entries = folders.iter().flat_map(|folder| std::fs::read_dir(folder).expect("a folder"));
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry").path()).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "tif"));
    paths.sort();
    assert!(paths.len() == 11 || paths.len() == 11 + 14, "{}", paths.len());
    paths
}

#[test]
fn gdal_sees_the_same_projection_place_and_values_as_in_the_source() {
    let test = "gdal_sees_the_same_projection_place_and_values_as_in_the_source";
    if !has("gdalinfo", test) || !has("gdal_translate", test) {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let site =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../missions/marias-pass/terrain/dem.tif");
    for path in flavours(test).iter().chain([&site]) {
        let source = GridReader::open(path).unwrap();
        let file = source.read(source.spec().window()).unwrap();
        let ours = folder.path().join("ours.tif");
        format::write_geotiff(&ours, &file).unwrap();
        let (mine, theirs) = (gdalinfo(&ours), gdalinfo(path));
        let place = |lines: &[String]| -> Vec<String> {
            let apart =
                |line: &&String| ["NoData", "Desc"].iter().all(|word| !line.starts_with(word));
            lines.iter().filter(apart).cloned().collect()
        };
        assert_eq!(place(&mine), place(&theirs), "{}", path.display());
        assert!(mine.iter().any(|line| line.contains("R=3396190")), "{mine:?}");
        assert!(mine.contains(&"NoData Value=-32767".to_owned()), "{mine:?}");
        let wanted: Vec<u32> = file
            .raster
            .iter()
            .map(|(cell, value)| if file.known[cell] { *value } else { -32767.0 }.to_bits())
            .collect();
        assert_eq!(gdal_floats(&ours, folder.path()), wanted, "{}", path.display());
    }
}

/// PROJ's words for each projection, written by us and by GDAL, seen by GDAL and by us.
#[test]
fn gdal_and_we_mean_the_same_by_every_projection() {
    let test = "gdal_and_we_mean_the_same_by_every_projection";
    if !has("gdalinfo", test) || !has("gdal_translate", test) {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let (ours, theirs) = (folder.path().join("ours.tif"), folder.path().join("theirs.tif"));
    for (proj, is_parsed) in [
        (
            "+proj=eqc +lat_ts=18.5 +lat_0=0 +lon_0=180 +x_0=0 +y_0=0 +R=3396190 +units=m +no_defs",
            true,
        ),
        (
            "+proj=eqc +lat_ts=-8 +lat_0=0 +lon_0=-23.25 +x_0=1000 +y_0=-2000 +R=1737400 +units=m +no_defs",
            true,
        ),
        ("+proj=eqc +lat_ts=8 +lat_0=5 +lon_0=0 +x_0=0 +y_0=0 +R=1737400 +units=m +no_defs", false),
        ("+proj=stere +lat_0=90 +lon_0=0 +k=1 +x_0=0 +y_0=0 +R=3396190 +units=m +no_defs", true),
        (
            "+proj=stere +lat_0=-90 +lon_0=30 +k=0.994 +x_0=2000000 +y_0=2000000 +a=3396190 +b=3376200 +units=m +no_defs",
            true,
        ),
        (
            "+proj=stere +lat_0=-90 +lat_ts=-71 +lon_0=0 +x_0=0 +y_0=0 +R=1737400 +units=m +no_defs",
            false,
        ),
        ("+proj=sinu +lon_0=0 +x_0=0 +y_0=0 +R=3396190 +units=m +no_defs", false),
        ("+proj=merc +lon_0=12 +k=1 +x_0=0 +y_0=0 +R=3396190 +units=m +no_defs", false),
        ("EPSG:32630", false),
    ] {
        output(
            Command::new("gdal_translate")
                .args(["-q", "-a_srs", proj])
                .arg(data("f32_tiled_deflate_p3.tif"))
                .arg(&theirs),
        );
        let reader = GridReader::open(&theirs).unwrap();
        let crs = reader.crs().unwrap().clone();
        let kept = matches!(crs.projection, Projection::GeoKeys(_));
        assert_eq!(kept, !is_parsed, "{proj}: {crs:?}");
        let file = reader.read(reader.spec().window()).unwrap();
        format::write_geotiff(&ours, &file).unwrap();
        assert_eq!(gdalinfo(&ours), gdalinfo(&theirs), "{proj}");
        let back = GridReader::open(&ours).unwrap();
        assert!(back.crs().unwrap().same_projection(&crs), "{proj}");
        let line = gdalinfo(&ours).into_iter().find(|line| line.contains("+proj=")).unwrap();
        if is_parsed && !proj.contains("+b=") {
            assert!(line.contains(proj), "{line}, not {proj}");
        }
    }
}

#[test]
fn gdal_reads_bytes_bigtiff_unit_and_description_of_a_local_plane() {
    let test = "gdal_reads_bytes_bigtiff_unit_and_description_of_a_local_plane";
    if !has("gdalinfo", test) || !has("gdal_translate", test) {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("classes.tif");
    let spec = GridSpec::new(70, 45, 0.094).unwrap().at(-23.5, 21.5);
    let cells: Vec<Option<f32>> =
        (0..113).map(|i| (i % 9 != 0).then_some((i * 2) as f32)).collect();
    let file = grid(spec, &cells);
    let options = GeoTiffOptions {
        tile_side: 32,
        big_tiff: true,
        unit: "m/s".to_owned(),
        description: "speed < 5 & more".to_owned(),
        ..GeoTiffOptions::new(Sample::U8)
    };
    format::write_geotiff_with(&path, &file, &options).unwrap();
    assert_eq!(
        gdalinfo(&path),
        [
            "Size is 45, 70",
            "Origin = (-23.500000000000000,21.500000000000000)",
            "Pixel Size = (0.094000000000000,-0.094000000000000)",
            "Description = speed < 5 & more",
            "NoData Value=255",
            "Unit Type: m/s",
        ]
    );
    let wanted: Vec<u32> = file
        .raster
        .iter()
        .map(|(cell, value)| if file.known[cell] { *value } else { 255.0 }.to_bits())
        .collect();
    assert_eq!(gdal_floats(&path, folder.path()), wanted);
}
