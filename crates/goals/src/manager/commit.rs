//! Second half of a deliberation: the chosen sequence is committed to, and of every goal is said what was done.

use std::collections::BTreeSet;

use wisdom_grid::Cell;

use super::why::Tried;
use super::{Deliberated, GoalManager, Poses, Revision, Selection, Shortlist};
use crate::lifecycle::{Committed, Diary, Expanded, Formulated, Found, Outcome, Selected};
use crate::sequence::Problem;
use crate::{Action, Cause, Goal, GoalId, Reason, Stop, Term, Transformation, Verdict};

/// What was weighed, and the sequence chosen from it.
#[derive(Clone, Copy)]
pub struct Weighed<'a> {
    /// The choice.
    pub selection: &'a Selection,
    /// Which goals were sequenced.
    pub shortlist: &'a Shortlist,
    /// Poses of every open goal.
    pub poses: &'a Poses,
    /// What the search was asked.
    pub problem: Problem<'a>,
    /// Cells of the travel matrix's nodes.
    pub nodes: &'a [Cell],
    /// Distance between cells, metres.
    pub spacing_m: f64,
    /// Whether any reading changed since the last decision.
    pub map_changed: bool,
}

impl GoalManager {
    /// Second half of a deliberation: commits to the chosen sequence and says of every goal what was done.
    ///
    /// # Panics
    /// If the sequence holds a goal that is not open, or a pose that is no node: what was weighed is not this manager's.
    pub fn commit(&mut self, mut revision: Revision, weighed: Weighed<'_>) -> Deliberated {
        let sequence = weighed.selection.sequence();
        let order: Vec<GoalId> = sequence.goals().collect();
        let steady = common_order(&self.state.agenda, &order);
        let entrant = self.best_entrant(&order);
        let mut tried = Tried::new(&weighed.problem);
        let mut verdicts = std::mem::take(&mut revision.ended);
        let open: Vec<GoalId> = self.state.goals.keys().copied().collect();
        for id in open {
            let turn = order.iter().position(|o| *o == id);
            let was_committed = self.state.agenda.contains(&id);
            let changes = revision.changes.remove(&id).unwrap_or_default();
            let born = revision.born.contains(&id);
            let goal = &self.state.goals[&id];
            let numbers =
                || vec![Term::of("interest", goal.interest), Term::of("prize", goal.prize)];
            // That a goal is new is no change of it; that a command wants one that was there is.
            let changed =
                changes.iter().find(|c| !born || c.transformation != Transformation::Formulation);
            let mut other = None;
            let (action, reason, terms) = if turn.is_some() {
                if !was_committed {
                    let first = changes.first().filter(|_| born);
                    other = first.and_then(|change| change.other);
                    (Action::Add, first.map_or(Reason::Promoted, |c| c.reason), numbers())
                } else if let Some(change) = changed {
                    (Action::Modify, change.reason, change.terms.clone())
                } else if steady.contains(&id) {
                    (Action::Keep, Reason::Unchanged, numbers())
                } else {
                    (Action::Reorder, Reason::BetterOrder, numbers())
                }
            } else if let Some(&near) =
                order.iter().find(|&&o| self.exclude(id, o, weighed.spacing_m))
            {
                let theirs = self.state.goals[&near].prize;
                other = Some(near);
                let terms = vec![Term::against("prize", goal.prize, theirs)];
                (Action::Defer, Reason::Excluded, terms)
            } else {
                let refusal = self.why_not(goal, &weighed, &mut tried);
                // What it would have been worth, or the limit that the others leave it no room under.
                let crowded_out = !refusal.alone;
                match entrant.filter(|_| was_committed && crowded_out) {
                    Some(by) => {
                        other = Some(by);
                        (Action::Defer, Reason::Superseded, refusal.terms)
                    }
                    None => (Action::Defer, refusal.reason, refusal.terms),
                }
            };
            let commanded = |reason| matches!(reason, Reason::Commanded | Reason::Withdrawn);
            let cause = if self.state.decision == 0 {
                Cause::Start
            } else if commanded(reason) || changes.iter().any(|c| commanded(c.reason)) {
                Cause::Command
            } else if weighed.map_changed && reason != Reason::Eroded {
                Cause::Discovery
            } else {
                Cause::Execution
            };
            let stop = turn.map(|turn| &sequence.stops[turn]);
            let failed = revision.failed.contains(&id);
            let goal = self.state.goals.get_mut(&id).expect("the goal is open");
            let step = Step { stop, nodes: weighed.nodes, action, reason, failed };
            step.live(goal, revision.diaries.entry(id).or_insert_with(|| Diary::new(id)));
            let goal = goal.clone();
            verdicts.push(Verdict { goal, action, reason, cause, turn, other, terms, changes });
        }
        verdicts.sort_by_key(|v| v.goal.id);
        self.state.agenda = order;
        self.state.decision += 1;
        let transitions =
            revision.diaries.into_values().flat_map(|diary| diary.transitions).collect();
        Deliberated { verdicts, transitions }
    }

    /// Of the goals that come into the sequence the one of the highest prize, by which another may have been displaced.
    fn best_entrant(&self, order: &[GoalId]) -> Option<GoalId> {
        let new = order.iter().filter(|id| !self.state.agenda.contains(id));
        let prize = |id: &GoalId| self.state.goals[id].prize;
        new.copied().max_by(|a, b| prize(a).total_cmp(&prize(b)).then(b.cmp(a)))
    }
}

/// What a goal goes through as a sequence is committed to.
struct Step<'a> {
    /// Its stop, if it is in the sequence.
    stop: Option<&'a Stop>,
    nodes: &'a [Cell],
    action: Action,
    reason: Reason,
    /// Whether its last try failed.
    failed: bool,
}

impl Step<'_> {
    /// Moves the goal on in its life, and tells it where to stand and what to do.
    fn live(&self, goal: &mut Goal, diary: &mut Diary) {
        let Self { reason, .. } = *self;
        let Some(stop) = self.stop else {
            goal.life = match goal.life.found() {
                Found::Committed(at) => at.then::<Formulated>(reason, diary).life(),
                Found::Evaluated(at) => {
                    at.judged::<Formulated>(Outcome::Defer, reason, diary).life()
                }
                _ => goal.life,
            };
            (goal.pose, goal.operators) = (None, Vec::new());
            return;
        };
        let pose = self.nodes[stop.pose];
        let expansion = &stop.expansion;
        let operators: Vec<usize> =
            expansion.before.iter().chain(&expansion.after).copied().collect();
        let other_operators = operators != goal.operators;
        let of_new_directive = matches!(
            reason,
            Reason::Eroded
                | Reason::Afforded
                | Reason::Fault
                | Reason::Retyped
                | Reason::Refined
                | Reason::Concretised
                | Reason::Abstracted
        );
        goal.life = match goal.life.found() {
            Found::Formulated(at) => {
                let at = at.then::<Selected>(reason, diary).then::<Expanded>(reason, diary);
                at.then::<Committed>(reason, diary).life()
            }
            Found::Committed(at) if other_operators => {
                at.then::<Expanded>(reason, diary).then::<Committed>(reason, diary).life()
            }
            Found::Evaluated(at) if of_new_directive => {
                let at = at.judged::<Formulated>(Outcome::Reformulate, reason, diary);
                let at = at.then::<Selected>(reason, diary).then::<Expanded>(reason, diary);
                at.then::<Committed>(reason, diary).life()
            }
            Found::Evaluated(at) if other_operators => {
                let at = at.judged::<Expanded>(Outcome::ReExpand, reason, diary);
                at.then::<Committed>(reason, diary).life()
            }
            Found::Evaluated(at) => {
                let outcome = if self.failed {
                    Outcome::Repair
                } else if self.action == Action::Keep && goal.pose == Some(pose) {
                    Outcome::Continue
                } else {
                    Outcome::Adjust
                };
                at.judged::<Committed>(outcome, reason, diary).life()
            }
            _ => goal.life,
        };
        (goal.pose, goal.operators) = (Some(pose), operators);
    }
}

/// The goals of the longest subsequence common to two orders: those whose turn did not change among the
/// others that stayed.
fn common_order(old: &[GoalId], new: &[GoalId]) -> BTreeSet<GoalId> {
    let mut length = vec![vec![0usize; new.len() + 1]; old.len() + 1];
    for (i, a) in old.iter().enumerate().rev() {
        for (j, b) in new.iter().enumerate().rev() {
            length[i][j] = if a == b {
                length[i + 1][j + 1] + 1
            } else {
                length[i + 1][j].max(length[i][j + 1])
            };
        }
    }
    let (mut i, mut j, mut common) = (0, 0, BTreeSet::new());
    while i < old.len() && j < new.len() {
        if old[i] == new[j] {
            common.insert(old[i]);
            (i, j) = (i + 1, j + 1);
        } else if length[i + 1][j] >= length[i][j + 1] {
            i += 1;
        } else {
            j += 1;
        }
    }
    common
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_order_common_to_two_sequences_is_the_longest() {
        let ids = |list: &[u32]| list.iter().map(|&i| GoalId(i)).collect::<Vec<_>>();
        let common = common_order(&ids(&[1, 2, 3, 4]), &ids(&[2, 3, 1, 4]));
        assert_eq!(common, ids(&[2, 3, 4]).into_iter().collect());
        assert!(common_order(&ids(&[1]), &ids(&[2])).is_empty());
    }
}
