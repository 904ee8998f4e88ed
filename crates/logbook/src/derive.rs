//! Decisions of the past, derived again one by one and in any order.

use std::collections::VecDeque;
use std::ops::Deref;
use std::sync::Arc;

use wisdom_autonomy::{Autonomy, Decision, Maps, Message, Observation, Outcome};
use wisdom_goals::Action;
use wisdom_grid::Cell;

use crate::compare::first_difference;
use crate::replay::same_version;
use crate::{Entry, LogReader, ReplayError, Setting, mission_of, record};

/// Decisions kept to go on from: each holds its maps, on a large ground some ten megabytes.
const KEPT: usize = 8;

/// A decision of the past with what it was made from.
#[derive(Debug, Clone)]
pub struct Past {
    /// The decision, derived again.
    pub decision: Decision,
    /// The core right after it: its maps and deliberation are those of the decision.
    pub rover: Autonomy,
    /// Goals achieved before it: their targets and names.
    pub achieved: Vec<(Cell, String)>,
}

impl Past {
    /// The maps the decision was made from.
    ///
    /// # Panics
    /// Never: a core that has decided has maps.
    #[must_use]
    pub fn maps(&self) -> &Maps {
        self.rover.maps().expect("a core that has decided has maps")
    }
}

/// Derives decisions of a log again, whichever is asked for; goes on from those asked for last. `L` points at the log:
/// a reference, or an `Arc` of it.
#[derive(Debug)]
pub struct Deriver<L> {
    log: L,
    setting: Setting,
    start: Autonomy,
    /// Decisions with the place of the entry after each; those asked for last at the end.
    kept: VecDeque<(usize, Arc<Past>)>,
}

impl<L: Deref<Target = LogReader>> Deriver<L> {
    /// Gets ready to derive the decisions of a log.
    ///
    /// # Errors
    /// [`ReplayError`] if the log's mission does not load, or its decisions mean another version.
    pub fn new(log: L) -> Result<Self, ReplayError> {
        same_version(&log)?;
        let mission = mission_of(&log)?;
        let setting = Setting::from(&mission.spec);
        let start = Autonomy::new(mission.spec)?;
        Ok(Self { log, setting, start, kept: VecDeque::new() })
    }

    /// The core before anything was logged; its spec is the mission's.
    #[must_use]
    pub fn start(&self) -> &Autonomy {
        &self.start
    }

    /// Derives a decision again, with what it was made from; none if the log does not hold it. Every decision up to it is
    /// held against its record, so what is shown is what was logged.
    ///
    /// # Errors
    /// [`ReplayError`] if the core refuses a logged input, or a decision differs from its record.
    pub fn at(&mut self, number: u32) -> Result<Option<Arc<Past>>, ReplayError> {
        let before = |(_, past): &&(usize, Arc<Past>)| past.decision.number <= number;
        let nearest = self.kept.iter().filter(before).max_by_key(|(_, past)| past.decision.number);
        let (next, mut rover, mut achieved) = match nearest.cloned() {
            Some((next, past)) if past.decision.number == number => {
                self.keep(next, &past);
                return Ok(Some(past));
            }
            Some((next, past)) => (next, past.rover.clone(), achieved_by(&past)),
            None => (0, self.start.clone(), Vec::new()),
        };
        for (place, entry) in self.log.entries.iter().enumerate().skip(next) {
            match entry {
                Entry::Observation(logged) => rover.observe(&Observation::try_from(logged)?)?,
                Entry::Message(logged) => rover.hear(&Message::try_from(logged)?)?,
                Entry::Fault(_) => {}
                Entry::Outcome(logged) => rover.report(&Outcome::try_from(logged)?)?,
                Entry::Decision(logged) => {
                    let decision = rover.decide()?;
                    let derived = record::Decision::of(&decision, &self.setting);
                    if let Some(difference) = first_difference(logged, &derived) {
                        return Err(ReplayError::Differs(Box::new(difference)));
                    }
                    if decision.number == number {
                        let past = Arc::new(Past { decision, rover, achieved });
                        self.keep(place + 1, &past);
                        return Ok(Some(past));
                    }
                    achieved.extend(achieved_at(&decision));
                }
            }
        }
        Ok(None)
    }

    fn keep(&mut self, next: usize, past: &Arc<Past>) {
        self.kept.retain(|(_, kept)| kept.decision.number != past.decision.number);
        if self.kept.len() == KEPT {
            self.kept.pop_front();
        }
        self.kept.push_back((next, Arc::clone(past)));
    }
}

/// Goals achieved up to and with a decision.
fn achieved_by(past: &Past) -> Vec<(Cell, String)> {
    past.achieved.iter().cloned().chain(achieved_at(&past.decision)).collect()
}

fn achieved_at(decision: &Decision) -> impl Iterator<Item = (Cell, String)> + '_ {
    let done = decision.verdicts.iter().filter(|v| v.action == Action::Achieve);
    done.map(|v| (v.goal.target, v.goal.id.to_string()))
}

/// Derives one decision of a log again ([`Deriver::at`]).
///
/// # Errors
/// As [`Deriver::new`] and [`Deriver::at`].
pub fn derive_at(log: &LogReader, number: u32) -> Result<Option<Past>, ReplayError> {
    let mut deriver = Deriver::new(log)?;
    let found = deriver.at(number)?;
    drop(deriver);
    Ok(found.map(Arc::unwrap_or_clone))
}
