//! Commonalities and implicabilities of all elements at once: the zeta transform and its inverse, Möbius'.
//!
//! On 2^Θ that is the fast Möbius transform (Kennes and Smets 1990), one pass an atom. On other models the
//! elements are the sets of regions that hold, with a region, all that lie within more of the same atoms; one
//! pass a region then does it, along the pairs of elements that differ by that region alone (after Björklund
//! et al. 2016). The passes take regions within few atoms first: they are the last to join on the way from an
//! element up to one that holds it, so each way is gone once.

use crate::closure::from_differences;
use crate::{BeliefError, Element, Frame, MassFunction, Number};

/// The most elements of a dense transform: 2^Θ on 20 atoms. (D^Θ on five free atoms has 7580, on six too many.)
pub const MAX_DENSE_ELEMENTS: usize = 1 << 20;

/// The elements of a frame with the steps of the transforms between them; made once, used for many masses.
///
/// Values are slices with one number for each element, in the order of [`Frame::elements`].
///
/// ```
/// # use wisdom_belief::{Frame, Lattice, MassFunction};
/// let frame = Frame::free(["A", "B", "C"])?;
/// let lattice = Lattice::new(&frame)?;
/// let m = MassFunction::parse(&frame, [("A & B", 0.5), ("A | C", 0.25), ("Theta", 0.25)])?;
/// let mut values = lattice.masses(&m)?;
/// lattice.to_commonalities(&mut values);
/// let a = frame.parse("A")?;
/// assert_eq!(values[lattice.index(a).expect("an element")], m.commonality(a));
/// # Ok::<(), wisdom_belief::BeliefError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Lattice {
    frame: Frame,
    elements: Vec<Element>,
    steps: Steps,
}

#[derive(Debug, Clone)]
enum Steps {
    /// Elements are all subsets of so many atoms, each at the place of its bit mask.
    Subsets { atoms: usize },
    /// Places of elements that differ by one region, the smaller first; regions within few atoms first.
    Covers(Vec<(u32, u32)>),
}

impl Lattice {
    /// The lattice of a frame's elements.
    ///
    /// # Errors
    /// [`BeliefError::TooManyElements`] if there are more than [`MAX_DENSE_ELEMENTS`].
    pub fn new(frame: &Frame) -> Result<Self, BeliefError> {
        let elements: Vec<Element> = frame.elements().take(MAX_DENSE_ELEMENTS + 1).collect();
        if elements.len() > MAX_DENSE_ELEMENTS {
            return Err(BeliefError::TooManyElements { limit: MAX_DENSE_ELEMENTS });
        }
        let steps = if frame.exclusive() {
            Steps::Subsets { atoms: frame.atoms().len() }
        } else {
            Steps::Covers(covers(frame, &elements))
        };
        Ok(Self { frame: frame.clone(), elements, steps })
    }

    /// The elements, in the order of [`Frame::elements`].
    #[must_use]
    pub fn elements(&self) -> &[Element] {
        &self.elements
    }

    /// The place of an element in that order; `None` if it is not one of the frame.
    #[must_use]
    pub fn index(&self, element: Element) -> Option<usize> {
        place(&self.elements, element)
    }

    /// The mass of each element.
    ///
    /// # Errors
    /// [`BeliefError::ForeignElement`] if a focal element is not of this frame.
    pub fn masses<F: Number>(&self, mass: &MassFunction<F>) -> Result<Vec<F>, BeliefError> {
        let mut values = vec![F::zero(); self.elements.len()];
        for &(element, mass) in mass.focal() {
            values[self.index(element).ok_or_else(|| self.frame.foreign(element))?] = mass;
        }
        Ok(values)
    }

    /// The mass function that gives each element its value. Zeros are dropped, and with them what is below 0 by
    /// no more than [`Number::SUM_TOLERANCE`]: the inverse transforms subtract, which leaves rounded zeros.
    ///
    /// # Errors
    /// [`BeliefError::OutOfRange`] or [`BeliefError::SumNotOne`] if the values are no masses,
    /// [`BeliefError::ValueCount`] if there is not one for each element.
    pub fn mass_function<F: Number>(&self, values: &[F]) -> Result<MassFunction<F>, BeliefError> {
        let (found, expected) = (values.len(), self.elements.len());
        if found != expected {
            return Err(BeliefError::ValueCount { found, expected });
        }
        from_differences(&self.frame, self.elements.iter().copied().zip(values.iter().copied()))
    }

    /// Turns masses m into commonalities, q(A) = Σ m(B) over B ⊇ A.
    ///
    /// # Panics
    /// As the other transforms, if there is not one value for each element.
    pub fn to_commonalities<F: Number>(&self, values: &mut [F]) {
        self.rising(values, |low, high| *low += *high);
    }

    /// Turns commonalities back into masses.
    ///
    /// # Panics
    /// If there is not one value for each element.
    pub fn from_commonalities<F: Number>(&self, values: &mut [F]) {
        self.falling(values, |low, high| *low = *low - *high);
    }

    /// Turns masses m into implicabilities, b(A) = Σ m(B) over B ⊆ A.
    ///
    /// # Panics
    /// If there is not one value for each element.
    pub fn to_implicabilities<F: Number>(&self, values: &mut [F]) {
        self.falling(values, |low, high| *high += *low);
    }

    /// Turns implicabilities back into masses.
    ///
    /// # Panics
    /// If there is not one value for each element.
    pub fn from_implicabilities<F: Number>(&self, values: &mut [F]) {
        self.rising(values, |low, high| *high = *high - *low);
    }

    /// One step for each pair that differs by a region, regions within few atoms first.
    fn rising<F: Number>(&self, values: &mut [F], step: impl Fn(&mut F, &mut F)) {
        self.check_count(values);
        match &self.steps {
            Steps::Subsets { atoms } => subsets(*atoms, values, step),
            Steps::Covers(pairs) => pairs.iter().for_each(|&pair| at(pair, values, &step)),
        }
    }

    /// The same steps from the last to the first. (The passes of exclusive atoms may come in any order.)
    fn falling<F: Number>(&self, values: &mut [F], step: impl Fn(&mut F, &mut F)) {
        self.check_count(values);
        match &self.steps {
            Steps::Subsets { atoms } => subsets(*atoms, values, step),
            Steps::Covers(pairs) => pairs.iter().rev().for_each(|&pair| at(pair, values, &step)),
        }
    }

    fn check_count<F>(&self, values: &[F]) {
        let (found, expected) = (values.len(), self.elements.len());
        assert!(found == expected, "{found} values; the lattice has {expected} elements");
    }
}

/// One pass an atom: a step for each set without the atom and the same set with it.
fn subsets<F: Number>(atoms: usize, values: &mut [F], step: impl Fn(&mut F, &mut F)) {
    for half in (0..atoms).map(|atom| 1 << atom) {
        for block in values.chunks_exact_mut(2 * half) {
            let (without, with) = block.split_at_mut(half);
            without.iter_mut().zip(with).for_each(|(low, high)| step(low, high));
        }
    }
}

#[inline]
fn at<F: Number>((low, high): (u32, u32), values: &mut [F], step: impl Fn(&mut F, &mut F)) {
    // Copies, since two places of a slice cannot be borrowed at once for less than a search.
    let (mut of_low, mut of_high) = (values[low as usize], values[high as usize]);
    step(&mut of_low, &mut of_high);
    (values[low as usize], values[high as usize]) = (of_low, of_high);
}

/// All pairs of elements that differ by one region.
fn covers(frame: &Frame, elements: &[Element]) -> Vec<(u32, u32)> {
    let mut regions: Vec<u32> = frame.existing_regions().collect();
    regions.sort_by_key(|region| (region + 1).count_ones());
    let mut pairs = Vec::new();
    for region in regions.into_iter().map(|region| Element(1 << region)) {
        // What an element needs to hold before it can take this region.
        let needs = Element(frame.project(frame.up_closure(region)).0 & !region.0);
        for (low, &element) in elements.iter().enumerate() {
            if needs.is_subset_of(element) && !region.is_subset_of(element) {
                let high = place(elements, element | region);
                pairs.push((low as u32, high.expect("an element with all it needs") as u32));
            }
        }
    }
    pairs
}

/// The place of an element among some in rising order of their bit masks.
fn place(elements: &[Element], element: Element) -> Option<usize> {
    elements.binary_search_by_key(&element.0, |element| element.0).ok()
}
