//! Frames of discernment and the models that say which intersections exist.

use crate::{BeliefError, Element};

/// The most atoms of a frame on which they may overlap: 127 Venn regions, a bit each.
pub const MAX_OVERLAPPING_ATOMS: usize = 7;

/// The most atoms of a frame on which they are exclusive.
pub const MAX_EXCLUSIVE_ATOMS: usize = 64;

/// Which intersections of atoms exist.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Model {
    /// All of them: atoms may overlap in any way (Dezert 2002; the paper's section II). Elements are D^Θ.
    #[default]
    Free,
    /// None of them: atoms are exclusive (Shafer 1976; the paper's section IV.A). Elements are 2^Θ.
    Shafer,
    /// All but some (Dezert and Smarandache 2004).
    Hybrid {
        /// Elements, made on the free frame of the same atoms, that cannot be true.
        empty: Vec<Element>,
    },
}

/// A frame of discernment Θ: named atoms under a model.
///
/// ```
/// # use wisdom_belief::Frame;
/// let free = Frame::free(["A", "B", "C"])?;
/// assert_eq!(free.print(free.parse("A & B | A & C")?), "A & (B | C)");
///
/// let hybrid = Frame::with_empty(["A", "B", "C"], &["A & C", "B & C"])?;
/// assert_eq!(hybrid.parse("A | C")?.cardinality(), 3);
/// assert!(hybrid.parse("A & C")?.is_empty());
/// # Ok::<(), wisdom_belief::BeliefError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Frame {
    atoms: Vec<String>,
    model: Model,
    /// The regions inside each atom, before the model's constraints.
    within: Vec<u128>,
    theta: Element,
}

impl Frame {
    /// A frame of named atoms under a model.
    ///
    /// # Errors
    /// [`BeliefError::FrameSize`], [`BeliefError::AtomName`] or [`BeliefError::RepeatedAtom`] for bad atoms;
    /// [`BeliefError::ForeignElement`] or [`BeliefError::EmptyFrame`] for bad constraints.
    pub fn new<N: Into<String>>(
        atoms: impl IntoIterator<Item = N>,
        model: Model,
    ) -> Result<Self, BeliefError> {
        let atoms: Vec<String> = atoms.into_iter().map(Into::into).collect();
        let n = atoms.len();
        let limit = match model {
            Model::Shafer => MAX_EXCLUSIVE_ATOMS,
            Model::Free | Model::Hybrid { .. } => MAX_OVERLAPPING_ATOMS,
        };
        if n == 0 || n > limit {
            return Err(BeliefError::FrameSize { atoms: n, limit });
        }
        check_names(&atoms)?;
        let within: Vec<u128> = match model {
            Model::Shafer => (0..n).map(|atom| 1 << atom).collect(),
            Model::Free | Model::Hybrid { .. } => (0..n).map(|atom| regions_of(atom, n)).collect(),
        };
        let all = Element(within.iter().fold(0, |all, atom| all | atom));
        let mut frame = Self { atoms, model: Model::Free, within, theta: all };
        if let Model::Hybrid { empty } = &model {
            for &element in empty {
                frame.check(element)?;
            }
            let gone = empty.iter().fold(Element::EMPTY, |gone, &element| gone | element);
            frame.theta = Element(all.0 & !gone.0);
            if frame.theta.is_empty() {
                return Err(BeliefError::EmptyFrame { atoms: frame.atoms.join(", ") });
            }
        }
        frame.model = model;
        Ok(frame)
    }

    /// A frame on which every intersection exists.
    ///
    /// # Errors
    /// As [`Frame::new`].
    pub fn free<N: Into<String>>(atoms: impl IntoIterator<Item = N>) -> Result<Self, BeliefError> {
        Self::new(atoms, Model::Free)
    }

    /// A frame of exclusive atoms.
    ///
    /// # Errors
    /// As [`Frame::new`].
    pub fn shafer<N: Into<String>>(
        atoms: impl IntoIterator<Item = N>,
    ) -> Result<Self, BeliefError> {
        Self::new(atoms, Model::Shafer)
    }

    /// A frame under the hybrid model that empties the given expressions.
    ///
    /// # Errors
    /// As [`Frame::new`] and [`Frame::parse`].
    pub fn with_empty<N: Into<String>>(
        atoms: impl IntoIterator<Item = N>,
        empty: &[&str],
    ) -> Result<Self, BeliefError> {
        let free = Self::free(atoms)?;
        let empty = empty.iter().map(|text| free.parse(text)).collect::<Result<_, _>>()?;
        Self::new(free.atoms, Model::Hybrid { empty })
    }

    /// The paper's frame {I, NI}: *interesting*, *not interesting* (section III.B).
    ///
    /// # Errors
    /// As [`Frame::new`], which only a hybrid model can cause.
    pub fn interest(model: Model) -> Result<Self, BeliefError> {
        Self::new(["I", "NI"], model)
    }

    /// The names of the atoms.
    #[must_use]
    pub fn atoms(&self) -> &[String] {
        &self.atoms
    }

    /// The model.
    #[must_use]
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Total ignorance Θ: the union of all atoms.
    #[must_use]
    pub fn theta(&self) -> Element {
        self.theta
    }

    /// The element of one atom, counted from 0; empty if the model empties it.
    #[must_use]
    pub fn atom(&self, index: usize) -> Option<Element> {
        self.within.get(index).map(|&regions| self.project(Element(regions)))
    }

    /// What is left of a free-model element under this frame's constraints.
    #[must_use]
    pub fn project(&self, element: Element) -> Element {
        element & self.theta
    }

    /// Whether no intersection is empty.
    #[must_use]
    pub fn is_free(&self) -> bool {
        self.model != Model::Shafer && self.theta.0 == self.within.iter().fold(0, |a, b| a | b)
    }

    /// Whether the element is one of this frame's (hyper-)power set.
    #[must_use]
    pub fn contains(&self, element: Element) -> bool {
        element.is_subset_of(self.theta) && self.up_closure(element) & self.theta == element
    }

    pub(crate) fn check(&self, element: Element) -> Result<(), BeliefError> {
        if self.contains(element) {
            return Ok(());
        }
        Err(self.foreign(element))
    }

    /// [`Frame::check`] of the focal elements of a source: all at once, since every combination begins with it.
    pub(crate) fn check_focal<F>(&self, focal: &[(Element, F)]) -> Result<(), BeliefError> {
        if self.model == Model::Shafer || self.atoms.len() == MAX_OVERLAPPING_ATOMS {
            return focal.iter().try_for_each(|&(element, _)| self.check(element));
        }
        let theta = self.theta.0 as u64;
        let strange = focal.iter().any(|(element, _)| !element.is_subset_of(self.theta));
        let missing = self.within.iter().enumerate().fold(0, |missing, (atom, &within)| {
            // Regions that an element must hold, since it holds what lies around them.
            let without = !(within as u64);
            focal.iter().fold(missing, |missing, (element, _)| {
                let regions = element.0 as u64;
                missing | ((regions & without) << (1_u32 << atom)) & theta & !regions
            })
        });
        if strange || missing != 0 {
            return focal.iter().try_for_each(|&(element, _)| self.check(element));
        }
        Ok(())
    }

    pub(crate) fn foreign(&self, element: Element) -> BeliefError {
        BeliefError::ForeignElement { regions: element.0, atoms: self.atoms.join(", ") }
    }

    /// The Venn regions that exist, as bits, in rising order.
    pub(crate) fn existing_regions(&self) -> impl Iterator<Item = u32> + use<> {
        let theta = self.theta.0;
        (0..u128::BITS).filter(move |bit| theta >> bit & 1 == 1)
    }

    /// The regions inside an atom, before the model's constraints.
    pub(crate) fn regions_within(&self, atom: usize) -> u128 {
        self.within[atom]
    }

    /// The least element of the free model that holds these regions: what is true in a region stays true
    /// where more atoms hold, so an element holds each region's supersets. (Nothing to add when exclusive.)
    pub(crate) fn up_closure(&self, element: Element) -> Element {
        if self.model == Model::Shafer {
            return element;
        }
        if self.atoms.len() < MAX_OVERLAPPING_ATOMS {
            // 63 regions at most: every source of every combination is checked by this, and words are faster.
            let add = |regions: u64, (atom, &within): (usize, &u128)| {
                regions | (regions & !(within as u64)) << (1_u32 << atom)
            };
            return Element(self.within.iter().enumerate().fold(element.0 as u64, add).into());
        }
        let add = |regions: u128, (atom, within): (usize, &u128)| {
            regions | (regions & !within) << (1_u32 << atom)
        };
        Element(self.within.iter().enumerate().fold(element.0, add))
    }
}

/// The Venn regions inside one of `n` atoms that may overlap.
fn regions_of(atom: usize, n: usize) -> u128 {
    (1..1_u32 << n).filter(|region| region >> atom & 1 == 1).fold(0, |all, r| all | 1 << (r - 1))
}

fn check_names(atoms: &[String]) -> Result<(), BeliefError> {
    for (index, name) in atoms.iter().enumerate() {
        let reserved = |c: char| c.is_whitespace() || matches!(c, '&' | '|' | '(' | ')' | ',');
        if name.is_empty() || name.contains(reserved) || name == "empty" || name == "Theta" {
            return Err(BeliefError::AtomName { name: name.clone() });
        }
        if atoms[..index].contains(name) {
            return Err(BeliefError::RepeatedAtom { name: name.clone() });
        }
    }
    Ok(())
}
