//! What a caller wants to know of each cell.

use super::MapNumber;
use super::width::Width;
use crate::interest::closed::{Lanes, Outcome};
use crate::{BeliefError, Number};

/// The planes to be written; what is `None` is not.
#[derive(Debug)]
pub struct Outputs<'a, F> {
    /// Bel(I): m(I), and under `dsmc` m(I ∩ NI), too.
    pub belief: Option<&'a mut [F]>,
    /// m(I).
    pub interesting: Option<&'a mut [F]>,
    /// m(NI).
    pub not_interesting: Option<&'a mut [F]>,
    /// m(I ∪ NI).
    pub ignorance: Option<&'a mut [F]>,
    /// m(I ∩ NI) under `dsmc`; m(∅) under the other rules, as in [`Fused::mass`](crate::Fused::mass).
    pub paradox: Option<&'a mut [F]>,
    /// K, as [`Fused::conflict`](crate::Fused::conflict).
    pub conflict: Option<&'a mut [F]>,
    /// BetP(I) under the rule's model, as [`InterestMass::pignistic`](crate::InterestMass::pignistic).
    pub pignistic: Option<&'a mut [F]>,
}

impl<F> Default for Outputs<'_, F> {
    fn default() -> Self {
        Self {
            belief: None,
            interesting: None,
            not_interesting: None,
            ignorance: None,
            paradox: None,
            conflict: None,
            pignistic: None,
        }
    }
}

/// The planes' names in messages, in the order of [`Outputs::planes`].
const NAMES: [&str; 7] =
    ["belief", "interesting", "not_interesting", "ignorance", "paradox", "conflict", "pignistic"];

impl<F: MapNumber> Outputs<'_, F> {
    fn planes(&self) -> [Option<&[F]>; 7] {
        [
            self.belief.as_deref(),
            self.interesting.as_deref(),
            self.not_interesting.as_deref(),
            self.ignorance.as_deref(),
            self.paradox.as_deref(),
            self.conflict.as_deref(),
            self.pignistic.as_deref(),
        ]
    }

    /// How many cells the first plane has, if there is one.
    pub(super) fn cells(&self) -> Option<usize> {
        self.planes().into_iter().flatten().map(<[F]>::len).next()
    }

    /// Whether only Bel(I) is wanted.
    pub(super) fn belief_alone(&self) -> bool {
        self.planes().iter().enumerate().all(|(index, plane)| plane.is_some() == (index == 0))
    }

    /// Refuses planes of another length.
    pub(super) fn check(&self, cells: usize) -> Result<(), BeliefError> {
        let named = NAMES.into_iter().zip(self.planes());
        named.filter_map(|(name, plane)| Some((name, plane?))).try_for_each(|(name, plane)| {
            super::source::check_length(plane.len(), cells, || format!("output {name}"))
        })
    }

    /// The same planes, some cells of them.
    pub(super) fn window(&mut self, from: usize, to: usize) -> Outputs<'_, F> {
        Outputs {
            belief: part_of(&mut self.belief, from, to),
            interesting: part_of(&mut self.interesting, from, to),
            not_interesting: part_of(&mut self.not_interesting, from, to),
            ignorance: part_of(&mut self.ignorance, from, to),
            paradox: part_of(&mut self.paradox, from, to),
            conflict: part_of(&mut self.conflict, from, to),
            pignistic: part_of(&mut self.pignistic, from, to),
        }
    }
}

fn part_of<'a, F>(plane: &'a mut Option<&mut [F]>, from: usize, to: usize) -> Option<&'a mut [F]> {
    plane.as_deref_mut().map(|plane| &mut plane[from..to])
}

/// Puts cells into a plane, if it is wanted.
#[inline(always)]
fn put<F, W: Width<F>>(width: W, plane: &mut Option<&mut [F]>, at: usize, lanes: W::Lanes) {
    if let Some(plane) = plane {
        width.store(lanes, plane, at);
    }
}

impl<F: Number> Outputs<'_, F> {
    /// Writes what came out of some cells. On the free model all mass counts, on Shafer's the last is that of ∅.
    #[inline(always)]
    pub(super) fn write<W: Width<F>>(
        &mut self,
        width: W,
        at: usize,
        outcome: Outcome<W::Lanes>,
        free: bool,
    ) {
        let Outcome { masses: [i, n, u, p], conflict } = outcome;
        put(width, &mut self.interesting, at, i);
        put(width, &mut self.not_interesting, at, n);
        put(width, &mut self.ignorance, at, u);
        put(width, &mut self.paradox, at, p);
        put(width, &mut self.conflict, at, conflict);
        if let Some(plane) = &mut self.pignistic {
            let pignistic =
                if free { free_pignistic([i, n, u, p]) } else { pignistic([i, n, u, p]) };
            width.store(pignistic, plane, at);
        }
    }
}

/// m(I ∩ NI) + m(I) + m(NI)/2 + 2 m(I ∪ NI)/3.
#[inline(always)]
fn free_pignistic<L: Lanes>([i, n, u, p]: [L; 4]) -> L {
    p + i + n.half() + u * (u.count(2) / u.count(3))
}

/// m(I) + m(I ∪ NI)/2, scaled up by the mass that is not on ∅; 0 if that is none.
#[inline(always)]
fn pignistic<L: Lanes>([i, n, u, p]: [L; 4]) -> L {
    let sum = i + u.half();
    p.where_positive(sum.share_of(i + n + u), sum)
}
