//! Grey PNG images of 8 or 16 bits with a side file, as simulators write heights.

use std::io::Cursor;

use png::{BitDepth, ColorType, DecodeOptions, Decoder, Limits, Transformations};

use super::raw::{Array, Missing, Number, Sample};
use super::side::Side;
use super::{GridFile, Siblings, check_size, damaged, file_name};
use crate::TerrainError;

/// Deflate (RFC 1951) makes at most 258 bytes of 2 bits: a short file cannot hold a large image.
const MOST_INFLATION: usize = 1032;

/// What the decoder may use beside the image: some rows, and chunks that say nothing of heights.
const DECODER_BYTES: usize = 1 << 22;

pub(super) fn read(
    name: &str,
    bytes: &[u8],
    siblings: &mut Siblings<'_>,
) -> Result<GridFile, TerrainError> {
    let fail = |error: png::DecodingError| damaged(name, error.to_string());
    let mut options = DecodeOptions::default();
    options.set_ignore_text_chunk(true);
    options.set_ignore_iccp_chunk(true);
    let mut decoder = Decoder::new_with_options(Cursor::new(bytes), options);
    decoder.set_limits(Limits { bytes: DECODER_BYTES });
    decoder.set_transformations(Transformations::IDENTITY);
    let info = decoder.read_header_info().map_err(fail)?;
    let (rows, cols) = (info.height as usize, info.width as usize);
    let number = match (info.color_type, info.bit_depth) {
        (ColorType::Grayscale, BitDepth::Sixteen) => Number::U16,
        (ColorType::Grayscale, BitDepth::Eight) => Number::U8,
        (colour, depth) => {
            let found = format!("{colour:?} of {} bits", depth as u8);
            return Err(damaged(name, format!("it is {found}; grey of 8 or 16 bits is wanted")));
        }
    };
    check_size(name, rows, cols)?;
    let sample = Sample { number, big_endian: true };
    let size = rows * cols * sample.bytes();
    if size / MOST_INFLATION > bytes.len() {
        let found = bytes.len();
        return Err(damaged(name, format!("{found} bytes cannot hold {rows} x {cols} cells")));
    }
    let side = Side::of(name, siblings)?;
    if side.spacing_m.is_none() {
        let side = format!("{}.toml", file_name(name));
        let wanted =
            format!("an image needs a side file {side} with spacing-m, the size of a cell");
        return Err(damaged(name, format!("the spacing of its cells is not known; {wanted}")));
    }
    let mut image = decoder.read_info().map_err(fail)?;
    let mut pixels = vec![0; size];
    if image.output_buffer_size() != Some(size) {
        return Err(damaged(name, format!("its image has not {size} bytes")));
    }
    image.next_frame(&mut pixels).map_err(fail)?;
    let array = Array {
        layout: "deflate".to_owned(),
        missing: Missing { values: side.nodata.into_iter().collect(), valid: None },
        nodata: side.nodata.map(|none| none.to_string()),
        scale: side.scale.unwrap_or(1.0),
        offset: side.offset.unwrap_or(0.0),
        ..Array::plain("PNG image", sample, cols)
    };
    let mut bands = array.read(name, &pixels, side.grid(rows, cols)?, side.crs().as_ref())?;
    Ok(bands.pop().expect("an array of one band"))
}
