//! Step height.

use wisdom_grid::Cell;

use super::stencil::{Ground, Reading, Stencil, UNKNOWN, highest_of_eight, lowest_of_eight};
use super::width::Width;

/// The largest difference to a neighbour.
pub(super) struct Step;

/// The eight neighbours.
const AROUND: [(isize, isize); 8] =
    [(-1, -1), (-1, 0), (-1, 1), (0, -1), (0, 1), (1, -1), (1, 0), (1, 1)];

impl Stencil for Step {
    fn reach(&self) -> usize {
        1
    }

    /// The highest and the lowest neighbour decide: differences are rounded in the order of the heights.
    #[inline(always)]
    fn values<W: Width>(&self, w: W, ground: &Ground<'_>, at: usize) -> W::Lanes {
        let (z, cols) = (ground.z, ground.spec.cols());
        let here = w.load(z, at);
        let high = highest_of_eight(w, z, at, cols);
        let low = lowest_of_eight(w, z, at, cols);
        // Zero is put in so that level ground has no negative one.
        w.held(w.larger(w.larger(high - here, here - low), w.splat(0.0)))
    }

    #[inline(always)]
    fn worst_u<W: Width>(&self, w: W, ground: &Ground<'_>, at: usize) -> W::Lanes {
        let (u, cols) = (ground.u, ground.spec.cols());
        let around = highest_of_eight(w, u, at, cols);
        w.larger(around, w.load(u, at))
    }

    fn reading(&self, ground: &Ground<'_>, cell: Cell) -> Reading {
        let Some((here, u_here)) = ground.known(cell, 0, 0) else { return UNKNOWN };
        AROUND
            .iter()
            .filter_map(|&(d_row, d_col)| ground.known(cell, d_row, d_col))
            .map(|(height, u)| ((height - here).abs(), u))
            .reduce(|a, b| (a.0.max(b.0), a.1.max(b.1)))
            .map_or(UNKNOWN, |(height, u)| (height.min(f32::MAX), u.max(u_here)))
    }
}
