//! The label search finds what trying everything finds.

mod rover;

use std::collections::BTreeMap;

use proptest::prelude::*;
use wisdom_goals::{
    Candidate, Directive, Domain, Effort, FactSet, GoalId, GoalSequence, Limits, Policy, Problem,
    Proof, Sequences, ServiceCost, quantised, sequences, weigh,
};
use wisdom_grid::{Cell, GridSpec, Raster};
use wisdom_planner::{CostVector, TravelMatrix};

use rover::{directives, domain, ground, names, travel};

const NO_LIMITS: Limits = Limits {
    time_s: f64::INFINITY,
    energy_j: f64::INFINITY,
    data_mb: f64::INFINITY,
    min_reliability: 0.0,
};

/// Enough for every instance here.
fn thorough() -> Effort<'static> {
    Effort { expansions: 10_000_000, keep: 5, first: &[] }
}

/// Everything a problem borrows.
struct Instance {
    candidates: Vec<Candidate>,
    travel: TravelMatrix,
    domain: Domain,
    directives: Vec<Directive>,
    facts: FactSet,
    limits: Limits,
}

impl Instance {
    fn problem(&self, policy: Policy) -> Problem<'_> {
        Problem {
            candidates: &self.candidates,
            travel: &self.travel,
            domain: &self.domain,
            directives: &self.directives,
            facts: self.facts,
            limits: self.limits,
            policy,
        }
    }
}

/// `SplitMix64` (Steele, Lea and Flood 2014): instances from one number.
struct Draws(u64);

impl Draws {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ z >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ z >> 31) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    fn below(&mut self, count: usize) -> usize {
        (self.unit() * count as f64) as usize
    }
}

/// Hilly, hazardous ground with some rocks; goals of all directives; each limit anywhere from hopeless to ample.
fn instance(goals: usize, poses: usize, seed: u64) -> Instance {
    let mut draws = Draws(seed);
    let spec = GridSpec::new(9, 9, 1.0).expect("a small grid");
    let tallest = [0.05, 0.15, 0.3][draws.below(3)];
    let heights = Raster::from_fn(spec, |_| draws.between(0.0, tallest) as f32);
    let worst = [0.003, 0.03, 0.1][draws.below(3)];
    let hazard = Raster::from_fn(spec, |_| draws.between(0.0005, worst) as f32);
    let blocked = Raster::from_fn(spec, |_| draws.unit() < 0.12);
    let ground = ground(heights, hazard, blocked);
    let cells: Vec<Cell> =
        (0..=goals * poses).map(|_| spec.cell(draws.below(spec.len()))).collect();
    let domain = domain();
    let directives = directives(&domain);
    // Ids run against the order of the candidates, so that the two cannot be mixed up unnoticed.
    let candidates = (0..goals)
        .map(|g| Candidate {
            goal: GoalId(100 - g as u32),
            directive: draws.below(directives.len()),
            prize: quantised(draws.between(0.05, 1.0)),
            poses: (0..poses).map(|p| 1 + g * poses + p).collect(),
        })
        .collect();
    let facts = [names(&["stowed"]), names(&["out"]), names(&["stowed", "lit", "imaged"])];
    let facts = domain.set(&facts[draws.below(3)]).expect("the domain has these facts");
    let each = goals as f64;
    let mut share = |all: f64| if draws.unit() < 0.2 { f64::INFINITY } else { draws.unit() * all };
    let limits = Limits {
        time_s: share(700.0 * each),
        energy_j: share(60_000.0 * each),
        data_mb: share(50.0 * each),
        min_reliability: [0.0, 0.5, 0.8][draws.below(3)],
    };
    Instance { travel: travel(&ground, &cells), candidates, domain, directives, facts, limits }
}

/// How an instance was drawn, for the report of a failure.
#[derive(Debug, Clone, Copy)]
struct Drawn {
    goals: usize,
    poses: usize,
    seed: u64,
}

impl Drawn {
    fn instance(self) -> Instance {
        instance(self.goals, self.poses, self.seed)
    }
}

fn any_instance() -> impl Strategy<Value = Drawn> {
    let size =
        prop_oneof![(1usize..=4, 1usize..=2), (5usize..=5, 1usize..=2), (6usize..=7, 1usize..=1)];
    (size, any::<u64>()).prop_map(|((goals, poses), seed)| Drawn { goals, poses, seed })
}

fn any_policy() -> impl Strategy<Value = Policy> {
    prop::sample::select(&Policy::ALL[..])
}

/// The operators of every goal by trying all short sequences of operators: facts afterwards and costs.
struct Services(BTreeMap<(FactSet, usize), Option<(FactSet, ServiceCost)>>);

impl Services {
    fn of(
        &mut self,
        problem: &Problem<'_>,
        facts: FactSet,
        directive: usize,
    ) -> Option<(FactSet, ServiceCost)> {
        *self.0.entry((facts, directive)).or_insert_with(|| {
            let Directive { requires, achieves, .. } = problem.directives[directive];
            let mut best = None;
            if facts.contains(requires) {
                try_operators(problem.domain, achieves, facts, false, &mut Vec::new(), &mut best);
            }
            best.map(|(_, facts, cost)| (facts, cost))
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
        // A thousandth of a second an operator, as the expansion counts.
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

/// A plan as the brute force knows it.
#[derive(Debug, Clone, PartialEq)]
struct Tried {
    goals: Vec<GoalId>,
    value: f64,
    prize: f64,
    expected: f64,
    reliability: f64,
    time_s: f64,
    energy_j: f64,
    data_mb: f64,
}

impl Tried {
    /// Better first, as the documentation of a goal sequence says.
    fn better_than(&self, other: &Self) -> bool {
        let key = |t: &Self| (t.value, t.reliability, -t.time_s);
        key(self) > key(other) || key(self) == key(other) && self.goals < other.goals
    }
}

/// All plans within the limits: every subset in every order, through every pose and leg.
fn all_plans(problem: &Problem<'_>, mut visit: impl FnMut(&Tried)) {
    let nothing = Tried {
        goals: Vec::new(),
        value: 0.0,
        prize: 0.0,
        expected: 0.0,
        reliability: 1.0,
        time_s: 0.0,
        energy_j: 0.0,
        data_mb: 0.0,
    };
    let mut services = Services(BTreeMap::new());
    extend(problem, &mut services, &nothing, (problem.facts, 0, 0.0), &mut visit);
}

fn extend(
    problem: &Problem<'_>,
    services: &mut Services,
    so_far: &Tried,
    (facts, node, neg_ln_r): (FactSet, usize, f64),
    visit: &mut impl FnMut(&Tried),
) {
    visit(so_far);
    for candidate in problem.candidates.iter().filter(|c| !so_far.goals.contains(&c.goal)) {
        let Some((after, service)) = services.of(problem, facts, candidate.directive) else {
            continue;
        };
        for &pose in &candidate.poses {
            for leg in problem.travel.alternatives(node, pose) {
                let neg_ln_r = neg_ln_r + leg.neg_ln_r;
                let reliability = CostVector { neg_ln_r, ..CostVector::ZERO }.reliability();
                let mut next = so_far.clone();
                next.goals.push(candidate.goal);
                next.prize += candidate.prize;
                next.expected += candidate.prize * reliability;
                next.value = match problem.policy {
                    Policy::ExpectedInterest => next.expected,
                    _ => next.prize,
                };
                next.reliability = reliability;
                // Added in the order of the search: budgets may fit to the last bit.
                next.time_s = next.time_s + leg.time_s + service.time_s;
                next.energy_j = next.energy_j + leg.energy_j + service.energy_j;
                next.data_mb += service.data_mb;
                let limits = &problem.limits;
                if next.time_s <= limits.time_s
                    && next.energy_j <= limits.energy_j
                    && next.data_mb <= limits.data_mb
                    && reliability >= limits.min_reliability
                {
                    extend(problem, services, &next, (after, pose, neg_ln_r), visit);
                }
            }
        }
    }
}

fn best_plan(problem: &Problem<'_>, wanted: impl Fn(&Tried) -> bool) -> Option<Tried> {
    let mut best: Option<Tried> = None;
    all_plans(problem, |plan| {
        if wanted(plan) && best.as_ref().is_none_or(|b| plan.better_than(b)) {
            best = Some(plan.clone());
        }
    });
    best
}

/// Sums of costs in another order of addition.
fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-9 * (1.0 + a.abs())
}

/// The numbers of a sequence, by walking through its stops once more.
fn walked(problem: &Problem<'_>, sequence: &GoalSequence) -> Tried {
    let mut services = Services(BTreeMap::new());
    let (mut facts, mut node, mut legs) = (problem.facts, 0, CostVector::ZERO);
    let mut told = Tried {
        goals: sequence.goals().collect(),
        value: sequence.value,
        prize: 0.0,
        expected: 0.0,
        reliability: 1.0,
        time_s: 0.0,
        energy_j: 0.0,
        data_mb: 0.0,
    };
    for stop in &sequence.stops {
        let candidate = problem.candidates.iter().find(|c| c.goal == stop.goal);
        let candidate = candidate.expect("stops are candidates");
        assert!(candidate.poses.contains(&stop.pose), "a pose of another goal");
        legs += problem.travel.alternatives(node, stop.pose)[stop.alternative];
        let (after, service) =
            services.of(problem, facts, candidate.directive).expect("the goal can be done here");
        assert_eq!(stop.expansion.cost, service);
        assert_eq!(stop.expansion.facts, after);
        told.time_s += service.time_s;
        told.energy_j += service.energy_j;
        told.data_mb += service.data_mb;
        told.prize += candidate.prize;
        told.expected += candidate.prize * legs.reliability();
        (facts, node) = (after, stop.pose);
    }
    told.reliability = legs.reliability();
    told.time_s += legs.time_s;
    told.energy_j += legs.energy_j;
    told
}

fn check_numbers(problem: &Problem<'_>, sequence: &GoalSequence) {
    let walked = walked(problem, sequence);
    let value = match problem.policy {
        Policy::ExpectedInterest => walked.expected,
        _ => walked.prize,
    };
    for (told, found) in [
        (sequence.value, value),
        (sequence.prize, walked.prize),
        (sequence.expected, walked.expected),
        (sequence.reliability, walked.reliability),
        (sequence.time_s, walked.time_s),
        (sequence.energy_j, walked.energy_j),
        (sequence.data_mb, walked.data_mb),
    ] {
        assert!(close(told, found), "{told} is told, {found} is found: {sequence:?}");
    }
    assert!(sequence.time_s <= problem.limits.time_s);
    assert!(sequence.energy_j <= problem.limits.energy_j);
    assert!(sequence.data_mb <= problem.limits.data_mb);
    assert!(sequence.reliability >= problem.limits.min_reliability);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(384))]

    /// Value to the last bit; under LEX the reliability too.
    #[test]
    fn the_search_equals_brute_force(drawn in any_instance(), policy in any_policy()) {
        let instance = drawn.instance();
        let problem = instance.problem(policy);
        let Sequences { best, proof, .. } = sequences(&problem, thorough());
        let brute = best_plan(&problem, |_| true).expect("doing nothing is always possible");
        prop_assert_eq!(proof, Proof::Proven);
        prop_assert_eq!(best[0].value, brute.value, "{:?}", brute.goals);
        if policy == Policy::MostInteresting {
            prop_assert_eq!(best[0].reliability, brute.reliability, "{:?}", brute.goals);
        }
        for sequence in &best {
            check_numbers(&problem, sequence);
        }
        prop_assert!(best.windows(2).all(|w| w[0].rank(&w[1]).is_lt()), "the family is in order");
    }

    /// Each of the family is feasible and no better than the best of its own set.
    #[test]
    fn the_family_holds_one_sequence_a_set(drawn in any_instance(), policy in any_policy()) {
        let instance = drawn.instance();
        let problem = instance.problem(policy);
        let mut sets = Vec::new();
        for sequence in sequences(&problem, thorough()).best {
            let mut set: Vec<GoalId> = sequence.goals().collect();
            set.sort();
            let same_set = |plan: &Tried| {
                let mut goals = plan.goals.clone();
                goals.sort();
                goals == set
            };
            let brute = best_plan(&problem, same_set).expect("the set is feasible");
            prop_assert!(sequence.value <= brute.value);
            prop_assert!(!sets.contains(&set));
            sets.push(set);
        }
    }

    #[test]
    fn weighing_an_order_equals_brute_force_of_that_order(
        drawn in any_instance(),
        policy in any_policy(),
        seed in any::<u64>(),
    ) {
        let instance = drawn.instance();
        let problem = instance.problem(policy);
        let mut draws = Draws(seed);
        let mut order: Vec<GoalId> = instance.candidates.iter().map(|c| c.goal).collect();
        for i in (1..order.len()).rev() {
            order.swap(i, draws.below(i + 1));
        }
        order.truncate(1 + draws.below(order.len().min(4)));
        let brute = best_plan(&problem, |plan| plan.goals == order);
        let weighed = weigh(&problem, &order);
        prop_assert_eq!(weighed.as_ref().map(|s| s.value), brute.as_ref().map(|b| b.value));
        if let Some(weighed) = weighed {
            prop_assert_eq!(weighed.goals().collect::<Vec<_>>(), order);
            prop_assert_eq!(weighed.reliability, brute.expect("both or none").reliability);
            check_numbers(&problem, &weighed);
        }
    }

    /// J1 ≥ J2: what is relayed on arrival cannot be worth less than what must come home.
    #[test]
    fn expected_interest_is_at_least_all_or_nothing(drawn in any_instance(), policy in any_policy()) {
        let instance = drawn.instance();
        for sequence in sequences(&instance.problem(policy), thorough()).best {
            prop_assert!(sequence.expected >= sequence.prize * sequence.reliability - 1e-12);
        }
    }

    #[test]
    fn more_of_a_budget_never_lowers_the_optimum(
        drawn in any_instance(),
        policy in any_policy(),
        more in [1.0..3.0f64, 1.0..3.0f64, 1.0..3.0f64, 0.0..1.0f64],
    ) {
        let instance = drawn.instance();
        let problem = instance.problem(policy);
        let Limits { time_s, energy_j, data_mb, min_reliability } = problem.limits;
        let limits = Limits {
            time_s: time_s * more[0],
            energy_j: energy_j * more[1],
            data_mb: data_mb * more[2],
            min_reliability: min_reliability * more[3],
        };
        let before = &sequences(&problem, thorough()).best[0];
        let after = &sequences(&Problem { limits, ..problem }, thorough()).best[0];
        prop_assert!(after.value >= before.value);
    }

    #[test]
    fn one_more_optional_goal_never_lowers_the_optimum(
        drawn in any_instance(),
        policy in any_policy(),
    ) {
        let instance = drawn.instance();
        let all = instance.problem(policy);
        let fewer = Problem { candidates: &all.candidates[1..], ..all };
        prop_assert!(
            sequences(&all, thorough()).best[0].value >= sequences(&fewer, thorough()).best[0].value
        );
    }

    /// However early the search is stopped, what it could not rule out is said.
    #[test]
    fn a_bound_is_never_below_the_optimum(
        drawn in any_instance(),
        policy in any_policy(),
        expansions in 0u64..40,
    ) {
        let instance = drawn.instance();
        let problem = instance.problem(policy);
        let optimum = sequences(&problem, thorough()).best[0].value;
        let Sequences { best, proof, expansions: done } =
            sequences(&problem, Effort { expansions, ..thorough() });
        prop_assert!(done <= expansions);
        check_numbers(&problem, &best[0]);
        match proof {
            Proof::Proven => prop_assert_eq!(best[0].value, optimum),
            Proof::Bound(bound) => {
                prop_assert_eq!(done, expansions);
                prop_assert!(bound >= optimum, "{} < {}", bound, optimum);
                prop_assert!(best[0].value <= optimum);
            }
        }
    }

    /// A budget of exactly what the best plan costs is enough for it, rounding notwithstanding.
    #[test]
    fn a_plan_that_fits_exactly_is_found(drawn in any_instance(), policy in any_policy()) {
        let instance = drawn.instance();
        let free = Problem { limits: NO_LIMITS, ..instance.problem(policy) };
        let best = &sequences(&free, thorough()).best[0];
        let limits = Limits {
            time_s: best.time_s,
            energy_j: best.energy_j,
            data_mb: best.data_mb,
            min_reliability: best.reliability,
        };
        let again = &sequences(&Problem { limits, ..free }, thorough()).best[0];
        prop_assert_eq!(again.value, best.value);
    }

    /// One budget is just enough for the thriftiest way to do as many goals as can be done, the others are not
    /// short: labels that spend more of it must not hide it.
    #[test]
    fn the_thriftiest_plan_is_found_whatever_is_short(
        drawn in any_instance(),
        policy in any_policy(),
        budget in 0usize..4,
    ) {
        let instance = drawn.instance();
        let free = Problem { limits: NO_LIMITS, ..instance.problem(policy) };
        let spent = |p: &Tried| [p.time_s, p.energy_j, p.data_mb, -p.reliability][budget];
        let mut thriftiest: Option<Tried> = None;
        all_plans(&free, |plan| {
            let better = thriftiest.as_ref().is_none_or(|t| {
                let (more, as_many) = (plan.goals.len() > t.goals.len(), plan.goals.len() == t.goals.len());
                more || as_many && spent(plan) < spent(t)
            });
            if better {
                thriftiest = Some(plan.clone());
            }
        });
        let thriftiest = thriftiest.expect("doing nothing is always possible");
        let mut limits = NO_LIMITS;
        match budget {
            0 => limits.time_s = thriftiest.time_s,
            1 => limits.energy_j = thriftiest.energy_j,
            2 => limits.data_mb = thriftiest.data_mb,
            _ => limits.min_reliability = thriftiest.reliability,
        }
        let short = Problem { limits, ..free };
        let brute = best_plan(&short, |_| true).expect("doing nothing is always possible");
        let best = &sequences(&short, thorough()).best[0];
        prop_assert_eq!(best.value, brute.value, "{:?}", brute.goals);
    }

    #[test]
    fn the_pinned_goal_comes_first_or_nothing_is_found(
        drawn in any_instance(),
        policy in any_policy(),
        which in any::<prop::sample::Index>(),
    ) {
        let instance = drawn.instance();
        let problem = instance.problem(policy);
        let pinned = instance.candidates[which.index(instance.candidates.len())].goal;
        let found = sequences(&problem, Effort { first: &[pinned], ..thorough() });
        let brute = best_plan(&problem, |plan| plan.goals.first() == Some(&pinned));
        if let Some(brute) = brute {
            prop_assert_eq!(found.best[0].value, brute.value);
            for sequence in &found.best {
                prop_assert_eq!(sequence.goals().next(), Some(pinned));
            }
        } else {
            prop_assert_eq!(found.best, vec![GoalSequence::empty()]);
        }
    }

    #[test]
    fn two_searches_give_the_same_result(drawn in any_instance(), policy in any_policy()) {
        let instance = drawn.instance();
        let problem = instance.problem(policy);
        prop_assert_eq!(sequences(&problem, thorough()), sequences(&problem, thorough()));
    }
}

/// Goals to be imaged on ground of one hazard, each at one cell, with nothing else to tell them apart.
fn level(goals: &[(u32, Cell)], heights: Raster<f32>) -> Instance {
    let spec = heights.spec();
    let ground = ground(heights, Raster::filled(spec, 0.001), Raster::filled(spec, false));
    let start = Cell::new(spec.rows() / 2, spec.cols() / 2);
    let cells: Vec<Cell> = std::iter::once(start).chain(goals.iter().map(|g| g.1)).collect();
    let domain = domain();
    let candidate = |(node, &(id, _)): (usize, &(u32, Cell))| Candidate {
        goal: GoalId(id),
        directive: 1,
        prize: 0.5,
        poses: vec![node + 1],
    };
    Instance {
        candidates: goals.iter().enumerate().map(candidate).collect(),
        travel: travel(&ground, &cells),
        directives: directives(&domain),
        facts: domain.initial(),
        domain,
        limits: NO_LIMITS,
    }
}

fn best_order(instance: &Instance, policy: Policy) -> Vec<u32> {
    let best = sequences(&instance.problem(policy), thorough()).best.swap_remove(0);
    best.goals().map(|g| g.0).collect()
}

#[test]
fn of_equally_good_orders_the_quicker_is_taken_whatever_the_ids() {
    let spec = GridSpec::new(9, 9, 1.0).expect("a small grid");
    // Both ways round are 12 m of the same hazard; climbing 4 m and coming down 8 m is the quicker.
    let hill = Raster::from_fn(spec, |c| 0.1 * c.col as f32);
    let (top, foot) = (Cell::new(4, 8), Cell::new(4, 0));
    for (high, low) in [(2, 7), (7, 2)] {
        let instance = level(&[(high, top), (low, foot)], hill.clone());
        for policy in Policy::ALL {
            assert_eq!(best_order(&instance, policy), [high, low], "{policy}");
        }
    }
}

#[test]
fn of_orders_alike_in_all_numbers_the_smaller_ids_come_first() {
    let spec = GridSpec::new(9, 9, 1.0).expect("a small grid");
    let flat = Raster::filled(spec, 0.0);
    let (here, there, beyond) = (Cell::new(4, 6), Cell::new(4, 7), Cell::new(4, 8));
    // Two goals in one cell may be done in either order; what follows makes both one state of the search.
    for ids in [[3, 9, 5, 1], [9, 3, 5, 1], [9, 3, 1, 5], [3, 9, 1, 5]] {
        let [a, b, c, d] = ids;
        let goals = [(a, here), (b, here), (c, there), (d, beyond)];
        for policy in Policy::ALL {
            assert_eq!(best_order(&level(&goals, flat.clone()), policy), [3, 9, c, d], "{policy}");
        }
    }
    // On both sides of the start: nothing but the ids decides where to go first.
    let sides = [(8, Cell::new(4, 1)), (6, Cell::new(4, 7))];
    assert_eq!(best_order(&level(&sides, flat), Policy::MostInteresting), [6, 8]);
}

#[test]
fn most_interesting_takes_the_largest_sum_and_then_the_safest_way_to_it() {
    let spec = GridSpec::new(3, 9, 1.0).expect("a small grid");
    let hazard = Raster::from_fn(spec, |c| if c.col > 5 { 0.05 } else { 0.001 });
    let ground = ground(Raster::filled(spec, 0.0), hazard, Raster::filled(spec, false));
    let domain = domain();
    let near = |col: usize| Cell::new(1, col);
    let candidate = |id: u32, prize: f64, poses: Vec<usize>| Candidate {
        goal: GoalId(id),
        directive: 1,
        prize,
        poses,
    };
    let instance = Instance {
        travel: travel(&ground, &[near(4), near(8), near(6), near(2), near(1)]),
        // G1, worth least, can be done from the far or the near side of the hazard.
        candidates: vec![
            candidate(1, 0.25, vec![1, 2]),
            candidate(2, 0.5, vec![3]),
            candidate(3, 0.625, vec![4]),
        ],
        directives: directives(&domain),
        facts: domain.initial(),
        domain,
        // Two images fit into the data volume.
        limits: Limits { data_mb: 80.0, ..NO_LIMITS },
    };
    let best =
        sequences(&instance.problem(Policy::MostInteresting), thorough()).best.swap_remove(0);
    assert_eq!(best.goals().collect::<Vec<_>>(), [GoalId(2), GoalId(3)]);
    assert_eq!(best.prize, 1.125);
    let pair = weigh(&instance.problem(Policy::MostInteresting), &[GoalId(2), GoalId(1)]);
    assert_eq!(pair.expect("two fit").stops[1].pose, 2, "the safer pose");
}

/// Time and energy are each at their least on different legs: the bound may use both, a plan may not.
#[test]
fn a_goal_that_is_quick_one_way_and_cheap_another_is_not_ruled_out() {
    let spec = GridSpec::new(9, 9, 1.0).expect("a small grid");
    let slope = Raster::from_fn(spec, |c| 0.12 * c.row as f32);
    let goals = [(1, Cell::new(0, 4)), (2, Cell::new(8, 4)), (3, Cell::new(4, 8))];
    let mut instance = level(&goals, slope);
    instance.candidates[1].directive = 0;
    for policy in Policy::ALL {
        let free = best_plan(&instance.problem(policy), |p| p.goals.len() == 3);
        let free = free.expect("all three can be done");
        instance.limits = Limits { time_s: free.time_s, energy_j: free.energy_j, ..NO_LIMITS };
        let best = &sequences(&instance.problem(policy), thorough()).best[0];
        assert_eq!(best.value, free.value);
        instance.limits = NO_LIMITS;
    }
}

#[test]
fn an_order_of_unknown_goals_cannot_be_weighed() {
    let instance = instance(3, 1, 7);
    let problem = instance.problem(Policy::ExpectedInterest);
    assert_eq!(weigh(&problem, &[GoalId(1)]), None);
    assert_eq!(weigh(&problem, &[]), Some(GoalSequence::empty()));
    assert_eq!(weigh(&problem, &[GoalId(100), GoalId(100)]), None);
}

/// A goal without a prize is still a goal when its order is asked for.
#[test]
fn worthless_goals_can_be_weighed() {
    let spec = GridSpec::new(3, 3, 1.0).expect("a small grid");
    let mut instance = level(&[(1, Cell::new(0, 0))], Raster::filled(spec, 0.0));
    instance.candidates[0].prize = 0.0;
    for policy in Policy::ALL {
        let weighed = weigh(&instance.problem(policy), &[GoalId(1)]).expect("it can be done");
        assert_eq!(weighed.value, 0.0);
        assert!(weighed.time_s > 0.0);
    }
}
