//! An expert's table as columns, to be looked up a whole map at a time.

use super::MapNumber;
use crate::{BeliefError, InterestMass, Number, Opinion};

/// The most rows a [`Table`] has: as many as a byte can number.
pub const MAX_ROWS: usize = 256;

/// Rows that fit one register: tables of fewer are looked up there, many cells at once.
pub(super) const REGISTER_ROWS: usize = 16;

/// The row of such a table that is kept free for whatever has none.
pub(super) const LAST_ROW: u8 = 15;

/// A table of opinions by row number; a number without a row is no opinion at all.
#[derive(Debug, Clone, PartialEq)]
pub struct Table<F> {
    rows: usize,
    pub(super) interesting: Column<F>,
    pub(super) not_interesting: Column<F>,
    /// Absent if no row has any.
    pub(super) paradox: Option<Column<F>>,
    /// m(I) + m(I ∩ NI): all that Bel(I) asks under DSmC.
    pub(super) supporting: Column<F>,
}

impl<F: MapNumber> Table<F> {
    /// The table with these rows.
    ///
    /// # Errors
    /// [`BeliefError::TableRows`] for more than [`MAX_ROWS`]; what is wrong with an opinion, as
    /// [`InterestMass::try_from`] says it.
    pub fn new(rows: &[Opinion]) -> Result<Self, BeliefError> {
        if rows.len() > MAX_ROWS {
            return Err(BeliefError::TableRows { rows: rows.len(), limit: MAX_ROWS });
        }
        rows.iter().try_for_each(|&row| InterestMass::try_from(row).map(|_| ()))?;
        let column = |of: fn(&Opinion) -> f64| Column::new(rows.iter().map(of));
        let any_paradox = rows.iter().any(|row| row.paradox > 0.0);
        Ok(Self {
            rows: rows.len(),
            interesting: column(|row| row.interesting),
            not_interesting: column(|row| row.not_interesting),
            paradox: any_paradox.then(|| column(|row| row.paradox)),
            supporting: column(|row| row.interesting + row.paradox),
        })
    }

    /// How many rows there are.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }
}

/// One mass of each row, and 0 where there is none.
#[derive(Debug, Clone, PartialEq)]
pub struct Column<F> {
    rows: usize,
    masses: [F; MAX_ROWS],
}

impl<F: Number> Column<F> {
    fn new(masses: impl ExactSizeIterator<Item = f64>) -> Self {
        let mut column = Self { rows: masses.len(), masses: [F::zero(); MAX_ROWS] };
        for (slot, mass) in column.masses.iter_mut().zip(masses) {
            *slot = F::from_f64(mass);
        }
        column
    }

    /// The mass of a row.
    #[inline(always)]
    pub(super) fn at(&self, row: u8) -> F {
        self.masses[usize::from(row)]
    }
}

impl Column<f32> {
    /// The masses as a register holds them, if that is all and one is left for whatever has no row.
    #[inline(always)]
    pub(super) fn register(&self) -> Option<&[f32; REGISTER_ROWS]> {
        if self.rows < REGISTER_ROWS { self.masses.first_chunk() } else { None }
    }
}
