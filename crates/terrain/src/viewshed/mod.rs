//! What a camera on a mast can see of the ground (paper section IV, Fig. 3).
//!
//! Observer and target stand over cell centres. Wherever the sight line between them crosses a line of the grid
//! that joins cell centres, it is compared with the ground there, interpolated between the two cells beside the
//! crossing; the target is hidden when the ground at any crossing is strictly above the line. Crossings next to
//! unknown ground are skipped: what no one has seen blocks no one's view. The test is made on whole multiples of the heights, without
//! division, so that a line that just grazes the ground is not a matter of rounding.
//!
//! [`viewshed`] answers by that definition to the last cell. [`viewshed_fast`] carries a sampled horizon
//! outwards instead, which is many times faster and wrong at the ragged edges of shadows.

use std::fmt;
use std::str::FromStr;

use wisdom_grid::{Cell, Window};

use crate::Layer;

mod exact;
mod fan;
mod fast;
mod horizon;
mod sight;

use fan::Limits;
use sight::Sight;

/// A camera and the limits of its sight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observer {
    /// The cell it stands on.
    pub cell: Cell,
    /// Height of the camera above the ground there, metres.
    pub height_m: f64,
    /// Farthest distance between cell centres at which it sees, metres; `None` for no limit.
    pub range_m: Option<f64>,
    /// Height above its ground at which a target counts as seen, metres.
    pub target_height_m: f64,
    /// Radius of a round body, metres: ground at distance d drops by d²/2R before anything else. `None` for a plane.
    pub body_radius_m: Option<f64>,
    /// The sector it looks at; `None` for all around.
    pub field_of_view: Option<FieldOfView>,
}

impl Observer {
    /// A camera that looks all around at bare ground on a plane, without a limit of range: the paper's.
    #[must_use]
    pub fn all_round(cell: Cell, height_m: f64) -> Self {
        Self {
            cell,
            height_m,
            range_m: None,
            target_height_m: 0.0,
            body_radius_m: None,
            field_of_view: None,
        }
    }
}

/// The sector a camera looks at. The observer's own cell is always in it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FieldOfView {
    /// Direction of its middle, clockwise from north, radians.
    pub azimuth_rad: f64,
    /// Full width, radians; 2π or more is all around.
    pub width_rad: f64,
}

impl FieldOfView {
    fn contains(self, d_row: f64, d_col: f64) -> bool {
        use std::f64::consts::{PI, TAU};
        let off = libm::fmod(libm::atan2(d_col, -d_row) - self.azimuth_rad, TAU).abs();
        let off = if off > PI { TAU - off } else { off };
        (d_row == 0.0 && d_col == 0.0) || off <= self.width_rad / 2.0
    }
}

/// The cells an [`Observer`] sees (the paper's "visibility map").
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Viewshed {
    window: Window,
    /// 1 where seen, 0 where not, row by row of the window: bytes, as that is what the kernels write.
    visible: Vec<u8>,
}

impl Viewshed {
    /// The part of the grid that was in range.
    #[must_use]
    pub fn window(&self) -> Window {
        self.window
    }

    /// Whether a cell of the grid is seen; a cell outside the window is not.
    #[must_use]
    pub fn is_visible(&self, cell: Cell) -> bool {
        let Window { row, col, cols, .. } = self.window;
        self.window.contains(cell) && self.visible[(cell.row - row) * cols + (cell.col - col)] != 0
    }

    /// The cells that are seen, row by row.
    pub fn cells(&self) -> impl Iterator<Item = Cell> + '_ {
        self.window
            .cells()
            .zip(&self.visible)
            .filter(|(_, visible)| **visible != 0)
            .map(|(cell, _)| cell)
    }
}

/// How a viewshed is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Method {
    /// By the definition, to the last cell: [`viewshed`].
    #[default]
    Exact,
    /// With a sampled horizon: [`viewshed_fast`].
    Fast,
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Exact => "exact",
            Self::Fast => "fast",
        })
    }
}

/// A word that names no way to compute a viewshed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("\"{found}\" is no method for a viewshed; \"exact\" and \"fast\" are")]
#[non_exhaustive]
pub struct MethodError {
    /// The word found.
    pub found: String,
}

impl FromStr for Method {
    type Err = MethodError;

    /// # Errors
    /// [`MethodError`] for any word but `exact` and `fast`.
    fn from_str(word: &str) -> Result<Self, MethodError> {
        match word {
            "exact" => Ok(Self::Exact),
            "fast" => Ok(Self::Fast),
            _ => Err(MethodError { found: word.to_owned() }),
        }
    }
}

/// The cells that `observer` sees of an elevation layer in metres, by the method named.
///
/// # Panics
/// If the observer is not on the grid.
#[must_use]
pub fn viewshed_by(method: Method, elevation: &Layer, observer: &Observer) -> Viewshed {
    match method {
        Method::Exact => viewshed(elevation, observer),
        Method::Fast => viewshed_fast(elevation, observer),
    }
}

/// The cells that `observer` sees of an elevation layer in metres, exactly by the module's definition.
///
/// Unknown ground neither blocks nor is ever seen, and a camera that stands on it sees nothing. The result does
/// not depend on the number of threads. On most ground the cost grows with the number of cells; only where many
/// sight lines graze the ground to the last bit (a tilted plane, seen from its surface) does it grow with the
/// cube of the range.
///
/// # Panics
/// If the observer is not on the grid.
#[must_use]
pub fn viewshed(elevation: &Layer, observer: &Observer) -> Viewshed {
    let limits = Limits::new(elevation, observer);
    let visible = exact::visible(elevation, observer, &limits);
    Viewshed { window: limits.window(), visible }
}

/// The cells that `observer` sees of an elevation layer in metres, nearly: the horizon is sampled along rays (in the manner of
/// `XDraw`; Franklin, Ray and Mehta, 1994).
///
/// Some cells at the edges of shadows fall to the wrong side, 0.1 to 0.3 % of all on rocky ground (see the bench
/// `viewshed`). All limits of the observer are kept as [`viewshed`] keeps them, and so are holes: unknown ground neither
/// blocks nor is ever seen. The result does not depend on the number of threads or on the processor, and turned ground gives
/// the turned result. The cost grows with the number of cells in the window. Heights are compared in `f32`, relative to
/// the observer's ground.
///
/// # Panics
/// If the observer is not on the grid.
#[must_use]
pub fn viewshed_fast(elevation: &Layer, observer: &Observer) -> Viewshed {
    let limits = Limits::new(elevation, observer);
    let visible = fast::visible(elevation, observer, &limits);
    Viewshed { window: limits.window(), visible }
}

/// Whether a point `from_height_m` above the ground of one cell sees a point `to_height_m` above that of
/// another (metres), by the definition of [`viewshed`] on a plane. It is the same seen from either end.
///
/// # Panics
/// If a cell is not on the grid, as a slice does.
#[must_use]
pub fn line_of_sight(
    elevation: &Layer,
    from: Cell,
    from_height_m: f64,
    to: Cell,
    to_height_m: f64,
) -> bool {
    Sight::new(elevation, from, None).reaches(to, from_height_m, to_height_m)
}
