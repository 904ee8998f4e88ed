//! The price in prize: how much more a goal would have to be worth.
//!
//! The value of the best sequence that holds a goal is a convex, rising function of its prize, that of the best without it
//! does not change. Newton's method from above therefore meets the least prize without passing it; where hysteresis,
//! ties or a search cut short make steps of their own, halving takes over.

use super::{Choice, Known, Price};
use crate::sequence::{Candidate, GoalSequence, weigh};
use crate::{GoalId, Problem, Proof, Selection};

/// The highest prize tried.
pub const MOST_PRIZE: f64 = 65_536.0;
/// Prizes lie on a ladder of this step, see [`quantised`](crate::quantised).
const STEP: f64 = 1.0 / 4_294_967_296.0;
/// Decisions before halving takes over.
const NEWTON: usize = 10;

/// What is asked of a goal's prize.
#[derive(Clone, Copy)]
pub struct PrizeQuestion<'q> {
    /// The goal.
    pub goal: GoalId,
    /// Its prize now.
    pub now: f64,
    /// The least prize at which it counts as a goal at all.
    pub least: f64,
    /// The candidates if its prize were this: a higher one may bring it into the shortlist, and another goal out of it.
    pub candidates: &'q (dyn Fn(f64) -> Vec<Candidate> + Sync),
}

impl PrizeQuestion<'_> {
    /// The prize after a change, on the ladder.
    #[must_use]
    pub fn prize(&self, change: f64) -> f64 {
        ((self.now + change) / STEP).floor() * STEP
    }
}

/// A decision at some prize.
struct Tried {
    prize: f64,
    candidates: Vec<Candidate>,
    selection: Selection,
    holds: bool,
}

impl Tried {
    fn is_proven(&self) -> bool {
        self.selection.proof == Proof::Proven
    }
}

fn holds(sequence: &GoalSequence, goal: GoalId) -> bool {
    sequence.goals().any(|id| id == goal)
}

impl Choice<'_> {
    /// How much higher a goal's prize must be; at most about `solves` decisions are taken anew.
    #[must_use]
    pub fn price_of_prize(&self, asked: &PrizeQuestion<'_>, solves: usize) -> Price {
        let bottom = self.at_prize(asked, asked.now);
        if bottom.holds {
            return Price::Least { change: 0.0, known: Known::Exactly };
        }
        let mut high = self.at_prize(asked, MOST_PRIZE);
        let mut proven = bottom.is_proven() && high.is_proven();
        let known = |proven| if proven { Known::Exactly } else { Known::Searched };
        if !high.holds {
            let choice = self.among(&high.candidates);
            return choice.barrier(asked.goal, None, &high.selection).price(known(proven));
        }
        let mut low = asked.now;
        for turn in 2..solves.max(3) {
            let change = high.prize - asked.now;
            let under = asked.prize(change * 0.99);
            if low >= under {
                return Price::Least { change, known: known(proven) };
            }
            let next = if turn < NEWTON {
                let root = self.root(asked, &bottom.selection, &high);
                // A root that is out already was rounded down, or is none.
                let root = root.map(|root| root.max(asked.prize((low - asked.now) * 1.005) + STEP));
                // Near the root only what lies 1 % below is left to be seen.
                root.filter(|root| *root < under).unwrap_or(under)
            } else {
                asked.prize(f64::midpoint(low - asked.now, change)).max(low + STEP).min(under)
            };
            // Below the least prize there is no goal, and nothing to decide.
            let next = if low < asked.least { next.max(asked.least.min(under)) } else { next };
            if next < asked.least {
                low = next;
                continue;
            }
            let tried = self.at_prize(asked, next);
            proven &= tried.is_proven();
            if tried.holds {
                high = tried;
            } else {
                low = next;
            }
        }
        Price::Unknown
    }

    fn at_prize(&self, asked: &PrizeQuestion<'_>, prize: f64) -> Tried {
        let candidates = (asked.candidates)(prize);
        let selection = self.among(&candidates).decide();
        let holds = prize >= asked.least && holds(selection.sequence(), asked.goal);
        Tried { prize, candidates, selection, holds }
    }

    /// The prize at which the sequence chosen at a higher one is worth just enough: as much as the best without the
    /// goal, and by the hysteresis more than the committed one.
    fn root(&self, asked: &PrizeQuestion<'_>, without: &Selection, high: &Tried) -> Option<f64> {
        let lacks = |sequence: &&GoalSequence| !holds(sequence, asked.goal);
        let best = without.family.first().filter(lacks).map(|best| best.value);
        let committed = without.committed.as_ref().filter(lacks).map(|c| {
            // The hysteresis is for a change of the committed sequence only.
            c.value + self.spec.hysteresis * c.value.abs()
        });
        let least = best.into_iter().chain(committed).max_by(f64::total_cmp)?;
        let order: Vec<GoalId> = high.selection.sequence().goals().collect();
        let value = high.selection.sequence().value;
        // The same order a little below: its value falls by the slope.
        let down = (high.prize - asked.now) / 2.0;
        let mut candidates = high.candidates.clone();
        for candidate in candidates.iter_mut().filter(|c| c.goal == asked.goal) {
            candidate.prize = high.prize - down;
        }
        let lower = weigh(&Problem { candidates: &candidates, ..self.problem }, &order)?;
        let slope = (value - lower.value) / down;
        if slope.is_nan() || slope <= 0.0 {
            return None;
        }
        let root = high.prize - (value - least) / slope;
        Some((root / STEP).ceil() * STEP)
    }
}
