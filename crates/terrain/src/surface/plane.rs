//! Roughness: what a fitted plane leaves over.

use nalgebra::{Matrix3, Vector3};
use wisdom_grid::{Cell, GridSpec};

use super::stencil::{Ground, Reading, Stencil, UNKNOWN, strip};
use super::width::Width;

/// The plane fitted over a disc.
///
/// Let z₀ be the height in the middle and z₊, z₋ those of two cells opposite each other. Over a whole disc the
/// least squares plane falls into two parts that do not know of each other. Its height is the mean of the even parts
/// s = (z₊ − z₀) + (z₋ − z₀), its tilt follows from the odd parts t = z₊ − z₋ alone. A tilted plane has s = 0, so
/// neither its tilt nor its height above the datum costs the residual any digits, and single precision is enough:
/// a difference of heights is rounded once, and all that follows is relative to differences.
pub(super) struct PlaneFit {
    radius: usize,
    /// Row and column steps to all cells, row by row.
    footprint: Vec<(isize, isize)>,
    /// One of each two opposite cells.
    half: Vec<Arm>,
    /// Sum of the squared column steps (as of the row steps) over that half.
    spread: f32,
    /// Two over the number of cells.
    twice_per_cell: f32,
    /// One over twice the number of cells.
    per_two_cells: f32,
}

/// A step from the middle to a cell, as whole numbers and as floats.
struct Arm {
    row: isize,
    col: isize,
    down: f32,
    right: f32,
}

impl PlaneFit {
    /// The disc of a radius in cells, between centres, cut to what can lie on the grid.
    pub(super) fn new(radius: usize, spec: GridSpec) -> Self {
        let radius = radius.min(spec.rows() + spec.cols());
        let footprint = disc(radius, spec);
        let arm =
            |&(row, col): &(isize, isize)| Arm { row, col, down: row as f32, right: col as f32 };
        let half: Vec<Arm> = footprint.iter().filter(|&&step| step > (0, 0)).map(arm).collect();
        let cells = footprint.len() as f64;
        Self {
            radius,
            spread: half.iter().map(|arm| f64::from(arm.right).powi(2)).sum::<f64>() as f32,
            twice_per_cell: (2.0 / cells) as f32,
            per_two_cells: (0.5 / cells) as f32,
            footprint,
            half,
        }
    }

    /// Whether there are cells enough for a residual at all.
    pub(super) fn is_possible(&self) -> bool {
        self.footprint.len() >= 4
    }

    /// The root mean square from the squares of both parts, each twice too large.
    #[inline(always)]
    fn root_mean<W: Width>(&self, w: W, twice_squares: W::Lanes) -> W::Lanes {
        w.held(w.root(twice_squares * w.splat(self.per_two_cells)))
    }

    /// Radius 1: five cells, whose two odd parts the tilt explains whole.
    #[inline(always)]
    fn of_five<W: Width>(&self, w: W, z: &[f32], cols: usize, at: usize) -> W::Lanes {
        let (beside, here) = (strip::<W>(z, at, 1), w.load(z, at));
        let row = even::<W>(w.load(beside, 2), here, w.load(beside, 0));
        let col = even::<W>(w.load(z, at + cols), here, w.load(z, at - cols));
        let mean = (row + col) * w.splat(self.twice_per_cell);
        let (row, col) = (row - mean, col - mean);
        let middle = mean * mean * w.splat(0.5);
        self.root_mean(w, squares::<W>(row, col) + middle)
    }

    /// Radius 2: thirteen cells. Sums are grouped so that a map turned or mirrored has the same bits.
    #[inline(always)]
    fn of_thirteen<W: Width>(&self, w: W, z: &[f32], cols: usize, at: usize) -> W::Lanes {
        let (north, row, south) =
            (strip::<W>(z, at - cols, 1), strip::<W>(z, at, 2), strip::<W>(z, at + cols, 1));
        let here = w.load(row, 2);
        let east = [w.load(row, 3), w.load(row, 4)];
        let west = [w.load(row, 1), w.load(row, 0)];
        let below = [w.load(south, 1), w.load(z, at + 2 * cols)];
        let above = [w.load(north, 1), w.load(z, at - 2 * cols)];
        let [sw, se] = [w.load(south, 0), w.load(south, 2)];
        let [nw, ne] = [w.load(north, 0), w.load(north, 2)];
        self.residual_of_thirteen(w, here, [east, below, [se, sw]], [west, above, [nw, ne]])
    }

    /// Of the cells opposite each other, the ones after the middle and the ones before it.
    #[inline(always)]
    fn residual_of_thirteen<W: Width>(
        &self,
        w: W,
        here: W::Lanes,
        after: [[W::Lanes; 2]; 3],
        before: [[W::Lanes; 2]; 3],
    ) -> W::Lanes {
        let [[east1, east2], [south1, south2], [southeast, southwest]] = after;
        let [[west1, west2], [north1, north2], [northwest, northeast]] = before;
        let (e1, e2) = (even::<W>(east1, here, west1), even::<W>(east2, here, west2));
        let (s1, s2) = (even::<W>(south1, here, north1), even::<W>(south2, here, north2));
        let se = even::<W>(southeast, here, northwest);
        let sw = even::<W>(southwest, here, northeast);
        let sum = ((e1 + s1) + (e2 + s2)) + (se + sw);
        let mean = sum * w.splat(self.twice_per_cell);
        let evens = (squares::<W>(e1 - mean, s1 - mean) + squares::<W>(e2 - mean, s2 - mean))
            + squares::<W>(se - mean, sw - mean);

        let (e1, e2) = (east1 - west1, east2 - west2);
        let (s1, s2) = (south1 - north1, south2 - north2);
        let (se, sw) = (southeast - northwest, southwest - northeast);
        let spread = w.splat(self.spread);
        let right = ((e1 + (e2 + e2)) + (se - sw)) / spread;
        let down = ((s1 + (s2 + s2)) + (se + sw)) / spread;
        let odds = (squares::<W>(e1 - right, s1 - down)
            + squares::<W>(e2 - (right + right), s2 - (down + down)))
            + squares::<W>(se - (down + right), sw - (down - right));
        self.root_mean(w, (evens + odds) + mean * mean * w.splat(0.5))
    }

    /// Any radius.
    #[inline(always)]
    fn of_disc<W: Width>(&self, w: W, z: &[f32], cols: usize, at: usize) -> W::Lanes {
        let pair = Pair { w, z, at, here: w.load(z, at) };
        let zero = w.splat(0.0);
        let (mut sum, mut right, mut down) = (zero, zero, zero);
        for arm in &self.half {
            let step = arm.index_step(cols);
            let odd = pair.odd(step);
            sum = sum + pair.even(step);
            right = right + odd * w.splat(arm.right);
            down = down + odd * w.splat(arm.down);
        }
        let mean = sum * w.splat(self.twice_per_cell);
        let (right, down) = (right / w.splat(self.spread), down / w.splat(self.spread));
        let mut sum_of_squares = mean * mean * w.splat(0.5);
        for arm in &self.half {
            let step = arm.index_step(cols);
            let even = pair.even(step) - mean;
            let plane = right * w.splat(arm.right) + down * w.splat(arm.down);
            let odd = pair.odd(step) - plane;
            sum_of_squares = sum_of_squares + squares::<W>(even, odd);
        }
        self.root_mean(w, sum_of_squares)
    }

    /// Known cells of the footprint: where they lie, their rise above the middle, their u.
    fn known(
        &self,
        ground: &Ground<'_>,
        centre: Cell,
        base: f32,
    ) -> impl Iterator<Item = (Vector3<f64>, f64, f32)> {
        self.footprint.iter().filter_map(move |&(d_row, d_col)| {
            let (height, u) = ground.known(centre, d_row, d_col)?;
            let rise = f64::from(height) - f64::from(base);
            Some((Vector3::new(1.0, d_col as f64, d_row as f64), rise, u))
        })
    }
}

impl Arm {
    /// The step of a row-major index.
    #[inline(always)]
    fn index_step(&self, cols: usize) -> usize {
        (self.row * cols as isize + self.col) as usize
    }
}

/// The even part of two cells opposite each other.
#[inline(always)]
fn even<W: Width>(after: W::Lanes, here: W::Lanes, before: W::Lanes) -> W::Lanes {
    (after - here) + (before - here)
}

#[inline(always)]
fn squares<W: Width>(a: W::Lanes, b: W::Lanes) -> W::Lanes {
    a * a + b * b
}

/// Cells opposite each other around cells from an index on.
struct Pair<'a, W: Width> {
    w: W,
    z: &'a [f32],
    at: usize,
    here: W::Lanes,
}

impl<W: Width> Pair<'_, W> {
    #[inline(always)]
    fn even(&self, step: usize) -> W::Lanes {
        let after = self.w.load(self.z, self.at + step);
        let before = self.w.load(self.z, self.at - step);
        even::<W>(after, self.here, before)
    }

    #[inline(always)]
    fn odd(&self, step: usize) -> W::Lanes {
        self.w.load(self.z, self.at + step) - self.w.load(self.z, self.at - step)
    }
}

impl Stencil for PlaneFit {
    fn reach(&self) -> usize {
        self.radius
    }

    #[inline(always)]
    fn values<W: Width>(&self, w: W, ground: &Ground<'_>, at: usize) -> W::Lanes {
        let (z, cols) = (ground.z, ground.spec.cols());
        match self.radius {
            1 => self.of_five(w, z, cols, at),
            2 => self.of_thirteen(w, z, cols, at),
            _ => self.of_disc(w, z, cols, at),
        }
    }

    #[inline(always)]
    fn worst_u<W: Width>(&self, w: W, ground: &Ground<'_>, at: usize) -> W::Lanes {
        let (u, cols) = (ground.u, ground.spec.cols());
        let mut worst = w.load(u, at);
        for arm in &self.half {
            let step = arm.index_step(cols);
            let both = w.larger(w.load(u, at + step), w.load(u, at - step));
            worst = w.larger(worst, both);
        }
        worst
    }

    /// Least squares plane z = a + b·col + c·row over the footprint's known cells, in double precision.
    fn reading(&self, ground: &Ground<'_>, cell: Cell) -> Reading {
        let Some((base, _)) = ground.known(cell, 0, 0) else { return UNKNOWN };
        let (mut right, mut cells, mut u) = (Vector3::zeros(), 0.0, 0.0_f32);
        let (mut x, mut y, mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for (at, rise, u_there) in self.known(ground, cell, base) {
            (x, y) = (x + at.y, y + at.z);
            (xx, xy, yy) = (xx + at.y * at.y, xy + at.y * at.z, yy + at.z * at.z);
            right += at * rise;
            cells += 1.0;
            u = u.max(u_there);
        }
        let normal = Matrix3::new(cells, x, y, x, xx, xy, y, xy, yy);
        // The entries are sums of whole numbers, so the determinant of cells on one line is 0 up to rounding and
        // that of any others at least 1.
        if cells < 4.0 || normal.determinant() < 0.5 {
            return UNKNOWN;
        }
        let Some(inverse) = normal.try_inverse() else { return UNKNOWN };
        let plane = inverse * right;
        let squares: f64 = self
            .known(ground, cell, base)
            .map(|(at, rise, _)| (rise - plane.dot(&at)).powi(2))
            .sum();
        ((libm::sqrt(squares / cells) as f32).min(f32::MAX), u)
    }
}

/// Row and column steps to all cells within a radius that some two cells of the grid can lie apart, row by row.
fn disc(radius: usize, spec: GridSpec) -> Vec<(isize, isize)> {
    let r = radius as isize;
    let (rows, cols) = (r.min(spec.rows() as isize - 1), r.min(spec.cols() as isize - 1));
    (-rows..=rows)
        .flat_map(|d_row| (-cols..=cols).map(move |d_col| (d_row, d_col)))
        .filter(|(d_row, d_col)| d_row * d_row + d_col * d_col <= r * r)
        .collect()
}
