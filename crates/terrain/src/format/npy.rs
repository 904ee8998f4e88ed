//! `NumPy` arrays of two axes (NEP 1, format versions 1 to 3), with a side file if one is there.

use super::pvl::shorten;
use super::raw::{Array, Missing, Number, Order, Sample};
use super::side::Side;
use super::{GridFile, Siblings, check_size, damaged};
use crate::TerrainError;

/// The longest header that is read; that of two plain axes has 118 bytes.
const MAX_HEADER: usize = 1 << 16;

pub(super) fn read(
    name: &str,
    bytes: &[u8],
    siblings: &mut Siblings<'_>,
) -> Result<GridFile, TerrainError> {
    let (header, start) = header(name, bytes)?;
    let descr = value(name, header, "descr")?;
    let sample = sample(descr).ok_or_else(|| {
        let wanted = "an integer of 1, 2, 4 or 8 bytes or a float of 4 or 8";
        damaged(name, format!("descr is {}; {wanted} is wanted", shorten(descr)))
    })?;
    let columns_first = match value(name, header, "fortran_order")? {
        "True" => true,
        "False" => false,
        found => {
            let found = shorten(found);
            return Err(damaged(
                name,
                format!("fortran_order is {found}; True or False is wanted"),
            ));
        }
    };
    let (rows, cols) = shape(name, value(name, header, "shape")?)?;
    check_size(name, rows, cols)?;
    let side = Side::of(name, siblings)?;
    let size = sample.bytes() as u64;
    let order = if columns_first {
        Order::Steps { band: 0, row: size, col: rows as u64 * size }
    } else {
        Order::Steps { band: 0, row: cols as u64 * size, col: size }
    };
    let array = Array {
        layout: if columns_first { "column after column".to_owned() } else { String::new() },
        start: start as u64,
        order,
        missing: Missing { values: side.nodata.into_iter().collect(), valid: None },
        nodata: side.nodata.map(|none| none.to_string()),
        scale: side.scale.unwrap_or(1.0),
        offset: side.offset.unwrap_or(0.0),
        ..Array::plain("NumPy array", sample, cols)
    };
    let mut bands = array.read(name, bytes, side.grid(rows, cols)?, side.crs().as_ref())?;
    Ok(bands.pop().expect("an array of one band"))
}

/// The header's text and where the samples begin.
fn header<'a>(name: &str, bytes: &'a [u8]) -> Result<(&'a str, usize), TerrainError> {
    let (length, from) = match *bytes {
        [_, _, _, _, _, _, 1, _, a, b, ..] => (usize::from(u16::from_le_bytes([a, b])), 10),
        [_, _, _, _, _, _, 2 | 3, _, a, b, c, d, ..] => {
            (u32::from_le_bytes([a, b, c, d]) as usize, 12)
        }
        _ => {
            let found = bytes.get(6).map_or("none".to_owned(), u8::to_string);
            return Err(damaged(name, format!("its format version is {found}; 1 to 3 are read")));
        }
    };
    let text = Some(length)
        .filter(|&length| length <= MAX_HEADER)
        .and_then(|length| bytes.get(from..from + length))
        .and_then(|text| std::str::from_utf8(text).ok());
    let text = text.ok_or_else(|| {
        let found = bytes.len();
        damaged(name, format!("a text header of {length} bytes is not in its {found} bytes"))
    })?;
    Ok((text, from + length))
}

/// What stands behind `'key':`, up to the comma after it; parentheses and quotes are kept together.
fn value<'a>(name: &str, header: &'a str, key: &str) -> Result<&'a str, TerrainError> {
    let missing = || damaged(name, format!("no {key} in its header"));
    let (_, rest) = header.split_once(&format!("'{key}'")).ok_or_else(missing)?;
    let rest = rest.trim_start().strip_prefix(':').ok_or_else(missing)?.trim_start();
    let end = match rest.strip_prefix('(') {
        Some(inner) => inner.find(')').ok_or_else(missing)? + 2,
        None => rest.find([',', '}']).ok_or_else(missing)?,
    };
    Ok(rest[..end].trim_end())
}

fn shape(name: &str, text: &str) -> Result<(usize, usize), TerrainError> {
    let inner = text.trim_matches(['(', ')']);
    let sides = inner.split(',').map(str::trim).filter(|side| !side.is_empty()).take(3);
    let sides: Option<Vec<u32>> = sides.map(|side| side.parse().ok()).collect();
    match sides.as_deref() {
        Some(&[rows, cols]) => Ok((rows as usize, cols as usize)),
        _ => Err(damaged(name, format!("shape is {}; (rows, columns) is wanted", shorten(text)))),
    }
}

fn sample(descr: &str) -> Option<Sample> {
    let text = descr.strip_prefix('\'')?.strip_suffix('\'')?;
    let order = text.chars().next()?;
    let number = match &text[order.len_utf8()..] {
        "u1" => Number::U8,
        "i1" => Number::I8,
        "u2" => Number::U16,
        "i2" => Number::I16,
        "u4" => Number::U32,
        "i4" => Number::I32,
        "u8" => Number::U64,
        "i8" => Number::I64,
        "f4" => Number::F32,
        "f8" => Number::F64,
        _ => return None,
    };
    let sample = Sample { number, big_endian: order == '>' };
    (matches!(order, '<' | '>') || order == '|' && sample.bytes() == 1).then_some(sample)
}
