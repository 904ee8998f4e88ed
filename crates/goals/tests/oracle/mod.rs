//! Plans found and weighed by trying everything, from what the documentation of the types says: the sequencer's searches,
//! bounds and sums are not asked. Only where several series of operators are equally cheap is the domain's choice taken,
//! and then walked through here.

#![allow(dead_code, reason = "each file of tests needs its part")]

use std::collections::BTreeMap;

use wisdom_goals::{
    Candidate, Directive, Domain, End, Expansion, FactSet, Fade, GoalId, GoalSequence, Limits,
    Policy, Preferences, Prices, Problem, ServiceCost, Window, quantised,
};
use wisdom_grid::Cell;
use wisdom_planner::{CostVector, TravelMatrix};

use crate::rover::{directives, domain, names};

pub(crate) const NO_LIMITS: Limits = Limits {
    time_s: f64::INFINITY,
    energy_j: f64::INFINITY,
    data_mb: f64::INFINITY,
    min_reliability: 0.0,
};

/// Everything a problem borrows.
#[derive(Clone)]
pub(crate) struct Instance {
    pub candidates: Vec<Candidate>,
    pub travel: TravelMatrix,
    pub ends: Vec<usize>,
    pub domain: Domain,
    pub directives: Vec<Directive>,
    pub facts: FactSet,
    pub limits: Limits,
    pub waiting_w: f64,
    pub preferences: Preferences,
}

impl Instance {
    /// Goals that the rover of the tests can do, anywhere, at any time, at any price.
    pub(crate) fn new(candidates: Vec<Candidate>, travel: TravelMatrix) -> Self {
        let domain = domain();
        Self {
            candidates,
            travel,
            ends: Vec::new(),
            directives: directives(&domain),
            facts: domain.initial(),
            domain,
            limits: NO_LIMITS,
            waiting_w: 0.0,
            preferences: Preferences::default(),
        }
    }

    pub(crate) fn problem(&self, policy: Policy) -> Problem<'_> {
        Problem {
            candidates: &self.candidates,
            travel: &self.travel,
            ends: &self.ends,
            domain: &self.domain,
            directives: &self.directives,
            facts: self.facts,
            limits: self.limits,
            waiting_w: self.waiting_w,
            policy,
            preferences: self.preferences,
        }
    }

    /// The same with other legs.
    pub(crate) fn with_legs(&self, change: impl Fn(&CostVector) -> CostVector) -> Self {
        let travel = TravelMatrix::from_costs(self.travel.nodes(), |from, to| {
            self.travel.alternatives(from, to).iter().map(&change).collect()
        });
        Self { travel, ..self.clone() }
    }
}

/// `SplitMix64` (Steele, Lea and Flood 2014): instances from one number.
pub(crate) struct Draws(pub u64);

impl Draws {
    pub(crate) fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ z >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ z >> 31) >> 11) as f64 / (1u64 << 53) as f64
    }

    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    pub(crate) fn below(&mut self, count: usize) -> usize {
        (self.unit() * count as f64) as usize
    }

    pub(crate) fn happens(&mut self, chance: f64) -> bool {
        self.unit() < chance
    }

    /// One of a few.
    pub(crate) fn of<T: Copy>(&mut self, few: &[T]) -> T {
        few[self.below(few.len())]
    }
}

pub(crate) fn nodes(count: usize) -> Vec<Cell> {
    (0..count).map(|col| Cell::new(0, col)).collect()
}

/// Goals of all directives that share some poses; up to `alternatives` a leg, none for some; costs of a few values (so
/// that much is equal) or of many; in most instances some goals with a window, a fading prize, work of their own,
/// another goal before or instead of them, or no choice; some with places to end at; limits from hopeless to ample for up
/// to `hold` goals, and prices to match.
pub(crate) fn drawn(
    goals: usize,
    poses: usize,
    alternatives: usize,
    hold: usize,
    seed: u64,
) -> Instance {
    let mut draws = Draws(seed);
    let ends = draws.of(&[0, 0, 1, 2]);
    let count = 1 + goals * poses + ends;
    let coarse = draws.happens(0.5);
    let safe = draws.happens(0.1);
    let cost = move |draws: &mut Draws, unit: f64| {
        let share = draws.unit();
        unit * if coarse { 1.0 + (3.0 * share).floor() } else { 0.5 + 3.0 * share }
    };
    let travel = TravelMatrix::from_costs(&nodes(count), |from, to| {
        if from == to {
            return vec![CostVector::ZERO];
        }
        let ways = if draws.happens(0.1) { 0 } else { 1 + draws.below(alternatives) };
        (0..ways)
            .map(|_| CostVector {
                length_m: 1.0,
                time_s: cost(&mut draws, 200.0),
                energy_j: cost(&mut draws, 10_000.0),
                neg_ln_r: if safe { 0.0 } else { cost(&mut draws, 0.0625) },
            })
            .collect()
    });
    let plain = draws.happens(0.25);
    let mut candidates: Vec<Candidate> = (0..goals)
        .map(|g| {
            let prize = if coarse { 0.25 * draws.below(4) as f64 } else { draws.unit() };
            let poses = (0..poses).map(|_| 1 + draws.below(count - 1)).collect();
            // Ids run against the order of the candidates, so that the two cannot be mixed up unnoticed.
            Candidate::new(GoalId(100 - g as u32), draws.below(3), quantised(prize), poses)
        })
        .collect();
    let span_s = 600.0 * hold as f64;
    let special = if plain { 0 } else { goals };
    for candidate in &mut candidates[..special] {
        let mut other = || GoalId(100 - draws.below(goals) as u32);
        let (before, beside) = (other(), other());
        if draws.happens(0.25) {
            candidate.service = ServiceCost {
                time_s: cost(&mut draws, 50.0),
                energy_j: cost(&mut draws, 3000.0),
                data_mb: cost(&mut draws, 5.0),
            };
        }
        if draws.happens(0.3) {
            let open_s = draws.between(-0.2, 0.6) * span_s;
            candidate.window = Some(Window { open_s, close_s: open_s + draws.unit() * span_s });
        }
        if draws.happens(0.5) {
            let full_until_s = draws.between(0.0, 0.5) * span_s;
            let fading_s = draws.of(&[0.0, 0.3, 1.0]) * span_s;
            candidate.fade = Some(Fade { full_until_s, nothing_from_s: full_until_s + fading_s });
        }
        candidate.mandatory = draws.happens(0.12);
        if draws.happens(0.12) && before != candidate.goal {
            candidate.after.push(before);
        }
        if draws.happens(0.15) && beside != candidate.goal {
            candidate.excludes.push(beside);
        }
    }
    let mut instance = Instance::new(candidates, travel);
    let facts = [names(&["stowed"]), names(&["out"]), names(&["stowed", "lit", "imaged"])];
    instance.facts =
        instance.domain.set(&facts[draws.below(3)]).expect("the domain has these facts");
    instance.ends = (count - ends..count).collect();
    if ends == 2 {
        // To where it came from, or to another place.
        instance.ends[0] = 0;
    }
    let each = hold as f64;
    let mut share = |all: f64| if draws.happens(0.2) { f64::INFINITY } else { draws.unit() * all };
    instance.limits = Limits {
        time_s: share(1200.0 * each),
        energy_j: share(80_000.0 * each),
        data_mb: share(60.0 * each),
        min_reliability: 0.0,
    };
    if hold < goals {
        instance.limits.time_s = draws.between(0.3, 1.0) * 500.0 * each;
    }
    instance.limits.min_reliability = draws.of(&[0.0, 0.5, 0.7]);
    instance.waiting_w = draws.of(&[0.0, 0.0, 5.0, 50.0]);
    let mut price = |most: f64| if draws.happens(0.3) { 0.0 } else { draws.unit() * most };
    instance.preferences = Preferences {
        prices: Prices {
            risk: price(1.5),
            energy_per_j: price(1e-5),
            time_per_s: price(3e-4),
            data_per_mb: price(5e-3),
        },
        confidence: draws.of(&[0.0, 0.5, 0.8, 0.9]),
    };
    instance
}

/// What a directive's operators do and take in some state of the facts.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Service {
    facts: FactSet,
    cost: ServiceCost,
    /// Until the rover has arrived.
    before_s: f64,
}

/// The operators of every goal by trying all short series of operators.
#[derive(Default)]
struct Services(BTreeMap<(FactSet, usize), Option<Service>>);

impl Services {
    fn of(&mut self, problem: &Problem<'_>, facts: FactSet, directive: usize) -> Option<Service> {
        *self.0.entry((facts, directive)).or_insert_with(|| {
            let Directive { requires, achieves, .. } = problem.directives[directive];
            let mut best = None;
            if facts.contains(requires) {
                try_operators(problem.domain, achieves, facts, false, &mut Vec::new(), &mut best);
            }
            let (_, after, cost) = best?;
            let chosen = problem.domain.expand(facts, achieves).expect("operators were found");
            let before_s = walk_operators(problem.domain, achieves, facts, &chosen);
            assert_eq!((chosen.facts, chosen.cost), (after, cost), "not the cheapest operators");
            Some(Service { facts: after, cost, before_s })
        })
    }
}

fn try_operators(
    domain: &Domain,
    wanted: FactSet,
    facts: FactSet,
    driven: bool,
    done: &mut Vec<usize>,
    best: &mut Option<(f64, FactSet, ServiceCost)>,
) {
    if driven && facts.contains(wanted) {
        let mut cost = ServiceCost::default();
        for &index in done.iter() {
            cost += domain.operators()[index].cost;
        }
        // By time, then by the number of operators: a thousandth of a second each.
        let rank = cost.time_s + 0.001 * done.len() as f64;
        if best.is_none_or(|(least, _, _)| rank < least) {
            *best = Some((rank, facts, cost));
        }
        return;
    }
    if done.len() == 6 {
        return;
    }
    for (index, operator) in domain.operators().iter().enumerate() {
        let drives = operator.name == "drive";
        if !facts.contains(operator.preconditions) || drives && driven {
            continue;
        }
        let after = facts.without(operator.deletes).with(operator.adds);
        let after = if drives { after.without(wanted) } else { after };
        done.push(index);
        try_operators(domain, wanted, after, driven || drives, done, best);
        done.pop();
    }
}

/// Steps through the operators of an expansion, checks what it says of them, and gives the time until the arrival.
fn walk_operators(domain: &Domain, wanted: FactSet, facts: FactSet, told: &Expansion) -> f64 {
    let drive = domain.operators().iter().position(|o| o.name == "drive").expect("rovers drive");
    let (mut facts, mut cost, mut before_s) = (facts, ServiceCost::default(), 0.0);
    for &index in told.before.iter().chain([&drive]).chain(&told.after) {
        let operator = &domain.operators()[index];
        assert!(facts.contains(operator.preconditions), "{} is not possible", operator.name);
        facts = facts.without(operator.deletes).with(operator.adds);
        cost += operator.cost;
        if index == drive {
            facts = facts.without(wanted);
            before_s = cost.time_s;
        }
    }
    assert!(facts.contains(wanted), "the operators do not bring about the goal");
    assert_eq!((told.facts, told.cost), (facts, cost));
    before_s
}

/// A plan as trying everything knows it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Tried {
    pub goals: Vec<GoalId>,
    pub end: Option<End>,
    pub missed: usize,
    pub value: f64,
    pub prize: f64,
    pub fresh: f64,
    pub expected: f64,
    pub neg_ln_r: f64,
    pub reliability: f64,
    pub time_s: f64,
    pub energy_j: f64,
    pub data_mb: f64,
}

impl Tried {
    /// Better first, as the documentation of a goal sequence says.
    pub(crate) fn better_than(&self, other: &Self) -> bool {
        let key = |t: &Self| (-(t.missed as f64), t.value, t.reliability, -t.time_s);
        key(self) > key(other) || key(self) == key(other) && self.goals < other.goals
    }
}

/// The six formulas.
fn value(problem: &Problem<'_>, plan: &Tried) -> f64 {
    let Prices { risk, energy_per_j, time_per_s, data_per_mb } = problem.preferences.prices;
    let net = risk * plan.neg_ln_r + energy_per_j * plan.energy_j;
    match problem.policy {
        Policy::ExpectedInterest => plan.expected,
        Policy::MostInteresting | Policy::ChanceConstrained => plan.prize,
        Policy::AllOrNothing => plan.prize * plan.reliability,
        Policy::NetBenefit => plan.prize - net,
        Policy::Utility => {
            plan.fresh - (net + time_per_s * plan.time_s + data_per_mb * plan.data_mb)
        }
        other => panic!("{other} has no formula here"),
    }
}

/// Least reliability of a whole plan.
fn floor(problem: &Problem<'_>) -> f64 {
    match problem.policy {
        Policy::ChanceConstrained => {
            problem.limits.min_reliability.max(problem.preferences.confidence)
        }
        _ => problem.limits.min_reliability,
    }
}

fn chance(neg_ln_r: f64) -> f64 {
    CostVector { neg_ln_r, ..CostVector::ZERO }.reliability()
}

/// How far a plan has come.
#[derive(Debug, Clone, Copy)]
struct Standing {
    facts: FactSet,
    node: usize,
    time_s: f64,
    energy_j: f64,
    data_mb: f64,
    neg_ln_r: f64,
    prize: f64,
    fresh: f64,
    expected: f64,
    /// Waiting for the last goal's window.
    wait_s: f64,
}

impl Standing {
    fn start(problem: &Problem<'_>) -> Self {
        Self {
            facts: problem.facts,
            node: 0,
            time_s: 0.0,
            energy_j: 0.0,
            data_mb: 0.0,
            neg_ln_r: 0.0,
            prize: 0.0,
            fresh: 0.0,
            expected: 0.0,
            wait_s: 0.0,
        }
    }

    /// One leg and one goal further; none if its window has closed.
    fn serve(
        &self,
        problem: &Problem<'_>,
        goal: &Candidate,
        pose: usize,
        leg: &CostVector,
        service: Service,
    ) -> Option<Self> {
        let mut cost = service.cost;
        cost += goal.service;
        // Added in the order of the search: budgets may fit to the last bit.
        let mut time_s = self.time_s + leg.time_s + cost.time_s;
        let mut energy_j = self.energy_j + leg.energy_j + cost.energy_j;
        let mut wait_s = 0.0;
        if let Some(Window { open_s, close_s }) = goal.window {
            let arrival_s = self.time_s + leg.time_s + service.before_s;
            if arrival_s.max(open_s) > close_s {
                return None;
            }
            if arrival_s < open_s {
                wait_s = open_s - arrival_s;
                energy_j += problem.waiting_w * wait_s;
                time_s = open_s + (cost.time_s - service.before_s);
            }
        }
        let neg_ln_r = self.neg_ln_r + leg.neg_ln_r;
        let freshness = match goal.fade {
            None => 1.0,
            Some(fade) if time_s <= fade.full_until_s => 1.0,
            Some(fade) if time_s >= fade.nothing_from_s => 0.0,
            Some(Fade { full_until_s, nothing_from_s }) => {
                (nothing_from_s - time_s) / (nothing_from_s - full_until_s)
            }
        };
        Some(Self {
            facts: service.facts,
            node: pose,
            time_s,
            energy_j,
            data_mb: self.data_mb + cost.data_mb,
            neg_ln_r,
            prize: self.prize + goal.prize,
            fresh: self.fresh + goal.prize * freshness,
            expected: self.expected + goal.prize * chance(neg_ln_r),
            wait_s,
        })
    }

    fn ended(mut self, leg: &CostVector) -> Self {
        self.time_s += leg.time_s;
        self.energy_j += leg.energy_j;
        self.neg_ln_r += leg.neg_ln_r;
        self
    }

    fn within(&self, limits: &Limits, floor: f64) -> bool {
        self.time_s <= limits.time_s
            && self.energy_j <= limits.energy_j
            && self.data_mb <= limits.data_mb
            && chance(self.neg_ln_r) >= floor
    }

    /// As a whole plan.
    fn tell(&self, problem: &Problem<'_>, end: Option<End>, plan: &mut Tried) {
        plan.end = end;
        let missing = |c: &&Candidate| c.mandatory && !plan.goals.contains(&c.goal);
        plan.missed = problem.candidates.iter().filter(missing).count();
        plan.prize = self.prize;
        plan.fresh = self.fresh;
        plan.expected = self.expected;
        plan.neg_ln_r = self.neg_ln_r;
        plan.reliability = chance(self.neg_ln_r);
        plan.time_s = self.time_s;
        plan.energy_j = self.energy_j;
        plan.data_mb = self.data_mb;
        plan.value = value(problem, plan);
    }
}

fn nothing() -> Tried {
    Tried {
        goals: Vec::new(),
        end: None,
        missed: 0,
        value: 0.0,
        prize: 0.0,
        fresh: 0.0,
        expected: 0.0,
        neg_ln_r: 0.0,
        reliability: 1.0,
        time_s: 0.0,
        energy_j: 0.0,
        data_mb: 0.0,
    }
}

/// Whether a goal may follow these.
fn may_follow(problem: &Problem<'_>, done: &[GoalId], goal: &Candidate) -> bool {
    let beside = |c: &Candidate| {
        done.contains(&c.goal)
            && (c.excludes.contains(&goal.goal) || goal.excludes.contains(&c.goal))
    };
    !done.contains(&goal.goal)
        && goal.after.iter().all(|before| done.contains(before))
        && !problem.candidates.iter().any(beside)
}

/// All plans within the limits: every subset in every order, through every pose and leg, to every end.
pub(crate) fn all_plans(problem: &Problem<'_>, visit: &mut impl FnMut(&Tried)) {
    let mut trial = Trial {
        problem,
        services: Services::default(),
        floor: floor(problem),
        plan: nothing(),
        visit,
    };
    trial.extend(&Standing::start(problem));
}

struct Trial<'t, 'a, F> {
    problem: &'t Problem<'a>,
    services: Services,
    floor: f64,
    plan: Tried,
    visit: &'t mut F,
}

impl<F: FnMut(&Tried)> Trial<'_, '_, F> {
    fn extend(&mut self, at: &Standing) {
        let problem = self.problem;
        if !at.within(&problem.limits, self.floor) {
            return;
        }
        self.end(at);
        for goal in problem.candidates {
            if !may_follow(problem, &self.plan.goals, goal) {
                continue;
            }
            let Some(service) = self.services.of(problem, at.facts, goal.directive) else {
                continue;
            };
            self.plan.goals.push(goal.goal);
            for &pose in &goal.poses {
                for leg in problem.travel.alternatives(at.node, pose) {
                    if let Some(next) = at.serve(problem, goal, pose, leg, service) {
                        self.extend(&next);
                    }
                }
            }
            self.plan.goals.pop();
        }
    }

    fn end(&mut self, at: &Standing) {
        let problem = self.problem;
        if problem.ends.is_empty() {
            at.tell(problem, None, &mut self.plan);
            (self.visit)(&self.plan);
        }
        for &pose in problem.ends {
            for (alternative, leg) in problem.travel.alternatives(at.node, pose).iter().enumerate()
            {
                let ended = at.ended(leg);
                if ended.within(&problem.limits, self.floor) {
                    ended.tell(problem, Some(End { pose, alternative }), &mut self.plan);
                    (self.visit)(&self.plan);
                }
            }
        }
    }
}

/// The best of all plans that are wanted, if there are any.
pub(crate) fn best_plan(problem: &Problem<'_>, wanted: impl Fn(&Tried) -> bool) -> Option<Tried> {
    let mut best: Option<Tried> = None;
    all_plans(problem, &mut |plan| {
        if wanted(plan) && best.as_ref().is_none_or(|b| plan.better_than(b)) {
            best = Some(plan.clone());
        }
    });
    best
}

/// Sums of costs in another order of addition.
pub(crate) fn close(a: f64, b: f64) -> bool {
    a == b || (a - b).abs() <= 1e-9 * (1.0 + a.abs())
}

/// Values of plans that are the same but for the order of addition.
pub(crate) fn same_value(policy: Policy, a: f64, b: f64) -> bool {
    match policy {
        Policy::MostInteresting | Policy::ChanceConstrained => a == b,
        // Prizes and charges of a handful of goals are of the order of one.
        _ => (a - b).abs() <= 1e-12 * a.abs().max(1.0),
    }
}

/// Doing nothing, told where not even that can end where plans must.
pub(crate) fn stranded(problem: &Problem<'_>) -> GoalSequence {
    let missed = problem.candidates.iter().filter(|c| c.mandatory).count();
    GoalSequence { missed, ..GoalSequence::empty() }
}

/// Whether this is the last resort: no plan at all was found.
pub(crate) fn is_stranded(problem: &Problem<'_>, told: &GoalSequence) -> bool {
    !problem.ends.is_empty() && told.end.is_none()
}

/// Walks through a sequence once more; it must be possible and all its numbers must be right.
pub(crate) fn checked(problem: &Problem<'_>, told: &GoalSequence) -> Tried {
    let (mut at, mut plan) = (Standing::start(problem), nothing());
    let floor = floor(problem);
    for stop in &told.stops {
        let goal = problem.candidates.iter().find(|c| c.goal == stop.goal);
        let goal = goal.expect("stops are candidates");
        assert!(goal.poses.contains(&stop.pose), "{} has no such pose", goal.goal);
        assert!(may_follow(problem, &plan.goals, goal), "{} may not follow {plan:?}", goal.goal);
        let Directive { requires, achieves, .. } = problem.directives[goal.directive];
        assert!(at.facts.contains(requires), "{} is not ready", goal.goal);
        let before_s = walk_operators(problem.domain, achieves, at.facts, &stop.expansion);
        let Expansion { facts, cost, .. } = stop.expansion;
        let service = Service { facts, cost, before_s };
        let leg = problem.travel.alternatives(at.node, stop.pose)[stop.alternative];
        let next = at.serve(problem, goal, stop.pose, &leg, service).expect("its window is open");
        assert!(next.within(&problem.limits, floor), "over a limit: {told:?}");
        for (name, told, found) in [
            ("waiting", stop.wait_s, next.wait_s),
            ("service time", stop.service.time_s, next.time_s - at.time_s - leg.time_s),
            ("service energy", stop.service.energy_j, next.energy_j - at.energy_j - leg.energy_j),
            ("service data", stop.service.data_mb, next.data_mb - at.data_mb),
        ] {
            // Differences of sums of this size.
            let off = 1e-9 * (1.0 + next.time_s.abs() + next.energy_j.abs() + next.data_mb.abs());
            assert!((told - found).abs() <= off, "{name}: {told} is told, {found} is found");
        }
        plan.goals.push(goal.goal);
        at = next;
    }
    if is_stranded(problem, told) {
        assert_eq!(*told, stranded(problem), "only doing nothing may end nowhere");
        at.tell(problem, None, &mut plan);
        return plan;
    }
    if let Some(End { pose, alternative }) = told.end {
        assert!(problem.ends.contains(&pose), "plans may not end there");
        at = at.ended(&problem.travel.alternatives(at.node, pose)[alternative]);
    }
    assert!(at.within(&problem.limits, floor), "over a limit: {told:?}");
    at.tell(problem, told.end, &mut plan);
    assert_eq!(told.missed, plan.missed);
    for (name, told, found) in [
        ("value", told.value, plan.value),
        ("prize", told.prize, plan.prize),
        ("fresh", told.fresh, plan.fresh),
        ("expected", told.expected, plan.expected),
        ("reliability", told.reliability, plan.reliability),
        ("time", told.time_s, plan.time_s),
        ("energy", told.energy_j, plan.energy_j),
        ("data", told.data_mb, plan.data_mb),
    ] {
        assert!(close(told, found), "{name}: {told} is told, {found} is found");
    }
    plan
}
