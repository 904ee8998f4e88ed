//! Reading: the facts of the header, and the decoding of one strip or tile at a time.

use std::io::{Read, Seek};

use tiff::decoder::{Decoder, DecodingResult, Limits};
use wisdom_grid::{GridSpec, Raster, Window};

use super::header::Header;
use super::tag;
use crate::crs::{
    GEOGRAPHIC, LINEAR_UNIT, LINEAR_UNIT_SIZE, METRE, MODEL_TYPE, PIXEL_IS_POINT, RASTER_TYPE,
    USER_DEFINED,
};
use crate::format::{About, GridFile, MAX_CELLS, damaged, is_special};
use crate::{Crs, GeoKeys, TerrainError};

/// How far two spacings or a rotation term may be from square, relative: rounding in writers' decimals.
const SQUARE_TOLERANCE: f64 = 1e-6;

/// The most samples of one strip or tile: as many as a file's cells, 2²⁶.
const MAX_CHUNK_SAMPLES: u64 = MAX_CELLS as u64;

/// The most samples (cells times bands) of one reading: four full grids, as a colour image with its mask has them.
const MAX_SAMPLES: usize = 4 * MAX_CELLS;

/// The most bands of a file: images of the Earth have a dozen, hostile files 65 535.
const MAX_BANDS: u64 = 64;
/// The longest text that may stand for "no data".
const MAX_NODATA_BYTES: usize = 64;
/// The longest metadata, which are searched once a band.
const MAX_METADATA_BYTES: usize = 1 << 20;

/// What the header of a GeoTIFF says, checked.
pub(crate) struct Facts {
    pub(crate) name: String,
    pub(crate) spec: GridSpec,
    pub(crate) crs: Option<Crs>,
    /// One a band.
    pub(crate) about: Vec<About>,
    nodata: Option<f64>,
    /// Whether samples are floats.
    is_float: bool,
    chunks: Chunks,
}

/// How the image is cut into strips (as wide as the image) or tiles, row by row.
#[derive(Debug, Clone, Copy)]
struct Chunks {
    rows: usize,
    cols: usize,
    across: usize,
}

/// One decoded strip or tile, cut at the image's edge.
#[derive(Debug)]
pub(crate) enum Chunk {
    /// Its samples, band by band within each cell.
    Samples(DecodingResult),
    /// Left out by a writer of sparse files: nodata everywhere, or 0 where the file has no nodata.
    Left,
}

impl Chunk {
    /// Bytes that it takes in memory.
    pub(crate) fn bytes(&self) -> usize {
        match self {
            Self::Left => 0,
            Self::Samples(samples) => match samples {
                DecodingResult::U8(v) => v.len(),
                DecodingResult::I8(v) => v.len(),
                DecodingResult::U16(v) => size_of_val(&v[..]),
                DecodingResult::I16(v) => size_of_val(&v[..]),
                DecodingResult::F16(v) => size_of_val(&v[..]),
                DecodingResult::U32(v) => size_of_val(&v[..]),
                DecodingResult::I32(v) => size_of_val(&v[..]),
                DecodingResult::F32(v) => size_of_val(&v[..]),
                DecodingResult::U64(v) => size_of_val(&v[..]),
                DecodingResult::I64(v) => size_of_val(&v[..]),
                DecodingResult::F64(v) => size_of_val(&v[..]),
            },
        }
    }
}

/// A GeoTIFF open for decoding.
pub(crate) struct Image<R: Read + Seek> {
    decoder: Decoder<R>,
    /// Bytes of each strip or tile in the file; 0 for one left out.
    byte_counts: Vec<u64>,
}

impl<R: Read + Seek> Image<R> {
    /// Opens a file of `length` bytes. `check_size` may refuse its rows and columns before anything else is asked.
    pub(crate) fn open(
        name: &str,
        mut from: R,
        length: u64,
        check_size: impl FnOnce(usize, usize) -> Result<(), TerrainError>,
    ) -> Result<(Facts, Self), TerrainError> {
        let header = Header::read(name, &mut from, length)?;
        let side = |value: Option<u64>| value.and_then(|v| usize::try_from(v).ok());
        let (Some(cols), Some(rows)) = (
            side(header.whole_number(&mut from, tag::IMAGE_WIDTH)?),
            side(header.whole_number(&mut from, tag::IMAGE_LENGTH)?),
        ) else {
            return Err(damaged(name, "it does not say its width and length".to_owned()));
        };
        check_size(rows, cols)?;
        let (spec, crs) = place(name, &header, &mut from, rows, cols)?;
        let samples = header.whole_number(&mut from, tag::SAMPLES_PER_PIXEL)?.unwrap_or(1);
        if samples > MAX_BANDS {
            return Err(damaged(
                name,
                format!("it has {samples} bands; at most {MAX_BANDS} are read"),
            ));
        }
        check_layout(name, &header, &mut from, samples)?;
        let (chunks, byte_counts) = chunks(name, &header, &mut from, spec, samples, length)?;
        let nodata_text = header.text(&mut from, tag::GDAL_NODATA)?.trim().to_owned();
        if nodata_text.len() > MAX_NODATA_BYTES {
            let found = nodata_text.len();
            let reason = format!("its nodata text has {found} bytes; a number is wanted");
            return Err(damaged(name, reason));
        }
        let metadata = header.text(&mut from, tag::GDAL_METADATA)?;
        if metadata.len() > MAX_METADATA_BYTES {
            let found = metadata.len();
            let reason =
                format!("its metadata has {found} bytes; at most {MAX_METADATA_BYTES} are read");
            return Err(damaged(name, reason));
        }
        let is_float = header.whole_number(&mut from, tag::SAMPLE_FORMAT)? == Some(3);
        let predictor = header.whole_number(&mut from, tag::PREDICTOR)?.unwrap_or(1);
        let storage = storage(&header, &mut from, spec, chunks)?;
        let fail = |error: tiff::TiffError| damaged(name, error.to_string());
        let mut limits = Limits::default();
        limits.decoding_buffer_size = MAX_CELLS * size_of::<f64>();
        // A strip's bytes are known to lie inside the file.
        limits.intermediate_buffer_size = usize::MAX;
        from.rewind().map_err(|error| damaged(name, error.to_string()))?;
        let mut decoder = Decoder::new(from).map_err(fail)?.with_limits(limits);
        let found = decoder.dimensions().map_err(fail)?;
        if (found.0 as usize, found.1 as usize) != (cols, rows) {
            return Err(damaged(name, "its width and length are given twice".to_owned()));
        }
        let color = decoder.colortype().map_err(fail)?;
        if !matches!(color.bit_depth(), 8 | 16 | 32 | 64) {
            return Err(damaged(
                name,
                format!("its samples have {} bits; 8, 16, 32 or 64 are wanted", color.bit_depth()),
            ));
        }
        let bands = usize::from(color.num_samples());
        // The decoder drops samples beyond the colours before it undoes a predictor, which then gives other values.
        if bands as u64 != samples && predictor != 1 {
            return Err(damaged(
                name,
                format!(
                    "it has {samples} samples a cell, {bands} of them colours, under predictor {predictor}; predictor 1 is wanted"
                ),
            ));
        }
        let about = (0..bands).map(|band| About {
            format: "GeoTIFF",
            storage: storage.clone(),
            nodata: (!nodata_text.is_empty()).then(|| nodata_text.clone()),
            scale: metadata_number(&metadata, "scale", band).unwrap_or(1.0),
            offset: metadata_number(&metadata, "offset", band).unwrap_or(0.0),
        });
        let facts = Facts {
            name: name.to_owned(),
            spec,
            crs,
            about: about.collect(),
            nodata: nodata_text.parse().ok(),
            is_float,
            chunks,
        };
        Ok((facts, Self { decoder, byte_counts }))
    }

    /// Decodes one strip or tile.
    pub(crate) fn chunk(&mut self, facts: &Facts, index: usize) -> Result<Chunk, TerrainError> {
        if self.byte_counts[index] == 0 {
            return Ok(Chunk::Left);
        }
        let decoded = self.decoder.read_chunk(index as u32);
        let chunk = Chunk::Samples(decoded.map_err(|e| damaged(&facts.name, e.to_string()))?);
        Ok(chunk)
    }

    /// The file itself, for its bytes; the decoder seeks before it reads.
    pub(crate) fn file(&mut self) -> &mut R {
        self.decoder.inner()
    }
}

impl Facts {
    /// Every band of a window, from the strips or tiles that it touches.
    ///
    /// # Errors
    /// The chunk's own; [`TerrainError::TooLarge`] beyond [`MAX_CELLS`]; [`TerrainError::Grid`] for a window outside.
    pub(crate) fn gather<C: AsRef<Chunk>>(
        &self,
        window: Window,
        mut chunk: impl FnMut(usize) -> Result<C, TerrainError>,
    ) -> Result<Vec<GridFile>, TerrainError> {
        let spec = self.spec.sub(window)?;
        let bands = self.about.len();
        if spec.len() > MAX_CELLS || spec.len() * bands > MAX_SAMPLES {
            let Window { rows, cols, .. } = window;
            return Err(TerrainError::TooLarge { name: self.name.clone(), rows, cols });
        }
        let empty = (Raster::filled(spec, 0.0_f32), Raster::filled(spec, false));
        let mut planes = vec![empty; bands];
        let Chunks { rows, cols, across } = self.chunks;
        for down in window.row / rows..=(window.row + window.rows - 1) / rows {
            for along in window.col / cols..=(window.col + window.cols - 1) / cols {
                let here = Window {
                    row: down * rows,
                    col: along * cols,
                    rows: rows.min(self.spec.rows() - down * rows),
                    cols: cols.min(self.spec.cols() - along * cols),
                };
                let chunk = chunk(down * across + along)?;
                self.copy(here, chunk.as_ref(), window, &mut planes)?;
            }
        }
        let crs = || self.crs.clone();
        let files = planes.into_iter().zip(&self.about);
        Ok(files
            .map(|((raster, known), about)| GridFile {
                raster,
                known,
                crs: crs(),
                about: about.clone(),
            })
            .collect())
    }

    /// Copies what a chunk, which covers `here`, has of the window.
    fn copy(
        &self,
        here: Window,
        chunk: &Chunk,
        window: Window,
        planes: &mut [(Raster<f32>, Raster<bool>)],
    ) -> Result<(), TerrainError> {
        let Some(part) = here.intersection(window) else { return Ok(()) };
        let copy = Transfer { facts: self, here, part, window };
        match chunk {
            Chunk::Left => {
                let fill = vec![self.nodata.unwrap_or(0.0); here.rows * here.cols * planes.len()];
                copy.samples(&fill, |x| x, planes)
            }
            Chunk::Samples(samples) => match samples {
                DecodingResult::U8(v) => copy.samples(v, f64::from, planes),
                DecodingResult::U16(v) => copy.samples(v, f64::from, planes),
                DecodingResult::U32(v) => copy.samples(v, f64::from, planes),
                DecodingResult::U64(v) => copy.samples(v, |x| x as f64, planes),
                DecodingResult::I8(v) => copy.samples(v, f64::from, planes),
                DecodingResult::I16(v) => copy.samples(v, f64::from, planes),
                DecodingResult::I32(v) => copy.samples(v, f64::from, planes),
                DecodingResult::I64(v) => copy.samples(v, |x| x as f64, planes),
                DecodingResult::F16(v) => copy.samples(v, |x| f64::from(x.to_f32()), planes),
                DecodingResult::F32(v) => copy.samples(v, f64::from, planes),
                DecodingResult::F64(v) => copy.samples(v, |x| x, planes),
            },
        }
    }

    /// What a stored sample stands for; as f64 it is exact for all but 64-bit integers beyond 2⁵³.
    fn value(&self, sample: f64, scale: f64, offset: f64) -> Option<f32> {
        // Floats as f32 too: a nodata text may have fewer digits than what is stored.
        let alike = |none: f64| sample == none || self.is_float && sample as f32 == none as f32;
        let missing = self.nodata.is_some_and(alike) || is_special(sample as f32);
        // Unscaled samples stay what they are, a negative zero too.
        let is_plain = scale == 1.0 && offset == 0.0;
        let value = if is_plain { sample } else { sample * scale + offset } as f32;
        (!missing && value.is_finite() && !is_special(value)).then_some(value)
    }
}

/// The part of a chunk that goes into a window.
struct Transfer<'a> {
    facts: &'a Facts,
    here: Window,
    part: Window,
    window: Window,
}

impl Transfer<'_> {
    fn samples<T: Copy>(
        &self,
        samples: &[T],
        to_f64: impl Fn(T) -> f64,
        planes: &mut [(Raster<f32>, Raster<bool>)],
    ) -> Result<(), TerrainError> {
        let Self { facts, here, part, window } = self;
        let bands = planes.len();
        if samples.len() != here.rows * here.cols * bands {
            let found = samples.len();
            let wanted =
                format!("{found} samples for {bands} bands of {} x {}", here.rows, here.cols);
            return Err(damaged(&facts.name, wanted));
        }
        for (band, (raster, known)) in planes.iter_mut().enumerate() {
            let About { scale, offset, .. } = facts.about[band];
            for row in part.row..part.row + part.rows {
                let from = ((row - here.row) * here.cols + part.col - here.col) * bands + band;
                let to = (row - window.row) * window.cols + part.col - window.col;
                let values = &mut raster.values_mut()[to..to + part.cols];
                let knowns = &mut known.values_mut()[to..to + part.cols];
                let stored = samples[from..].iter().step_by(bands);
                for ((value, known), &sample) in values.iter_mut().zip(knowns).zip(stored) {
                    if let Some(found) = facts.value(to_f64(sample), scale, offset) {
                        (*value, *known) = (found, true);
                    }
                }
            }
        }
        Ok(())
    }
}

impl AsRef<Chunk> for Chunk {
    fn as_ref(&self) -> &Chunk {
        self
    }
}

/// The number in `<Item name=".." sample="BAND" role="ROLE">NUMBER</Item>`.
fn metadata_number(metadata: &str, role: &str, band: usize) -> Option<f64> {
    let (role, band) = (format!("role=\"{role}\""), format!("sample=\"{band}\""));
    metadata.split("<Item ").find_map(|item| {
        let (attributes, rest) = item.split_once('>')?;
        let wanted = attributes.contains(&role) && attributes.contains(&band);
        rest.split('<').next().filter(|_| wanted)?.trim().parse().ok()
    })
}

/// Several bands in separate planes are refused: of those the `tiff` crate reads only the first. So are compressions
/// outside the list of those tried.
fn check_layout(
    name: &str,
    header: &Header<'_>,
    from: &mut (impl Read + Seek),
    samples: u64,
) -> Result<(), TerrainError> {
    const PLANAR: u64 = 2;
    const BLACK_IS_ZERO: u64 = 1;
    const RGB: u64 = 2;
    if samples > 1 && header.whole_number(from, tag::PLANAR_CONFIGURATION)? == Some(PLANAR) {
        return Err(damaged(
            name,
            format!("its {samples} bands lie in separate planes; interleave them"),
        ));
    }
    // Others are turned into other numbers on decoding: inverted, or left as brightness and colour differences.
    let photometric = header.whole_number(from, tag::PHOTOMETRIC)?.unwrap_or(BLACK_IS_ZERO);
    if ![BLACK_IS_ZERO, RGB].contains(&photometric) {
        return Err(damaged(
            name,
            format!(
                "its photometric interpretation is {photometric}; 1 (black is zero) or 2 (RGB) is wanted"
            ),
        ));
    }
    let compression = header.whole_number(from, tag::COMPRESSION)?.unwrap_or(1);
    if compression_name(compression).is_none() {
        return Err(damaged(
            name,
            format!(
                "its compression is number {compression}; none, LZW, deflate, ZSTD, PackBits and JPEG are read"
            ),
        ));
    }
    Ok(())
}

fn compression_name(compression: u64) -> Option<&'static str> {
    Some(match compression {
        1 => "no compression",
        5 => "LZW",
        7 => "JPEG",
        8 | 32946 => "deflate",
        32773 => "PackBits",
        50000 => "ZSTD",
        _ => return None,
    })
}

/// How the image is cut, and the bytes of each strip or tile, all of which must lie inside the file.
fn chunks(
    name: &str,
    header: &Header<'_>,
    from: &mut (impl Read + Seek),
    spec: GridSpec,
    samples: u64,
    length: u64,
) -> Result<(Chunks, Vec<u64>), TerrainError> {
    let (rows, cols) = (spec.rows() as u64, spec.cols() as u64);
    let tile_width = header.whole_number(from, tag::TILE_WIDTH)?;
    let is_tiled = tile_width.is_some();
    let (chunk_rows, chunk_cols) = if is_tiled {
        (header.whole_number(from, tag::TILE_LENGTH)?.unwrap_or(0), tile_width.unwrap_or(0))
    } else {
        (header.whole_number(from, tag::ROWS_PER_STRIP)?.unwrap_or(rows).min(rows), cols)
    };
    let size = chunk_rows.checked_mul(chunk_cols).and_then(|cells| cells.checked_mul(samples));
    if size.is_none_or(|samples| samples == 0 || samples > MAX_CHUNK_SAMPLES) {
        let what = if is_tiled { "tiles" } else { "strips" };
        return Err(damaged(
            name,
            format!(
                "its {what} are {chunk_rows} x {chunk_cols} cells of {samples} samples; 1 to {MAX_CHUNK_SAMPLES} samples are read"
            ),
        ));
    }
    let (at, counts) = if is_tiled {
        (tag::TILE_OFFSETS, tag::TILE_BYTE_COUNTS)
    } else {
        (tag::STRIP_OFFSETS, tag::STRIP_BYTE_COUNTS)
    };
    let places = header.whole_numbers(from, at)?;
    let byte_counts = header.whole_numbers(from, counts)?;
    let across = cols.div_ceil(chunk_cols);
    let wanted = across * rows.div_ceil(chunk_rows);
    if places.len() as u64 != wanted || byte_counts.len() as u64 != wanted {
        return Err(damaged(
            name,
            format!(
                "it has {} places and {} sizes for {wanted} strips or tiles",
                places.len(),
                byte_counts.len()
            ),
        ));
    }
    let beyond =
        |(place, count): (&u64, &u64)| place.checked_add(*count).is_none_or(|e| e > length);
    if let Some(index) = places.iter().zip(&byte_counts).position(beyond) {
        return Err(damaged(
            name,
            format!(
                "strip or tile {index} has {} bytes at byte {}, beyond the end of the file of {length} bytes",
                byte_counts[index], places[index]
            ),
        ));
    }
    let chunks =
        Chunks { rows: chunk_rows as usize, cols: chunk_cols as usize, across: across as usize };
    Ok((chunks, byte_counts))
}

/// How the file holds its samples, in words.
fn storage(
    header: &Header<'_>,
    from: &mut (impl Read + Seek),
    spec: GridSpec,
    chunks: Chunks,
) -> Result<String, TerrainError> {
    let mut one = |tag| header.whole_number(from, tag);
    let bits = one(tag::BITS_PER_SAMPLE)?.unwrap_or(1);
    let kind = match one(tag::SAMPLE_FORMAT)?.unwrap_or(1) {
        1 => "uint",
        2 => "int",
        3 => "float",
        _ => "unknown",
    };
    let cut = if one(tag::TILE_WIDTH)?.is_some() {
        format!("tiles of {} x {}", chunks.rows, chunks.cols)
    } else {
        match chunks.rows {
            1 => "strips of 1 row".to_owned(),
            rows if rows == spec.rows() => "one strip".to_owned(),
            rows => format!("strips of {rows} rows"),
        }
    };
    let compression = compression_name(one(tag::COMPRESSION)?.unwrap_or(1)).unwrap_or_default();
    let predictor = match one(tag::PREDICTOR)?.unwrap_or(1) {
        1 => String::new(),
        predictor => format!(", predictor {predictor}"),
    };
    let order = if header.big_endian { "big endian" } else { "little endian" };
    let big = if header.big_tiff { ", BigTIFF" } else { "" };
    Ok(format!("{kind}{bits}, {cut}, {compression}{predictor}, {order}{big}"))
}

/// Where the geo tags put the image.
fn place(
    name: &str,
    header: &Header<'_>,
    from: &mut (impl Read + Seek),
    rows: usize,
    cols: usize,
) -> Result<(GridSpec, Option<Crs>), TerrainError> {
    let keys = GeoKeys {
        directory: header
            .whole_numbers(from, tag::GEO_KEYS)?
            .into_iter()
            .map(|number| number as u16)
            .collect(),
        doubles: header.doubles(from, tag::GEO_DOUBLES)?,
        ascii: header.text(from, tag::GEO_ASCII)?,
    };
    if keys.short(MODEL_TYPE) == Some(GEOGRAPHIC) {
        return Err(damaged(name, "its grid is in degrees; project it to metres first".to_owned()));
    }
    if let Some(unit) =
        keys.short(LINEAR_UNIT).filter(|&unit| unit != METRE && unit != USER_DEFINED)
    {
        return Err(damaged(
            name,
            format!("its grid is in EPSG unit {unit}; metres (9001) are wanted"),
        ));
    }
    if let Some(metres) = keys.double(LINEAR_UNIT_SIZE).filter(|&metres| metres != 1.0) {
        return Err(damaged(
            name,
            format!("its grid is in units of {metres} m; metres are wanted"),
        ));
    }
    let Affine { step_x, step_y, west, north } = Affine::of(name, header, from)?;
    if !(step_x > 0.0 && step_y < 0.0) {
        let found =
            format!("a pixel steps by ({step_x}, {step_y}); north up, east right is wanted");
        return Err(damaged(name, found));
    }
    if (step_x + step_y).abs() > SQUARE_TOLERANCE * step_x {
        return Err(damaged(
            name,
            format!("its cells are {step_x} x {}; square ones are wanted", -step_y),
        ));
    }
    let half = if keys.short(RASTER_TYPE) == Some(PIXEL_IS_POINT) { step_x / 2.0 } else { 0.0 };
    let spec = GridSpec::new(rows, cols, step_x)?.at(west - half, north + half);
    let crs = (!keys.directory.is_empty()).then(|| Crs::from_geo_keys(&keys));
    Ok((spec, crs))
}

/// Map position of pixel (0, 0) and its step to the next column and row.
struct Affine {
    step_x: f64,
    step_y: f64,
    west: f64,
    north: f64,
}

impl Affine {
    fn of(
        name: &str,
        header: &Header<'_>,
        from: &mut (impl Read + Seek),
    ) -> Result<Self, TerrainError> {
        let scale = header.doubles(from, tag::PIXEL_SCALE)?;
        let tie = header.doubles(from, tag::TIE_POINT)?;
        let matrix = header.doubles(from, tag::TRANSFORMATION)?;
        let affine = if let ([sx, sy, ..], [i, j, _, x, y, ..]) = (&scale[..], &tie[..]) {
            Self { step_x: *sx, step_y: -sy, west: x - i * sx, north: y + j * sy }
        } else if let [a, b, _, x, d, e, _, y, ..] = &matrix[..] {
            if b.abs().max(d.abs()) > SQUARE_TOLERANCE * a.abs() {
                return Err(damaged(
                    name,
                    format!("its grid is turned (terms {b}, {d}); north up is wanted"),
                ));
            }
            Self { step_x: *a, step_y: *e, west: *x, north: *y }
        } else {
            return Err(damaged(
                name,
                "it has neither pixel scale and tie point nor an affine matrix".to_owned(),
            ));
        };
        if [affine.step_x, affine.step_y, affine.west, affine.north].iter().all(|v| v.is_finite()) {
            return Ok(affine);
        }
        Err(damaged(name, "its pixel scale or tie point is not finite".to_owned()))
    }
}
