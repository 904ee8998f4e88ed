//! The exact viewshed: a horizon decides what is clear, the definition decides what is close.
//!
//! Octant by octant, row by row away from the observer, each cell is held against the outline of all grid edges in
//! front of it (see [`super::horizon`]). In an octant no sight line to row r crosses an edge beyond row r − 1, so
//! the outline of the rows before is the whole of what the definition tests. The
//! outline is rounded and the definition is not the same arithmetic: a cell within [`doubt`] of the outline is
//! decided by the definition itself, so that the answer is the definition's bit for bit.

use rayon::prelude::*;

use super::Observer;
use super::fan::{Fan, Limits};
use super::horizon::{Piece, merge};
use super::sight::Sight;
use crate::Layer;

/// What is known of a cell before its row is reached.
const HIDDEN: u8 = 0;
const VISIBLE: u8 = 1;
/// A lone known cell between unknown ones lies right before it, which has no edge to draw in the outline.
const BEHIND_A_LONE_CELL: u8 = 2;

/// Half the distance from 1 to the next number, the largest relative error of one operation.
const UNIT_ROUNDOFF: f64 = f64::EPSILON / 2.0;

/// Heights nearer to the horizon than this on row `along` are left to the definition, metres.
///
/// Let u be the unit roundoff and M a bound of |height − eye|. A projected height is at most M and wrong by at most 2u·M; t is wrong
/// by u/2; no line is steeper than 3M·along. A point of a line is then wrong by less than 10u·M·along, and where two lines
/// change over, at a place that is itself rounded, the outline by less than 28u·M·along. A height on row
/// `along` is that times along; the definition's own rounding is below 4u·M. The factor here is 8 times
/// the sum.
fn doubt(largest: f64, along: usize) -> f64 {
    256.0 * UNIT_ROUNDOFF * largest * (along * along) as f64
}

/// Magnitudes of heights for which the error bound holds: no overflow, no underflow, whatever the length of a line.
const SANE_HEIGHTS_M: std::ops::Range<f64> = 1e-100..1e100;

/// 1 where a cell of the window is seen, else 0.
pub(super) fn visible(elevation: &Layer, observer: &Observer, limits: &Limits) -> Vec<u8> {
    let look = Look::new(elevation, observer, limits);
    let window = limits.window();
    if !look.sight.is_known(look.sight.origin()) {
        return vec![HIDDEN; window.rows * window.cols];
    }
    let triangles: Vec<Triangle> =
        limits.fans().into_par_iter().map(|fan| look.triangle(fan)).collect();
    let mut visible = assemble(limits, &triangles);
    limits.cut_sector(&mut visible);
    visible
}

/// The cells in range of one octant, row by row; those out of range are left out.
struct Triangle {
    /// Where each row starts, from the observer's on, and the end of the last one.
    starts: Vec<usize>,
    cells: Vec<u8>,
}

impl Triangle {
    fn new(fan: Fan, limits: &Limits) -> Self {
        let mut starts = vec![0];
        let mut end = 0;
        for along in 0..=fan.max_along {
            let Some(reach) = limits.reach(along, along.min(fan.max_across)) else { break };
            end += reach + 1;
            starts.push(end);
        }
        Self { starts, cells: vec![HIDDEN; end] }
    }

    fn rows(&self) -> usize {
        self.starts.len() - 1
    }

    fn row(&self, along: usize) -> &[u8] {
        if along < self.rows() {
            &self.cells[self.starts[along]..self.starts[along + 1]]
        } else {
            &[]
        }
    }

    fn get(&self, along: usize, across: usize) -> u8 {
        self.row(along).get(across).copied().unwrap_or(HIDDEN)
    }

    fn row_mut(&mut self, along: usize) -> &mut [u8] {
        &mut self.cells[self.starts[along]..self.starts[along + 1]]
    }

    /// Notes that the cells right behind one must be looked at by the definition.
    fn mark_behind(&mut self, along: usize, across: usize) {
        let shared = gcd(along, across);
        let (step_along, step_across) = (along / shared, across / shared);
        let (mut along, mut across) = (along + step_along, across + step_across);
        while along < self.rows() {
            if let Some(cell) = self.row_mut(along).get_mut(across) {
                *cell = BEHIND_A_LONE_CELL;
            }
            along += step_along;
            across += step_across;
        }
    }
}

fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// One row of an octant: places and heights, NaN where unknown.
#[derive(Default)]
struct Row {
    t: Vec<f64>,
    y: Vec<f64>,
    height: Vec<f64>,
}

struct Look<'a> {
    sight: Sight<'a>,
    observer: &'a Observer,
    limits: &'a Limits,
    eye: f64,
    /// Largest magnitude of any height in play, metres; `None` if the error bound does not hold for it.
    largest: Option<f64>,
}

impl<'a> Look<'a> {
    fn new(elevation: &'a Layer, observer: &'a Observer, limits: &'a Limits) -> Self {
        let sight = Sight::new(elevation, observer.cell, observer.body_radius_m);
        let eye = sight.height(sight.origin(), 0, 0) + observer.height_m;
        let window = limits.window();
        let west = window.col - elevation.spec().first().col;
        let highest = (window.row..window.row + window.rows)
            .flat_map(|row| &elevation.values().row(row)[west..west + window.cols])
            .fold(0.0_f32, |highest, height| highest.max(height.abs()));
        let drop_m = sight.drop_m(window.rows, window.cols).abs();
        let largest = f64::from(highest) + drop_m + eye.abs() + observer.target_height_m.abs();
        // A NaN is not in the range either.
        let largest = SANE_HEIGHTS_M.contains(&largest).then_some(largest);
        Self { sight, observer, limits, eye, largest }
    }

    fn by_definition(&self, fan: Fan, along: usize, across: usize) -> bool {
        let Observer { height_m, target_height_m, .. } = *self.observer;
        self.sight.reaches_in(fan.octant, along, across, height_m, target_height_m)
    }

    fn triangle(&self, fan: Fan) -> Triangle {
        let mut triangle = Triangle::new(fan, self.limits);
        let Some(largest) = self.largest else {
            for along in 0..triangle.rows() {
                for (across, cell) in triangle.row_mut(along).iter_mut().enumerate() {
                    *cell = u8::from(self.by_definition(fan, along, across));
                }
            }
            return triangle;
        };
        if triangle.rows() == 0 {
            // A range that is not a number reaches nothing.
            return triangle;
        }
        triangle.row_mut(0)[0] = VISIBLE;
        let (mut row, mut before) = (Row::default(), Row::default());
        let (mut outline, mut fresh, mut upper) = (Vec::new(), Vec::new(), Vec::new());
        for along in 1..triangle.rows() {
            let reach = triangle.row(along).len() - 1;
            // The last crossing in range may lie between a cell in range and one beyond.
            let width = (reach + 1).min(along.min(fan.max_across));
            self.read(&mut row, fan, along, width);
            let doubt = doubt(largest, along) / along as f64;
            self.judge(fan, along, &row, &outline, doubt, triangle.row_mut(along));
            draw(&row, &before, along, &mut fresh, &mut triangle);
            merge(&outline, &fresh, row.t[width], &mut upper);
            std::mem::swap(&mut outline, &mut upper);
            std::mem::swap(&mut row, &mut before);
        }
        triangle
    }

    fn read(&self, row: &mut Row, fan: Fan, along: usize, width: usize) {
        let (origin, length) = (self.sight.origin(), along as f64);
        row.height.clear();
        row.height.extend((0..=width).map(|across| {
            let index = fan.octant.index(origin, along, across);
            let height = self.sight.height(index, along, across);
            if self.sight.is_known(index) { height } else { f64::NAN }
        }));
        row.y.clear();
        row.y.extend(row.height.iter().map(|height| (height - self.eye) / length));
        row.t.clear();
        row.t.extend((0..=width).map(|across| across as f64 / length));
    }

    /// Holds the cells of a row against the outline of the rows before; `doubt` is in the outline's scale.
    fn judge(
        &self,
        fan: Fan,
        along: usize,
        row: &Row,
        outline: &[Piece],
        doubt: f64,
        cells: &mut [u8],
    ) {
        let mut next = 0;
        let raised = self.observer.target_height_m;
        for (across, cell) in cells.iter_mut().enumerate() {
            let (t, height) = (row.t[across], row.height[across]);
            if height.is_nan() {
                *cell = HIDDEN;
                continue;
            }
            while outline.get(next).is_some_and(|piece| piece.end < t) {
                next += 1;
            }
            // Two pieces may meet here, at different heights beside a hole.
            let top = outline[next..]
                .iter()
                .take(2)
                .filter(|piece| piece.start <= t)
                .map(|piece| piece.at(t))
                .fold(f64::NEG_INFINITY, f64::max);
            let above = (height + raised - self.eye) / along as f64 - top;
            *cell = if above < -doubt {
                HIDDEN
            } else if above > doubt && *cell != BEHIND_A_LONE_CELL {
                VISIBLE
            } else {
                u8::from(self.by_definition(fan, along, across))
            };
        }
    }
}

/// The pieces of a row's own edges and of those that join it to the row before, upper ones only.
fn draw(row: &Row, before: &Row, along: usize, fresh: &mut Vec<Piece>, triangle: &mut Triangle) {
    fresh.clear();
    let width = row.t.len() - 1;
    let known = |across: usize| !row.y[across].is_nan();
    for across in 0..=width {
        if !known(across) {
            continue;
        }
        let here = (row.t[across], row.y[across]);
        let side = (across < width && known(across + 1))
            .then(|| Piece::between(here, (row.t[across + 1], row.y[across + 1])));
        let inward = (0 < across && across < width && !before.y[across].is_nan())
            .then(|| Piece::between(here, (before.t[across], before.y[across])));
        match (side, inward) {
            (Some(side), Some(inward)) if inward.slope() > side.slope() => {
                fresh.push(inward);
                if inward.end < side.end {
                    fresh.push(side.from(inward.end));
                }
            }
            (Some(piece), _) | (None, Some(piece)) => fresh.push(piece),
            (None, None) => {
                if across == 0 || !known(across - 1) {
                    triangle.mark_behind(along, across);
                }
            }
        }
    }
}

/// Lays the octants side by side.
fn assemble(limits: &Limits, triangles: &[Triangle]) -> Vec<u8> {
    let window = limits.window();
    let [north, _, west, _] = limits.sides();
    let mut visible = vec![HIDDEN; window.rows * window.cols];
    visible.par_chunks_mut(window.cols).enumerate().for_each(|(row, cells)| {
        let along = row.abs_diff(north);
        let pair = if row <= north { 0 } else { 2 };
        let (left, right) = cells.split_at_mut(west);
        let fill = |cells: &mut dyn Iterator<Item = (usize, &mut u8)>, side: usize| {
            let steep = triangles[pair + side].row(along);
            for (across, cell) in cells {
                *cell = if across <= along {
                    steep.get(across).copied().unwrap_or(HIDDEN)
                } else {
                    triangles[4 + pair + side].get(across, along)
                };
            }
        };
        fill(&mut left.iter_mut().rev().enumerate().map(|(i, cell)| (i + 1, cell)), 0);
        fill(&mut right.iter_mut().enumerate(), 1);
    });
    visible
}
