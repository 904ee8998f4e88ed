//! The eight octants about an observer, and what of them it may look at.
//!
//! In every octant a cell is `along` steps away down an axis of the grid and `across` steps to the side of it, with
//! across ≤ along. All that is ever compared is the same in each of them.

use wisdom_grid::{Cell, GridSpec, MAX_SIDE, Window};

use super::{FieldOfView, Observer};
use crate::Layer;

/// Steps of a row-major index along an octant's axis and to its side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Octant {
    along: isize,
    across: isize,
}

impl Octant {
    /// The octant of `from` in which `to` lies.
    pub(super) fn towards(cols: usize, from: Cell, to: Cell) -> Self {
        let down = if to.row < from.row { -(cols as isize) } else { cols as isize };
        let right = if to.col < from.col { -1 } else { 1 };
        let octant = Self { along: down, across: right };
        let is_steep = from.row.abs_diff(to.row) >= from.col.abs_diff(to.col);
        if is_steep { octant } else { octant.swapped() }
    }

    /// The octant on the other side of the diagonal.
    pub(super) fn swapped(self) -> Self {
        Self { along: self.across, across: self.along }
    }

    /// The index of the cell so many steps along and across from one of index `origin`.
    pub(super) fn index(self, origin: usize, along: usize, across: usize) -> usize {
        origin.wrapping_add_signed(self.along * along as isize + self.across * across as isize)
    }
}

/// Which cells an observer may look at at all: window, range and field of view.
pub(super) struct Limits {
    window: Window,
    centre: Cell,
    cols: usize,
    range_cells: f64,
    sector: Option<Sector>,
}

/// An octant with the farthest steps that stay in the window.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fan {
    pub(super) octant: Octant,
    pub(super) max_along: usize,
    pub(super) max_across: usize,
}

impl Limits {
    /// # Panics
    /// If the observer is not on the grid.
    pub(super) fn new(elevation: &Layer, observer: &Observer) -> Self {
        let spec: GridSpec = elevation.spec();
        let centre = observer.cell;
        assert!(spec.contains(centre), "an observer at {centre} is off the grid");
        let range_cells =
            observer.range_m.map_or(f64::INFINITY, |range_m| range_m / spec.spacing_m());
        Self {
            window: spec.around(centre, (range_cells as usize).min(MAX_SIDE)),
            centre,
            cols: spec.cols(),
            range_cells,
            sector: observer.field_of_view.map(Sector::new),
        }
    }

    pub(super) fn window(&self) -> Window {
        self.window
    }

    /// Steps from the observer to the window's edges: north, south, west, east.
    pub(super) fn sides(&self) -> [usize; 4] {
        let (row, col) = (self.centre.row - self.window.row, self.centre.col - self.window.col);
        [row, self.window.rows - 1 - row, col, self.window.cols - 1 - col]
    }

    /// The octants: first those along columns (north-west, north-east, south-west, south-east), then those along rows in the same order.
    pub(super) fn fans(&self) -> [Fan; 8] {
        let [north, south, west, east] = self.sides();
        let cols = self.cols as isize;
        let steep = [
            (-cols, -1, north, west),
            (-cols, 1, north, east),
            (cols, -1, south, west),
            (cols, 1, south, east),
        ];
        let fan = |along, across, max_along: usize, max_across: usize| Fan {
            octant: Octant { along, across },
            max_along,
            max_across: max_across.min(max_along),
        };
        std::array::from_fn(|i| {
            let (down, side, rows, cols) = steep[i % 4];
            if i < 4 { fan(down, side, rows, cols) } else { fan(side, down, cols, rows) }
        })
    }

    /// Whether a cell so many steps away along two axes is in range.
    pub(super) fn is_in_range(&self, along: usize, across: usize) -> bool {
        let (along, across) = (along as f64, across as f64);
        along * along + across * across <= self.range_cells * self.range_cells
    }

    /// The number of steps across, at most `limit`, to the last cell in range so many steps along; `None` if
    /// there is none.
    pub(super) fn reach(&self, along: usize, limit: usize) -> Option<usize> {
        if !self.is_in_range(along, 0) {
            return None;
        }
        if self.is_in_range(along, limit) {
            return Some(limit);
        }
        let length = along as f64;
        let guess = (self.range_cells * self.range_cells - length * length).max(0.0).sqrt();
        let mut across = (guess as usize).min(limit);
        while !self.is_in_range(along, across) {
            across -= 1;
        }
        while across < limit && self.is_in_range(along, across + 1) {
            across += 1;
        }
        Some(across)
    }

    /// Whether there is a field of view narrower than all around.
    pub(super) fn has_sector(&self) -> bool {
        self.sector.is_some()
    }

    /// Whether a cell is in the field of view.
    pub(super) fn is_in_sector(&self, cell: Cell) -> bool {
        self.sector.is_none_or(|sector| {
            sector.contains(
                cell.row as f64 - self.centre.row as f64,
                cell.col as f64 - self.centre.col as f64,
            )
        })
    }

    /// Takes from a map of the window what is out of range.
    pub(super) fn cut_range(&self, visible: &mut [u8]) {
        if self.range_cells == f64::INFINITY {
            return;
        }
        let [north, _, west, east] = self.sides();
        for (row, cells) in visible.chunks_mut(self.window.cols).enumerate() {
            let (left, right) = match self.reach(row.abs_diff(north), west.max(east)) {
                Some(reach) => (west.saturating_sub(reach), (west + reach + 1).min(cells.len())),
                None => (0, 0),
            };
            cells[..left].fill(0);
            cells[right..].fill(0);
        }
    }

    /// Takes from a map of the window what is outside the field of view.
    pub(super) fn cut_sector(&self, visible: &mut [u8]) {
        use rayon::prelude::*;
        if !self.has_sector() {
            return;
        }
        visible.par_chunks_mut(self.window.cols).enumerate().for_each(|(row, cells)| {
            for (col, seen) in cells.iter_mut().enumerate() {
                let cell = Cell { row: self.window.row + row, col: self.window.col + col };
                *seen &= u8::from(*seen != 0 && self.is_in_sector(cell));
            }
        });
    }
}

/// A field of view with the cosines that decide most cells without an arc tangent.
#[derive(Clone, Copy)]
struct Sector {
    field: FieldOfView,
    north: f64,
    east: f64,
    /// Cosine of half the width, if cosines may decide at all.
    edge: Option<f64>,
}

/// Cosines of angles that differ by more than this belong to angles that differ by more than any rounding in
/// [`FieldOfView::contains`]: a cosine changes no faster than its angle.
const COSINE_DOUBT: f64 = 1e-9;

/// Azimuths up to this lose less than [`COSINE_DOUBT`] when a direction is subtracted from them, radians.
const PLAIN_AZIMUTH_RAD: f64 = 1000.0;

impl Sector {
    fn new(field: FieldOfView) -> Self {
        let half = field.width_rad / 2.0;
        let is_plain = (0.0..=std::f64::consts::PI).contains(&half)
            && field.azimuth_rad.abs() <= PLAIN_AZIMUTH_RAD;
        Self {
            field,
            north: libm::cos(field.azimuth_rad),
            east: libm::sin(field.azimuth_rad),
            edge: is_plain.then(|| libm::cos(half)),
        }
    }

    fn contains(self, d_row: f64, d_col: f64) -> bool {
        if let Some(edge) = self.edge {
            let length = (d_row * d_row + d_col * d_col).sqrt();
            let inside = d_col * self.east - d_row * self.north - edge * length;
            if inside.abs() > COSINE_DOUBT * length {
                return inside > 0.0;
            }
        }
        self.field.contains(d_row, d_col)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cosines_decide_as_the_arc_tangent_does() {
        for (azimuth_rad, width_rad) in [
            (0.0, 1.0),
            (3.0, 0.5),
            (-2.0, 6.0),
            (1.0, 7.0),
            (900.0, 2.0),
            (1e9, 2.0),
            (0.0, 0.0),
            (0.5, -1.0),
        ] {
            let field = FieldOfView { azimuth_rad, width_rad };
            let sector = Sector::new(field);
            for row in -40..=40 {
                for col in -40..=40 {
                    let (row, col) = (f64::from(row), f64::from(col));
                    assert_eq!(
                        sector.contains(row, col),
                        field.contains(row, col),
                        "({row}, {col}) in {field:?}"
                    );
                }
            }
        }
    }
}
