//! Which sequence is committed to: the best, unless the one there is nearly as good.

use std::cmp::Ordering;

use super::ManagerSpec;
use crate::sequence::{Effort, GoalSequence, Problem, Sequences, sequences, weigh};
use crate::{GoalId, PlanFront, Proof, plan_front};

/// The sequence chosen and what it was chosen from.
#[derive(Debug, Clone, PartialEq)]
pub struct Selection {
    /// The family, best first; holds the chosen one.
    pub family: Vec<GoalSequence>,
    /// For each of the family, the plans of its order that none beats in time, energy and −ln R at once.
    pub fronts: Vec<PlanFront>,
    /// Index of the chosen sequence.
    pub chosen: usize,
    /// What is known of the best sequence.
    pub proof: Proof,
    /// Labels expanded.
    pub expansions: u64,
    /// The committed sequence weighed on today's map, if it can still be carried out.
    pub committed: Option<GoalSequence>,
    /// Whether the committed sequence was kept although another is better, but not by enough.
    pub held: bool,
    /// The goal of the leg under way, if the sequences had to begin with it.
    pub pinned: Option<GoalId>,
}

impl Selection {
    /// The chosen sequence.
    #[must_use]
    pub fn sequence(&self) -> &GoalSequence {
        &self.family[self.chosen]
    }
}

/// Ways kept after each goal of an order while its front is worked out.
const FRONT_LABELS: usize = 500;

/// The front of a sequence's order, and the best plan known for that order: a search that was cut short may have met a
/// worse one than the front holds.
fn with_front(problem: &Problem<'_>, sequence: GoalSequence) -> (GoalSequence, PlanFront) {
    let order: Vec<GoalId> = sequence.goals().collect();
    let front = plan_front(problem, &order, FRONT_LABELS);
    let best =
        front.plans.iter().min_by(|a, b| a.rank(b)).filter(|plan| plan.rank(&sequence).is_lt());
    (best.cloned().unwrap_or(sequence), front)
}

/// The same for a family, best first.
fn with_fronts(
    problem: &Problem<'_>,
    family: Vec<GoalSequence>,
) -> (Vec<GoalSequence>, Vec<PlanFront>) {
    let mut both: Vec<_> = family.into_iter().map(|s| with_front(problem, s)).collect();
    both.sort_by(|(a, _), (b, _)| a.rank(b));
    both.into_iter().unzip()
}

impl ManagerSpec {
    /// Chooses a sequence: the best, unless the committed one is nearly as good.
    ///
    /// `agenda` is the order committed to, `pinned` the goal of the leg under way (the commit window): it stays first if it can. The committed
    /// sequence without the goals that have ended is what a better one is held against.
    #[must_use]
    pub fn select(
        &self,
        problem: &Problem<'_>,
        agenda: &[GoalId],
        pinned: Option<GoalId>,
    ) -> Selection {
        let pin: Vec<GoalId> = pinned.into_iter().collect();
        let effort =
            Effort { expansions: self.expansions, keep: self.family, first: &pin, clock: None };
        let mut found = sequences(problem, effort);
        let pinned = pinned.filter(|_| !found.best[0].stops.is_empty());
        if pinned.is_none() && !pin.is_empty() {
            found = sequences(problem, Effort { first: &[], ..effort });
        }
        let Sequences { best, proof, expansions } = found;
        let (mut family, mut fronts) = with_fronts(problem, best);
        let known = |id: &GoalId| problem.candidates.iter().any(|c| c.goal == *id);
        let order: Vec<GoalId> = agenda.iter().copied().filter(known).collect();
        let keeps_pin = pinned.is_none_or(|pin| order.first() == Some(&pin));
        let committed = if order.is_empty() || !keeps_pin { None } else { weigh(problem, &order) };
        let committed = committed.map(|committed| with_front(problem, committed));
        let mut chosen = 0;
        let mut held = false;
        if let Some((committed, front)) = &committed {
            let best = &family[0];
            let least = self.hysteresis;
            let (gained, worth) = (best.value - committed.value, committed.value.abs());
            let better_value = gained > 0.0 && gained >= least * worth;
            let safer = best.value == committed.value
                && best.reliability >= (1.0 + least) * committed.reliability
                && best.reliability > committed.reliability;
            let same = best.goals().eq(committed.goals());
            // Mandatory goals come before any value.
            let better = match best.missed.cmp(&committed.missed) {
                Ordering::Less => true,
                Ordering::Equal => better_value || safer,
                Ordering::Greater => false,
            };
            if !same && !better {
                // A search cut short may not have met the committed sequence, and that may be the best.
                held = best.rank(committed).is_lt();
                let known = family.iter().position(|s| s.goals().eq(committed.goals()));
                chosen = known.unwrap_or_else(|| {
                    let turn = family.partition_point(|s| s.rank(committed).is_lt());
                    family.insert(turn, committed.clone());
                    fronts.insert(turn, front.clone());
                    turn
                });
            }
        }
        let committed = committed.map(|(committed, _)| committed);
        Selection { family, fronts, chosen, proof, expansions, committed, held, pinned }
    }
}
