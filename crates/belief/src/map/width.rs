//! How many cells are worked on at once: one, or as many as a vector register holds.

use std::ops::{Add, Div, Mul, Sub};

use fearless_simd::{Bytes, Select, Simd, SimdBase, SimdFloat, SimdWiden, f32x4, u8x16, u16x8};

use super::table::{Column, LAST_ROW, REGISTER_ROWS};
use crate::Number;
use crate::interest::closed::{Binary, Format, Lanes, exponential};

/// A way to take cells from planes and put them back.
pub trait Width<F>: Copy {
    /// The cells taken at once.
    type Lanes: Lanes;

    /// How many.
    const CELLS: usize;

    /// The cells of a plane from `at` on.
    fn load(self, plane: &[F], at: usize) -> Self::Lanes;

    /// Readings from `at` on; single precision fits into any plane's numbers.
    fn load_readings(self, readings: &[f32], at: usize) -> Self::Lanes;

    /// The same number in all of them.
    fn splat(self, value: F) -> Self::Lanes;

    /// Puts cells back.
    fn store(self, lanes: Self::Lanes, plane: &mut [F], at: usize);

    /// Looks up as many rows of a table's column as `found` has cells, each discounted by its u.
    fn look_up(self, column: &Column<F>, rows: &[u8], uncertainty: &[F], found: &mut [F]);
}

/// One cell after the other.
#[derive(Clone, Copy)]
pub(super) struct Single;

impl<F: Number> Width<F> for Single {
    type Lanes = F;

    const CELLS: usize = 1;

    #[inline(always)]
    fn load(self, plane: &[F], at: usize) -> F {
        plane[at]
    }

    #[inline(always)]
    fn load_readings(self, readings: &[f32], at: usize) -> F {
        F::from_f64(f64::from(readings[at]))
    }

    #[inline(always)]
    fn splat(self, value: F) -> F {
        value
    }

    #[inline(always)]
    fn store(self, lanes: F, plane: &mut [F], at: usize) {
        plane[at] = lanes;
    }

    #[inline(always)]
    fn look_up(self, column: &Column<F>, rows: &[u8], uncertainty: &[F], found: &mut [F]) {
        for ((found, &row), &u) in found.iter_mut().zip(rows).zip(uncertainty) {
            *found = column.at(row) * (F::one() - u);
        }
    }
}

/// As many cells as the instruction set's registers hold.
#[derive(Clone, Copy)]
pub(super) struct Wide<S>(pub S);

impl<S: Simd> Width<f32> for Wide<S> {
    type Lanes = Vector<S, S::f32s>;

    const CELLS: usize = <S::f32s as SimdBase<S>>::LEN;

    #[inline(always)]
    fn load(self, plane: &[f32], at: usize) -> Self::Lanes {
        let cells = <Self as Width<f32>>::CELLS;
        Vector::of(S::f32s::from_slice(self.0, &plane[at..at + cells]))
    }

    #[inline(always)]
    fn load_readings(self, readings: &[f32], at: usize) -> Self::Lanes {
        self.load(readings, at)
    }

    #[inline(always)]
    fn splat(self, value: f32) -> Self::Lanes {
        Vector::of(S::f32s::splat(self.0, value))
    }

    #[inline(always)]
    fn store(self, lanes: Self::Lanes, plane: &mut [f32], at: usize) {
        lanes.lanes.store_slice(&mut plane[at..at + <Self as Width<f32>>::CELLS]);
    }

    #[inline(always)]
    fn look_up(self, column: &Column<f32>, rows: &[u8], uncertainty: &[f32], found: &mut [f32]) {
        let done = match column.register() {
            Some(masses) => look_up_in_registers(self, masses, rows, uncertainty, found),
            None => 0,
        };
        Single.look_up(column, &rows[done..], &uncertainty[done..], &mut found[done..]);
    }
}

/// Looks up what fills registers and tells how many cells that were. Row numbers above 15 count as 15.
#[inline(always)]
fn look_up_in_registers<S: Simd>(
    wide: Wide<S>,
    masses: &[f32; REGISTER_ROWS],
    rows: &[u8],
    uncertainty: &[f32],
    found: &mut [f32],
) -> usize {
    let cells = <Wide<S> as Width<f32>>::CELLS;
    let (whole, at_once) = (cells == REGISTER_ROWS, <S::u8s as SimdBase<S>>::LEN);
    let mut done = 0;
    while whole && done + at_once <= rows.len() {
        gather(wide, masses, &rows[done..], &mut found[done..]);
        done += at_once;
    }
    let tables = split(wide.0, masses);
    while !whole && done + REGISTER_ROWS <= rows.len() {
        shuffle(wide.0, tables, &rows[done..done + REGISTER_ROWS], &mut found[done..]);
        done += REGISTER_ROWS;
    }
    let mut at = 0;
    while at < done {
        let (u, mass) = (wide.load(uncertainty, at), wide.load(found, at));
        wide.store(mass * (u.one_of() - u), found, at);
        at += cells;
    }
    done
}

/// Looks up as many rows as there are bytes in a register that holds the whole table.
#[inline(always)]
fn gather<S: Simd>(wide: Wide<S>, masses: &[f32; REGISTER_ROWS], rows: &[u8], found: &mut [f32]) {
    let table = S::f32s::from_slice(wide.0, masses);
    let rows = S::u8s::from_slice(wide.0, &rows[..<S::u8s as SimdBase<S>>::LEN]);
    let (low, high) = rows.min(LAST_ROW).widen();
    let ((first, second), (third, fourth)) = (low.widen(), high.widen());
    let cells = <Wide<S> as Width<f32>>::CELLS;
    pick::<S>(table, first).store_slice(&mut found[..cells]);
    pick::<S>(table, second).store_slice(&mut found[cells..2 * cells]);
    pick::<S>(table, third).store_slice(&mut found[2 * cells..3 * cells]);
    pick::<S>(table, fourth).store_slice(&mut found[3 * cells..4 * cells]);
}

/// One number of a register for each row: its four bytes are those from byte 4 · row on.
#[inline(always)]
fn pick<S: Simd>(table: S::f32s, rows: S::u32s) -> S::f32s {
    let first = rows << 2;
    let two = first | (first << 8);
    let four = two | (two << 16);
    table.swizzle_dyn((four + 0x0302_0100).to_bytes())
}

/// The first, second, third and fourth bytes of sixteen numbers.
#[inline(always)]
fn split<S: Simd>(simd: S, masses: &[f32; REGISTER_ROWS]) -> [u8x16<S>; 4] {
    let mut tables = [u8x16::splat(simd, 0); 4];
    for (byte, table) in tables.iter_mut().enumerate() {
        *table = u8x16::from_fn(simd, |row| masses[row].to_le_bytes()[byte]);
    }
    tables
}

/// Looks up sixteen rows: each byte of a number in a table of its own.
#[inline(always)]
fn shuffle<S: Simd>(simd: S, tables: [u8x16<S>; 4], rows: &[u8], found: &mut [f32]) {
    let rows = u8x16::from_slice(simd, rows).min(LAST_ROW);
    let [first, second, third, fourth] = [
        tables[0].swizzle_dyn(rows),
        tables[1].swizzle_dyn(rows),
        tables[2].swizzle_dyn(rows),
        tables[3].swizzle_dyn(rows),
    ];
    // From four registers of bytes to sixteen numbers of four bytes each.
    join(first.zip_low(second), third.zip_low(fourth), &mut found[..8]);
    join(first.zip_high(second), third.zip_high(fourth), &mut found[8..16]);
}

/// Eight numbers from their lower and their upper two bytes.
#[inline(always)]
fn join<S: Simd>(lower: u8x16<S>, upper: u8x16<S>, found: &mut [f32]) {
    let (lower, upper): (u16x8<S>, u16x8<S>) = (lower.bitcast(), upper.bitcast());
    let (first, second): (f32x4<S>, f32x4<S>) =
        (lower.zip_low(upper).bitcast(), lower.zip_high(upper).bitcast());
    first.store_slice(&mut found[..4]);
    second.store_slice(&mut found[4..8]);
}

impl<S: Simd> Width<f64> for Wide<S> {
    type Lanes = Vector<S, S::f64s>;

    const CELLS: usize = <S::f64s as SimdBase<S>>::LEN;

    #[inline(always)]
    fn load(self, plane: &[f64], at: usize) -> Self::Lanes {
        let cells = <Self as Width<f64>>::CELLS;
        Vector::of(S::f64s::from_slice(self.0, &plane[at..at + cells]))
    }

    #[inline(always)]
    fn load_readings(self, readings: &[f32], at: usize) -> Self::Lanes {
        let readings = &readings[at..at + <Self as Width<f64>>::CELLS];
        Vector::of(S::f64s::from_fn(self.0, |cell| f64::from(readings[cell])))
    }

    #[inline(always)]
    fn splat(self, value: f64) -> Self::Lanes {
        Vector::of(S::f64s::splat(self.0, value))
    }

    #[inline(always)]
    fn store(self, lanes: Self::Lanes, plane: &mut [f64], at: usize) {
        lanes.lanes.store_slice(&mut plane[at..at + <Self as Width<f64>>::CELLS]);
    }

    #[inline(always)]
    fn look_up(self, column: &Column<f64>, rows: &[u8], uncertainty: &[f64], found: &mut [f64]) {
        Single.look_up(column, rows, uncertainty, found);
    }
}

/// Numbers in a vector register.
#[derive(Clone, Copy)]
pub(super) struct Vector<S: Simd, V> {
    lanes: V,
    simd: S,
}

impl<S: Simd, V: SimdFloat<S>> Vector<S, V> {
    #[inline(always)]
    fn of(lanes: V) -> Self {
        Self { lanes, simd: lanes.token() }
    }
}

impl<S: Simd, V: SimdFloat<S>> Add for Vector<S, V> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::of(self.lanes + other.lanes)
    }
}

impl<S: Simd, V: SimdFloat<S>> Sub for Vector<S, V> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self::of(self.lanes - other.lanes)
    }
}

impl<S: Simd, V: SimdFloat<S>> Mul for Vector<S, V> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self::of(self.lanes * other.lanes)
    }
}

impl<S: Simd, V: SimdFloat<S>> Div for Vector<S, V> {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        Self::of(self.lanes / other.lanes)
    }
}

impl<S, V> Lanes for Vector<S, V>
where
    S: Simd,
    V: SimdFloat<S>,
    V::Element: Binary + Number,
{
    const SINGLE: bool = <V::Element as Lanes>::SINGLE;

    #[inline(always)]
    fn count(self, n: u32) -> Self {
        Self::of(V::splat(self.simd, <V::Element as Number>::count(n)))
    }

    #[inline(always)]
    fn value(self, value: f64) -> Self {
        Self::of(V::splat(self.simd, V::Element::from_f64(value)))
    }

    /// The same as a division by 2, which is exact either way.
    #[inline(always)]
    fn half(self) -> Self {
        self * self.value(0.5)
    }

    #[inline(always)]
    fn where_positive(self, then: Self, otherwise: Self) -> Self {
        let positive = self.lanes.simd_gt(self.zero_of().lanes);
        Self::of(positive.select(then.lanes, otherwise.lanes))
    }

    #[inline(always)]
    fn where_at_least(self, bound: Self, then: Self, otherwise: Self) -> Self {
        let at_least = self.lanes.simd_ge(bound.lanes);
        Self::of(at_least.select(then.lanes, otherwise.lanes))
    }

    #[inline(always)]
    fn lower(self, other: Self) -> Self {
        Self::of(other.lanes.simd_lt(self.lanes).select(other.lanes, self.lanes))
    }

    #[inline(always)]
    fn upper(self, other: Self) -> Self {
        Self::of(other.lanes.simd_gt(self.lanes).select(other.lanes, self.lanes))
    }

    #[inline(always)]
    fn root(self) -> Self {
        Self::of(self.lanes.sqrt())
    }

    #[inline(always)]
    fn power_of_e(self) -> Self {
        exponential(self)
    }
}

impl<S, V> Binary for Vector<S, V>
where
    S: Simd,
    V: SimdFloat<S>,
    V::Element: Binary + Number,
{
    const FORMAT: &'static Format = <V::Element as Binary>::FORMAT;

    #[inline(always)]
    fn scaled(self, shifted: Self) -> Self {
        let exponent = shifted.lanes.to_bits() << Self::FORMAT.mantissa_bits();
        Self::of(V::from_bits(self.lanes.to_bits() + exponent))
    }
}
