//! Whole-plan fronts, and the most reliable plan of the most interesting set, are what trying everything finds.

#[expect(dead_code, reason = "legs are drawn here, not driven over ground")]
mod rover;

use proptest::prelude::*;
use wisdom_goals::{
    Candidate, Directive, Domain, Effort, FactSet, GoalId, GoalSequence, Limits, PlanFront, Policy,
    Problem, Proof, plan_front, quantised, sequences, weigh,
};
use wisdom_grid::Cell;
use wisdom_planner::{CostVector, TravelMatrix};

use rover::{directives, domain, names};

const NO_LIMITS: Limits = Limits {
    time_s: f64::INFINITY,
    energy_j: f64::INFINITY,
    data_mb: f64::INFINITY,
    min_reliability: 0.0,
};

/// Enough for every instance here.
const ENOUGH: usize = 1_000_000;

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

    fn below(&mut self, count: usize) -> usize {
        (self.unit() * count as f64) as usize
    }
}

fn cost(time_s: f64, energy_j: f64, neg_ln_r: f64) -> CostVector {
    CostVector { length_m: 1.0, time_s, energy_j, neg_ln_r }
}

fn nodes(count: usize) -> Vec<Cell> {
    (0..count).map(|col| Cell::new(0, col)).collect()
}

/// Goals of all directives, which share some poses; up to three alternatives a leg, none for some; costs of a few
/// values (so that much is equal) or of many; each limit anywhere from hopeless to ample.
fn instance(goals: usize, poses: usize, alternatives: usize, seed: u64) -> Instance {
    let mut draws = Draws(seed);
    let count = 1 + goals * poses;
    let coarse = draws.unit() < 0.5;
    let draw = move |draws: &mut Draws, unit: f64| {
        let share = draws.unit();
        unit * if coarse { 1.0 + (3.0 * share).floor() } else { 0.5 + 3.0 * share }
    };
    let travel = TravelMatrix::from_costs(&nodes(count), |from, to| {
        if from == to {
            return vec![CostVector::ZERO];
        }
        let ways = if draws.unit() < 0.1 { 0 } else { 1 + draws.below(alternatives) };
        (0..ways)
            .map(|_| {
                let (time_s, energy_j) = (draw(&mut draws, 200.0), draw(&mut draws, 10_000.0));
                cost(time_s, energy_j, draw(&mut draws, 0.0625))
            })
            .collect()
    });
    let domain = domain();
    let directives = directives(&domain);
    let candidates = (0..goals)
        .map(|g| Candidate {
            goal: GoalId(100 - g as u32),
            directive: draws.below(directives.len()),
            prize: quantised(0.25 * (1 + draws.below(3)) as f64),
            poses: (0..poses).map(|_| 1 + draws.below(count - 1)).collect(),
        })
        .collect();
    let facts = [names(&["stowed"]), names(&["out"]), names(&["stowed", "lit", "imaged"])];
    let facts = domain.set(&facts[draws.below(3)]).expect("the domain has these facts");
    let each = goals as f64;
    let mut share = |all: f64| if draws.unit() < 0.2 { f64::INFINITY } else { draws.unit() * all };
    let limits = Limits {
        time_s: share(1200.0 * each),
        energy_j: share(80_000.0 * each),
        data_mb: share(60.0 * each),
        min_reliability: [0.0, 0.5, 0.7][draws.below(3)],
    };
    Instance { candidates, travel, domain, directives, facts, limits }
}

/// How an instance was drawn, for the report of a failure.
#[derive(Debug, Clone, Copy)]
struct Drawn {
    goals: usize,
    poses: usize,
    alternatives: usize,
    seed: u64,
}

impl Drawn {
    fn instance(self) -> Instance {
        instance(self.goals, self.poses, self.alternatives, self.seed)
    }
}

fn any_instance() -> impl Strategy<Value = Drawn> {
    (1..=4usize, 1..=3usize, 1..=3usize, any::<u64>())
        .prop_map(|(goals, poses, alternatives, seed)| Drawn { goals, poses, alternatives, seed })
}

/// A plan as the brute force knows it.
#[derive(Debug, Clone, PartialEq)]
struct Tried {
    goals: Vec<GoalId>,
    prize: f64,
    data_mb: f64,
    cost: CostVector,
}

/// All plans within the limits: every subset in every order, through every pose and leg.
fn all_plans(problem: &Problem<'_>, visit: &mut impl FnMut(&Tried)) {
    let nothing = Tried { goals: Vec::new(), prize: 0.0, data_mb: 0.0, cost: CostVector::ZERO };
    extend(problem, &nothing, problem.facts, 0, visit);
}

fn extend(
    problem: &Problem<'_>,
    so_far: &Tried,
    facts: FactSet,
    node: usize,
    visit: &mut impl FnMut(&Tried),
) {
    visit(so_far);
    let limits = &problem.limits;
    for candidate in problem.candidates.iter().filter(|c| !so_far.goals.contains(&c.goal)) {
        let directive = &problem.directives[candidate.directive];
        if !facts.contains(directive.requires) {
            continue;
        }
        let Some(service) = problem.domain.expand(facts, directive.achieves) else { continue };
        for &pose in &candidate.poses {
            for &leg in problem.travel.alternatives(node, pose) {
                let mut next = so_far.clone();
                next.goals.push(candidate.goal);
                next.prize += candidate.prize;
                next.data_mb += service.cost.data_mb;
                next.cost += leg;
                next.cost.time_s += service.cost.time_s;
                next.cost.energy_j += service.cost.energy_j;
                if next.cost.time_s <= limits.time_s
                    && next.cost.energy_j <= limits.energy_j
                    && next.data_mb <= limits.data_mb
                    && next.cost.reliability() >= limits.min_reliability
                {
                    extend(problem, &next, service.facts, pose, visit);
                }
            }
        }
    }
}

type Costs = [f64; 3];

fn matches_or_beats(a: &Costs, b: &Costs) -> bool {
    a.iter().zip(b).all(|(a, b)| a <= b)
}

/// −ln R, time and energy of the plans for one order that no other matches or beats.
fn brute_front(problem: &Problem<'_>, order: &[GoalId]) -> Vec<Costs> {
    let mut front: Vec<Costs> = Vec::new();
    all_plans(problem, &mut |plan| {
        let CostVector { neg_ln_r, time_s, energy_j, .. } = plan.cost;
        let new = [neg_ln_r, time_s, energy_j];
        if plan.goals == order && !front.iter().any(|known| matches_or_beats(known, &new)) {
            front.retain(|known| !matches_or_beats(&new, known));
            front.push(new);
        }
    });
    front.sort_by(|a, b| a.partial_cmp(b).expect("costs are numbers"));
    front
}

/// The costs of a plan, by walking through its stops once more; its other numbers are checked on the way.
fn walked(problem: &Problem<'_>, plan: &GoalSequence) -> Costs {
    let (mut facts, mut node, mut cost) = (problem.facts, 0, CostVector::ZERO);
    let (mut prize, mut expected, mut data_mb) = (0.0, 0.0, 0.0);
    for stop in &plan.stops {
        let candidate = problem.candidates.iter().find(|c| c.goal == stop.goal);
        let candidate = candidate.expect("stops are candidates");
        assert!(candidate.poses.contains(&stop.pose), "a pose of another goal");
        let directive = &problem.directives[candidate.directive];
        assert!(facts.contains(directive.requires));
        let service = problem.domain.expand(facts, directive.achieves).expect("it can be done");
        assert_eq!(stop.expansion, service);
        cost += problem.travel.alternatives(node, stop.pose)[stop.alternative];
        cost.time_s += service.cost.time_s;
        cost.energy_j += service.cost.energy_j;
        data_mb += service.cost.data_mb;
        prize += candidate.prize;
        expected += candidate.prize * cost.reliability();
        (facts, node) = (service.facts, stop.pose);
    }
    let value = if problem.policy == Policy::MostInteresting { prize } else { expected };
    assert_eq!(
        [plan.value, plan.prize, plan.expected, plan.data_mb, plan.reliability],
        [value, prize, expected, data_mb, cost.reliability()]
    );
    assert_eq!([plan.time_s, plan.energy_j], [cost.time_s, cost.energy_j]);
    [cost.neg_ln_r, cost.time_s, cost.energy_j]
}

fn shuffled(instance: &Instance, seed: u64) -> Vec<GoalId> {
    let mut draws = Draws(seed);
    let mut order: Vec<GoalId> = instance.candidates.iter().map(|c| c.goal).collect();
    for i in (1..order.len()).rev() {
        order.swap(i, draws.below(i + 1));
    }
    if draws.unit() < 0.3 {
        order.truncate(1 + draws.below(order.len()));
    }
    order
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(192))]

    /// To the last bit.
    #[test]
    fn the_front_of_an_order_is_what_trying_every_way_finds(
        drawn in any_instance(), seed in any::<u64>(), policy in prop::sample::select(&Policy::ALL[..]),
    ) {
        let instance = drawn.instance();
        let problem = instance.problem(policy);
        let order = shuffled(&instance, seed);
        let PlanFront { plans, complete, .. } = plan_front(&problem, &order, ENOUGH);
        prop_assert!(complete);
        let found: Vec<Costs> = plans.iter().map(|plan| walked(&problem, plan)).collect();
        prop_assert_eq!(found, brute_front(&problem, &order));
        for plan in &plans {
            prop_assert_eq!(plan.goals().collect::<Vec<_>>(), order.clone());
        }
    }

    /// With some labels left out, what is found is possible, and it is said that it need not be the best.
    #[test]
    fn a_front_from_too_few_labels_is_said_to_be_one(
        drawn in any_instance(), seed in any::<u64>(), max_labels in 0..12usize,
    ) {
        let instance = drawn.instance();
        let problem = instance.problem(Policy::MostInteresting);
        let order = shuffled(&instance, seed);
        let whole = plan_front(&problem, &order, ENOUGH);
        let part = plan_front(&problem, &order, max_labels);
        prop_assert!(part.labels <= (max_labels.max(1) * order.len()) as u64);
        prop_assert!(!part.complete || part == whole);
        prop_assert!(part.complete || whole.labels > max_labels as u64);
        let whole: Vec<Costs> = whole.plans.iter().map(|plan| walked(&problem, plan)).collect();
        for plan in &part.plans {
            let costs = walked(&problem, plan);
            prop_assert!(whole.iter().any(|known| matches_or_beats(known, &costs)));
        }
    }

    /// The paper's sentence, word by word: of all plans within all limits the largest sum of prizes, whatever the
    /// set; of those, in whatever order, by whatever poses and legs, the most reliable; of those, the quickest.
    #[test]
    fn the_plan_taken_is_the_most_reliable_of_the_most_interesting_sets(drawn in any_instance()) {
        let instance = drawn.instance();
        let problem = instance.problem(Policy::MostInteresting);
        let mut best = (0.0, 1.0, 0.0);
        all_plans(&problem, &mut |plan| {
            let (prize, reliability, time_s) = (plan.prize, plan.cost.reliability(), plan.cost.time_s);
            if (prize, reliability, -time_s) > (best.0, best.1, -best.2) {
                best = (prize, reliability, time_s);
            }
        });
        let found = sequences(&problem, Effort { expansions: 10_000_000, keep: 3, first: &[] });
        let plan = &found.best[0];
        prop_assert_eq!(found.proof, Proof::Proven);
        prop_assert_eq!((plan.prize, plan.reliability, plan.time_s), best);
        walked(&problem, plan);
        // It is the first of its order's front, and what weighing its order finds.
        let order: Vec<GoalId> = plan.goals().collect();
        let front = plan_front(&problem, &order, ENOUGH).plans;
        prop_assert_eq!((front[0].reliability, front[0].time_s), (plan.reliability, plan.time_s));
        let weighed = weigh(&problem, &order).expect("it was found");
        prop_assert_eq!((weighed.reliability, weighed.time_s), (plan.reliability, plan.time_s));
    }
}

/// The instances are not so poor that anything would pass.
#[test]
fn the_instances_ask_for_a_choice() {
    let (mut several, mut held_back, mut rivals) = (0, 0, 0);
    for seed in 0..200 {
        let instance = instance(3, 2, 3, seed);
        let problem = instance.problem(Policy::MostInteresting);
        let plan = sequences(&problem, Effort { expansions: 10_000_000, keep: 1, first: &[] });
        let order: Vec<GoalId> = plan.best[0].goals().collect();
        several += usize::from(plan_front(&problem, &order, ENOUGH).plans.len() > 1);
        let free = Problem { limits: NO_LIMITS, ..problem };
        let freely = plan_front(&free, &order, ENOUGH).plans.swap_remove(0);
        held_back += usize::from(freely.reliability > plan.best[0].reliability);
        let mut orders = std::collections::BTreeSet::new();
        all_plans(&problem, &mut |tried| {
            if tried.prize == plan.best[0].prize {
                orders.insert(tried.goals.clone());
            }
        });
        rivals += usize::from(orders.len() > 1);
    }
    // Fronts of several plans, limits that rule out the most reliable way, and orders or sets of equal prizes.
    assert!(several > 50 && held_back > 20 && rivals > 50, "{several} {held_back} {rivals}");
}

/// Two goals to be imaged in a row, each reached safely but slowly, or quickly; the times of the safe legs do not fit
/// together. What the second leg gains is more.
fn hurried() -> Instance {
    let legs = |safe: f64| vec![cost(500.0, 1.0, safe), cost(100.0, 1.0, 0.25)];
    let travel = TravelMatrix::from_costs(&nodes(3), |from, to| match (from, to) {
        (0, 1) => legs(0.125),
        (1, 2) => legs(0.0625),
        _ => Vec::new(),
    });
    let domain = domain();
    let candidate = |id: u32, pose: usize| Candidate {
        goal: GoalId(id),
        directive: 1,
        prize: 0.5,
        poses: vec![pose],
    };
    Instance {
        candidates: vec![candidate(1, 1), candidate(2, 2)],
        travel,
        directives: directives(&domain),
        facts: domain.initial(),
        domain,
        // Two images and two drives take 130 s besides the legs.
        limits: Limits { time_s: 730.0, ..NO_LIMITS },
    }
}

fn alternatives(plan: &GoalSequence) -> Vec<usize> {
    plan.stops.iter().map(|stop| stop.alternative).collect()
}

#[test]
fn time_is_spent_where_it_saves_most_risk() {
    let instance = hurried();
    let problem = instance.problem(Policy::MostInteresting);
    let front = plan_front(&problem, &[GoalId(1), GoalId(2)], ENOUGH);
    let ways: Vec<Vec<usize>> = front.plans.iter().map(alternatives).collect();
    // [0, 0] takes too long; [0, 1] takes as long as [1, 0] and is riskier.
    assert_eq!(ways, [[1, 0], [1, 1]]);
    let effort = Effort { expansions: 1000, keep: 1, first: &[] };
    assert_eq!(alternatives(&sequences(&problem, effort).best[0]), [1, 0]);
}

#[test]
fn an_order_of_unknown_or_repeated_goals_has_no_plan() {
    let instance = hurried();
    let problem = instance.problem(Policy::MostInteresting);
    let empty = PlanFront { plans: Vec::new(), complete: true, labels: 0 };
    assert_eq!(plan_front(&problem, &[GoalId(7)], ENOUGH), empty);
    assert_eq!(plan_front(&problem, &[GoalId(1), GoalId(1)], ENOUGH), empty);
    assert_eq!(plan_front(&problem, &[], ENOUGH).plans, [GoalSequence::empty()]);
    // The way back is closed.
    assert_eq!(plan_front(&problem, &[GoalId(2), GoalId(1)], ENOUGH), empty);
}

/// However soon the search is cut short, alternatives of legs never lead to a worse plan than none, and no plan known for
/// the order chosen is better than the one chosen.
#[test]
fn more_ways_are_never_worse_even_if_the_search_is_cut_short() {
    let (mut cut, mut gained) = (0, 0);
    for seed in 0..60_u64 {
        let instance = instance(7, 2, 3, seed);
        for policy in Policy::ALL {
            let problem = instance.problem(policy);
            let narrow = problem.travel.most_reliable();
            for expansions in [3, 20, 200] {
                let effort = Effort { expansions, keep: 3, first: &[] };
                let with = sequences(&problem, effort);
                let without = sequences(&Problem { travel: &narrow, ..problem }, effort);
                let (a, b) = (&with.best[0], &without.best[0]);
                assert!(a.rank(b).is_le(), "seed {seed}, {expansions}: {a:?}\n{b:?}");
                if let Proof::Bound(bound) = with.proof {
                    assert!(bound >= a.value);
                    cut += 1;
                }
                gained += u32::from(a.value > b.value);
            }
        }
    }
    assert!(cut > 50 && gained > 10, "{cut} searches were cut short, {gained} gained by more ways");
}
