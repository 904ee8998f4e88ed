//! What a run came to, as its log tells it.

use std::collections::BTreeMap;

use wisdom_autonomy::Spent;
use wisdom_goals::{Action, Cause};
use wisdom_grid::{Cell, GridSpec, Raster, Window};
use wisdom_mission::{Mission, Ruler, labels_found};

use crate::record;
use crate::{Entry, LogError, LogReader, ReplayError, derive_at, mission_of};

/// A goal that a run achieved.
#[derive(Debug, Clone, PartialEq)]
pub struct Reached {
    /// Number of the goal: 7 is G7.
    pub goal: u32,
    /// Its directive's name.
    pub directive: String,
    /// Its target.
    pub target: Cell,
    /// Interest there on the run's own map when it was achieved.
    pub interest: f64,
    /// Its prize then.
    pub prize: f64,
    /// Interest there on the common ruler ([`Ruler`]); none if the true ground is not at hand.
    pub ruler: Option<f64>,
    /// Which of the mission's labels it found, by index.
    pub label: Option<usize>,
    /// The decision that says so.
    pub decision: u32,
    /// What had been spent by then.
    pub spent: Spent,
}

/// What a run came to, as far as its log goes.
#[derive(Debug, Clone)]
pub struct Account {
    /// The mission inside the log.
    pub mission: Mission,
    /// How the run ended; none if the log ends before it.
    pub ended: Option<String>,
    /// The goals achieved, in order.
    pub goals: Vec<Reached>,
    /// What was spent by the last record.
    pub spent: Spent,
    /// Decisions in the log.
    pub decisions: u32,
    /// Goals added, modified, reordered or dropped after the first decision, for what was discovered or what came of
    /// drives.
    pub reallocations: u32,
    /// Chance that a rover survives all steps driven, by the true hazards; none if the true ground is not at hand.
    pub reliability: Option<f64>,
    /// Every cell the rover stood on, in order.
    pub track: Vec<Cell>,
    /// Mission time of each decision, seconds, and whether it begins anything new: false if it keeps every goal as it is.
    pub decided: Vec<(f64, bool)>,
}

impl Account {
    /// Reads what a run came to out of its log.
    ///
    /// # Errors
    /// [`ReplayError::Mission`] if the mission inside does not load; [`ReplayError::Log`] if a record does not hold what
    /// its type allows.
    pub fn of(log: &LogReader) -> Result<Self, ReplayError> {
        let mission = mission_of(log)?;
        let ruler = Ruler::new(&mission);
        let mut account = Self {
            mission,
            ended: log.end.as_ref().map(|end| end.status.clone()),
            goals: Vec::new(),
            spent: Spent::default(),
            decisions: 0,
            reallocations: 0,
            reliability: None,
            track: Vec::new(),
            decided: Vec::new(),
        };
        let mut done: BTreeMap<(String, String), u32> = BTreeMap::new();
        let mut pieces: Vec<Vec<Cell>> = Vec::new();
        for entry in &log.entries {
            match entry {
                Entry::Observation(observation) => account.note(observation.spent.as_ref()),
                Entry::Outcome(outcome) => {
                    account.note(outcome.spent.as_ref());
                    pieces.push(outcome.track.iter().copied().map(Cell::from).collect());
                }
                Entry::Decision(decision) => account.decide(decision, &ruler, &mut done)?,
                Entry::Message(_) | Entry::Fault(_) => {}
            }
        }
        account.reallocations = reallocations(&done);
        account.reliability = reliability(&account.mission, &pieces);
        account.track = pieces.concat();
        account.track.dedup();
        let targets = account.targets();
        let found = labels_found(&account.mission.labels, account.mission.spec.grid, &targets);
        for (goal, label) in account.goals.iter_mut().zip(found) {
            goal.label = label;
        }
        Ok(account)
    }

    /// Keeps what has been spent.
    fn note(&mut self, spent: Option<&record::Spent>) {
        if let Some(spent) = spent {
            self.spent = Spent {
                time_s: spent.time_s,
                energy_j: spent.energy_j,
                data_mb: spent.data_mb,
                length_m: spent.length_m,
            };
        }
    }

    fn decide(
        &mut self,
        decision: &record::Decision,
        ruler: &Ruler,
        done: &mut BTreeMap<(String, String), u32>,
    ) -> Result<(), ReplayError> {
        self.decisions += 1;
        let state = decision.state.as_ref();
        self.note(state.and_then(|state| state.spent.as_ref()));
        let (keep, defer) = (Action::Keep.to_string(), Action::Defer.to_string());
        let verdicts = decision.choice.iter().flat_map(|choice| &choice.verdicts);
        let news = verdicts.clone().any(|v| v.action != keep && v.action != defer);
        self.decided.push((self.spent.time_s, news));
        for verdict in verdicts {
            *done.entry((verdict.action.clone(), verdict.cause.clone())).or_default() += 1;
            if verdict.action != Action::Achieve.to_string() {
                continue;
            }
            let missing = |field: &str| LogError::Malformed {
                record: format!("decision {}", decision.number),
                field: field.to_owned(),
                found: "absent".to_owned(),
                limit: "there",
            };
            let goal = verdict.goal.as_ref().ok_or_else(|| missing("choice.verdicts.goal"))?;
            let target = goal.target.map(Cell::from);
            let target = target.ok_or_else(|| missing("choice.verdicts.goal.target"))?;
            self.goals.push(Reached {
                goal: goal.id,
                directive: goal.directive_name.clone(),
                target,
                interest: goal.interest,
                prize: goal.prize,
                ruler: ruler.interest(target).ok(),
                label: None,
                decision: decision.number,
                spent: self.spent,
            });
        }
        Ok(())
    }

    /// The targets of the goals achieved, in order.
    #[must_use]
    pub fn targets(&self) -> Vec<Cell> {
        self.goals.iter().map(|goal| goal.target).collect()
    }

    /// Within how many cells of each other targets are the same place.
    #[must_use]
    pub fn identity_radius_cells(&self) -> f64 {
        let spec = &self.mission.spec;
        spec.manager.identity_radius_m / spec.grid.spacing_m()
    }

    /// Interest gained on the run's own map, each goal as it was when it was achieved.
    #[must_use]
    pub fn interest(&self) -> f64 {
        self.goals.iter().fold(0.0, |sum, goal| sum + goal.interest)
    }

    /// Interest gained on the common ruler; none if the true ground is not at hand.
    #[must_use]
    pub fn ruler(&self) -> Option<f64> {
        self.goals.iter().try_fold(0.0, |sum, goal| Some(sum + goal.ruler?))
    }

    /// Worth of the labels found; none if the mission has no labels.
    #[must_use]
    pub fn labels(&self) -> Option<f64> {
        let labels = &self.mission.labels;
        let found = self.goals.iter().filter_map(|goal| goal.label);
        (!labels.is_empty()).then(|| found.fold(0.0, |sum, label| sum + labels[label].worth))
    }
}

/// As a run counts them ([`wisdom_mission::RunSummary::reallocations`]).
fn reallocations(done: &BTreeMap<(String, String), u32>) -> u32 {
    let causes = [Cause::Discovery, Cause::Execution];
    [Action::Add, Action::Modify, Action::Reorder, Action::Drop]
        .into_iter()
        .flat_map(|action| causes.map(|cause| (action.to_string(), cause.to_string())))
        .filter_map(|of| done.get(&of))
        .sum()
}

/// Chance of all steps driven, by the true hazards.
fn reliability(mission: &Mission, pieces: &[Vec<Cell>]) -> Option<f64> {
    let mut neg_ln_r = 0.0;
    for pair in pieces.iter().flat_map(|piece| piece.windows(2)) {
        neg_ln_r += mission.world.step(pair[0], pair[1]).ok()??.cost.neg_ln_r;
    }
    Some(libm::exp(-neg_ln_r))
}

/// The interest map that a run ended with: the last one logged, or the last decision's derived again if the log has no
/// maps. None of a log without decisions.
///
/// # Errors
/// [`ReplayError`] if a map cannot be read, or not be derived.
pub fn final_map(log: &LogReader) -> Result<Option<Raster<f32>>, ReplayError> {
    let Some(last) = log.decisions().last() else { return Ok(None) };
    if let Some(logged) = log.interest(last.number)? {
        return Ok(Some(logged));
    }
    Ok(derive_at(log, last.number)?.map(|past| past.maps().interest.interest.clone()))
}

/// The cells of a grid of which a run was told anything: some layer was read there with an uncertainty below 1.
#[must_use]
pub fn observed(log: &LogReader, grid: GridSpec) -> Raster<bool> {
    let mut seen = Raster::filled(grid, false);
    for entry in &log.entries {
        let Entry::Observation(observation) = entry else { continue };
        for part in &observation.windows {
            let [row, col, rows, cols] =
                [part.row, part.col, part.rows, part.cols].map(|side| side as usize);
            let cells = Window { row, col, rows, cols }.cells();
            for (cell, u) in cells.zip(&part.uncertainty) {
                if *u < 1.0 && grid.contains(cell) {
                    seen[cell] = true;
                }
            }
        }
    }
    seen
}
