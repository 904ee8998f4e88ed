//! Where a mission's files come from: its folder, or a log that carries them.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use wisdom_grid::GridSpec;
use wisdom_terrain::format::GridReader;

use crate::MissionError;
use crate::mission::MISSION_FILE;

/// What is added to the name of a file that is too large to be carried, to name what is carried in its stead.
const REFERENCE: &str = ".reference.toml";

/// Gives the bytes of a file by its path in the mission's folder.
pub(crate) trait Supply {
    fn bytes(&mut self, relative: &str) -> Result<Vec<u8>, MissionError>;

    /// Where the file lies on disk, if it does.
    fn place(&self, relative: &str) -> Option<PathBuf>;
}

/// A mission's folder, and the mission's own file, which may have any name.
pub(crate) struct Folder<'a> {
    pub file: &'a Path,
}

impl Supply for Folder<'_> {
    fn bytes(&mut self, relative: &str) -> Result<Vec<u8>, MissionError> {
        let place = self.path(relative);
        std::fs::read(&place)
            .map_err(|error| MissionError::of_file(&place.display().to_string(), error))
    }

    fn place(&self, relative: &str) -> Option<PathBuf> {
        Some(self.path(relative))
    }
}

impl Folder<'_> {
    fn path(&self, relative: &str) -> PathBuf {
        if relative == MISSION_FILE {
            return self.file.to_path_buf();
        }
        self.file.parent().map(|folder| folder.join(relative)).unwrap_or_default()
    }
}

/// The files that a log carries.
pub(crate) struct Carried<'a>(pub &'a BTreeMap<String, Vec<u8>>);

impl Supply for Carried<'_> {
    fn bytes(&mut self, relative: &str) -> Result<Vec<u8>, MissionError> {
        self.0
            .get(relative)
            .cloned()
            .ok_or_else(|| MissionError::of_file(relative, "is not among the mission's files"))
    }

    fn place(&self, _: &str) -> Option<PathBuf> {
        None
    }
}

/// Every file a mission asks for, remembered as it was taken.
pub(crate) struct Files<'a> {
    pub supply: &'a mut dyn Supply,
    pub taken: BTreeMap<String, Vec<u8>>,
}

/// Ground that is not carried along: the file, where it is at hand, and what it is.
pub(crate) struct LargeGround {
    pub reader: Option<GridReader>,
    pub grid: GridSpec,
}

impl Files<'_> {
    /// The bytes of a file.
    pub(crate) fn bytes(&mut self, path: &str) -> Result<Vec<u8>, MissionError> {
        if let Some(bytes) = self.taken.get(path) {
            return Ok(bytes.clone());
        }
        let bytes = self.supply.bytes(path)?;
        self.taken.insert(path.to_owned(), bytes.clone());
        Ok(bytes)
    }

    /// The bytes of a file beside another one, if there is one: a label's image, a picture's side file.
    pub(crate) fn sibling(&mut self, of: &str, name: &str) -> Option<Vec<u8>> {
        let folder = of.rsplit_once('/').map_or("", |(folder, _)| folder);
        let path = if folder.is_empty() { name.to_owned() } else { format!("{folder}/{name}") };
        self.bytes(&path).ok()
    }

    /// A terrain file that stays where it is, if it is of a format that is read window by window. What is remembered of
    /// it is its digest, and where it lies.
    pub(crate) fn large_ground(&mut self, path: &str) -> Result<Option<LargeGround>, MissionError> {
        let error = |error: &dyn std::fmt::Display| MissionError::of_file(path, error);
        let carried = format!("{path}{REFERENCE}");
        let Some(place) = self.supply.place(path) else {
            let Ok(bytes) = self.bytes(&carried) else { return Ok(None) };
            let text = String::from_utf8_lossy(&bytes);
            let reference: Reference =
                toml::from_str(&text).map_err(|e| MissionError::of_toml(&carried, &text, &e))?;
            let grid = reference.grid().map_err(|e| MissionError::of_file(&carried, e))?;
            return Ok(Some(LargeGround { reader: None, grid }));
        };
        let reader = GridReader::open(&place).map_err(|e| error(&e))?;
        if !reader.reads_windows() {
            return Ok(None);
        }
        let grid = reader.spec();
        let reference = Reference {
            blake3: hex(&reader.digest().map_err(|e| error(&e))?),
            bytes: reader.length(),
            rows: grid.rows(),
            cols: grid.cols(),
            spacing_m: grid.spacing_m(),
            west_m: grid.west_m(),
            north_m: grid.north_m(),
        };
        let text = toml::to_string(&reference).map_err(|e| error(&e))?;
        self.taken.insert(carried, text.into_bytes());
        Ok(Some(LargeGround { reader: Some(reader), grid }))
    }
}

/// What is carried in the stead of ground that is too large for it.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
struct Reference {
    /// Digest of the file's bytes.
    blake3: String,
    /// Length of the file.
    bytes: u64,
    rows: usize,
    cols: usize,
    spacing_m: f64,
    west_m: f64,
    north_m: f64,
}

impl Reference {
    fn grid(&self) -> Result<GridSpec, wisdom_grid::GridError> {
        let spec = GridSpec::new(self.rows, self.cols, self.spacing_m)?;
        Ok(spec.at(self.west_m, self.north_m))
    }
}

fn hex(digest: &[u8; 32]) -> String {
    digest.iter().fold(String::new(), |text, byte| text + &format!("{byte:02x}"))
}
