//! All ways to serve goals in a given order that no other way is better than in everything.

use wisdom_planner::{CostVector, TravelMatrix, non_dominated};

use crate::sequence::{Candidate, GoalSequence, Limits, Problem, Stop};
use crate::{Expansion, GoalId};

/// Whole plans for one order of goals, none better than another in time, energy and −ln R at once.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanFront {
    /// The plans, most reliable first, then the quickest, then the one that draws least; empty if the order cannot
    /// be served within the limits.
    pub plans: Vec<GoalSequence>,
    /// Whether these are all, of the poses and leg alternatives given. If not, more labels were met than may be
    /// kept, and each plan may be beaten by one that was not met.
    pub complete: bool,
    /// Labels kept, over all goals.
    pub labels: u64,
}

/// Finds the ways (a pose for each goal, an alternative for each leg) to serve the goals in exactly this order
/// within the limits that no other way matches or beats in time, energy and −ln R at once; of ways with equal costs,
/// one, always the same.
///
/// The order fixes the facts at each turn, hence what every goal's operators cost and the data volume; the rest is a
/// search goal by goal with a Pareto set of labels for each pose (Martins 1984), without those that the cheapest
/// way to go on takes over a limit. After each goal at most `max_labels` labels are kept (one, if it is 0): where
/// there are more, some spread evenly from the most to the least reliable, and the front counts as not complete.
///
/// Every goal of the order must be a candidate, and be named once; otherwise there is no plan.
#[must_use]
pub fn plan_front(problem: &Problem<'_>, order: &[GoalId], max_labels: usize) -> PlanFront {
    let mut front = PlanFront { plans: Vec::new(), complete: true, labels: 0 };
    let Some(turns) = turns(problem, order) else { return front };
    let bounds = bounds(problem.travel, &turns);
    let start = Label { node: 0, cost: CostVector::ZERO, parent: 0, alternative: 0 };
    let mut layers = vec![vec![start]];
    for (turn, bounds) in turns.iter().zip(&bounds) {
        let before = &layers[layers.len() - 1];
        let mut layer = Vec::new();
        for (&node, bound) in turn.candidate.poses.iter().zip(bounds) {
            layer.extend(reach(problem, turn, before, node, bound));
        }
        if layer.len() > max_labels.max(1) {
            layer = thinned(layer, max_labels.max(1));
            front.complete = false;
        }
        front.labels += layer.len() as u64;
        layers.push(layer);
    }
    let last = &layers[layers.len() - 1];
    let costs: Vec<CostVector> = last.iter().map(|label| label.cost).collect();
    front.plans = non_dominated(&costs)
        .into_iter()
        .map(|label| plan(problem, &turns, &layers, label))
        .collect();
    front
}

/// A goal's turn in the order.
struct Turn<'a> {
    candidate: &'a Candidate,
    expansion: Expansion,
}

/// A way to a pose of a goal.
#[derive(Clone, Copy)]
struct Label {
    /// The pose, as a node of the travel matrix.
    node: usize,
    /// Drives and services so far.
    cost: CostVector,
    /// The label before, in the layer before.
    parent: usize,
    /// The alternative of the leg from there.
    alternative: usize,
}

/// What the goals of an order need in their turns; none if one of them cannot be served, however the rover drives.
fn turns<'a>(problem: &Problem<'a>, order: &[GoalId]) -> Option<Vec<Turn<'a>>> {
    let mut facts = problem.facts;
    let mut data_mb = 0.0;
    let mut turns: Vec<Turn<'a>> = Vec::new();
    for goal in order {
        let candidate = problem.candidates.iter().find(|c| c.goal == *goal)?;
        let directive = &problem.directives[candidate.directive];
        let named_before = turns.iter().any(|turn| turn.candidate.goal == *goal);
        if named_before || !facts.contains(directive.requires) {
            return None;
        }
        let expansion = problem.domain.expand(facts, directive.achieves)?;
        facts = expansion.facts;
        data_mb += expansion.cost.data_mb;
        turns.push(Turn { candidate, expansion });
    }
    // The search compares what is spent with what is left, and so does this: NaN allows nothing.
    (data_mb <= problem.limits.data_mb).then_some(turns)
}

/// The costs of a leg and the service at its end, added in the order of the sequence search so that both have the
/// same bits.
fn then(cost: CostVector, leg: CostVector, expansion: &Expansion) -> CostVector {
    let mut next = cost + leg;
    next.time_s += expansion.cost.time_s;
    next.energy_j += expansion.cost.energy_j;
    next
}

/// For each turn and pose, the least that each cost alone can be from there to the end of the order.
fn bounds(travel: &TravelMatrix, turns: &[Turn<'_>]) -> Vec<Vec<CostVector>> {
    const NO_WAY: CostVector = CostVector {
        length_m: f64::INFINITY,
        time_s: f64::INFINITY,
        energy_j: f64::INFINITY,
        neg_ln_r: f64::INFINITY,
    };
    let least = |a: CostVector, b: CostVector| CostVector {
        length_m: a.length_m.min(b.length_m),
        time_s: a.time_s.min(b.time_s),
        energy_j: a.energy_j.min(b.energy_j),
        neg_ln_r: a.neg_ln_r.min(b.neg_ln_r),
    };
    let mut bounds: Vec<Vec<CostVector>> = Vec::new();
    for (index, turn) in turns.iter().enumerate().rev() {
        let here = turn.candidate.poses.iter().map(|&from| {
            let (Some(next), Some(after)) = (turns.get(index + 1), bounds.last()) else {
                return CostVector::ZERO;
            };
            let ways = next.candidate.poses.iter().zip(after).flat_map(|(&to, &rest)| {
                let legs = travel.alternatives(from, to);
                legs.iter().map(move |&leg| then(rest, leg, &next.expansion))
            });
            ways.fold(NO_WAY, least)
        });
        let here = here.collect();
        bounds.push(here);
    }
    bounds.reverse();
    bounds
}

/// The ways to one pose that are within the limits and that no other way there matches or beats.
fn reach(
    problem: &Problem<'_>,
    turn: &Turn<'_>,
    before: &[Label],
    node: usize,
    bound: &CostVector,
) -> Vec<Label> {
    let mut labels = Vec::new();
    for (parent, label) in before.iter().enumerate() {
        let legs = problem.travel.alternatives(label.node, node);
        for (alternative, &leg) in legs.iter().enumerate() {
            let cost = then(label.cost, leg, &turn.expansion);
            if allowed(&problem.limits, cost, bound) {
                labels.push(Label { node, cost, parent, alternative });
            }
        }
    }
    let costs: Vec<CostVector> = labels.iter().map(|label| label.cost).collect();
    non_dominated(&costs).into_iter().map(|index| labels[index]).collect()
}

/// Whether a way keeps the limits so far, and may keep them to the end.
fn allowed(limits: &Limits, cost: CostVector, bound: &CostVector) -> bool {
    // Sums of the same costs in another order differ by rounding; a plan that fits exactly must not be ruled out by
    // that.
    const GRACE: f64 = 1.0 + 1e-9;
    let rest = cost + *bound;
    cost.time_s <= limits.time_s
        && cost.energy_j <= limits.energy_j
        && cost.reliability() >= limits.min_reliability
        && rest.time_s <= limits.time_s * GRACE
        && rest.energy_j <= limits.energy_j * GRACE
        && rest.reliability() * GRACE >= limits.min_reliability
        && rest.neg_ln_r < f64::INFINITY
}

/// So many of the labels, from the most to the least reliable at even steps.
fn thinned(mut labels: Vec<Label>, keep: usize) -> Vec<Label> {
    labels.sort_by(|a, b| a.cost.neg_ln_r.total_cmp(&b.cost.neg_ln_r));
    let last = labels.len() - 1;
    let steps = keep.saturating_sub(1).max(1);
    (0..keep).map(|index| labels[index * last / steps]).collect()
}

/// The plan that ends with a label of the last layer.
fn plan(
    problem: &Problem<'_>,
    turns: &[Turn<'_>],
    layers: &[Vec<Label>],
    last: usize,
) -> GoalSequence {
    let mut way = Vec::new();
    let mut at = last;
    for layer in layers[1..].iter().rev() {
        way.push(layer[at]);
        at = layer[at].parent;
    }
    let objective = problem.policy.objective();
    let mut plan = GoalSequence::empty();
    for (turn, label) in turns.iter().zip(way.into_iter().rev()) {
        let Candidate { goal, prize, .. } = *turn.candidate;
        plan.reliability = label.cost.reliability();
        plan.value = objective.extend(plan.value, prize, plan.reliability);
        plan.prize += prize;
        plan.expected += prize * plan.reliability;
        plan.time_s = label.cost.time_s;
        plan.energy_j = label.cost.energy_j;
        plan.data_mb += turn.expansion.cost.data_mb;
        plan.stops.push(Stop {
            goal,
            pose: label.node,
            alternative: label.alternative,
            expansion: turn.expansion.clone(),
        });
    }
    plan
}
