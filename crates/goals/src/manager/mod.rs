//! The goal manager: goals are born from maxima, keep their name while the map changes, enter and leave the
//! sequence for stated reasons, and are given up when they must be.

mod commit;
mod orders;
mod reach;
mod revise;
mod select;
mod shortlist;
mod why;

use std::collections::{BTreeMap, BTreeSet};

use wisdom_grid::{Cell, GridSpec, Raster, Window};
use wisdom_planner::CostVector;

use crate::lifecycle::{Diary, Found, Transition};
use crate::prize::quantised;
use crate::sequence::Problem;
use crate::{
    Change, Directive, Domain, Extraction, Goal, GoalId, Kind, Reason, Site, Taxonomy, Term,
    Verdict,
};

pub use commit::Weighed;
pub use select::Selection;

/// How the manager weighs.
#[derive(Debug, Clone, PartialEq)]
pub struct ManagerSpec {
    /// What counts as a maximum worth a goal.
    pub extraction: Extraction,
    /// A new sequence must be better by this share to replace the committed one (default 0.05).
    pub hysteresis: f64,
    /// A maximum within this distance of a known goal is that goal, metres.
    pub identity_radius_m: f64,
    /// Goals sequenced exactly (default 14).
    pub max_sequenced: usize,
    /// Sequences in the family (default 5).
    pub family: usize,
    /// Labels that one search may expand (default 50 000).
    pub expansions: u64,
    /// How often a place given up as unreachable or as failed may be tried anew after its ground changed.
    pub max_reopenings: u32,
    /// Types of objects that directives may ask for.
    pub taxonomy: Taxonomy,
    /// A class read with an uncertainty of at least this is known by its parent type only.
    pub clear_below: f64,
}

impl Default for ManagerSpec {
    fn default() -> Self {
        Self {
            extraction: Extraction::default(),
            hysteresis: 0.05,
            identity_radius_m: 8.0,
            max_sequenced: 14,
            family: 5,
            expansions: 50_000,
            max_reopenings: 1,
            taxonomy: Taxonomy::default(),
            clear_below: 0.5,
        }
    }
}

/// In the stead of a digest: the ground around the place was not all on the map when its goal ended. The first digest
/// seen takes its place, and is no change.
const GROUND_UNSEEN: u64 = 0;

/// A place where a goal ended, kept so that the same maximum does not come back for ever.
#[derive(Debug, Clone, PartialEq)]
pub struct Retired {
    /// The goal that ended there.
    pub goal: GoalId,
    /// What its directive looked for: it may leave something of another kind to do.
    pub kind: Kind,
    /// Its target.
    pub target: Cell,
    /// Maxima within this distance are the same place, metres; so is one whose region holds the target.
    pub radius_m: f64,
    /// Why it ended.
    pub reason: Reason,
    /// The experts that had read anything there when it ended, a bit each by index: what others say later is news.
    pub heard: u64,
    /// Digest of the ground around it when it ended; a change reopens a place given up.
    pub ground: u64,
    /// How often it has been reopened.
    pub reopenings: u32,
    /// Whether it keeps goals away, other than the one that answers for it.
    pub closed: bool,
}

impl Retired {
    /// Whether it ended without success, so that changed ground is a reason to try anew.
    fn is_given_up(&self) -> bool {
        matches!(self.reason, Reason::AttemptsSpent | Reason::Unreachable)
    }
}

/// Failed tries at a place. Places remember them when goals do not: a goal that is lost and found again, or
/// whose maximum wanders, gets no more tries than one that stays.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tries {
    /// Where the first of them was meant to lead.
    pub target: Cell,
    /// How many failed.
    pub failed: u32,
}

/// Something that happened to a goal between two decisions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Event {
    /// Its operators were carried out.
    Achieved,
    /// A try failed.
    Failed,
}

/// What the ground asks for.
#[derive(Debug, Clone, PartialEq)]
pub struct Command {
    /// Its name, by which it can be taken back.
    pub name: String,
    /// What is asked.
    pub wish: Wish,
}

/// What a command asks for.
#[derive(Debug, Clone, PartialEq)]
pub enum Wish {
    /// A goal at this place.
    Pursue {
        /// The directive it is to follow, by index.
        directive: usize,
        /// Its target.
        target: Cell,
        /// What it is worth, in the place of the map's prize.
        prize: f64,
        /// Whether a sequence with it is better than any without.
        mandatory: bool,
    },
    /// The goal of the command of this name is not wanted any more.
    Withdraw,
}

/// Everything the manager remembers. Part of every decision record, so that any decision can be taken again.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ManagerState {
    /// The open goals.
    pub goals: BTreeMap<GoalId, Goal>,
    /// The committed sequence.
    pub agenda: Vec<GoalId>,
    /// Places where goals ended.
    pub retired: Vec<Retired>,
    /// Places where tries failed, and no goal was given up for it yet.
    pub tries: Vec<Tries>,
    /// What happened since the last decision.
    pub events: Vec<(GoalId, Event)>,
    /// What the ground asked for since the last decision.
    pub commands: Vec<Command>,
    /// Number of the next goal.
    pub next_id: u32,
    /// Number of the next decision.
    pub decision: u32,
}

/// Where something stands out, and how much.
#[derive(Clone, Copy)]
pub struct View<'a> {
    /// Maxima of the signal, extracted at half the least prominence: known goals survive a little longer than new
    /// ones need to be born.
    pub sites: &'a [Site],
    /// What stands out, in each cell.
    pub signal: &'a Raster<f32>,
    /// The interest that directives ask of a place.
    pub interest: &'a Raster<f32>,
}

/// The map as goals see it: named scalar planes, no masses.
#[derive(Clone, Copy)]
pub struct Survey<'a> {
    /// What [`Kind::Inspect`] reads: the prize map and the interest.
    pub inspect: View<'a>,
    /// What [`Kind::LookAgain`] reads: the promise map and the interest promised; none if no directive asks.
    pub look_again: Option<View<'a>>,
    /// What [`Kind::Adjudicate`] reads: the contradiction map and the interest; none if no directive asks.
    pub adjudicate: Option<View<'a>>,
    /// Ignorance of each cell.
    pub ignorance: &'a Raster<f32>,
    /// Paradox of each cell.
    pub paradox: &'a Raster<f32>,
    /// Contradiction of each cell.
    pub contradiction: &'a Raster<f32>,
    /// Share of each expert in a cell's interest.
    pub credit: &'a dyn Fn(Cell) -> Vec<f64>,
    /// The experts that have read anything in a cell, a bit each by index.
    pub heard: &'a dyn Fn(Cell) -> u64,
    /// Sum of the experts' uncertainties of a cell.
    pub doubt: &'a dyn Fn(Cell) -> f64,
    /// Class of the ground in a cell and its uncertainty; none where there is no such reading.
    pub class: &'a dyn Fn(Cell) -> Option<(u16, f64)>,
    /// Whether operators can still bring about what a directive wants.
    pub able: &'a dyn Fn(usize) -> bool,
    /// Digest of the ground (what is blocked) around a cell; none where that lies beyond the map's planes.
    pub ground: &'a dyn Fn(Cell) -> Option<u64>,
    /// Where the rover stands.
    pub stand: Cell,
    /// How long the mission has lasted, seconds.
    pub time_s: f64,
    /// Whether any reading changed since the last decision.
    pub map_changed: bool,
}

impl<'a> Survey<'a> {
    /// What directives of a kind read.
    #[must_use]
    pub fn view(&self, kind: Kind) -> Option<View<'a>> {
        match kind {
            Kind::Inspect => Some(self.inspect),
            Kind::LookAgain => self.look_again,
            Kind::Adjudicate => self.adjudicate,
        }
    }

    fn grid(&self) -> GridSpec {
        self.inspect.signal.spec()
    }

    fn spacing_m(&self) -> f64 {
        self.grid().spacing_m()
    }
}

/// How the rover can get to goals.
#[derive(Clone, Copy)]
pub struct Access<'a> {
    /// Poses from which a directive (by index) can be followed at a target, safest first.
    pub poses: &'a dyn Fn(Cell, usize) -> Vec<(Cell, CostVector)>,
    /// Whether a pose still serves a target under a directive.
    pub serves: &'a dyn Fn(Cell, Cell, usize) -> bool,
}

/// Poses of each open goal, safest first, each with what it costs to get there.
pub type Poses = BTreeMap<GoalId, Vec<(Cell, CostVector)>>;

/// Which goals are sequenced exactly.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Shortlist {
    /// Goals sequenced: the committed ones, then the others, best bound first.
    pub kept: Vec<GoalId>,
    /// The others that could be reached, each with the bound that was too low: prize times the reliability of
    /// its safest pose, the most it could add to any sequence on its own.
    pub left_out: Vec<(GoalId, f64)>,
}

/// What a revision already settled, until the sequence is known.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Revision {
    ended: Vec<Verdict>,
    born: BTreeSet<GoalId>,
    /// What changed about goals, in order.
    changes: BTreeMap<GoalId, Vec<Change>>,
    /// What was done in their lives.
    diaries: BTreeMap<GoalId, Diary>,
    /// Those whose last try failed.
    failed: BTreeSet<GoalId>,
    /// Where the maxima of the goals reached before the deliberation.
    before: BTreeMap<GoalId, Window>,
}

impl Revision {
    fn change(&mut self, goal: GoalId, change: Change) {
        self.changes.entry(goal).or_default().push(change);
    }

    fn diary(&mut self, goal: GoalId) -> &mut Diary {
        self.diaries.entry(goal).or_insert_with(|| Diary::new(goal))
    }
}

/// What a deliberation said.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Deliberated {
    /// What was done with every known goal, by its id.
    pub verdicts: Vec<Verdict>,
    /// Every step in a goal's life, by its id.
    pub transitions: Vec<Transition>,
}

/// Adds, drops, transforms and reorders goals.
#[derive(Debug, Clone, PartialEq)]
pub struct GoalManager {
    spec: ManagerSpec,
    directives: Vec<Directive>,
    state: ManagerState,
}

impl GoalManager {
    /// A manager that knows no goal yet.
    #[must_use]
    pub fn new(spec: ManagerSpec, directives: Vec<Directive>) -> Self {
        Self { spec, directives, state: ManagerState::default() }
    }

    /// What it remembers.
    #[must_use]
    pub fn state(&self) -> &ManagerState {
        &self.state
    }

    /// Puts back what a decision record remembered.
    pub fn restore(&mut self, state: ManagerState) {
        self.state = state;
    }

    /// The pool.
    #[must_use]
    pub fn directives(&self) -> &[Directive] {
        &self.directives
    }

    /// How it weighs.
    #[must_use]
    pub fn spec(&self) -> &ManagerSpec {
        &self.spec
    }

    /// The extraction under which known goals survive: half the least prominence.
    #[must_use]
    pub fn survival(&self) -> Extraction {
        let extraction = &self.spec.extraction;
        Extraction { min_prominence: extraction.min_prominence / 2.0, ..extraction.clone() }
    }

    /// Notes what the ground asks for; the next decision acts on it.
    pub fn command(&mut self, command: Command) {
        self.state.commands.push(command);
    }

    /// Lets a goal follow a weaker directive that what is left can pay for; the revision remembers why. Returns the goal as
    /// it was.
    pub fn erode(
        &mut self,
        goal: GoalId,
        weaker: usize,
        terms: Vec<Term>,
        revision: &mut Revision,
    ) -> Option<Goal> {
        let known = self.state.goals.get_mut(&goal)?;
        let before = known.clone();
        let (weight, was) = (&self.directives[weaker].weight, &self.directives[before.directive]);
        known.directive = weaker;
        if known.order.is_none() {
            known.prize = quantised(known.prize / was.weight * weight);
        }
        revision.change(goal, Change::new(Reason::Afforded, terms));
        Some(before)
    }

    /// Takes an erosion back: `goal` is what it was before.
    pub fn take_back(&mut self, goal: Goal, revision: &mut Revision) {
        if let Some(changes) = revision.changes.get_mut(&goal.id) {
            changes.retain(|change| change.reason != Reason::Afforded);
        }
        self.state.goals.insert(goal.id, goal);
    }

    /// Notes that a committed goal is now being carried out.
    pub fn dispatch(&mut self, goal: GoalId) -> Option<Transition> {
        let goal = self.state.goals.get_mut(&goal)?;
        let Found::Committed(at) = goal.life.found() else { return None };
        let mut diary = Diary::new(goal.id);
        goal.life = at.then::<crate::lifecycle::Dispatched>(Reason::Unchanged, &mut diary).life();
        diary.transitions.pop()
    }

    /// Notes what became of a goal; the next decision acts on it.
    pub fn note(&mut self, goal: GoalId, event: Event) {
        self.state.events.push((goal, event));
    }

    /// Chooses a sequence, as [`ManagerSpec::select`] does against the committed one.
    #[must_use]
    pub fn select(&self, problem: &Problem<'_>, pinned: Option<GoalId>) -> Selection {
        self.spec.select(problem, &self.state.agenda, pinned)
    }

    /// Whether a problem can be stated for this domain: every directive can be achieved from the start.
    ///
    /// # Errors
    /// [`crate::DomainError::Impossible`] naming the facts that no operators bring about.
    pub fn check(&self, domain: &Domain) -> Result<(), crate::DomainError> {
        for directive in &self.directives {
            if domain.expand(domain.initial(), directive.achieves).is_none() {
                let wanted: Vec<&str> = domain.names(directive.achieves).collect();
                return Err(crate::DomainError::Impossible { wanted: wanted.join(", ") });
            }
        }
        Ok(())
    }
}
