//! Exact label search over (goals visited, facts, pose).
//!
//! A state keeps a Pareto set of labels over time, energy, data, reliability and gain, because with real-valued budgets
//! no single number decides which prefix is better. Labels are taken best bound first, so the search can stop as soon
//! as no open label can beat the best plan found.

use std::cmp::Ordering;
use std::collections::{BTreeMap, BinaryHeap};

use super::model::{Call, Model, Standing, Whole};
use super::problem::{Effort, GoalSequence, Problem, Proof};
use crate::GoalId;
use crate::objective::{Policy, ROUNDING, Served};
use crate::prize::Ladder;

/// The most goals a label search takes: the set visited is a bit mask.
pub(super) const MAX_LABELLED: usize = 64;

/// Labels kept in memory at most (about 200 bytes each).
const MAX_LABELS: usize = 4_000_000;

const NONE: u32 = u32::MAX;

/// A prefix of a sequence.
#[derive(Clone, Copy)]
struct Label {
    mask: u64,
    at: Standing,
    /// As a whole plan; none if it cannot end here.
    whole: Option<Whole>,
    parent: u32,
    candidate: u32,
    alternative: u32,
    /// The next label of the same state.
    next: u32,
    dead: bool,
}

impl Label {
    fn state(&self) -> (u64, u32, u32) {
        (self.mask, self.at.facts, self.at.node)
    }
}

/// An open label; the heap pops the one that can hold most mandatory goals, then the highest bound, then the more
/// reliable, then the older.
struct Open {
    mandatory: u32,
    bound: f64,
    reliability: f64,
    label: u32,
}

impl Ord for Open {
    fn cmp(&self, other: &Self) -> Ordering {
        self.mandatory
            .cmp(&other.mandatory)
            .then(self.bound.total_cmp(&other.bound))
            .then(self.reliability.total_cmp(&other.reliability))
            .then(other.label.cmp(&self.label))
    }
}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Open {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Open {}

/// What still can be collected after a prefix.
#[derive(Clone, Copy)]
struct Promise {
    /// No whole plan that follows has more value.
    bound: f64,
    /// Mandatory goals that a plan that follows may hold.
    mandatory: u32,
}

/// The best a plan can be ranked: what a label must be able to beat.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Mark {
    pub mandatory: u32,
    pub value: f64,
    pub reliability: f64,
}

impl Mark {
    /// The rank of a plan.
    pub(super) fn of(plan: &GoalSequence, model: &Model<'_>) -> Self {
        let all = model.problem.candidates.iter().filter(|c| c.mandatory).count();
        Self {
            mandatory: (all - plan.missed) as u32,
            value: plan.value,
            reliability: plan.reliability,
        }
    }

    /// Whether something with this promise could rank before it, or beside it.
    fn may_be_reached(&self, mandatory: u32, bound: f64, reliability: f64) -> bool {
        if mandatory != self.mandatory {
            return mandatory > self.mandatory;
        }
        bound > self.value || (bound == self.value && reliability >= self.reliability)
    }
}

/// How a label search ended.
pub(super) struct Outcome {
    /// The best plan of each of the best sets met, best first.
    pub best: Vec<Vec<Call>>,
    pub proof: Proof,
    pub expansions: u64,
}

/// When to stop.
pub(super) struct Until<'a> {
    pub expansions: u64,
    /// Asked now and then: whether the time is over.
    pub over: &'a dyn Fn() -> bool,
}

pub(super) struct Search<'m, 'a> {
    model: &'m mut Model<'a>,
    /// Candidates that must come first.
    prefix: &'m [usize],
    costs: Cheapest,
    mandatory: u64,
    excluded: Vec<u64>,
    required: Vec<u64>,
    ladder: Option<Ladder>,
    labels: Vec<Label>,
    heads: Heads,
    open: BinaryHeap<Open>,
    /// Best label of each set met: the family is drawn from these.
    best_of_set: BTreeMap<u64, u32>,
    /// Best label found; none until the goals that must come first have been visited.
    incumbent: Option<u32>,
    /// The rank to beat, found elsewhere or here.
    mark: Option<Mark>,
    /// Where the front of gain and reliability is wanted: the labels on it.
    front: Option<Vec<u32>>,
    scratch: Scratch,
}

impl<'m, 'a> Search<'m, 'a> {
    /// A search for what ranks before the mark, or beside it.
    pub(super) fn new(model: &'m mut Model<'a>, prefix: &'m [usize], mark: Option<Mark>) -> Self {
        let candidates = model.problem.candidates;
        let bits = |list: &Vec<usize>| list.iter().fold(0u64, |mask, &i| mask | 1 << i);
        let mandatory = candidates
            .iter()
            .enumerate()
            .filter(|(_, c)| c.mandatory)
            .fold(0, |mask, (index, _)| mask | 1 << index);
        Self {
            prefix,
            costs: Cheapest::new(model),
            mandatory,
            excluded: model.excludes.iter().map(bits).collect(),
            required: model.after.iter().map(bits).collect(),
            ladder: model.ladder(),
            labels: Vec::new(),
            heads: Heads::default(),
            open: BinaryHeap::new(),
            best_of_set: BTreeMap::new(),
            incumbent: None,
            mark,
            front: None,
            scratch: Scratch::default(),
            model,
        }
    }

    pub(super) fn run(mut self, until: &Until<'_>, keep: usize) -> Outcome {
        /// Labels expanded between two looks at the clock.
        const BREATH: u64 = 64;
        let start = Model::start();
        let whole = self.model.whole(&start);
        self.enter(Label {
            mask: 0,
            at: start,
            whole,
            parent: NONE,
            candidate: NONE,
            alternative: 0,
            next: NONE,
            dead: false,
        });
        // A label of many goals leads to many others, each with a bound over all of them: as much work as so many
        // labels of a few.
        let visits: usize = self.model.problem.candidates.iter().map(|c| c.poses.len()).sum();
        let price = 1 + (visits * self.costs.count.saturating_sub(16) / 128) as u64;
        let (mut expansions, mut taken) = (0, 0u64);
        let mut proof = Proof::Proven;
        while let Some(open) = self.open.pop() {
            if !self.may_improve(open.mandatory, open.bound, open.reliability) {
                if self.front.is_none() {
                    break;
                }
                continue;
            }
            if self.labels[open.label as usize].dead {
                continue;
            }
            taken += 1;
            let tired = taken % BREATH == 0 && (until.over)();
            if expansions + price > until.expansions || tired || self.labels.len() > MAX_LABELS {
                let found = self.mark.map_or(0.0, |mark| mark.value);
                let others = self.open.iter().map(|o| o.bound).fold(open.bound, f64::max);
                proof = Proof::Bound(others.max(found));
                break;
            }
            expansions += price;
            self.expand(open.label);
        }
        let mut sets: Vec<u32> = match self.front.take() {
            Some(front) => front,
            None => self.best_of_set.values().copied().collect(),
        };
        sets.sort_by(|&a, &b| self.compare(a, b));
        let best = sets.into_iter().take(keep.max(1)).map(|label| self.stops(label)).collect();
        Outcome { best, proof, expansions }
    }

    /// Better label first, as [`GoalSequence::rank`]; both must be whole plans.
    fn compare(&self, a: u32, b: u32) -> Ordering {
        let (x, y) = (&self.labels[a as usize], &self.labels[b as usize]);
        let (Some(p), Some(q)) = (x.whole, y.whole) else { return Ordering::Equal };
        let served = |label: &Label| (label.mask & self.mandatory).count_ones();
        served(y)
            .cmp(&served(x))
            .then(q.value.total_cmp(&p.value))
            .then(q.reliability.total_cmp(&p.reliability))
            .then(p.time_s.total_cmp(&q.time_s))
            .then_with(|| self.goals(x).cmp(&self.goals(y)))
    }

    fn goals(&self, label: &Label) -> Vec<GoalId> {
        let (mut at, mut goals) = (label, Vec::new());
        while at.candidate != NONE {
            goals.push(self.model.problem.candidates[at.candidate as usize].goal);
            at = &self.labels[at.parent as usize];
        }
        goals.reverse();
        goals
    }

    /// Whether a label with this promise could still lead to something better than the best found.
    fn may_improve(&self, mandatory: u32, bound: f64, reliability: f64) -> bool {
        if let Some(front) = &self.front {
            let beaten = |w: &Whole| w.value >= bound && w.reliability >= reliability;
            return !front
                .iter()
                .any(|&l| self.labels[l as usize].whole.as_ref().is_some_and(beaten));
        }
        self.mark.is_none_or(|mark| mark.may_be_reached(mandatory, bound, reliability))
    }

    fn expand(&mut self, index: u32) {
        let label = self.labels[index as usize];
        let demanded = self.prefix.get(label.mask.count_ones() as usize).copied();
        for candidate in 0..self.model.problem.candidates.len() {
            if demanded.is_some_and(|d| d != candidate) || !self.allowed(label.mask, candidate) {
                continue;
            }
            let candidates = self.model.problem.candidates;
            for &node in &candidates[candidate].poses {
                let travel = self.model.problem.travel;
                let legs = travel.alternatives(label.at.node as usize, node);
                for (alternative, leg) in legs.iter().enumerate() {
                    let Some(at) = self.model.serve(&label.at, candidate, node, leg) else {
                        continue;
                    };
                    self.offer(Label {
                        mask: label.mask | 1 << candidate,
                        at,
                        whole: None,
                        parent: index,
                        candidate: candidate as u32,
                        alternative: alternative as u32,
                        next: NONE,
                        dead: false,
                    });
                }
            }
        }
    }

    /// Whether precedence and exclusion let a candidate follow these.
    fn allowed(&self, mask: u64, candidate: usize) -> bool {
        mask >> candidate & 1 == 0
            && mask & self.excluded[candidate] == 0
            && mask & self.required[candidate] == self.required[candidate]
            && !self.model.orphaned[candidate]
    }

    /// Keeps a label that no other label of its state makes needless.
    fn offer(&mut self, mut label: Label) {
        let slot = self.heads.slot(label.state(), &self.labels);
        let head = self.heads.slots[slot];
        let mut at = head;
        while at != NONE {
            let other = &self.labels[at as usize];
            let next = other.next;
            if !other.dead {
                if self.supersedes(other, &label) {
                    return;
                }
                if self.supersedes(&label, other) {
                    self.labels[at as usize].dead = true;
                }
            }
            at = next;
        }
        label.whole = self.model.whole(&label.at);
        label.next = head;
        let index = self.enter(label);
        self.heads.put(slot, index);
    }

    /// Takes a label in: as a plan, if it can end here, and as a prefix of others.
    fn enter(&mut self, label: Label) -> u32 {
        let index = self.labels.len() as u32;
        self.labels.push(label);
        if let Some(whole) = label.whole
            && label.mask.count_ones() as usize >= self.prefix.len()
        {
            if self.front.is_some() {
                self.join_front(index, &whole);
            }
            let known = self.best_of_set.get(&label.mask).copied();
            if known.is_none_or(|known| self.compare(index, known).is_lt()) {
                self.best_of_set.insert(label.mask, index);
            }
            if self.incumbent.is_none_or(|best| self.compare(index, best).is_lt()) {
                self.incumbent = Some(index);
                let mandatory = (label.mask & self.mandatory).count_ones();
                let found = Mark { mandatory, value: whole.value, reliability: whole.reliability };
                let better = self
                    .mark
                    .is_none_or(|m| m.may_be_reached(mandatory, whole.value, whole.reliability));
                if better {
                    self.mark = Some(found);
                }
            }
        }
        let Promise { bound, mandatory } = self.promise(index);
        let reliability = label.at.reliability;
        if self.may_improve(mandatory, bound, reliability) {
            self.open.push(Open { mandatory, bound, reliability, label: index });
        }
        index
    }

    /// Puts a whole plan on the front, unless one there is as good in both; of equals the quicker, then the one with
    /// smaller ids.
    fn join_front(&mut self, index: u32, whole: &Whole) {
        let beats = |a: &Whole, b: &Whole| a.value >= b.value && a.reliability >= b.reliability;
        let equal = |a: &Whole, b: &Whole| beats(a, b) && beats(b, a);
        let of =
            |label: u32| self.labels[label as usize].whole.expect("plans of the front are whole");
        let front = self.front.as_deref().unwrap_or_default();
        let kept_out = |&other: &u32| {
            let o = of(other);
            beats(&o, whole) && (!equal(&o, whole) || self.compare(other, index).is_lt())
        };
        if front.iter().any(kept_out) {
            return;
        }
        let stays = |&other: &u32| !beats(whole, &of(other));
        let mut left: Vec<u32> = front.iter().copied().filter(stays).collect();
        left.push(index);
        self.front = Some(left);
    }

    /// Whether `other` can be forgotten for `label`: nothing that can follow it is better than what can follow `label`,
    /// and where both rank the same, its goals do not come in the order of smaller ids.
    fn supersedes(&self, label: &Label, other: &Label) -> bool {
        let (a, b) = (&label.at, &other.at);
        // Who is early may have to wait, and waiting draws power.
        let waiting = self.model.problem.waiting_w * (b.time_s - a.time_s).max(0.0);
        let dominates = a.gain >= b.gain
            && a.neg_ln_r <= b.neg_ln_r
            && a.time_s <= b.time_s
            && a.energy_j + waiting <= b.energy_j
            && a.data_mb <= b.data_mb;
        let ties = a.gain == b.gain && a.neg_ln_r == b.neg_ln_r && a.time_s == b.time_s;
        dominates && (!ties || self.goals(label) <= self.goals(other))
    }

    /// The most that can still be collected after a label: every goal at its cheapest, coming from where the rover
    /// stands or from another goal still open, the last one in part, under the tightest of the budgets (the fractional
    /// knapsack bound, Dantzig 1957).
    fn promise(&mut self, index: u32) -> Promise {
        // Sums of the same costs in another order differ by rounding; a goal that fits exactly must not be
        // ruled out by that.
        const GRACE: f64 = 1e-9;
        let label = &self.labels[index as usize];
        let (at, mask) = (label.at, label.mask);
        let model = &*self.model;
        let limits = &model.problem.limits;
        let costs = &self.costs;
        let Scratch { items, open, order } = &mut self.scratch;

        open.clear();
        let mut rest = 0u64;
        for candidate in 0..costs.count {
            let free = mask >> candidate & 1 == 0 && mask & self.excluded[candidate] == 0;
            if free && costs.possible[candidate] && !model.orphaned[candidate] {
                open.push(candidate);
                rest |= 1 << candidate;
            }
        }
        let home = costs.home(at.node as usize, open);
        let left = [
            limits.time_s - at.time_s - home[TIME] + GRACE * limits.time_s,
            limits.energy_j - at.energy_j - home[ENERGY] + GRACE * limits.energy_j,
            limits.data_mb - at.data_mb + GRACE * limits.data_mb,
            costs.max_neg_ln_r - at.neg_ln_r - home[RISK] + GRACE,
        ];

        items.clear();
        let mut mandatory = (mask & self.mandatory).count_ones();
        let mut gains = 0.0;
        let mut safest = 0.0f64;
        for &candidate in open.iter() {
            let visit = costs.visit(at.node as usize, candidate, rest);
            // A goal that no longer fits alone can never be added.
            if (0..RESOURCES).any(|k| visit.cost[k] > left[k]) {
                continue;
            }
            let goal = &model.problem.candidates[candidate];
            let arrival_s = at.time_s + visit.cost[TIME] - costs.after_s[candidate];
            let late = |close_s: f64| arrival_s > close_s + GRACE * (1.0 + close_s.abs());
            if goal.window.is_some_and(|w| late(w.close_s)) {
                continue;
            }
            let done_s = at.time_s + visit.cost[TIME];
            let freshness = goal.fade.map_or(1.0, |fade| fade.freshness(done_s));
            let reliability = at.reliability * visit.reliability;
            let served = Served { prize: goal.prize, reliability, freshness };
            let [time_s, energy_j, data_mb, neg_ln_r] = visit.cost;
            let charge = model.charge(time_s, energy_j, data_mb, neg_ln_r);
            let gain = (model.objective.gain(served) - charge).max(0.0);
            mandatory += u32::from(goal.mandatory);
            safest = safest.max(visit.reliability);
            gains += gain;
            items.push(Item { gain, cost: visit.cost });
        }
        for (k, &left) in left.iter().enumerate() {
            if left < f64::INFINITY {
                gains = gains.min(fill(items, order, k, left));
            }
        }
        if let Some(ladder) = &self.ladder {
            gains = ladder.below(gains * ROUNDING);
        }
        let charge = model.charge(at.time_s, at.energy_j, at.data_mb, at.neg_ln_r);
        let value = |gain: f64, reliability: f64| model.objective.value(gain, charge, reliability);
        let stay = value(at.gain, at.reliability);
        let go = value(at.gain + gains, at.reliability * safest.min(1.0));
        let bound = stay.max(go);
        // Sums of quantised prizes are exact; everything else is raised a little, whatever its sign.
        let exact = self.ladder.is_some() && bound == at.gain + gains;
        let grains = bound.abs() + at.gain + gains + charge.abs();
        let bound = if exact { bound } else { bound + grains * (ROUNDING - 1.0) };
        Promise { bound, mandatory }
    }

    fn stops(&self, label: u32) -> Vec<Call> {
        let mut stops = Vec::new();
        let mut at = label;
        while self.labels[at as usize].parent != NONE {
            let here = &self.labels[at as usize];
            stops.push(Call {
                candidate: here.candidate as usize,
                node: here.at.node as usize,
                alternative: here.alternative as usize,
            });
            at = here.parent;
        }
        stops.reverse();
        stops
    }
}

// The order of resources: time, energy, data, −ln R.
const TIME: usize = 0;
const ENERGY: usize = 1;
const RISK: usize = 3;
const RESOURCES: usize = 4;

/// What a goal can add at most, and costs at least.
#[derive(Clone, Copy)]
struct Item {
    gain: f64,
    cost: [f64; RESOURCES],
}

/// Memory that every bound needs anew.
#[derive(Default)]
struct Scratch {
    items: Vec<Item>,
    open: Vec<usize>,
    order: Vec<(f64, u32)>,
}

/// The most gain that fits into what is left of one resource, the last item in part.
fn fill(items: &[Item], order: &mut Vec<(f64, u32)>, resource: usize, mut left: f64) -> f64 {
    order.clear();
    let mut whole = 0.0;
    for (index, item) in items.iter().enumerate() {
        whole += item.cost[resource];
        let cost = item.cost[resource];
        order.push((if cost > 0.0 { item.gain / cost } else { f64::INFINITY }, index as u32));
    }
    if whole <= left {
        return items.iter().map(|item| item.gain).sum();
    }
    order.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let mut total = 0.0;
    for &(_, index) in order.iter() {
        let Item { gain, cost } = items[index as usize];
        if cost[resource] > left {
            return total + gain * left / cost[resource];
        }
        total += gain;
        left -= cost[resource];
    }
    total
}

/// The least that visits cost, whatever comes before them.
struct Cheapest {
    count: usize,
    max_neg_ln_r: f64,
    /// Whether some state of the facts allows each candidate.
    possible: Vec<bool>,
    /// Least service of each candidate, per resource.
    service: Vec<[f64; RESOURCES]>,
    /// The part of its least time that passes after the arrival, at most.
    after_s: Vec<f64>,
    /// Least leg from each node to each candidate, per resource, and its reliability.
    from_node: Vec<([f64; RESOURCES], f64)>,
    /// Least leg between candidates, per resource, and its reliability.
    between: Vec<([f64; RESOURCES], f64)>,
    /// For each resource and candidate the candidates to come from, nearest first.
    nearest: Vec<Vec<u8>>,
    /// Least last leg from each node, and from each candidate's poses; nothing where plans end at their last goal.
    home_of_node: Vec<[f64; RESOURCES]>,
    home_of: Vec<[f64; RESOURCES]>,
}

const NO_WAY: [f64; RESOURCES] = [f64::INFINITY, f64::INFINITY, 0.0, f64::INFINITY];

/// A visit at its cheapest.
#[derive(Clone, Copy)]
struct Visit {
    cost: [f64; RESOURCES],
    reliability: f64,
}

fn least(a: [f64; RESOURCES], b: [f64; RESOURCES]) -> [f64; RESOURCES] {
    std::array::from_fn(|k| a[k].min(b[k]))
}

impl Cheapest {
    fn new(model: &mut Model<'_>) -> Self {
        let problem = model.problem;
        let (candidates, travel) = (problem.candidates, problem.travel);
        let count = candidates.len();
        let nodes = travel.nodes().len();
        let legs = |from: usize, to: usize| {
            travel.alternatives(from, to).iter().fold(NO_WAY, |best, leg| {
                least(best, [leg.time_s, leg.energy_j, 0.0, leg.neg_ln_r])
            })
        };
        let safe = |cost: [f64; RESOURCES]| (cost, libm::exp(-cost[RISK]));
        let mut from_node = Vec::with_capacity(nodes * count);
        for node in 0..nodes {
            for candidate in candidates {
                let to = candidate.poses.iter().map(|&pose| legs(node, pose));
                from_node.push(safe(to.fold(NO_WAY, least)));
            }
        }
        let mut between = Vec::with_capacity(count * count);
        for from in candidates {
            for to in 0..count {
                let ways = from.poses.iter().map(|&pose| from_node[pose * count + to].0);
                between.push(safe(ways.fold(NO_WAY, least)));
            }
        }
        let mut nearest = Vec::with_capacity(RESOURCES * count);
        for k in 0..RESOURCES {
            for to in 0..count {
                let cost = |from: u8| between[usize::from(from) * count + to].0[k];
                let mut sources: Vec<u8> =
                    (0..count as u8).filter(|&i| usize::from(i) != to).collect();
                sources.sort_by(|&a, &b| cost(a).total_cmp(&cost(b)).then(a.cmp(&b)));
                nearest.push(sources);
            }
        }
        let home_of_node: Vec<[f64; RESOURCES]> = (0..nodes)
            .map(|node| {
                let ways = problem.ends.iter().map(|&end| legs(node, end));
                if problem.ends.is_empty() { [0.0; RESOURCES] } else { ways.fold(NO_WAY, least) }
            })
            .collect();
        let home_of = candidates
            .iter()
            .map(|c| c.poses.iter().map(|&pose| home_of_node[pose]).fold(NO_WAY, least))
            .collect();
        let services: Vec<Option<_>> =
            candidates.iter().map(|c| model.cheapest_service(c)).collect();
        let service = |index: usize| {
            services[index]
                .map_or([0.0; RESOURCES], |(s, _)| [s.time_s, s.energy_j, s.data_mb, 0.0])
        };
        // A leg's own part of the time before the arrival is in the leg.
        let after = |index: usize| services[index].map_or(0.0, |(s, before_s)| s.time_s - before_s);
        Self {
            count,
            max_neg_ln_r: if model.floor > 0.0 { -libm::log(model.floor) } else { f64::INFINITY },
            possible: services.iter().map(Option::is_some).collect(),
            service: (0..count).map(service).collect(),
            after_s: (0..count).map(after).collect(),
            from_node,
            between,
            nearest,
            home_of_node,
            home_of,
        }
    }

    /// The least that a candidate can cost, coming from a node or from one of the candidates still open.
    fn visit(&self, node: usize, candidate: usize, rest: u64) -> Visit {
        let (mut cost, mut reliability) = self.from_node[node * self.count + candidate];
        for k in [TIME, ENERGY, RISK] {
            let sources = &self.nearest[k * self.count + candidate];
            let Some(&from) = sources.iter().find(|&&from| rest >> from & 1 == 1) else { continue };
            let (leg, safe) = self.between[usize::from(from) * self.count + candidate];
            if leg[k] < cost[k] {
                cost[k] = leg[k];
                if k == RISK {
                    reliability = safe;
                }
            }
        }
        let service = &self.service[candidate];
        Visit { cost: std::array::from_fn(|k| cost[k] + service[k]), reliability }
    }

    /// The least last leg, from a node or from one of the candidates still open.
    fn home(&self, node: usize, open: &[usize]) -> [f64; RESOURCES] {
        open.iter()
            .fold(self.home_of_node[node], |best, &candidate| least(best, self.home_of[candidate]))
    }
}

/// The newest label of each state: an open-addressed table whose order decides nothing, for it is only looked up.
#[derive(Default)]
struct Heads {
    slots: Vec<u32>,
    taken: usize,
}

impl Heads {
    /// Where a state's newest label stands, or would.
    fn slot(&mut self, state: (u64, u32, u32), labels: &[Label]) -> usize {
        if self.slots.len() < 2 * (self.taken + 1) {
            let larger = (2 * self.slots.len()).max(1024);
            let old = std::mem::replace(&mut self.slots, vec![NONE; larger]);
            for label in old.into_iter().filter(|&label| label != NONE) {
                let slot = self.find(labels[label as usize].state(), labels);
                self.slots[slot] = label;
            }
        }
        self.find(state, labels)
    }

    fn find(&self, state: (u64, u32, u32), labels: &[Label]) -> usize {
        let last = self.slots.len() - 1;
        let mut slot = spread(state) as usize & last;
        while self.slots[slot] != NONE && labels[self.slots[slot] as usize].state() != state {
            slot = (slot + 1) & last;
        }
        slot
    }

    fn put(&mut self, slot: usize, label: u32) {
        self.taken += usize::from(self.slots[slot] == NONE);
        self.slots[slot] = label;
    }
}

/// A number that spreads states over a table.
fn spread((mask, facts, node): (u64, u32, u32)) -> u64 {
    let mix =
        |hash: u64, part: u64| (hash.rotate_left(23) ^ part).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    let hash =
        mix(mix(mask.wrapping_mul(0xBF58_476D_1CE4_E5B9), u64::from(facts)), u64::from(node));
    hash ^ hash >> 29
}

/// The plans that no other one beats in both the sum of prizes and the reliability of the whole (PAR).
#[derive(Debug, Clone, PartialEq)]
pub struct PrizeFront {
    /// The plans, largest sum of prizes first; the last is to do nothing, or the safest way to the end.
    pub plans: Vec<GoalSequence>,
    /// Whether these are all. If not, the effort ended first (or there were more than 64 goals), and each plan may be
    /// beaten by one that was not met.
    pub complete: bool,
    /// Labels expanded.
    pub expansions: u64,
}

/// Finds the front of (sum of prizes, reliability) within the limits, whatever the problem's policy: the plans among
/// which a mission chooses how much risk interest is worth (Pareto sets of plans, Ceriotti, Croisard and Vasile 2007).
///
/// Takes up to 64 goals; of more, those with the largest prizes. Mandatory goals are not forced: a front without them
/// shows what they cost. [`Effort::keep`] does not matter.
#[must_use]
pub fn prize_front(problem: &Problem<'_>, effort: Effort<'_>) -> PrizeFront {
    let mut candidates = problem.candidates.to_vec();
    candidates.sort_by(|a, b| b.prize.total_cmp(&a.prize).then(a.goal.cmp(&b.goal)));
    let all = candidates.len() <= MAX_LABELLED;
    candidates.truncate(MAX_LABELLED);
    for candidate in &mut candidates {
        candidate.mandatory = false;
    }
    let asked = Problem { candidates: &candidates, policy: Policy::MostInteresting, ..*problem };
    let mut model = Model::new(asked);
    let named = |id: &GoalId| candidates.iter().position(|c| c.goal == *id);
    let Some(prefix) = effort.first.iter().map(named).collect::<Option<Vec<usize>>>() else {
        return PrizeFront { plans: Vec::new(), complete: all, expansions: 0 };
    };
    let mut search = Search::new(&mut model, &prefix, None);
    search.front = Some(Vec::new());
    let over = || effort.clock.is_some_and(|clock| clock() >= 1.0);
    let until = Until { expansions: effort.expansions, over: &over };
    let Outcome { best, proof, expansions } = search.run(&until, usize::MAX);
    let plans = best.iter().filter_map(|stops| model.sequence(stops)).collect();
    PrizeFront { plans, complete: all && proof == Proof::Proven, expansions }
}
