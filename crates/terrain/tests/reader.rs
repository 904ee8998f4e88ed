//! Terrain files read window by window: the same cells as the whole file, in little memory, from any thread.

use std::path::{Path, PathBuf};

use proptest::prelude::*;
use wisdom_grid::{Cell, Window};
use wisdom_terrain::format::{self, GeoTiffOptions, GridReader, Sample};
use wisdom_terrain::{GridFile, TerrainError};

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)
}

fn tiffs_of(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry").path()).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "tif"));
    paths.sort();
    paths
}

/// The flavours that ship, and the further ones where `WISDOM_DATA` names their folder.
#[expect(clippy::print_stdout, reason = "a test that was skipped in part says so in the test log")]
fn flavours(test: &str) -> Vec<PathBuf> {
    let mut paths = tiffs_of(&data(""));
    assert_eq!(paths.len(), 11);
    match std::env::var_os("WISDOM_DATA").filter(|folder| !folder.is_empty()) {
        Some(folder) => paths.extend(tiffs_of(&Path::new(&folder).join("data/terrain/formats"))),
        None => println!("skipped: {test}: the further flavours: WISDOM_DATA is not set"),
    }
    paths
}

fn whole(path: &Path) -> GridFile {
    format::read_file(path).expect("a sound file")
}

fn window(row: usize, col: usize, rows: usize, cols: usize) -> Window {
    Window { row, col, rows, cols }
}

fn assert_is_crop(found: &GridFile, all: &GridFile, window: Window) {
    assert_eq!(found.raster, all.raster.crop(window).expect("a window inside"), "{window}");
    assert_eq!(found.known, all.known.crop(window).expect("a window inside"), "{window}");
    assert_eq!((&found.crs, &found.about), (&all.crs, &all.about), "{window}");
}

#[test]
fn a_window_of_every_flavour_is_a_crop_of_the_whole() {
    for path in flavours("a_window_of_every_flavour_is_a_crop_of_the_whole") {
        let (reader, all) = (GridReader::open(&path).unwrap(), whole(&path));
        let spec = reader.spec();
        assert_eq!((spec, reader.bands()), (all.raster.spec(), 1));
        assert_eq!((reader.crs(), reader.about()), (all.crs.as_ref(), &all.about));
        let mut windows = vec![spec.window(), window(15, 15, 2, 2), window(16, 16, 16, 16)];
        for cell in [Cell::new(0, 0), Cell::new(22, 33), Cell::new(47, 63), Cell::new(0, 63)] {
            windows.extend([0, 1, 7, 20].map(|radius| spec.around(cell, radius)));
        }
        for window in windows {
            assert_is_crop(&reader.read(window).unwrap(), &all, window);
        }
    }
}

#[test]
fn the_header_says_how_the_file_holds_its_samples() {
    let about = |name: &str| GridReader::open(&data(name)).unwrap().about().clone();
    let storage = |name: &str| about(name).storage;
    assert_eq!(
        storage("f32_tiled_deflate_p3_bigtiff.tif"),
        "float32, tiles of 16 x 16, deflate, predictor 3, little endian, BigTIFF"
    );
    assert_eq!(
        storage("f32_tiled_deflate_p1_bigendian.tif"),
        "float32, tiles of 16 x 16, deflate, big endian"
    );
    assert_eq!(
        storage("i16_tiled_deflate_p2.tif"),
        "int16, tiles of 16 x 16, deflate, predictor 2, little endian"
    );
    assert!(storage("f32_tiled_zstd_p3.tif").contains("ZSTD"));
    let whole = about("i16_tiled_deflate_p2.tif");
    assert_eq!(
        (whole.nodata.as_deref(), whole.scale, whole.offset),
        (Some("-32768"), 0.01, -4450.0)
    );
    assert_eq!(about("f32_tiled_deflate_p3_nan.tif").nodata.as_deref(), Some("nan"));
}

/// 64 x 48 cells in tiles of 16: a window decodes the tiles that it touches, and those in the cache not again.
#[test]
fn only_the_tiles_that_a_window_touches_are_decoded() {
    let reader = GridReader::open(&data("f32_tiled_deflate_p3.tif")).unwrap();
    assert_eq!(reader.decoded_chunks(), 0);
    reader.read(window(3, 3, 5, 5)).unwrap();
    assert_eq!(reader.decoded_chunks(), 1);
    reader.read(window(15, 15, 2, 2)).unwrap();
    assert_eq!(reader.decoded_chunks(), 4);
    reader.read(window(0, 0, 32, 32)).unwrap();
    assert_eq!(reader.decoded_chunks(), 4);
    reader.read(reader.spec().window()).unwrap();
    assert_eq!(reader.decoded_chunks(), 12);
}

#[test]
fn the_cache_keeps_its_bound_and_forgets_the_least_recently_used() {
    // A tile has 1024 bytes and a place: this holds two, not three.
    let path = data("f32_tiled_deflate_p3.tif");
    let reader = GridReader::open_with_cache(&path, 2500).unwrap();
    let all = whole(&path);
    let tile = |across: usize| window(0, across * 16, 16, 16);
    for (across, decoded) in [(0, 1), (1, 2), (0, 2), (2, 3), (0, 3), (1, 4), (2, 5)] {
        assert_is_crop(&reader.read(tile(across)).unwrap(), &all, tile(across));
        assert_eq!(reader.decoded_chunks(), decoded, "tile {across}");
        assert!(reader.cached_bytes() <= 2500 && reader.cached_bytes() > 1024);
    }
    let none = GridReader::open_with_cache(&path, 0).unwrap();
    assert_is_crop(
        &none.read(all.raster.spec().window()).unwrap(),
        &all,
        all.raster.spec().window(),
    );
    assert_eq!((none.cached_bytes(), none.decoded_chunks()), (0, 12));
}

#[test]
fn many_threads_share_a_reader() {
    let path = data("f32_tiled_deflate_p3.tif");
    let (reader, all) = (GridReader::open_with_cache(&path, 3000).unwrap(), whole(&path));
    std::thread::scope(|scope| {
        for thread in 0..8 {
            let (reader, all) = (&reader, &all);
            scope.spawn(move || {
                for step in 0..40 {
                    let window = window((thread * 5 + step) % 40, (step * 7 + thread) % 50, 8, 14);
                    assert_is_crop(&reader.read(window).unwrap(), all, window);
                }
            });
        }
    });
}

#[test]
fn another_format_is_read_whole_and_cropped() {
    let reader = GridReader::open(&data("grid.asc")).unwrap();
    let bytes = std::fs::read(data("grid.asc")).unwrap();
    let all = whole(&data("grid.asc"));
    let window = window(18, 28, 9, 11);
    assert_is_crop(&reader.read(window).unwrap(), &all, window);
    assert_eq!(reader.length(), bytes.len() as u64);
    assert_eq!(reader.digest().unwrap(), *blake3::hash(&bytes).as_bytes());
    assert_eq!((reader.cached_bytes(), reader.decoded_chunks()), (0, 0));
}

#[test]
fn the_digest_is_that_of_the_bytes_and_leaves_the_reader_usable() {
    let path = data("f32_tiled_zstd_p3.tif");
    let (reader, bytes, all) =
        (GridReader::open(&path).unwrap(), std::fs::read(&path).unwrap(), whole(&path));
    for row in [0, 20, 40] {
        let window = window(row, 0, 8, 64);
        assert_is_crop(&reader.read(window).unwrap(), &all, window);
        assert_eq!(reader.digest().unwrap(), *blake3::hash(&bytes).as_bytes());
    }
    assert_eq!(reader.length(), bytes.len() as u64);
}

#[test]
fn a_window_beyond_the_edge_and_a_missing_file_are_errors() {
    let reader = GridReader::open(&data("f32_tiled_deflate_p3.tif")).unwrap();
    for window in [
        window(0, 0, 49, 1),
        window(0, 60, 1, 5),
        window(0, 0, 0, 3),
        window(usize::MAX, 0, 2, 1),
        window(0, 3, 1, usize::MAX),
    ] {
        assert!(matches!(reader.read(window).unwrap_err(), TerrainError::Grid(_)), "{window}");
    }
    let error = GridReader::open(&data("none.tif")).err().unwrap();
    assert!(matches!(&error, TerrainError::Io { action: "open", .. }), "{error}");
    assert!(error.to_string().contains("none.tif: cannot open it: "), "{error}");
}

#[test]
fn a_colour_image_gives_its_bands_by_window() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../missions/marias-pass/terrain/ortho_rgb.tif");
    let reader = GridReader::open(&path).unwrap();
    let all = format::read_bands("ortho_rgb.tif", &std::fs::read(&path).unwrap()).unwrap();
    let window = window(250, 250, 12, 12);
    assert_eq!(reader.bands(), 3);
    for (found, all) in reader.read_bands(window).unwrap().iter().zip(&all) {
        assert_is_crop(found, all, window);
    }
    assert!(matches!(reader.read(window), Err(TerrainError::Bands { bands: 3, .. })));
}

/// A little-endian TIFF of one directory at byte 8; a value is a number, or the place of bytes after the directory.
struct Hostile {
    big: bool,
    tags: Vec<(u16, u16, u64, u64)>,
    tail: Vec<u8>,
}

const SHORT: u16 = 3;
const LONG: u16 = 4;
const DOUBLE: u16 = 12;

impl Hostile {
    /// A sound file of `side` x `side` cells of 1 m in tiles of `tile` cells, each tile left out as sparse files do.
    fn sparse(side: u64, tile: u64) -> Self {
        let tiles = side.div_ceil(tile) * side.div_ceil(tile);
        // 17 tags of 12 bytes, their number, the place of the next directory; then doubles; then zeros for the tiles.
        let doubles_at = 8 + 2 + 17 * 12 + 4;
        let numbers = [1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 500.0, 900.0, 0.0_f64];
        let mut tail: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
        let tiles_at = doubles_at + tail.len() as u64;
        let inline = tiles == 1;
        tail.resize(tail.len() + if inline { 0 } else { tiles as usize * 4 }, 0);
        let place = if inline { 0 } else { tiles_at };
        let tags = vec![
            (256, LONG, 1, side),
            (257, LONG, 1, side),
            (258, SHORT, 1, 8),
            (259, SHORT, 1, 8),
            (262, SHORT, 1, 1),
            (277, SHORT, 1, 1),
            (284, SHORT, 1, 1),
            (317, SHORT, 1, 1),
            (322, LONG, 1, tile),
            (323, LONG, 1, tile),
            (324, LONG, tiles, place),
            (325, LONG, tiles, place),
            (339, SHORT, 1, 1),
            (33550, DOUBLE, 3, doubles_at),
            (33922, DOUBLE, 6, doubles_at + 24),
            // "7" and a NUL.
            (42113, 2, 2, 0x37),
            (65000, SHORT, 1, 0),
        ];
        Self { big: false, tags, tail }
    }

    fn with(mut self, tag: u16, count: u64, value: u64) -> Self {
        for entry in self.tags.iter_mut().filter(|entry| entry.0 == tag) {
            (entry.2, entry.3) = (count, value);
        }
        self
    }

    fn bytes(&self) -> Vec<u8> {
        let mut bytes = if self.big {
            [&b"II\x2b\0\x08\0\0\0"[..], &16_u64.to_le_bytes()].concat()
        } else {
            b"II\x2a\0\x08\0\0\0".to_vec()
        };
        let inline = if self.big { 8 } else { 4 };
        bytes.extend(&(self.tags.len() as u64).to_le_bytes()[..if self.big { 8 } else { 2 }]);
        for &(tag, kind, count, value) in &self.tags {
            bytes.extend(tag.to_le_bytes());
            bytes.extend(kind.to_le_bytes());
            bytes.extend(&count.to_le_bytes()[..inline]);
            bytes.extend(&value.to_le_bytes()[..inline]);
        }
        bytes.resize(bytes.len() + inline, 0);
        bytes.extend(&self.tail);
        bytes
    }
}

fn open_bytes(bytes: &[u8]) -> Result<GridReader, TerrainError> {
    let folder = tempfile::tempdir().expect("a folder for a moment");
    let path = folder.path().join("x.tif");
    std::fs::write(&path, bytes).expect("a file for a moment");
    GridReader::open(&path)
}

#[test]
fn a_file_larger_than_one_reading_is_open_to_windows() {
    let reader = open_bytes(&Hostile::sparse(65_535, 4096).bytes()).unwrap();
    let spec = reader.spec();
    assert_eq!(
        (spec.rows(), spec.cols(), spec.west_m(), spec.north_m()),
        (65_535, 65_535, 500.0, 900.0)
    );
    let corner = reader.read(window(65_500, 65_500, 35, 35)).unwrap();
    // Tiles left out are nodata, which this file has.
    assert!(corner.known.values().iter().all(|known| !known));
    let error = reader.read(spec.window()).unwrap_err();
    assert!(matches!(error, TerrainError::TooLarge { rows: 65_535, .. }), "{error}");
}

#[test]
fn headers_that_promise_more_than_the_file_holds_are_refused() {
    let refusal = |file: &Hostile| {
        let (opened, bytes) = (open_bytes(&file.bytes()).err(), file.bytes());
        let read = format::read_bands("x.tif", &bytes).expect_err("what the reader refuses");
        (opened.expect("a refusal").to_string(), read.to_string())
    };
    let sound = || Hostile::sparse(64, 16);
    assert!(open_bytes(&sound().bytes()).is_ok());
    let most = u64::from(u32::MAX);
    for (file, words) in [
        (sound().with(322, 1, most).with(323, 1, most), "samples are read"),
        (sound().with(322, 1, most), "samples are read"),
        (sound().with(322, 1, 0), "samples are read"),
        (sound().with(277, 1, 64).with(322, 1, 4096).with(323, 1, 4096), "samples are read"),
        (sound().with(277, 1, 65), "65 bands; at most 64"),
        (sound().with(324, most, 300), "beyond the end of the file"),
        (sound().with(325, 16, most), "beyond the end of the file"),
        (sound().with(325, 3, 200), "sizes for 16 strips or tiles"),
        (sound().with(256, 1, most), "4294967295"),
        (sound().with(256, 1, 0), "0 cells"),
        (sound().with(258, 1, 1), "have 1 bits"),
        (sound().with(259, 1, 34_712), "compression is number 34712"),
        (sound().with(262, 1, 0), "photometric interpretation is 0"),
        (sound().with(262, 1, 6), "photometric interpretation is 6"),
        (sound().with(284, 1, 2).with(277, 1, 2), "2 bands lie in separate planes"),
        (sound().with(33_550, most, 238), "beyond the end of the file"),
    ] {
        let (opened, read) = refusal(&file);
        assert!(opened.contains(words) || read.contains(words), "{opened}; {read}; {words}");
    }
    // A fourth sample that is no colour, under predictor 2: the decoder would give other values.
    let mut extra = sound().with(262, 1, 2).with(277, 1, 4).with(317, 1, 2);
    extra.tags[16] = (338, SHORT, 1, 0);
    assert!(refusal(&extra).0.contains("3 of them colours"), "{}", refusal(&extra).0);
    // One tile said to have bytes that the file has not.
    let mut file = Hostile::sparse(16, 16);
    file = file.with(325, 1, 1_000_000);
    assert!(refusal(&file).0.contains("beyond the end of the file"));
    // As many tags as eight bytes can count.
    let mut endless = Hostile { big: true, tags: Vec::new(), tail: vec![0; 64] }.bytes();
    endless[16..24].copy_from_slice(&u64::MAX.to_le_bytes());
    assert!(open_bytes(&endless).err().unwrap().to_string().contains("at most 4096"));
    endless[8..16].copy_from_slice(&u64::MAX.to_le_bytes());
    assert!(open_bytes(&endless).err().unwrap().to_string().contains("it ends at byte"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// No damage makes a reader panic, and what it still reads is finite.
    #[test]
    fn damaged_files_never_panic(
        which in 0..7_usize,
        cut in prop::option::of(0.0..1.0_f64),
        flips in prop::collection::vec((0.0..1.0_f64, 0..8_u8), 1..6),
        in_header in any::<bool>(),
    ) {
        let mut bytes = std::fs::read(&tiffs_of(&data(""))[which]).unwrap();
        let span = if in_header { 600 } else { bytes.len() };
        for (place, bit) in flips {
            bytes[(place * span as f64) as usize] ^= 1 << bit;
        }
        if let Some(cut) = cut {
            bytes.truncate((cut * bytes.len() as f64) as usize);
        }
        if let Ok(reader) = open_bytes(&bytes) {
            let spec = reader.spec();
            for window in [spec.window(), spec.around(Cell::new(20, 20).min(spec.cell(spec.len() - 1)), 9)] {
                for file in reader.read_bands(window).into_iter().flatten() {
                    prop_assert!(file.into_layer().is_ok());
                }
            }
        }
    }

    /// Any window of any size of tile and grid.
    #[test]
    fn any_window_is_a_crop(
        rows in 1..90_usize,
        cols in 1..90_usize,
        tile in 1..4_usize,
        place in (0.0..1.0_f64, 0.0..1.0_f64, 0.0..1.0_f64, 0.0..1.0_f64),
    ) {
        let spec = wisdom_grid::GridSpec::new(rows, cols, 2.0).unwrap();
        let raster = wisdom_grid::Raster::from_fn(spec, |cell| (cell.row * 100 + cell.col) as f32);
        let known = wisdom_grid::Raster::from_fn(spec, |cell| !(cell.row + cell.col).is_multiple_of(7));
        let values = wisdom_grid::Raster::from_fn(spec, |cell| if known[cell] { raster[cell] } else { 0.0 });
        let mut options = GeoTiffOptions::new(Sample::F32);
        options.tile_side = tile * 16;
        let all = GridFile { raster: values, known, crs: None, about: format::About::default() };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.tif");
        format::write_geotiff_with(&path, &all, &options).unwrap();
        let (row, col) = ((place.0 * rows as f64) as usize, (place.1 * cols as f64) as usize);
        let part = window(
            row,
            col,
            1 + (place.2 * (rows - row) as f64) as usize,
            1 + (place.3 * (cols - col) as f64) as usize,
        );
        let part = part.intersection(spec.window()).unwrap();
        let found = GridReader::open(&path).unwrap().read(part).unwrap();
        prop_assert_eq!(&found.raster, &all.raster.crop(part).unwrap());
        prop_assert_eq!(&found.known, &all.known.crop(part).unwrap());
    }
}
