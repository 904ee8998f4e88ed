//! The sources as a rule reads them: checked, on the target frame, their focal elements side by side.

use super::accumulate::Accumulator;
use super::mask::Mask;
use super::{Rule, Settings};
use crate::{BeliefError, Frame, MassFunction, Number};

/// All focal elements of all sources, source by source, on the target frame.
#[derive(Debug, Clone)]
pub(super) struct Bodies<M, F> {
    focal: Vec<(M, F)>,
    /// Where each source's focal elements end.
    ends: Vec<usize>,
    /// For rule `dsmh`: the union of the atoms that occur in each focal element as its source gave it.
    named: Vec<M>,
}

impl<M: Mask, F: Number> Bodies<M, F> {
    pub(super) fn new() -> Self {
        Self { focal: Vec::new(), ends: Vec::new(), named: Vec::new() }
    }

    /// Reads the sources of a rule.
    pub(super) fn read(
        &mut self,
        rule: Rule,
        sources: &[MassFunction<F>],
        frame: &Frame,
        settings: &Settings<'_>,
        sums: &mut Accumulator<M, F>,
    ) -> Result<(), BeliefError> {
        self.focal.clear();
        self.ends.clear();
        self.named.clear();
        let given_on = settings.source_frame.unwrap_or(frame);
        for (index, source) in sources.iter().enumerate() {
            given_on.check_focal(source.focal())?;
            let empty = source.conflict();
            if empty > F::zero() && !rule.takes_mass_on_empty() {
                return Err(BeliefError::MassOnEmpty { index, mass: empty.to_f64(), rule });
            }
            match settings.source_frame {
                _ if rule == Rule::Dsmh => self.keep_apart(source, given_on, frame)?,
                None => {
                    self.focal.extend(source.focal().iter().map(|&(x, mass)| (M::of(x), mass)));
                }
                Some(given_on) => {
                    sums.clear();
                    for &(element, mass) in source.focal() {
                        sums.add(M::of(frame.translate(given_on, element)?), mass);
                    }
                    self.focal.extend_from_slice(sums.entries());
                }
            }
            self.ends.push(self.focal.len());
        }
        Ok(())
    }

    /// Keeps elements apart that coincide on the target frame, since `dsmh` asks what they were.
    fn keep_apart(
        &mut self,
        source: &MassFunction<F>,
        given_on: &Frame,
        frame: &Frame,
    ) -> Result<(), BeliefError> {
        for &(element, mass) in source.focal() {
            self.focal.push((M::of(frame.translate(given_on, element)?), mass));
            let named = given_on.union_of_atoms(element)?;
            self.named.push(M::of(frame.translate(given_on, named)?));
        }
        Ok(())
    }

    /// How many sources there are.
    pub(super) fn len(&self) -> usize {
        self.ends.len()
    }

    /// Where the focal elements of one source lie among all.
    #[inline]
    pub(super) fn range(&self, source: usize) -> std::ops::Range<usize> {
        let start = if source == 0 { 0 } else { self.ends[source - 1] };
        start..self.ends[source]
    }

    /// The focal elements of all sources, one after another.
    pub(super) fn focal(&self) -> &[(M, F)] {
        &self.focal
    }

    /// The focal elements of each source.
    pub(super) fn iter(&self) -> impl Iterator<Item = &[(M, F)]> {
        (0..self.len()).map(|source| &self.focal[self.range(source)])
    }

    /// The sources as mass functions on the target frame.
    pub(super) fn mass_functions(&self) -> impl Iterator<Item = MassFunction<F>> {
        let read = |&(element, mass): &(M, F)| (element.element(), mass);
        self.iter().map(move |body| MassFunction::from_sums(body.iter().map(read).collect()))
    }

    /// Under `dsmh`, the union of the atoms that occur in a focal element as its source gave it.
    pub(super) fn named(&self, place: usize) -> M {
        self.named[place]
    }

    /// How many ways there are to choose one focal element from each source (saturating).
    pub(super) fn products(&self) -> u64 {
        self.iter().fold(1, |products: u64, body| products.saturating_mul(body.len() as u64))
    }
}
