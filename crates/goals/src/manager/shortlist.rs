//! Which goals are sequenced, and what the search is told of them.

use std::collections::BTreeMap;

use super::why::bound;
use super::{GoalManager, Poses, Shortlist};
use crate::sequence::{Candidate, MAX_SEQUENCED, Window};
use crate::{Fade, Goal, GoalId};

impl GoalManager {
    /// The goals to be sequenced: mandatory ones, committed ones, then those of highest bound; of goals that no sequence may hold
    /// together the better one, and the others only if there is room for them. Cells are `spacing_m` metres apart.
    #[must_use]
    pub fn shortlist(&self, poses: &Poses, spacing_m: f64) -> Shortlist {
        let mut bounds: Vec<(GoalId, f64)> = self
            .state
            .goals
            .values()
            .filter_map(|goal| Some((goal.id, bound(goal, poses)?)))
            .collect();
        let committed = |id: &GoalId| self.state.agenda.contains(id);
        let mandatory = |id: &GoalId| self.is_mandatory(&self.state.goals[id]);
        let first = |id: &GoalId| (mandatory(id), committed(id));
        bounds.sort_by(|a, b| {
            first(&b.0).cmp(&first(&a.0)).then(b.1.total_cmp(&a.1)).then(a.0.cmp(&b.0))
        });
        let mut kept: Vec<(GoalId, f64)> = Vec::new();
        let mut beside: Vec<(GoalId, f64)> = Vec::new();
        for (id, bound) in bounds {
            let near = kept.iter().any(|&(other, _)| self.exclude(id, other, spacing_m));
            if near && !committed(&id) { &mut beside } else { &mut kept }.push((id, bound));
        }
        kept.append(&mut beside);
        let most = self.spec.max_sequenced.min(MAX_SEQUENCED);
        let left_out = kept.split_off(kept.len().min(most));
        Shortlist { kept: kept.into_iter().map(|(id, _)| id).collect(), left_out }
    }

    fn is_mandatory(&self, goal: &Goal) -> bool {
        self.directives[goal.directive].mandatory
            || goal.order.as_ref().is_some_and(|o| o.mandatory)
    }

    /// Whether doing one of two goals would close the ground around it to the other.
    pub(super) fn exclude(&self, one: GoalId, other: GoalId, spacing_m: f64) -> bool {
        let (a, b) = (&self.state.goals[&one], &self.state.goals[&other]);
        let distance_m = a.target.distance(b.target) * spacing_m;
        let closes = |a: &Goal, b: &Goal| {
            let (done, kept) = (&self.directives[a.directive], &self.directives[b.directive]);
            done.kind.closes(kept.kind) && distance_m <= done.exclusion_radius_m
        };
        // The ground knows what it wants side by side.
        let both_ordered = a.order.is_some() && b.order.is_some();
        one != other && !both_ordered && (closes(a, b) || closes(b, a))
    }

    /// The shortlisted goals as the search wants them; `nodes` gives the matrix nodes of each goal's poses, `spent_s` how
    /// long the mission has lasted.
    ///
    /// Two goals of which one will close the ground around it (its directive's exclusion radius) to the other do not
    /// stand in one sequence.
    #[must_use]
    pub fn candidates(
        &self,
        shortlist: &Shortlist,
        nodes: &BTreeMap<GoalId, Vec<usize>>,
        spacing_m: f64,
        spent_s: f64,
    ) -> Vec<Candidate> {
        shortlist
            .kept
            .iter()
            .map(|id| {
                let goal = &self.state.goals[id];
                let poses = nodes.get(id).cloned().unwrap_or_default();
                let near = |other: &&GoalId| self.exclude(*id, **other, spacing_m);
                let directive = &self.directives[goal.directive];
                let fade = directive.fade.map(|fade| Fade {
                    full_until_s: fade.full_until_s - spent_s,
                    nothing_from_s: fade.nothing_from_s - spent_s,
                });
                Candidate {
                    mandatory: self.is_mandatory(goal),
                    window: directive.window.map(|window| Window {
                        open_s: window.open_s - spent_s,
                        close_s: window.close_s - spent_s,
                    }),
                    fade,
                    excludes: shortlist.kept.iter().filter(near).copied().collect(),
                    ..Candidate::new(*id, goal.directive, goal.prize, poses)
                }
            })
            .collect()
    }
}
