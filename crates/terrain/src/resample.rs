//! Resampling: a grid's values on another grid of the same projection.

use std::fmt;
use std::str::FromStr;

use rayon::prelude::*;
use wisdom_grid::{GridSpec, Raster, Window};

use crate::{GridFile, TerrainError};

/// How far a place may be from a cell's edge or centre and count as on it, in cells: more than rounding of map
/// coordinates leaves (1e-9 m of 10 000 km), less than any value could tell.
const SNAP: f64 = 1e-6;

/// How far two areas may differ and be the same, in cells of the source: rounding of the overlaps' sums.
const AREA_TOLERANCE: f64 = 1e-6;

/// How values are carried from one grid to another.
///
/// As text: `nearest`, `bilinear`, `average`, `mode`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Resampling {
    /// The value of the source cell in which the centre lies: for classes.
    Nearest,
    /// Linear between the centres of the four source cells around: for heights on a grid as fine or finer.
    Bilinear,
    /// The mean of the source cells, each by the area that is covered: for heights on a coarser grid.
    Average,
    /// The value that covers the largest area, the smaller one of two that tie: for classes on a coarser grid.
    Mode,
}

impl Resampling {
    /// Every way, in the order of the documentation.
    pub const ALL: [Self; 4] = [Self::Nearest, Self::Bilinear, Self::Average, Self::Mode];
}

impl fmt::Display for Resampling {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Nearest => "nearest",
            Self::Bilinear => "bilinear",
            Self::Average => "average",
            Self::Mode => "mode",
        })
    }
}

impl FromStr for Resampling {
    type Err = TerrainError;

    fn from_str(text: &str) -> Result<Self, TerrainError> {
        let known = Self::ALL.into_iter().find(|way| way.to_string() == text);
        known.ok_or_else(|| TerrainError::Resampling { found: text.to_owned() })
    }
}

/// The cells of a grid that values on another may be made from: those under it and two around, cut at the edges; none
/// if the two do not meet.
#[must_use]
pub fn covering(of: GridSpec, under: GridSpec) -> Option<Window> {
    let along = |low_m: f64, high_m: f64, count: usize| {
        let low = ((low_m / of.spacing_m()).floor() - 2.0).max(0.0) as usize;
        let high = ((high_m / of.spacing_m()).ceil() + 2.0).max(0.0) as usize;
        let (low, high) = (low.min(count), high.min(count));
        (low, high - low)
    };
    let west_m = under.west_m() - of.west_m();
    let north_m = of.north_m() - under.north_m();
    let side = |count: usize| count as f64 * under.spacing_m();
    let (col, cols) = along(west_m, west_m + side(under.cols()), of.cols());
    let (row, rows) = along(north_m, north_m + side(under.rows()), of.rows());
    let window = Window { row, col, rows, cols };
    (!window.is_empty()).then_some(window)
}

/// A file's values on another grid of the same projection: any origin, spacing and extent.
///
/// Whether the projections agree is the caller's to check ([`Crs::same_projection`](crate::Crs::same_projection)). A cell
/// is unknown where the grids do not overlap. Nearest and bilinear: also where the source cell around the centre is
/// unknown; of the other corners that bilinear uses, unknown ones are left out and the weights of the rest scaled to sum
/// to one. Average and mode: where no known source cell is covered. Sums are of f64 above a base height, so
/// that nothing is lost at −4500 m, and a field of one value keeps it. The same bits at any number of threads.
///
/// ```
/// # use wisdom_grid::{Cell, GridSpec};
/// use wisdom_terrain::{Resampling, resample};
/// let asc = b"ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2\n3 4\n";
/// let fine = wisdom_terrain::format::read("dem.asc", asc)?;
/// let coarse = resample(&fine, GridSpec::new(1, 1, 2.0)?, Resampling::Average);
/// assert_eq!(coarse.raster[Cell::new(0, 0)], 2.5);
/// # Ok::<(), wisdom_terrain::TerrainError>(())
/// ```
#[must_use]
pub fn resample(source: &GridFile, onto: GridSpec, way: Resampling) -> GridFile {
    let from = source.raster.spec();
    let across = Axis {
        start: (onto.west_m() - from.west_m()) / from.spacing_m(),
        step: onto.spacing_m() / from.spacing_m(),
        cells: from.cols(),
    };
    let down = Axis {
        start: (from.north_m() - onto.north_m()) / from.spacing_m(),
        step: across.step,
        cells: from.rows(),
    };
    let fill = |value: &(dyn Fn(&Line, &Line) -> Option<f32> + Sync)| {
        let rows: Vec<Line> = (0..onto.rows()).map(|row| down.line(row, way)).collect();
        let cols: Vec<Line> = (0..onto.cols()).map(|col| across.line(col, way)).collect();
        let (mut raster, mut known) = (Raster::filled(onto, 0.0), Raster::filled(onto, false));
        raster
            .values_mut()
            .par_chunks_mut(onto.cols())
            .zip(known.values_mut().par_chunks_mut(onto.cols()))
            .zip(&rows)
            .for_each(|((values, knowns), row)| {
                for ((out, is_known), col) in values.iter_mut().zip(knowns).zip(&cols) {
                    if let Some(found) = value(row, col) {
                        (*out, *is_known) = (found, true);
                    }
                }
            });
        (raster, known)
    };
    let cells = Source { values: source.raster.values(), known: source.known.values(), from };
    let (raster, known) = match way {
        Resampling::Nearest => fill(&|row, col| cells.nearest(row, col)),
        Resampling::Bilinear => {
            fill(&|row, col| cells.weighted(row, col, Some(cells.nearest(row, col)?)))
        }
        Resampling::Average => fill(&|row, col| cells.weighted(row, col, None)),
        Resampling::Mode => fill(&|row, col| cells.commonest(row, col)),
    };
    GridFile { raster, known, crs: source.crs.clone(), about: source.about.clone() }
}

/// Rows or columns of the new grid, measured in rows or columns of the source from its first edge.
struct Axis {
    start: f64,
    step: f64,
    /// Rows or columns of the source.
    cells: usize,
}

/// What one row or column of the new grid takes of the source's.
struct Line {
    /// The one in which the centre lies.
    nearest: Option<usize>,
    /// The first one used.
    first: usize,
    /// How much of each from there on.
    weights: Vec<f64>,
}

impl Axis {
    fn line(&self, index: usize, way: Resampling) -> Line {
        let centre = snapped(self.start + (index as f64 + 0.5) * self.step);
        let nearest = self.cell(centre.floor());
        let (first, weights) = match way {
            Resampling::Nearest => (0, Vec::new()),
            Resampling::Bilinear => self.corners(centre),
            Resampling::Average | Resampling::Mode => self.overlaps(index),
        };
        Line { nearest, first, weights }
    }

    fn cell(&self, place: f64) -> Option<usize> {
        (place >= 0.0 && place < self.cells as f64).then_some(place as usize)
    }

    /// The two cells whose centres lie around a place, without one beyond the edge.
    fn corners(&self, centre: f64) -> (usize, Vec<f64>) {
        let place = snapped(centre - 0.5);
        let low = place.floor();
        let share = place - low;
        match (self.cell(low), self.cell(low + 1.0)) {
            (Some(low), Some(_)) => (low, vec![1.0 - share, share]),
            (Some(low), None) => (low, vec![1.0]),
            (None, Some(high)) => (high, vec![1.0]),
            (None, None) => (0, Vec::new()),
        }
    }

    /// The cells that one of the new grid covers, and how much of each.
    fn overlaps(&self, index: usize) -> (usize, Vec<f64>) {
        let low = snapped(self.start + index as f64 * self.step).max(0.0);
        let high = snapped(self.start + (index as f64 + 1.0) * self.step).min(self.cells as f64);
        if low >= high {
            return (0, Vec::new());
        }
        let cells = low.floor() as usize..high.ceil() as usize;
        let share = |cell: usize| high.min((cell + 1) as f64) - low.max(cell as f64);
        (cells.start, cells.map(share).collect())
    }
}

/// A place with rounding's last digits taken off where it lies on an edge (or, less a half, on a centre).
fn snapped(place: f64) -> f64 {
    let nearest = place.round();
    if (place - nearest).abs() < SNAP { nearest } else { place }
}

/// The source's values.
struct Source<'a> {
    values: &'a [f32],
    known: &'a [bool],
    from: GridSpec,
}

impl Source<'_> {
    fn at(&self, row: usize, col: usize) -> Option<f32> {
        let index = row * self.from.cols() + col;
        self.known[index].then(|| self.values[index])
    }

    fn nearest(&self, row: &Line, col: &Line) -> Option<f32> {
        self.at(row.nearest?, col.nearest?)
    }

    /// The known source cells of a cell of the new grid, with their weights, row by row.
    fn for_each_known(&self, row: &Line, col: &Line, mut each: impl FnMut(f32, f64)) {
        for (down, of_row) in row.weights.iter().enumerate() {
            let start = (row.first + down) * self.from.cols() + col.first;
            let here = start..start + col.weights.len();
            let cells = self.values[here.clone()].iter().zip(&self.known[here]);
            for ((&value, &known), of_col) in cells.zip(&col.weights) {
                if known {
                    each(value, of_row * of_col);
                }
            }
        }
    }

    /// The weighted mean, as a base (if none is given, the first value) and the mean of what lies above it.
    fn weighted(&self, row: &Line, col: &Line, mut base: Option<f32>) -> Option<f32> {
        let (mut sum, mut total) = (0.0, 0.0);
        self.for_each_known(row, col, |value, weight| {
            let base = *base.get_or_insert(value);
            sum += (f64::from(value) - f64::from(base)) * weight;
            total += weight;
        });
        // Nothing above the base: the base itself, and its sign if it is a zero.
        let mean = |base| if sum == 0.0 { base } else { (f64::from(base) + sum / total) as f32 };
        base.filter(|_| total > 0.0).map(mean)
    }

    fn commonest(&self, row: &Line, col: &Line) -> Option<f32> {
        let mut areas: Vec<(f32, f64)> = Vec::new();
        self.for_each_known(row, col, |value, weight| {
            match areas.iter_mut().find(|(class, _)| *class == value) {
                Some((_, area)) => *area += weight,
                None => areas.push((value, weight)),
            }
        });
        let largest = areas.iter().map(|&(_, area)| area).fold(0.0, f64::max);
        let tied = areas.into_iter().filter(|&(_, area)| area >= largest - AREA_TOLERANCE);
        tied.map(|(class, _)| class).min_by(f32::total_cmp)
    }
}
