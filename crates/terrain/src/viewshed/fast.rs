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

use fearless_simd::{Level, dispatch};

use super::Observer;
use super::fan::{Fan, Limits};
use crate::Layer;

/// Rays for each cell of the row they aim at: with one, half the cells would lie midway between two rays.
const FINE: usize = 2;

/// Rows of the near field, whose rays aim at the cells of its last row.
const NEAR: usize = 64;

/// A block of rows is this part of its distance.
const ROWS_A_BLOCK: usize = 32;

/// Longest block, rows.
const LONGEST_BLOCK: usize = 64;

/// Height of unknown ground relative to the eye: lower than any, so that it never blocks.
const ABYSS: f32 = -1e30;

/// Slope of a ray that has met no ground: below that of any ground, above that of unknown ground at any distance.
const OPEN: f32 = -1e24;

/// Rows that are read and written at a time where rows of an octant are columns of the map.
const STRIP: usize = 64;

/// Rows of the map that are turned at a time.
const TILE: usize = 8;

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
    let look = Look { elevation, observer, limits, level };
    let [north_rows, _, west, _] = limits.sides();
    let (north, south) = visible.split_at_mut(north_rows * window.cols);
    south[west] = 1;
    let fans = limits.fans();
    let half = |visible: &mut [u8], [a, b, c, d]: [usize; 4]| {
        look.steep(fans[a], visible, a);
        look.steep(fans[b], visible, b);
        look.flat(fans[c], visible, c);
        look.flat(fans[d], visible, d);
    };
    rayon::join(|| half(north, [0, 1, 4, 5]), || half(south, [2, 3, 6, 7]));
    limits.cut_range(&mut visible);
    limits.cut_sector(&mut visible);
    visible
}

struct Look<'a> {
    elevation: &'a Layer,
    observer: &'a Observer,
    limits: &'a Limits,
    level: Level,
}

impl Look<'_> {
    /// An octant whose rows are rows of the map.
    fn steep(&self, fan: Fan, visible: &mut [u8], index: usize) {
        let (is_south, is_east) = (index / 2 % 2 == 1, index % 2 == 1);
        let window = self.limits.window();
        let [north, _, west, _] = self.limits.sides();
        let mut rays = Rays::new(fan);
        let mut heights = vec![ABYSS; fan.max_across + 3];
        let mut seen = vec![0; fan.max_across + 1];
        for along in 1..=fan.max_along {
            let width = along.min(fan.max_across);
            let row = if is_south {
                self.observer.cell.row + along
            } else {
                self.observer.cell.row - along
            };
            let (values, u) =
                (self.elevation.values().row(row), self.elevation.uncertainty().row(row));
            let centre = self.observer.cell.col - self.elevation.spec().first().col;
            let out = &mut heights[1..=width + 1];
            dispatch!(self.level, _simd => {
                if is_east {
                    let span = centre..=centre + width;
                    self.lower(out, values[span.clone()].iter(), u[span].iter());
                } else {
                    let span = centre - width..=centre;
                    self.lower(out, values[span.clone()].iter().rev(), u[span].iter().rev());
                }
            });
            self.bend(out, along);
            heights[width + 2] = ABYSS;
            let raised = self.observer.target_height_m as f32;
            dispatch!(self.level, _simd => rays.advance(along, &heights, raised, &mut seen));
            let start = if is_south { along } else { north - along } * window.cols;
            let row = &mut visible[start..start + window.cols];
            if is_east {
                row[west..=west + width].copy_from_slice(&seen[..=width]);
            } else {
                for (cell, seen) in row[west - width..=west].iter_mut().rev().zip(&seen) {
                    *cell = *seen;
                }
            }
        }
    }

    /// An octant whose rows are columns of the map: some of them at a time are copied out and their cells copied back.
    fn flat(&self, fan: Fan, visible: &mut [u8], index: usize) {
        let (is_south, is_east) = (index / 2 % 2 == 1, index % 2 == 1);
        let window = self.limits.window();
        let [north, _, west, _] = self.limits.sides();
        let at = self.observer.cell;
        let mut rays = Rays::new(fan);
        // An odd number of cache lines, so that the strip's rows do not compete for the same places in a cache.
        let stride = ((fan.max_across + 3 + TILE).div_ceil(16) | 1) * 16;
        let mut heights = vec![ABYSS; STRIP * stride];
        let mut seen = vec![0; STRIP * stride];
        let mut tile = [[0.0; STRIP]; TILE];
        let mut bytes = [[0; STRIP]; TILE];
        let raised = self.observer.target_height_m as f32;
        for first in (1..=fan.max_along).step_by(STRIP) {
            let rows = STRIP.min(fan.max_along + 1 - first);
            let widest = (first + rows - 1).min(fan.max_across);
            // The leftmost column of the strip on the map.
            let left = if is_east { first } else { first + rows - 1 };
            let centre = at.col - self.elevation.spec().first().col;
            let col = if is_east { centre + left } else { centre - left };
            let place = |i: usize| if is_east { i } else { rows - 1 - i };
            for across in (0..=widest).step_by(TILE) {
                let tile_rows = TILE.min(widest + 1 - across);
                for (i, line) in tile.iter_mut().enumerate().take(tile_rows) {
                    let row = if is_south { at.row + across + i } else { at.row - across - i };
                    let values = &self.elevation.values().row(row)[col..col + rows];
                    let u = &self.elevation.uncertainty().row(row)[col..col + rows];
                    dispatch!(self.level, _simd => self.lower(&mut line[..rows], values.iter(), u.iter()));
                }
                for i in 0..rows {
                    let out = &mut heights[place(i) * stride + across + 1..][..TILE];
                    for (out, line) in out.iter_mut().zip(&tile) {
                        *out = line[i];
                    }
                }
            }
            for i in 0..rows {
                let along = first + i;
                let width = along.min(fan.max_across);
                let row = &mut heights[i * stride..][..width + 3];
                row[width + 2] = ABYSS;
                self.bend(&mut row[1..=width + 1], along);
                let seen = &mut seen[i * stride..][..=width];
                dispatch!(self.level, _simd => rays.advance(along, row, raised, seen));
            }
            let (window_col, skip) =
                (if is_east { west + left } else { west - left }, usize::from(!is_south));
            for group in (skip..=widest).step_by(TILE) {
                for i in 0..rows {
                    let cells = &seen[place(i) * stride + group..][..TILE];
                    for (line, cell) in bytes.iter_mut().zip(cells) {
                        line[i] = *cell;
                    }
                }
                for (line, across) in bytes.iter().zip(group..=widest) {
                    let row = if is_south { across } else { north - across };
                    let cells = &mut visible[row * window.cols + window_col..][..rows];
                    // Cells up to the diagonal, and on it, are the other octant's.
                    let inner = (across + 1).saturating_sub(first).min(rows);
                    let own = if is_east { inner..rows } else { 0..rows - inner };
                    cells[own.clone()].copy_from_slice(&line[own]);
                }
            }
        }
    }

    /// Heights relative to the eye; `ABYSS` where unknown.
    #[expect(clippy::inline_always, reason = "compiled once for each instruction set")]
    #[inline(always)]
    fn lower<'b>(
        &self,
        out: &mut [f32],
        values: impl Iterator<Item = &'b f32>,
        u: impl Iterator<Item = &'b f32>,
    ) {
        let ground = self.elevation.value(self.observer.cell);
        let height_m = self.observer.height_m as f32;
        for ((out, &value), &u) in out.iter_mut().zip(values).zip(u) {
            *out = if u < 1.0 { (value - ground) - height_m } else { ABYSS };
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

/// The horizon of an octant on its rays, [`FINE`] of them for each cell of the row they aim at.
struct Rays {
    /// Steepest slope met so far, ray by ray from the axis on, after one place of padding.
    slopes: Vec<f32>,
    spare: Vec<f32>,
    /// The current row with its midpoints, after one place of padding.
    fine: Vec<f32>,
    max_along: usize,
    max_across: usize,
    /// The row the rays aim at, the last one of the current block.
    last: usize,
    /// Number of the farthest ray.
    end: usize,
}

impl Rays {
    fn new(fan: Fan) -> Self {
        let most = FINE * (NEAR.max(fan.max_along) + LONGEST_BLOCK) + 8;
        Self {
            slopes: vec![OPEN; most],
            spare: vec![OPEN; most],
            fine: vec![ABYSS; FINE * fan.max_across + 2],
            max_along: fan.max_along,
            max_across: fan.max_across,
            last: NEAR,
            end: FINE * NEAR,
        }
    }

    /// Judges the cells of the next row and takes it into the horizon. `heights` are relative to the eye, after one place
    /// of padding and with one behind.
    #[expect(clippy::inline_always, reason = "compiled once for each instruction set")]
    #[inline(always)]
    fn advance(&mut self, along: usize, heights: &[f32], raised: f32, seen: &mut [u8]) {
        let width = along.min(self.max_across);
        if along <= NEAR {
            self.judge_near(along, width, heights, raised, seen);
            self.raise_near(along, width, heights);
            return;
        }
        if along > self.last {
            self.aim(along - 1);
        }
        self.judge(along, width, heights, raised, seen);
        self.refine(width, heights);
        self.raise(along, width);
    }

    /// Judges a row of the near field, a cell between the two rays beside it.
    #[expect(clippy::inline_always, reason = "compiled once for each instruction set")]
    #[inline(always)]
    fn judge_near(
        &self,
        along: usize,
        width: usize,
        heights: &[f32],
        raised: f32,
        seen: &mut [u8],
    ) {
        let (mut ray, mut rest) = (0, 0);
        let inverse = 1.0 / along as f32;
        let (whole, part) = (FINE * NEAR / along, FINE * NEAR % along);
        for (cell, &height) in seen[..=width].iter_mut().zip(&heights[1..]) {
            let (near, far) = (self.slopes[ray + 1], self.slopes[ray + 2]);
            let top = near + (far - near) * (rest as f32 * inverse);
            *cell = u8::from((height + raised) * inverse >= top);
            ray += whole;
            rest += part;
            if rest >= along {
                rest -= along;
                ray += 1;
            }
        }
    }

    /// Takes a row of the near field into the horizon.
    #[expect(clippy::inline_always, reason = "compiled once for each instruction set")]
    #[inline(always)]
    fn raise_near(&mut self, along: usize, width: usize, heights: &[f32]) {
        let inverse = 1.0 / (FINE * NEAR) as f32;
        let to_slope = 1.0 / along as f32;
        let end = (width * FINE * NEAR / along).min(FINE * NEAR);
        for (ray, slope) in self.slopes[1..=end + 1].iter_mut().enumerate() {
            let (whole, rest) = (ray * along / (FINE * NEAR), ray * along % (FINE * NEAR));
            let (near, far) = (heights[whole + 1], heights[whole + 2]);
            let found = (near + (far - near) * (rest as f32 * inverse)) * to_slope;
            *slope = if found > *slope { found } else { *slope };
        }
    }

    /// Begins a block after row `base`: rays that aim at the cells of its last row and the places between them.
    #[expect(clippy::inline_always, reason = "compiled once for each instruction set")]
    #[inline(always)]
    fn aim(&mut self, base: usize) {
        let rows = (base / ROWS_A_BLOCK).clamp(1, LONGEST_BLOCK).min(self.max_along - base);
        let last = base + rows;
        let end = (FINE * self.max_across * last).div_ceil(base + 1).min(FINE * last);
        // Rays that end beside the map go on with the last horizon known.
        let farthest = self.slopes[self.end + 1];
        self.slopes[self.end + 2..].fill(farthest);
        let inverse = 1.0 / last as f32;
        let (mut k, mut first) = (0, 0);
        while first <= end {
            let next = ((k + 1) * last).div_ceil(rows).min(end + 1);
            let count = next - first;
            let near = &self.slopes[first + 1 - k..][..count];
            let far = &self.slopes[first - k..][..count];
            let fresh = &mut self.spare[first + 1..][..count];
            let rest = (first * rows - k * last) as i32;
            for i in 0..count {
                let share = (rest + i as i32 * rows as i32) as f32 * inverse;
                fresh[i] = near[i] + (far[i] - near[i]) * share;
            }
            first = next;
            k += 1;
        }
        self.spare[end + 2..].fill(OPEN);
        std::mem::swap(&mut self.slopes, &mut self.spare);
        (self.last, self.end) = (last, end);
    }

    /// Judges a row: the sight line to cell c lies `FINE·c·(last − along)/along` rays beyond that of the same number.
    #[expect(clippy::inline_always, reason = "compiled once for each instruction set")]
    #[inline(always)]
    fn judge(&self, along: usize, width: usize, heights: &[f32], raised: f32, seen: &mut [u8]) {
        let step = FINE * (self.last - along);
        let inverse = 1.0 / along as f32;
        let (mut k, mut first) = (0, 0);
        while first <= width {
            // The cells whose lines lie between k and k + 1 rays beyond.
            let next =
                if step == 0 { width + 1 } else { ((k + 1) * along).div_ceil(step).min(width + 1) };
            let count = next - first;
            let rays = self.slopes[FINE * first + k + 1..][..FINE * count].chunks_exact(FINE);
            let heights = &heights[first + 1..][..count];
            let seen = &mut seen[first..][..count];
            let mut rest = (first * step - k * along) as i32;
            for ((seen, height), rays) in seen.iter_mut().zip(heights).zip(rays) {
                let top = rays[0] + (rays[1] - rays[0]) * (rest as f32 * inverse);
                *seen = u8::from((height + raised) * inverse >= top);
                rest += step as i32;
            }
            first = next;
            k += 1;
        }
    }

    /// The row with its midpoints.
    #[expect(clippy::inline_always, reason = "compiled once for each instruction set")]
    #[inline(always)]
    fn refine(&mut self, width: usize, heights: &[f32]) {
        let fine = self.fine[1..].chunks_exact_mut(FINE);
        for ((fine, here), next) in fine.zip(&heights[1..=width]).zip(&heights[2..]) {
            fine[0] = *here;
            fine[1] = (here + next) * 0.5;
        }
        self.fine[FINE * width + 1] = heights[width + 1];
    }

    /// Takes the refined row into the horizon: ray j meets it `j·(last − along)/last` places before the one of the same number.
    #[expect(clippy::inline_always, reason = "compiled once for each instruction set")]
    #[inline(always)]
    fn raise(&mut self, along: usize, width: usize) {
        let step = self.last - along;
        let end = (FINE * width * self.last / along).min(self.end);
        let (to_slope, inverse) = (1.0 / along as f32, 1.0 / self.last as f32);
        let (mut k, mut first) = (0, 0);
        while first <= end {
            let next =
                if step == 0 { end + 1 } else { ((k + 1) * self.last).div_ceil(step).min(end + 1) };
            let count = next - first;
            let near = &self.fine[first + 1 - k..][..count];
            let far = &self.fine[first - k..][..count];
            let slopes = &mut self.slopes[first + 1..][..count];
            let rest = (first * step - k * self.last) as i32;
            for i in 0..count {
                let share = (rest + i as i32 * step as i32) as f32 * inverse;
                let found = (near[i] + (far[i] - near[i]) * share) * to_slope;
                slopes[i] = if found > slopes[i] { found } else { slopes[i] };
            }
            first = next;
            k += 1;
        }
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
