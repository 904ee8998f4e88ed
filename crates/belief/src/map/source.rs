//! What one source says of every cell.

use super::MapNumber;
use super::table::{Column, Table};
use super::width::{Single, Width};
use crate::interest::closed::{Lanes, Masses, Sources};
use crate::{BeliefError, Number, ParadoxPolicy};

/// The masses of a source, in the manner of an [`Opinion`](crate::Opinion): the rest, up to 1, is ignorance.
///
/// Masses are taken as they are: numbers that are no masses (below 0, or with a sum above 1 by more than
/// rounding, or not numbers) give results that are none either, but do no harm beyond their cell.
#[derive(Debug, Clone, Copy)]
pub struct Planes<'a, F> {
    /// m(I).
    pub interesting: &'a [F],
    /// m(NI).
    pub not_interesting: &'a [F],
    /// m(I ∩ NI); none if left out.
    pub paradox: Option<&'a [F]>,
}

/// One source of a map.
#[derive(Debug, Clone, Copy)]
pub enum Source<'a, F> {
    /// Masses, already discounted.
    Planes(Planes<'a, F>),
    /// Classes: row numbers of a table. A number without a row says nothing.
    Classes {
        /// The row of each cell.
        rows: &'a [u8],
        /// What the rows say.
        table: &'a Table<F>,
        /// The uncertainty u of each cell, in [0, 1] (paper Eq. 4).
        uncertainty: &'a [F],
    },
    /// Readings on a scale cut into bands. NaN says nothing.
    Readings {
        /// The reading of each cell.
        values: &'a [f32],
        /// Where the bands meet, in rising order, one less than the table has rows: row 0 is below the first
        /// bound, row k from bound k − 1 (included) up to bound k (not included). Gaps are bands, too.
        bounds: &'a [f32],
        /// What the bands say.
        table: &'a Table<F>,
        /// The uncertainty u of each cell, in [0, 1] (paper Eq. 4).
        uncertainty: &'a [F],
    },
}

/// Refuses a plane of another length than the map.
pub(super) fn check_length(
    found: usize,
    expected: usize,
    plane: impl FnOnce() -> String,
) -> Result<(), BeliefError> {
    if found == expected {
        return Ok(());
    }
    Err(BeliefError::PlaneLength { plane: plane(), found, expected })
}

impl<F> Planes<'_, F> {
    pub(super) fn check(&self, index: usize, cells: usize) -> Result<(), BeliefError> {
        let name = |plane: &str| format!("{plane} of source {index}");
        check_length(self.interesting.len(), cells, || name("interesting"))?;
        check_length(self.not_interesting.len(), cells, || name("not_interesting"))?;
        self.paradox.map_or(Ok(()), |p| check_length(p.len(), cells, || name("paradox")))
    }
}

impl<F: MapNumber> Source<'_, F> {
    /// How many cells it speaks of.
    pub(super) fn cells(&self) -> usize {
        match self {
            Self::Planes(planes) => planes.interesting.len(),
            Self::Classes { rows, .. } => rows.len(),
            Self::Readings { values, .. } => values.len(),
        }
    }

    /// Refuses planes of another length and bounds that make no bands.
    pub(super) fn check(&self, index: usize, cells: usize) -> Result<(), BeliefError> {
        let name = |plane: &str| format!("{plane} of source {index}");
        match self {
            Self::Planes(planes) => planes.check(index, cells),
            Self::Classes { rows, uncertainty, .. } => {
                check_length(rows.len(), cells, || name("rows"))?;
                check_length(uncertainty.len(), cells, || name("uncertainty"))
            }
            Self::Readings { values, bounds, table, uncertainty } => {
                check_length(values.len(), cells, || name("values"))?;
                check_length(uncertainty.len(), cells, || name("uncertainty"))?;
                check_bounds(bounds, table.rows())
            }
        }
    }
}

fn check_bounds(bounds: &[f32], rows: usize) -> Result<(), BeliefError> {
    let steps = bounds.windows(2).take_while(|pair| pair[0] < pair[1]).count();
    let rising = if bounds.is_empty() { 0 } else { steps + 1 };
    let numbers = bounds.iter().all(|bound| !bound.is_nan());
    if numbers && rising == bounds.len() && bounds.len() + 1 == rows {
        return Ok(());
    }
    Err(BeliefError::BandBounds { found: bounds.len(), rising, rows })
}

/// How many cells of a source are looked up ahead: few enough to stay in the first cache.
pub(super) const BLOCK: usize = 256;

/// What a fusion asks of a table.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Wanted {
    /// m(I) and m(I ∩ NI) in one: all that Bel(I) alone asks under DSmC.
    Supporting,
    /// m(I) and m(NI): paradox that goes to ignorance is part of the rest.
    Opinion,
    /// m(I ∩ NI), too.
    Paradox,
}

/// Room for what was looked up of one source: m(I), m(NI), m(I ∩ NI).
pub(super) type Room<F> = [[F; BLOCK]; 3];

impl<'a, F: MapNumber> Source<'a, F> {
    /// Looks up the masses of a block of cells, at most [`BLOCK`], unless they are there already. What is
    /// [`Wanted::Supporting`] takes the place of m(I).
    #[inline(always)]
    pub(super) fn look_up<W: Width<F>>(
        &self,
        width: W,
        [from, to]: [usize; 2],
        room: &mut Room<F>,
        wanted: Wanted,
    ) {
        let Some(table) = self.table() else { return };
        let [i, n, p] = room;
        if wanted == Wanted::Supporting {
            return self.column(width, [from, to], &table.supporting, i);
        }
        self.column(width, [from, to], &table.interesting, i);
        self.column(width, [from, to], &table.not_interesting, n);
        if let (Wanted::Paradox, Some(column)) = (wanted, &table.paradox) {
            self.column(width, [from, to], column, p);
        }
    }

    fn table(&self) -> Option<&'a Table<F>> {
        match *self {
            Self::Planes(_) => None,
            Self::Classes { table, .. } | Self::Readings { table, .. } => Some(table),
        }
    }

    /// The block's planes: its own, or what was looked up.
    #[inline(always)]
    pub(super) fn planes<'b>(
        &self,
        [from, to]: [usize; 2],
        room: &'b Room<F>,
        wanted: Wanted,
    ) -> Planes<'b, F>
    where
        'a: 'b,
    {
        match *self {
            Self::Planes(Planes { interesting, not_interesting, paradox }) => Planes {
                interesting: &interesting[from..to],
                not_interesting: &not_interesting[from..to],
                paradox: paradox.map(|paradox| &paradox[from..to]),
            },
            Self::Classes { table, .. } | Self::Readings { table, .. } => {
                let [i, n, p] = room;
                Planes {
                    interesting: &i[..to - from],
                    not_interesting: &n[..to - from],
                    paradox: (table.paradox.is_some() && wanted == Wanted::Paradox)
                        .then(|| &p[..to - from]),
                }
            }
        }
    }

    /// One column of the table for a block of cells, discounted.
    #[inline(always)]
    fn column<W: Width<F>>(
        &self,
        width: W,
        [from, to]: [usize; 2],
        column: &Column<F>,
        found: &mut [F; BLOCK],
    ) {
        let found = &mut found[..to - from];
        match *self {
            Self::Planes(_) => {}
            Self::Classes { rows, uncertainty, .. } => {
                width.look_up(column, &rows[from..to], &uncertainty[from..to], found);
            }
            Self::Readings { values, bounds, uncertainty, .. } => {
                let (values, uncertainty) = (&values[from..to], &uncertainty[from..to]);
                sweep(width, to - from, Bands { values, bounds, column, uncertainty, found });
            }
        }
    }
}

/// Something done to cells at some place, at any width.
pub(super) trait Step<F> {
    /// Does it to the cells from `at` on.
    fn step<W: Width<F>>(&mut self, width: W, at: usize);
}

/// Goes through the cells, as many at once as there is room for; the last step overlaps the one before where
/// they do not come out even. There must be at least one width of cells, or none.
#[inline(always)]
pub(super) fn sweep_again<F: Number, W: Width<F>>(width: W, cells: usize, mut step: impl Step<F>) {
    let mut at = 0;
    while at < cells {
        step.step(width, at.min(cells - W::CELLS));
        at += W::CELLS;
    }
}

/// Goes through the cells: as many at once as there is room for, the last few one by one. For steps that must
/// not be taken twice, and few cells.
#[inline(always)]
pub(super) fn sweep<F: Number, W: Width<F>>(width: W, cells: usize, mut step: impl Step<F>) {
    let mut at = 0;
    while at + W::CELLS <= cells {
        step.step(width, at);
        at += W::CELLS;
    }
    while at < cells {
        step.step(Single, at);
        at += 1;
    }
}

/// Finds the bands of readings, and discounts what they say.
struct Bands<'a, F> {
    values: &'a [f32],
    bounds: &'a [f32],
    column: &'a Column<F>,
    uncertainty: &'a [F],
    found: &'a mut [F],
}

impl<F: Number> Step<F> for Bands<'_, F> {
    #[inline(always)]
    fn step<W: Width<F>>(&mut self, width: W, at: usize) {
        let value = width.load_readings(self.values, at);
        let mut mass = width.splat(self.column.at(0));
        for (row, &bound) in (1..=u8::MAX).zip(self.bounds) {
            let bound = value.value(f64::from(bound));
            mass = value.where_at_least(bound, width.splat(self.column.at(row)), mass);
        }
        let u = width.load(self.uncertainty, at);
        let kept = value.where_at_least(value, u.one_of() - u, u.zero_of());
        width.store(mass * kept, self.found, at);
    }
}

/// Some cells of all sources.
#[derive(Clone, Copy)]
pub(super) struct Cells<'a, F, W> {
    pub width: W,
    pub planes: &'a [Planes<'a, F>],
    /// None on the free model.
    pub policy: Option<ParadoxPolicy>,
    pub at: usize,
}

impl<F: Number, W: Width<F>> Sources<W::Lanes> for Cells<'_, F, W> {
    const MAP: bool = true;

    #[inline(always)]
    fn count(&self) -> usize {
        self.planes.len()
    }

    #[inline(always)]
    fn masses(&self, source: usize) -> Masses<W::Lanes> {
        let Planes { interesting, not_interesting, paradox } = self.planes[source];
        let i = self.width.load(interesting, self.at);
        let n = self.width.load(not_interesting, self.at);
        match (paradox, self.policy) {
            // What goes to ignorance is part of the rest already.
            (None, _) | (_, Some(ParadoxPolicy::ToIgnorance)) => [i, n, rest(n + i), i.zero_of()],
            (Some(paradox), policy) => {
                let p = self.width.load(paradox, self.at);
                let masses = [i, n, rest(p + n + i), p];
                match policy {
                    None => masses,
                    Some(policy) => policy.moved(masses),
                }
            }
        }
    }
}

/// What some masses leave of 1; none if that is no more than their rounding.
#[inline(always)]
fn rest<L: Lanes>(sum: L) -> L {
    let rest = sum.one_of() - sum;
    let rounding = if L::SINGLE { f64::from(f32::EPSILON) } else { crate::interest::ROUNDING };
    (rest - rest.value(rounding)).where_positive(rest, rest.zero_of())
}
