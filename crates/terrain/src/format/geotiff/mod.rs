//! GeoTIFF: pixels by the `tiff` crate, their place by the tags of the OGC GeoTIFF standard 1.1 and GDAL's own.

mod header;
mod read;
pub(super) mod write;

use std::io::Cursor;

pub(super) use read::{Chunk, Facts, Image};

use super::{GridFile, check_size};
use crate::TerrainError;

/// Reads a whole file: every strip or tile once.
pub(super) fn read(name: &str, bytes: &[u8]) -> Result<Vec<GridFile>, TerrainError> {
    let sized = |rows, cols| check_size(name, rows, cols);
    let (facts, mut image) = Image::open(name, Cursor::new(bytes), bytes.len() as u64, sized)?;
    let whole = facts.spec.window();
    facts.gather(whole, |chunk| image.chunk(&facts, chunk))
}

/// Tag numbers: TIFF 6.0, GeoTIFF 1.1 and GDAL.
mod tag {
    pub(super) const IMAGE_WIDTH: u16 = 256;
    pub(super) const IMAGE_LENGTH: u16 = 257;
    pub(super) const BITS_PER_SAMPLE: u16 = 258;
    pub(super) const COMPRESSION: u16 = 259;
    pub(super) const PHOTOMETRIC: u16 = 262;
    pub(super) const STRIP_OFFSETS: u16 = 273;
    pub(super) const SAMPLES_PER_PIXEL: u16 = 277;
    pub(super) const ROWS_PER_STRIP: u16 = 278;
    pub(super) const STRIP_BYTE_COUNTS: u16 = 279;
    pub(super) const PLANAR_CONFIGURATION: u16 = 284;
    pub(super) const PREDICTOR: u16 = 317;
    pub(super) const TILE_WIDTH: u16 = 322;
    pub(super) const TILE_LENGTH: u16 = 323;
    pub(super) const TILE_OFFSETS: u16 = 324;
    pub(super) const TILE_BYTE_COUNTS: u16 = 325;
    pub(super) const EXTRA_SAMPLES: u16 = 338;
    pub(super) const SAMPLE_FORMAT: u16 = 339;
    pub(super) const JPEG_TABLES: u16 = 347;
    pub(super) const CHROMA_SUBSAMPLING: u16 = 530;
    pub(super) const PIXEL_SCALE: u16 = 33550;
    pub(super) const TIE_POINT: u16 = 33922;
    pub(super) const TRANSFORMATION: u16 = 34264;
    pub(super) const GEO_KEYS: u16 = 34735;
    pub(super) const GEO_DOUBLES: u16 = 34736;
    pub(super) const GEO_ASCII: u16 = 34737;
    pub(super) const GDAL_METADATA: u16 = 42112;
    pub(super) const GDAL_NODATA: u16 = 42113;
}
