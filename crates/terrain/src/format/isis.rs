//! ISIS cubes: a label in the Parameter Value Language and band-sequential or tiled pixels (USGS ISIS 3, "Cube format").

use wisdom_grid::GridSpec;

use super::map::{Map, metres};
use super::pvl::{Label, Section};
use super::raw::{Array, Missing, Number, Order, Sample};
use super::{GridFile, Siblings, check_size, damaged};
use crate::{Crs, TerrainError};

pub(super) fn read(
    name: &str,
    bytes: &[u8],
    siblings: &mut Siblings<'_>,
) -> Result<Vec<GridFile>, TerrainError> {
    let label = Label::of(name, bytes)?;
    let block = |wanted: &str| {
        label.block(wanted).ok_or_else(|| damaged(name, format!("no {wanted} in its label")))
    };
    let (core, pixels) = (block("Core")?, block("Pixels")?);
    let sides = block("Dimensions")?;
    let (rows, cols) =
        (sides.need_whole("Lines", 1)? as usize, sides.need_whole("Samples", 1)? as usize);
    check_size(name, rows, cols)?;
    let (spec, crs) = place(block("Mapping")?, rows, cols)?;
    let bands = sides.whole("Bands", 1)?.unwrap_or(1);
    let array = array(core, pixels, [bands, rows as u64, cols as u64])?;
    match core.find("^Core").or_else(|| label.root().find("^Core")) {
        None => array.read(name, bytes, spec, Some(&crs)),
        Some(file) => {
            let file = file.text();
            array.read(file, &siblings.need(name, file)?, spec, Some(&crs))
        }
    }
}

fn array(
    core: Section<'_, '_>,
    pixels: Section<'_, '_>,
    [bands, rows, cols]: [u64; 3],
) -> Result<Array, TerrainError> {
    let kind = pixels.need("Type")?;
    let (number, valid) = match &kind.text().to_ascii_lowercase()[..] {
        "real" => (Number::F32, None),
        // Special pixels are the lowest doubles, beyond what a cell of f32 can hold: unknown in any case.
        "double" => (Number::F64, None),
        // The rest is special (USGS ISIS, `SpecialPixel.h`).
        "unsignedbyte" => (Number::U8, Some((1.0, 254.0))),
        "signedword" => (Number::I16, Some((-32_752.0, 32_767.0))),
        "unsignedword" => (Number::U16, Some((3.0, 65_522.0))),
        _ => {
            let wanted = "Real, Double, SignedWord, UnsignedWord or UnsignedByte";
            return Err(pixels.wrong(kind, wanted));
        }
    };
    let big_endian = match pixels.find("ByteOrder") {
        None => false,
        Some(order) if order.text().eq_ignore_ascii_case("lsb") => false,
        Some(order) if order.text().eq_ignore_ascii_case("msb") => true,
        Some(order) => return Err(pixels.wrong(order, "Lsb or Msb")),
    };
    let sample = Sample { number, big_endian };
    let size = sample.bytes() as u64;
    let format = core.need("Format")?;
    let (layout, order) = match &format.text().to_ascii_lowercase()[..] {
        "bandsequential" => {
            let row = cols.saturating_mul(size);
            let band = row.saturating_mul(rows);
            ("band after band".to_owned(), Order::Steps { band, row, col: size })
        }
        "tile" => {
            let (high, wide) =
                (core.need_whole("TileLines", 1)?, core.need_whole("TileSamples", 1)?);
            (format!("tiles of {high} x {wide}"), Order::Tiles { rows: high, cols: wide })
        }
        _ => return Err(core.wrong(format, "BandSequential or Tile")),
    };
    Ok(Array {
        layout,
        bands: bands as usize,
        start: core.whole("StartByte", 1)?.unwrap_or(1) - 1,
        order,
        missing: Missing { values: Vec::new(), valid },
        nodata: Some("ISIS special pixels".to_owned()),
        scale: pixels.number("Multiplier")?.unwrap_or(1.0),
        offset: pixels.number("Base")?.unwrap_or(0.0),
        ..Array::plain("ISIS cube", sample, cols as usize)
    })
}

/// The grid and its map: the corner is the outer one of the first pixel.
fn place(map: Section<'_, '_>, rows: usize, cols: usize) -> Result<(GridSpec, Crs), TerrainError> {
    let length = |key: &str| {
        let entry = map.need(key)?;
        let unit = if entry.unit().is_empty() { Some(1.0) } else { metres(entry.unit()) };
        let wrong = || map.wrong(entry, "a length in <meters>");
        let found = map.need_number(key)? * unit.ok_or_else(wrong)?;
        if found.is_finite() { Ok(found) } else { Err(wrong()) }
    };
    let radius = |key: &str| match map.find(key) {
        None => Ok(None),
        Some(_) => match length(key)? {
            radius if radius > 0.0 => Ok(Some(radius)),
            _ => Err(map.wrong(map.need(key)?, "a positive radius")),
        },
    };
    let spacing_m = length("PixelResolution")?;
    let spec = GridSpec::new(rows, cols, spacing_m)?
        .at(length("UpperLeftCornerX")?, length("UpperLeftCornerY")?);
    if let Some(turn) = map.find("Rotation")
        && map.number("Rotation")? != Some(0.0)
    {
        return Err(map.wrong(turn, "a grid with north up, 0,"));
    }
    let degrees = |key| Ok::<f64, TerrainError>(map.number(key)?.unwrap_or(0.0));
    let is = |key, word: &str| map.text(key).is_some_and(|text| text.eq_ignore_ascii_case(word));
    let facts = Map {
        target: map.text("TargetName").unwrap_or(""),
        projection: map.text("ProjectionName").unwrap_or(""),
        radius_m: radius("EquatorialRadius")?,
        polar_radius_m: radius("PolarRadius")?,
        centre_lon_deg: degrees("CenterLongitude")?,
        true_lat_deg: degrees("CenterLatitude")?,
        origin_lat_deg: 0.0,
        scale_at_pole: None,
        west_positive: is("LongitudeDirection", "PositiveWest"),
        planetocentric: !is("LatitudeType", "Planetographic"),
    };
    Ok((spec, facts.crs()))
}
