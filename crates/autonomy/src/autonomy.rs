//! The core itself: observe, hear, decide, report.

use wisdom_fusion::credit;
use wisdom_goals::{
    Access, CausalGraph, Command, Deliberated, Event, FactSet, Goal, GoalId, GoalManager,
    GoalSequence, Kind, Limits, Preferences, Prices, Problem, Selection, Survey, View, Wish,
};
use wisdom_grid::{Cell, Window};
use wisdom_planner::{
    Budget as PlanBudget, CostVector, Field, FieldOptions, Leg, Limits as DriveLimits, Plan, Route,
    Service, TravelCache, TravelMatrix, field, validate,
};

use crate::maps::Digester;
use crate::weighing::{Asked, Standing, weigh};
use crate::{
    Act, AutonomyError, Decision, Deliberation, Digest, Digests, FrontOf, Knowledge,
    MIN_WORKING_CELLS, Maps, Message, Moment, Objectives, Observation, Outcome, Pace, PlanOption,
    Pose, RoverState, Source, Spec, Spent, Stage, StepResult, Trigger, Triggers, Wake, Watch, Word,
};

/// Cells around a goal whose ground decides whether a place given up may be tried again.
const LOCAL_GROUND: usize = 8;

/// The leg being driven.
#[derive(Debug, Clone, PartialEq)]
struct Underway {
    goal: GoalId,
    route: Route,
    energy_at_start_j: f64,
    /// Prizes of the route's cells when it was decided; empty if nobody asks for their changes.
    prizes: Vec<f32>,
}

/// The autonomy core: a pure function of its spec and of what it observed and was told.
///
/// Feed it [`Autonomy::observe`] and [`Autonomy::report`]; whenever [`Autonomy::triggers`] is not empty, or a
/// step has ended, ask it to [`Autonomy::decide`].
#[derive(Debug, Clone)]
pub struct Autonomy {
    spec: Spec,
    knowledge: Knowledge,
    working: Window,
    maps: Option<Maps>,
    /// Routes between poses, kept where the ground did not change: they save time and change nothing.
    travel: TravelCache,
    manager: GoalManager,
    facts: FactSet,
    /// Facts added and deleted by messages while a step was carried out: its operators were begun before.
    told: Vec<(FactSet, FactSet)>,
    /// Whether a step is being carried out.
    acting: bool,
    pose: Pose,
    spent: Spent,
    observations: u32,
    decisions: u32,
    messages: u32,
    decided_version: u64,
    /// Mission time of the last decision, seconds.
    decided_at_s: f64,
    triggers: Vec<Trigger>,
    underway: Option<Underway>,
    idle_looks: u32,
    deliberation: Option<Deliberation>,
}

impl Autonomy {
    /// A core that has seen nothing yet.
    ///
    /// # Errors
    /// [`AutonomyError`] if experts, layers, operators, directives or limits do not fit each other.
    pub fn new(spec: Spec) -> Result<Self, AutonomyError> {
        spec.vehicle.validate()?;
        spec.fusion.check(spec.experts.len())?;
        let (found, limit) = (spec.experts.len(), u64::BITS as usize);
        if found > limit {
            return Err(AutonomyError::TooManyExperts { found, limit });
        }
        for expert in &spec.experts {
            let layer = spec.layers.iter().find(|l| l.name == expert.layer).ok_or_else(|| {
                AutonomyError::NoLayer { expert: expert.name.clone(), layer: expert.layer.clone() }
            })?;
            if layer.unit != expert.table.unit() {
                return Err(AutonomyError::Unit {
                    expert: expert.name.clone(),
                    layer: layer.name.clone(),
                    table: expert.table.unit().to_owned(),
                    unit: layer.unit.clone(),
                });
            }
        }
        if let Some(layer) = &spec.slip_layer
            && !spec.measures(layer)
        {
            return Err(AutonomyError::SlipLayer { layer: layer.clone() });
        }
        let measured = spec.layers.iter().filter_map(|l| match l.source {
            Source::Measured(update) => Some((l.name.clone(), update)),
            Source::Derived(_) => None,
        });
        let knowledge = Knowledge::new(spec.grid, measured);
        let manager = GoalManager::new(spec.manager.clone(), spec.directives.clone());
        manager.check(&spec.domain)?;
        let facts = spec.domain.initial();
        let pose = Pose { cell: spec.fallback.home, heading_rad: 0.0 };
        if let Some(side) = spec.working_cells
            && side < MIN_WORKING_CELLS
        {
            return Err(AutonomyError::WorkingCells { side });
        }
        let working = spec.working_map(pose.cell);
        Ok(Self {
            spec,
            knowledge,
            working,
            maps: None,
            travel: TravelCache::new(),
            manager,
            facts,
            told: Vec::new(),
            acting: false,
            pose,
            spent: Spent::default(),
            observations: 0,
            decisions: 0,
            messages: 0,
            decided_version: 0,
            decided_at_s: 0.0,
            triggers: vec![Trigger::Start],
            underway: None,
            idle_looks: 0,
            deliberation: None,
        })
    }

    /// What it was told once.
    #[must_use]
    pub fn spec(&self) -> &Spec {
        &self.spec
    }

    /// The maps of the latest observation; none before the first.
    #[must_use]
    pub fn maps(&self) -> Option<&Maps> {
        self.maps.as_ref()
    }

    /// The part of the grid that decisions look at ([`Spec::working_cells`]).
    #[must_use]
    pub fn working_map(&self) -> Window {
        self.working
    }

    /// What the latest decision was searched in; none before the first.
    #[must_use]
    pub fn deliberation(&self) -> Option<&Deliberation> {
        self.deliberation.as_ref()
    }

    /// The facts that hold.
    #[must_use]
    pub fn facts(&self) -> FactSet {
        self.facts
    }

    /// What calls for a decision now. At a cadence ([`Pace::Cadence`]) what is not urgent is kept until something is.
    #[must_use]
    pub fn triggers(&self) -> &[Trigger] {
        let paced = self.spec.triggers.pace == Pace::Cadence;
        let due = !paced || self.triggers.iter().any(Trigger::is_urgent);
        if due { &self.triggers } else { &[] }
    }

    /// Takes in an observation, derives the maps anew if a reading changed, and notes what calls for a
    /// decision.
    ///
    /// # Errors
    /// [`AutonomyError`] if the observation is out of order, off the grid or holds bad readings.
    pub fn observe(&mut self, observation: &Observation) -> Result<(), AutonomyError> {
        self.observe_watched(observation, &mut |_| {})
    }

    /// [`Autonomy::observe`], with someone told of each [`Stage`] as it ends. Stages that are not gone through are
    /// not told of: without a new reading the maps stay.
    ///
    /// # Errors
    /// As [`Autonomy::observe`].
    pub fn observe_watched(
        &mut self,
        observation: &Observation,
        watch: Watch<'_>,
    ) -> Result<(), AutonomyError> {
        if observation.number != self.observations {
            return Err(AutonomyError::ObservationOrder {
                expected: self.observations,
                found: observation.number,
            });
        }
        self.check_cell(observation.pose.cell)?;
        let changed = self.knowledge.take_in(&observation.windows)?;
        self.observations += 1;
        self.pose = observation.pose;
        self.spent = observation.spent;
        watch(Stage::Readings);
        self.derive_maps(changed, watch)?;
        if self.decisions > 0 {
            let noticed = self.notice(changed.is_some());
            for trigger in noticed {
                self.trigger(trigger);
            }
        }
        watch(Stage::Triggers);
        Ok(())
    }

    /// Moves the working map on if the rover has come near its edge, and derives the maps anew where that or the
    /// readings that changed ask for it.
    fn derive_maps(
        &mut self,
        changed: Option<Window>,
        watch: Watch<'_>,
    ) -> Result<(), AutonomyError> {
        if self.spec.outgrows(self.working, self.pose.cell) {
            self.working = self.spec.working_map(self.pose.cell);
            self.maps = None;
        }
        let (spec, knowledge, survival) = (&self.spec, &self.knowledge, self.manager.survival());
        self.maps = Some(match (self.maps.take(), changed) {
            (None, _) => Maps::new(spec, knowledge, self.working, &survival, watch)?,
            (Some(maps), Some(changed)) => {
                maps.revised(spec, knowledge, changed, &survival, watch)?
            }
            (Some(maps), None) => maps,
        });
        Ok(())
    }

    /// Takes in word from the ground or from the rover's own health watch.
    ///
    /// # Errors
    /// [`AutonomyError`] if the message is out of order, or names a directive, a fact or a place that there is not.
    pub fn hear(&mut self, message: &Message) -> Result<(), AutonomyError> {
        let number = message.number;
        if number != self.messages {
            return Err(AutonomyError::MessageOrder { expected: self.messages, found: number });
        }
        let wrong = |why: String| AutonomyError::Message { number, why };
        match &message.word {
            Word::Pursue { name, directive, target, prize, mandatory } => {
                self.check_cell(*target)?;
                let pool = self.manager.directives();
                let index = pool.iter().position(|d| d.name == *directive);
                let directive =
                    index.ok_or_else(|| wrong(format!("`{directive}` is no directive")))?;
                if !(prize.is_finite() && *prize > 0.0) {
                    return Err(wrong(format!("a prize of {prize}; expected more than 0")));
                }
                self.manager.command(Command {
                    name: name.clone(),
                    wish: Wish::Pursue {
                        directive,
                        target: *target,
                        prize: *prize,
                        mandatory: *mandatory,
                    },
                });
                self.trigger(Trigger::Command { number });
            }
            Word::Withdraw { name } => {
                self.manager.command(Command { name: name.clone(), wish: Wish::Withdraw });
                self.trigger(Trigger::Command { number });
            }
            Word::Facts { adds, deletes } => {
                let set = |names: &[String]| {
                    self.spec.domain.set(names).map_err(|error| wrong(error.to_string()))
                };
                let (adds, deletes) = (set(adds)?, set(deletes)?);
                self.told.push((adds, deletes));
                if !self.acting {
                    self.take_in_told();
                }
                self.trigger(Trigger::Facts { number });
            }
        }
        self.messages += 1;
        Ok(())
    }

    /// Takes in what became of the step that the last decision asked for.
    ///
    /// # Errors
    /// [`AutonomyError`] if the outcome answers another decision or names an impossible operator.
    pub fn report(&mut self, outcome: &Outcome) -> Result<(), AutonomyError> {
        let last = self.decisions.wrapping_sub(1);
        if outcome.decision != last {
            return Err(AutonomyError::OutcomeOrder { expected: last, found: outcome.decision });
        }
        self.check_cell(outcome.pose.cell)?;
        self.facts = self.carried_out(outcome)?;
        self.take_in_told();
        self.acting = false;
        self.pose = outcome.pose;
        self.spent = outcome.spent;
        self.derive_maps(None, &mut |_| {})?;
        match outcome.result {
            StepResult::Achieved(goal) => {
                self.manager.note(goal, Event::Achieved);
                self.trigger(Trigger::GoalEnded(goal));
                self.underway = None;
            }
            StepResult::Blocked(goal) | StepResult::Aborted(goal) => {
                self.manager.note(goal, Event::Failed);
                self.trigger(Trigger::LegFailed(goal));
                self.underway = None;
            }
            StepResult::Interrupted(goal) if self.triggers.is_empty() => {
                self.trigger(Trigger::LegInterrupted(goal));
            }
            StepResult::Interrupted(_) => {}
            StepResult::Arrived => {
                self.trigger(Trigger::Arrived);
                self.underway = None;
            }
            StepResult::Stopped => {
                self.trigger(Trigger::Stopped);
                self.underway = None;
            }
        }
        Ok(())
    }

    /// Decides what to do next.
    ///
    /// # Errors
    /// [`AutonomyError`] if nothing was observed yet, or if a plan fails its independent validation (a bug of
    /// ours, reported rather than driven).
    pub fn decide(&mut self) -> Result<Decision, AutonomyError> {
        self.decide_watched(&mut |_| {})
    }

    /// [`Autonomy::decide`], with someone told of each [`Stage`] as it ends.
    ///
    /// ```
    /// # use wisdom_autonomy::{Autonomy, AutonomyError, Decision, Stage};
    /// fn told(rover: &mut Autonomy) -> Result<(Decision, Vec<Stage>), AutonomyError> {
    ///     let mut stages = Vec::new();
    ///     let decision = rover.decide_watched(&mut |stage| stages.push(stage))?;
    ///     Ok((decision, stages))
    /// }
    /// ```
    ///
    /// # Errors
    /// As [`Autonomy::decide`].
    pub fn decide_watched(&mut self, watch: Watch<'_>) -> Result<Decision, AutonomyError> {
        let maps = self.maps.take().ok_or(AutonomyError::NothingObserved)?;
        let decision = self.deliberate(&maps, watch);
        self.maps = Some(maps);
        decision
    }

    /// Decides from a moment of another run, or of this one, on the readings this core has taken in: everything else it
    /// remembers is set to the moment first. A core of the same spec that observed the same decides as that run did;
    /// one of another spec decides as it would have in its place.
    ///
    /// Between two moments such a core is fed observations alone: what came of steps and what was heard is in the
    /// moments.
    ///
    /// # Errors
    /// [`AutonomyError::Moment`] if the moment speaks of what this core's spec does not have; else as
    /// [`Autonomy::decide`].
    pub fn decide_at(&mut self, moment: Moment) -> Result<Decision, AutonomyError> {
        let Moment { number, triggers, state, map_changed } = moment;
        let RoverState { pose, spent, facts, underway, idle_looks, manager } = state;
        self.check_cell(pose.cell)?;
        let wrong = |why: String| AutonomyError::Moment { number, why };
        let pool = self.manager.directives();
        if let Some(goal) = manager.goals.values().find(|goal| goal.directive >= pool.len()) {
            let (id, index, known) = (goal.id, goal.directive, pool.len());
            return Err(wrong(format!("{id} follows directive {index} of {known}")));
        }
        let operators = self.spec.domain.operators().len();
        for goal in manager.goals.values() {
            let (id, before) = (goal.id, goal.order.as_ref().and_then(|order| order.before));
            self.check_cell(goal.target)?;
            if let Some(index) = goal.operators.iter().find(|index| **index >= operators) {
                return Err(wrong(format!("{id} is served by operator {index} of {operators}")));
            }
            if before.is_some_and(|(directive, _)| directive >= pool.len()) {
                return Err(wrong(format!("{id} followed a directive that there is not")));
            }
        }
        for command in &manager.commands {
            let Wish::Pursue { directive, target, .. } = &command.wish else { continue };
            self.check_cell(*target)?;
            if *directive >= pool.len() {
                let (name, known) = (&command.name, pool.len());
                return Err(wrong(format!("`{name}` asks for directive {directive} of {known}")));
            }
        }
        for place in &manager.retired {
            self.check_cell(place.target)?;
        }
        let known = manager.agenda.iter().chain(&underway);
        if let Some(id) = known.into_iter().find(|id| !manager.goals.contains_key(id)) {
            return Err(wrong(format!("{id} is committed to, but no goal")));
        }
        if facts.bits().checked_shr(self.spec.domain.facts().len() as u32).unwrap_or(0) != 0 {
            return Err(wrong("a fact holds that the domain does not have".to_owned()));
        }
        self.pose = pose;
        self.spent = spent;
        self.facts = facts;
        self.told.clear();
        self.acting = false;
        self.underway = underway.map(|goal| Underway {
            goal,
            route: Route { cells: Vec::new(), cost: CostVector::ZERO },
            energy_at_start_j: spent.energy_j,
            prizes: Vec::new(),
        });
        self.idle_looks = idle_looks;
        self.manager.restore(manager);
        self.triggers = triggers;
        self.decisions = number;
        let version = self.knowledge.version();
        self.decided_version = if map_changed { version.wrapping_sub(1) } else { version };
        self.derive_maps(None, &mut |_| {})?;
        self.decide()
    }

    /// What messages said of the facts holds from now on.
    fn take_in_told(&mut self) {
        for (adds, deletes) in std::mem::take(&mut self.told) {
            self.facts = self.facts.without(deletes).with(adds);
        }
    }

    fn deliberate(&mut self, maps: &Maps, watch: Watch<'_>) -> Result<Decision, AutonomyError> {
        self.take_in_told();
        let state = self.state();
        let mut triggers = std::mem::take(&mut self.triggers);
        if triggers.is_empty() {
            triggers.push(Trigger::Woken);
        }
        let map_changed = self.knowledge.version() != self.decided_version;
        let credit_at = |cell: Cell| credit(&maps.evidence, &self.spec.fusion, cell);
        let ground_at = |cell: Cell| maps.local_ground(self.spec.grid, cell, LOCAL_GROUND);
        let heard_at = |cell: Cell| maps.heard(&self.spec, cell);
        let doubt_at = |cell: Cell| maps.doubt(&self.spec, cell);
        let class_at = |cell: Cell| maps.class(&self.spec, cell);
        let facts = self.facts;
        let can = |wanted: FactSet| self.spec.domain.expand(facts, wanted).is_some();
        let able: Vec<bool> = self.spec.directives.iter().map(|d| can(d.achieves)).collect();
        let able = |directive: usize| able[directive];
        let interest = &maps.interest.interest;
        let survey = Survey {
            inspect: View { sites: &maps.sites, signal: &maps.prize.prize, interest },
            look_again: maps.promise.as_ref().map(|promise| View {
                sites: &promise.sites,
                signal: &promise.gain,
                interest: &promise.interest,
            }),
            adjudicate: maps.disputes.as_ref().map(|sites| View {
                sites,
                signal: &maps.interest.contradiction,
                interest,
            }),
            ignorance: &maps.interest.ignorance,
            paradox: &maps.interest.paradox,
            contradiction: &maps.interest.contradiction,
            credit: &credit_at,
            heard: &heard_at,
            doubt: &doubt_at,
            class: &class_at,
            able: &able,
            ground: &ground_at,
            stand: self.pose.cell,
            time_s: self.spent.time_s,
            map_changed,
        };
        let mut revision = self.manager.revise(&survey);
        watch(Stage::Goals);

        let limits = self.limits();
        // No budget here: a goal beyond it is deferred for time or energy, with the numbers, and must not look
        // unreachable. The sequencer prunes by the budgets.
        let everywhere = FieldOptions { targets: None, limits: DriveLimits::NONE };
        let reach = field(&maps.ground, self.pose.cell, &everywhere);
        watch(Stage::Reach);
        let standing = Standing { spec: &self.spec, maps, reach: &reach };
        let mut poses = standing.poses_of(&self.manager);
        let access = Access {
            poses: &|target, directive| standing.poses(target, directive),
            serves: &|pose, target, directive| standing.serves(pose, target, directive),
        };
        self.manager.keep_in_reach(&mut poses, access, &survey, &mut revision);
        watch(Stage::Poses);
        let pinned = state.underway.filter(|_| {
            !triggers.iter().any(|t| matches!(t, Trigger::Risk { .. } | Trigger::RouteBlocked(_)))
        });
        let asked = Asked {
            from: self.pose.cell,
            facts: self.facts,
            limits,
            pinned,
            spent_s: self.spent.time_s,
        };
        let mut weighing = weigh(&standing, &self.manager, &mut self.travel, poses, asked, watch);
        // A committed goal that no longer fits may do so as a weaker one.
        let dear = self.manager.too_dear(&weighing.weighed(&self.spec, map_changed));
        if let Some((goal, weaker, terms)) = dear
            && let Some(before) = self.manager.erode(goal, weaker, terms, &mut revision)
        {
            let mut poses = weighing.poses.clone();
            // From poses there are already no new travel has to be worked out.
            let mut kept = poses.remove(&goal).unwrap_or_default();
            kept.retain(|(pose, _)| standing.serves(*pose, before.target, weaker));
            if kept.is_empty() {
                kept = standing.poses(before.target, weaker);
            }
            poses.insert(goal, kept);
            let again = weigh(&standing, &self.manager, &mut self.travel, poses, asked, watch);
            if again.selection.sequence().goals().any(|id| id == goal) {
                weighing = again;
            } else {
                self.manager.take_back(before, &mut revision);
            }
        }
        let weighed = weighing.weighed(&self.spec, map_changed);
        let committed_value = weighed.selection.committed.as_ref().map(|s| s.value);
        let Deliberated { verdicts, mut transitions } = self.manager.commit(revision, weighed);
        watch(Stage::Verdicts);
        let weighed = weighing.weighed(&self.spec, map_changed);
        let family = self.family(maps, weighed.selection, weighed.problem, weighed.nodes)?;
        let chosen = weighed.selection.chosen;
        let (act, act_cost) = self.act(maps, &reach, &family[chosen], &limits);
        if let Act::Pursue(goal) = &act {
            transitions.extend(self.manager.dispatch(*goal));
        }
        self.embark(&act, &family[chosen], maps);
        self.acting = !matches!(act, Act::Wait { .. });
        watch(Stage::Family);

        let digests = Digests {
            frame: maps.frame_digest(&self.spec),
            derived: maps.derived_digest(&self.spec),
            masses: maps.masses_digest(),
            fusion: maps.fusion_digest(),
            ground: maps.ground_digest(),
            travel: travel_digest(&weighing.travel, weighing.nodes.len()),
        };
        watch(Stage::Digests);
        let number = self.decisions;
        self.decisions += 1;
        self.decided_version = self.knowledge.version();
        self.decided_at_s = self.spent.time_s;
        let decision = Decision {
            number,
            triggers,
            state,
            digests,
            map_changed,
            map_version: self.decided_version,
            background: maps.prize.background,
            seen: maps.seen,
            sites: maps.sites.clone(),
            promises: maps.promise.as_ref().map_or_else(Vec::new, |p| p.sites.clone()),
            disputes: maps.disputes.clone().unwrap_or_default(),
            verdicts,
            transitions,
            shortlist: weighing.shortlist.clone(),
            family,
            chosen,
            proof: weighing.selection.proof,
            expansions: weighing.selection.expansions,
            committed_value,
            held: weighing.selection.held,
            act,
            act_cost,
            manager_after: self.manager.state().clone(),
        };
        self.deliberation = Some(weighing.into_deliberation(&decision, self.spent.time_s));
        Ok(decision)
    }

    /// Whether maps and pose are still those of the latest decision.
    pub(crate) fn maps_are_those_decided_on(&self) -> bool {
        let here = |d: &Deliberation| d.nodes.first() == Some(&self.pose.cell);
        self.knowledge.version() == self.decided_version && self.deliberation().is_some_and(here)
    }

    fn state(&self) -> RoverState {
        RoverState {
            pose: self.pose,
            spent: self.spent,
            facts: self.facts,
            underway: self.underway.as_ref().map(|u| u.goal),
            idle_looks: self.idle_looks,
            manager: self.manager.state().clone(),
        }
    }

    fn check_cell(&self, cell: Cell) -> Result<(), AutonomyError> {
        let grid = self.spec.grid;
        if grid.contains(cell) {
            return Ok(());
        }
        Err(AutonomyError::OffGrid { cell, rows: grid.rows(), cols: grid.cols() })
    }

    fn trigger(&mut self, trigger: Trigger) {
        let same = |t: &Trigger| match (t, &trigger) {
            (
                Trigger::InterestChanged { goal: a, .. },
                Trigger::InterestChanged { goal: b, .. },
            )
            | (Trigger::GoalEnded(a), Trigger::GoalEnded(b))
            | (Trigger::LegFailed(a), Trigger::LegFailed(b))
            | (Trigger::Conflict { goal: a, .. }, Trigger::Conflict { goal: b, .. })
            | (Trigger::WindowClosing { goal: a, .. }, Trigger::WindowClosing { goal: b, .. }) => {
                a == b
            }
            (Trigger::Command { number: a }, Trigger::Command { number: b })
            | (Trigger::Facts { number: a }, Trigger::Facts { number: b }) => a == b,
            (a, b) => a.name() == b.name(),
        };
        if !self.triggers.iter().any(same) {
            self.triggers.push(trigger);
        }
    }

    /// What is left to spend.
    fn limits(&self) -> Limits {
        let budget = &self.spec.budget;
        Limits {
            time_s: (budget.time_s - self.spent.time_s).max(0.0),
            energy_j: (budget.energy_j - budget.reserve_j - self.spent.energy_j).max(0.0),
            data_mb: (budget.data_mb - self.spent.data_mb).max(0.0),
            min_reliability: budget.min_reliability,
        }
    }

    /// What the latest observation says that a decision should know of.
    fn notice(&self, changed: bool) -> Vec<Trigger> {
        let mut found = Vec::new();
        let Some(maps) = &self.maps else { return found };
        if changed {
            self.notice_goals(maps, &mut found);
        }
        if let Some(underway) = &self.underway {
            self.notice_leg(maps, underway, changed, &mut found);
        }
        self.notice_time(&mut found);
        found
    }

    /// Windows that close, and the time since the last decision.
    fn notice_time(&self, found: &mut Vec<Trigger>) {
        let Triggers { pace, cadence_s, window_closing_s, watchdog_s, .. } = self.spec.triggers;
        let (now_s, state) = (self.spent.time_s, self.manager.state());
        for goal in state.agenda.iter().filter_map(|id| state.goals.get(id)) {
            let Some(window) = self.spec.directives[goal.directive].window else { continue };
            let left_s = window.close_s - now_s;
            let left_then_s = window.close_s - self.decided_at_s;
            if left_s <= window_closing_s && left_then_s > window_closing_s {
                found.push(Trigger::WindowClosing { goal: goal.id, left_s });
            }
        }
        let since_s = now_s - self.decided_at_s;
        if pace != Pace::Event && since_s >= cadence_s {
            found.push(Trigger::Cadence { since_s });
        }
        if since_s >= watchdog_s {
            found.push(Trigger::Watchdog { since_s });
        }
    }

    fn notice_goals(&self, maps: &Maps, found: &mut Vec<Trigger>) {
        let state = self.manager.state();
        let on_map = |goal: &&Goal| self.working.contains(goal.target);
        for goal in state.agenda.iter().filter_map(|id| state.goals.get(id)).filter(on_map) {
            let directive = &self.manager.directives()[goal.directive];
            let signal = match directive.kind {
                Kind::LookAgain => maps.promise.as_ref().map(|promise| &promise.gain),
                Kind::Adjudicate => Some(&maps.interest.contradiction),
                Kind::Inspect => Some(&maps.prize.prize),
            };
            let after = directive.weight * signal.map_or(0.0, |s| f64::from(s[goal.target]));
            let changed = (after - goal.prize).abs() >= self.spec.triggers.interest_change;
            if changed && goal.order.is_none() {
                found.push(Trigger::InterestChanged { goal: goal.id, before: goal.prize, after });
            }
            let (before, after) =
                (goal.contradiction, f64::from(maps.interest.contradiction[goal.target]));
            let kappa = self.spec.triggers.conflict;
            if before < kappa && after >= kappa {
                found.push(Trigger::Conflict { goal: goal.id, before, after });
            }
        }
        let least = state
            .agenda
            .iter()
            .filter_map(|id| state.goals.get(id))
            .map(|g| g.prize)
            .fold(f64::INFINITY, f64::min);
        let spacing = self.spec.grid.spacing_m();
        let radius_m = self.manager.spec().identity_radius_m;
        let extraction = &self.manager.spec().extraction;
        let near_goal = |cell: Cell| {
            state.goals.values().any(|g| g.target.distance(cell) * spacing <= radius_m)
        };
        let speaks = |cell: Cell| {
            let shares = credit(&maps.evidence, &self.spec.fusion, cell);
            (f64::from(maps.interest.interest[cell]), shares)
        };
        let new = maps.sites.iter().find(|site| {
            site.prominence >= extraction.min_prominence
                && !near_goal(site.peak)
                && self.manager.explained_by(site, Kind::Inspect, spacing, &speaks).is_none()
                && self
                    .weight_of(maps, site.peak)
                    .is_some_and(|weight| weight * site.prize >= least || least.is_infinite())
        });
        if let Some(site) = new {
            found.push(Trigger::NewCandidate { cell: site.peak, prize: site.prize });
        }
    }

    /// The weight of the heaviest directive that looks for such a place, if any does.
    fn weight_of(&self, maps: &Maps, cell: Cell) -> Option<f64> {
        let interest = f64::from(maps.interest.interest[cell]);
        let shares = credit(&maps.evidence, &self.spec.fusion, cell);
        let accepting = self
            .manager
            .directives()
            .iter()
            .filter(|d| d.kind == Kind::Inspect && d.accepts(interest, &shares));
        accepting.map(|d| d.weight).max_by(f64::total_cmp)
    }

    fn notice_leg(
        &self,
        maps: &Maps,
        underway: &Underway,
        changed: bool,
        found: &mut Vec<Trigger>,
    ) {
        let cells = &underway.route.cells;
        let Some(at) = cells.iter().position(|c| *c == self.pose.cell) else { return };
        if changed {
            let mut ahead = CostVector::ZERO;
            for pair in cells[at..].windows(2) {
                let Some(cost) = maps.ground.edge(pair[0], pair[1]) else {
                    found.push(Trigger::RouteBlocked(pair[1]));
                    return;
                };
                ahead += cost;
            }
            self.notice_corridor(maps, underway, at, found);
            let floor = self.spec.budget.min_reliability;
            if ahead.reliability() < floor {
                found.push(Trigger::Risk { reliability: ahead.reliability(), floor });
            }
        }
        let whole = underway.route.cost.energy_j;
        if whole > 0.0 && at > 0 {
            let driven = self.spent.energy_j - underway.energy_at_start_j;
            // What the same edges cost on today's map; one that the map now closes counts nothing.
            let edges =
                cells[..=at].windows(2).filter_map(|pair| maps.ground.edge(pair[0], pair[1]));
            let planned: f64 = edges.map(|cost| cost.energy_j).sum();
            let share = (driven - planned) / whole;
            if share.abs() >= self.spec.triggers.budget_drift {
                found.push(Trigger::BudgetDrift { share });
            }
        }
    }

    /// The largest change of the prize on the way ahead.
    fn notice_corridor(
        &self,
        maps: &Maps,
        underway: &Underway,
        at: usize,
        found: &mut Vec<Trigger>,
    ) {
        let ahead = underway.route.cells.iter().zip(&underway.prizes).skip(at);
        let change = |(cell, before): (&Cell, &f32)| {
            let after = f64::from(*maps.prize.prize.get(*cell)?);
            Some((*cell, f64::from(*before), after))
        };
        let largest = ahead
            .filter_map(change)
            .max_by(|a, b| (a.2 - a.1).abs().total_cmp(&(b.2 - b.1).abs()).then(b.0.cmp(&a.0)));
        if let Some((cell, before, after)) = largest
            && (after - before).abs() >= self.spec.triggers.corridor_change
        {
            found.push(Trigger::CorridorChanged { cell, before, after });
        }
    }

    /// The facts after the operators of an outcome, each checked.
    fn carried_out(&self, outcome: &Outcome) -> Result<FactSet, AutonomyError> {
        let domain = &self.spec.domain;
        let goal = match outcome.result {
            StepResult::Achieved(g)
            | StepResult::Blocked(g)
            | StepResult::Aborted(g)
            | StepResult::Interrupted(g) => self.manager.state().goals.get(&g),
            StepResult::Arrived | StepResult::Stopped => None,
        };
        let wanted =
            goal.map_or(FactSet::EMPTY, |g| self.manager.directives()[g.directive].achieves);
        outcome.operators.iter().try_fold(self.facts, |facts, name| {
            let error = |why| AutonomyError::Operator { operator: name.clone(), why };
            let index = domain
                .operators()
                .iter()
                .position(|o| o.name == *name)
                .ok_or_else(|| error("the domain has no such operator"))?;
            domain.step(facts, index, wanted).ok_or_else(|| error("its preconditions do not hold"))
        })
    }

    /// The plans of the family, each validated by arithmetic of its own: the best of each set, then what else is on
    /// the fronts of their orders.
    fn family(
        &self,
        maps: &Maps,
        selection: &Selection,
        problem: Problem<'_>,
        nodes: &[Cell],
    ) -> Result<Vec<PlanOption>, AutonomyError> {
        let problem = &problem;
        let mut family = Vec::new();
        let mut others = Vec::new();
        for (best, (sequence, found)) in selection.family.iter().zip(&selection.fronts).enumerate()
        {
            let front = FrontOf { best, plans: found.plans.len(), complete: found.complete };
            family.push(self.option(maps, problem, nodes, sequence, front)?);
            let rest: Vec<&GoalSequence> =
                found.plans.iter().filter(|plan| !drives_alike(plan, sequence)).collect();
            for plan in spread(&rest, self.spec.routes.front - 1) {
                others.push(self.option(maps, problem, nodes, plan, front)?);
            }
        }
        family.append(&mut others);
        Ok(family)
    }

    /// A member of the family, validated.
    fn option(
        &self,
        maps: &Maps,
        problem: &Problem<'_>,
        nodes: &[Cell],
        sequence: &GoalSequence,
        front: FrontOf,
    ) -> Result<PlanOption, AutonomyError> {
        let limits = &problem.limits;
        let budget = PlanBudget {
            time_s: limits.time_s,
            energy_j: limits.energy_j,
            min_reliability: limits.min_reliability,
        };
        let invalid = |why: String| AutonomyError::InvalidPlan { why };
        let plan = plan(self.pose.cell, sequence, problem.travel, nodes)
            .ok_or_else(|| invalid("a leg is not in the travel matrix".to_owned()))?;
        validate(&plan, &maps.ground, &self.spec.vehicle, &budget)
            .map_err(|violation| invalid(violation.to_string()))?;
        let state = self.manager.state();
        let directive_of =
            |goal: GoalId| self.manager.directives()[state.goals[&goal].directive].clone();
        CausalGraph::new(sequence, &self.spec.domain, self.facts, directive_of)
            .map_err(|error| invalid(error.to_string()))?;
        let objectives = objectives(sequence, limits.min_reliability, &self.spec.preferences);
        Ok(PlanOption { sequence: sequence.clone(), plan, objectives, front })
    }

    /// The first leg of the chosen plan; without one, the next thing in the order look, home, wait.
    fn act(
        &self,
        maps: &Maps,
        reach: &Field<'_>,
        chosen: &PlanOption,
        limits: &Limits,
    ) -> (Act, CostVector) {
        if let (Some(stop), Some(leg)) = (chosen.sequence.stops.first(), chosen.plan.legs.first()) {
            return (Act::Pursue(stop.goal), leg.route.cost);
        }
        let fallback = &self.spec.fallback;
        // Whatever must be true before driving (a stowed arm) is part of the price.
        let ready = self.spec.domain.expand(self.facts, FactSet::EMPTY).map(|e| e.cost);
        let safe = |route: &Route| {
            ready.is_some_and(|ready| {
                route.cost.reliability() >= limits.min_reliability
                    && route.cost.time_s + ready.time_s <= limits.time_s
                    && route.cost.energy_j + ready.energy_j <= limits.energy_j
            })
        };
        // First from where it stands, if a second reading of the same ground can teach anything.
        if self.idle_looks == 0
            && fallback.max_looks > 0
            && self.spec.learns_from_repeats()
            && let Some(ignorance) = self.ignorance_in_range(maps)
            && let Some(route) = reach.route(self.pose.cell).filter(safe)
        {
            let cost = route.cost;
            return (Act::Look { route, ignorance }, cost);
        }
        if self.idle_looks < fallback.max_looks
            && let Some((route, ignorance)) = self.vantage(maps, reach, limits, &safe)
        {
            let cost = route.cost;
            return (Act::Look { route, ignorance }, cost);
        }
        if fallback.return_home
            && self.pose.cell != fallback.home
            && let Some(route) = reach.route(fallback.home).filter(safe)
        {
            let cost = route.cost;
            return (Act::Home { route }, cost);
        }
        (Act::Wait { wake: self.wake() }, CostVector::ZERO)
    }

    /// What ends a wait: the first window of a goal that is still to open, else word from outside.
    fn wake(&self) -> Wake {
        let goals = self.manager.state().goals.values();
        let opens = goals.filter_map(|g| self.spec.directives[g.directive].window);
        let later = opens.map(|window| window.open_s).filter(|&open_s| open_s > self.spent.time_s);
        later.min_by(f64::total_cmp).map_or(Wake::Word, Wake::Time)
    }

    /// Ignorance in range of where the rover stands, in cells' worth, if it is worth a look.
    fn ignorance_in_range(&self, maps: &Maps) -> Option<f64> {
        let fallback = &self.spec.fallback;
        let radius = (fallback.look_range_m / self.spec.grid.spacing_m()) as usize;
        let plane = &maps.interest.ignorance;
        let window = plane.spec().around(self.pose.cell, radius);
        let ignorance = window.cells().fold(0.0, |sum, cell| sum + f64::from(plane[cell]));
        let mean = ignorance / (window.rows * window.cols) as f64;
        (mean >= fallback.min_ignorance).then_some(ignorance)
    }

    /// The way to the cell from which the most ignorance lies in range, times the chance of getting there, of those that what
    /// is left can pay for.
    fn vantage(
        &self,
        maps: &Maps,
        reach: &Field<'_>,
        limits: &Limits,
        safe: &dyn Fn(&Route) -> bool,
    ) -> Option<(Route, f64)> {
        let fallback = &self.spec.fallback;
        let spacing_m = self.spec.grid.spacing_m();
        let radius = (fallback.look_range_m / spacing_m) as usize;
        let spec = maps.interest.ignorance.spec();
        let (rows, cols, first) = (spec.rows(), spec.cols(), spec.first());
        // Summed areas: the ignorance of any window in four look-ups.
        let mut sums = vec![0.0f64; (rows + 1) * (cols + 1)];
        for (row, values) in maps.interest.ignorance.values().chunks(cols).enumerate() {
            let mut line = 0.0;
            for (col, &ignorance) in values.iter().enumerate() {
                line += f64::from(ignorance);
                sums[(row + 1) * (cols + 1) + col + 1] = sums[row * (cols + 1) + col + 1] + line;
            }
        }
        // No way there is cheaper than a straight one on level ground without slip.
        let affordable = |cell: Cell| {
            let length_m = self.pose.cell.distance(cell) * spacing_m;
            let least = self.spec.vehicle.drive_slipping(length_m, 0.0, 0.0);
            least.is_some_and(|(time_s, energy_j)| {
                time_s <= limits.time_s && energy_j <= limits.energy_j
            })
        };
        let mut worth: Vec<(f64, Cell, f64)> = Vec::new();
        for cell in spec.cells().filter(|cell| *cell != self.pose.cell) {
            let Some(neg_ln_r) = reach.neg_ln_r(cell) else { continue };
            let w = spec.around(cell, radius);
            let at =
                |row: usize, col: usize| sums[(row - first.row) * (cols + 1) + col - first.col];
            let ignorance = at(w.row + w.rows, w.col + w.cols)
                - at(w.row, w.col + w.cols)
                - at(w.row + w.rows, w.col)
                + at(w.row, w.col);
            let mean = ignorance / (w.rows * w.cols) as f64;
            if mean >= fallback.min_ignorance && affordable(cell) {
                worth.push((ignorance * libm::exp(-neg_ln_r), cell, ignorance));
            }
        }
        worth.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        worth.into_iter().find_map(|(_, cell, ignorance)| {
            Some((reach.route(cell).filter(|route| safe(route))?, ignorance))
        })
    }

    /// Remembers the leg that is about to be driven.
    fn embark(&mut self, act: &Act, chosen: &PlanOption, maps: &Maps) {
        let corridor = self.spec.triggers.corridor_change.is_finite();
        self.underway = match (act, chosen.plan.legs.first()) {
            (Act::Pursue(goal), Some(leg)) => Some(Underway {
                goal: *goal,
                route: leg.route.clone(),
                energy_at_start_j: self.spent.energy_j,
                prizes: if corridor {
                    leg.route.cells.iter().map(|cell| maps.prize.prize[*cell]).collect()
                } else {
                    Vec::new()
                },
            }),
            _ => None,
        };
        self.idle_looks = match act {
            Act::Look { .. } => self.idle_looks + 1,
            Act::Pursue(_) => 0,
            _ => self.idle_looks,
        };
    }
}

/// The legs of a sequence; none if one of them is not in the matrix.
fn plan(
    start: Cell,
    sequence: &GoalSequence,
    travel: &TravelMatrix,
    nodes: &[Cell],
) -> Option<Plan> {
    let mut from = 0;
    let legs = sequence
        .stops
        .iter()
        .enumerate()
        .map(|(stop, s)| {
            let route = travel.route(from, s.pose, s.alternative)?;
            from = s.pose;
            let service = Service { time_s: s.service.time_s, energy_j: s.service.energy_j };
            Some(Leg { stop, pose: nodes[s.pose], route, service })
        })
        .collect::<Option<_>>()?;
    Some(Plan::new(start, legs))
}

/// Whether two plans for one order stop at the same poses and take the same ways there.
fn drives_alike(a: &GoalSequence, b: &GoalSequence) -> bool {
    let way = |plan: &GoalSequence| -> Vec<(usize, usize)> {
        plan.stops.iter().map(|stop| (stop.pose, stop.alternative)).collect()
    };
    way(a) == way(b)
}

/// At most so many of the plans, at even steps from the first to the last.
fn spread<'a>(plans: &[&'a GoalSequence], most: usize) -> Vec<&'a GoalSequence> {
    if plans.len() <= most {
        return plans.to_vec();
    }
    let steps = most.saturating_sub(1).max(1);
    (0..most).map(|index| plans[index * (plans.len() - 1) / steps]).collect()
}

fn objectives(sequence: &GoalSequence, floor: f64, preferences: &Preferences) -> Objectives {
    let GoalSequence { prize, fresh, reliability, time_s, energy_j, data_mb, .. } = *sequence;
    let Prices { risk, energy_per_j, time_per_s, data_per_mb } = preferences.prices;
    // Nothing is risked for nothing, however unsafe.
    let danger = if risk > 0.0 { risk * libm::log(reliability) } else { 0.0 };
    let confident = reliability >= floor.max(preferences.confidence);
    Objectives {
        expected_interest: sequence.expected,
        most_interesting: prize,
        all_or_nothing: prize * reliability,
        chance_constrained: if confident { prize } else { 0.0 },
        net_benefit: prize + danger - energy_per_j * energy_j,
        utility: fresh + danger
            - energy_per_j * energy_j
            - time_per_s * time_s
            - data_per_mb * data_mb,
    }
}

fn travel_digest(travel: &TravelMatrix, nodes: usize) -> Digest {
    let mut digest = Digester::default();
    for from in 0..nodes {
        for to in 0..nodes {
            for cost in travel.alternatives(from, to) {
                for number in [cost.length_m, cost.time_s, cost.energy_j, cost.neg_ln_r] {
                    digest.number(number);
                }
            }
            digest.bytes(b";");
        }
    }
    digest.finish()
}
