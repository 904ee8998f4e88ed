//! ESRI ASCII grids: six header lines, then rows of numbers, north first.

use std::collections::BTreeMap;

use wisdom_grid::GridSpec;

use super::{About, GridFile, Siblings, check_size, damaged, file_name, grid_file, wkt};
use crate::{Crs, TerrainError};

const KEYS: [&str; 8] = [
    "ncols",
    "nrows",
    "xllcorner",
    "xllcenter",
    "yllcorner",
    "yllcenter",
    "cellsize",
    "nodata_value",
];

pub(super) fn read(
    name: &str,
    bytes: &[u8],
    siblings: &mut Siblings<'_>,
) -> Result<GridFile, TerrainError> {
    let text = std::str::from_utf8(bytes).map_err(|e| damaged(name, e.to_string()))?;
    let mut words = text.split_ascii_whitespace().peekable();
    let mut header = BTreeMap::new();
    while let Some(word) = words.next_if(|word| starts_with_letter(word)) {
        let key = word.to_ascii_lowercase();
        let Some(&key) = KEYS.iter().find(|known| **known == key) else {
            return Err(damaged(name, format!("header word {word:?}; known are {KEYS:?}")));
        };
        let value = words.next().unwrap_or("nothing");
        let number = value
            .parse::<f64>()
            .map_err(|_| damaged(name, format!("{key} is {value:?}; a number is wanted")))?;
        if header.insert(key, number).is_some() {
            return Err(damaged(name, format!("{key} is given twice")));
        }
    }
    let spec = place(name, &header)?;
    let values = numbers(name, words, spec, header.get("nodata_value").copied())?;
    let about = About {
        format: "ESRI ASCII grid",
        storage: "text".to_owned(),
        nodata: header.get("nodata_value").map(f64::to_string),
        scale: 1.0,
        offset: 0.0,
    };
    grid_file(spec, values.into_iter(), crs(name, siblings)?, about)
}

/// What the `.prj` of the same stem says, if there is one.
fn crs(name: &str, siblings: &mut Siblings<'_>) -> Result<Option<Crs>, TerrainError> {
    let name = file_name(name);
    let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
    let files = [format!("{stem}.prj"), format!("{stem}.PRJ")];
    let found = files.iter().find_map(|file| Some((file, siblings.find(file)?)));
    found.map_or(Ok(None), |(file, bytes)| wkt::crs(file, &bytes))
}

/// A letter that begins a header word, not a number such as `nan` or `inf`.
fn starts_with_letter(word: &str) -> bool {
    word.starts_with(|c: char| c.is_ascii_alphabetic()) && word.parse::<f64>().is_err()
}

fn place(name: &str, header: &BTreeMap<&str, f64>) -> Result<GridSpec, TerrainError> {
    let need = |key: &str| {
        header.get(key).copied().ok_or_else(|| damaged(name, format!("no {key} in its header")))
    };
    let side = |key: &str| {
        let value = need(key)?;
        if value.fract() == 0.0 && (1.0..=wisdom_grid::MAX_SIDE as f64).contains(&value) {
            return Ok(value as usize);
        }
        let limit = wisdom_grid::MAX_SIDE;
        Err(damaged(name, format!("{key} is {value}; a whole number from 1 to {limit} is wanted")))
    };
    let (rows, cols, spacing_m) = (side("nrows")?, side("ncols")?, need("cellsize")?);
    check_size(name, rows, cols)?;
    let spec = GridSpec::new(rows, cols, spacing_m)?;
    let edge = |corner: &str, centre: &str| match header.get(centre) {
        Some(centre) => Ok(centre - spacing_m / 2.0),
        None => need(corner),
    };
    let (west_m, south_m) = (edge("xllcorner", "xllcenter")?, edge("yllcorner", "yllcenter")?);
    if !(west_m.is_finite() && south_m.is_finite()) {
        return Err(damaged(name, format!("its corner is at ({west_m}, {south_m})")));
    }
    Ok(spec.at(west_m, south_m + rows as f64 * spacing_m))
}

/// Exactly as many numbers as there are cells. Room is made as they come: a header alone reserves nothing.
fn numbers<'a>(
    name: &str,
    words: impl Iterator<Item = &'a str>,
    spec: GridSpec,
    nodata: Option<f64>,
) -> Result<Vec<Option<f32>>, TerrainError> {
    let mut values = Vec::new();
    for word in words {
        let number: f64 = word
            .parse()
            .map_err(|_| damaged(name, format!("value {} is {word:?}", values.len() + 1)))?;
        values.push((nodata != Some(number)).then_some(number as f32));
        if values.len() > spec.len() {
            break;
        }
    }
    if values.len() == spec.len() {
        return Ok(values);
    }
    let found = if values.len() > spec.len() { "more" } else { "fewer" };
    Err(damaged(name, format!("{found} values than {} x {}", spec.rows(), spec.cols())))
}
