//! Quantities derived from a cell's surroundings: many cells at once where all is known, one by one elsewhere.

use wisdom_grid::{Cell, GridSpec};

use super::width::{Instructions, Job, Single, Width};
use crate::Layer;

/// A reading of something derived from a layer, with its uncertainty; u = 1 if it cannot be derived.
pub(super) type Reading = (f32, f32);

/// What cannot be derived.
pub(super) const UNKNOWN: Reading = (0.0, 1.0);

/// Heights and their u, as kernels see them.
#[derive(Clone, Copy)]
pub(super) struct Ground<'a> {
    pub(super) spec: GridSpec,
    /// Heights, metres.
    pub(super) z: &'a [f32],
    pub(super) u: &'a [f32],
    /// The u that all cells share, if that is known.
    pub(super) alike: Option<f32>,
    /// One over twice the cell spacing, per metre.
    pub(super) per_two_cells: f32,
}

impl<'a> Ground<'a> {
    pub(super) fn of(elevation: &'a Layer) -> Self {
        // Only the shape counts here: cells are numbered from (0, 0), whatever part of a ground they are.
        let spec = elevation.spec().numbered_from(Cell::new(0, 0));
        Self {
            spec,
            z: elevation.values().values(),
            u: elevation.uncertainty().values(),
            alike: elevation.alike(),
            per_two_cells: per_two_cells(spec),
        }
    }

    /// Height and u of the cell some rows and columns away; none if it is off the map or unknown.
    #[inline]
    pub(super) fn known(&self, cell: Cell, d_row: isize, d_col: isize) -> Option<Reading> {
        let at = self.spec.index(self.spec.step(cell, d_row, d_col)?);
        (self.u[at] < 1.0).then(|| (self.z[at], self.u[at]))
    }

    /// The u of one row of cells.
    pub(super) fn u_of_row(&self, row: usize) -> &'a [f32] {
        let cols = self.spec.cols();
        &self.u[row * cols..(row + 1) * cols]
    }
}

/// One over twice the cell spacing, per metre; never infinite.
pub(super) fn per_two_cells(spec: GridSpec) -> f32 {
    (0.5 / spec.spacing_m()).min(f64::from(f32::MAX)) as f32
}

/// A quantity derived from a cell's surroundings.
pub(super) trait Stencil {
    /// Rows and columns that it reaches to every side.
    fn reach(&self) -> usize;

    /// The quantity at cells from index `at` on, of whose surroundings all is known, held (see [`Width::held`]).
    fn values<W: Width>(&self, w: W, ground: &Ground<'_>, at: usize) -> W::Lanes;

    /// The largest u of the heights that [`Stencil::values`] makes use of; 1 tells that it cannot be used.
    fn worst_u<W: Width>(&self, w: W, ground: &Ground<'_>, at: usize) -> W::Lanes;

    /// The quantity at any cell: beside holes, at the map's edge. With nothing missing it is only as good as
    /// [`Stencil::values`], and need not have its last bits.
    fn reading(&self, ground: &Ground<'_>, cell: Cell) -> Reading;
}

/// The cells from index `at` on and so many beside them to either side. Its length is a constant where `beside` is,
/// which spares the loads from it all further checks.
#[inline(always)]
pub(super) fn strip<W: Width>(plane: &[f32], at: usize, beside: usize) -> &[f32] {
    &plane[at - beside..at + beside + W::CELLS]
}

/// The largest of the eight neighbours' numbers.
#[inline(always)]
pub(super) fn highest_of_eight<W: Width>(w: W, plane: &[f32], at: usize, cols: usize) -> W::Lanes {
    let north = strip::<W>(plane, at - cols, 1);
    let here = strip::<W>(plane, at, 1);
    let south = strip::<W>(plane, at + cols, 1);
    let above = w.larger(w.load(north, 0), w.load(north, 2));
    let below = w.larger(w.load(south, 0), w.load(south, 2));
    let beside = w.larger(w.load(here, 0), w.load(here, 2));
    let middle = w.larger(w.load(north, 1), w.load(south, 1));
    w.larger(w.larger(above, below), w.larger(beside, middle))
}

/// The smallest of the eight neighbours' numbers.
#[inline(always)]
pub(super) fn lowest_of_eight<W: Width>(w: W, plane: &[f32], at: usize, cols: usize) -> W::Lanes {
    let north = strip::<W>(plane, at - cols, 1);
    let here = strip::<W>(plane, at, 1);
    let south = strip::<W>(plane, at + cols, 1);
    let above = w.smaller(w.load(north, 0), w.load(north, 2));
    let below = w.smaller(w.load(south, 0), w.load(south, 2));
    let beside = w.smaller(w.load(here, 0), w.load(here, 2));
    let middle = w.smaller(w.load(north, 1), w.load(south, 1));
    w.smaller(w.smaller(above, below), w.smaller(beside, middle))
}

/// What is known of some rows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Seen {
    /// Nothing.
    Nothing,
    /// Of some cells.
    Some,
    /// Of every cell.
    All,
    /// Of every cell, all with the same u.
    Alike(f32),
}

impl Seen {
    /// What is known of a row, from the u of its cells.
    pub(super) fn of(instructions: Instructions, u: &[f32]) -> Self {
        let (mut low, mut high) = (1.0, 0.0);
        instructions.run(Range { row: u, low: &mut low, high: &mut high });
        match (low < 1.0, high < 1.0) {
            (false, _) => Self::Nothing,
            (true, false) => Self::Some,
            (true, true) if low == high => Self::Alike(low + 0.0),
            (true, true) => Self::All,
        }
    }

    /// What is known of rows together.
    pub(super) fn together(rows: &[Self]) -> Self {
        let first = rows[0];
        if rows.iter().all(|&seen| seen == first) {
            first
        } else if rows.iter().any(|seen| matches!(seen, Self::Nothing | Self::Some)) {
            Self::Some
        } else {
            Self::All
        }
    }
}

/// The smallest and the largest number of a row, from 0 to 1.
struct Range<'a> {
    row: &'a [f32],
    low: &'a mut f32,
    high: &'a mut f32,
}

impl Range<'_> {
    #[inline(always)]
    fn find<W: Width>(self, w: W) {
        let (mut low, mut high) = (w.splat(1.0), w.splat(0.0));
        let mut at = 0;
        while let Some(start) = next::<W>(&mut at, self.row.len()) {
            let here = w.load(self.row, start);
            (low, high) = (w.smaller(here, low), w.larger(here, high));
        }
        let mut each = [[0.0; MOST_CELLS]; 2];
        w.store(low, &mut each[0], 0);
        w.store(high, &mut each[1], 0);
        *self.low = each[0][..W::CELLS].iter().copied().fold(1.0, f32::min);
        *self.high = each[1][..W::CELLS].iter().copied().fold(0.0, f32::max);
    }
}

impl Job for Range<'_> {
    #[inline(always)]
    fn run<W: Width>(self, w: W) {
        if self.row.len() < W::CELLS { self.find(Single) } else { self.find(w) }
    }
}

/// No register holds more cells.
const MOST_CELLS: usize = 16;

/// Where to go on from `at` so that every number before `end` is met: the last step overlaps the one before it if
/// need be. None when all are.
#[inline(always)]
fn next<W: Width>(at: &mut usize, end: usize) -> Option<usize> {
    let start = (*at).min(end - W::CELLS);
    let more = *at < end;
    *at += W::CELLS;
    more.then_some(start)
}

/// One row of a derived layer.
pub(super) struct Row<'a> {
    pub(super) values: &'a mut [f32],
    pub(super) u: &'a mut [f32],
    /// The u that all cells hold already, if that is known.
    pub(super) alike: Option<f32>,
}

impl Row<'_> {
    /// The same u for all cells.
    pub(super) fn fill_u(&mut self, u: f32) {
        // Pages of fresh zeros are best left alone: the first access to a page costs more than the arithmetic. And to
        // see that a row is right already takes half the memory traffic of writing it.
        if self.alike != Some(u) && !is_all(self.u, u) {
            self.u.fill(u);
        }
    }

    /// The u of a row already made from the same cells, of which so much is known.
    pub(super) fn copy_u(&mut self, from: &[f32], seen: Seen) -> Option<f32> {
        match seen {
            // Either all of such a row can be derived or, on a map of one row or column, none of it.
            Seen::Alike(u) if from[0] == u => {
                self.fill_u(u);
                Some(u)
            }
            _ => {
                self.u.copy_from_slice(from);
                None
            }
        }
    }

    /// Derives a row, given what is known of the rows within reach, and says which u all its cells share, if that is
    /// known.
    pub(super) fn derive<T: Stencil>(
        &mut self,
        instructions: Instructions,
        stencil: &T,
        ground: &Ground<'_>,
        row: usize,
        seen: Seen,
    ) -> Option<f32> {
        let (rows, cols, reach) = (ground.spec.rows(), ground.spec.cols(), stencil.reach());
        if seen == Seen::Nothing {
            self.values.fill(UNKNOWN.0);
            self.u.fill(UNKNOWN.1);
            return Some(UNKNOWN.1);
        }
        let filled = match seen {
            Seen::Alike(u) => Some(u),
            Seen::Some | Seen::All | Seen::Nothing => None,
        };
        if let Some(u) = filled {
            self.fill_u(u);
        }
        if row < reach || row + reach >= rows || cols <= 2 * reach {
            return self.one_by_one(stencil, ground, row, 0..cols, filled);
        }
        let inner = reach..cols - reach;
        instructions.run(AtOnce {
            stencil,
            ground,
            first: row * cols,
            inner: inner.clone(),
            values: self.values,
            u: filled.is_none().then_some(&mut *self.u),
        });
        if seen == Seen::Some {
            for col in inner.clone() {
                if self.u[col] >= 1.0 {
                    self.one_by_one(stencil, ground, row, col..col + 1, None);
                }
            }
        }
        let west = self.one_by_one(stencil, ground, row, 0..inner.start, filled);
        let east = self.one_by_one(stencil, ground, row, inner.end..cols, filled);
        west.and(east)
    }

    /// Cells one after the other, whatever is known around them; `filled` is the u that they hold already, and what is
    /// returned if they keep it.
    #[inline(never)]
    fn one_by_one<T: Stencil>(
        &mut self,
        stencil: &T,
        ground: &Ground<'_>,
        row: usize,
        cols: std::ops::Range<usize>,
        filled: Option<f32>,
    ) -> Option<f32> {
        let mut kept = filled;
        for col in cols {
            let (value, u) = stencil.reading(ground, Cell { row, col });
            self.values[col] = value;
            if filled != Some(u) {
                self.u[col] = u + 0.0;
                kept = None;
            }
        }
        kept
    }
}

/// Whether a row has these bits everywhere; some cells at a time, so that the comparisons vectorise.
fn is_all(row: &[f32], value: f32) -> bool {
    let differs = |bits: u32, there: &f32| bits | (there.to_bits() ^ value.to_bits());
    row.chunks(256).all(|cells| cells.iter().fold(0, differs) == 0)
}

/// Cells of a row away from the edge, as if all were known; where it is not, u comes out as 1.
struct AtOnce<'a, T> {
    stencil: &'a T,
    ground: &'a Ground<'a>,
    /// Index of the row's first cell.
    first: usize,
    /// Columns.
    inner: std::ops::Range<usize>,
    values: &'a mut [f32],
    /// None if it is known without looking.
    u: Option<&'a mut [f32]>,
}

impl<T: Stencil> AtOnce<'_, T> {
    #[inline(always)]
    fn sweep<W: Width>(self, w: W) {
        let Self { stencil, ground, first, inner, values, u } = self;
        let mut at = inner.start;
        while let Some(col) = next::<W>(&mut at, inner.end) {
            w.store(stencil.values(w, ground, first + col), values, col);
        }
        let Some(u) = u else { return };
        let mut at = inner.start;
        while let Some(col) = next::<W>(&mut at, inner.end) {
            // Adding zero makes a negative one positive, whatever the order of the comparisons was.
            w.store(stencil.worst_u(w, ground, first + col) + w.splat(0.0), u, col);
        }
    }
}

impl<T: Stencil> Job for AtOnce<'_, T> {
    #[inline(always)]
    fn run<W: Width>(self, w: W) {
        if self.inner.len() < W::CELLS { self.sweep(Single) } else { self.sweep(w) }
    }
}
