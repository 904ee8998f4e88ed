//! Elements of the (hyper-)power set as sets of Venn regions.

use std::cmp::Ordering;
use std::ops::{BitAnd, BitOr};

/// An element of the power set or hyper-power set of a [`Frame`](crate::Frame): a bit for each Venn region.
///
/// Made by a frame (an atom, Θ, a parsed expression) and combined with `&` (∩) and `|` (∪); both stay within
/// the frame and its model, since a frame hands out only regions that exist in it. An element does not know
/// its frame: those of different frames must not be mixed, which mass functions and rules check.
///
/// ```
/// # use wisdom_belief::{Element, Frame};
/// let frame = Frame::free(["I", "NI"])?;
/// let (i, ni) = (frame.parse("I")?, frame.parse("NI")?);
/// assert_eq!((i & ni).cardinality(), 1);
/// assert_eq!(i | ni, frame.theta());
/// assert!((i & ni).is_subset_of(i));
/// # Ok::<(), wisdom_belief::BeliefError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Element(pub(crate) u128);

impl Element {
    /// The impossible element ∅, the same on every frame.
    pub const EMPTY: Self = Self(0);

    /// Whether this is ∅.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Whether every region of this element is one of `other` (A ⊆ B).
    #[must_use]
    pub const fn is_subset_of(self, other: Self) -> bool {
        self.0 & !other.0 == 0
    }

    /// `DSm` cardinality |X|: the number of Venn regions (Dezert and Smarandache 2004).
    #[must_use]
    pub const fn cardinality(self) -> u32 {
        self.0.count_ones()
    }

    /// The bit mask: under the free or a hybrid model bit `s − 1` is the region inside exactly the atoms of
    /// the bit set `s`, under Shafer's model bit `a` is atom `a`.
    #[must_use]
    pub const fn regions(self) -> u128 {
        self.0
    }
}

/// Elements of fewer Venn regions come first, equally large ones by their bit masks: a part always comes before
/// the whole.
impl Ord for Element {
    fn cmp(&self, other: &Self) -> Ordering {
        self.cardinality().cmp(&other.cardinality()).then(self.0.cmp(&other.0))
    }
}

impl PartialOrd for Element {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl BitAnd for Element {
    type Output = Self;

    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

impl BitOr for Element {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}
