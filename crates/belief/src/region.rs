//! Single Venn regions: what holds inside exactly some atoms and outside all others.

use crate::translate::bits;
use crate::{BeliefError, Element, Frame};

/// A Venn region of a frame: the part inside exactly some atoms. Under Shafer's model it is an atom.
///
/// A region is in general no [`Element`]: no expression in ∩ and ∪ says "A but not B". It carries probability
/// ([`Distribution`](crate::Distribution)), not mass. It does not know its frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Region(u32);

impl Region {
    /// Whether the region is one of the element's.
    #[must_use]
    pub const fn is_within(self, element: Element) -> bool {
        element.0 >> self.0 & 1 == 1
    }

    /// The region's bit in [`Element::regions`].
    #[must_use]
    pub const fn bit(self) -> u32 {
        self.0
    }

    /// The region as a mask, for sums that ask of elements no more than their regions.
    pub(crate) const fn mask(self) -> Element {
        Element(1 << self.0)
    }
}

impl Frame {
    /// The Venn regions that exist in the model, in rising order of their bits.
    pub fn regions(&self) -> impl Iterator<Item = Region> + Clone + use<> {
        bits(self.theta().0).map(Region)
    }

    /// The region inside exactly the named atoms, in any order.
    ///
    /// ```
    /// # use wisdom_belief::Frame;
    /// let frame = Frame::with_empty(["A", "B", "C"], &["A & C"])?;
    /// let region = frame.region(&["B", "A"])?;
    /// assert!(region.is_within(frame.parse("A & B")?));
    /// assert_eq!(frame.atoms_of(region), ["A", "B"]);
    /// assert!(frame.region(&["A", "C"]).is_err());
    /// # Ok::<(), wisdom_belief::BeliefError>(())
    /// ```
    ///
    /// # Errors
    /// [`BeliefError::UnknownName`] for what is no atom, [`BeliefError::RepeatedAtom`], and
    /// [`BeliefError::NoSuchRegion`] if the model empties the region or no atom is named.
    pub fn region(&self, atoms: &[&str]) -> Result<Region, BeliefError> {
        let mut set = 0_u128;
        for &name in atoms {
            let atom = self.position(name)?;
            if set >> atom & 1 == 1 {
                return Err(BeliefError::RepeatedAtom { name: name.to_owned() });
            }
            set |= 1 << atom;
        }
        self.region_of(set).ok_or_else(|| BeliefError::NoSuchRegion {
            named: atoms.join(", "),
            atoms: self.atoms().join(", "),
        })
    }

    /// The names of the atoms that a region of this frame lies in, in the frame's order.
    #[must_use]
    pub fn atoms_of(&self, region: Region) -> Vec<&str> {
        let set = if self.exclusive() { 1 << region.0 } else { u128::from(region.0 + 1) };
        let inside = self.atoms().iter().enumerate().filter(|(atom, _)| set >> atom & 1 == 1);
        inside.map(|(_, name)| name.as_str()).collect()
    }

    fn position(&self, name: &str) -> Result<usize, BeliefError> {
        let found = self.atoms().iter().position(|atom| atom == name);
        found.ok_or_else(|| BeliefError::UnknownName {
            what: "atom",
            name: name.to_owned(),
            known: self.atoms().join(", "),
        })
    }

    /// The region inside exactly the atoms of a bit set, if the model has it.
    fn region_of(&self, set: u128) -> Option<Region> {
        let bit = if self.exclusive() {
            set.is_power_of_two().then(|| set.trailing_zeros())
        } else {
            u32::try_from(set).ok()?.checked_sub(1)
        };
        bit.map(Region).filter(|region| region.is_within(self.theta()))
    }
}
