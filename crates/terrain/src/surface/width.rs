//! How many cells are worked on at once: one, or as many as a vector register holds.
//!
//! No result depends on it. Every step is one addition, subtraction, multiplication, division, square root or
//! comparison of IEEE 754 in single precision, in the same order at any width; nothing is fused.

use std::ops::{Add, Div, Mul, Sub};

use fearless_simd::{Level, Select, Simd, SimdBase, SimdFloat};

/// A way to take cells from planes and put them back.
pub(super) trait Width: Copy {
    /// The cells taken at once.
    type Lanes: Copy
        + Add<Output = Self::Lanes>
        + Sub<Output = Self::Lanes>
        + Mul<Output = Self::Lanes>
        + Div<Output = Self::Lanes>;

    /// How many.
    const CELLS: usize;

    /// The cells of a plane from `at` on.
    fn load(self, plane: &[f32], at: usize) -> Self::Lanes;

    /// Puts cells back.
    fn store(self, lanes: Self::Lanes, plane: &mut [f32], at: usize);

    /// The same number in all of them.
    fn splat(self, value: f32) -> Self::Lanes;

    /// Square roots.
    fn root(self, a: Self::Lanes) -> Self::Lanes;

    /// `then` where `a > b`, else `otherwise`.
    fn where_above(
        self,
        a: Self::Lanes,
        b: Self::Lanes,
        then: Self::Lanes,
        otherwise: Self::Lanes,
    ) -> Self::Lanes;

    /// The larger of two numbers; `b` if they compare equal or not at all.
    #[inline(always)]
    fn larger(self, a: Self::Lanes, b: Self::Lanes) -> Self::Lanes {
        self.where_above(a, b, a, b)
    }

    /// The smaller of two numbers; `b` if they compare equal or not at all.
    #[inline(always)]
    fn smaller(self, a: Self::Lanes, b: Self::Lanes) -> Self::Lanes {
        self.where_above(b, a, a, b)
    }

    /// A number that a layer may hold: what overflowed, to an infinity or to the difference of two, is the
    /// largest number.
    #[inline(always)]
    fn held(self, a: Self::Lanes) -> Self::Lanes {
        self.smaller(a, self.splat(f32::MAX))
    }
}

/// One cell after the other.
#[derive(Clone, Copy)]
pub(super) struct Single;

impl Width for Single {
    type Lanes = f32;

    const CELLS: usize = 1;

    #[inline(always)]
    fn load(self, plane: &[f32], at: usize) -> f32 {
        plane[at]
    }

    #[inline(always)]
    fn store(self, lanes: f32, plane: &mut [f32], at: usize) {
        plane[at] = lanes;
    }

    #[inline(always)]
    fn splat(self, value: f32) -> f32 {
        value
    }

    #[inline(always)]
    fn root(self, a: f32) -> f32 {
        a.sqrt()
    }

    #[inline(always)]
    fn where_above(self, a: f32, b: f32, then: f32, otherwise: f32) -> f32 {
        if a > b { then } else { otherwise }
    }
}

/// As many cells as the instruction set's registers hold.
#[derive(Clone, Copy)]
pub(super) struct Wide<S>(S);

impl<S: Simd> Width for Wide<S> {
    type Lanes = S::f32s;

    const CELLS: usize = <S::f32s as SimdBase<S>>::LEN;

    #[inline(always)]
    fn load(self, plane: &[f32], at: usize) -> S::f32s {
        S::f32s::from_slice(self.0, &plane[at..at + Self::CELLS])
    }

    #[inline(always)]
    fn store(self, lanes: S::f32s, plane: &mut [f32], at: usize) {
        lanes.store_slice(&mut plane[at..at + Self::CELLS]);
    }

    #[inline(always)]
    fn splat(self, value: f32) -> S::f32s {
        S::f32s::splat(self.0, value)
    }

    #[inline(always)]
    fn root(self, a: S::f32s) -> S::f32s {
        a.sqrt()
    }

    #[inline(always)]
    fn where_above(self, a: S::f32s, b: S::f32s, then: S::f32s, otherwise: S::f32s) -> S::f32s {
        a.simd_gt(b).select(then, otherwise)
    }
}

/// Something to do with cells, as many at once as there is room for.
pub(super) trait Job {
    /// Does it.
    fn run<W: Width>(self, width: W);
}

/// The instructions to do a job with, or none but those for one cell at a time.
#[derive(Clone, Copy)]
pub(super) struct Instructions(pub(super) Option<Level>);

impl Instructions {
    /// The widest that this processor has.
    pub(super) fn widest() -> Self {
        Self(Some(Level::new()))
    }

    /// Does a job with them.
    pub(super) fn run(self, job: impl Job) {
        match self.0 {
            Some(level) => run_wide(level, job),
            None => job.run(Single),
        }
    }
}

/// On x86-64 one of three widths: what SSE 4.2 adds to SSE2 is of little use here, and would be compiled, too.
#[cfg(target_arch = "x86_64")]
fn run_wide(level: Level, job: impl Job) {
    if let Some(simd) = level.as_avx512() {
        return simd.vectorize(
            #[inline(always)]
            || job.run(Wide(simd)),
        );
    }
    if let Some(simd) = level.as_avx2() {
        return simd.vectorize(
            #[inline(always)]
            || job.run(Wide(simd)),
        );
    }
    match level.as_sse2() {
        Some(simd) => simd.vectorize(
            #[inline(always)]
            || job.run(Wide(simd)),
        ),
        None => job.run(Single),
    }
}

/// Other processors have one width.
#[cfg(not(target_arch = "x86_64"))]
fn run_wide(level: Level, job: impl Job) {
    fearless_simd::dispatch!(level, simd => job.run(Wide(simd)));
}
