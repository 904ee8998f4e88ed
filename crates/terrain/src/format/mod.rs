//! Terrain files.

mod ascii;
mod geotiff;
mod isis;
mod map;
mod npy;
mod pds3;
mod pds4;
mod png16;
mod pvl;
mod raw;
mod reader;
mod side;
mod wkt;

use std::path::Path;

use wisdom_grid::{GridSpec, Raster};

use crate::{Crs, Layer, TerrainError};

pub use geotiff::write::{
    GeoTiffOptions, GeoTiffWriter, Sample, write_geotiff, write_geotiff_by, write_geotiff_with,
    write_layer,
};
pub use reader::{DEFAULT_CACHE_BYTES, GridReader};

/// What a terrain file holds.
#[derive(Debug, Clone, PartialEq)]
pub struct GridFile {
    /// The values, 0 where the file has none.
    pub raster: Raster<f32>,
    /// Where the file has a value.
    pub known: Raster<bool>,
    /// What the map coordinates mean, if the file says.
    pub crs: Option<Crs>,
    /// How the file holds it.
    pub about: About,
}

/// How a file holds its grid: facts for people.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct About {
    /// The format's name: `GeoTIFF`, `PDS3 image`, ..
    pub format: &'static str,
    /// Sample type, layout, compression and byte order, in words: `float32, tiles of 256 x 256, deflate, predictor 3`.
    pub storage: String,
    /// What stands for "no value", as the file writes it.
    pub nodata: Option<String>,
    /// What stored numbers are multiplied by.
    pub scale: f64,
    /// What is added then.
    pub offset: f64,
}

impl GridFile {
    /// A grid of which nothing is known.
    #[must_use]
    pub fn unknown(spec: GridSpec) -> Self {
        Self {
            raster: Raster::filled(spec, 0.0),
            known: Raster::filled(spec, false),
            crs: None,
            about: About::default(),
        }
    }

    /// Radius of the body's sphere (semi-major axis of its ellipsoid), metres, if the file says.
    #[must_use]
    pub fn body_radius_m(&self) -> Option<f64> {
        self.crs.as_ref()?.radius_m
    }

    /// The file as a layer: u = 0 where there is a value, 1 where there is none.
    ///
    /// ```
    /// # use wisdom_grid::Cell;
    /// let asc = b"ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\nNODATA_value -9\n3.5 -9\n";
    /// let layer = wisdom_terrain::format::read("dem.asc", asc)?.into_layer()?;
    /// assert_eq!(layer.value(Cell::new(0, 0)), 3.5);
    /// assert!(!layer.is_known(Cell::new(0, 1)));
    /// # Ok::<(), wisdom_terrain::TerrainError>(())
    /// ```
    ///
    /// # Errors
    /// As [`Layer::new`]; never for what [`read`] returned.
    pub fn into_layer(self) -> Result<Layer, TerrainError> {
        let uncertainty = self.known.map(|&known| if known { 0.0 } else { 1.0 });
        Layer::new(self.raster, uncertainty)
    }
}

/// The most cells a file may have: 2²⁶, a square of 8192, 256 MiB in memory.
pub const MAX_CELLS: usize = 1 << 26;

/// The largest file that is read from disk: 2³¹ bytes, room for four bands of [`MAX_CELLS`] doubles.
pub const MAX_FILE_BYTES: u64 = 1 << 31;

/// Reads a terrain file of one band from its bytes; `name` is for messages, and tells `.asc` by its extension.
///
/// The format is told by the first bytes:
///
/// | format | what is read |
/// | --- | --- |
/// | GeoTIFF | classic or big, either byte order, strips or tiles, integers or floats, every compression and predictor of the `tiff` crate but fax and WebP; placed by pixel scale and tie point, or by an affine matrix without rotation, with the half-pixel shift of `PixelIsPoint`; GDAL's nodata, scale and offset |
/// | PDS3 image | attached or detached label; reals of 32 and 64 bits, integers of 8 to 32, either byte order; `SCALING_FACTOR`, `OFFSET`, missing values as numbers or bits; `IMAGE_MAP_PROJECTION` |
/// | PDS4 array | the `.xml` label, with its raw file beside it; `Array_2D` and `Array_3D` with their images and maps; any integer or IEEE 754 type; scaling, special constants, display direction, cartography |
/// | ISIS cube | band-sequential or tiled, attached or detached; base, multiplier and special pixels; the `Mapping` group |
/// | PNG | grey of 8 or 16 bits, with a side file |
/// | `NumPy` | `.npy` of two axes, C or Fortran order, either byte order; with a side file or without |
/// | ESRI ASCII grid | `.asc`, with a `.prj` beside it or without |
///
/// A **side file** `NAME.toml` stands beside `NAME` (`height16.png.toml`). Its keys: `spacing-m`, the side of a cell;
/// `west-m` and `north-m`, the outer north-west corner; `scale` and `offset`, which turn a stored number into a reading,
/// `stored × scale + offset`; `nodata`, the stored number that is none; `body-radius-m`. All may be absent, but an image
/// needs `spacing-m`; without them cells are 1 m wide, the south-west corner is at the origin
/// ([`GridSpec::new`]), and numbers are taken as they are stored. Other keys are errors.
///
/// NaN, infinities, the file's nodata values and the bit patterns that ISIS and PDS3 products reserve
/// (0xFF7FFFFA to 0xFF7FFFFF) are unknown cells. A map projection other than the equidistant cylindrical and the polar
/// stereographic is taken as a local plane in metres; a grid in degrees is refused.
///
/// This function sees no other file: a detached label says which one it misses, and side files are not found. See
/// [`read_with`] and [`read_file`].
///
/// # Errors
/// [`TerrainError::Format`] for anything else, naming what was found; [`TerrainError::File`] if the content
/// is damaged or its grid is not north-up, square and metric; [`TerrainError::Bands`] if there is more than one band;
/// [`TerrainError::TooLarge`] beyond [`MAX_CELLS`], before room is made for them.
pub fn read(name: &str, bytes: &[u8]) -> Result<GridFile, TerrainError> {
    read_with(name, bytes, &mut |_| None)
}

/// Reads a terrain file of any number of bands (a colour image has three), as [`read`] does.
///
/// # Errors
/// As [`read`], but for the number of bands.
pub fn read_bands(name: &str, bytes: &[u8]) -> Result<Vec<GridFile>, TerrainError> {
    read_bands_with(name, bytes, &mut |_| None)
}

/// As [`read`], with the files beside it: `sibling` gives the bytes of a file of the same folder, or nothing.
///
/// `sibling` is asked for plain file names only, never for a path: a label from elsewhere cannot reach out of its
/// folder. Names of labels are also tried in lower and in upper case, for they often come from file systems that know
/// no difference.
///
/// ```
/// let side = b"spacing-m = 0.5\nscale = 2";
/// let npy = b"\x93NUMPY\x01\0\x39\0{'descr': '|u1', 'fortran_order': False, 'shape': (1, 2)}\x07\x09";
/// let file = wisdom_terrain::format::read_with("h.npy", npy, &mut |name| {
///     (name == "h.npy.toml").then(|| side.to_vec())
/// })?;
/// assert_eq!(file.raster.spec().spacing_m(), 0.5);
/// assert_eq!(file.raster.values(), [14.0, 18.0]);
/// # Ok::<(), wisdom_terrain::TerrainError>(())
/// ```
///
/// # Errors
/// As [`read`]; [`TerrainError::File`] also if a file that a label names is not there, or not a plain name.
pub fn read_with(
    name: &str,
    bytes: &[u8],
    sibling: &mut dyn FnMut(&str) -> Option<Vec<u8>>,
) -> Result<GridFile, TerrainError> {
    only(name, read_bands_with(name, bytes, sibling)?)
}

/// Reads a terrain file of any number of bands with the files beside it, as [`read_with`] does.
///
/// # Errors
/// As [`read_with`], but for the number of bands.
pub fn read_bands_with(
    name: &str,
    bytes: &[u8],
    sibling: &mut dyn FnMut(&str) -> Option<Vec<u8>>,
) -> Result<Vec<GridFile>, TerrainError> {
    let mut siblings = Siblings { find: sibling };
    let siblings = &mut siblings;
    let is_asc = extension(name).is_some_and(|found| found.eq_ignore_ascii_case("asc"));
    match kind(bytes) {
        Kind::Tiff => geotiff::read(name, bytes),
        Kind::Pds3 => pds3::read(name, bytes, siblings),
        Kind::Pds4 => pds4::read(name, bytes, siblings),
        Kind::Isis => isis::read(name, bytes, siblings),
        Kind::Png => Ok(vec![png16::read(name, bytes, siblings)?]),
        Kind::NumPy => Ok(vec![npy::read(name, bytes, siblings)?]),
        Kind::Ascii => Ok(vec![ascii::read(name, bytes, siblings)?]),
        Kind::Other(_) if is_asc => Ok(vec![ascii::read(name, bytes, siblings)?]),
        Kind::Other(found) => Err(TerrainError::Format { name: name.to_owned(), found }),
    }
}

/// Reads a terrain file of one band from disk, with the files beside it, as [`read_with`] does.
///
/// # Errors
/// As [`read_with`]; [`TerrainError::Io`] if the file is not there, cannot be read, or is larger than
/// [`MAX_FILE_BYTES`].
pub fn read_file(path: &Path) -> Result<GridFile, TerrainError> {
    let name = path.display().to_string();
    let refused = |source| TerrainError::Io { name: name.clone(), action: "read", source };
    let bytes = on_disk(path).map_err(refused)?;
    read_with(&name, &bytes, &mut |sibling| beside(path, sibling))
}

/// The bytes of a file in the same folder as another.
fn beside(path: &Path, sibling: &str) -> Option<Vec<u8>> {
    on_disk(&path.parent().unwrap_or(Path::new("")).join(sibling)).ok()
}

/// The bytes of a plain file that is not too large.
fn on_disk(path: &Path) -> std::io::Result<Vec<u8>> {
    let found = std::fs::metadata(path)?;
    if !found.is_file() {
        return Err(std::io::Error::other("it is no plain file"));
    }
    if found.len() > MAX_FILE_BYTES {
        let reason = format!("it has {} bytes; at most {MAX_FILE_BYTES} are read", found.len());
        return Err(std::io::Error::other(reason));
    }
    std::fs::read(path)
}

/// The only band.
fn only(name: &str, mut bands: Vec<GridFile>) -> Result<GridFile, TerrainError> {
    match (bands.pop(), bands.len()) {
        (Some(only), 0) => Ok(only),
        (_, others) => Err(TerrainError::Bands { name: name.to_owned(), bands: others + 1 }),
    }
}

/// The files beside the one that is read.
struct Siblings<'a> {
    find: &'a mut dyn FnMut(&str) -> Option<Vec<u8>>,
}

impl Siblings<'_> {
    /// The file of this very name. A name made from that of the file that is read is plain already.
    fn find(&mut self, file: &str) -> Option<Vec<u8>> {
        is_plain(file).then(|| (self.find)(file)).flatten()
    }

    /// A file that the label `name` refers to.
    fn need(&mut self, name: &str, file: &str) -> Result<Vec<u8>, TerrainError> {
        if !is_plain(file) {
            let found = pvl::shorten(file);
            return Err(damaged(
                name,
                format!("its samples are in {found}; a plain name of a file beside it is wanted"),
            ));
        }
        let cases = [file.to_owned(), file.to_ascii_lowercase(), file.to_ascii_uppercase()];
        let found = cases.iter().find_map(|case| (self.find)(case));
        found.ok_or_else(|| {
            damaged(name, format!("its samples are in {file}, which is not there beside it"))
        })
    }
}

/// A name that stays in its folder on every system.
fn is_plain(file: &str) -> bool {
    const LONGEST: usize = 255;
    let outside = |c: char| matches!(c, '/' | '\\' | ':') || c.is_control();
    !matches!(file, "" | "." | "..") && file.len() <= LONGEST && !file.contains(outside)
}

/// The last part of a path.
fn file_name(name: &str) -> &str {
    name.rsplit(['/', '\\']).next().unwrap_or(name)
}

fn extension(name: &str) -> Option<&str> {
    file_name(name).rsplit_once('.').map(|(_, extension)| extension)
}

enum Kind {
    Tiff,
    Pds3,
    Pds4,
    Isis,
    Png,
    NumPy,
    Ascii,
    Other(&'static str),
}

/// What the first bytes say. The names of formats that are not read help a person to convert them.
fn kind(bytes: &[u8]) -> Kind {
    /// A label's first words stand in its first lines.
    const HEAD: usize = 512;
    let text = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes).trim_ascii_start();
    let head = &text[..text.len().min(HEAD)];
    let starts = |magic: &[u8]| bytes.starts_with(magic);
    let holds = |word: &[u8]| head.windows(word.len()).any(|found| found == word);
    let begins =
        |word: &[u8]| head.get(..word.len()).is_some_and(|found| found.eq_ignore_ascii_case(word));
    if [b"II\x2a\0", b"MM\0\x2a", b"II\x2b\0", b"MM\0\x2b"].into_iter().any(|magic| starts(magic)) {
        Kind::Tiff
    } else if starts(b"\x89PNG") {
        Kind::Png
    } else if starts(b"\x93NUMPY") {
        Kind::NumPy
    } else if begins(b"ncols") {
        Kind::Ascii
    } else if begins(b"<?xml") || begins(b"<Product_") {
        Kind::Pds4
    } else if begins(b"object") && holds(b"IsisCube") {
        Kind::Isis
    } else if begins(b"PDS_VERSION_ID") || begins(b"CCSD") && holds(b"PDS_VERSION_ID") {
        Kind::Pds3
    } else if bytes.is_empty() {
        Kind::Other("an empty file")
    } else if starts(b"\x89HDF") {
        Kind::Other("an HDF5 file")
    } else if starts(b"\0\0\0\x0cjP  ") {
        Kind::Other("a JPEG 2000 image")
    } else if starts(b"\xFF\xD8\xFF") {
        Kind::Other("a JPEG image")
    } else if starts(b"CDF") {
        Kind::Other("a NetCDF file")
    } else if starts(b"SIMPLE  =") {
        Kind::Other("a FITS file")
    } else if starts(b"LASF") {
        Kind::Other("a LAS point cloud")
    } else if starts(b"ply") {
        Kind::Other("a PLY mesh")
    } else {
        Kind::Other(
            "bytes of no format known here (of an image with a label beside it, the label is to be named)",
        )
    }
}

/// The bit patterns of missing and special pixels in 32-bit ISIS and PDS3 products, and the lowest `f32`, which many
/// programs write for "none" (ISIS special pixel values, USGS).
fn is_special(value: f32) -> bool {
    (0xFF7F_FFFA..=0xFF7F_FFFF).contains(&value.to_bits())
}

/// A grid file from stored values (`None` where missing), all of which are known to be there.
fn grid_file(
    spec: GridSpec,
    values: impl Iterator<Item = Option<f32>>,
    crs: Option<Crs>,
    about: About,
) -> Result<GridFile, TerrainError> {
    let mut readings = Vec::with_capacity(spec.len());
    let mut known = Vec::with_capacity(spec.len());
    for value in values {
        let usable = value.filter(|value| value.is_finite() && !is_special(*value));
        readings.push(usable.unwrap_or(0.0));
        known.push(usable.is_some());
    }
    Ok(GridFile {
        raster: Raster::from_vec(spec, readings)?,
        known: Raster::from_vec(spec, known)?,
        crs,
        about,
    })
}

fn check_size(name: &str, rows: usize, cols: usize) -> Result<(), TerrainError> {
    if rows.checked_mul(cols).is_none_or(|cells| cells > MAX_CELLS) {
        return Err(TerrainError::TooLarge { name: name.to_owned(), rows, cols });
    }
    Ok(())
}

fn damaged(name: &str, reason: String) -> TerrainError {
    TerrainError::File { name: name.to_owned(), reason }
}
