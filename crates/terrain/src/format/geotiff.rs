//! GeoTIFF: the image by the `tiff` crate, its place by the tags of the OGC GeoTIFF standard 1.1 and GDAL's own.

use std::io::Cursor;

use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::tags::{PlanarConfiguration, Tag};
use wisdom_grid::GridSpec;

use super::{About, GridFile, MAX_CELLS, check_size, damaged, grid_file};
use crate::{Crs, Projection, TerrainError};

/// GDAL's XML of scale, offset and the like, which the `tiff` crate does not name.
const GDAL_METADATA: Tag = Tag::Unknown(42112);

/// How far two spacings or a rotation term may be from square, relative: rounding in writers' decimals.
const SQUARE_TOLERANCE: f64 = 1e-6;

type Tiff<'a> = Decoder<Cursor<&'a [u8]>>;

pub(super) fn read(name: &str, bytes: &[u8]) -> Result<Vec<GridFile>, TerrainError> {
    let fail = |error: tiff::TiffError| damaged(name, error.to_string());
    let mut limits = Limits::default();
    limits.decoding_buffer_size = MAX_CELLS * size_of::<f64>();
    let mut tiff = Decoder::new(Cursor::new(bytes)).map_err(fail)?.with_limits(limits);
    let (cols, rows) = tiff.dimensions().map_err(fail)?;
    let (rows, cols) = (rows as usize, cols as usize);
    check_size(name, rows, cols)?;
    let Place { spec, crs } = Place::of(name, &mut tiff, rows, cols)?;
    let bands = tiff.colortype().map_err(fail)?.num_samples() as usize;
    check_layout(name, &mut tiff, bands)?;
    let nodata = nodata(&mut tiff);
    let metadata = text(&mut tiff, GDAL_METADATA);
    let samples = samples(tiff.read_image().map_err(fail)?);
    if samples.len() != spec.len() * bands {
        let found = samples.len();
        return Err(damaged(name, format!("{found} samples for {bands} bands of {rows} x {cols}")));
    }
    (0..bands)
        .map(|band| {
            let scale = metadata_number(&metadata, "scale", band).unwrap_or(1.0);
            let offset = metadata_number(&metadata, "offset", band).unwrap_or(0.0);
            let values = samples.iter().skip(band).step_by(bands).map(|&sample| {
                // As f32 too: a nodata text may have fewer digits than the stored float.
                let missing = nodata
                    .is_some_and(|none| sample == none || sample as f32 == none as f32)
                    || super::is_special(sample as f32);
                (!missing).then_some((sample * scale + offset) as f32)
            });
            let about = About {
                format: "GeoTIFF",
                storage: String::new(),
                nodata: nodata.map(|none| none.to_string()),
                scale,
                offset,
            };
            grid_file(spec, values, crs.clone(), about)
        })
        .collect()
}

/// Several bands in separate planes are refused: of those the `tiff` crate reads only the first.
fn check_layout(name: &str, tiff: &mut Tiff<'_>, bands: usize) -> Result<(), TerrainError> {
    let planar = tiff.find_tag_unsigned::<u16>(Tag::PlanarConfiguration).ok().flatten();
    if bands > 1 && planar == Some(PlanarConfiguration::Planar.to_u16()) {
        return Err(damaged(
            name,
            format!("its {bands} bands lie in separate planes; interleave them"),
        ));
    }
    Ok(())
}

/// Every sample as f64: exact for all but 64-bit integers beyond 2⁵³.
fn samples(image: DecodingResult) -> Vec<f64> {
    match image {
        DecodingResult::U8(v) => v.into_iter().map(f64::from).collect(),
        DecodingResult::U16(v) => v.into_iter().map(f64::from).collect(),
        DecodingResult::U32(v) => v.into_iter().map(f64::from).collect(),
        DecodingResult::U64(v) => v.into_iter().map(|x| x as f64).collect(),
        DecodingResult::I8(v) => v.into_iter().map(f64::from).collect(),
        DecodingResult::I16(v) => v.into_iter().map(f64::from).collect(),
        DecodingResult::I32(v) => v.into_iter().map(f64::from).collect(),
        DecodingResult::I64(v) => v.into_iter().map(|x| x as f64).collect(),
        DecodingResult::F16(v) => v.into_iter().map(|x| f64::from(x.to_f32())).collect(),
        DecodingResult::F32(v) => v.into_iter().map(f64::from).collect(),
        DecodingResult::F64(v) => v,
    }
}

/// A text tag; empty if the file has none that can be read.
fn text(tiff: &mut Tiff<'_>, tag: Tag) -> String {
    tiff.get_tag_ascii_string(tag).unwrap_or_default()
}

fn nodata(tiff: &mut Tiff<'_>) -> Option<f64> {
    text(tiff, Tag::GdalNodata).trim_matches(|c: char| c == '\0' || c.is_whitespace()).parse().ok()
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

/// Where the geo tags put the image.
struct Place {
    spec: GridSpec,
    crs: Option<Crs>,
}

impl Place {
    fn of(name: &str, tiff: &mut Tiff<'_>, rows: usize, cols: usize) -> Result<Self, TerrainError> {
        let keys = GeoKeys::of(tiff);
        if keys.short(MODEL_TYPE) == Some(GEOGRAPHIC) {
            return Err(damaged(
                name,
                "its grid is in degrees; project it to metres first".to_owned(),
            ));
        }
        if let Some(unit) =
            keys.short(LINEAR_UNIT).filter(|&unit| unit != METRE && unit != USER_DEFINED)
        {
            return Err(damaged(
                name,
                format!("its grid is in EPSG unit {unit}; metres (9001) are wanted"),
            ));
        }
        let Affine { step_x, step_y, west, north } = Affine::of(name, tiff)?;
        if !(step_x > 0.0 && step_y < 0.0) {
            let found =
                format!("a pixel steps by ({step_x}, {step_y}); north up, east right is wanted")
                    .to_string();
            return Err(damaged(name, found));
        }
        if (step_x + step_y).abs() > SQUARE_TOLERANCE * step_x {
            return Err(damaged(
                name,
                format!("its cells are {step_x} x {}; square ones are wanted", -step_y),
            ));
        }
        let half = if keys.short(RASTER_TYPE) == Some(PIXEL_IS_POINT) { step_x / 2.0 } else { 0.0 };
        Ok(Self {
            spec: GridSpec::new(rows, cols, step_x)?.at(west - half, north + half),
            crs: Some(Crs {
                name: String::new(),
                radius_m: keys.double(SEMI_MAJOR_AXIS).filter(|r| r.is_finite() && *r > 0.0),
                polar_radius_m: None,
                projection: Projection::Local,
            }),
        })
    }
}

/// Map position of pixel (0, 0) and its step to the next column and row.
struct Affine {
    step_x: f64,
    step_y: f64,
    west: f64,
    north: f64,
}

impl Affine {
    fn of(name: &str, tiff: &mut Tiff<'_>) -> Result<Self, TerrainError> {
        let mut doubles = |tag| tiff.get_tag_f64_vec(tag).unwrap_or_default();
        let scale = doubles(Tag::ModelPixelScaleTag);
        let tie = doubles(Tag::ModelTiepointTag);
        let matrix = doubles(Tag::ModelTransformationTag);
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

// Keys and values of the GeoTIFF standard 1.1, by number.
const MODEL_TYPE: u16 = 1024;
const GEOGRAPHIC: u16 = 2;
const RASTER_TYPE: u16 = 1025;
const PIXEL_IS_POINT: u16 = 2;
const SEMI_MAJOR_AXIS: u16 = 2057;
const LINEAR_UNIT: u16 = 3076;
const METRE: u16 = 9001;
const USER_DEFINED: u16 = 32767;
const IN_DOUBLES: u16 = 34736;

/// The geo key directory: entries of key, place, count and value or index.
struct GeoKeys {
    entries: Vec<[u16; 4]>,
    doubles: Vec<f64>,
}

impl GeoKeys {
    fn of(tiff: &mut Tiff<'_>) -> Self {
        let directory = tiff.get_tag_u16_vec(Tag::GeoKeyDirectoryTag).unwrap_or_default();
        let entries = directory.chunks_exact(4).skip(1).map(|e| [e[0], e[1], e[2], e[3]]).collect();
        Self { entries, doubles: tiff.get_tag_f64_vec(Tag::GeoDoubleParamsTag).unwrap_or_default() }
    }

    /// A value stored in the directory itself.
    fn short(&self, key: u16) -> Option<u16> {
        self.entries.iter().find(|e| e[0] == key && e[1] == 0).map(|e| e[3])
    }

    /// A value stored among the doubles.
    fn double(&self, key: u16) -> Option<f64> {
        let entry = self.entries.iter().find(|e| e[0] == key && e[1] == IN_DOUBLES)?;
        self.doubles.get(usize::from(entry[3])).copied()
    }
}
