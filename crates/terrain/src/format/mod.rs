//! Terrain files.

mod ascii;
mod geotiff;

use wisdom_grid::{GridSpec, Raster};

use crate::{Crs, Layer, TerrainError};

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

/// Reads a terrain file of one band from its bytes; `name` is for messages, and tells `.asc` by its extension.
///
/// Reads GeoTIFF (told by its first bytes: classic or big, either byte order, strips or tiles, integers or floats, any
/// compression and predictor of the `tiff` crate; placed by pixel scale and tie point, or by an affine matrix without
/// rotation, with the half-pixel shift of `PixelIsPoint`; GDAL's nodata, scale and offset) and ESRI ASCII
/// grids. NaN, infinities, the file's nodata value and the bit patterns that ISIS and PDS3 products reserve
/// (0xFF7FFFFA to 0xFF7FFFFF) are unknown cells.
///
/// # Errors
/// [`TerrainError::Format`] for anything else, naming what was found; [`TerrainError::File`] if the content
/// is damaged or its grid is not north-up, square and metric; [`TerrainError::Bands`] if there is more than one band;
/// [`TerrainError::TooLarge`] beyond [`MAX_CELLS`], before room is made for them.
pub fn read(name: &str, bytes: &[u8]) -> Result<GridFile, TerrainError> {
    let mut bands = read_bands(name, bytes)?;
    match (bands.pop(), bands.len()) {
        (Some(only), 0) => Ok(only),
        (_, others) => Err(TerrainError::Bands { name: name.to_owned(), bands: others + 1 }),
    }
}

/// Reads a terrain file of any number of bands (a colour image has three), as [`read`] does.
///
/// # Errors
/// As [`read`], but for the number of bands.
pub fn read_bands(name: &str, bytes: &[u8]) -> Result<Vec<GridFile>, TerrainError> {
    let is_asc = name.len() >= 4 && name.as_bytes()[name.len() - 4..].eq_ignore_ascii_case(b".asc");
    match kind(bytes) {
        Kind::Tiff => geotiff::read(name, bytes),
        Kind::Ascii => Ok(vec![ascii::read(name, bytes)?]),
        Kind::Other(_) if is_asc => Ok(vec![ascii::read(name, bytes)?]),
        Kind::Other(found) => Err(TerrainError::Format { name: name.to_owned(), found }),
    }
}

enum Kind {
    Tiff,
    Ascii,
    Other(&'static str),
}

/// What the first bytes say. The names of formats that are not read help a person to convert them.
fn kind(bytes: &[u8]) -> Kind {
    let starts = |magic: &[u8]| bytes.starts_with(magic);
    if [b"II\x2a\0", b"MM\0\x2a", b"II\x2b\0", b"MM\0\x2b"].into_iter().any(|magic| starts(magic)) {
        return Kind::Tiff;
    }
    if bytes.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"ncols")) {
        return Kind::Ascii;
    }
    Kind::Other(if bytes.is_empty() {
        "an empty file"
    } else if starts(b"PDS_VERSION_ID") {
        "a PDS3 product"
    } else if starts(b"<?xml") {
        "XML (a PDS4 label?)"
    } else if starts(b"Object = IsisCube") {
        "an ISIS cube"
    } else if starts(b"\x89PNG") {
        "a PNG image"
    } else if starts(b"\x93NUMPY") {
        "a NumPy array"
    } else {
        "bytes of no format known here"
    })
}

/// The bit patterns of missing and special pixels in 32-bit ISIS and PDS3 products, and the lowest `f32`, which many
/// programs write for "none" (ISIS special pixel values, USGS).
fn is_special(value: f32) -> bool {
    (0xFF7F_FFFA..=0xFF7F_FFFF).contains(&value.to_bits())
}

/// A grid file from stored values (`None` where missing), on a grid already checked for size.
fn grid_file(
    spec: GridSpec,
    values: impl Iterator<Item = Option<f32>>,
    crs: Option<Crs>,
    about: About,
) -> Result<GridFile, TerrainError> {
    let usable = |value: f32| value.is_finite() && !is_special(value);
    let cells: Vec<Option<f32>> = values.map(|value| value.filter(|&v| usable(v))).collect();
    let known = cells.iter().map(Option::is_some).collect();
    let values = cells.iter().map(|value| value.unwrap_or(0.0)).collect();
    Ok(GridFile {
        raster: Raster::from_vec(spec, values)?,
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
