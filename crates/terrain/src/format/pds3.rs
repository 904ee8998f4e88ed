//! PDS3 images: an attached or detached label and an array of samples (PDS Standards Reference 3.8, appendix A).

use wisdom_grid::GridSpec;

use super::map::{Map, metres};
use super::pvl::{Entry, Label, Section};
use super::raw::{Array, Missing, Number, Order, Sample};
use super::{GridFile, Siblings, check_size, damaged};
use crate::{Crs, TerrainError};

/// Keys of stored values that are no reading.
const MISSING: [&str; 11] = [
    "MISSING_CONSTANT",
    "MISSING",
    "INVALID_CONSTANT",
    "UNKNOWN_CONSTANT",
    "NOT_APPLICABLE_CONSTANT",
    "NULL_CONSTANT",
    "CORE_NULL",
    "CORE_LOW_REPR_SATURATION",
    "CORE_LOW_INSTR_SATURATION",
    "CORE_HIGH_REPR_SATURATION",
    "CORE_HIGH_INSTR_SATURATION",
];

/// What a label writes for "there is no such value".
const NOTHING: [&str; 5] = ["N/A", "NA", "NULL", "UNK", "NONE"];

pub(super) fn read(
    name: &str,
    bytes: &[u8],
    siblings: &mut Siblings<'_>,
) -> Result<Vec<GridFile>, TerrainError> {
    let label = Label::of(name, bytes)?;
    let image = label
        .block("IMAGE")
        .or_else(|| label.block_where(|block| block.to_ascii_uppercase().ends_with("_IMAGE")))
        .ok_or_else(|| damaged(name, "no IMAGE object in its label".to_owned()))?;
    let rows = image.need_whole("LINES", 1)? as usize;
    let cols = image.need_whole("LINE_SAMPLES", 1)? as usize;
    check_size(name, rows, cols)?;
    let map = label
        .block("IMAGE_MAP_PROJECTION")
        .or_else(|| {
            label.block_where(|block| block.to_ascii_uppercase().ends_with("MAP_PROJECTION"))
        })
        .ok_or_else(|| damaged(name, "no IMAGE_MAP_PROJECTION in its label".to_owned()))?;
    let (spec, crs) = place(map, rows, cols)?;
    let data = Data::of(&label, image)?;
    let array = array(image, cols, data.start)?;
    match data.file {
        None => array.read(name, bytes, spec, Some(&crs)),
        Some(file) => {
            let bytes = siblings.need(name, &file)?;
            array.read(&file, &bytes, spec, Some(&crs))
        }
    }
}

/// Where the samples are: the bytes before them and the file, if it is not the label's own.
struct Data {
    file: Option<String>,
    start: u64,
}

impl Data {
    /// What `^IMAGE` says: a record or `<BYTES>` counted from 1, a file, or both.
    fn of(label: &Label<'_>, image: Section<'_, '_>) -> Result<Self, TerrainError> {
        let key = format!("^{}", image.name());
        let place =
            [image.outer(), label.root()].into_iter().find(|place| place.find(&key).is_some());
        let place = place.unwrap_or(label.root());
        let entry = place.need(&key)?;
        let wrong =
            || place.wrong(entry, "a record, a number of <BYTES>, a file, or (file, record)");
        let members = entry.members();
        let (file, position) = match (&members[..], entry.is_quoted()) {
            ([position], false) if position.0.parse::<u64>().is_ok() => (None, Some(*position)),
            ([(file, _)], _) => (Some(*file), None),
            ([(file, _), position], _) => (Some(*file), Some(*position)),
            _ => return Err(wrong()),
        };
        let start = match position {
            None => 0,
            Some((number, unit)) => {
                let number = number.parse::<u64>().ok().filter(|&n| n > 0).ok_or_else(wrong)?;
                match &unit.to_ascii_uppercase()[..] {
                    "BYTES" | "BYTE" => number - 1,
                    "" => {
                        let record = place.whole("RECORD_BYTES", 1)?;
                        let record =
                            record.map_or_else(|| label.root().need_whole("RECORD_BYTES", 1), Ok);
                        // Beyond 64 bits is beyond the file's end, which is found later.
                        (number - 1).saturating_mul(record?)
                    }
                    _ => return Err(wrong()),
                }
            }
        };
        Ok(Self { file: file.map(str::to_owned), start })
    }
}

fn array(image: Section<'_, '_>, cols: usize, start: u64) -> Result<Array, TerrainError> {
    let sample = sample(image)?;
    let bands = image.whole("BANDS", 1)?.unwrap_or(1);
    let rows = image.need_whole("LINES", 1)?;
    let size = sample.bytes() as u64;
    let extra = |key| Ok::<u64, TerrainError>(image.whole(key, 0)?.unwrap_or(0));
    let around = extra("LINE_PREFIX_BYTES")? + extra("LINE_SUFFIX_BYTES")?;
    let line = cols as u64 * size;
    let storage = image.find("BAND_STORAGE_TYPE").filter(|_| bands > 1);
    let (layout, order) =
        match &storage.map_or("", Entry::text).to_ascii_uppercase().replace(' ', "_")[..] {
            "" | "BAND_SEQUENTIAL" => {
                let row = line + around;
                ("band after band", Order::Steps { band: rows.saturating_mul(row), row, col: size })
            }
            "LINE_INTERLEAVED" => {
                let band = line + around;
                (
                    "bands line by line",
                    Order::Steps { band, row: band.saturating_mul(bands), col: size },
                )
            }
            "SAMPLE_INTERLEAVED" => {
                let col = size.saturating_mul(bands);
                let row = (cols as u64).saturating_mul(col).saturating_add(around);
                ("bands sample by sample", Order::Steps { band: size, row, col })
            }
            _ => {
                let entry = storage.expect("an absent key is band sequential");
                let wanted = "BAND_SEQUENTIAL, LINE_INTERLEAVED or SAMPLE_INTERLEAVED";
                return Err(image.wrong(entry, wanted));
            }
        };
    for (key, usual) in [("LINE_DISPLAY_DIRECTION", "DOWN"), ("SAMPLE_DISPLAY_DIRECTION", "RIGHT")]
    {
        if let Some(entry) =
            image.find(key).filter(|entry| !entry.text().eq_ignore_ascii_case(usual))
        {
            return Err(image.wrong(entry, usual));
        }
    }
    let (missing, nodata) = missing(image, sample)?;
    Ok(Array {
        layout: if bands > 1 { layout.to_owned() } else { String::new() },
        bands: bands as usize,
        start: start.saturating_add(extra("LINE_PREFIX_BYTES")?),
        order,
        missing,
        nodata,
        scale: image.number("SCALING_FACTOR")?.unwrap_or(1.0),
        offset: image.number("OFFSET")?.unwrap_or(0.0),
        ..Array::plain("PDS3 image", sample, cols)
    })
}

/// `SAMPLE_TYPE` and `SAMPLE_BITS` (PDS Standards Reference 3.8, appendix C).
fn sample(image: Section<'_, '_>) -> Result<Sample, TerrainError> {
    let (kind, bits) = (image.need("SAMPLE_TYPE")?, image.need_whole("SAMPLE_BITS", 1)?);
    let word = kind.text().to_ascii_uppercase().replace(' ', "_");
    let (big_endian, kind_of) = match &word[..] {
        "PC_REAL" => (false, "REAL"),
        "IEEE_REAL" | "REAL" | "FLOAT" | "SUN_REAL" | "MAC_REAL" => (true, "REAL"),
        "LSB_INTEGER" | "PC_INTEGER" | "VAX_INTEGER" => (false, "INTEGER"),
        "MSB_INTEGER" | "INTEGER" | "SUN_INTEGER" | "MAC_INTEGER" => (true, "INTEGER"),
        "LSB_UNSIGNED_INTEGER" | "PC_UNSIGNED_INTEGER" | "VAX_UNSIGNED_INTEGER" => {
            (false, "UNSIGNED")
        }
        "MSB_UNSIGNED_INTEGER"
        | "UNSIGNED_INTEGER"
        | "SUN_UNSIGNED_INTEGER"
        | "MAC_UNSIGNED_INTEGER" => (true, "UNSIGNED"),
        _ => {
            let wanted = "PC_REAL, IEEE_REAL, or LSB_ or MSB_ with INTEGER or UNSIGNED_INTEGER";
            return Err(image.wrong(kind, wanted));
        }
    };
    let number = match (kind_of, bits) {
        ("REAL", 32) => Number::F32,
        ("REAL", 64) => Number::F64,
        ("INTEGER", 8) => Number::I8,
        ("INTEGER", 16) => Number::I16,
        ("INTEGER", 32) => Number::I32,
        ("UNSIGNED", 8) => Number::U8,
        ("UNSIGNED", 16) => Number::U16,
        ("UNSIGNED", 32) => Number::U32,
        _ => {
            let wanted = if kind_of == "REAL" { "32 or 64" } else { "8, 16 or 32" };
            return Err(image.wrong(image.need("SAMPLE_BITS")?, wanted));
        }
    };
    Ok(Sample { number, big_endian })
}

/// The stored values that are none, and the first of them as it is written.
fn missing(
    image: Section<'_, '_>,
    sample: Sample,
) -> Result<(Missing, Option<String>), TerrainError> {
    let (mut values, mut words) = (Vec::new(), None);
    for entry in MISSING.iter().filter_map(|key| image.find(key)) {
        for (text, _) in entry.members() {
            if NOTHING.iter().any(|nothing| text.eq_ignore_ascii_case(nothing)) {
                continue;
            }
            let wanted = "a number or bits such as 16#FF7FFFFB#";
            values.push(sample.constant(text).ok_or_else(|| image.wrong(entry, wanted))?);
            words.get_or_insert_with(|| text.to_owned());
        }
    }
    Ok((Missing { values, valid: None }, words))
}

/// The grid and its map. A projection offset counts lines or samples from the centre of the first to the map's origin.
fn place(map: Section<'_, '_>, rows: usize, cols: usize) -> Result<(GridSpec, Crs), TerrainError> {
    let scale = map.need("MAP_SCALE")?;
    let unit = metres(scale.unit())
        .ok_or_else(|| map.wrong(scale, "a scale in <M/PIXEL> or <KM/PIXEL>"))?;
    let spacing_m = map.need_number("MAP_SCALE")? * unit;
    if !(spacing_m.is_finite() && spacing_m > 0.0) {
        return Err(map.wrong(scale, "a positive scale"));
    }
    if let Some(turn) = map.find("MAP_PROJECTION_ROTATION") {
        let words = NOTHING.iter().any(|nothing| turn.text().eq_ignore_ascii_case(nothing));
        if !words && map.number("MAP_PROJECTION_ROTATION")? != Some(0.0) {
            return Err(map.wrong(turn, "a grid with north up, 0,"));
        }
    }
    let line = map.need_number("LINE_PROJECTION_OFFSET")?;
    let sample = map.need_number("SAMPLE_PROJECTION_OFFSET")?;
    let (west, north) = (-(sample + 0.5) * spacing_m, (line + 0.5) * spacing_m);
    let spec = GridSpec::new(rows, cols, spacing_m)?.at(west, north);
    if !(west.is_finite() && north.is_finite()) {
        return Err(map.wrong(map.need("LINE_PROJECTION_OFFSET")?, "a place on the map"));
    }
    let degrees = |key| Ok::<f64, TerrainError>(map.number(key)?.unwrap_or(0.0));
    let is = |key, word: &str| map.text(key).is_some_and(|text| text.eq_ignore_ascii_case(word));
    let facts = Map {
        target: "",
        projection: map.text("MAP_PROJECTION_TYPE").unwrap_or(""),
        radius_m: radius(map, "A_AXIS_RADIUS")?,
        polar_radius_m: radius(map, "C_AXIS_RADIUS")?,
        centre_lon_deg: degrees("CENTER_LONGITUDE")?,
        true_lat_deg: degrees("CENTER_LATITUDE")?,
        origin_lat_deg: 0.0,
        scale_at_pole: None,
        west_positive: is("POSITIVE_LONGITUDE_DIRECTION", "WEST"),
        planetocentric: !is("COORDINATE_SYSTEM_NAME", "PLANETOGRAPHIC"),
    };
    Ok((spec, facts.crs()))
}

/// A radius in metres; kilometres where no unit is given, as the data dictionary has it.
fn radius(map: Section<'_, '_>, key: &str) -> Result<Option<f64>, TerrainError> {
    let Some(entry) = map.find(key) else { return Ok(None) };
    let unit = if entry.unit().is_empty() { Some(1000.0) } else { metres(entry.unit()) };
    let wrong = || map.wrong(entry, "a positive radius in <KM> or <M>");
    let length = map.number(key)?.zip(unit).map(|(number, unit)| number * unit);
    length.filter(|radius| radius.is_finite() && *radius > 0.0).ok_or_else(wrong).map(Some)
}
