//! The best ordered sets of goals: exact label search over (goals visited, facts, pose).
//!
//! An orienteering problem whose legs have several costs and whose services depend on the STRIPS facts that
//! earlier goals leave behind. A state keeps a Pareto set of labels over time, energy, data, reliability and
//! value, because with real-valued budgets no single number decides which prefix is better. Labels are
//! taken best bound first, so the search can stop as soon as no open label can beat the best plan found.

use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet, BinaryHeap};

use wisdom_planner::TravelMatrix;

use crate::objective::{Promise, ROUNDING};
use crate::prize::{quantised, quantised_down};
use crate::{Directive, Domain, Expansion, FactSet, GoalId, Policy, ServiceCost};

/// The most goals one exact search takes: the set visited is a bit mask and the states are a table.
pub const MAX_SEQUENCED: usize = 16;

/// A goal as the search sees it.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// Its name.
    pub goal: GoalId,
    /// The directive it follows, by index.
    pub directive: usize,
    /// Its quantised prize.
    pub prize: f64,
    /// The poses from which it can be done: nodes of the travel matrix.
    pub poses: Vec<usize>,
}

/// What is left to spend, and how unsafe a plan may be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Time left, seconds.
    pub time_s: f64,
    /// Energy left above the reserve, joules.
    pub energy_j: f64,
    /// Data volume left, megabytes.
    pub data_mb: f64,
    /// Least reliability of a whole plan, in [0, 1].
    pub min_reliability: f64,
}

/// Everything a search needs. Node 0 of the matrix is where the rover stands.
#[derive(Clone, Copy)]
pub struct Problem<'a> {
    /// The goals, at most [`MAX_SEQUENCED`].
    pub candidates: &'a [Candidate],
    /// Costs between poses.
    pub travel: &'a TravelMatrix,
    /// Facts and operators.
    pub domain: &'a Domain,
    /// The pool.
    pub directives: &'a [Directive],
    /// Facts that hold now.
    pub facts: FactSet,
    /// What is left.
    pub limits: Limits,
    /// The objective.
    pub policy: Policy,
}

/// One goal of a sequence, and how it is served.
#[derive(Debug, Clone, PartialEq)]
pub struct Stop {
    /// The goal.
    pub goal: GoalId,
    /// The pose, as a node of the travel matrix.
    pub pose: usize,
    /// Which alternative of the leg that leads there.
    pub alternative: usize,
    /// The operators before the drive and at the site.
    pub expansion: Expansion,
}

/// An ordered set of goals with its numbers.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct GoalSequence {
    /// The stops in their order.
    pub stops: Vec<Stop>,
    /// Value under the mission's policy.
    pub value: f64,
    /// Sum of the prizes (exact).
    pub prize: f64,
    /// J1 of the sequence, whatever the policy.
    pub expected: f64,
    /// Chance that every leg succeeds.
    pub reliability: f64,
    /// Time of legs and services, seconds.
    pub time_s: f64,
    /// Energy of legs and services, joules.
    pub energy_j: f64,
    /// Data of the services, megabytes.
    pub data_mb: f64,
}

impl GoalSequence {
    /// Doing nothing.
    #[must_use]
    pub fn empty() -> Self {
        Self { reliability: 1.0, ..Self::default() }
    }

    /// The goals in their order.
    pub fn goals(&self) -> impl Iterator<Item = GoalId> + '_ {
        self.stops.iter().map(|s| s.goal)
    }

    /// Better first: value, then reliability, then less time, then smaller ids.
    #[must_use]
    pub fn rank(&self, other: &Self) -> Ordering {
        other
            .value
            .total_cmp(&self.value)
            .then(other.reliability.total_cmp(&self.reliability))
            .then(self.time_s.total_cmp(&other.time_s))
            .then_with(|| self.goals().cmp(other.goals()))
    }
}

/// How good the best sequence is known to be, relative to the goals, poses and leg alternatives given, and
/// to the goals that had to come first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Proof {
    /// No sequence is better.
    Proven,
    /// The expansion limit came first; no sequence has more than this value.
    Bound(f64),
}

/// What a search found.
#[derive(Debug, Clone, PartialEq)]
pub struct Sequences {
    /// The best sequence of each of the best sets met, best first; never empty (the last resort is to do
    /// nothing, also where the goals that had to come first cannot). The first carries the proof; the others
    /// were met on the way and are the best known orders of their sets, not proven ones.
    pub best: Vec<GoalSequence>,
    /// What is known of the first.
    pub proof: Proof,
    /// Labels expanded, in both searches where there were two.
    pub expansions: u64,
}

impl Sequences {
    /// What two searches found together, the first having had all the ways that the second had.
    fn or(self, narrower: Self, keep: usize) -> Self {
        let mut best: Vec<GoalSequence> = Vec::new();
        let mut all = self.best;
        all.extend(narrower.best);
        all.sort_by(GoalSequence::rank);
        for sequence in all {
            let set = |s: &GoalSequence| s.goals().collect::<BTreeSet<_>>();
            if best.len() < keep.max(1) && best.iter().all(|other| set(other) != set(&sequence)) {
                best.push(sequence);
            }
        }
        let proof = match self.proof {
            Proof::Proven => Proof::Proven,
            Proof::Bound(bound) => Proof::Bound(bound.max(best[0].value)),
        };
        Self { best, proof, expansions: self.expansions + narrower.expansions }
    }
}

/// How much work, and what the search must respect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort<'a> {
    /// Labels to expand at most; as many again with the most reliable way of each leg alone, if legs have alternatives
    /// and the search was cut short.
    pub expansions: u64,
    /// How many different sets to keep.
    pub keep: usize,
    /// Goals that must come first, in this order (a commit window, or a whole order to be weighed).
    pub first: &'a [GoalId],
}

/// Searches for the best sequence.
///
/// # Panics
/// If there are more than [`MAX_SEQUENCED`] candidates.
#[must_use]
pub fn sequences(problem: &Problem<'_>, effort: Effort<'_>) -> Sequences {
    assert!(
        problem.candidates.len() <= MAX_SEQUENCED,
        "candidates are cut before they are sequenced"
    );
    let prefix: Option<Vec<usize>> = effort
        .first
        .iter()
        .map(|id| problem.candidates.iter().position(|c| c.goal == *id))
        .collect();
    match prefix {
        Some(prefix) => {
            let found = Search::new(*problem, prefix.clone(), effort).run();
            if found.proof == Proof::Proven || !problem.travel.has_alternatives() {
                return found;
            }
            // Alternatives multiply the labels: a search that was cut short may have met less than it would have
            // without them, and more ways must never lead to a worse plan.
            let travel = problem.travel.most_reliable();
            let narrow = Problem { travel: &travel, ..*problem };
            found.or(Search::new(narrow, prefix, effort).run(), effort.keep)
        }
        None => {
            Sequences { best: vec![GoalSequence::empty()], proof: Proof::Proven, expansions: 0 }
        }
    }
}

/// The best way (poses, operators) to serve the goals in exactly this order, if any is within the limits.
///
/// Looks at 20 000 labels at most; orders of a dozen goals with a few poses each need far fewer.
///
/// # Panics
/// If the order names more than [`MAX_SEQUENCED`] goals.
#[must_use]
pub fn weigh(problem: &Problem<'_>, order: &[GoalId]) -> Option<GoalSequence> {
    const ENOUGH: u64 = 20_000;
    let candidates: Vec<Candidate> = order
        .iter()
        .map(|id| problem.candidates.iter().find(|c| c.goal == *id).cloned())
        .collect::<Option<_>>()?;
    let fixed = Problem { candidates: &candidates, ..*problem };
    let effort = Effort { expansions: ENOUGH, keep: 1, first: order };
    let best = sequences(&fixed, effort).best.swap_remove(0);
    (best.stops.len() == order.len()).then_some(best)
}

/// A prefix of a sequence.
#[derive(Clone, Copy)]
struct Label {
    mask: u32,
    facts: FactSet,
    node: usize,
    time_s: f64,
    energy_j: f64,
    data_mb: f64,
    neg_ln_r: f64,
    reliability: f64,
    value: f64,
    prize: f64,
    expected: f64,
    parent: u32,
    candidate: u32,
    alternative: u32,
    /// The next label of the same state.
    next: u32,
    dead: bool,
}

const NONE: u32 = u32::MAX;

impl Label {
    /// Whether both rank the same but for the order of their goals.
    fn ties(&self, other: &Self) -> bool {
        self.value == other.value && self.neg_ln_r == other.neg_ln_r && self.time_s == other.time_s
    }

    /// Whether nothing that can follow `other` is better than what can follow `self`.
    fn dominates(&self, other: &Self) -> bool {
        self.value >= other.value
            && self.neg_ln_r <= other.neg_ln_r
            && self.time_s <= other.time_s
            && self.energy_j <= other.energy_j
            && self.data_mb <= other.data_mb
    }
}

/// An open label; the heap pops the highest bound, then the more reliable, then the older.
struct Open {
    bound: f64,
    reliability: f64,
    label: u32,
}

impl Ord for Open {
    fn cmp(&self, other: &Self) -> Ordering {
        self.bound
            .total_cmp(&other.bound)
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

/// The least a candidate can cost and the most it can bring, whatever comes before it.
struct Cheapest {
    time_s: f64,
    energy_j: f64,
    data_mb: f64,
    reliability: f64,
}

struct Search<'a> {
    problem: Problem<'a>,
    prefix: Vec<usize>,
    effort: Effort<'a>,
    cheapest: Vec<Cheapest>,
    /// The candidates in the orders that the bounds need.
    plain: [Knapsack; 3],
    reliable: [Knapsack; 3],
    expansions_cache: BTreeMap<(FactSet, usize), Option<(Expansion, ServiceCost)>>,
    labels: Vec<Label>,
    heads: BTreeMap<(u32, FactSet, usize), u32>,
    open: BinaryHeap<Open>,
    /// Best label of each set met: the family is drawn from these.
    best_of_set: BTreeMap<u32, u32>,
    /// Best label found; none until the goals that must come first have been visited.
    incumbent: Option<u32>,
    /// Whether every prize is quantised, so that sums of prizes are exact.
    exact: bool,
}

impl<'a> Search<'a> {
    fn new(problem: Problem<'a>, prefix: Vec<usize>, effort: Effort<'a>) -> Self {
        let services = cheapest_services(&problem);
        let cheapest: Vec<Cheapest> = problem
            .candidates
            .iter()
            .enumerate()
            .map(|(index, candidate)| cheapest_visit(&problem, index, candidate, &services))
            .collect();
        let plain = |i: usize| problem.candidates[i].prize;
        let reliable = |i: usize| problem.candidates[i].prize * cheapest[i].reliability;
        let costs: [fn(&Cheapest) -> f64; 3] = [|c| c.time_s, |c| c.energy_j, |c| c.data_mb];
        let plain = costs.map(|cost| Knapsack::new(&cheapest, plain, cost));
        let reliable = costs.map(|cost| Knapsack::new(&cheapest, reliable, cost));
        let root = Label {
            mask: 0,
            facts: problem.facts,
            node: 0,
            time_s: 0.0,
            energy_j: 0.0,
            data_mb: 0.0,
            neg_ln_r: 0.0,
            reliability: 1.0,
            value: 0.0,
            prize: 0.0,
            expected: 0.0,
            parent: NONE,
            candidate: NONE,
            alternative: 0,
            next: NONE,
            dead: false,
        };
        let exact = problem.candidates.iter().all(|c| c.prize == quantised(c.prize));
        let nothing = prefix.is_empty().then_some(0);
        Self {
            problem,
            prefix,
            effort,
            cheapest,
            plain,
            reliable,
            expansions_cache: BTreeMap::new(),
            labels: vec![root],
            heads: BTreeMap::new(),
            open: BinaryHeap::new(),
            best_of_set: nothing.map(|root| (0, root)).into_iter().collect(),
            incumbent: nothing,
            exact,
        }
    }

    fn run(mut self) -> Sequences {
        self.push_open(0);
        let mut expansions = 0;
        let mut proof = Proof::Proven;
        while let Some(open) = self.open.pop() {
            if !self.may_improve(open.bound, open.reliability) {
                break;
            }
            if self.labels[open.label as usize].dead {
                continue;
            }
            if expansions == self.effort.expansions {
                let found = self.incumbent.map_or(0.0, |best| self.labels[best as usize].value);
                proof = Proof::Bound(open.bound.max(found));
                break;
            }
            expansions += 1;
            self.expand(open.label);
        }
        let mut best: Vec<GoalSequence> = Vec::new();
        let mut sets: Vec<u32> = self.best_of_set.values().copied().collect();
        sets.sort_by(|&a, &b| self.compare(a, b));
        for label in sets.into_iter().take(self.effort.keep.max(1)) {
            best.push(self.sequence(label));
        }
        if best.is_empty() {
            best.push(GoalSequence::empty());
        }
        Sequences { best, proof, expansions }
    }

    /// Better label first, as [`GoalSequence::rank`].
    fn compare(&self, a: u32, b: u32) -> Ordering {
        let (x, y) = (&self.labels[a as usize], &self.labels[b as usize]);
        y.value
            .total_cmp(&x.value)
            .then(y.reliability.total_cmp(&x.reliability))
            .then(x.time_s.total_cmp(&y.time_s))
            .then_with(|| self.goals(x).cmp(&self.goals(y)))
    }

    fn goals(&self, label: &Label) -> Vec<GoalId> {
        let (mut at, mut goals) = (label, Vec::new());
        while at.candidate != NONE {
            goals.push(self.problem.candidates[at.candidate as usize].goal);
            at = &self.labels[at.parent as usize];
        }
        goals.reverse();
        goals
    }

    /// Whether `other` can be forgotten for `label`: it is dominated, and where both rank the same, its goals
    /// do not come in the order of smaller ids.
    fn supersedes(&self, label: &Label, other: &Label) -> bool {
        label.dominates(other) && (!label.ties(other) || self.goals(label) <= self.goals(other))
    }

    /// Whether a label with this bound could still lead to something better than the best found.
    fn may_improve(&self, bound: f64, reliability: f64) -> bool {
        let Some(best) = self.incumbent else { return true };
        let best = &self.labels[best as usize];
        bound > best.value || (bound == best.value && reliability >= best.reliability)
    }

    /// The prefix demands this candidate next, or none in particular.
    fn demanded(&self, label: &Label) -> Option<usize> {
        self.prefix.get(label.mask.count_ones() as usize).copied()
    }

    fn expand(&mut self, index: u32) {
        let label = self.labels[index as usize];
        let demanded = self.demanded(&label);
        for candidate in 0..self.problem.candidates.len() {
            if label.mask >> candidate & 1 == 1 || demanded.is_some_and(|d| d != candidate) {
                continue;
            }
            let directive = self.problem.candidates[candidate].directive;
            let Some((facts, service)) = self.service(label.facts, directive) else { continue };
            for pose in 0..self.problem.candidates[candidate].poses.len() {
                let node = self.problem.candidates[candidate].poses[pose];
                let travel = self.problem.travel;
                for (alternative, leg) in travel.alternatives(label.node, node).iter().enumerate() {
                    let neg_ln_r = label.neg_ln_r + leg.neg_ln_r;
                    let reliability = libm::exp(-neg_ln_r);
                    let prize = self.problem.candidates[candidate].prize;
                    let objective = self.problem.policy.objective();
                    let next = Label {
                        mask: label.mask | 1 << candidate,
                        facts,
                        node,
                        time_s: label.time_s + leg.time_s + service.time_s,
                        energy_j: label.energy_j + leg.energy_j + service.energy_j,
                        data_mb: label.data_mb + service.data_mb,
                        neg_ln_r,
                        reliability,
                        value: objective.extend(label.value, prize, reliability),
                        prize: label.prize + prize,
                        expected: label.expected + prize * reliability,
                        parent: index,
                        candidate: candidate as u32,
                        alternative: alternative as u32,
                        next: NONE,
                        dead: false,
                    };
                    self.offer(next);
                }
            }
        }
    }

    fn service(&mut self, facts: FactSet, directive: usize) -> Option<(FactSet, ServiceCost)> {
        let problem = self.problem;
        self.expansions_cache
            .entry((facts, directive))
            .or_insert_with(|| {
                let wanted = &problem.directives[directive];
                let expansion = facts
                    .contains(wanted.requires)
                    .then(|| problem.domain.expand(facts, wanted.achieves))
                    .flatten()?;
                let cost = expansion.cost;
                Some((expansion, cost))
            })
            .as_ref()
            .map(|(expansion, cost)| (expansion.facts, *cost))
    }

    /// Keeps a label that is within the limits and that no other label of its state dominates.
    fn offer(&mut self, mut label: Label) {
        let limits = &self.problem.limits;
        if label.time_s > limits.time_s
            || label.energy_j > limits.energy_j
            || label.data_mb > limits.data_mb
            || label.reliability < limits.min_reliability
        {
            return;
        }
        let state = (label.mask, label.facts, label.node);
        let head = self.heads.get(&state).copied().unwrap_or(NONE);
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
        label.next = head;
        let index = self.labels.len() as u32;
        self.labels.push(label);
        self.heads.insert(state, index);
        if label.mask.count_ones() as usize >= self.prefix.len() {
            let known = self.best_of_set.get(&label.mask).copied();
            if known.is_none_or(|known| self.compare(index, known).is_lt()) {
                self.best_of_set.insert(label.mask, index);
            }
            if self.incumbent.is_none_or(|best| self.compare(index, best).is_lt()) {
                self.incumbent = Some(index);
            }
        }
        self.push_open(index);
    }

    fn push_open(&mut self, index: u32) {
        let label = self.labels[index as usize];
        let promise = self.promise(&label);
        let bound =
            self.problem.policy.objective().optimistic(label.value, promise, label.reliability);
        if self.may_improve(bound, label.reliability) {
            self.open.push(Open { bound, reliability: label.reliability, label: index });
        }
    }

    /// The most that can still be collected after a label: every goal at its cheapest, the last one in part,
    /// under the tightest of the three budgets (the fractional knapsack bound, Dantzig 1957).
    fn promise(&self, label: &Label) -> Promise {
        // Sums of the same costs in another order differ by rounding; a goal that fits exactly must not be
        // ruled out by that.
        const GRACE: f64 = 1e-9;
        let limits = &self.problem.limits;
        let left = |limit: f64, spent: f64| limit - spent + GRACE * limit;
        let time_s = left(limits.time_s, label.time_s);
        let energy_j = left(limits.energy_j, label.energy_j);
        let data_mb = left(limits.data_mb, label.data_mb);
        // A goal that no longer fits alone can never be added.
        let fits = |index: usize| {
            let cheapest = &self.cheapest[index];
            label.mask >> index & 1 == 0
                && cheapest.time_s.is_finite()
                && cheapest.time_s <= time_s
                && cheapest.energy_j <= energy_j
                && cheapest.data_mb <= data_mb
        };
        let tightest = |[time, energy, data]: &[Knapsack; 3]| {
            time.fill(time_s, fits).min(energy.fill(energy_j, fits)).min(data.fill(data_mb, fits))
        };
        let plain = tightest(&self.plain) * ROUNDING;
        let reliable = tightest(&self.reliable);
        // Sums of quantised prizes lie on the ladder; so does the best that can be reached below the bound.
        let plain = if self.exact { quantised_down(plain) } else { plain };
        Promise { plain, reliable: reliable * ROUNDING }
    }

    fn sequence(&self, label: u32) -> GoalSequence {
        let end = &self.labels[label as usize];
        let mut stops = Vec::new();
        let mut at = label;
        while self.labels[at as usize].parent != NONE {
            let here = &self.labels[at as usize];
            let before = &self.labels[here.parent as usize];
            let candidate = &self.problem.candidates[here.candidate as usize];
            let (expansion, _) = self.expansions_cache[&(before.facts, candidate.directive)]
                .clone()
                .expect("the label was made from this expansion");
            stops.push(Stop {
                goal: candidate.goal,
                pose: here.node,
                alternative: here.alternative as usize,
                expansion,
            });
            at = here.parent;
        }
        stops.reverse();
        GoalSequence {
            stops,
            value: end.value,
            prize: end.prize,
            expected: end.expected,
            reliability: end.reliability,
            time_s: end.time_s,
            energy_j: end.energy_j,
            data_mb: end.data_mb,
        }
    }
}

/// Items of (index, prize, cost), best prize per cost first.
struct Knapsack(Vec<(usize, f64, f64)>);

impl Knapsack {
    fn new(
        cheapest: &[Cheapest],
        prize: impl Fn(usize) -> f64,
        cost: impl Fn(&Cheapest) -> f64,
    ) -> Self {
        let ratio = |&(_, prize, cost): &(usize, f64, f64)| {
            if cost > 0.0 { prize / cost } else { f64::INFINITY }
        };
        let mut items: Vec<_> =
            cheapest.iter().enumerate().map(|(i, c)| (i, prize(i), cost(c))).collect();
        items.sort_by(|a, b| ratio(b).total_cmp(&ratio(a)).then(a.0.cmp(&b.0)));
        Self(items)
    }

    /// The most prize that fits, the last item in part.
    fn fill(&self, mut left: f64, fits: impl Fn(usize) -> bool) -> f64 {
        let mut total = 0.0;
        for &(index, prize, cost) in &self.0 {
            if !fits(index) {
                continue;
            }
            if cost > left {
                return total + prize * left / cost;
            }
            total += prize;
            left -= cost;
        }
        total
    }
}

/// The cheapest leg into any pose of the candidate, from the start or from any pose of another goal, and the
/// cheapest service that any reachable state of the facts allows.
fn cheapest_visit(
    problem: &Problem<'_>,
    index: usize,
    candidate: &Candidate,
    services: &BTreeMap<usize, ServiceCost>,
) -> Cheapest {
    let mut best = Cheapest {
        time_s: f64::INFINITY,
        energy_j: f64::INFINITY,
        data_mb: f64::INFINITY,
        reliability: 0.0,
    };
    let Some(service) = services.get(&candidate.directive) else { return best };
    best.data_mb = service.data_mb;
    let others = problem.candidates.iter().enumerate().filter(|(i, _)| *i != index);
    let sources = std::iter::once(0).chain(others.flat_map(|(_, c)| c.poses.iter().copied()));
    for from in sources {
        for &to in &candidate.poses {
            for leg in problem.travel.alternatives(from, to) {
                best.time_s = best.time_s.min(leg.time_s + service.time_s);
                best.energy_j = best.energy_j.min(leg.energy_j + service.energy_j);
                best.reliability = best.reliability.max(leg.reliability());
            }
        }
    }
    best
}

/// The least time, energy and data (each on its own) that each directive's operators cost in any state
/// of the facts that the directives can lead to; directives that no state allows are left out.
fn cheapest_services(problem: &Problem<'_>) -> BTreeMap<usize, ServiceCost> {
    let wanted: std::collections::BTreeSet<usize> =
        problem.candidates.iter().map(|c| c.directive).collect();
    let mut services: BTreeMap<usize, ServiceCost> = BTreeMap::new();
    let mut known = std::collections::BTreeSet::from([problem.facts]);
    let mut open = vec![problem.facts];
    while let Some(facts) = open.pop() {
        for &index in &wanted {
            let directive = &problem.directives[index];
            if !facts.contains(directive.requires) {
                continue;
            }
            let Some(expansion) = problem.domain.expand(facts, directive.achieves) else {
                continue;
            };
            services
                .entry(index)
                .and_modify(|s| {
                    s.time_s = s.time_s.min(expansion.cost.time_s);
                    s.energy_j = s.energy_j.min(expansion.cost.energy_j);
                    s.data_mb = s.data_mb.min(expansion.cost.data_mb);
                })
                .or_insert(expansion.cost);
            if known.insert(expansion.facts) {
                open.push(expansion.facts);
            }
        }
    }
    services
}
