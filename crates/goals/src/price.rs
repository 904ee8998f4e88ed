//! Price tags: what would have had to be otherwise for a goal to be in the chosen sequence.
//!
//! One lever at a time is moved: the energy or the time that is left, the floor on reliability, or the goal's own prize.
//! For each the decision is taken again, with the same candidates, committed order, hysteresis and pin, until the least
//! change is known that brings the goal in (the nearest counterfactual of Wachter, Mittelstadt and Russell 2018).

mod prize;
mod staircase;

use crate::sequence::{Candidate, Effort, GoalSequence, Limits, Problem, Proof, sequences};
use crate::{GoalId, ManagerSpec, Preferences, Reason, Selection, Term};

pub use prize::{MOST_PRIZE, PrizeQuestion};

/// A limit that can be loosened.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Lever {
    /// More energy, joules.
    Energy,
    /// More time, seconds.
    Time,
    /// A lower floor on the reliability of the plan; where the policy has a floor of its own (the confidence of
    /// [`crate::Policy::ChanceConstrained`]), that one too.
    Reliability,
}

impl Lever {
    /// Every lever.
    pub const ALL: [Self; 3] = [Self::Energy, Self::Time, Self::Reliability];

    /// Where it stands: the higher, the more is allowed.
    fn level(self, problem: &Problem<'_>) -> f64 {
        match self {
            Self::Energy => problem.limits.energy_j,
            Self::Time => problem.limits.time_s,
            Self::Reliability => -floor(problem),
        }
    }

    /// Where it forbids nothing.
    fn unlimited(self) -> f64 {
        match self {
            Self::Energy | Self::Time => f64::INFINITY,
            Self::Reliability => 0.0,
        }
    }

    /// The level that a sequence asks for.
    fn needs(self, sequence: &GoalSequence) -> f64 {
        match self {
            Self::Energy => sequence.energy_j,
            Self::Time => sequence.time_s,
            Self::Reliability => -sequence.reliability,
        }
    }

    fn set<'a>(self, problem: &Problem<'a>, level: f64) -> Problem<'a> {
        let Problem { mut limits, mut preferences, .. } = *problem;
        match self {
            Self::Energy => limits.energy_j = level,
            Self::Time => limits.time_s = level,
            Self::Reliability => {
                limits.min_reliability = limits.min_reliability.min(-level);
                preferences.confidence = preferences.confidence.min(-level);
            }
        }
        Problem { limits, preferences, ..*problem }
    }

    fn reason(self) -> Reason {
        match self {
            Self::Energy => Reason::Energy,
            Self::Time => Reason::Time,
            Self::Reliability => Reason::Risk,
        }
    }
}

/// The least reliability of a whole plan, the objective's own floor among it.
fn floor(problem: &Problem<'_>) -> f64 {
    problem.limits.min_reliability.max(problem.policy.objective().floor(&problem.preferences))
}

/// How far a price was searched for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Known {
    /// No smaller change does it: every decision between none and this one is known. (Of a prize: none that is smaller by
    /// more than 1 %, as a goal that is in stays in when its prize rises.)
    Exactly,
    /// A change that is smaller by 1 % does not do it, nor does any other that was tried; there are smaller ones that
    /// were not.
    Searched,
}

/// The price of a goal on one lever.
#[derive(Debug, Clone, PartialEq)]
pub enum Price {
    /// This change brings the goal in, and 1 % less does not.
    Least {
        /// The change: joules or seconds more, reliability less, prize more.
        change: f64,
        /// Whether a smaller one could.
        known: Known,
    },
    /// No change of this lever alone brings it in, however large.
    Nothing {
        /// What is in its way when the lever is as loose as can be.
        reason: Reason,
        /// The numbers compared.
        terms: Vec<Term>,
        /// Whether it is out at every setting of the lever, or at all that were tried.
        known: Known,
    },
    /// The effort ended before a price was found.
    Unknown,
}

impl Price {
    /// The change, if there is one that does it.
    #[must_use]
    pub fn change(&self) -> Option<f64> {
        match self {
            Self::Least { change, .. } => Some(*change),
            Self::Nothing { .. } | Self::Unknown => None,
        }
    }

    /// Ruled out by something that no lever moves.
    #[must_use]
    pub fn nothing(reason: Reason, terms: Vec<Term>) -> Self {
        Self::Nothing { reason, terms, known: Known::Exactly }
    }
}

/// What would bring a goal into the sequence, one lever at a time.
#[derive(Debug, Clone, PartialEq)]
pub struct PriceTag {
    /// The goal.
    pub goal: GoalId,
    /// Energy, joules more.
    pub energy_j: Price,
    /// Time, seconds more.
    pub time_s: Price,
    /// How much lower the floor on reliability.
    pub reliability: Price,
    /// How much higher its prize.
    pub prize: Price,
}

/// A decision that can be taken again under other limits and prizes.
#[derive(Clone, Copy)]
pub struct Choice<'a> {
    /// What was searched.
    pub problem: Problem<'a>,
    /// How the manager weighs.
    pub spec: &'a ManagerSpec,
    /// The order committed to before.
    pub agenda: &'a [GoalId],
    /// The goal of the leg under way.
    pub pinned: Option<GoalId>,
}

impl<'a> Choice<'a> {
    /// Decides, as [`ManagerSpec::select`] does.
    #[must_use]
    pub fn decide(&self) -> Selection {
        self.spec.select(&self.problem, self.agenda, self.pinned)
    }

    /// The same with a limit loosened: joules or seconds more, reliability less. An infinite change takes the limit away.
    #[must_use]
    pub fn loosened(&self, lever: Lever, change: f64) -> Self {
        let level = (lever.level(&self.problem) + change).min(lever.unlimited());
        self.at(lever, level)
    }

    /// The same with other candidates.
    #[must_use]
    pub fn among<'b>(&self, candidates: &'b [Candidate]) -> Choice<'b>
    where
        'a: 'b,
    {
        Choice { problem: Problem { candidates, ..self.problem }, ..*self }
    }

    /// The prices of some goals on one lever. They share their solves: a decision under a looser limit says of every goal
    /// whether it is in. At most `solves` of these are spent on all goals together, and 16 more on each.
    ///
    /// A looser limit may also bring a goal in and a still looser one take it out again, for better ones. The price is
    /// that of the first setting which holds the goal.
    #[must_use]
    pub fn prices(&self, lever: Lever, goals: &[GoalId], solves: usize) -> Vec<Price> {
        staircase::prices(self, lever, goals, solves)
    }

    /// The best sequence that holds a goal, whatever it is worth: none if there is none, or none was met.
    #[must_use]
    pub fn best_with(&self, goal: GoalId) -> Option<GoalSequence> {
        match self.with_goal(goal) {
            Forced::Possible(best) => Some(best),
            Forced::Impossible | Forced::NotMet => None,
        }
    }

    fn at(&self, lever: Lever, level: f64) -> Self {
        Self { problem: lever.set(&self.problem, level), ..*self }
    }

    /// The best sequence that holds a goal; no other one is mandatory.
    fn with_goal(&self, goal: GoalId) -> Forced {
        let forced: Vec<Candidate> = self
            .problem
            .candidates
            .iter()
            .map(|c| Candidate { mandatory: c.goal == goal, ..c.clone() })
            .collect();
        let problem = Problem { candidates: &forced, ..self.problem };
        let pin: Vec<GoalId> = self.pinned.into_iter().collect();
        let effort = Effort { expansions: self.spec.expansions, keep: 1, first: &pin, clock: None };
        let mut found = sequences(&problem, effort);
        if !pin.is_empty() && found.best[0].stops.is_empty() {
            found = sequences(&problem, Effort { first: &[], ..effort });
        }
        let best = found.best.swap_remove(0);
        if best.goals().any(|id| id == goal) {
            Forced::Possible(best)
        } else if found.proof == Proof::Proven {
            Forced::Impossible
        } else {
            Forced::NotMet
        }
    }

    /// What keeps a goal out of a decision taken at the loosest setting of a lever (none: of its prize).
    fn barrier(&self, goal: GoalId, lever: Option<Lever>, selection: &Selection) -> Barrier {
        let Some(candidate) = self.problem.candidates.iter().find(|c| c.goal == goal) else {
            return Barrier::told(Reason::BeyondExact, vec![]);
        };
        if candidate.poses.is_empty() {
            return Barrier::told(Reason::Unreachable, vec![Term::against("poses", 0.0, 1.0)]);
        }
        let best = match self.with_goal(goal) {
            Forced::Impossible => return self.binding(goal, lever),
            Forced::NotMet => {
                return Barrier { sure: false, ..Barrier::told(Reason::SearchCut, vec![]) };
            }
            Forced::Possible(best) => best,
        };
        let chosen = selection.sequence();
        let excluded = |id: GoalId| {
            let other = self.problem.candidates.iter().find(|c| c.goal == id);
            candidate.excludes.contains(&id) || other.is_some_and(|o| o.excludes.contains(&goal))
        };
        let value = |reason, least| {
            Barrier::told(reason, vec![Term::against("value with it", best.value, least)])
        };
        if chosen.goals().any(excluded) {
            value(Reason::Excluded, chosen.value)
        } else if selection.held && best.value > chosen.value {
            value(Reason::Held, chosen.value + self.spec.hysteresis * chosen.value.abs())
        } else {
            value(Reason::Outweighed, chosen.value)
        }
    }

    /// The limits that a goal breaks in any sequence, beside a lever that is loose already.
    fn binding(&self, goal: GoalId, lever: Option<Lever>) -> Barrier {
        let free = Limits {
            time_s: f64::INFINITY,
            energy_j: f64::INFINITY,
            data_mb: f64::INFINITY,
            min_reliability: 0.0,
        };
        let none = Preferences { confidence: 0.0, ..self.problem.preferences };
        let possible = |limits, preferences| {
            let problem = Problem { limits, preferences, ..self.problem };
            matches!(Self { problem, ..*self }.with_goal(goal), Forced::Possible(_))
        };
        if !possible(free, none) {
            return Barrier::told(Reason::Preconditions, vec![]);
        }
        let Problem { limits, preferences, .. } = self.problem;
        let keeping = [
            (Reason::Time, "time_s", limits.time_s, Limits { time_s: limits.time_s, ..free }, none),
            (
                Reason::Energy,
                "energy_j",
                limits.energy_j,
                Limits { energy_j: limits.energy_j, ..free },
                none,
            ),
            (
                Reason::Data,
                "data_mb",
                limits.data_mb,
                Limits { data_mb: limits.data_mb, ..free },
                none,
            ),
            (
                Reason::Risk,
                "reliability",
                floor(&self.problem),
                Limits { min_reliability: limits.min_reliability, ..free },
                preferences,
            ),
        ];
        let loose = lever.map(Lever::reason);
        let told = |term: &(Reason, &'static str, f64, Limits, Preferences)| {
            (term.0, Term::of(term.1, term.2))
        };
        let binds = keeping.iter().find(|l| Some(l.0) != loose && !possible(l.3, l.4));
        if let Some(limit) = binds {
            let (reason, term) = told(limit);
            return Barrier::told(reason, vec![term]);
        }
        // Each alone could be kept: all are named.
        let finite = keeping.iter().filter(|l| Some(l.0) != loose && l.2.is_finite());
        let (reasons, terms): (Vec<_>, Vec<_>) = finite.map(told).unzip();
        Barrier::told(reasons.first().copied().unwrap_or(Reason::Preconditions), terms)
    }
}

/// A sequence that was made to hold a goal.
enum Forced {
    Possible(GoalSequence),
    Impossible,
    /// The search ended before it met one.
    NotMet,
}

/// What keeps a goal out.
struct Barrier {
    reason: Reason,
    terms: Vec<Term>,
    /// Whether the search for it ended by itself.
    sure: bool,
}

impl Barrier {
    fn told(reason: Reason, terms: Vec<Term>) -> Self {
        Self { reason, terms, sure: true }
    }

    fn price(self, known: Known) -> Price {
        let known = if self.sure { known } else { Known::Searched };
        Price::Nothing { reason: self.reason, terms: self.terms, known }
    }
}

/// The price tag of one candidate of a decision; at most `solves` decisions are taken anew for each lever, and 16 more.
#[must_use]
pub fn price_tag(choice: &Choice<'_>, goal: GoalId, solves: usize) -> PriceTag {
    let on = |lever| choice.prices(lever, &[goal], solves).swap_remove(0);
    let prize = choice.problem.candidates.iter().find(|c| c.goal == goal).map(|c| c.prize);
    let prized = |prize: f64| {
        let mut candidates = choice.problem.candidates.to_vec();
        for candidate in candidates.iter_mut().filter(|c| c.goal == goal) {
            candidate.prize = prize;
        }
        candidates
    };
    let now = prize.unwrap_or(0.0);
    let question = PrizeQuestion { goal, now, least: now, candidates: &prized };
    PriceTag {
        goal,
        energy_j: on(Lever::Energy),
        time_s: on(Lever::Time),
        reliability: on(Lever::Reliability),
        prize: choice.price_of_prize(&question, solves),
    }
}
