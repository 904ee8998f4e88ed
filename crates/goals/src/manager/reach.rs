//! What becomes of committed goals that the rover can no longer get to.

use super::revise::{Ending, extent};
use super::{Access, GROUND_UNSEEN, GoalManager, Poses, Retired, Revision, Survey};
use crate::prize::quantised;
use crate::{Change, GoalId, Kind, Reason, Term};
use wisdom_grid::Cell;

impl GoalManager {
    /// Looks after committed goals whose poses went: another pose may serve, or another place of their kind; those that
    /// nothing serves any more are given up. The others stay known: the map may open.
    pub fn keep_in_reach(
        &mut self,
        poses: &mut Poses,
        access: Access<'_>,
        survey: &Survey<'_>,
        revision: &mut Revision,
    ) {
        while self.give_up_unreachable(poses, access, survey, revision) {
            // A place that was given up closes the ground around it, and may set a maximum free.
            self.see(survey, revision);
            *poses = self
                .state
                .goals
                .values()
                .map(|goal| (goal.id, (access.poses)(goal.target, goal.directive)))
                .collect();
        }
    }

    /// Says whether a goal was given up.
    fn give_up_unreachable(
        &mut self,
        poses: &mut Poses,
        access: Access<'_>,
        survey: &Survey<'_>,
        revision: &mut Revision,
    ) -> bool {
        let ended = revision.ended.len();
        let committed: Vec<GoalId> =
            self.state.goals.values().filter(|g| g.status().is_committed()).map(|g| g.id).collect();
        for id in committed {
            let Some(goal) = self.state.goals.get_mut(&id) else { continue };
            let offered = poses.get(&id).map_or(0, Vec::len);
            let lost =
                goal.pose.is_some_and(|pose| !(access.serves)(pose, goal.target, goal.directive));
            if offered > 0 {
                if lost {
                    goal.pose = None;
                    let terms = vec![Term::of("poses", offered as f64)];
                    revision.change(id, Change::new(Reason::PoseLost, terms));
                }
                continue;
            }
            if self.generalise(id, poses, access, survey, revision) {
                continue;
            }
            let radius_m = self.spec.identity_radius_m;
            let terms = vec![Term::against("poses", 0.0, 1.0)];
            self.end(id, Ending::drop(Reason::Unreachable, terms, None), survey, revision);
            self.retire(id, radius_m, Reason::Unreachable, survey, revision);
        }
        revision.ended.len() > ended
    }

    /// Moves a goal whose target cannot be reached to the best reachable place of its kind nearby that no committed goal
    /// has, if its directive allows that. A goal that had the place is merged into it. Says whether there was one.
    fn generalise(
        &mut self,
        id: GoalId,
        poses: &mut Poses,
        access: Access<'_>,
        survey: &Survey<'_>,
        revision: &mut Revision,
    ) -> bool {
        let goal = &self.state.goals[&id];
        let directive = goal.directive;
        let wanted = &self.directives[directive];
        let kind = wanted.kind;
        // Leaving a place is a try that failed.
        if goal.attempts + 1 >= wanted.max_attempts {
            return false;
        }
        let Some(view) = survey.view(kind) else { return false };
        let spacing = survey.spacing_m();
        let speaks = |cell: Cell| (f64::from(view.interest[cell]), (survey.credit)(cell));
        for site in view.sites {
            let distance_m = site.peak.distance(goal.target) * spacing;
            let here = distance_m <= self.spec.identity_radius_m
                || site.region.binary_search(&goal.target).is_ok();
            if here
                || distance_m > wanted.generalise_m
                || self.explained_by(site, kind, spacing, &speaks).is_some()
                || !self.suits(directive, self.type_at(site.peak, survey))
                || !wanted.accepts(f64::from(view.interest[site.peak]), &(survey.credit)(site.peak))
            {
                continue;
            }
            let owner = self.state.goals.values().find(|other| {
                other.id != id
                    && self.directives[other.directive].kind == wanted.kind
                    && (self.same_place(other.target, site.peak, survey)
                        || site.region.binary_search(&other.target).is_ok())
            });
            if owner.is_some_and(|owner| owner.status().is_committed() || owner.order.is_some()) {
                continue;
            }
            let ways = (access.poses)(site.peak, directive);
            if ways.is_empty() {
                continue;
            }
            let owner = owner.map(|owner| owner.id);
            let (from, moved_m) = (goal.target, distance_m);
            let prize = quantised(wanted.weight * site.prize);
            let terms = vec![
                Term::against("poses", 0.0, 1.0),
                Term::against("prize", prize, goal.prize),
                Term::against("moved_m", moved_m, wanted.generalise_m),
            ];
            if let Some(owner) = owner {
                let merged = vec![Term::of("prize", self.state.goals[&owner].prize)];
                self.end(owner, Ending::drop(Reason::Merged, merged, Some(id)), survey, revision);
                poses.remove(&owner);
            }
            let goal = self.state.goals.get_mut(&id).expect("the goal is open");
            goal.target = site.peak;
            goal.pose = None;
            goal.attempts += 1;
            goal.prominence = site.prominence;
            goal.region_cells = site.region.len();
            goal.extent = extent(site);
            poses.insert(id, ways);
            revision.change(id, Change::new(Reason::Generalised, terms));
            self.weigh_anew(id, survey, revision);
            self.close_unreachable(id, from, kind, survey);
            return true;
        }
        false
    }

    /// Closes a place that a goal left because nothing reaches it, so that it is not wanted again until its ground changes.
    fn close_unreachable(&mut self, goal: GoalId, target: Cell, kind: Kind, survey: &Survey<'_>) {
        let ground = (survey.ground)(target).unwrap_or(GROUND_UNSEEN);
        let radius_m = self.spec.identity_radius_m;
        let reason = Reason::Unreachable;
        let heard = (survey.heard)(target);
        self.state.retired.push(Retired {
            goal,
            kind,
            target,
            radius_m,
            reason,
            heard,
            ground,
            reopenings: 0,
            closed: true,
        });
    }
}
