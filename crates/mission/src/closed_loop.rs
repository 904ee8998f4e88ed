//! The closed loop: look, decide, drive, report, until there is nothing left to do.

use std::collections::BTreeMap;

use wisdom_autonomy::{
    Act, Autonomy, AutonomyError, Decision, Message, Observation, Outcome, Pace, Pose, Spent,
    StepResult, Wake, Word,
};
use wisdom_goals::{Action, Cause, GoalId};
use wisdom_grid::{Cell, Window};
use wisdom_planner::Route;
use wisdom_terrain::TerrainError;

use crate::fault::{FaultKind, Faults};
use crate::statistics::{Forecast, brier};
use crate::{FaultEvent, Mission, RecordError, Recorder, Ruler, Step};

/// Why a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum RunStatus {
    /// Nothing was left to do: the rover waits in a safe state.
    Waiting,
    /// Time or energy ran out on the way.
    BudgetSpent,
    /// The mission's limit of decisions was reached.
    DecisionLimit,
    /// Somebody asked the run to stop.
    Stopped,
}

impl std::fmt::Display for RunStatus {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Waiting => "waiting",
            Self::BudgetSpent => "budget-spent",
            Self::DecisionLimit => "decision-limit",
            Self::Stopped => "stopped",
        })
    }
}

/// A goal that was achieved.
#[derive(Debug, Clone, PartialEq)]
pub struct Achievement {
    /// The goal.
    pub goal: GoalId,
    /// Its directive's name.
    pub directive: String,
    /// Its target.
    pub target: Cell,
    /// Interest at the target on the run's own map when it was achieved.
    pub interest: f64,
    /// Its prize then.
    pub prize: f64,
    /// Interest there on the common ruler: the noise-free, fully known world under the rule `dsmc`.
    pub ruler: f64,
    /// Mission time, seconds.
    pub time_s: f64,
}

/// How a leg was predicted and how it went.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LegRecord {
    /// Reliability predicted when it was decided.
    pub predicted: f64,
    /// Whether the rover arrived; none if it was cut short by a decision or by the end of the budget, which
    /// say nothing of the ground.
    pub arrived: Option<bool>,
}

/// What a run came to.
#[derive(Debug, Clone, PartialEq)]
pub struct RunSummary {
    /// Why it ended.
    pub status: RunStatus,
    /// The goals achieved, in order.
    pub achieved: Vec<Achievement>,
    /// How often each action was taken, by cause.
    pub actions: BTreeMap<(Action, Cause), u32>,
    /// What was spent.
    pub spent: Spent,
    /// Decisions taken.
    pub decisions: u32,
    /// Observations made.
    pub observations: u32,
    /// The legs on which wheels were to turn: a goal served from where the rover stands is none.
    pub legs: Vec<LegRecord>,
    /// −ln of the chance of all steps driven, by the true hazards.
    pub neg_ln_r: f64,
    /// Every cell the rover stood on, in order.
    pub track: Vec<Cell>,
    /// The faults that struck, in order.
    pub faults: Vec<FaultEvent>,
}

impl RunSummary {
    /// How often an action was taken, whatever the cause.
    #[must_use]
    pub fn count(&self, action: Action) -> u32 {
        self.actions.iter().filter(|((a, _), _)| *a == action).map(|(_, n)| n).sum()
    }

    /// How often an action was taken for a cause.
    #[must_use]
    pub fn count_for(&self, action: Action, cause: Cause) -> u32 {
        self.actions.get(&(action, cause)).copied().unwrap_or(0)
    }

    /// Changes of the goals that were reallocations: everything but keeping, deferring and achieving, after
    /// the first decision.
    #[must_use]
    pub fn reallocations(&self) -> u32 {
        let changes = [Action::Add, Action::Modify, Action::Reorder, Action::Drop];
        changes
            .iter()
            .flat_map(|a| [Cause::Discovery, Cause::Execution].map(|c| self.count_for(*a, c)))
            .sum()
    }

    /// Chance that a rover survives all steps that were driven, by the true hazards.
    #[must_use]
    pub fn reliability(&self) -> f64 {
        libm::exp(-self.neg_ln_r)
    }

    /// Interest gained on the run's own map.
    #[must_use]
    pub fn interest(&self) -> f64 {
        self.achieved.iter().fold(0.0, |sum, a| sum + a.interest)
    }

    /// Interest gained on the common ruler.
    #[must_use]
    pub fn ruler(&self) -> f64 {
        self.achieved.iter().fold(0.0, |sum, a| sum + a.ruler)
    }

    /// Mean squared difference between predicted reliability and what happened, over legs that ended by
    /// themselves (Brier 1950); none without such legs.
    #[must_use]
    pub fn brier(&self) -> Option<f64> {
        let ended = self.legs.iter();
        brier(
            ended.filter_map(|leg| {
                Some(Forecast { predicted: leg.predicted, happened: leg.arrived? })
            }),
        )
    }
}

/// How far a run is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress<'a> {
    /// What was spent.
    pub spent: Spent,
    /// The budget's energy, joules.
    pub energy_j: f64,
    /// The budget's time, seconds.
    pub time_s: f64,
    /// Goals achieved.
    pub achieved: usize,
    /// The latest decision, when one was just taken.
    pub decision: Option<&'a Decision>,
}

/// Why a run could not go on.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// The core refused something.
    #[error("the autonomy core stopped: {0}")]
    Autonomy(#[from] AutonomyError),
    /// The true ground could not be read.
    #[error("the ground could not be read: {0}")]
    Ground(#[from] TerrainError),
    /// A record could not be kept.
    #[error("the record could not be kept: {0}")]
    Record(#[from] RecordError),
}

/// Runs a mission to its end.
///
/// `watch` is called after every decision and look; it returns whether to go on.
///
/// # Errors
/// [`RunError`] if the core or the recorder stops.
pub fn run(
    mission: &Mission,
    recorder: &mut dyn Recorder,
    watch: &mut dyn FnMut(&Progress<'_>) -> bool,
) -> Result<RunSummary, RunError> {
    let rover = Autonomy::new(mission.spec.clone())?;
    let start = mission.world.execution().start;
    let simulation = Simulation {
        mission,
        rover,
        charted: Vec::new(),
        recorder,
        watch,
        pose: Pose { cell: start, heading_rad: mission.world.execution().heading_rad },
        spent: Spent::default(),
        observations: 0,
        looks: 0,
        last_look: None,
        handed_in: 0,
        operators: 0,
        expected: mission.world.execution().commands.clone(),
        messages: 0,
        entries: BTreeMap::new(),
        going_on: true,
        summary: RunSummary {
            status: RunStatus::Waiting,
            achieved: Vec::new(),
            actions: BTreeMap::new(),
            spent: Spent::default(),
            decisions: 0,
            observations: 0,
            legs: Vec::new(),
            neg_ln_r: 0.0,
            track: vec![start],
            faults: Vec::new(),
        },
        faults: mission.world.faults(),
        ruler: Ruler::new(mission),
    };
    simulation.run()
}

/// How a drive ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Drive {
    Arrived,
    /// The core wants to decide.
    Interrupted,
    /// Time or energy ran out on the way: nobody's failure.
    Spent,
    Blocked,
    Aborted,
}

struct Simulation<'a> {
    mission: &'a Mission,
    rover: Autonomy,
    /// The parts of the ground whose view from before the first look the rover has.
    charted: Vec<Window>,
    recorder: &'a mut dyn Recorder,
    watch: &'a mut dyn FnMut(&Progress<'_>) -> bool,
    pose: Pose,
    spent: Spent,
    observations: u32,
    looks: u32,
    last_look: Option<Cell>,
    /// Readings handed over so far.
    handed_in: usize,
    operators: u32,
    /// Messages to come, by mission time.
    expected: Vec<(f64, Word)>,
    /// Messages passed on.
    messages: u32,
    /// How often each cell was entered.
    entries: BTreeMap<Cell, u32>,
    going_on: bool,
    /// What has broken; the core never hears of it.
    faults: Faults,
    summary: RunSummary,
    ruler: Ruler,
}

impl Simulation<'_> {
    fn run(mut self) -> Result<RunSummary, RunError> {
        self.chart()?;
        self.look()?;
        self.summary.status = loop {
            if self.summary.decisions == self.mission.world.execution().max_decisions {
                break RunStatus::DecisionLimit;
            }
            let decision = self.decide()?;
            if !self.going_on {
                break RunStatus::Stopped;
            }
            let outcome = match &decision.act {
                Act::Wait { wake } => {
                    if self.sleep(*wake)? {
                        continue;
                    }
                    break RunStatus::Waiting;
                }
                Act::Pursue(goal) => self.pursue(&decision, *goal)?,
                Act::Look { route, .. } | Act::Home { route } => {
                    match self.reposition(&decision, route)? {
                        Some(outcome) => outcome,
                        None => break RunStatus::Waiting,
                    }
                }
                _ => break RunStatus::Waiting,
            };
            self.strike()?;
            self.recorder.outcome(&outcome)?;
            self.rover.report(&outcome)?;
            self.chart()?;
            self.hand_in()?;
            if self.is_spent() {
                // The budget is gone: one last decision says what became of the goals, and the rover waits.
                self.decide()?;
                break RunStatus::BudgetSpent;
            }
            if !self.going_on {
                break RunStatus::Stopped;
            }
        };
        self.summary.spent = self.spent;
        self.summary.observations = self.observations;
        self.summary.faults = self.faults.into_struck();
        Ok(self.summary)
    }

    fn is_spent(&self) -> bool {
        let budget = &self.mission.spec.budget;
        self.spent.time_s >= budget.time_s
            || self.spent.energy_j >= budget.energy_j - budget.reserve_j
    }

    fn watch(&mut self, decision: Option<&Decision>) {
        let budget = &self.mission.spec.budget;
        let progress = Progress {
            spent: self.spent,
            energy_j: budget.energy_j - budget.reserve_j,
            time_s: budget.time_s,
            achieved: self.summary.achieved.len(),
            decision,
        };
        self.going_on &= (self.watch)(&progress);
    }

    fn decide(&mut self) -> Result<Decision, RunError> {
        let decision = self.rover.decide()?;
        for verdict in &decision.verdicts {
            *self.summary.actions.entry((verdict.action, verdict.cause)).or_default() += 1;
            if verdict.action == Action::Achieve {
                let goal = &verdict.goal;
                self.summary.achieved.push(Achievement {
                    goal: goal.id,
                    directive: self.mission.spec.directives[goal.directive].name.clone(),
                    target: goal.target,
                    interest: goal.interest,
                    prize: goal.prize,
                    ruler: self.ruler.interest(goal.target)?,
                    time_s: self.spent.time_s,
                });
            }
        }
        self.summary.decisions += 1;
        if let Some(maps) = self.rover.maps() {
            self.recorder.decision(&decision, maps)?;
        }
        self.watch(Some(&decision));
        Ok(decision)
    }

    fn observe(&mut self, windows: Vec<wisdom_autonomy::LayerWindow>) -> Result<(), RunError> {
        let observation =
            Observation { number: self.observations, pose: self.pose, spent: self.spent, windows };
        self.recorder.observation(&observation)?;
        self.rover.observe(&observation)?;
        self.observations += 1;
        self.chart()
    }

    /// Hands over what was known of the ground beforehand where the working map has moved to.
    fn chart(&mut self) -> Result<(), RunError> {
        let working = self.rover.working_map();
        if self.charted.last() == Some(&working) {
            return Ok(());
        }
        // What was handed over before is part of what the rover knows: a second time it would count as news, and
        // stand against its own readings.
        let mut fresh = vec![working];
        for known in &self.charted {
            fresh = fresh.into_iter().flat_map(|part| part.minus(*known)).collect();
        }
        let begins = self.charted.is_empty();
        self.charted.push(working);
        let mut prior = Vec::new();
        for part in fresh {
            prior.extend(self.mission.world.prior(&self.mission.spec.layers, part)?);
        }
        if prior.is_empty() && !begins { Ok(()) } else { self.observe(prior) }
    }

    /// Hands over the readings whose time has come.
    fn hand_in(&mut self) -> Result<(), RunError> {
        let world = &self.mission.world;
        let waiting = &world.execution().readings[self.handed_in..];
        let due = waiting.iter().take_while(|reading| reading.at_s <= self.spent.time_s);
        let windows: Vec<_> = due.map(|reading| reading.window(world.grid())).collect();
        if windows.is_empty() {
            return Ok(());
        }
        self.handed_in += windows.len();
        self.observe(windows)
    }

    /// A look with all instruments, unless the last one was from here. What is handed in by then comes first.
    fn look(&mut self) -> Result<(), RunError> {
        self.hand_in()?;
        if self.mission.world.instruments().is_empty() {
            // Without instruments there still is a clock, for those who go by it.
            let spec = &self.mission.spec;
            let timed = spec.triggers.pace != Pace::Event
                || spec.triggers.watchdog_s.is_finite()
                || spec.directives.iter().any(|d| d.window.is_some());
            return if timed { self.observe(Vec::new()) } else { Ok(()) };
        }
        if self.last_look == Some(self.pose.cell) {
            return Ok(());
        }
        self.strike()?;
        let (faults, now_s) = (&self.faults, self.spent.time_s);
        let windows = self.mission.world.look_despite(faults, now_s, self.pose, self.looks)?;
        self.looks += 1;
        self.last_look = Some(self.pose.cell);
        self.observe(windows)?;
        self.watch(None);
        Ok(())
    }

    /// Lets the faults strike that are due, and passes on the messages that have come.
    fn strike(&mut self) -> Result<(), RunError> {
        while let Some(event) = self.faults.strike(self.spent.time_s) {
            self.recorder.fault(&event)?;
            if let FaultKind::FactsLost { facts } = event.kind {
                let lost = Word::Facts { adds: Vec::new(), deletes: facts.clone() };
                self.expect(event.time_s, lost);
                let restored = self.restorable(facts);
                if event.until_s.is_finite() && !restored.is_empty() {
                    let works = Word::Facts { adds: restored, deletes: Vec::new() };
                    self.expect(event.until_s, works);
                }
            }
        }
        while self.expected.first().is_some_and(|(due_s, _)| *due_s <= self.spent.time_s) {
            let (_, word) = self.expected.remove(0);
            let message = Message { number: self.messages, word };
            self.recorder.message(&message)?;
            self.rover.hear(&message)?;
            self.messages += 1;
        }
        Ok(())
    }

    /// Of facts that a fault takes away those that its end gives back: they held, and no operator's doing is in them. The
    /// others are for operators to bring about again.
    fn restorable(&self, mut facts: Vec<String>) -> Vec<String> {
        let domain = &self.mission.spec.domain;
        facts.retain(|fact| {
            domain.set(std::slice::from_ref(fact)).is_ok_and(|set| {
                self.rover.facts().contains(set)
                    && domain.operators().iter().all(|o| !o.adds.with(o.deletes).meets(set))
            })
        });
        facts
    }

    /// A message to come; of those at one time, in the order they were announced.
    fn expect(&mut self, due_s: f64, word: Word) {
        let turn = self.expected.partition_point(|(other, _)| *other <= due_s);
        self.expected.insert(turn, (due_s, word));
    }

    /// Sleeps until something wakes the rover, within the time there is. Says whether anything did. Asleep, the rover draws
    /// nothing from the budget but time.
    fn sleep(&mut self, wake: Wake) -> Result<bool, RunError> {
        let window = match wake {
            Wake::Time(time_s) => Some(time_s),
            _ => None,
        };
        // Of faults only those wake it that it is told of; when others strike nobody knows.
        let told = self.faults.next_told_s();
        let word = self.expected.first().map(|(due_s, _)| *due_s);
        let readings = &self.mission.world.execution().readings;
        let reading = readings.get(self.handed_in).map(|reading| reading.at_s);
        let next = [window, told, word, reading].into_iter().flatten().min_by(f64::total_cmp);
        let Some(next) = next.filter(|&next| next < self.mission.spec.budget.time_s) else {
            return Ok(false);
        };
        self.spent.time_s = self.spent.time_s.max(next);
        self.strike()?;
        self.observe(Vec::new())?;
        self.hand_in()?;
        Ok(true)
    }

    /// Drives the first leg of the chosen plan and carries out its goal's operators.
    fn pursue(&mut self, decision: &Decision, goal: GoalId) -> Result<Outcome, RunError> {
        let chosen = decision.plan();
        let expansion = chosen.sequence.stops[0].expansion.clone();
        let route = chosen.plan.legs[0].route.clone();
        let mut done: Vec<String> = Vec::new();
        let from = self.summary.track.len() - 1;
        let drive = self.set_out(&expansion.before, &route, &mut done)?;
        let result = match drive {
            Drive::Blocked => StepResult::Blocked(goal),
            Drive::Aborted => StepResult::Aborted(goal),
            Drive::Interrupted | Drive::Spent => StepResult::Interrupted(goal),
            Drive::Arrived => {
                self.look()?;
                // What is seen on arrival may call for a decision before anything is done there.
                if self.rover.triggers().is_empty() {
                    self.await_window(decision, goal)?;
                }
                if self.rover.triggers().is_empty() && self.operate_all(&expansion.after, &mut done)
                {
                    StepResult::Achieved(goal)
                } else {
                    StepResult::Interrupted(goal)
                }
            }
        };
        Ok(self.outcome(decision.number, result, done, route.cost.reliability(), from))
    }

    /// Waits at a goal's pose until its window opens, or word comes; all but the drives stay on.
    fn await_window(&mut self, decision: &Decision, goal: GoalId) -> Result<(), RunError> {
        let spec = &self.mission.spec;
        let Some(goal) = decision.manager_after.goals.get(&goal) else { return Ok(()) };
        let Some(window) = spec.directives[goal.directive].window else { return Ok(()) };
        while self.rover.triggers().is_empty() && self.spent.time_s < window.open_s {
            let word = self.expected.first().map_or(f64::INFINITY, |(due_s, _)| *due_s);
            let until_s = window.open_s.min(word);
            let wait_s = (until_s - self.spent.time_s).max(0.0);
            self.spent.time_s = self.spent.time_s.max(until_s);
            self.spent.energy_j += self.mission.spec.vehicle.hotel_power_w * wait_s;
            self.strike()?;
        }
        Ok(())
    }

    /// Drives to a vantage or home. Whatever must be true before driving (a stowed arm) is made true as for a
    /// goal; none if nothing can make it true, so that the rover has to stay where it is.
    fn reposition(
        &mut self,
        decision: &Decision,
        route: &Route,
    ) -> Result<Option<Outcome>, RunError> {
        let domain = &self.mission.spec.domain;
        let Some(ready) = domain.expand(self.rover.facts(), wisdom_goals::FactSet::EMPTY) else {
            return Ok(None);
        };
        let from = self.summary.track.len() - 1;
        let mut done = Vec::new();
        let result = match self.set_out(&ready.before, route, &mut done)? {
            Drive::Arrived => {
                if route.cells.len() == 1 {
                    // It is to look again from where it stands.
                    self.last_look = None;
                }
                self.look()?;
                StepResult::Arrived
            }
            _ => StepResult::Stopped,
        };
        Ok(Some(self.outcome(decision.number, result, done, route.cost.reliability(), from)))
    }

    /// Carries out what must be done before a drive, then drives. The drive is an operator too, carried out
    /// once wheels turn, or at once where the rover already stands at the pose.
    fn set_out(
        &mut self,
        before: &[usize],
        route: &Route,
        done: &mut Vec<String>,
    ) -> Result<Drive, RunError> {
        if !self.operate_all(before, done) {
            return Ok(Drive::Spent);
        }
        let from = self.summary.track.len();
        let drive = self.drive(route)?;
        if self.summary.track.len() > from || drive == Drive::Arrived {
            self.operate(self.mission.spec.domain.drive(), done);
        }
        if route.cells.len() > 1 {
            let arrived = match drive {
                Drive::Arrived => Some(true),
                Drive::Interrupted | Drive::Spent => None,
                Drive::Blocked | Drive::Aborted => Some(false),
            };
            self.summary.legs.push(LegRecord { predicted: route.cost.reliability(), arrived });
        }
        Ok(drive)
    }

    fn outcome(
        &self,
        decision: u32,
        result: StepResult,
        operators: Vec<String>,
        predicted_reliability: f64,
        from: usize,
    ) -> Outcome {
        Outcome {
            decision,
            result,
            operators,
            pose: self.pose,
            spent: self.spent,
            predicted_reliability,
            track: self.summary.track[from..].to_vec(),
        }
    }

    /// Operators one after the other, none begun once the budget is gone. Says whether all were carried out.
    fn operate_all(&mut self, operators: &[usize], done: &mut Vec<String>) -> bool {
        for &index in operators {
            if self.is_spent() {
                return false;
            }
            self.operate(index, done);
        }
        true
    }

    /// One operator: its costs, scattered.
    fn operate(&mut self, index: usize, done: &mut Vec<String>) {
        let operator = &self.mission.spec.domain.operators()[index];
        let factor = self.mission.world.service_factor(self.operators);
        self.operators += 1;
        self.spent.time_s += operator.cost.time_s * factor;
        self.spent.energy_j += operator.cost.energy_j * factor;
        self.spent.data_mb += operator.cost.data_mb;
        done.push(operator.name.clone());
    }

    /// Drives a route cell by cell over the true ground, looking as it goes.
    fn drive(&mut self, route: &Route) -> Result<Drive, RunError> {
        let world = &self.mission.world;
        let mut since_look_m = 0.0;
        for pair in route.cells.windows(2) {
            let (from, to) = (pair[0], pair[1]);
            self.strike()?;
            let Some(Step { cost, slip }) = world.step(from, to)? else {
                // The reactive layer: ground the map took for passable is not.
                self.spent.time_s += self.faults.delay_s(self.spent.time_s);
                self.observe(world.close_look(from)?)?;
                return Ok(Drive::Blocked);
            };
            let entry = self.entries.entry(to).and_modify(|n| *n += 1).or_insert(1);
            let entry = *entry;
            let scatter = world.slip_factor(to, entry);
            let factor = scatter * self.faults.drag(self.spent.time_s);
            self.spent.time_s += cost.time_s * factor;
            self.spent.energy_j += cost.energy_j * factor;
            // A step that costs twice the wheels' way keeps half of what was kept of it.
            if 1.0 - (1.0 - slip) / scatter >= self.mission.spec.vehicle.slip_max {
                // The wheels spin: the way is spent and nothing gained.
                return self.aborted();
            }
            self.spent.length_m += cost.length_m;
            self.summary.neg_ln_r += cost.neg_ln_r;
            self.pose = Pose { cell: to, heading_rad: heading(from, to) };
            self.summary.track.push(to);
            since_look_m += cost.length_m;
            if world.hazard_strikes(cost.neg_ln_r, to, entry) {
                return self.aborted();
            }
            let is_last = Some(&to) == route.cells.last();
            if self.is_spent() && !is_last {
                return Ok(Drive::Spent);
            }
            if since_look_m >= world.execution().look_every_m && !is_last {
                since_look_m = 0.0;
                self.look()?;
                if !self.rover.triggers().is_empty() {
                    return Ok(Drive::Interrupted);
                }
            }
        }
        Ok(Drive::Arrived)
    }

    /// A hazard ended the drive: the rover recovers, waits for the ground's word if it must, and looks around.
    fn aborted(&mut self) -> Result<Drive, RunError> {
        self.spent.time_s += self.mission.world.execution().recovery_s;
        self.spent.time_s += self.faults.delay_s(self.spent.time_s);
        self.look()?;
        Ok(Drive::Aborted)
    }
}

/// Heading of a step, radians clockwise from north.
fn heading(from: Cell, to: Cell) -> f64 {
    let north = from.row as f64 - to.row as f64;
    let east = to.col as f64 - from.col as f64;
    libm::atan2(east, north).rem_euclid(std::f64::consts::TAU)
}
