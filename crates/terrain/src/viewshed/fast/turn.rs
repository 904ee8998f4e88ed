//! Rows to columns and bits to bytes.

use fearless_simd::{Select, Simd, SimdBase, SimdMask, f32x8, mask8x64, u8x64};

/// Side of a square that is turned at once.
pub(super) const TILE: usize = 8;

/// Bits of a word, and words of a square of them.
pub(super) const WORD: usize = 64;

/// A square's rows as columns: zipping each with the one half a square further down, three times.
#[inline(always)]
pub(super) fn turned<S: Simd>(mut rows: [f32x8<S>; TILE]) -> [f32x8<S>; TILE] {
    for _ in 0..TILE.ilog2() {
        let above = rows;
        for i in 0..TILE / 2 {
            rows[2 * i] = above[i].zip_low(above[i + TILE / 2]);
            rows[2 * i + 1] = above[i].zip_high(above[i + TILE / 2]);
        }
    }
    rows
}

/// Turns a square of bits: bit j of word i becomes bit i of word j. Off-diagonal quarters change places, then theirs.
#[inline(always)]
pub(super) fn turn_bits(words: &mut [u64; WORD]) {
    let (mut half, mut low) = (WORD / 2, u64::from(u32::MAX));
    while half > 0 {
        for pair in words.chunks_exact_mut(2 * half) {
            let (upper, lower) = pair.split_at_mut(half);
            for (upper, lower) in upper.iter_mut().zip(lower) {
                let changed = ((*upper >> half) ^ *lower) & low;
                *upper ^= changed << half;
                *lower ^= changed;
            }
        }
        half /= 2;
        low ^= low << half;
    }
}

/// A byte for each bit, the lowest first.
#[inline(always)]
pub(super) fn bytes<S: Simd>(simd: S, bits: u64) -> [u8; WORD] {
    let (one, zero) = (u8x64::splat(simd, 1), u8x64::splat(simd, 0));
    mask8x64::from_bitmask(simd, bits).select(one, zero).into()
}

/// Sixty-four bits from four parts of sixteen, the lowest first.
#[inline(always)]
pub(super) fn word(parts: [u16; 4]) -> u64 {
    parts.iter().rev().fold(0, |word, part| word << 16 | u64::from(*part))
}

#[cfg(test)]
mod tests {
    use fearless_simd::{Level, dispatch};

    use super::*;

    fn scrambled(number: u64) -> u64 {
        number.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15).rotate_left(29)
    }

    #[test]
    fn bits_change_rows_for_columns() {
        let words: [u64; WORD] = std::array::from_fn(|i| scrambled(i as u64));
        let mut turned = words;
        turn_bits(&mut turned);
        for (row, word) in words.iter().enumerate() {
            for (col, turned) in turned.iter().enumerate() {
                assert_eq!(turned >> row & 1, word >> col & 1, "row {row}, column {col}");
            }
        }
    }

    #[test]
    fn squares_change_rows_for_columns() {
        for level in [Level::new(), Level::baseline()] {
            dispatch!(level, simd => {
                let rows = std::array::from_fn(|row| f32x8::from_fn(simd, |col| (TILE * row + col) as f32));
                for (col, turned) in turned(rows).iter().enumerate() {
                    for (row, value) in turned.as_slice().iter().enumerate() {
                        assert_eq!(*value, (TILE * row + col) as f32);
                    }
                }
            });
        }
    }

    #[test]
    fn a_byte_is_its_bit() {
        let parts = [0x8001, 0x1234, 0x0ff0, 0xc003];
        let bits = word(parts);
        assert_eq!(bits, 0xc003_0ff0_1234_8001);
        for level in [Level::new(), Level::baseline()] {
            let bytes = dispatch!(level, simd => bytes(simd, bits));
            for (i, byte) in bytes.into_iter().enumerate() {
                assert_eq!(u64::from(byte), bits >> i & 1, "bit {i}");
            }
        }
    }
}
