//! The numbers that planes hold, and the instructions they are worked on with.

use fearless_simd::{Level, Simd};

use super::fuse::Fusion;
use super::width::{Single, Wide, Width};
use crate::{Number, Rule, Settings};

/// What planes hold: f32 or f64.
pub trait MapNumber: Number + Wideable {}

impl MapNumber for f32 {}
impl MapNumber for f64 {}

/// Something to do with cells, as many at once as there is room for.
pub trait Job<F> {
    /// Does it.
    fn run<W: Width<F>>(self, width: W);
}

/// A number that vector registers hold.
pub trait Wideable: Sized {
    /// Does a job with an instruction set's registers.
    fn run_wide<S: Simd>(simd: S, job: impl Job<Self>);

    /// Fuses planes by a rule. Not generic, so that the many ways to do it are compiled once, with this crate.
    fn fuse_planes(fusion: Fusion<'_, Self>, rule: Rule, settings: &Settings<'_>);
}

impl Wideable for f32 {
    #[inline(always)]
    fn run_wide<S: Simd>(simd: S, job: impl Job<Self>) {
        job.run(Wide(simd));
    }

    fn fuse_planes(fusion: Fusion<'_, Self>, rule: Rule, settings: &Settings<'_>) {
        rule.closed_form(settings, fusion);
    }
}

impl Wideable for f64 {
    #[inline(always)]
    fn run_wide<S: Simd>(simd: S, job: impl Job<Self>) {
        job.run(Wide(simd));
    }

    fn fuse_planes(fusion: Fusion<'_, Self>, rule: Rule, settings: &Settings<'_>) {
        rule.closed_form(settings, fusion);
    }
}

/// The instructions to do a job with, or none but those for one cell at a time; the result does not depend on
/// them.
#[derive(Clone, Copy)]
pub(super) struct Instructions(pub Option<Level>);

/// No register holds more cells.
const WIDEST: usize = 16;

impl Instructions {
    /// The widest that this processor has.
    pub(super) fn widest() -> Self {
        Self(Some(Level::new()))
    }

    /// Does a job on so many cells; one by one if they may not fill a register.
    pub(super) fn run<F: MapNumber>(self, cells: usize, job: impl Job<F>) {
        match self.0 {
            Some(level) if cells >= WIDEST => run_wide(level, job),
            _ => job.run(Single),
        }
    }
}

/// On x86-64 one of three widths: what SSE 4.2 adds to SSE2 is of no use here, and would be compiled, too.
#[cfg(target_arch = "x86_64")]
fn run_wide<F: MapNumber>(level: Level, job: impl Job<F>) {
    if let Some(simd) = level.as_avx512() {
        return simd.vectorize(
            #[inline(always)]
            || F::run_wide(simd, job),
        );
    }
    if let Some(simd) = level.as_avx2() {
        return simd.vectorize(
            #[inline(always)]
            || F::run_wide(simd, job),
        );
    }
    match level.as_sse2() {
        Some(simd) => simd.vectorize(
            #[inline(always)]
            || F::run_wide(simd, job),
        ),
        None => job.run(Single),
    }
}

/// Other processors have one width.
#[cfg(not(target_arch = "x86_64"))]
fn run_wide<F: MapNumber>(level: Level, job: impl Job<F>) {
    fearless_simd::dispatch!(level, simd => F::run_wide(simd, job));
}

/// The name of the instruction set that maps are made with on this machine, to be printed beside measurements.
#[must_use]
pub fn instruction_set() -> String {
    let level = format!("{:?}", Level::new());
    level.split(['(', ' ']).next().unwrap_or_default().to_owned()
}
