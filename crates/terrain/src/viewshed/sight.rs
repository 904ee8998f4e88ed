//! The definition: one sight line, crossing by crossing.

use wisdom_grid::Cell;

use super::fan::Octant;
use crate::Layer;

/// The ground as seen from one cell.
pub(super) struct Sight<'a> {
    values: &'a [f32],
    uncertainty: &'a [f32],
    cols: usize,
    spacing_m: f64,
    from: Cell,
    origin: usize,
    body_radius_m: Option<f64>,
}

impl<'a> Sight<'a> {
    pub(super) fn new(ground: &'a Layer, from: Cell, body_radius_m: Option<f64>) -> Self {
        Self {
            values: ground.values().values(),
            uncertainty: ground.uncertainty().values(),
            cols: ground.spec().cols(),
            spacing_m: ground.spec().spacing_m(),
            from,
            origin: ground.spec().index(from),
            body_radius_m,
        }
    }

    /// Row-major index of the cell the sight starts from.
    pub(super) fn origin(&self) -> usize {
        self.origin
    }

    pub(super) fn is_known(&self, index: usize) -> bool {
        self.uncertainty[index] < 1.0
    }

    /// How much the curvature of the body lowers ground so many cells away along and across, metres.
    pub(super) fn drop_m(&self, along: usize, across: usize) -> f64 {
        let Some(radius_m) = self.body_radius_m else { return 0.0 };
        let (along, across) = (along as f64, across as f64);
        let distance_m = (along * along + across * across).sqrt() * self.spacing_m;
        distance_m * distance_m / (2.0 * radius_m)
    }

    /// Height of the cell of an index, so many cells away, lowered by the curvature of the body, metres.
    pub(super) fn height(&self, index: usize, along: usize, across: usize) -> f64 {
        f64::from(self.values[index]) - self.drop_m(along, across)
    }

    pub(super) fn reaches(&self, to: Cell, from_height_m: f64, to_height_m: f64) -> bool {
        let octant = Octant::towards(self.cols, self.from, to);
        let (rows, cols) = (self.from.row.abs_diff(to.row), self.from.col.abs_diff(to.col));
        self.reaches_in(octant, rows.max(cols), rows.min(cols), from_height_m, to_height_m)
    }

    /// The same, for the cell so many steps along and across an octant.
    pub(super) fn reaches_in(
        &self,
        octant: Octant,
        along: usize,
        across: usize,
        from_height_m: f64,
        to_height_m: f64,
    ) -> bool {
        let origin = self.origin();
        let target = octant.index(origin, along, across);
        if !(self.is_known(origin) && self.is_known(target)) {
            return false;
        }
        let ends = (
            self.height(origin, 0, 0) + from_height_m,
            self.height(target, along, across) + to_height_m,
        );
        self.is_clear(octant, along, across, ends)
            && self.is_clear(octant.swapped(), across, along, ends)
    }

    /// Tests the crossings with the grid lines that lie `1 .. n − 1` steps away, `n` = along. On the k-th the sight line
    /// is at height `(eye·(n−k) + mark·k)/n`, between two cells with weights `(n−m)/n` and
    /// `m/n`; both sides are compared times n.
    fn is_clear(&self, octant: Octant, n: usize, across: usize, (eye, mark): (f64, f64)) -> bool {
        let origin = self.origin();
        let (mut whole, mut m) = (0, 0);
        (1..n).all(|k| {
            whole += across / n;
            m += across % n;
            if m >= n {
                m -= n;
                whole += 1;
            }
            let near = octant.index(origin, k, whole);
            if !self.is_known(near) {
                return true;
            }
            let ground = if m == 0 {
                self.height(near, k, whole) * n as f64
            } else {
                let far = octant.index(origin, k, whole + 1);
                if !self.is_known(far) {
                    return true;
                }
                self.height(near, k, whole) * (n - m) as f64
                    + self.height(far, k, whole + 1) * m as f64
            };
            ground <= eye * (n - k) as f64 + mark * k as f64
        })
    }
}
