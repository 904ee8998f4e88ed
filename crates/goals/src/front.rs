//! All ways to serve goals in a given order that no other way is better than in everything.

use wisdom_planner::{CostVector, non_dominated};

use crate::GoalId;
use crate::sequence::{GoalSequence, Model, Problem, Way, Whole};

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
/// Every goal of the order must be a candidate, and be named once; otherwise there is no plan. Where waiting draws power
/// and goals have windows, a way that comes early and waits may hide one that sets out later and draws less.
#[must_use]
pub fn plan_front(problem: &Problem<'_>, order: &[GoalId], max_labels: usize) -> PlanFront {
    let mut front = PlanFront { plans: Vec::new(), complete: true, labels: 0 };
    let mut model = Model::new(*problem);
    let Some(turns) = model.turns(order) else { return front };
    let layers = model.ways(&turns, max_labels, |_, ways| best_of(&ways));
    front.complete = layers.complete;
    front.labels = layers.layers[1..].iter().map(|layer| layer.len() as u64).sum();
    let last = &layers.layers[layers.layers.len() - 1];
    let mut ended: Vec<(usize, Whole)> = Vec::new();
    for (index, way) in last.iter().enumerate() {
        model.endings(&way.at, |whole| ended.push((index, whole)));
    }
    let costs: Vec<CostVector> = ended.iter().map(|(_, whole)| whole.cost()).collect();
    for best in non_dominated(&costs) {
        let (index, whole) = ended[best];
        let calls = layers.calls(&turns, index);
        front.plans.extend(model.sequence_to(&calls, |_, _| Some(whole)));
    }
    front
}

/// The ways to one pose that no other way there matches or beats.
fn best_of(ways: &[Way]) -> Vec<Way> {
    let cost = |way: &Way| CostVector {
        length_m: 0.0,
        time_s: way.at.time_s,
        energy_j: way.at.energy_j,
        neg_ln_r: way.at.neg_ln_r,
    };
    let costs: Vec<CostVector> = ways.iter().map(cost).collect();
    non_dominated(&costs).into_iter().map(|index| ways[index]).collect()
}
