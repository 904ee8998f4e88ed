//! All ways to serve goals in a given order: a pose for each goal, an alternative for each leg.

use wisdom_planner::CostVector;

use super::model::{Call, Model, Standing, Whole};
use super::problem::{GoalSequence, Problem};
use crate::{GoalId, ServiceCost};

/// Labels kept after each goal of an order that is weighed; orders of a dozen goals with a few poses need far fewer.
const ENOUGH: usize = 2000;

/// The best way (poses, alternatives, operators) to serve the goals in exactly this order, if any is within the limits.
///
/// After each goal at most 2000 ways are kept, spread from the most to the least reliable.
#[must_use]
pub fn weigh(problem: &Problem<'_>, order: &[GoalId]) -> Option<GoalSequence> {
    let mut model = Model::new(*problem);
    let turns = model.turns(order)?;
    model.best_way(&turns)
}

/// A way to a pose of a goal.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Way {
    pub at: Standing,
    /// The way before, in the layer before.
    pub parent: usize,
    /// The alternative of the leg from there.
    pub alternative: usize,
}

/// The ways after each goal of an order; the first layer is the start.
pub(crate) struct Layers {
    pub layers: Vec<Vec<Way>>,
    /// Whether no layer had more ways than may be kept.
    pub complete: bool,
}

impl Layers {
    /// The stops of the way that ends with a member of the last layer.
    pub(crate) fn calls(&self, turns: &[usize], last: usize) -> Vec<Call> {
        let (mut calls, mut at) = (Vec::new(), last);
        for (layer, &candidate) in self.layers[1..].iter().zip(turns).rev() {
            let Way { at: standing, parent, alternative } = layer[at];
            calls.push(Call { candidate, node: standing.node as usize, alternative });
            at = parent;
        }
        calls.reverse();
        calls
    }
}

impl Model<'_> {
    /// The candidates of an order, if all are known, none is named twice, and precedence and exclusion allow it.
    pub(crate) fn turns(&self, order: &[GoalId]) -> Option<Vec<usize>> {
        let mut turns: Vec<usize> = Vec::new();
        for goal in order {
            let turn = self.problem.candidates.iter().position(|c| c.goal == *goal)?;
            let fits = !turns.contains(&turn)
                && !self.orphaned[turn]
                && self.after[turn].iter().all(|before| turns.contains(before))
                && !self.excludes[turn].iter().any(|other| turns.contains(other));
            if !fits {
                return None;
            }
            turns.push(turn);
        }
        Some(turns)
    }

    /// The best plan for an order.
    pub(crate) fn best_way(&mut self, turns: &[usize]) -> Option<GoalSequence> {
        let calls = self.best_calls(turns)?;
        self.sequence(&calls)
    }

    /// The stops of the best plan for an order.
    pub(crate) fn best_calls(&mut self, turns: &[usize]) -> Option<Vec<Call>> {
        let (layers, last, _) = self.best_end(turns)?;
        Some(layers.calls(turns, last))
    }

    /// The best plan for an order in numbers, and its data in megabytes.
    pub(crate) fn worth(&mut self, turns: &[usize]) -> Option<(Whole, f64)> {
        let (layers, last, whole) = self.best_end(turns)?;
        Some((whole, layers.layers[turns.len()][last].at.data_mb))
    }

    /// The ways to serve an order, and which of the last is the best plan.
    fn best_end(&mut self, turns: &[usize]) -> Option<(Layers, usize, Whole)> {
        let layers = self.ways(turns, ENOUGH, Self::best_of);
        let mut best: Option<(usize, Whole)> = None;
        for (index, way) in layers.layers[turns.len()].iter().enumerate() {
            let Some(whole) = self.whole(&way.at) else { continue };
            if best.is_none_or(|(_, b)| whole.ranks_before(&b)) {
                best = Some((index, whole));
            }
        }
        let (last, whole) = best?;
        Some((layers, last, whole))
    }

    /// The stops of some way to serve an order, whether or not a plan can end there.
    pub(crate) fn any_calls(&mut self, turns: &[usize]) -> Option<Vec<Call>> {
        let ends = std::mem::take(&mut self.problem.ends);
        let layers = self.ways(turns, ENOUGH, Self::best_of);
        self.problem.ends = ends;
        let last = layers.layers.last().filter(|layer| !layer.is_empty());
        last.map(|_| layers.calls(turns, 0))
    }

    /// The ways, layer by layer, less those that `keep` does not want and those that the cheapest way to go on takes
    /// over a limit.
    pub(crate) fn ways(
        &mut self,
        turns: &[usize],
        most: usize,
        keep: impl Fn(&Self, Vec<Way>) -> Vec<Way>,
    ) -> Layers {
        let bounds = self.rest(turns);
        let start = Way { at: Self::start(), parent: 0, alternative: 0 };
        let mut complete = true;
        let mut layers = vec![vec![start]];
        for (&turn, bounds) in turns.iter().zip(&bounds) {
            let before = &layers[layers.len() - 1];
            let candidates = self.problem.candidates;
            let mut layer = Vec::new();
            for (&node, rest) in candidates[turn].poses.iter().zip(bounds) {
                let mut here = Vec::new();
                for (parent, way) in before.iter().enumerate() {
                    let travel = self.problem.travel;
                    let legs = travel.alternatives(way.at.node as usize, node);
                    for (alternative, leg) in legs.iter().enumerate() {
                        let next = self.serve(&way.at, turn, node, leg);
                        let Some(at) = next.filter(|at| self.may_go_on(at, rest)) else { continue };
                        here.push(Way { at, parent, alternative });
                    }
                }
                layer.append(&mut keep(self, here));
            }
            if layer.len() > most.max(1) {
                layer = thinned(layer, most.max(1));
                complete = false;
            }
            layers.push(layer);
        }
        Layers { layers, complete }
    }

    /// For each turn and pose, the least that each cost alone can be from there to the end of the order.
    fn rest(&mut self, turns: &[usize]) -> Vec<Vec<CostVector>> {
        let least = |a: CostVector, b: CostVector| CostVector {
            length_m: 0.0,
            time_s: a.time_s.min(b.time_s),
            energy_j: a.energy_j.min(b.energy_j),
            neg_ln_r: a.neg_ln_r.min(b.neg_ln_r),
        };
        let Problem { candidates, travel, ends, .. } = self.problem;
        let no_way = CostVector {
            length_m: 0.0,
            time_s: f64::INFINITY,
            energy_j: f64::INFINITY,
            neg_ln_r: f64::INFINITY,
        };
        let home = |from: usize| {
            let legs = ends.iter().flat_map(|&end| travel.alternatives(from, end)).copied();
            if ends.is_empty() { CostVector::ZERO } else { legs.fold(no_way, least) }
        };
        let services: Vec<ServiceCost> =
            self.services_in(turns).unwrap_or_else(|| vec![ServiceCost::default(); turns.len()]);
        let mut bounds: Vec<Vec<CostVector>> = Vec::new();
        for (index, &turn) in turns.iter().enumerate().rev() {
            let here = candidates[turn].poses.iter().map(|&from| {
                let (Some(&next), Some(after)) = (turns.get(index + 1), bounds.last()) else {
                    return home(from);
                };
                let ways = candidates[next].poses.iter().zip(after).flat_map(|(&to, &rest)| {
                    let legs = travel.alternatives(from, to);
                    legs.iter().map(move |&leg| rest + leg)
                });
                let mut way = ways.fold(no_way, least);
                way.time_s += services[index + 1].time_s;
                way.energy_j += services[index + 1].energy_j;
                way
            });
            let here = here.collect();
            bounds.push(here);
        }
        bounds.reverse();
        bounds
    }

    /// Whether a way that keeps the limits so far may keep them to the end.
    fn may_go_on(&self, at: &Standing, rest: &CostVector) -> bool {
        // Sums of the same costs in another order differ by rounding; a plan that fits exactly must not be ruled out by
        // that.
        const GRACE: f64 = 1.0 + 1e-9;
        let limits = &self.problem.limits;
        let neg_ln_r = at.neg_ln_r + rest.neg_ln_r;
        at.time_s + rest.time_s <= limits.time_s * GRACE
            && at.energy_j + rest.energy_j <= limits.energy_j * GRACE
            && libm::exp(-neg_ln_r) * GRACE >= self.floor
            && neg_ln_r < f64::INFINITY
    }

    /// The ways of one pose that no other one there makes needless for the objective.
    fn best_of(&self, ways: Vec<Way>) -> Vec<Way> {
        let beats = |a: &Standing, b: &Standing| {
            let waiting = self.problem.waiting_w * (b.time_s - a.time_s).max(0.0);
            a.gain >= b.gain
                && a.neg_ln_r <= b.neg_ln_r
                && a.time_s <= b.time_s
                && a.energy_j + waiting <= b.energy_j
        };
        let mut kept: Vec<Way> = Vec::new();
        for way in ways {
            if !kept.iter().any(|other| beats(&other.at, &way.at)) {
                kept.retain(|other| !beats(&way.at, &other.at));
                kept.push(way);
            }
        }
        kept
    }
}

/// So many of the ways, from the most to the least reliable at even steps.
fn thinned(mut ways: Vec<Way>, keep: usize) -> Vec<Way> {
    ways.sort_by(|a, b| a.at.neg_ln_r.total_cmp(&b.at.neg_ln_r));
    let last = ways.len() - 1;
    let steps = keep.saturating_sub(1).max(1);
    (0..keep).map(|index| ways[index * last / steps]).collect()
}
