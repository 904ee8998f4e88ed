//! The fast viewshed: a sampled horizon carried outwards row by row (the XDraw family; Franklin, Ray and Mehta, 1994).
//!
//! Each octant keeps, for a set of rays from the eye, the steepest slope met so far. `XDraw` has one ray for
//! each cell of the row it is on and slides them all at every row, which smears the horizon a little each time.
//! Here rays stay what they are for a block of rows: those that aim at the cells of the block's last row, and one
//! between any two of them. Blocks are a fixed part of the distance, so that the horizon is resampled some
//! tens of times in all. Slopes are compared where a ray crosses a row; crossings with
//! the lines that run along the octant's axis are not looked at.
//!
//! Every octant is worked in the same order from its axis on, so that turned ground gives the turned answer, and
//! operations are never fused or reordered, so that the answer is the same with any instruction set.

#![expect(
    clippy::inline_always,
    reason = "an octant is compiled once for each instruction set, down to its last kernel"
)]

use fearless_simd::{Level, Select, Simd, SimdBase, SimdMask, dispatch, f32x8, f32x16};
use rayon::prelude::*;

use super::Observer;
use super::fan::{Fan, Limits};
use crate::Layer;

mod rays;
mod turn;

use rays::{ABYSS, BEFORE, BEHIND, LANES, Rays};
use turn::{TILE, WORD, bytes, turn_bits, turned, word};

/// Rows that are read and written at a time where rows of an octant are columns of the map.
const STRIP: usize = 2 * WORD;

/// Rows of the map that are read at a time where rows of an octant are columns of the map.
const LINES: usize = 2 * TILE;

/// 1 where a cell of the window is seen, else 0.
pub(super) fn visible(elevation: &Layer, observer: &Observer, limits: &Limits) -> Vec<u8> {
    visible_at(Level::new(), elevation, observer, limits)
}

/// The same with the instructions named.
fn visible_at(level: Level, elevation: &Layer, observer: &Observer, limits: &Limits) -> Vec<u8> {
    let window = limits.window();
    let mut visible = vec![0; window.rows * window.cols];
    if !elevation.is_known(observer.cell) {
        return visible;
    }
    let [north, _, west, _] = limits.sides();
    visible[north * window.cols + west] = 1;
    let look = Look { elevation, observer };
    wedges(&mut visible, limits).par_iter_mut().with_max_len(1).enumerate().for_each(
        |(index, wedge)| {
            dispatch!(level, simd => if index < 4 {
                look.steep(simd, wedge);
            } else {
                look.flat(simd, wedge);
            });
        },
    );
    limits.cut_range(&mut visible);
    limits.cut_sector(&mut visible);
    visible
}

/// An octant with the cells it judges.
struct Wedge<'a> {
    fan: Fan,
    is_south: bool,
    is_east: bool,
    /// Pieces of rows of the map, by their number of rows from the observer's. Diagonals belong to the octants along columns, axes
    /// to those in the east and in the south.
    cells: Vec<&'a mut [u8]>,
}

/// The octants in the order of [`Limits::fans`].
fn wedges<'a>(visible: &'a mut [u8], limits: &Limits) -> [Wedge<'a>; 8] {
    let [north, _, west, _] = limits.sides();
    let cols = limits.window().cols;
    let fans = limits.fans();
    let mut wedges = std::array::from_fn(|i| Wedge {
        fan: fans[i],
        is_south: i / 2 % 2 == 1,
        is_east: i % 2 == 1,
        // The observer's row is in the south.
        cells: if i / 2 % 2 == 1 { vec![] } else { vec![Default::default()] },
    });
    let (upper, lower) = visible.split_at_mut(north * cols);
    let upper = upper.rchunks_exact_mut(cols).zip(1..).map(|(row, away)| (row, away, 0));
    let lower = lower.chunks_exact_mut(cols).zip(0..).map(|(row, away)| (row, away, 2));
    for (row, away, first) in upper.chain(lower) {
        let (row_west, row_east) = row.split_at_mut(west);
        let (flat, steep) = row_west.split_at_mut(west - west.min(away));
        wedges[first].cells.push(steep);
        wedges[first + 4].cells.push(flat);
        let (steep, flat) = row_east.split_at_mut(row_east.len().min(away + 1));
        wedges[first + 1].cells.push(steep);
        wedges[first + 5].cells.push(flat);
    }
    wedges
}

struct Look<'a> {
    elevation: &'a Layer,
    observer: &'a Observer,
}

impl Look<'_> {
    /// An octant whose rows are rows of the map.
    #[inline(always)]
    fn steep<S: Simd>(&self, simd: S, wedge: &mut Wedge) {
        let fan = wedge.fan;
        let at = self.observer.cell;
        let centre = at.col - self.elevation.spec().first().col;
        let raised = self.observer.target_height_m as f32;
        let mut rays = Rays::new(fan);
        let mut heights = vec![ABYSS; BEFORE + fan.max_across + 1 + BEHIND];
        let mut seen = vec![0; (fan.max_across / WORD + 1) * (WORD / LANES)];
        for (along, cells) in wedge.cells.iter_mut().enumerate().skip(1) {
            let width = along.min(fan.max_across);
            let row = if wedge.is_south { at.row + along } else { at.row - along };
            let (row_heights, behind) = heights[BEFORE..].split_at_mut(width + 1);
            let left = if wedge.is_east { centre } else { centre - width };
            row_heights.copy_from_slice(&self.elevation.values().row(row)[left..=left + width]);
            self.lower(simd, row, left, row_heights);
            if !wedge.is_east {
                row_heights.reverse();
            }
            self.bend(row_heights, along);
            behind[..BEHIND].fill(ABYSS);
            rays.advance(simd, along, &heights, raised, &mut seen);
            let (parts, _) = seen.as_chunks();
            if wedge.is_east {
                for (cells, parts) in cells.chunks_mut(WORD).zip(parts) {
                    put(cells, bytes(simd, word(*parts)));
                }
            } else {
                // Its first cell is one beside the axis.
                let next = parts[1..].iter().copied().chain([[0; 4]]);
                for ((cells, parts), next) in cells.rchunks_mut(WORD).zip(parts).zip(next) {
                    let bits = word(*parts) >> 1 | word(next) << (WORD - 1);
                    let count = cells.len();
                    put(cells, bytes(simd, bits.reverse_bits() >> (WORD - count)));
                }
            }
        }
    }

    /// An octant whose rows are columns of the map: some of them at a time are copied out and their cells copied back.
    #[inline(always)]
    fn flat<S: Simd>(&self, simd: S, wedge: &mut Wedge) {
        let fan = wedge.fan;
        let raised = self.observer.target_height_m as f32;
        let mut rays = Rays::new(fan);
        // An odd number of cache lines, so that the strip's rows do not compete for the same places in a cache.
        let stride = ((BEFORE + fan.max_across + 1 + BEHIND).div_ceil(LANES) | 1) * LANES;
        let mut heights = vec![ABYSS; STRIP * stride];
        let words = fan.max_across / WORD + 1;
        let mut seen = vec![0; words * (WORD / LANES)];
        let mut squares = vec![[[0; WORD]; STRIP / WORD]; words];
        for first in (1..=fan.max_along).step_by(STRIP) {
            let rows = STRIP.min(fan.max_along + 1 - first);
            let widest = (first + rows - 1).min(fan.max_across);
            let strip = Strip { first, rows, widest, is_east: wedge.is_east };
            self.read(simd, strip, wedge.is_south, &mut heights, stride);
            for i in 0..rows {
                let along = first + i;
                let width = along.min(fan.max_across);
                let row = &mut heights[i * stride..][..BEFORE + width + 1 + BEHIND];
                self.bend(&mut row[BEFORE..=BEFORE + width], along);
                row[BEFORE + width + 1..].fill(ABYSS);
                rays.advance(simd, along, row, raised, &mut seen);
                let col = strip.col(i);
                for (squares, parts) in squares.iter_mut().zip(seen.as_chunks().0) {
                    squares[col / WORD][col % WORD] = word(*parts);
                }
            }
            strip.write(simd, &mut squares, wedge);
        }
    }

    /// Copies a strip's heights out, each column of the map to a row of `stride` places.
    #[inline(always)]
    fn read<S: Simd>(
        &self,
        simd: S,
        strip: Strip,
        is_south: bool,
        heights: &mut [f32],
        stride: usize,
    ) {
        let Strip { first, rows, widest, is_east } = strip;
        let at = self.observer.cell;
        let centre = at.col - self.elevation.spec().first().col;
        let left = if is_east { centre + first } else { centre + 1 - first - rows };
        let row = |across| if is_south { at.row + across } else { at.row - across };
        let mut lines = [[0.0; STRIP]; LINES];
        for across in (0..=widest).step_by(LINES) {
            // First all as they are: then many rows, each on a page of its own, are waited for at once.
            for (line, across) in lines.iter_mut().zip(across..=widest) {
                let values = &self.elevation.values().row(row(across))[left..left + rows];
                match values.as_array() {
                    Some(values) => *line = *values,
                    None => line[..rows].copy_from_slice(values),
                }
            }
            for (line, across) in lines.iter_mut().zip(across..=widest) {
                self.lower(simd, row(across), left, &mut line[..rows]);
            }
            let (lines, _) = lines.as_chunks::<TILE>();
            for (lines, across) in lines.iter().zip((across..).step_by(TILE)) {
                for col in (0..rows).step_by(TILE) {
                    let square = lines
                        .each_ref()
                        .map(|line| f32x8::from_slice(simd, &line[col..col + TILE]));
                    for (cells, col) in turned(square).iter().zip(col..rows) {
                        let place = strip.col(col) * stride + BEFORE + across;
                        cells.store_slice(&mut heights[place..place + TILE]);
                    }
                }
            }
        }
    }

    /// Makes the values of a piece of a row of the map heights relative to the eye; [`ABYSS`] where unknown.
    #[inline(always)]
    fn lower<S: Simd>(&self, simd: S, row: usize, left: usize, heights: &mut [f32]) {
        let u = &self.elevation.uncertainty().row(row)[left..left + heights.len()];
        let ground = self.elevation.value(self.observer.cell);
        let height_m = self.observer.height_m as f32;
        let (blocks, rest) = heights.as_chunks_mut::<LANES>();
        let (u_blocks, u_rest) = u.as_chunks();
        for (block, u) in blocks.iter_mut().zip(u_blocks) {
            let values = f32x16::load_array_ref(simd, block);
            let mut heights = (values - ground) - height_m;
            // Unknown cells hold a zero, so that elsewhere u need not be read.
            if values.simd_eq(0.0).any_true() {
                let is_known = f32x16::load_array_ref(simd, u).simd_lt(1.0);
                heights = is_known.select(heights, f32x16::splat(simd, ABYSS));
            }
            heights.store_array(block);
        }
        for (height, u) in rest.iter_mut().zip(u_rest) {
            *height = if *u < 1.0 { (*height - ground) - height_m } else { ABYSS };
        }
    }

    /// Lowers a row by the curvature of the body.
    fn bend(&self, heights: &mut [f32], along: usize) {
        let Some(radius_m) = self.observer.body_radius_m else { return };
        let spacing_m = self.elevation.spec().spacing_m();
        let scale = spacing_m * spacing_m / (2.0 * radius_m);
        for (across, height) in heights.iter_mut().enumerate() {
            *height -= ((along * along + across * across) as f64 * scale) as f32;
        }
    }
}

/// Some rows of an octant that are columns of the map.
#[derive(Clone, Copy)]
struct Strip {
    /// Steps along to the first one.
    first: usize,
    rows: usize,
    /// Steps across to the last cell of the last one.
    widest: usize,
    is_east: bool,
}

impl Strip {
    /// Number, from the west, of the column that is row `i`, and of the row that is column `i`.
    #[inline(always)]
    fn col(self, i: usize) -> usize {
        if self.is_east { i } else { self.rows - 1 - i }
    }

    /// Writes what is seen, a bit a cell, where it belongs on the map: for each word of cells across, the columns from the
    /// west on.
    #[inline(always)]
    fn write<S: Simd>(self, simd: S, words: &mut [[[u64; WORD]; STRIP / WORD]], wedge: &mut Wedge) {
        let Self { first, rows, widest, is_east } = self;
        for (number, squares) in words.iter_mut().enumerate().take(widest / WORD + 1) {
            for square in squares.iter_mut() {
                turn_bits(square);
            }
            for (bit, across) in (0..WORD).zip(WORD * number..=widest) {
                // Cells up to the diagonal, and on it, are the other octant's.
                let inner = (across + 1).saturating_sub(first);
                if inner >= rows || (across == 0 && !wedge.is_south) {
                    continue;
                }
                let (mut skip, start) = if is_east {
                    (inner, first + inner - (across + 1))
                } else {
                    (0, wedge.fan.max_along + 1 - first - rows)
                };
                let mut cells = &mut wedge.cells[across][start..start + rows - inner];
                for square in &squares[skip / WORD..] {
                    skip %= WORD;
                    let count = (WORD - skip).min(cells.len());
                    let (here, next) = std::mem::take(&mut cells).split_at_mut(count);
                    put(here, bytes(simd, square[bit] >> skip));
                    (skip, cells) = (0, next);
                }
            }
        }
    }
}

/// Writes the first of some bytes. A whole word of them is the common case, and its length need not be looked at.
#[inline(always)]
fn put(cells: &mut [u8], bytes: [u8; WORD]) {
    match cells.as_mut_array() {
        Some(cells) => *cells = bytes,
        None => cells.copy_from_slice(&bytes[..cells.len()]),
    }
}

#[cfg(test)]
mod tests {
    use wisdom_grid::{Cell, GridSpec};

    use super::*;
    use crate::unit_noise;

    #[test]
    fn the_widest_instructions_see_what_the_plainest_see() {
        let spec = GridSpec::new(290, 411, 1.0).unwrap();
        let mut layer = Layer::unknown(spec);
        for cell in spec.cells() {
            let key = [cell.row as u64, cell.col as u64];
            if unit_noise(&key) > 0.05 {
                layer.set(cell, (6.0 * unit_noise(&[key[0], key[1], 1])) as f32, 0.0);
            }
        }
        let observer = Observer {
            body_radius_m: Some(9000.0),
            ..Observer::all_round(Cell::new(101, 260), 7.0)
        };
        layer.set(observer.cell, 1.0, 0.0);
        let limits = Limits::new(&layer, &observer);
        let plain = visible_at(Level::baseline(), &layer, &observer, &limits);
        assert_eq!(visible(&layer, &observer, &limits), plain);
        assert!(plain.contains(&1) && plain.contains(&0));
    }
}
