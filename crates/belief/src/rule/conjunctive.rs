//! The conjunctive rule: every product of masses goes to the intersection (Smets 1990).

use std::collections::BTreeMap;

use super::check_frame;
use crate::{BeliefError, Element, Frame, MassFunction};

/// Combines all sources by intersection; what falls on ∅ stays there.
///
/// # Errors
/// [`BeliefError::ForeignElement`] if a source is not of this frame.
pub fn conjunctive(sources: &[MassFunction], frame: &Frame) -> Result<MassFunction, BeliefError> {
    check_frame(sources, frame)?;
    Ok(sources.iter().fold(MassFunction::vacuous(frame), |fused, source| meet(&fused, source)))
}

/// K: the mass that falls on ∅ when all sources are combined by intersection.
///
/// # Errors
/// As [`conjunctive`].
pub fn conflict(sources: &[MassFunction], frame: &Frame) -> Result<f64, BeliefError> {
    Ok(conjunctive(sources, frame)?.conflict())
}

/// Intersection is associative, so two at a time is the same as all at once and visits far fewer products.
fn meet(a: &MassFunction, b: &MassFunction) -> MassFunction {
    let mut fused = BTreeMap::<Element, f64>::new();
    for &(x, of_x) in a.focal() {
        for &(y, of_y) in b.focal() {
            *fused.entry(x & y).or_default() += of_x * of_y;
        }
    }
    MassFunction::from_map(fused)
}
