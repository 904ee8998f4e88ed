//! Plain arrays of samples: what PDS3, PDS4, ISIS and `NumPy` files have in common.

use wisdom_grid::GridSpec;

use super::{About, GridFile, MAX_CELLS, check_size, damaged, grid_file, is_special};
use crate::{Crs, TerrainError};

/// The largest whole number that a label may give: more than any file has bytes.
pub(super) const MAX_WHOLE: u64 = 1 << 40;

/// How many bands are read: a cube of a few layers, not one of spectra.
const MAX_BANDS: usize = 64;

/// What a sample's bits mean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Number {
    U8,
    I8,
    U16,
    I16,
    U32,
    I32,
    U64,
    I64,
    F32,
    F64,
}

/// A sample as it is stored.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sample {
    pub(super) number: Number,
    pub(super) big_endian: bool,
}

impl Sample {
    pub(super) fn bytes(self) -> usize {
        match self.number {
            Number::U8 | Number::I8 => 1,
            Number::U16 | Number::I16 => 2,
            Number::U32 | Number::I32 | Number::F32 => 4,
            Number::U64 | Number::I64 | Number::F64 => 8,
        }
    }

    /// In words, as [`About::storage`] has them.
    pub(super) fn words(self) -> String {
        let number = match self.number {
            Number::U8 => "uint8",
            Number::I8 => "int8",
            Number::U16 => "uint16",
            Number::I16 => "int16",
            Number::U32 => "uint32",
            Number::I32 => "int32",
            Number::U64 => "uint64",
            Number::I64 => "int64",
            Number::F32 => "float32",
            Number::F64 => "float64",
        };
        match (self.bytes(), self.big_endian) {
            (1, _) => number.to_owned(),
            (_, true) => format!("{number}, big-endian"),
            (_, false) => format!("{number}, little-endian"),
        }
    }

    /// The value that the lowest bits stand for. Exact for all but 64-bit integers beyond 2⁵³.
    fn of_bits(self, bits: u64) -> f64 {
        match self.number {
            Number::U8 => f64::from(bits as u8),
            Number::I8 => f64::from(bits as i8),
            Number::U16 => f64::from(bits as u16),
            Number::I16 => f64::from(bits as i16),
            Number::U32 => f64::from(bits as u32),
            Number::I32 => f64::from(bits as i32),
            Number::U64 => bits as f64,
            Number::I64 => (bits as i64) as f64,
            Number::F32 => f64::from(f32::from_bits(bits as u32)),
            Number::F64 => f64::from_bits(bits),
        }
    }

    /// The value of stored bytes, as many as [`Sample::bytes`].
    fn value(self, stored: &[u8]) -> f64 {
        let shift = |bits: u64, &byte: &u8| bits << 8 | u64::from(byte);
        self.of_bits(if self.big_endian {
            stored.iter().fold(0, shift)
        } else {
            stored.iter().rev().fold(0, shift)
        })
    }

    /// A constant of a label: a number, or a sample's bits as `16#FF7FFFFB#` or `0xFF7FFFFB`.
    pub(super) fn constant(self, text: &str) -> Option<f64> {
        let hex = text.strip_prefix("0x").or_else(|| text.strip_prefix("0X"));
        if let Some(hex) = hex {
            return u64::from_str_radix(hex, 16).ok().map(|bits| self.of_bits(bits));
        }
        let Some((radix, digits)) = text.split_once('#') else {
            return text.parse().ok();
        };
        let radix = radix.parse().ok().filter(|radix| (2..=16).contains(radix))?;
        let (negative, digits) = match digits.strip_prefix('-') {
            Some(digits) => (true, digits),
            None => (false, digits),
        };
        let bits = u64::from_str_radix(digits.strip_suffix('#')?, radix).ok()?;
        Some(self.of_bits(if negative { bits.wrapping_neg() } else { bits }))
    }
}

/// Where the samples of an array lie, in bytes from its first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Order {
    /// A fixed number of bytes from each band, line and sample to the next.
    Steps { band: u64, row: u64, col: u64 },
    /// Whole tiles one after another, those at the edges filled up.
    Tiles { rows: u64, cols: u64 },
}

/// Which stored values are none.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Missing {
    /// Single values.
    pub(super) values: Vec<f64>,
    /// The least and greatest value that is one.
    pub(super) valid: Option<(f64, f64)>,
}

/// An array of samples: its shape, its place in a file and what its numbers mean.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Array {
    pub(super) format: &'static str,
    pub(super) sample: Sample,
    /// Words on the layout, for people.
    pub(super) layout: String,
    pub(super) bands: usize,
    /// Bytes before the first sample.
    pub(super) start: u64,
    pub(super) order: Order,
    /// The first line is the southernmost.
    pub(super) south_first: bool,
    /// The first sample is the easternmost.
    pub(super) east_first: bool,
    pub(super) missing: Missing,
    /// What stands for "no value", as the file writes it.
    pub(super) nodata: Option<String>,
    pub(super) scale: f64,
    pub(super) offset: f64,
}

impl Array {
    /// An array of one band, line after line without gaps, of plain numbers.
    pub(super) fn plain(format: &'static str, sample: Sample, cols: usize) -> Self {
        let col = sample.bytes() as u64;
        Self {
            format,
            sample,
            layout: String::new(),
            bands: 1,
            start: 0,
            order: Order::Steps { band: 0, row: cols as u64 * col, col },
            south_first: false,
            east_first: false,
            missing: Missing::default(),
            nodata: None,
            scale: 1.0,
            offset: 0.0,
        }
    }

    /// The bands, one grid each, once the bytes are seen to hold them all.
    pub(super) fn read(
        &self,
        name: &str,
        bytes: &[u8],
        spec: GridSpec,
        crs: Option<&Crs>,
    ) -> Result<Vec<GridFile>, TerrainError> {
        let (rows, cols) = (spec.rows(), spec.cols());
        check_bands(name, self.bands, rows, cols)?;
        if !(self.scale.is_finite() && self.offset.is_finite()) {
            let (scale, offset) = (self.scale, self.offset);
            return Err(damaged(name, format!("its numbers are scaled by {scale} plus {offset}")));
        }
        let (found, wanted) = (bytes.len(), self.end(rows, cols));
        if wanted > found as u64 {
            let (bands, words) = (self.bands, self.sample.words());
            let samples = format!("{bands} x {rows} x {cols} samples of {words}");
            let reason = format!("it has {found} bytes; its {samples} end at byte {wanted}");
            return Err(damaged(name, reason));
        }
        let single: Vec<f32> = self.missing.values.iter().map(|&value| value as f32).collect();
        (0..self.bands)
            .map(|band| {
                let values = spec.cells().map(|cell| {
                    let row = if self.south_first { rows - 1 - cell.row } else { cell.row };
                    let col = if self.east_first { cols - 1 - cell.col } else { cell.col };
                    let at = self.position(rows, cols, [band, row, col]) as usize;
                    let stored = self.sample.value(&bytes[at..at + self.sample.bytes()]);
                    (!self.is_missing(&single, stored))
                        .then_some((stored * self.scale + self.offset) as f32)
                });
                grid_file(spec, values, crs.cloned(), self.about())
            })
            .collect()
    }

    /// As f32 too where that is what is stored: a label's text may have fewer digits.
    fn is_missing(&self, single: &[f32], stored: f64) -> bool {
        let float = self.sample.number == Number::F32;
        self.missing.values.contains(&stored)
            || self.missing.valid.is_some_and(|(least, most)| !(least..=most).contains(&stored))
            || float && (is_special(stored as f32) || single.contains(&(stored as f32)))
    }

    fn about(&self) -> About {
        let storage = match &self.layout[..] {
            "" => self.sample.words(),
            layout => format!("{}, {layout}", self.sample.words()),
        };
        About {
            format: self.format,
            storage,
            nodata: self.nodata.clone(),
            scale: self.scale,
            offset: self.offset,
        }
    }

    /// The byte after the last. Sums that overflow stay at the greatest number, which no file reaches.
    fn end(&self, rows: usize, cols: usize) -> u64 {
        let last = match self.order {
            Order::Steps { .. } => [self.bands - 1, rows - 1, cols - 1],
            // Tiles are stored whole, so the last sample of the last tile counts even beyond the edge.
            Order::Tiles { rows: high, cols: wide } => [
                self.bands - 1,
                rows.next_multiple_of(high as usize) - 1,
                cols.next_multiple_of(wide as usize) - 1,
            ],
        };
        self.position(rows, cols, last).saturating_add(self.sample.bytes() as u64)
    }

    /// The first byte of a sample, by band, stored line and stored sample.
    fn position(&self, rows: usize, cols: usize, index: [usize; 3]) -> u64 {
        let [band, row, col] = index.map(|i| i as u64);
        let sum = |a: u64, step: u64, times: u64| a.saturating_add(step.saturating_mul(times));
        match self.order {
            Order::Steps { band: b, row: r, col: c } => {
                sum(sum(sum(self.start, b, band), r, row), c, col)
            }
            Order::Tiles { rows: high, cols: wide } => {
                let (down, across) = ((rows as u64).div_ceil(high), (cols as u64).div_ceil(wide));
                let tile = sum(col / wide, sum(row / high, down, band), across);
                let sample =
                    sum(sum(col % wide, row % high, wide), tile, high.saturating_mul(wide));
                sum(self.start, sample, self.sample.bytes() as u64)
            }
        }
    }
}

/// Refuses more bands or cells than are read.
fn check_bands(name: &str, bands: usize, rows: usize, cols: usize) -> Result<(), TerrainError> {
    check_size(name, rows, cols)?;
    if (1..=MAX_BANDS).contains(&bands) && bands * rows * cols <= MAX_CELLS {
        return Ok(());
    }
    let wanted = format!("1 to {MAX_BANDS} bands of at most {MAX_CELLS} cells together are read");
    Err(damaged(name, format!("it has {bands} bands of {rows} x {cols} cells; {wanted}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(number: Number, big_endian: bool) -> Sample {
        Sample { number, big_endian }
    }

    #[test]
    fn a_sample_is_read_in_its_byte_order() {
        assert_eq!(sample(Number::I16, true).value(&[0xFF, 0xFE]), -2.0);
        assert_eq!(sample(Number::I16, false).value(&[0xFE, 0xFF]), -2.0);
        assert_eq!(sample(Number::U32, true).value(&[0xFF, 0, 0, 1]), 4_278_190_081.0);
        assert_eq!(sample(Number::I8, false).value(&[0x80]), -128.0);
        assert_eq!(sample(Number::F32, true).value(&1.5_f32.to_be_bytes()), 1.5);
        assert_eq!(sample(Number::F64, false).value(&(-0.1_f64).to_le_bytes()), -0.1);
        assert_eq!(sample(Number::I64, true).value(&(-7_i64).to_be_bytes()), -7.0);
        assert_eq!(sample(Number::U64, false).value(&9_u64.to_le_bytes()), 9.0);
    }

    #[test]
    fn a_constant_is_a_number_or_bits() {
        let float = sample(Number::F32, false);
        let null = f64::from(f32::from_bits(0xFF7F_FFFB));
        assert_eq!(float.constant("16#FF7FFFFB#"), Some(null));
        assert_eq!(float.constant("0xff7ffffb"), Some(null));
        assert_eq!(float.constant("-32767.0"), Some(-32767.0));
        assert_eq!(sample(Number::I16, true).constant("16#8000#"), Some(-32768.0));
        assert_eq!(sample(Number::I16, true).constant("8#-10#"), Some(-8.0));
        for wrong in ["", "16#", "16#FF", "99#1#", "16#FFFFFFFFFFFFFFFFF#", "none"] {
            assert_eq!(float.constant(wrong), None, "{wrong}");
        }
    }
}
