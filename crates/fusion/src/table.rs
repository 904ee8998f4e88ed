//! Look-up tables: from a reading to an opinion (paper Tables 1 to 3).

use wisdom_belief::{InterestMass, Opinion};

use crate::FusionError;

/// The largest class that a reading (f32) holds exactly.
const MAX_CLASS: u32 = 1 << 24;

/// A row for readings in the half-open band `[lo, hi)`, in the table's unit; bounds may be infinite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// The least reading of the band.
    pub lo: f64,
    /// The least reading above the band.
    pub hi: f64,
    /// What the expert says of such a reading.
    pub opinion: Opinion,
}

/// A row for readings that name a class.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Class {
    /// The class.
    pub class: i32,
    /// What the expert says of it.
    pub opinion: Opinion,
}

/// The rows of a table, all of one kind; their order is kept, and a row is known by its place in it.
#[derive(Debug, Clone, PartialEq)]
pub enum Rows {
    /// Bands of a quantity that varies continuously.
    Bands(Vec<Band>),
    /// Classes.
    Classes(Vec<Class>),
}

/// What an expert says of each reading: bands or classes, and a row for readings outside all of them (the
/// paper's "not in database").
///
/// Bounds are compared as f32, the precision of readings: a reading of 0.7 lies in the band that starts there.
///
/// ```
/// use wisdom_belief::Opinion;
/// use wisdom_fusion::{Band, LookupTable, Rows};
///
/// let dull = Opinion { paradox: 0.2, not_interesting: 0.8, interesting: 0.0 };
/// let edge = Opinion { paradox: 0.05, not_interesting: 0.0, interesting: 0.95 };
/// let rows = Rows::Bands(vec![
///     Band { lo: 0.0, hi: 1.0, opinion: dull },
///     Band { lo: 9.0, hi: f64::INFINITY, opinion: edge },
/// ]);
/// let table = LookupTable::new("dem", "gradient magnitude", "1", rows, dull)?;
/// assert_eq!(table.row_of(9.0), Some(1));
/// assert_eq!(table.gaps(), [(1.0, 9.0)]);
/// # Ok::<(), wisdom_fusion::FusionError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct LookupTable {
    name: String,
    quantity: String,
    unit: String,
    rows: Rows,
    outside: Opinion,
    /// The opinions as mass functions, row by row, and that of `outside` last.
    masses: Vec<InterestMass>,
}

impl LookupTable {
    /// A table of the given name that reads `quantity` in `unit`.
    ///
    /// # Errors
    /// [`FusionError::NoRows`]; [`FusionError::Opinion`] if a row's masses are out of range or sum to more
    /// than 1; [`FusionError::Band`], [`FusionError::Overlap`], [`FusionError::RepeatedClass`] or
    /// [`FusionError::ClassRange`] for what the rows read.
    pub fn new(
        name: impl Into<String>,
        quantity: impl Into<String>,
        unit: impl Into<String>,
        rows: Rows,
        outside: Opinion,
    ) -> Result<Self, FusionError> {
        let name = name.into();
        match &rows {
            Rows::Bands(bands) => check_bands(&name, bands)?,
            Rows::Classes(classes) => check_classes(&name, classes)?,
        }
        let mut opinions: Vec<(String, Opinion)> = match &rows {
            Rows::Bands(bands) => {
                bands.iter().map(|b| (format!("[{}, {})", b.lo, b.hi), b.opinion)).collect()
            }
            Rows::Classes(classes) => {
                classes.iter().map(|c| (format!("class {}", c.class), c.opinion)).collect()
            }
        };
        if opinions.is_empty() {
            return Err(FusionError::NoRows { table: name });
        }
        opinions.push(("outside".to_owned(), outside));
        let mass = |(row, opinion)| {
            InterestMass::try_from(opinion).map_err(|source| FusionError::Opinion {
                table: name.clone(),
                row,
                source: Box::new(source),
            })
        };
        let masses = opinions.into_iter().map(mass).collect::<Result<_, _>>()?;
        let (quantity, unit) = (quantity.into(), unit.into());
        Ok(Self { name, quantity, unit, rows, outside, masses })
    }

    /// The table's name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What it reads: gradient magnitude, temperature, texture.
    #[must_use]
    pub fn quantity(&self) -> &str {
        &self.quantity
    }

    /// The unit of what it reads.
    #[must_use]
    pub fn unit(&self) -> &str {
        &self.unit
    }

    /// The rows, in the order they were given.
    #[must_use]
    pub fn rows(&self) -> &Rows {
        &self.rows
    }

    /// The opinion on readings outside all rows.
    #[must_use]
    pub fn outside(&self) -> Opinion {
        self.outside
    }

    /// What the rows say as mass functions, before discounting, in the order they were given; that of `outside` last.
    #[must_use]
    pub fn masses(&self) -> &[InterestMass] {
        &self.masses
    }

    /// Which row a reading falls in; none if it is outside all of them.
    #[must_use]
    pub fn row_of(&self, value: f32) -> Option<usize> {
        match &self.rows {
            Rows::Bands(bands) => {
                bands.iter().position(|band| (band.lo as f32..band.hi as f32).contains(&value))
            }
            Rows::Classes(classes) => {
                classes.iter().position(|row| f64::from(row.class) == f64::from(value))
            }
        }
    }

    /// The opinion on a reading, as the table's row says it.
    #[must_use]
    pub fn opinion(&self, value: f32) -> Opinion {
        match (self.row_of(value), &self.rows) {
            (None, _) => self.outside,
            (Some(row), Rows::Bands(bands)) => bands[row].opinion,
            (Some(row), Rows::Classes(classes)) => classes[row].opinion,
        }
    }

    /// The opinion on a reading as a mass function, before discounting.
    #[must_use]
    pub fn mass(&self, value: f32) -> InterestMass {
        self.masses[self.row_of(value).unwrap_or(self.masses.len() - 1)]
    }

    /// The table as intervals that follow each other over all readings: where they meet, in rising order, and
    /// the opinion of each. A class is the interval from its number up to the next number that f32 holds.
    pub(crate) fn intervals(&self) -> (Vec<f32>, Vec<Opinion>) {
        let mut rows: Vec<(f32, f32, Opinion)> = match &self.rows {
            Rows::Bands(bands) => {
                bands.iter().map(|band| (band.lo as f32, band.hi as f32, band.opinion)).collect()
            }
            Rows::Classes(classes) => classes
                .iter()
                .map(|row| (row.class as f32, (row.class as f32).next_up(), row.opinion))
                .collect(),
        };
        rows.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (mut bounds, mut opinions) = (Vec::new(), vec![self.outside]);
        for (lo, hi, opinion) in rows {
            if bounds.last() == Some(&lo) {
                // The row before ends here: no gap is left between them.
                opinions.pop();
            } else {
                bounds.push(lo);
            }
            bounds.push(hi);
            opinions.extend([opinion, self.outside]);
        }
        (bounds, opinions)
    }

    /// The intervals `[lo, hi)` between bands that no band covers, lowest first: readings there are outside.
    /// Classes have none.
    #[must_use]
    pub fn gaps(&self) -> Vec<(f64, f64)> {
        let Rows::Bands(bands) = &self.rows else { return Vec::new() };
        let sorted = by_lower_bound(bands);
        let between = sorted.windows(2).map(|pair| (pair[0].hi, pair[1].lo));
        between.filter(|&(lo, hi)| (lo as f32) < hi as f32).collect()
    }
}

fn by_lower_bound(bands: &[Band]) -> Vec<Band> {
    let mut sorted = bands.to_vec();
    sorted.sort_by(|a, b| a.lo.total_cmp(&b.lo));
    sorted
}

fn check_bands(table: &str, bands: &[Band]) -> Result<(), FusionError> {
    // Nothing compares with NaN, so that a band with such a bound holds nothing either.
    let holds_readings = |band: &Band| (band.lo as f32) < band.hi as f32;
    if let Some(&Band { lo, hi, .. }) = bands.iter().find(|band| !holds_readings(band)) {
        return Err(FusionError::Band { table: table.to_owned(), lo, hi });
    }
    let sorted = by_lower_bound(bands);
    match sorted.windows(2).find(|pair| pair[0].hi as f32 > pair[1].lo as f32) {
        None => Ok(()),
        Some(pair) => Err(FusionError::Overlap {
            table: table.to_owned(),
            first: (pair[0].lo, pair[0].hi),
            second: (pair[1].lo, pair[1].hi),
        }),
    }
}

fn check_classes(table: &str, classes: &[Class]) -> Result<(), FusionError> {
    for (row, &Class { class, .. }) in classes.iter().enumerate() {
        let table = table.to_owned();
        if class.unsigned_abs() > MAX_CLASS {
            return Err(FusionError::ClassRange { table, class });
        }
        if classes[..row].iter().any(|earlier| earlier.class == class) {
            return Err(FusionError::RepeatedClass { table, class });
        }
    }
    Ok(())
}
