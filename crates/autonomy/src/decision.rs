//! What goes out of the core: a decision with everything it was made of.

use std::fmt;

use wisdom_goals::{
    FactSet, GoalId, GoalSequence, ManagerState, Proof, Shortlist, Site, Transition, Verdict,
};
use wisdom_grid::Cell;
use wisdom_planner::{CostVector, Plan, Route};

use crate::{Pose, Spent};

/// BLAKE3 of the exact bits of something too large for a decision record.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Digest(pub [u8; 32]);

impl fmt::Display for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0[..8].iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

impl fmt::Debug for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Digest({self})")
    }
}

/// Why a decision was due.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Trigger {
    /// The mission begins.
    Start,
    /// A goal was achieved.
    GoalEnded(GoalId),
    /// A leg failed.
    LegFailed(GoalId),
    /// The prize at a committed goal changed.
    InterestChanged {
        /// The goal.
        goal: GoalId,
        /// Prize when it was last weighed.
        before: f64,
        /// Prize now.
        after: f64,
    },
    /// A maximum appeared that no known goal explains.
    NewCandidate {
        /// Its peak.
        cell: Cell,
        /// Its prize.
        prize: f64,
    },
    /// The leg under way costs more or less than planned.
    BudgetDrift {
        /// Share of the leg's planned energy by which the actual one is off, signed.
        share: f64,
    },
    /// What remains of the leg fell below the reliability floor.
    Risk {
        /// Reliability of the rest of the leg on today's map.
        reliability: f64,
        /// The floor.
        floor: f64,
    },
    /// The prize changed on the way ahead.
    CorridorChanged {
        /// Where it changed most.
        cell: Cell,
        /// Prize at the last decision.
        before: f64,
        /// Prize now.
        after: f64,
    },
    /// The window of a committed goal closes soon.
    WindowClosing {
        /// The goal.
        goal: GoalId,
        /// Time left, seconds.
        left_s: f64,
    },
    /// The experts contradict each other at the target of a committed goal.
    Conflict {
        /// The goal.
        goal: GoalId,
        /// Contradiction when it was last weighed.
        before: f64,
        /// Contradiction now.
        after: f64,
    },
    /// The ground asked for something.
    Command {
        /// Number of the message.
        number: u32,
    },
    /// Facts changed that no operator changed.
    Facts {
        /// Number of the message.
        number: u32,
    },
    /// The time between two decisions has passed.
    Cadence {
        /// Time since the last one, seconds.
        since_s: f64,
    },
    /// There was no decision for longer than there should be.
    Watchdog {
        /// Time since the last one, seconds.
        since_s: f64,
    },
    /// The leg ended before its goal was done, and nothing else asks: the budget is spent.
    LegInterrupted(GoalId),
    /// A wait ended: a decision was asked for, and nothing else calls for one.
    Woken,
    /// Newly seen ground blocks the route under way.
    RouteBlocked(Cell),
    /// A look from a vantage was taken, or home was reached.
    Arrived,
    /// The drive to a vantage or home ended on the way.
    Stopped,
}

impl Trigger {
    /// Whether it calls for a decision at once whatever the pace: a step has ended, the way ahead is not safe, or it is
    /// time.
    #[must_use]
    pub fn is_urgent(&self) -> bool {
        match self {
            Self::Start
            | Self::GoalEnded(_)
            | Self::LegFailed(_)
            | Self::Risk { .. }
            | Self::LegInterrupted(_)
            | Self::Woken
            | Self::RouteBlocked(_)
            | Self::Arrived
            | Self::Stopped
            | Self::Cadence { .. }
            | Self::Watchdog { .. } => true,
            Self::InterestChanged { .. }
            | Self::NewCandidate { .. }
            | Self::BudgetDrift { .. }
            | Self::CorridorChanged { .. }
            | Self::WindowClosing { .. }
            | Self::Conflict { .. }
            | Self::Command { .. }
            | Self::Facts { .. } => false,
        }
    }

    /// The trigger's short name.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Start => "start",
            Self::GoalEnded(_) => "goal-ended",
            Self::LegFailed(_) => "leg-failed",
            Self::InterestChanged { .. } => "interest-changed",
            Self::NewCandidate { .. } => "new-candidate",
            Self::BudgetDrift { .. } => "budget-drift",
            Self::Risk { .. } => "risk",
            Self::CorridorChanged { .. } => "corridor-changed",
            Self::WindowClosing { .. } => "window-closing",
            Self::Conflict { .. } => "conflict",
            Self::Command { .. } => "command",
            Self::Facts { .. } => "facts",
            Self::Cadence { .. } => "cadence",
            Self::Watchdog { .. } => "watchdog",
            Self::LegInterrupted(_) => "leg-interrupted",
            Self::Woken => "woken",
            Self::RouteBlocked(_) => "route-blocked",
            Self::Arrived => "arrived",
            Self::Stopped => "stopped",
        }
    }
}

impl fmt::Display for Trigger {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Start | Self::Woken | Self::Arrived | Self::Stopped => f.write_str(self.name()),
            Self::GoalEnded(goal) | Self::LegFailed(goal) | Self::LegInterrupted(goal) => {
                write!(f, "{} ({goal})", self.name())
            }
            Self::InterestChanged { goal, before, after }
            | Self::Conflict { goal, before, after } => {
                write!(f, "{} ({goal}: {before:.3} -> {after:.3})", self.name())
            }
            Self::NewCandidate { cell, prize } => {
                write!(f, "{} ({cell}, prize {prize:.3})", self.name())
            }
            Self::BudgetDrift { share } => write!(f, "{} ({:+.0} %)", self.name(), share * 100.0),
            Self::Risk { reliability, floor } => {
                write!(f, "{} ({reliability:.3} < {floor:.3})", self.name())
            }
            Self::CorridorChanged { cell, before, after } => {
                write!(f, "{} ({cell}: {before:.3} -> {after:.3})", self.name())
            }
            Self::WindowClosing { goal, left_s } => {
                write!(f, "{} ({goal}: {left_s:.0} s left)", self.name())
            }
            Self::Command { number } | Self::Facts { number } => {
                write!(f, "{} (message {number})", self.name())
            }
            Self::Cadence { since_s } | Self::Watchdog { since_s } => {
                write!(f, "{} ({since_s:.0} s)", self.name())
            }
            Self::RouteBlocked(cell) => write!(f, "{} {cell}", self.name()),
        }
    }
}

/// What the rover is to do next. Never nothing: to wait is an act with a wake condition.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Act {
    /// Carry out the first leg of the chosen plan and its goal's operators.
    Pursue(GoalId),
    /// Drive to a vantage and look where ignorance is largest.
    Look {
        /// The way there.
        route: Route,
        /// Ignorance in range of the vantage, in cells' worth.
        ignorance: f64,
    },
    /// Drive home.
    Home {
        /// The way there.
        route: Route,
    },
    /// Wait in a safe state.
    Wait {
        /// What would end the wait.
        wake: Wake,
    },
}

/// What ends a wait.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Wake {
    /// Word from outside: a command, or a reading handed in.
    Word,
    /// Mission time, seconds: a goal's window opens; or word from outside before that.
    Time(f64),
}

impl fmt::Display for Wake {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Word => f.write_str("a new command, or a budget for another day"),
            Self::Time(time_s) => write!(f, "mission time {time_s:.0} s, when a window opens"),
        }
    }
}

impl Act {
    /// The act's short name.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Pursue(_) => "pursue",
            Self::Look { .. } => "look",
            Self::Home { .. } => "home",
            Self::Wait { .. } => "wait",
        }
    }
}

/// All objectives of one sequence, whatever the policy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Objectives {
    /// J1: Σ prize · reliability so far.
    pub expected_interest: f64,
    /// Σ prize.
    pub most_interesting: f64,
    /// J2: Σ prize · reliability of the whole.
    pub all_or_nothing: f64,
    /// CC: Σ prize if the reliability reaches the floor and the confidence asked for, else 0.
    pub chance_constrained: f64,
    /// NET: Σ prize − λ·(−ln R) − μ·energy.
    pub net_benefit: f64,
    /// UTIL: Σ prize · freshness − Σ price · resource.
    pub utility: f64,
}

/// One member of the plan family.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanOption {
    /// The goals in their order, with operators.
    pub sequence: GoalSequence,
    /// The legs that serve them.
    pub plan: Plan,
    /// What it is worth.
    pub objectives: Objectives,
    /// The front that it is one of.
    pub front: FrontOf,
}

/// The plans for one order of goals that no other one matches or beats in time, energy and −ln R at once.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FrontOf {
    /// The member of the family that is best for this order by the mission's policy; its own index if it is that one.
    pub best: usize,
    /// Plans on the front, of the poses and leg alternatives there are; the family holds some of them, spread evenly
    /// from the most to the least reliable, where they are more than [`crate::RouteSpec::front`].
    pub plans: usize,
    /// Whether these are all; if not, more ways were met than were kept.
    pub complete: bool,
}

/// Digests of the maps a decision was made from, stage by stage.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Digests {
    /// The measured layers as the rover knows them.
    pub frame: Digest,
    /// The layers derived from them.
    pub derived: Digest,
    /// The experts' masses.
    pub masses: Digest,
    /// The fused map.
    pub fusion: Digest,
    /// Traversability.
    pub ground: Digest,
    /// The travel matrix: every cost of every leg.
    pub travel: Digest,
}

/// What the rover was when it decided.
#[derive(Debug, Clone, PartialEq)]
pub struct RoverState {
    /// Where it stood.
    pub pose: Pose,
    /// What it had spent.
    pub spent: Spent,
    /// The facts that held.
    pub facts: FactSet,
    /// The goal of the leg under way, if any (the commit window).
    pub underway: Option<GoalId>,
    /// Looks taken since there was last a goal to pursue.
    pub idle_looks: u32,
    /// The goal manager's memory before the decision.
    pub manager: ManagerState,
}

/// A moment at which a decision was taken: all it depends on besides the spec and the readings.
#[derive(Debug, Clone, PartialEq)]
pub struct Moment {
    /// Number of the decision, from 0.
    pub number: u32,
    /// Why it was due.
    pub triggers: Vec<Trigger>,
    /// What the rover was.
    pub state: RoverState,
    /// Whether any reading changed since the decision before.
    pub map_changed: bool,
}

/// A decision: what was known, what was weighed, what was chosen and why.
#[derive(Debug, Clone, PartialEq)]
pub struct Decision {
    /// Number of the decision, from 0.
    pub number: u32,
    /// Why it was due.
    pub triggers: Vec<Trigger>,
    /// What the rover was.
    pub state: RoverState,
    /// The maps it was made from.
    pub digests: Digests,
    /// Whether any reading changed since the last decision.
    pub map_changed: bool,
    /// Median interest over seen ground.
    pub background: f64,
    /// Share of the working map of which anything is known.
    pub seen: f64,
    /// Maxima of the prize map.
    pub sites: Vec<Site>,
    /// Maxima of the promise map, if a directive asks for them.
    pub promises: Vec<Site>,
    /// Maxima of the contradiction map, likewise.
    pub disputes: Vec<Site>,
    /// What was said of every known goal.
    pub verdicts: Vec<Verdict>,
    /// Every step in a goal's life that was taken.
    pub transitions: Vec<Transition>,
    /// How often the map had changed when it was made.
    pub map_version: u64,
    /// Which goals were sequenced exactly.
    pub shortlist: Shortlist,
    /// The family of plans: the best of each set of goals, best first, then the others of their fronts.
    pub family: Vec<PlanOption>,
    /// Index of the plan chosen.
    pub chosen: usize,
    /// What is known of the best sequence.
    pub proof: Proof,
    /// Labels expanded by the search.
    pub expansions: u64,
    /// Value of the committed sequence on today's map, if it can still be carried out.
    pub committed_value: Option<f64>,
    /// Whether the committed sequence was kept although another is better, but not by enough.
    pub held: bool,
    /// What to do now.
    pub act: Act,
    /// Expected cost of the act's drive.
    pub act_cost: CostVector,
    /// The goal manager's memory after the decision.
    pub manager_after: ManagerState,
}

impl Decision {
    /// The chosen plan.
    #[must_use]
    pub fn plan(&self) -> &PlanOption {
        &self.family[self.chosen]
    }
}
