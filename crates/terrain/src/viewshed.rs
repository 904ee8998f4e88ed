//! What a camera on a mast can see of the ground (paper section IV, Fig. 3).
//!
//! Observer and target stand over cell centres. Wherever the sight line between them crosses a line of the grid
//! that joins cell centres, it is compared with the ground there, interpolated between the two cells beside the
//! crossing; the target is hidden when the ground at any crossing is strictly above the line. Crossings next to
//! unknown ground are skipped: what no one has seen blocks no one's view. The test is made on whole multiples of the heights, without
//! division, so that a line that just grazes the ground is not a matter of rounding.

use rayon::prelude::*;
use wisdom_grid::{Cell, Window};

use crate::Layer;

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
    visible: Vec<bool>,
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
        self.window.contains(cell) && self.visible[(cell.row - row) * cols + (cell.col - col)]
    }

    /// The cells that are seen, row by row.
    pub fn cells(&self) -> impl Iterator<Item = Cell> + '_ {
        self.window
            .cells()
            .zip(&self.visible)
            .filter(|(_, visible)| **visible)
            .map(|(cell, _)| cell)
    }
}

/// The cells that `observer` sees of an elevation layer in metres, exactly by the module's definition.
///
/// Unknown ground neither blocks nor is ever seen, and a camera that stands on it sees nothing. One thread a row; the
/// result does not depend on how many there are. The cost grows with the cube of the range.
///
/// # Panics
/// If the observer is not on the grid.
#[must_use]
pub fn viewshed(elevation: &Layer, observer: &Observer) -> Viewshed {
    let spec = elevation.spec();
    assert!(spec.contains(observer.cell), "an observer at {} is off the grid", observer.cell);
    let range_cells = observer.range_m.map_or(f64::INFINITY, |range_m| range_m / spec.spacing_m());
    let window = spec.around(observer.cell, (range_cells as usize).min(wisdom_grid::MAX_SIDE));
    let sees = |cell: Cell| {
        let d_row = cell.row as f64 - observer.cell.row as f64;
        let d_col = cell.col as f64 - observer.cell.col as f64;
        let sight =
            Sight { ground: elevation, from: observer.cell, body_radius_m: observer.body_radius_m };
        d_row * d_row + d_col * d_col <= range_cells * range_cells
            && observer.field_of_view.is_none_or(|field| field.contains(d_row, d_col))
            && sight.reaches(cell, observer.height_m, observer.target_height_m)
    };
    let rows: Vec<Vec<bool>> = (window.row..window.row + window.rows)
        .into_par_iter()
        .map(|row| {
            (window.col..window.col + window.cols).map(|col| sees(Cell { row, col })).collect()
        })
        .collect();
    Viewshed { window, visible: rows.concat() }
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
    Sight { ground: elevation, from, body_radius_m: None }.reaches(to, from_height_m, to_height_m)
}

/// The ground as seen from one cell.
struct Sight<'a> {
    ground: &'a Layer,
    from: Cell,
    body_radius_m: Option<f64>,
}

impl Sight<'_> {
    /// Height of a cell, lowered by the curvature of the body, metres.
    fn height(&self, cell: Cell) -> f64 {
        let height = f64::from(self.ground.value(cell));
        let Some(radius_m) = self.body_radius_m else { return height };
        let distance_m = self.from.distance(cell) * self.ground.spec().spacing_m();
        height - distance_m * distance_m / (2.0 * radius_m)
    }

    fn reaches(&self, to: Cell, from_height_m: f64, to_height_m: f64) -> bool {
        if !(self.ground.is_known(self.from) && self.ground.is_known(to)) {
            return false;
        }
        let eye = self.height(self.from) + from_height_m;
        let mark = self.height(to) + to_height_m;
        let (rows, cols) = (signed(self.from.row, to.row), signed(self.from.col, to.col));
        let on_row_lines = |along, across| Cell {
            row: moved(self.from.row, along),
            col: moved(self.from.col, across),
        };
        let on_col_lines = |along, across| Cell {
            row: moved(self.from.row, across),
            col: moved(self.from.col, along),
        };
        self.is_clear(rows, cols, (eye, mark), on_row_lines)
            && self.is_clear(cols, rows, (eye, mark), on_col_lines)
    }

    /// Tests the crossings with the grid lines that lie `1 .. |along| − 1` steps away. On the k-th the sight line
    /// is at height `(eye·(n−k) + mark·k)/n` with n = |along|, between two cells with weights `(n−m)/n` and
    /// `m/n`; both sides are compared times n.
    fn is_clear(
        &self,
        along: i64,
        across: i64,
        (eye, mark): (f64, f64),
        cell: impl Fn(i64, i64) -> Cell,
    ) -> bool {
        let n = along.abs();
        (1..n).all(|k| {
            let (whole, m) = ((across * k).div_euclid(n), (across * k).rem_euclid(n));
            let near = cell(k * along.signum(), whole);
            if !self.ground.is_known(near) {
                return true;
            }
            let ground = if m == 0 {
                self.height(near) * n as f64
            } else {
                let far = cell(k * along.signum(), whole + 1);
                if !self.ground.is_known(far) {
                    return true;
                }
                self.height(near) * (n - m) as f64 + self.height(far) * m as f64
            };
            ground <= eye * (n - k) as f64 + mark * k as f64
        })
    }
}

fn signed(from: usize, to: usize) -> i64 {
    to as i64 - from as i64
}

fn moved(from: usize, steps: i64) -> usize {
    (from as i64 + steps) as usize
}
