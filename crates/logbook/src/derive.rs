//! Decisions of the past, derived again one by one and in any order.

use std::collections::{BTreeMap, VecDeque};
use std::ops::Deref;
use std::sync::Arc;

use wisdom_autonomy::{Autonomy, Decision, Maps, Message, Observation, Outcome};
use wisdom_goals::Action;
use wisdom_grid::Cell;

use crate::compare::first_difference;
use crate::replay::same_version;
use crate::{Entry, LogReader, ReplayError, Setting, mission_of, record};

/// Cells of the decisions kept along the way, and as many of those asked for last. Each holds its maps and the ways found on
/// them, some five hundred bytes a cell.
const KEPT_CELLS: usize = 1 << 19;

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

/// Derives decisions of a log again, whichever is asked for. It goes on from the nearest one kept: some along the way, evenly
/// spread, and those asked for last. `L` points at the log: a reference, or an `Arc` of it.
#[derive(Debug)]
pub struct Deriver<L> {
    log: L,
    setting: Setting,
    start: Autonomy,
    /// Decisions between those kept along the way.
    stride: u32,
    landmarks: BTreeMap<u32, Kept>,
    /// Those asked for last at the end.
    recent: VecDeque<Kept>,
}

/// A decision to go on from.
#[derive(Debug, Clone)]
struct Kept {
    /// The place of the entry after it.
    next: usize,
    past: Arc<Past>,
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
        let landmarks = (KEPT_CELLS / setting.grid.len()).clamp(1, 8);
        let stride = log.decisions().count().div_ceil(landmarks).max(1) as u32;
        let start = Autonomy::new(mission.spec)?;
        let (landmarks, recent) = (BTreeMap::new(), VecDeque::new());
        Ok(Self { log, setting, start, stride, landmarks, recent })
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
        let landmark = self.landmarks.range(..=number).next_back().map(|(_, kept)| kept);
        let recent = self.recent.iter().filter(|kept| kept.past.decision.number <= number);
        let nearest = recent.chain(landmark).max_by_key(|kept| kept.past.decision.number);
        let (next, mut rover, mut achieved) = match nearest.cloned() {
            Some(kept) if kept.past.decision.number == number => {
                let past = Arc::clone(&kept.past);
                self.keep(kept);
                return Ok(Some(past));
            }
            Some(Kept { next, past }) => (next, past.rover.clone(), achieved_by(&past)),
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
                    let here = decision.number;
                    if here == number {
                        let past = Arc::new(Past { decision, rover, achieved });
                        self.keep(Kept { next: place + 1, past: Arc::clone(&past) });
                        return Ok(Some(past));
                    }
                    let done: Vec<_> = achieved_at(&decision).collect();
                    if self.is_landmark(here) {
                        let (rover, achieved) = (rover.clone(), achieved.clone());
                        let past = Arc::new(Past { decision, rover, achieved });
                        self.landmarks.insert(here, Kept { next: place + 1, past });
                    }
                    achieved.extend(done);
                }
            }
        }
        Ok(None)
    }

    fn is_landmark(&self, number: u32) -> bool {
        number > 0 && number.is_multiple_of(self.stride) && !self.landmarks.contains_key(&number)
    }

    fn keep(&mut self, kept: Kept) {
        let number = kept.past.decision.number;
        if self.is_landmark(number) {
            self.landmarks.insert(number, kept.clone());
        }
        self.recent.retain(|kept| kept.past.decision.number != number);
        let cells = kept.past.maps().interest.interest.spec().len();
        while self.recent.len() >= (KEPT_CELLS / cells).clamp(1, 4) {
            self.recent.pop_front();
        }
        self.recent.push_back(kept);
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
