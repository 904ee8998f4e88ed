//! Dempster's rule: the conjunctive rule without its conflict (Dempster 1967, Shafer 1976; paper Eq. 5).

use super::conjunctive;
use crate::{BeliefError, Frame, MassFunction};

pub(super) fn combine(
    sources: &[MassFunction],
    frame: &Frame,
) -> Result<MassFunction, BeliefError> {
    let fused = conjunctive(sources, frame)?;
    let surviving = || fused.focal().iter().filter(|(element, _)| !element.is_empty());
    // The sum of what survives, not 1 − K: the subtraction would lose every digit near total conflict.
    let sum: f64 = surviving().map(|&(_, mass)| mass).sum();
    if sum == 0.0 {
        return Err(BeliefError::TotalConflict { sources: sources.len() });
    }
    Ok(MassFunction::from_map(surviving().map(|&(element, mass)| (element, mass / sum)).collect()))
}
