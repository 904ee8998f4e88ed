//! What is asked of a search, and what it answers.

use std::cmp::Ordering;

use wisdom_planner::TravelMatrix;

use crate::{Directive, Domain, Expansion, FactSet, GoalId, Policy, Preferences, ServiceCost};

/// The most goals one search takes.
pub const MAX_SEQUENCED: usize = 2500;

/// When work at a goal's site may begin, seconds from now. Who comes early waits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// Not before.
    pub open_s: f64,
    /// Not after.
    pub close_s: f64,
}

/// How a prize fades after a deadline, seconds from now: all of it until the first, nothing from the second, in
/// proportion between the two.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fade {
    /// Last moment at which the whole prize counts.
    pub full_until_s: f64,
    /// First moment at which nothing of it does.
    pub nothing_from_s: f64,
}

impl Fade {
    /// What is left of the prize, in [0, 1], of a goal that is done at this time.
    #[must_use]
    pub fn freshness(self, time_s: f64) -> f64 {
        let Self { full_until_s, nothing_from_s } = self;
        if time_s <= full_until_s || nothing_from_s == f64::INFINITY {
            1.0
        } else if time_s >= nothing_from_s {
            0.0
        } else {
            (nothing_from_s - time_s) / (nothing_from_s - full_until_s)
        }
    }
}

/// A goal as the search sees it.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// Its name.
    pub goal: GoalId,
    /// The directive it follows, by index.
    pub directive: usize,
    /// Its prize; quantised, where equal sets are to have equal sums.
    pub prize: f64,
    /// The poses from which it can be done: nodes of the travel matrix.
    pub poses: Vec<usize>,
    /// What it costs at this place besides its directive's operators.
    pub service: ServiceCost,
    /// When it may be begun, if not at any time.
    pub window: Option<Window>,
    /// How its prize fades, for [`Policy::Utility`].
    pub fade: Option<Fade>,
    /// Whether a sequence with it is better than any without it.
    pub mandatory: bool,
    /// Goals that must have been done before it in the same sequence.
    pub after: Vec<GoalId>,
    /// Goals that no sequence may hold beside it (either may name the other).
    pub excludes: Vec<GoalId>,
}

impl Candidate {
    /// A goal without conditions of its own.
    #[must_use]
    pub fn new(goal: GoalId, directive: usize, prize: f64, poses: Vec<usize>) -> Self {
        Self {
            goal,
            directive,
            prize,
            poses,
            service: ServiceCost::default(),
            window: None,
            fade: None,
            mandatory: false,
            after: Vec::new(),
            excludes: Vec::new(),
        }
    }
}

/// What is left to spend, and how unsafe a plan may be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Time left, seconds.
    pub time_s: f64,
    /// Energy left above the reserve, joules.
    pub energy_j: f64,
    /// Data volume left, megabytes.
    pub data_mb: f64,
    /// Least reliability of a whole plan, in [0, 1].
    pub min_reliability: f64,
}

/// Everything a search needs. Node 0 of the matrix is where the rover stands.
#[derive(Clone, Copy)]
pub struct Problem<'a> {
    /// The goals, at most [`MAX_SEQUENCED`].
    pub candidates: &'a [Candidate],
    /// Costs between poses.
    pub travel: &'a TravelMatrix,
    /// Where a plan may end, as nodes of the matrix: the last leg leads to one of them, within the limits. Empty: at its
    /// last goal.
    pub ends: &'a [usize],
    /// Facts and operators.
    pub domain: &'a Domain,
    /// The pool.
    pub directives: &'a [Directive],
    /// Facts that hold now.
    pub facts: FactSet,
    /// What is left.
    pub limits: Limits,
    /// Power drawn while waiting for a window to open, watts.
    pub waiting_w: f64,
    /// The objective.
    pub policy: Policy,
    /// What it is told besides the plan.
    pub preferences: Preferences,
}

/// One goal of a sequence, and how it is served.
#[derive(Debug, Clone, PartialEq)]
pub struct Stop {
    /// The goal.
    pub goal: GoalId,
    /// The pose, as a node of the travel matrix.
    pub pose: usize,
    /// Which alternative of the leg that leads there.
    pub alternative: usize,
    /// The operators before the drive and at the site.
    pub expansion: Expansion,
    /// Waiting for the goal's window to open, seconds.
    pub wait_s: f64,
    /// What is spent besides the drive: operators, waiting, and what the place costs.
    pub service: ServiceCost,
}

/// How a plan gets from its last goal to where it ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct End {
    /// One of [`Problem::ends`].
    pub pose: usize,
    /// Which alternative of the leg that leads there.
    pub alternative: usize,
}

/// An ordered set of goals with its numbers; those of the whole include the leg to the end, if there is one.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct GoalSequence {
    /// The stops in their order.
    pub stops: Vec<Stop>,
    /// The last leg; none where plans end at their last goal.
    pub end: Option<End>,
    /// How many mandatory goals it leaves out.
    pub missed: usize,
    /// Value under the mission's policy.
    pub value: f64,
    /// Sum of the prizes (exact).
    pub prize: f64,
    /// Sum of the prizes, each as far as it has not faded when its goal is done.
    pub fresh: f64,
    /// J1 of the sequence, whatever the policy.
    pub expected: f64,
    /// Chance that every leg succeeds.
    pub reliability: f64,
    /// Time of legs, services and waiting, seconds.
    pub time_s: f64,
    /// Energy of legs, services and waiting, joules.
    pub energy_j: f64,
    /// Data of the services, megabytes.
    pub data_mb: f64,
}

impl GoalSequence {
    /// Doing nothing.
    #[must_use]
    pub fn empty() -> Self {
        Self { reliability: 1.0, ..Self::default() }
    }

    /// The goals in their order.
    pub fn goals(&self) -> impl Iterator<Item = GoalId> + '_ {
        self.stops.iter().map(|s| s.goal)
    }

    /// Better first: fewer mandatory goals missed, then value, then reliability, then less time, then smaller ids.
    #[must_use]
    pub fn rank(&self, other: &Self) -> Ordering {
        self.missed
            .cmp(&other.missed)
            .then(other.value.total_cmp(&self.value))
            .then(other.reliability.total_cmp(&self.reliability))
            .then(self.time_s.total_cmp(&other.time_s))
            .then_with(|| self.goals().cmp(other.goals()))
    }
}

/// How good the best sequence is known to be, relative to the goals, poses and leg alternatives given, and
/// to the goals that had to come first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Proof {
    /// No sequence is better.
    Proven,
    /// The effort ended first; no sequence that misses no more mandatory goals than the one found has more than this value.
    Bound(f64),
}

/// What a search found.
#[derive(Debug, Clone, PartialEq)]
pub struct Sequences {
    /// The best sequence of each of the best sets met, best first; never empty (the last resort is to do
    /// nothing, also where the goals that had to come first cannot). The first carries the proof; the others
    /// were met on the way and are the best known orders of their sets, not proven ones.
    pub best: Vec<GoalSequence>,
    /// What is known of the first.
    pub proof: Proof,
    /// Labels expanded, goals inserted and spanning trees built.
    pub expansions: u64,
}

/// How much work, and what the search must respect.
#[derive(Clone, Copy)]
pub struct Effort<'a> {
    /// Expansions at most: labels expanded, goals inserted, and steps of the bound; as many again with the most reliable
    /// way of each leg alone, if legs have alternatives and the search was cut short.
    pub expansions: u64,
    /// How many different sets to keep.
    pub keep: usize,
    /// Goals that must come first, in this order (a commit window, or a whole order to be weighed).
    pub first: &'a [GoalId],
    /// For measurements: the share of the time allowed that has passed; the search ends at 1. What it finds then depends
    /// on the machine.
    pub clock: Option<&'a dyn Fn() -> f64>,
}
