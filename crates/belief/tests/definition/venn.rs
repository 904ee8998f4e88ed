//! Elements as plain sets of Venn regions.

use std::collections::BTreeSet;

use wisdom_belief::{Element, Frame, Model};

/// A Venn region: the atoms it lies inside of, a bit each (and outside of all others).
pub(crate) type Region = u8;

/// An element: the regions that make it up.
pub(crate) type Set = BTreeSet<Region>;

/// The regions that exist under a model, written down from the model's constraints.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Venn {
    pub(crate) atoms: u32,
    pub(crate) theta: Set,
}

impl Venn {
    /// The model that empties some intersections, each given by its atoms: a region inside all of them is gone.
    pub(crate) fn without(atoms: u32, empty: &[Region]) -> Self {
        let exists = |region: &Region| empty.iter().all(|&gone| region & gone != gone);
        Self { atoms, theta: (1..=Region::MAX >> (8 - atoms)).filter(exists).collect() }
    }

    /// Shafer's model: no region is inside two atoms.
    pub(crate) fn exclusive(atoms: u32) -> Self {
        Self { atoms, theta: (0..atoms).map(|atom| 1 << atom).collect() }
    }

    /// The model of one of the library's frames.
    pub(crate) fn of(frame: &Frame) -> Self {
        let atoms = u32::try_from(frame.atoms().len()).expect("few atoms");
        Self { atoms, theta: read(frame, frame.theta()) }
    }

    pub(crate) fn is_free(&self) -> bool {
        self.theta.len() == (1 << self.atoms) - 1
    }

    /// The intersection of some atoms.
    pub(crate) fn meet_of(&self, atoms: Region) -> Set {
        self.theta.iter().copied().filter(|region| region & atoms == atoms).collect()
    }

    /// An atom.
    pub(crate) fn atom(&self, atom: u32) -> Set {
        self.meet_of(1 << atom)
    }

    /// What this model leaves of an element.
    pub(crate) fn project(&self, set: &Set) -> Set {
        set & &self.theta
    }

    /// Every element, ∅ too: all unions of intersections of atoms.
    pub(crate) fn elements(&self) -> BTreeSet<Set> {
        let mut elements = BTreeSet::from([Set::new()]);
        for atoms in 1..=Region::MAX >> (8 - self.atoms) {
            let term = self.meet_of(atoms);
            let more: Vec<Set> = elements.iter().map(|element| element | &term).collect();
            elements.extend(more);
        }
        elements
    }

    /// Some elements: intersections of atoms, and the unions of each with a few others, near and far.
    pub(crate) fn short_elements(&self) -> BTreeSet<Set> {
        let all = 1..=Region::MAX >> (8 - self.atoms);
        let others = |atoms: Region| [atoms, atoms.rotate_left(3), !atoms, atoms ^ 0b101];
        let union = |atoms: Region, other: Region| &self.meet_of(atoms) | &self.meet_of(other);
        all.flat_map(|atoms| others(atoms).map(|other| union(atoms, other))).collect()
    }

    /// The minimal regions of an element: the intersections in its canonical form.
    pub(crate) fn canonical(set: &Set) -> Set {
        let within = |a: Region, b: Region| a != b && a & b == a;
        let minimal = |&&region: &&Region| !set.iter().any(|&other| within(other, region));
        set.iter().filter(minimal).copied().collect()
    }

    /// u(X): the union of the atoms that occur in the canonical form of X.
    pub(crate) fn union_of_atoms(&self, set: &Set) -> Set {
        let occurring = Self::canonical(set).into_iter().fold(0, |all, term| all | term);
        let atoms = (0..self.atoms).filter(|atom| occurring >> atom & 1 == 1);
        atoms.flat_map(|atom| self.atom(atom)).collect()
    }
}

/// The library's element as a set: its documented bit mask.
pub(crate) fn read(frame: &Frame, element: Element) -> Set {
    let bits = (0..u128::BITS).filter(|bit| element.regions() >> bit & 1 == 1);
    let region = |bit: u32| match frame.model() {
        Model::Shafer => 1 << bit,
        _ => Region::try_from(bit + 1).expect("at most seven atoms"),
    };
    bits.map(region).collect()
}

/// The set as the library's element, by way of its canonical form as text.
pub(crate) fn write(frame: &Frame, set: &Set) -> Element {
    let term = |region: Region| {
        let inside = frame.atoms().iter().enumerate().filter(|(atom, _)| region >> atom & 1 == 1);
        inside.map(|(_, name)| name.as_str()).collect::<Vec<_>>().join(" & ")
    };
    let terms: Vec<String> = Venn::canonical(set).into_iter().map(term).collect();
    if terms.is_empty() {
        return Element::EMPTY;
    }
    frame.parse(&terms.join(" | ")).expect("an element")
}
