//! Why a goal is not in the sequence: the first constraint in its way, with the numbers compared.

use super::commit::Weighed;
use super::{GoalManager, Poses, Selection};
use crate::sequence::{Limits, Model, Problem};
use crate::{Goal, GoalId, Preferences, Proof, Reason, Term};
use wisdom_planner::CostVector;

impl GoalManager {
    /// The first constraint that keeps a goal out of the sequence, with the numbers compared.
    pub(super) fn why_not(
        &self,
        goal: &Goal,
        weighed: &Weighed<'_>,
        tried: &mut Tried<'_>,
    ) -> Refusal {
        let Weighed { selection, shortlist, poses, .. } = *weighed;
        let problem = tried.within.problem;
        let limits = tried.limits();
        let ways = poses.get(&goal.id).map_or(&[][..], Vec::as_slice);
        if ways.is_empty() {
            return Refusal::alone(Reason::Unreachable, vec![Term::against("poses", 0.0, 1.0)]);
        }
        let directive = &self.directives[goal.directive];
        let ready = problem.facts.contains(directive.requires);
        let service =
            ready.then(|| problem.domain.expand(problem.facts, directive.achieves)).flatten();
        let window = problem.candidates.iter().find(|c| c.goal == goal.id).and_then(|c| c.window);
        // The constraint that keeps it from being done next, from the pose that misses it by least.
        let alone = service.as_ref().and_then(|service| {
            let time_of = |&operator: &usize| problem.domain.operators()[operator].cost.time_s;
            let before_s =
                service.before.iter().map(time_of).sum::<f64>() + time_of(&problem.domain.drive());
            let over = |way: &CostVector| {
                let arrival_s = way.time_s + before_s;
                let wait_s = window.map_or(0.0, |window| (window.open_s - arrival_s).max(0.0));
                let late = window.filter(|window| arrival_s > window.close_s);
                if let Some(window) = late {
                    let (reason, name) = (Reason::Window, "arrival_s");
                    let (needed, limit) = (arrival_s, window.close_s);
                    return Some(Violation { reason, name, needed, limit });
                }
                let needs = Limits {
                    time_s: way.time_s + service.cost.time_s + wait_s,
                    energy_j: way.energy_j + service.cost.energy_j + problem.waiting_w * wait_s,
                    data_mb: service.cost.data_mb,
                    min_reliability: way.reliability(),
                };
                first_violation(&needs, &limits)
            };
            let over: Option<Vec<Violation>> = ways.iter().map(|(_, way)| over(way)).collect();
            over?.into_iter().min_by(|a, b| a.excess().total_cmp(&b.excess()))
        });
        if let Some((_, least)) = shortlist.left_out.iter().find(|(id, _)| *id == goal.id) {
            let last = shortlist.kept.last().and_then(|id| bound(&self.state.goals[id], poses));
            let cut = vec![Term::against("bound", *least, last.unwrap_or(0.0))];
            return alone.map_or(Refusal::alone(Reason::BeyondExact, cut), Violation::told);
        }
        let chosen = selection.sequence();
        let (within, over) = tried.insert(goal.id, selection);
        if let Some(value) = within {
            if selection.held && value > chosen.value {
                let least = chosen.value + self.spec.hysteresis * chosen.value.abs();
                let terms = vec![Term::against("value with it", value, least)];
                return Refusal::alone(Reason::Held, terms);
            }
            let terms = vec![Term::against("value with it", value, chosen.value)];
            if value > chosen.value && selection.proof != Proof::Proven {
                return Refusal::alone(Reason::SearchCut, terms);
            }
            return Refusal { reason: Reason::Outweighed, terms, alone: false };
        }
        if let Some(violation) = alone {
            return violation.told();
        }
        if let Some(violation) = over {
            return Refusal { alone: false, ..violation.told() };
        }
        if service.is_none() {
            let wanted = directive.requires.with(directive.achieves);
            let missing = problem.domain.names(wanted.without(problem.facts)).count();
            let terms = vec![Term::against("facts missing", missing as f64, 0.0)];
            return Refusal::alone(Reason::Preconditions, terms);
        }
        if let Some(window) = window {
            // After what the others take, it would be too late.
            let terms = vec![Term::against("time_s", chosen.time_s, window.close_s)];
            return Refusal { reason: Reason::Window, terms, alone: false };
        }
        let terms = vec![Term::of("prize", goal.prize)];
        Refusal { reason: Reason::Outweighed, terms, alone: false }
    }

    /// A committed goal that a limit drives out of the sequence although its directive has a weaker substitute that nothing
    /// forbids: the one of the highest prize, the substitute, and the numbers compared.
    #[must_use]
    pub fn too_dear(&self, weighed: &Weighed<'_>) -> Option<(GoalId, usize, Vec<Term>)> {
        let mut tried = None;
        let chosen: Vec<GoalId> = weighed.selection.sequence().goals().collect();
        let mut out: Vec<&Goal> = (self.state.agenda.iter())
            .filter(|id| !chosen.contains(id))
            .filter_map(|id| self.state.goals.get(id))
            .collect();
        out.sort_by(|a, b| b.prize.total_cmp(&a.prize).then(a.id.cmp(&b.id)));
        let problem = &weighed.problem;
        out.into_iter().find_map(|goal| {
            let strong = &self.directives[goal.directive];
            let weaker =
                strong.substitute.filter(|&w| self.directives[w].weight <= strong.weight)?;
            problem.domain.expand(problem.facts, self.directives[weaker].achieves)?;
            let tried = tried.get_or_insert_with(|| Tried::new(problem));
            let Refusal { reason, terms, .. } = self.why_not(goal, weighed, tried);
            let limit = [Reason::Time, Reason::Energy, Reason::Data, Reason::Risk];
            limit.contains(&reason).then_some((goal.id, weaker, terms))
        })
    }
}

/// Why a goal is not in the sequence.
pub(super) struct Refusal {
    pub reason: Reason,
    pub terms: Vec<Term>,
    /// Whether it could not be done, or would not, even if it were the only one.
    pub alone: bool,
}

impl Refusal {
    fn alone(reason: Reason, terms: Vec<Term>) -> Self {
        Self { reason, terms, alone: true }
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

    fn told(self) -> Refusal {
        Refusal::alone(self.reason, vec![Term::against(self.name, self.needed, self.limit)])
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
