//! Side files: what an image or a bare array does not say of itself, in `NAME.toml` beside `NAME`.

use serde::Deserialize;
use wisdom_grid::GridSpec;

use super::{Siblings, damaged, file_name};
use crate::{Crs, Projection, TerrainError};

/// The longest side file that is read.
const MAX_BYTES: usize = 1 << 16;

/// The keys of a side file.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(super) struct Side {
    pub(super) spacing_m: Option<f64>,
    pub(super) west_m: Option<f64>,
    pub(super) north_m: Option<f64>,
    pub(super) scale: Option<f64>,
    pub(super) offset: Option<f64>,
    pub(super) nodata: Option<f64>,
    pub(super) body_radius_m: Option<f64>,
}

impl Side {
    /// The side file of a file, if there is one; else one without any key.
    pub(super) fn of(name: &str, siblings: &mut Siblings<'_>) -> Result<Self, TerrainError> {
        let file = format!("{}.toml", file_name(name));
        let Some(bytes) = siblings.find(&file) else { return Ok(Self::default()) };
        if bytes.len() > MAX_BYTES {
            let found = bytes.len();
            return Err(damaged(
                &file,
                format!("it has {found} bytes; at most {MAX_BYTES} are read"),
            ));
        }
        let text = std::str::from_utf8(&bytes).map_err(|e| damaged(&file, e.to_string()))?;
        let side: Self = toml::from_str(text).map_err(|error| {
            let start = error.span().map_or(0, |span| span.start);
            let line = 1 + text.bytes().take(start).filter(|&byte| byte == b'\n').count();
            damaged(&file, format!("line {line}: {}", error.message()))
        })?;
        side.check(&file)?;
        Ok(side)
    }

    fn check(&self, file: &str) -> Result<(), TerrainError> {
        let finite = [
            ("spacing-m", self.spacing_m),
            ("west-m", self.west_m),
            ("north-m", self.north_m),
            ("scale", self.scale),
            ("offset", self.offset),
            ("body-radius-m", self.body_radius_m),
        ];
        for (key, number) in finite {
            let positive = matches!(key, "spacing-m" | "body-radius-m");
            if let Some(x) = number.filter(|&x| !x.is_finite() || positive && x <= 0.0) {
                let wanted = if positive { "a positive number" } else { "a finite number" };
                return Err(damaged(file, format!("{key} is {x}; {wanted} is wanted")));
            }
        }
        if self.scale == Some(0.0) {
            return Err(damaged(file, "scale is 0; every height would be the same".to_owned()));
        }
        if self.west_m.is_some() != self.north_m.is_some() {
            let reason = "west-m and north-m make one corner: both or none are wanted";
            return Err(damaged(file, reason.to_owned()));
        }
        Ok(())
    }

    /// The grid: cells of 1 m with their south-west corner at the origin, where the keys do not say otherwise.
    pub(super) fn grid(&self, rows: usize, cols: usize) -> Result<GridSpec, TerrainError> {
        let plain = GridSpec::new(rows, cols, self.spacing_m.unwrap_or(1.0))?;
        Ok(plain.at(self.west_m.unwrap_or(plain.west_m()), self.north_m.unwrap_or(plain.north_m())))
    }

    /// A local plane on the body, if its radius is known.
    pub(super) fn crs(&self) -> Option<Crs> {
        let radius_m = self.body_radius_m?;
        Some(Crs {
            name: String::new(),
            body: String::new(),
            radius_m: Some(radius_m),
            polar_radius_m: None,
            projection: Projection::Local,
        })
    }
}
