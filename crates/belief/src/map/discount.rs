//! Discounting whole maps (paper Eq. 4).

use super::MapNumber;
use super::number::{Instructions, Job};
use super::source::{Planes, Step, check_length, sweep_again};
use super::width::Width;
use crate::interest::closed::Lanes;
use crate::{BeliefError, Number};

/// Masses to be written, laid out as [`Planes`].
#[derive(Debug)]
pub struct PlanesMut<'a, F> {
    /// m(I).
    pub interesting: &'a mut [F],
    /// m(NI).
    pub not_interesting: &'a mut [F],
    /// m(I ∩ NI).
    pub paradox: Option<&'a mut [F]>,
}

/// Shrinks every mass of each cell by its share u; ignorance, the rest, gains what they lose (paper Eq. 4;
/// [`InterestMass::discounted`](crate::InterestMass::discounted)).
///
/// # Errors
/// [`BeliefError::PlaneLength`] if planes differ in length, or paradox has a plane on one side only.
pub fn discount<F: MapNumber>(
    source: Planes<'_, F>,
    uncertainty: &[F],
    discounted: PlanesMut<'_, F>,
) -> Result<(), BeliefError> {
    let cells = source.interesting.len();
    source.check(0, cells)?;
    check_length(uncertainty.len(), cells, || "uncertainty".to_owned())?;
    let PlanesMut { interesting, not_interesting, paradox } = &discounted;
    let to = [Some(&**interesting), Some(&**not_interesting), paradox.as_deref()];
    let from = [Some(()), Some(()), source.paradox.map(|_| ())];
    let names = ["interesting", "not_interesting", "paradox"];
    for ((to, from), name) in to.into_iter().zip(from).zip(names) {
        let expected = from.map_or(0, |()| cells);
        check_length(to.map_or(0, <[F]>::len), expected, || format!("discounted {name}"))?;
    }
    Instructions::widest().run(cells, Discount { source, uncertainty, discounted });
    Ok(())
}

struct Discount<'a, F> {
    source: Planes<'a, F>,
    uncertainty: &'a [F],
    discounted: PlanesMut<'a, F>,
}

impl<F: MapNumber> Job<F> for Discount<'_, F> {
    #[inline(always)]
    fn run<W: Width<F>>(self, width: W) {
        sweep_again(width, self.uncertainty.len(), self);
    }
}

impl<F: Number> Step<F> for Discount<'_, F> {
    #[inline(always)]
    fn step<W: Width<F>>(&mut self, width: W, at: usize) {
        let u = width.load(self.uncertainty, at);
        let kept = u.one_of() - u;
        let (from, to) = (&self.source, &mut self.discounted);
        width.store(width.load(from.interesting, at) * kept, to.interesting, at);
        width.store(width.load(from.not_interesting, at) * kept, to.not_interesting, at);
        if let (Some(from), Some(to)) = (from.paradox, &mut to.paradox) {
            width.store(width.load(from, at) * kept, to, at);
        }
    }
}
