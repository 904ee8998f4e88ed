//! Writing: tiled GeoTIFF, deflate with a predictor, row of tiles by row of tiles.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use flate2::Compression;
use flate2::write::ZlibEncoder;
use rayon::prelude::*;
use wisdom_grid::{Cell, GridSpec};

use super::tag;
use crate::format::{GridFile, damaged, is_special};
use crate::{Crs, Layer, TerrainError};

/// What stands for "no value" among floats unless said otherwise: below the lowest place of any planet, and what USGS
/// products of Mars use.
const NODATA_F32: f64 = -32767.0;
/// What stands for "no value" among bytes unless said otherwise.
const NODATA_U8: f64 = 255.0;
/// The null pixel of ISIS (bit pattern 0xFF7FFFFB), which no reading can be.
const ISIS_NULL_BITS: u32 = 0xFF7F_FFFB;
/// Sides a tile may have: TIFF 6.0 wants multiples of 16; beyond, a row of tiles takes too much memory.
const TILE_SIDES: std::ops::RangeInclusive<usize> = 16..=4096;
/// Deflate's default: a higher level gains few per cent.
const DEFLATE_LEVEL: u32 = 6;

/// How a stored sample is coded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Sample {
    /// 32-bit floats, floating-point predictor (3; TIFF Technical Note 3, Adobe 2005).
    F32,
    /// Bytes, horizontal differencing (predictor 2; TIFF 6.0, section 14): classes and images, whole numbers 0 to 255.
    U8,
}

/// How a GeoTIFF is written.
#[derive(Debug, Clone, PartialEq)]
pub struct GeoTiffOptions {
    /// How samples are stored.
    pub sample: Sample,
    /// Side of a tile in cells: a multiple of 16, 16 to 4096.
    pub tile_side: usize,
    /// What stands for "no value". Without one, unknown cells are NaN among floats and refused among bytes.
    pub nodata: Option<f64>,
    /// BigTIFF even where a classic file would do. A file that may pass 4 GiB is one in any case.
    pub big_tiff: bool,
    /// Unit of the values, as GDAL's metadata has it; none if empty.
    pub unit: String,
    /// What the values are, as GDAL's metadata has it; none if empty.
    pub description: String,
}

impl GeoTiffOptions {
    /// Tiles of 256 x 256; nodata −32767 for floats, 255 for bytes.
    #[must_use]
    pub fn new(sample: Sample) -> Self {
        let nodata = match sample {
            Sample::F32 => NODATA_F32,
            Sample::U8 => NODATA_U8,
        };
        Self {
            sample,
            tile_side: 256,
            nodata: Some(nodata),
            big_tiff: false,
            unit: String::new(),
            description: String::new(),
        }
    }
}

/// Writes one band as a tiled GeoTIFF, any number of rows at a time: memory for one row of tiles is enough.
///
/// Little endian, deflate, pixels are areas, placed by pixel scale and tie point; geo keys if there is a [`Crs`] that
/// has any. The tiles of a row are compressed in parallel and written in order: the same bytes at any number of
/// threads. (Another build's deflate may choose other bytes for the same values.) Until [`finish`](Self::finish) the
/// output does not begin as a TIFF, so that half a file is not taken for a whole one.
pub struct GeoTiffWriter<W: Write + Seek> {
    name: String,
    out: W,
    spec: GridSpec,
    options: GeoTiffOptions,
    /// Nodata as it is stored.
    fill: Option<f32>,
    big: bool,
    tags: Vec<Tag>,
    /// Rows written so far, with those in `band`.
    rows: usize,
    /// Rows that do not make a row of tiles yet.
    band: Vec<f32>,
    /// The next free byte.
    end: u64,
    places: Vec<u64>,
    sizes: Vec<u64>,
}

impl<W: Write + Seek> GeoTiffWriter<W> {
    /// Starts a file at the first byte of `out`; `name` is for messages.
    ///
    /// # Errors
    /// [`TerrainError::File`] for options that cannot be; [`TerrainError::Io`] if the output refuses.
    pub fn new(
        name: &str,
        out: W,
        spec: GridSpec,
        crs: Option<&Crs>,
        options: &GeoTiffOptions,
    ) -> Result<Self, TerrainError> {
        let side = options.tile_side;
        if !TILE_SIDES.contains(&side) || !side.is_multiple_of(16) {
            return Err(damaged(
                name,
                format!("tiles of {side} x {side}; a multiple of 16 from 16 to 4096 is wanted"),
            ));
        }
        let fill = options.nodata.map(|nodata| stored_nodata(name, nodata, options.sample));
        let tiles = spec.rows().div_ceil(side) * spec.cols().div_ceil(side);
        let mut writer = Self {
            name: name.to_owned(),
            out,
            spec,
            options: options.clone(),
            fill: fill.transpose()?,
            big: options.big_tiff || may_pass_4_gib(spec, options),
            tags: Vec::new(),
            rows: 0,
            band: Vec::new(),
            end: 0,
            places: vec![0; tiles],
            sizes: vec![0; tiles],
        };
        writer.tags = writer.tags(&crs.and_then(Crs::to_geo_keys).unwrap_or_default());
        // The directory has its final length from the start; its bytes come last.
        let directory = writer.directory().len();
        writer.end = directory as u64;
        writer
            .out
            .seek(SeekFrom::Start(0))
            .and_then(|_| writer.out.write_all(&vec![0; directory]))
            .map_err(|source| writer.refused(source))?;
        Ok(writer)
    }

    /// Adds whole rows, from the north: values and whether they are known, as many of each.
    ///
    /// # Errors
    /// [`TerrainError::File`] if these are not whole rows, or more than the grid has; if a known value cannot be stored
    /// and read back as what it is (not finite, equal to nodata, a bit pattern reserved for missing pixels, or
    /// no whole number of 0 to 255 where bytes are written), naming its cell; [`TerrainError::Io`] if the output refuses.
    pub fn write_rows(&mut self, values: &[f32], known: &[bool]) -> Result<(), TerrainError> {
        let cols = self.spec.cols();
        let rows = values.len() / cols;
        if values.len() != known.len()
            || values.len() != rows * cols
            || self.rows + rows > self.spec.rows()
        {
            return Err(damaged(
                &self.name,
                format!(
                    "{} values, {} of them said to be known or not, after {} rows of {} x {}; whole rows are wanted",
                    values.len(),
                    known.len(),
                    self.rows,
                    self.spec.rows(),
                    cols
                ),
            ));
        }
        for (values, known) in values.chunks_exact(cols).zip(known.chunks_exact(cols)) {
            for (col, (&value, &known)) in values.iter().zip(known).enumerate() {
                let cell = Cell::new(self.rows, col);
                let stored = self.stored(cell, known.then_some(value))?;
                self.band.push(stored);
            }
            self.rows += 1;
            if self.rows.is_multiple_of(self.options.tile_side) || self.rows == self.spec.rows() {
                self.write_tiles()?;
            }
        }
        Ok(())
    }

    /// Writes the directory and gives the output back, flushed.
    ///
    /// # Errors
    /// [`TerrainError::File`] if rows are missing; [`TerrainError::Io`] if the output refuses.
    pub fn finish(mut self) -> Result<W, TerrainError> {
        if self.rows != self.spec.rows() {
            let found = format!("{} rows were written of {}", self.rows, self.spec.rows());
            return Err(damaged(&self.name, found));
        }
        let directory = self.directory();
        self.out
            .seek(SeekFrom::Start(0))
            .and_then(|_| self.out.write_all(&directory))
            .and_then(|()| self.out.flush())
            .map_err(|source| self.refused(source))?;
        Ok(self.out)
    }

    fn refused(&self, source: io::Error) -> TerrainError {
        TerrainError::Io { name: self.name.clone(), action: "write", source }
    }

    /// The sample for a cell's value.
    fn stored(&self, cell: Cell, value: Option<f32>) -> Result<f32, TerrainError> {
        let fail = |reason: &str, value: f32| {
            Err(damaged(&self.name, format!("the value {value} at {cell} {reason}")))
        };
        match (value, self.options.sample, self.fill) {
            (None, _, Some(fill)) => Ok(fill),
            (None, Sample::F32, None) => Ok(f32::NAN),
            (None, Sample::U8, None) => fail("is unknown; nodata is wanted for it", 0.0),
            (Some(value), Sample::F32, _) if !value.is_finite() => fail("is not finite", value),
            (Some(value), _, fill) if fill == Some(value) => {
                fail("is the file's nodata; another nodata is wanted", value)
            }
            (Some(value), Sample::F32, _) if is_special(value) => {
                fail("is reserved for missing pixels", value)
            }
            (Some(value), Sample::U8, _)
                if !(0.0..=255.0).contains(&value) || value != value.trunc() =>
            {
                fail("is no whole number of 0 to 255", value)
            }
            (Some(value), ..) => Ok(value),
        }
    }

    /// Compresses and writes the rows in hand as a row of tiles.
    fn write_tiles(&mut self) -> Result<(), TerrainError> {
        let side = self.options.tile_side;
        let across = self.spec.cols().div_ceil(side);
        let first = (self.rows - 1) / side * across;
        let (band, cols, sample) = (&self.band[..], self.spec.cols(), self.options.sample);
        let compressed: io::Result<Vec<Vec<u8>>> = (0..across)
            .into_par_iter()
            .map(|along| deflated(&tile(band, cols, along, side, sample)))
            .collect();
        for (along, bytes) in compressed.map_err(|e| self.refused(e))?.into_iter().enumerate() {
            self.out.write_all(&bytes).map_err(|source| self.refused(source))?;
            self.places[first + along] = self.end;
            self.sizes[first + along] = bytes.len() as u64;
            self.end += bytes.len() as u64;
        }
        self.band.clear();
        Ok(())
    }

    /// All tags but those of places and sizes, in ascending order.
    fn tags(&self, keys: &crate::GeoKeys) -> Vec<Tag> {
        let (spec, options) = (self.spec, &self.options);
        let (bits, format, predictor) = match options.sample {
            Sample::F32 => (32, 3, 3),
            Sample::U8 => (8, 1, 2),
        };
        let side = options.tile_side as u32;
        let scale = spec.spacing_m();
        let mut tags = vec![
            Tag::longs(tag::IMAGE_WIDTH, spec.cols() as u32),
            Tag::longs(tag::IMAGE_LENGTH, spec.rows() as u32),
            Tag::shorts(tag::BITS_PER_SAMPLE, &[bits]),
            Tag::shorts(tag::COMPRESSION, &[8]),
            Tag::shorts(tag::PHOTOMETRIC, &[1]),
            Tag::shorts(tag::SAMPLES_PER_PIXEL, &[1]),
            Tag::shorts(tag::PLANAR_CONFIGURATION, &[1]),
            Tag::shorts(tag::PREDICTOR, &[predictor]),
            Tag::longs(tag::TILE_WIDTH, side),
            Tag::longs(tag::TILE_LENGTH, side),
            Tag::shorts(tag::SAMPLE_FORMAT, &[format]),
            Tag::doubles(tag::PIXEL_SCALE, &[scale, scale, 0.0]),
            Tag::doubles(tag::TIE_POINT, &[0.0, 0.0, 0.0, spec.west_m(), spec.north_m(), 0.0]),
        ];
        if !keys.directory.is_empty() {
            tags.push(Tag::shorts(tag::GEO_KEYS, &keys.directory));
        }
        if !keys.doubles.is_empty() {
            tags.push(Tag::doubles(tag::GEO_DOUBLES, &keys.doubles));
        }
        if !keys.ascii.is_empty() {
            tags.push(Tag::text(tag::GEO_ASCII, &keys.ascii));
        }
        let metadata = metadata(options);
        if !metadata.is_empty() {
            tags.push(Tag::text(tag::GDAL_METADATA, &metadata));
        }
        if let Some(fill) = self.fill {
            tags.push(Tag::text(tag::GDAL_NODATA, &f64::from(fill).to_string()));
        }
        tags
    }

    /// The file's first bytes: its header, its directory, and the values that do not fit into the directory.
    fn directory(&self) -> Vec<u8> {
        let mut tags = self.tags.clone();
        tags.push(self.numbers(tag::TILE_OFFSETS, &self.places));
        tags.push(self.numbers(tag::TILE_BYTE_COUNTS, &self.sizes));
        tags.sort_by_key(|tag| tag.number);
        let (header, entry, inline) = if self.big { (16, 20, 8) } else { (8, 12, 4) };
        let count = if self.big { 8 } else { 2 };
        let mut values_at = header + count + entry * tags.len() + inline;
        values_at = values_at.next_multiple_of(8);
        let mut bytes = if self.big {
            [&b"II\x2b\0\x08\0\0\0"[..], &16_u64.to_le_bytes()].concat()
        } else {
            b"II\x2a\0\x08\0\0\0".to_vec()
        };
        bytes.extend(&(tags.len() as u64).to_le_bytes()[..count]);
        let mut values = Vec::new();
        for tag in &tags {
            bytes.extend(tag.number.to_le_bytes());
            bytes.extend(tag.kind.to_le_bytes());
            bytes.extend(&tag.count.to_le_bytes()[..inline]);
            if tag.bytes.len() <= inline {
                bytes.extend(&tag.bytes);
                bytes.resize(bytes.len() + inline - tag.bytes.len(), 0);
            } else {
                bytes.extend(&((values_at + values.len()) as u64).to_le_bytes()[..inline]);
                values.extend(&tag.bytes);
                values.resize(values.len().next_multiple_of(8), 0);
            }
        }
        // The next directory's place: there is none.
        bytes.resize(values_at, 0);
        bytes.extend(values);
        bytes
    }

    fn numbers(&self, number: u16, values: &[u64]) -> Tag {
        let (kind, size) = if self.big { (16, 8) } else { (4, 4) };
        let bytes = values.iter().flat_map(|value| value.to_le_bytes().into_iter().take(size));
        Tag { number, kind, count: values.len() as u64, bytes: bytes.collect() }
    }
}

/// A tag and its values.
#[derive(Clone)]
struct Tag {
    number: u16,
    kind: u16,
    count: u64,
    bytes: Vec<u8>,
}

impl Tag {
    fn shorts(number: u16, values: &[u16]) -> Self {
        let bytes = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        Self { number, kind: 3, count: values.len() as u64, bytes }
    }

    fn longs(number: u16, value: u32) -> Self {
        Self { number, kind: 4, count: 1, bytes: value.to_le_bytes().to_vec() }
    }

    fn doubles(number: u16, values: &[f64]) -> Self {
        let bytes = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        Self { number, kind: 12, count: values.len() as u64, bytes }
    }

    fn text(number: u16, text: &str) -> Self {
        let bytes = [text.as_bytes(), b"\0"].concat();
        Self { number, kind: 2, count: bytes.len() as u64, bytes }
    }
}

/// The samples of one tile of a band of rows, after the predictor. Beyond the image's edge the last row and column go
/// on: what compresses best.
fn tile(band: &[f32], cols: usize, along: usize, side: usize, sample: Sample) -> Vec<u8> {
    let rows = band.len() / cols;
    let (west, east) = (along * side, ((along + 1) * side).min(cols));
    let mut tile = Vec::with_capacity(side * side * sample_bytes(sample));
    for row in (0..side).map(|row| row.min(rows - 1)) {
        let samples = &band[row * cols + west..row * cols + east];
        let last = samples[samples.len() - 1];
        let samples = samples.iter().copied().chain(std::iter::repeat(last)).take(side);
        let start = tile.len();
        match sample {
            Sample::U8 => tile.extend(samples.map(|sample| sample as u8)),
            Sample::F32 => {
                // Most significant bytes of the whole row first, then the next.
                tile.resize(start + 4 * side, 0);
                for (col, sample) in samples.enumerate() {
                    for (plane, byte) in sample.to_be_bytes().into_iter().enumerate() {
                        tile[start + plane * side + col] = byte;
                    }
                }
            }
        }
        difference(&mut tile[start..]);
    }
    tile
}

fn sample_bytes(sample: Sample) -> usize {
    match sample {
        Sample::F32 => 4,
        Sample::U8 => 1,
    }
}

/// Nodata as a stored sample, which it must be without loss.
fn stored_nodata(name: &str, nodata: f64, sample: Sample) -> Result<f32, TerrainError> {
    let stored = nodata as f32;
    let fits = match sample {
        Sample::F32 => nodata.is_nan() || (stored.is_finite() && f64::from(stored) == nodata),
        Sample::U8 => (0.0..=255.0).contains(&nodata) && nodata == nodata.trunc(),
    };
    if !fits {
        return Err(damaged(name, format!("nodata {nodata} is no value of {sample:?} samples")));
    }
    Ok(stored)
}

/// Whether the tiles could take more than classic TIFF can address, compressed as badly as can be.
fn may_pass_4_gib(spec: GridSpec, options: &GeoTiffOptions) -> bool {
    /// Room for the directory: its text and keys are far smaller.
    const DIRECTORY: u64 = 1 << 20;
    /// A tile's place and size in the directory, and its frame.
    const TILE: u64 = 128;
    let side = options.tile_side;
    let tiles = (spec.rows().div_ceil(side) * spec.cols().div_ceil(side)) as u64;
    let tile = (side * side * sample_bytes(options.sample)) as u64;
    // Stored blocks add 5 bytes each 16 KiB at worst: less than a 64th.
    let text = (options.unit.len() + options.description.len()) as u64 * 8;
    DIRECTORY + text + tiles * (tile + tile / 64 + TILE) > u64::from(u32::MAX)
}

/// Each byte becomes its difference from the one before.
fn difference(row: &mut [u8]) {
    for place in (1..row.len()).rev() {
        row[place] = row[place].wrapping_sub(row[place - 1]);
    }
}

fn deflated(bytes: &[u8]) -> io::Result<Vec<u8>> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::new(DEFLATE_LEVEL));
    encoder.write_all(bytes)?;
    encoder.finish()
}

/// GDAL's XML of unit and description; empty if there is neither.
fn metadata(options: &GeoTiffOptions) -> String {
    let item = |name: &str, role: &str, text: &str| {
        if text.is_empty() {
            return String::new();
        }
        // GDAL escapes text before it makes XML of it, which escapes it again.
        let text = escaped(&escaped(&text.replace(|c: char| c.is_control(), " ")));
        format!("  <Item name=\"{name}\" sample=\"0\" role=\"{role}\">{text}</Item>\n")
    };
    let items = item("DESCRIPTION", "description", &options.description)
        + &item("UNITTYPE", "unittype", &options.unit);
    if items.is_empty() { items } else { format!("<GDALMetadata>\n{items}</GDALMetadata>\n") }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// Writes a grid as a GeoTIFF of floats, with nodata −32767, or the null pixel of ISIS if −32767 is a value of it.
///
/// The file is written beside its place and then renamed: a failed write leaves what was there.
///
/// # Errors
/// [`TerrainError::Io`] if the system refuses; [`TerrainError::File`] as [`GeoTiffWriter::write_rows`].
///
/// ```
/// # use wisdom_terrain::format;
/// let asc = b"ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\nNODATA_value -9\n3.5 -9\n";
/// let grid = format::read("dem.asc", asc)?;
/// # let folder = tempfile::tempdir().unwrap();
/// let path = folder.path().join("dem.tif");
/// format::write_geotiff(&path, &grid)?;
/// let back = format::GridReader::open(&path)?.read(grid.raster.spec().window())?;
/// assert_eq!((back.raster, back.known), (grid.raster, grid.known));
/// # Ok::<(), wisdom_terrain::TerrainError>(())
/// ```
pub fn write_geotiff(path: &Path, grid: &GridFile) -> Result<(), TerrainError> {
    write_geotiff_with(path, grid, &float_options(grid.raster.values(), grid.known.values()))
}

/// As [`write_geotiff`], with options.
///
/// # Errors
/// As [`write_geotiff`], and [`GeoTiffWriter::new`] for the options.
pub fn write_geotiff_with(
    path: &Path,
    grid: &GridFile,
    options: &GeoTiffOptions,
) -> Result<(), TerrainError> {
    write_file(
        path,
        grid.raster.spec(),
        grid.crs.as_ref(),
        options,
        (grid.raster.values(), grid.known.values()),
    )
}

/// Writes a layer's readings as a GeoTIFF, as [`write_geotiff`] does: nodata where u is 1. The other cells' u is not in
/// the file.
///
/// # Errors
/// As [`write_geotiff`].
pub fn write_layer(path: &Path, layer: &Layer, crs: Option<&Crs>) -> Result<(), TerrainError> {
    let known: Vec<bool> = layer.uncertainty().values().iter().map(|&u| u < 1.0).collect();
    let values = layer.values().values();
    write_file(path, layer.spec(), crs, &float_options(values, &known), (values, &known))
}

fn float_options(values: &[f32], known: &[bool]) -> GeoTiffOptions {
    let taken = values.iter().zip(known).any(|(&v, &known)| known && f64::from(v) == NODATA_F32);
    let default = GeoTiffOptions::new(Sample::F32);
    let null = Some(f64::from(f32::from_bits(ISIS_NULL_BITS)));
    GeoTiffOptions { nodata: if taken { null } else { default.nodata }, ..default }
}

fn write_file(
    path: &Path,
    spec: GridSpec,
    crs: Option<&Crs>,
    options: &GeoTiffOptions,
    (values, known): (&[f32], &[bool]),
) -> Result<(), TerrainError> {
    write_geotiff_by(path, spec, crs, options, |writer| writer.write_rows(values, known))
}

/// Writes a GeoTIFF that `rows` gives piece by piece, for grids that do not lie in memory. The file is written beside
/// its place and renamed in the end: a failure leaves what was there.
///
/// # Errors
/// What `rows` returns; [`TerrainError::Io`] if the system refuses; as [`GeoTiffWriter::new`] and
/// [`GeoTiffWriter::finish`].
pub fn write_geotiff_by<E: From<TerrainError>>(
    path: &Path,
    spec: GridSpec,
    crs: Option<&Crs>,
    options: &GeoTiffOptions,
    rows: impl FnOnce(&mut GeoTiffWriter<BufWriter<File>>) -> Result<(), E>,
) -> Result<(), E> {
    let name = path.display().to_string();
    let refused = |action| {
        let name = name.clone();
        move |source| TerrainError::Io { name, action, source }
    };
    let (part, file) = Part::beside(path).map_err(refused("create"))?;
    let mut writer = GeoTiffWriter::new(&name, BufWriter::new(file), spec, crs, options)?;
    rows(&mut writer)?;
    let file = writer.finish()?.into_inner().map_err(|e| refused("write")(e.into_error()))?;
    file.sync_all().map_err(refused("write"))?;
    drop(file);
    Ok(part.rename(path).map_err(refused("rename"))?)
}

/// A file in the making, removed unless it is renamed.
struct Part {
    path: PathBuf,
}

impl Part {
    /// `NAME.part` beside `NAME`. One that a killed program left is taken over, one that is being written is not.
    fn beside(path: &Path) -> io::Result<(Self, File)> {
        let mut name = path.file_name().ok_or(io::ErrorKind::InvalidInput)?.to_owned();
        name.push(".part");
        let part = path.with_file_name(name);
        let file = OpenOptions::new().write(true).create(true).truncate(false).open(&part)?;
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => {
                let reason = format!("{} is being written by another program", part.display());
                return Err(io::Error::new(io::ErrorKind::WouldBlock, reason));
            }
            // A file system without locks: nothing to be known, nothing in the way.
            Ok(()) | Err(TryLockError::Error(_)) => {}
        }
        file.set_len(0)?;
        Ok((Self { path: part }, file))
    }

    fn rename(self, path: &Path) -> io::Result<()> {
        fs::rename(&self.path, path)
    }
}

impl Drop for Part {
    fn drop(&mut self) {
        // After a rename there is nothing left to remove, and a failed write has its own error to tell.
        drop(fs::remove_file(&self.path));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_may_pass_4_gib_is_a_bigtiff() {
        let float = GeoTiffOptions::new(Sample::F32);
        let spec = |side| GridSpec::new(side, side, 1.0).unwrap();
        assert!(!may_pass_4_gib(spec(10_000), &float));
        assert!(may_pass_4_gib(spec(32_768), &float));
        assert!(!may_pass_4_gib(spec(32_768), &GeoTiffOptions::new(Sample::U8)));
    }

    #[test]
    fn differences_are_taken_from_the_byte_before() {
        let mut row = [7, 9, 8, 0, 255];
        difference(&mut row);
        assert_eq!(row, [7, 2, 255, 248, 255]);
    }

    #[test]
    fn metadata_escapes_twice_what_xml_reserves() {
        let options = GeoTiffOptions {
            unit: "m".to_owned(),
            description: "a<b & c>d".to_owned(),
            ..GeoTiffOptions::new(Sample::F32)
        };
        let text = metadata(&options);
        assert!(
            text.contains(">a&amp;lt;b &amp;amp; c&amp;gt;d</Item>") && text.contains(">m</Item>"),
            "{text}"
        );
        assert_eq!(metadata(&GeoTiffOptions::new(Sample::U8)), "");
    }
}
