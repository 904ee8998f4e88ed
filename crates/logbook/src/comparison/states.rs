//! What another rule would have chosen at every state of a run.

use wisdom_mission::Mission;

use super::Chosen;
use crate::compare::Difference;
use crate::{LogReader, Parting, ReplayError, Scores, redecide};

/// One logged decision and what another mission would have chosen in its place.
#[derive(Debug, Clone, PartialEq)]
pub struct AtState {
    /// Its number.
    pub decision: u32,
    /// What differs; none if both choose alike.
    pub parting: Option<Parting>,
    /// What the run chose.
    pub own: Chosen,
    /// What the other mission would have chosen.
    pub other: Chosen,
    /// Both choices on the other mission's map: expected interest.
    pub scores: Scores,
    /// The first stage and field of the two records that differ, whether or not the choice does.
    pub first: Option<Difference>,
}

/// What another mission would have chosen at every state of a run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct AtStates {
    /// The decisions, in order.
    pub states: Vec<AtState>,
    /// What a reader should know.
    pub remarks: Vec<String>,
}

impl AtStates {
    /// At how many states both choose alike.
    #[must_use]
    pub fn alike(&self) -> usize {
        self.states.iter().filter(|state| state.parting.is_none()).count()
    }
}

/// Asks another mission (another rule, say) at every state of a run what it would have chosen there. `each` is told the
/// number of every decision that was taken again.
///
/// # Errors
/// [`ReplayError`] as [`redecide`].
pub fn at_states(
    log: &LogReader,
    under: &Mission,
    each: &mut dyn FnMut(u32),
) -> Result<AtStates, ReplayError> {
    let mut states = Vec::new();
    let found = redecide(log, under, &mut |retaken| {
        each(retaken.logged.number);
        states.push(AtState {
            decision: retaken.logged.number,
            parting: retaken.parting,
            own: Chosen::of(&retaken.logged),
            other: Chosen::of(&retaken.decided),
            scores: retaken.scores,
            first: retaken.difference,
        });
        true
    })?;
    Ok(AtStates { states, remarks: found.remarks })
}
