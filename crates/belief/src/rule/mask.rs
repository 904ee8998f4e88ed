//! Elements in as few bits as the frame needs.

use std::ops::{BitAnd, BitOr};

use crate::Element;

/// The regions of an element: 64 bits hold those of every frame but the free one of seven atoms and its like,
/// and combine at twice the speed of the 128 of [`Element`].
pub(super) trait Mask:
    Copy + Eq + Ord + BitAnd<Output = Self> + BitOr<Output = Self>
{
    /// ∅.
    const EMPTY: Self;

    /// The most regions it holds.
    const BITS: usize;

    /// The mask of an element that fits.
    fn of(element: Element) -> Self;

    /// The element again.
    fn element(self) -> Element;

    /// |X|.
    fn cardinality(self) -> u32;

    /// The bits spread over a word, the upper ones best (Fibonacci hashing, by 2^64 over the golden ratio).
    fn hash(self) -> u64;

    fn is_empty(self) -> bool {
        self == Self::EMPTY
    }

    fn is_subset_of(self, other: Self) -> bool {
        self & other == self
    }
}

const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

impl Mask for u64 {
    const EMPTY: Self = 0;
    const BITS: usize = Self::BITS as usize;

    #[inline]
    fn of(element: Element) -> Self {
        element.0 as Self
    }

    #[inline]
    fn element(self) -> Element {
        Element(self.into())
    }

    #[inline]
    fn cardinality(self) -> u32 {
        self.count_ones()
    }

    #[inline]
    fn hash(self) -> u64 {
        (self ^ self >> 29).wrapping_mul(GOLDEN)
    }
}

impl Mask for u128 {
    const EMPTY: Self = 0;
    const BITS: usize = Self::BITS as usize;

    #[inline]
    fn of(element: Element) -> Self {
        element.0
    }

    #[inline]
    fn element(self) -> Element {
        Element(self)
    }

    #[inline]
    fn cardinality(self) -> u32 {
        self.count_ones()
    }

    #[inline]
    fn hash(self) -> u64 {
        let folded = self as u64 ^ ((self >> 64) as u64).rotate_left(32);
        (folded ^ folded >> 29).wrapping_mul(GOLDEN)
    }
}
