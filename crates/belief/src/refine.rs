//! Refinement: a frame with overlaps seen as a frame of exclusive parts (paper Eq. 6).

use std::cmp::Reverse;
use std::collections::BTreeMap;

use crate::{BeliefError, Element, Frame, MassFunction, Model, Number};

/// The refined frame `Θ_ref`, one exclusive atom for each Venn region of another frame, and the way there.
///
/// Dempster's rule on the refined frame gives what the classic rule of DSmT gives on the free one (paper
/// Eqs. 6 to 9): every refined focal element holds the common region, so nothing conflicts.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Refinement {
    frame: Frame,
    /// For each atom of `frame`, the region bit it stands for.
    regions: Vec<u32>,
}

impl Frame {
    /// Refines the frame into exclusive atoms, one for each Venn region that exists, with the given names:
    /// regions within more atoms first, then by the order of the atoms. For {I, NI} that is the paper's
    /// X = I ∩ NI, Y = I \ X, Z = NI \ X.
    ///
    /// ```
    /// # use wisdom_belief::{Frame, Model};
    /// let frame = Frame::interest(Model::Free)?;
    /// let refined = frame.refined(["X", "Y", "Z"])?;
    /// let interesting = refined.element(frame.parse("I")?);
    /// assert_eq!(refined.frame().print(interesting), "X | Y");
    /// # Ok::<(), wisdom_belief::BeliefError>(())
    /// ```
    ///
    /// # Errors
    /// [`BeliefError::RegionNames`] if there are not as many names as regions, and as [`Frame::new`] (more
    /// than 64 regions do not fit).
    pub fn refined<N: Into<String>>(
        &self,
        names: impl IntoIterator<Item = N>,
    ) -> Result<Refinement, BeliefError> {
        let names: Vec<String> = names.into_iter().map(Into::into).collect();
        let atoms_of =
            |bit: u32| if *self.model() == Model::Shafer { 1 } else { (bit + 1).count_ones() };
        let mut regions: Vec<u32> = self.existing_regions().collect();
        regions.sort_by_key(|&bit| (Reverse(atoms_of(bit)), bit));
        if names.len() != regions.len() {
            return Err(BeliefError::RegionNames { names: names.len(), regions: regions.len() });
        }
        Ok(Refinement { frame: Frame::shafer(names)?, regions })
    }
}

impl Refinement {
    /// The refined frame, under Shafer's model.
    #[must_use]
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// The same element on the refined frame.
    #[must_use]
    pub fn element(&self, element: Element) -> Element {
        let atoms = self.regions.iter().enumerate().filter(|(_, bit)| element.0 >> *bit & 1 == 1);
        Element(atoms.fold(0, |set, (atom, _)| set | 1 << atom))
    }

    /// The mass function m′ that says the same on the refined frame (paper Eq. 6).
    #[must_use]
    pub fn mass<F: Number>(&self, mass: &MassFunction<F>) -> MassFunction<F> {
        let refined = mass.focal().iter().map(|&(element, mass)| (self.element(element), mass));
        MassFunction::from_map(refined.collect::<BTreeMap<_, _>>())
    }
}
