//! Why a goal is not in the sequence: the first constraint in its way, with the numbers compared.

use super::{GoalManager, Poses, Selection, Shortlist};
use crate::sequence::{Limits, Model, Problem};
use crate::{Goal, GoalId, Preferences, Proof, Reason, Term};
use wisdom_planner::CostVector;

impl GoalManager {
    /// The first constraint that keeps a goal out of the sequence, with the numbers compared.
    pub(super) fn why_not(
        &self,
        goal: &Goal,
        selection: &Selection,
        shortlist: &Shortlist,
        poses: &Poses,
        tried: &mut Tried<'_>,
    ) -> (Reason, Vec<Term>) {
        let problem = tried.within.problem;
        let limits = tried.limits();
        let ways = poses.get(&goal.id).map_or(&[][..], Vec::as_slice);
        if ways.is_empty() {
            return (Reason::Unreachable, vec![Term::against("poses", 0.0, 1.0)]);
        }
        let directive = &self.directives[goal.directive];
        let ready = problem.facts.contains(directive.requires);
        let service =
            ready.then(|| problem.domain.expand(problem.facts, directive.achieves)).flatten();
        // The constraint that keeps it from being done next, from the pose that misses it by least.
        let alone = service.as_ref().and_then(|service| {
            let needs = |way: &CostVector| Limits {
                time_s: way.time_s + service.cost.time_s,
                energy_j: way.energy_j + service.cost.energy_j,
                data_mb: service.cost.data_mb,
                min_reliability: way.reliability(),
            };
            let over: Option<Vec<Violation>> =
                ways.iter().map(|(_, way)| first_violation(&needs(way), &limits)).collect();
            over?.into_iter().min_by(|a, b| a.excess().total_cmp(&b.excess()))
        });
        if let Some((_, least)) = shortlist.left_out.iter().find(|(id, _)| *id == goal.id) {
            let last = shortlist.kept.last().and_then(|id| bound(&self.state.goals[id], poses));
            let cut = vec![Term::against("bound", *least, last.unwrap_or(0.0))];
            return alone.map_or((Reason::BeyondExact, cut), Violation::told);
        }
        let chosen = selection.sequence();
        let (within, over) = tried.insert(goal.id, selection);
        if let Some(value) = within {
            if selection.held && value > chosen.value {
                let least = chosen.value + self.spec.hysteresis * chosen.value.abs();
                return (Reason::Held, vec![Term::against("value with it", value, least)]);
            }
            if value > chosen.value && selection.proof != Proof::Proven {
                let terms = vec![Term::against("value with it", value, chosen.value)];
                return (Reason::SearchCut, terms);
            }
            return (Reason::Outweighed, vec![Term::against("value with it", value, chosen.value)]);
        }
        if let Some(violation) = alone.or(over) {
            return violation.told();
        }
        if service.is_none() {
            let wanted = directive.requires.with(directive.achieves);
            let missing = problem.domain.names(wanted.without(problem.facts)).count();
            return (
                Reason::Preconditions,
                vec![Term::against("facts missing", missing as f64, 0.0)],
            );
        }
        (Reason::Outweighed, vec![Term::of("prize", goal.prize)])
    }
}

/// The most a goal could add to any sequence on its own: prize times the reliability of its safest pose.
pub(super) fn bound(goal: &Goal, poses: &Poses) -> Option<f64> {
    let reliabilities = poses.get(&goal.id)?.iter().map(|(_, cost)| cost.reliability());
    Some(goal.prize * reliabilities.max_by(f64::total_cmp)?)
}

/// A problem, and the same without limits.
pub(super) struct Tried<'a> {
    within: Model<'a>,
    free: Model<'a>,
}

impl<'a> Tried<'a> {
    pub(super) fn new(problem: &Problem<'a>) -> Self {
        let limits = Limits {
            time_s: f64::INFINITY,
            energy_j: f64::INFINITY,
            data_mb: f64::INFINITY,
            min_reliability: 0.0,
        };
        let preferences = Preferences { confidence: 0.0, ..problem.preferences };
        let free = Problem { limits, preferences, ..*problem };
        Self { within: Model::new(*problem), free: Model::new(free) }
    }

    /// The limits, the objective's own floor among them.
    fn limits(&self) -> Limits {
        Limits { min_reliability: self.within.floor, ..self.within.problem.limits }
    }

    /// Tries a goal at every turn of the chosen sequence: the best value of those within the limits, and the smallest
    /// overrun of the others.
    fn insert(&mut self, goal: GoalId, selection: &Selection) -> (Option<f64>, Option<Violation>) {
        let order: Vec<GoalId> = selection.sequence().goals().collect();
        let first_turn = usize::from(selection.pinned.is_some());
        let mut best: Option<f64> = None;
        let mut least: Option<Violation> = None;
        for turn in first_turn..=order.len() {
            let mut with = order.clone();
            with.insert(turn, goal);
            let Some(turns) = self.within.turns(&with) else { continue };
            if let Some((within, _)) = self.within.worth(&turns) {
                best = Some(best.map_or(within.value, |b| b.max(within.value)));
            } else if let Some((over, data_mb)) = self.free.worth(&turns) {
                let needs = Limits {
                    time_s: over.time_s,
                    energy_j: over.energy_j,
                    data_mb,
                    min_reliability: over.reliability,
                };
                if let Some(violation) = first_violation(&needs, &self.limits())
                    && least.as_ref().is_none_or(|l| violation.excess() < l.excess())
                {
                    least = Some(violation);
                }
            }
        }
        (best, least)
    }
}

/// A limit missed.
struct Violation {
    reason: Reason,
    name: &'static str,
    needed: f64,
    limit: f64,
}

impl Violation {
    /// By how much, as a share of the limit.
    fn excess(&self) -> f64 {
        (self.needed - self.limit).abs() / self.limit.abs().max(f64::MIN_POSITIVE)
    }

    fn told(self) -> (Reason, Vec<Term>) {
        (self.reason, vec![Term::against(self.name, self.needed, self.limit)])
    }
}

/// The first limit that some needs exceed, in the order time, energy, data, risk.
fn first_violation(needs: &Limits, limits: &Limits) -> Option<Violation> {
    let over = |reason, name, needed: f64, limit: f64| {
        (needed > limit).then_some(Violation { reason, name, needed, limit })
    };
    over(Reason::Time, "time_s", needs.time_s, limits.time_s)
        .or_else(|| over(Reason::Energy, "energy_j", needs.energy_j, limits.energy_j))
        .or_else(|| over(Reason::Data, "data_mb", needs.data_mb, limits.data_mb))
        .or_else(|| {
            let (needed, limit) = (needs.min_reliability, limits.min_reliability);
            let (reason, name) = (Reason::Risk, "reliability");
            (needed < limit).then_some(Violation { reason, name, needed, limit })
        })
}
