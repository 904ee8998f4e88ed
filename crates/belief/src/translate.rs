//! The same element under another model of the same atoms.

use std::collections::BTreeMap;

use crate::{BeliefError, Element, Frame, MassFunction, Model, Number};

impl Frame {
    /// An element given on another model of the same atoms, as this frame sees it: written in atoms there, read
    /// here. What this frame's model empties is gone (Dezert and Smarandache 2004); what only the other model
    /// emptied comes back no larger than it must, as the least element of the free model that reads so there.
    ///
    /// ```
    /// # use wisdom_belief::Frame;
    /// let (free, shafer) = (Frame::free(["A", "B"])?, Frame::shafer(["A", "B"])?);
    /// let (paradox, a) = (free.parse("A & B")?, shafer.parse("A")?);
    /// assert!(shafer.translate(&free, paradox)?.is_empty());
    /// assert_eq!(free.translate(&shafer, a)?, free.parse("A")?);
    /// # Ok::<(), wisdom_belief::BeliefError>(())
    /// ```
    ///
    /// # Errors
    /// [`BeliefError::AtomsDiffer`] if the frames do not have the same atoms in the same order;
    /// [`BeliefError::ForeignElement`] if the element is not one of `from`.
    pub fn translate(&self, from: &Self, element: Element) -> Result<Element, BeliefError> {
        if self.atoms() != from.atoms() {
            let (found, expected) = (from.atoms().join(", "), self.atoms().join(", "));
            return Err(BeliefError::AtomsDiffer { found, expected });
        }
        from.check(element)?;
        Ok(match (self.exclusive(), from.exclusive()) {
            (true, true) => element,
            (false, false) => self.project(from.up_closure(element)),
            (false, true) => self.union_of(element.0),
            (true, false) => self.union_of(from.alone(element)),
        })
    }

    /// A mass function given on another model of the same atoms, element by element as [`Frame::translate`]; masses
    /// of elements that come to be the same are added, and those of emptied ones go to ∅.
    ///
    /// # Errors
    /// As [`Frame::translate`].
    pub fn translate_mass<F: Number>(
        &self,
        from: &Self,
        mass: &MassFunction<F>,
    ) -> Result<MassFunction<F>, BeliefError> {
        let mut masses = BTreeMap::new();
        for &(element, mass) in mass.focal() {
            *masses.entry(self.translate(from, element)?).or_insert_with(F::zero) += mass;
        }
        Ok(MassFunction::from_map(masses))
    }

    /// u(X) of the hybrid rule of `DSmT`: the union of the atoms that occur in X's minimal form, a union of
    /// intersections (Dezert and Smarandache 2004). ∅ has none.
    ///
    /// ```
    /// # use wisdom_belief::Frame;
    /// let frame = Frame::free(["A", "B", "C"])?;
    /// let x = frame.parse("A & B | A & B & C")?;
    /// assert_eq!(frame.union_of_atoms(x)?, frame.parse("A | B")?);
    /// # Ok::<(), wisdom_belief::BeliefError>(())
    /// ```
    ///
    /// # Errors
    /// [`BeliefError::ForeignElement`] if the element is not one of this frame.
    pub fn union_of_atoms(&self, element: Element) -> Result<Element, BeliefError> {
        self.check(element)?;
        if self.exclusive() {
            return Ok(element);
        }
        let minimal = Element(element.0 & !self.above(element).0);
        let occurring = bits(minimal.0).fold(0, |atoms, bit| atoms | u128::from(bit + 1));
        Ok(self.union_of(occurring))
    }

    /// Whether a region is a single atom (Shafer's model) rather than a set of atoms that hold together.
    pub(crate) fn exclusive(&self) -> bool {
        *self.model() == Model::Shafer
    }

    /// The union of some atoms, given as a bit set.
    fn union_of(&self, atoms: u128) -> Element {
        let named = bits(atoms).filter_map(|atom| self.atom(atom as usize));
        named.fold(Element::EMPTY, |union, atom| union | atom)
    }

    /// The atoms whose own region, outside all others, belongs to an element on overlapping atoms.
    fn alone(&self, element: Element) -> u128 {
        let own = |atom: &usize| element.0 >> ((1_u32 << atom) - 1) & 1 == 1;
        (0..self.atoms().len()).filter(own).fold(0, |set, atom| set | 1 << atom)
    }

    /// The regions that lie within all atoms of some region of the element, and one more at least.
    fn above(&self, element: Element) -> Element {
        let next = |atom: usize| {
            // Bit s − 1 is the region of the atom set s: a set without `atom` gains it 2^atom further up.
            (element.0 & !self.regions_within(atom)) << (1_u32 << atom)
        };
        Element((0..self.atoms().len()).fold(0, |above, atom| above | next(atom)))
    }
}

/// The positions of the bits that are set, from the lowest.
pub(crate) fn bits(mut set: u128) -> impl Iterator<Item = u32> + Clone {
    std::iter::from_fn(move || {
        let bit = (set != 0).then(|| set.trailing_zeros())?;
        set &= set - 1;
        Some(bit)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frames() -> [Frame; 4] {
        let atoms = ["A", "B", "C"];
        [
            Frame::free(atoms),
            Frame::shafer(atoms),
            Frame::with_empty(atoms, &["A & B", "A & C"]),
            Frame::with_empty(atoms, &["B"]),
        ]
        .map(|frame| frame.expect("a frame"))
    }

    #[test]
    fn an_expression_means_the_same_whether_translated_or_read_anew() {
        let [free, ..] = frames();
        for frame in frames() {
            for text in ["A", "A | B", "A & (B | C)", "(A | B) & C", "B & C", "Theta", "empty"] {
                let given = free.parse(text).expect(text);
                assert_eq!(frame.translate(&free, given), frame.parse(text), "{text}");
            }
        }
    }

    #[test]
    fn there_and_back_again_is_the_same_element() {
        let [free, shafer, hybrid, _] = frames();
        for text in ["empty", "A", "B", "A | C", "B | C", "Theta"] {
            let given = shafer.parse(text).expect(text);
            for other in [&free, &hybrid] {
                let there = other.translate(&shafer, given).expect("same atoms");
                assert_eq!(shafer.translate(other, there), Ok(given), "{text}");
            }
        }
    }

    #[test]
    fn what_only_the_other_model_empties_comes_back_as_small_as_it_reads() {
        let [free, _, hybrid, without_b] = frames();
        let a = hybrid.parse("A").expect("an atom");
        assert_eq!(free.translate(&hybrid, a), free.parse("A"));
        let theta = without_b.theta();
        assert_eq!(free.translate(&without_b, theta), free.parse("A | C"));
    }

    #[test]
    fn other_atoms_and_foreign_elements_are_refused() {
        let [free, shafer, ..] = frames();
        let swapped = Frame::free(["B", "A", "C"]).expect("a frame");
        let refused = free.translate(&swapped, Element::EMPTY).expect_err("another order");
        assert_eq!(
            refused.to_string(),
            "the source frame has atoms {B, A, C}; it must have {A, B, C}, in this order"
        );
        let theta = free.theta();
        assert!(matches!(free.translate(&shafer, theta), Err(BeliefError::ForeignElement { .. })));
    }

    #[test]
    fn the_atoms_of_an_element_are_those_of_its_minimal_form() {
        let [free, shafer, hybrid, _] = frames();
        let check = |frame: &Frame, text: &str, union: &str| {
            let element = frame.parse(text).expect(text);
            assert_eq!(frame.union_of_atoms(element), frame.parse(union), "{text}");
        };
        check(&free, "A & B & C", "Theta");
        check(&free, "A | A & B", "A");
        check(&free, "B & C", "B | C");
        check(&free, "empty", "empty");
        check(&shafer, "A | C", "A | C");
        check(&hybrid, "(A | B) & C", "B | C");
    }
}
