//! The horizon of one octant, kept on rays.

use fearless_simd::{Select, Simd, SimdBase, SimdFrom, SimdMask, f32x16};

use super::super::fan::Fan;

/// Rays for each cell of the row they aim at: with one, half the cells would lie midway between two rays.
const FINE: usize = 2;

/// Rows of the near field, whose rays aim at the cells of its last row.
const NEAR: usize = 64;

/// A block of rows is this part of its distance.
const ROWS_A_BLOCK: usize = 32;

// From the first lane to the last, rays drift against cells by less than one place.
const _: () = assert!(ROWS_A_BLOCK >= FINE * LANES && NEAR >= ROWS_A_BLOCK);

/// Longest block, rows.
const LONGEST_BLOCK: usize = 64;

/// Height of unknown ground relative to the eye: lower than any, so that it never blocks.
pub(super) const ABYSS: f32 = -1e30;

/// Slope of a ray that has met no ground: below that of any ground, above that of unknown ground at any distance.
const OPEN: f32 = -1e24;

/// Cells or rays worked on at once, with any instruction set.
pub(super) const LANES: usize = 16;

/// Places of a row of heights before its first cell.
pub(super) const BEFORE: usize = 2;

/// Places of a row of heights behind its last cell: blocks of lanes reach over its end.
pub(super) const BEHIND: usize = LANES + 4;

/// Places of a bank before its first ray.
const FIRST: usize = 1;

/// The steepest slopes met so far.
pub(super) struct Rays {
    /// Rays of even number, which aim at cells, and those of odd number, which aim midway between two: each from the axis on, after
    /// [`FIRST`] places. Apart, neighbours in a bank belong to neighbouring cells.
    banks: [Vec<f32>; FINE],
    spare: [Vec<f32>; FINE],
    /// All rays of the near field in their order, until it ends.
    near: [f32; FINE * NEAR + 2],
    max_along: usize,
    max_across: usize,
    /// The row the rays aim at, the last one of the current block.
    last: usize,
    /// Number of the farthest ray.
    end: usize,
}

impl Rays {
    pub(super) fn new(fan: Fan) -> Self {
        let places = FIRST + NEAR.max(fan.max_along) + LONGEST_BLOCK + 2 * LANES;
        let banks = [vec![OPEN; places], vec![OPEN; places]];
        Self {
            spare: banks.clone(),
            banks,
            near: [OPEN; FINE * NEAR + 2],
            max_along: fan.max_along,
            max_across: fan.max_across,
            last: NEAR,
            end: FINE * NEAR,
        }
    }

    /// Judges the cells of the next row, sixteen in each of `seen`, the nearest to the axis in the lowest bit; then takes it into
    /// the horizon. `heights` are relative to the eye, with [`BEFORE`] places before them and [`BEHIND`] of
    /// unknown ground behind.
    #[inline(always)]
    pub(super) fn advance<S: Simd>(
        &mut self,
        simd: S,
        along: usize,
        heights: &[f32],
        raised: f32,
        seen: &mut [u16],
    ) {
        let width = along.min(self.max_across);
        if along <= NEAR {
            self.judge_near(along, width, heights, raised, seen);
            self.raise_near(along, width, heights);
            if along == NEAR {
                for (ray, slope) in self.near.iter().enumerate() {
                    self.banks[ray % FINE][FIRST + ray / FINE] = *slope;
                }
            }
            return;
        }
        if along > self.last {
            self.aim(simd, along - 1);
        }
        self.judge(simd, along, width, heights, raised, seen);
        self.raise(simd, along, width, heights);
    }

    /// Judges a row of the near field, a cell between the two rays beside it.
    #[inline(always)]
    fn judge_near(
        &self,
        along: usize,
        width: usize,
        heights: &[f32],
        raised: f32,
        seen: &mut [u16],
    ) {
        let (mut ray, mut rest) = (0, 0);
        let inverse = 1.0 / along as f32;
        let (whole, part) = (FINE * NEAR / along, FINE * NEAR % along);
        let heights = heights[BEFORE..=BEFORE + width].chunks(LANES);
        for (heights, seen) in heights.zip(seen) {
            let mut bits = 0;
            for (lane, height) in heights.iter().enumerate() {
                let (near, far) = (self.near[ray], self.near[ray + 1]);
                let top = near + (far - near) * (rest as f32 * inverse);
                bits |= u16::from((height + raised) * inverse >= top) << lane;
                ray += whole;
                rest += part;
                if rest >= along {
                    rest -= along;
                    ray += 1;
                }
            }
            *seen = bits;
        }
    }

    /// Takes a row of the near field into the horizon.
    #[inline(always)]
    fn raise_near(&mut self, along: usize, width: usize, heights: &[f32]) {
        let inverse = 1.0 / (FINE * NEAR) as f32;
        let to_slope = 1.0 / along as f32;
        let heights = &heights[BEFORE..BEFORE + width + 2];
        let end = (width * FINE * NEAR / along).min(FINE * NEAR);
        for (ray, slope) in self.near[..=end].iter_mut().enumerate() {
            let (whole, rest) = (ray * along / (FINE * NEAR), ray * along % (FINE * NEAR));
            let (near, far) = (heights[whole], heights[whole + 1]);
            let found = (near + (far - near) * (rest as f32 * inverse)) * to_slope;
            *slope = if found > *slope { found } else { *slope };
        }
    }

    /// Begins a block after row `base`: rays that aim at the cells of its last row and the places between them.
    ///
    /// Ray j of the new ones lies `j·rows/last` places before that of the same number.
    #[inline(always)]
    fn aim<S: Simd>(&mut self, simd: S, base: usize) {
        let rows = (base / ROWS_A_BLOCK).clamp(1, LONGEST_BLOCK).min(self.max_along - base);
        let last = base + rows;
        let end = (FINE * self.max_across * last).div_ceil(base + 1).min(FINE * last);
        // Rays that end beside the map go on with the last horizon known.
        let farthest = self.banks[self.end % FINE][FIRST + self.end / FINE];
        for (parity, bank) in self.banks.iter_mut().enumerate() {
            bank[behind(parity, self.end)..].fill(farthest);
        }
        for (parity, fresh) in self.spare.iter_mut().enumerate() {
            let mut drift = Drift::new(simd, parity * rows, FINE * rows, last);
            for first in (0..=end / FINE).step_by(LANES) {
                // Number of the near ray, counted with the places before the first of both banks.
                let ray = FINE * (FIRST + first) + parity - drift.whole;
                let (side, at) = (ray % FINE, ray / FINE);
                let same = &self.banks[side][at - 1..][..=LANES];
                let other = &self.banks[1 - side][(ray - 1) / FINE..][..LANES];
                let [near, middle, far] = [&same[1..], other, &same[..LANES]].map(load(simd));
                drift.between(near, middle, far).store_slice(&mut fresh[FIRST + first..][..LANES]);
                drift.go_on();
            }
            fresh[behind(parity, end)..].fill(OPEN);
        }
        std::mem::swap(&mut self.banks, &mut self.spare);
        (self.last, self.end) = (last, end);
    }

    /// Judges a row: the sight line to cell c lies `FINE·c·(last − along)/along` rays beyond that of number `FINE·c`.
    #[inline(always)]
    fn judge<S: Simd>(
        &self,
        simd: S,
        along: usize,
        width: usize,
        heights: &[f32],
        raised: f32,
        seen: &mut [u16],
    ) {
        let inverse = 1.0 / along as f32;
        let mut drift = Drift::new(simd, 0, FINE * (self.last - along), along);
        for (first, seen) in (0..=width).step_by(LANES).zip(seen) {
            let (side, at) = (drift.whole % FINE, FIRST + first + drift.whole / FINE);
            let same = &self.banks[side][at..][..=LANES];
            let other = &self.banks[1 - side][at + side..][..LANES];
            let [near, middle, far] = [&same[..LANES], other, &same[1..]].map(load(simd));
            let top = drift.between(near, middle, far);
            let height = f32x16::from_slice(simd, &heights[BEFORE + first..][..LANES]);
            let is_seen = ((height + raised) * inverse).simd_ge(top);
            *seen = is_seen.to_bitmask() as u16;
            drift.go_on();
        }
    }

    /// Takes a row into the horizon: ray j meets it `j·(last − along)/(FINE·last)` cells before cell `j/FINE`.
    #[inline(always)]
    fn raise<S: Simd>(&mut self, simd: S, along: usize, width: usize, heights: &[f32]) {
        let step = self.last - along;
        let end = (FINE * width * self.last / along).min(self.end);
        let to_slope = 1.0 / along as f32;
        for (parity, bank) in self.banks.iter_mut().enumerate() {
            // A ray that aims midway starts half a cell before the next one.
            let start = parity * (self.last + step);
            let mut drift = Drift::new(simd, start, FINE * step, FINE * self.last);
            let slopes = bank[FIRST..].chunks_exact_mut(LANES);
            for (first, slopes) in (0..=end / FINE).step_by(LANES).zip(slopes) {
                let at = BEFORE + first + parity - drift.whole;
                let cells = &heights[at - 2..][..LANES + 2];
                let [near, middle, far] =
                    [&cells[2..], &cells[1..=LANES], &cells[..LANES]].map(load(simd));
                let found = drift.between(near, middle, far) * to_slope;
                found.max(f32x16::from_slice(simd, slopes)).store_slice(slopes);
                drift.go_on();
            }
        }
    }
}

/// First place of a bank behind ray `end`.
fn behind(parity: usize, end: usize) -> usize {
    FIRST + (end + FINE - parity) / FINE
}

#[inline(always)]
fn load<S: Simd>(simd: S) -> impl Fn(&[f32]) -> f32x16<S> {
    #[inline(always)]
    move |lanes| f32x16::from_slice(simd, lanes)
}

/// How far lines have drifted from the places of their number: a growing fraction, sixteen at once.
struct Drift<S: Simd> {
    /// Whole places of the first lane.
    whole: usize,
    /// What it has drifted beyond them, of `a_place`.
    rest: usize,
    step: usize,
    a_place: usize,
    /// What the lanes have drifted more than the first one. All counts are below 2²⁴ and so exact.
    more: f32x16<S>,
    limit: f32x16<S>,
    inverse: f32x16<S>,
}

impl<S: Simd> Drift<S> {
    #[inline(always)]
    fn new(simd: S, start: usize, step: usize, a_place: usize) -> Self {
        Self {
            whole: 0,
            rest: start,
            step,
            a_place,
            more: f32x16::simd_from(simd, std::array::from_fn::<f32, LANES, _>(|i| i as f32))
                * step as f32,
            limit: f32x16::splat(simd, a_place as f32),
            inverse: f32x16::splat(simd, 1.0 / a_place as f32),
        }
    }

    /// What lies at the lines, between `near` and `middle` or, for lanes that have drifted a place more than the first, `middle` and `far`.
    #[inline(always)]
    fn between(&self, near: f32x16<S>, middle: f32x16<S>, far: f32x16<S>) -> f32x16<S> {
        let rest = self.more + self.rest as f32;
        let is_past = rest.simd_ge(self.limit);
        let share = is_past.select(rest - self.limit, rest) * self.inverse;
        let (from, to) = (is_past.select(middle, near), is_past.select(far, middle));
        from + (to - from) * share
    }

    /// The next lanes: less than a place further.
    #[inline(always)]
    fn go_on(&mut self) {
        self.rest += LANES * self.step;
        if self.rest >= self.a_place {
            self.rest -= self.a_place;
            self.whole += 1;
        }
    }
}
