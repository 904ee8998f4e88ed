//! Masses added up by element, in memory that is used again.

use super::mask::Mask;
use crate::Number;

/// The fewest slots of the table.
const MIN_SLOTS: usize = 64;

/// A sum of masses for each element that was given one.
///
/// An open-addressing table of places in a list of entries. The list keeps the order in which elements first
/// came up, so that everything computed from it repeats, and clearing costs no more than the table's size.
#[derive(Debug, Clone)]
pub(super) struct Accumulator<M, F> {
    /// The place of an entry, or 0; their number is a power of two, at least twice the entries.
    slots: Vec<u32>,
    /// By how much a hash is shifted to give a slot.
    shift: u32,
    /// Those in use, from place 1 up to `end`.
    entries: Vec<(M, F)>,
    end: usize,
}

impl<M: Mask, F: Number> Accumulator<M, F> {
    pub(super) fn new() -> Self {
        Self {
            slots: vec![0; MIN_SLOTS],
            shift: 64 - MIN_SLOTS.trailing_zeros(),
            entries: vec![(M::EMPTY, F::zero()); MIN_SLOTS / 2],
            end: 1,
        }
    }

    pub(super) fn clear(&mut self) {
        self.slots.fill(0);
        self.end = 1;
    }

    /// Adds to the mass of an element.
    pub(super) fn add(&mut self, element: M, mass: F) {
        self.add_each(&[(element, mass)], |element, mass| (element, mass));
    }

    /// Adds to the mass of what each element of a list becomes: the loop of every rule.
    #[inline]
    pub(super) fn add_each(&mut self, list: &[(M, F)], become_: impl Fn(M, F) -> (M, F)) {
        while (self.end + list.len()) * 2 > self.slots.len() {
            self.grow();
        }
        // As slices, whose ends the compiler knows not to move while the loop writes.
        let (slots, entries) = (self.slots.as_mut_slice(), self.entries.as_mut_slice());
        let (shift, last) = (self.shift, slots.len() - 1);
        for &(element, mass) in list {
            let (element, mass) = become_(element, mass);
            let mut slot = (element.hash() >> shift) as usize & last;
            loop {
                let place = slots[slot];
                if place == 0 {
                    slots[slot] = self.end as u32;
                    entries[self.end] = (element, mass);
                    self.end += 1;
                    break;
                }
                let entry = &mut entries[place as usize];
                if entry.0 == element {
                    entry.1 += mass;
                    break;
                }
                slot = (slot + 1) & last;
            }
        }
    }

    #[cold]
    fn grow(&mut self) {
        let slots = self.slots.len() * 2;
        self.slots.clear();
        self.slots.resize(slots, 0);
        self.shift -= 1;
        self.entries.resize(slots / 2, (M::EMPTY, F::zero()));
        for (place, &(element, _)) in self.entries.iter().enumerate().take(self.end).skip(1) {
            let mut slot = (element.hash() >> self.shift) as usize;
            while self.slots[slot & (slots - 1)] != 0 {
                slot += 1;
            }
            self.slots[slot & (slots - 1)] = place as u32;
        }
    }

    /// The elements and their sums, in the order in which the elements first came up.
    pub(super) fn entries(&self) -> &[(M, F)] {
        &self.entries[1..self.end]
    }

    /// The mass of an element, 0 if it has none.
    pub(super) fn mass(&self, element: M) -> F {
        self.place(element).map_or(F::zero(), |place| self.entries[place].1)
    }

    fn place(&self, element: M) -> Option<usize> {
        let last = self.slots.len() - 1;
        let mut slot = (element.hash() >> self.shift) as usize & last;
        loop {
            match self.slots[slot] as usize {
                0 => return None,
                place if self.entries[place].0 == element => return Some(place),
                _ => slot = (slot + 1) & last,
            }
        }
    }

    /// Takes the mass of an element, which is 0 then.
    pub(super) fn take(&mut self, element: M) -> F {
        let place = self.place(element);
        place.map_or(F::zero(), |place| std::mem::replace(&mut self.entries[place].1, F::zero()))
    }

    /// Replaces each sum.
    pub(super) fn scale(&mut self, scaled: impl Fn(M, F) -> F) {
        for (element, mass) in &mut self.entries[1..self.end] {
            *mass = scaled(*element, *mass);
        }
    }

    /// Moves its entries to a list and is empty then.
    pub(super) fn drain_into(&mut self, list: &mut Vec<(M, F)>) {
        list.clear();
        list.extend_from_slice(self.entries());
        self.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn masses_of_many_elements_are_kept_apart() {
        let mut sums = Accumulator::new();
        for round in 1..=3_u32 {
            sums.clear();
            for _ in 0..round {
                (0..1000_u128).for_each(|i| sums.add((i * i) << 64 | i, 0.5));
            }
            assert_eq!(sums.entries().len(), 1000);
            let half = f64::from(round) / 2.0;
            assert!(sums.entries().iter().all(|&(_, mass)| mass == half));
            assert_eq!(sums.mass(9 << 64 | 3), half);
            assert_eq!(sums.mass(2), 0.0);
        }
    }

    #[test]
    fn what_is_taken_out_can_come_back() {
        let mut sums = Accumulator::<u64, f64>::new();
        sums.add(0, 0.25);
        sums.add(1, 0.75);
        assert_eq!(sums.take(0), 0.25);
        assert_eq!(sums.take(0), 0.0);
        sums.add(0, 0.5);
        assert_eq!(sums.mass(0), 0.5);
    }
}
