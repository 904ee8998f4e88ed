//! Gradient magnitude by central differences or by Horn's weights.

use std::fmt;
use std::str::FromStr;

use wisdom_grid::Cell;

use super::stencil::{Ground, Reading, Stencil, UNKNOWN, highest_of_eight, strip};
use super::width::{Single, Width};

/// Which cells a gradient is taken from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub enum Kernel {
    /// Central differences: the four neighbours along the axes. Keeps the edges of rocks sharp.
    #[default]
    Central,
    /// Horn's weights 1, 2, 1 over all eight neighbours (Horn, "Hill shading and the reflectance map", 1981), as
    /// GDAL and `ArcGIS` do by default. Smoother.
    Horn,
}

impl Kernel {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Central, Self::Horn];

    /// As mission files write it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Central => "central",
            Self::Horn => "horn",
        }
    }
}

impl fmt::Display for Kernel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A name that is no [`Kernel`]'s.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the gradient kernel is \"{name}\"; it is \"central\" or \"horn\"")]
pub struct UnknownKernel {
    /// The name found.
    pub name: String,
}

impl FromStr for Kernel {
    type Err = UnknownKernel;

    fn from_str(name: &str) -> Result<Self, UnknownKernel> {
        Self::ALL
            .into_iter()
            .find(|kernel| kernel.name() == name)
            .ok_or_else(|| UnknownKernel { name: name.to_owned() })
    }
}

/// Rise over run from the rises over two cells along both axes.
#[inline(always)]
fn magnitude<W: Width>(w: W, along_row: W::Lanes, along_col: W::Lanes, per_two: f32) -> W::Lanes {
    w.held(w.root(along_row * along_row + along_col * along_col) * w.splat(per_two))
}

/// [`Kernel::Central`].
pub(super) struct Central;

/// [`Kernel::Horn`].
pub(super) struct Horn;

impl Stencil for Central {
    fn reach(&self) -> usize {
        1
    }

    #[inline(always)]
    fn values<W: Width>(&self, w: W, ground: &Ground<'_>, at: usize) -> W::Lanes {
        let (z, cols) = (ground.z, ground.spec.cols());
        let here = strip::<W>(z, at, 1);
        let along_row = w.load(here, 2) - w.load(here, 0);
        let along_col = w.load(z, at + cols) - w.load(z, at - cols);
        magnitude(w, along_row, along_col, ground.per_two_cells)
    }

    #[inline(always)]
    fn worst_u<W: Width>(&self, w: W, ground: &Ground<'_>, at: usize) -> W::Lanes {
        let (u, cols) = (ground.u, ground.spec.cols());
        let here = strip::<W>(u, at, 1);
        let along_row = w.larger(w.load(here, 2), w.load(here, 0));
        let along_col = w.larger(w.load(u, at + cols), w.load(u, at - cols));
        w.larger(along_row, along_col)
    }

    fn reading(&self, ground: &Ground<'_>, cell: Cell) -> Reading {
        either(ground, |along, _| {
            both_sides(ground, cell, (0, 0), along)
                .or_else(|| one_side(ground, cell, (0, 0), along))
        })
    }
}

impl Stencil for Horn {
    fn reach(&self) -> usize {
        1
    }

    #[inline(always)]
    fn values<W: Width>(&self, w: W, ground: &Ground<'_>, at: usize) -> W::Lanes {
        let (z, cols) = (ground.z, ground.spec.cols());
        let north = strip::<W>(z, at - cols, 1);
        let here = strip::<W>(z, at, 1);
        let south = strip::<W>(z, at + cols, 1);
        let (nw, n, ne) = (w.load(north, 0), w.load(north, 1), w.load(north, 2));
        let (sw, s, se) = (w.load(south, 0), w.load(south, 1), w.load(south, 2));
        let middle_row = w.load(here, 2) - w.load(here, 0);
        let middle_col = s - n;
        let quarter = w.splat(0.25);
        // The outer two are added first, so that a map turned or mirrored has the same bits.
        let along_row = (((ne - nw) + (se - sw)) + (middle_row + middle_row)) * quarter;
        let along_col = (((sw - nw) + (se - ne)) + (middle_col + middle_col)) * quarter;
        magnitude(w, along_row, along_col, ground.per_two_cells)
    }

    #[inline(always)]
    fn worst_u<W: Width>(&self, w: W, ground: &Ground<'_>, at: usize) -> W::Lanes {
        let (u, cols) = (ground.u, ground.spec.cols());
        highest_of_eight(w, u, at, cols)
    }

    fn reading(&self, ground: &Ground<'_>, cell: Cell) -> Reading {
        either(ground, |along, across| {
            weighted(|side| both_sides(ground, cell, (across.0 * side, across.1 * side), along))
                .or_else(|| {
                    weighted(|side| {
                        one_side(ground, cell, (across.0 * side, across.1 * side), along)
                    })
                })
        })
    }
}

/// A step by rows and columns.
type Step = (isize, isize);

/// The gradient from the rises over two cells along each axis, which are found by the steps along and across it.
fn either(ground: &Ground<'_>, rise: impl Fn(Step, Step) -> Option<Reading>) -> Reading {
    match (rise((0, 1), (1, 0)), rise((1, 0), (0, 1))) {
        (Some((along_row, u_row)), Some((along_col, u_col))) => {
            let rise_over_run = magnitude(Single, along_row, along_col, ground.per_two_cells);
            (rise_over_run, u_row.max(u_col))
        }
        _ => UNKNOWN,
    }
}

/// Rise between the two neighbours of the cell `off` from a cell.
fn both_sides(ground: &Ground<'_>, cell: Cell, off: Step, along: Step) -> Option<Reading> {
    let (before, u_before) = ground.known(cell, off.0 - along.0, off.1 - along.1)?;
    let (after, u_after) = ground.known(cell, off.0 + along.0, off.1 + along.1)?;
    Some((after - before, u_before.max(u_after)))
}

/// Twice the rise to the only neighbour known of the cell `off` from a cell.
fn one_side(ground: &Ground<'_>, cell: Cell, off: Step, along: Step) -> Option<Reading> {
    let (middle, u_middle) = ground.known(cell, off.0, off.1)?;
    let before = ground.known(cell, off.0 - along.0, off.1 - along.1);
    let after = ground.known(cell, off.0 + along.0, off.1 + along.1);
    let (rise, u) = match (before, after) {
        (Some((before, u)), None) => (middle - before, u),
        (None, Some((after, u))) => (after - middle, u),
        _ => return None,
    };
    Some((rise + rise, u.max(u_middle)))
}

/// Mean of the rises at the sides -1, 0 and 1 that are known, by the weights 1, 2, 1.
fn weighted(rise: impl Fn(isize) -> Option<Reading>) -> Option<Reading> {
    let (before, middle, after) = (rise(-1), rise(0), rise(1));
    let known = |side: Option<Reading>| f32::from(u8::from(side.is_some()));
    let weight = known(before) + known(after) + 2.0 * known(middle);
    if weight == 0.0 {
        return None;
    }
    let (before, middle, after) =
        (before.unwrap_or_default(), middle.unwrap_or_default(), after.unwrap_or_default());
    let sum = (before.0 + after.0) + (middle.0 + middle.0);
    Some((sum / weight, before.1.max(middle.1).max(after.1)))
}
