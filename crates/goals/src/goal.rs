//! Goals and what becomes of them.

use std::fmt;

use wisdom_grid::{Cell, Window};

use crate::lifecycle::{Life, Status, named};

/// A goal's name for life, written `G7`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct GoalId(pub u32);

impl fmt::Display for GoalId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "G{}", self.0)
    }
}

/// What a ground command asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Order {
    /// The command's name.
    pub name: String,
    /// The prize it is worth, in the place of the map's.
    pub prize: f64,
    /// Whether a sequence with it is better than any without.
    pub mandatory: bool,
    /// The directive (by index) and the target of the goal that was there already: what it is again once the command is
    /// taken back.
    pub before: Option<(usize, Cell)>,
}

/// A site with a directive: something to do somewhere.
#[derive(Debug, Clone, PartialEq)]
pub struct Goal {
    /// Its name.
    pub id: GoalId,
    /// The directive it follows, by index.
    pub directive: usize,
    /// The cell it is about (not where the rover will stand).
    pub target: Cell,
    /// Interest at the target when last weighed.
    pub interest: f64,
    /// Directive weight times what the directive looks for, at the target; quantised.
    pub prize: f64,
    /// Prominence of its site, on the scale of what its directive looks for; 0 for a commanded goal.
    pub prominence: f64,
    /// Ignorance m(I ∪ NI) at the target.
    pub ignorance: f64,
    /// Paradox m(I ∩ NI) at the target.
    pub paradox: f64,
    /// Contradiction at the target: the largest `m_a(I)·m_b(NI)` over pairs of experts.
    pub contradiction: f64,
    /// Share of each expert in the interest; sums to one, or all zero where there is no interest.
    pub credit: Vec<f64>,
    /// Cells in its site's region; 0 for a commanded goal.
    pub region_cells: usize,
    /// The smallest window around its site's region: a new maximum in there is one that split off.
    pub extent: Window,
    /// Sum of the experts' uncertainties at the target when it was formulated: what a closer look can lower.
    pub doubt: f64,
    /// Failed tries so far, of its own or at its place before it.
    pub attempts: u32,
    /// The decision that formulated it.
    pub born: u32,
    /// The goal it split off from.
    pub parent: Option<GoalId>,
    /// The command that wants it.
    pub order: Option<Order>,
    /// Where the rover is to stand, while the goal is committed to.
    pub pose: Option<Cell>,
    /// The operators (by index) that serve it, while it is committed to: before the drive, then at the site.
    pub operators: Vec<usize>,
    /// Where it stands in its life.
    pub life: Life,
}

impl Goal {
    /// Where it stands in its life.
    #[must_use]
    pub fn status(&self) -> Status {
        self.life.status()
    }
}

named! {
    /// What a deliberation did with a goal.
    Action {
        /// Entered the sequence.
        Add = "add",
        /// Stays in the sequence as it was.
        Keep = "keep",
        /// Stays in the sequence, changed.
        Modify = "modify",
        /// Stays in the sequence, in another order.
        Reorder = "reorder",
        /// Is known, and not in the sequence.
        Defer = "defer",
        /// Is given up.
        Drop = "drop",
        /// Is done.
        Achieve = "achieve",
    }
}

named! {
    /// Why the action was taken.
    #[non_exhaustive]
    Reason {
        /// A maximum that no known goal explains.
        NewMaximum = "new-maximum",
        /// A maximum that was part of another goal's, or what is left of one whose goal was done.
        Split = "split",
        /// A ground command wants it.
        Commanded = "commanded",
        /// An expert speaks of a place that had said nothing when a goal was done there.
        NewEvidence = "new-evidence",
        /// A place given up before, on trial again because its ground changed.
        Reopened = "reopened",
        /// A known goal that the best sequence now contains.
        Promoted = "promoted",
        /// Nothing about it changed enough.
        Unchanged = "unchanged",
        /// Its maximum moved to another cell.
        PeakMoved = "peak-moved",
        /// A heavier directive looks for what it turned out to be.
        Refined = "refined",
        /// It follows a weaker directive after a failed try.
        Eroded = "eroded",
        /// It follows a weaker directive because the stronger one no longer fits what is left.
        Afforded = "afforded",
        /// It follows a weaker directive because nothing can bring about what the stronger one wants.
        Fault = "fault",
        /// It follows a directive of another kind: what stands out there is something else now.
        Retyped = "retyped",
        /// What kind of thing it is about is clear now, and there is a directive for that.
        Concretised = "concretised",
        /// What kind of thing it is about is no longer clear.
        Abstracted = "abstracted",
        /// Its target cannot be reached; another of its kind takes its place.
        Generalised = "generalised",
        /// Its pose was lost; another one serves.
        PoseLost = "pose-lost",
        /// The best sequence visits it at another turn.
        BetterOrder = "better-order",
        /// It does not fit the remaining time.
        Time = "time",
        /// It does not fit the remaining energy.
        Energy = "energy",
        /// It does not fit the remaining data volume.
        Data = "data",
        /// It would take the plan below the reliability floor.
        Risk = "risk",
        /// Its window has closed, or closes before the rover can be there.
        Window = "window",
        /// Other goals are worth more together.
        Outweighed = "outweighed",
        /// A goal that came in took its place in the sequence.
        Superseded = "superseded",
        /// With it the plan would be better, but not by enough to change the committed sequence.
        Held = "held",
        /// With it the plan would be better, but the search ended before it met that.
        SearchCut = "search-cut",
        /// Its bound was not among those of the goals sequenced.
        BeyondExact = "beyond-exact",
        /// No pose from which it can be done is reachable.
        Unreachable = "unreachable",
        /// Its operators or required facts cannot be brought about.
        Preconditions = "preconditions",
        /// Its interest is gone.
        LostInterest = "lost-interest",
        /// It is as interesting as before, but no longer a maximum.
        NoMaximum = "no-maximum",
        /// A closer look settled what was contradictory.
        Settled = "settled",
        /// Its place lies beyond the map that the rover works on, which moved on with it.
        OffMap = "off-map",
        /// Another goal stands for its maximum now.
        Merged = "merged",
        /// All its tries failed.
        AttemptsSpent = "attempts-spent",
        /// An achieved goal explains the place.
        Explained = "explained",
        /// A goal of the sequence stands so near that doing it will explain the place.
        Excluded = "excluded",
        /// The ground took its command back.
        Withdrawn = "withdrawn",
        /// Its last try failed.
        Failed = "failed",
        /// Its leg ended before it was done: something called for a decision.
        Interrupted = "interrupted",
        /// Its operators were carried out.
        Done = "done",
    }
}

named! {
    /// How a goal was transformed (after Cox & Veloso 1998).
    Transformation {
        /// It is what it was.
        Identity = "identity",
        /// From a place to a better one within it.
        Specialization = "specialization",
        /// From this one to any of its class in reach.
        Generalization = "generalization",
        /// To a broader type of object.
        Abstraction = "abstraction",
        /// To a narrower type of object.
        Concretion = "concretion",
        /// To a weaker aim.
        Erosion = "erosion",
        /// To another kind of goal.
        Retyping = "retyping",
        /// To another pose.
        Substitution = "substitution",
        /// It is given up.
        Retraction = "retraction",
        /// It is new.
        Formulation = "formulation",
        /// It has another turn.
        Reorder = "reorder",
    }
}

impl Transformation {
    /// The transformation that a reason speaks of.
    #[must_use]
    pub fn of(action: Action, reason: Reason) -> Self {
        match (action, reason) {
            (Action::Drop | Action::Achieve, _) => Self::Retraction,
            (
                _,
                Reason::NewMaximum
                | Reason::Split
                | Reason::Commanded
                | Reason::NewEvidence
                | Reason::Reopened,
            ) => Self::Formulation,
            (_, Reason::PeakMoved | Reason::Refined) => Self::Specialization,
            (_, Reason::Generalised) => Self::Generalization,
            (_, Reason::Abstracted) => Self::Abstraction,
            (_, Reason::Concretised) => Self::Concretion,
            (_, Reason::Eroded | Reason::Afforded | Reason::Fault) => Self::Erosion,
            (_, Reason::Retyped) => Self::Retyping,
            (_, Reason::PoseLost) => Self::Substitution,
            (_, Reason::BetterOrder) => Self::Reorder,
            _ => Self::Identity,
        }
    }
}

/// What a deliberation changed about a goal itself, whether it is in the sequence or not.
#[derive(Debug, Clone, PartialEq)]
pub struct Change {
    /// How it was transformed.
    pub transformation: Transformation,
    /// Why.
    pub reason: Reason,
    /// The goal that the reason speaks of (split off from).
    pub other: Option<GoalId>,
    /// The numbers compared.
    pub terms: Vec<Term>,
}

impl Change {
    /// A change for a reason that names its own transformation.
    #[must_use]
    pub fn new(reason: Reason, terms: Vec<Term>) -> Self {
        let transformation = Transformation::of(Action::Modify, reason);
        Self { transformation, reason, other: None, terms }
    }
}

named! {
    /// What brought the change about.
    Cause {
        /// The first deliberation: everything is new.
        Start = "start",
        /// What the instruments showed since the last decision.
        Discovery = "discovery",
        /// What the rover did or spent since the last decision.
        Execution = "execution",
        /// What the ground asked for.
        Command = "command",
    }
}

/// A number that was compared, and what with.
#[derive(Debug, Clone, PartialEq)]
pub struct Term {
    /// What the number is, with its unit.
    pub name: &'static str,
    /// The number.
    pub value: f64,
    /// What it was compared with, if anything.
    pub limit: Option<f64>,
}

impl Term {
    /// A number on its own.
    #[must_use]
    pub fn of(name: &'static str, value: f64) -> Self {
        Self { name, value, limit: None }
    }

    /// A number and its limit.
    #[must_use]
    pub fn against(name: &'static str, value: f64, limit: f64) -> Self {
        Self { name, value, limit: Some(limit) }
    }
}

/// What a deliberation says of one goal.
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict {
    /// The goal, as it stands after the deliberation.
    pub goal: Goal,
    /// What was done with it.
    pub action: Action,
    /// Why.
    pub reason: Reason,
    /// What brought it about.
    pub cause: Cause,
    /// Its turn in the sequence, from 0.
    pub turn: Option<usize>,
    /// The goal that the reason speaks of (merged into, explained by).
    pub other: Option<GoalId>,
    /// The numbers compared.
    pub terms: Vec<Term>,
    /// What changed about the goal itself, in order.
    pub changes: Vec<Change>,
}
