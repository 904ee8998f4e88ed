//! The classic rule of DSmT: the conjunctive rule on the free model (Dezert 2002; paper Eq. 2).

use super::{Rule, check_none_on_empty, conjunctive};
use crate::{BeliefError, Frame, MassFunction};

pub(super) fn combine(
    sources: &[MassFunction],
    frame: &Frame,
) -> Result<MassFunction, BeliefError> {
    if !frame.is_free() {
        return Err(BeliefError::NotFreeModel { atoms: frame.atoms().join(", ") });
    }
    check_none_on_empty(Rule::Dsmc, sources)?;
    conjunctive(sources, frame)
}
