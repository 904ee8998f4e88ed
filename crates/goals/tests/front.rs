//! Whole-plan fronts, and the most reliable plan of the most interesting set, are what trying everything finds.

mod oracle;
#[expect(dead_code, reason = "legs are drawn here, not driven over ground")]
mod rover;

use proptest::prelude::*;
use wisdom_goals::{
    Candidate, Effort, GoalId, GoalSequence, Limits, PlanFront, Policy, Problem, Proof, plan_front,
    sequences, weigh,
};
use wisdom_planner::{CostVector, TravelMatrix};

use oracle::{Draws, Instance, NO_LIMITS, all_plans, checked, is_stranded, nodes, same_value};

/// Enough for every instance here.
const ENOUGH: usize = 1_000_000;

fn cost(time_s: f64, energy_j: f64, neg_ln_r: f64) -> CostVector {
    CostVector { length_m: 1.0, time_s, energy_j, neg_ln_r }
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
    /// Waiting draws no power: a front may leave out ways that set out later to draw less.
    fn instance(self) -> Instance {
        let Self { goals, poses, alternatives, seed } = self;
        Instance { waiting_w: 0.0, ..oracle::drawn(goals, poses, alternatives, goals, seed) }
    }
}

fn any_instance() -> impl Strategy<Value = Drawn> {
    (1..=4usize, 1..=3usize, 1..=3usize, any::<u64>())
        .prop_map(|(goals, poses, alternatives, seed)| Drawn { goals, poses, alternatives, seed })
}

type Costs = [f64; 3];

fn matches_or_beats(a: &Costs, b: &Costs) -> bool {
    a.iter().zip(b).all(|(a, b)| a <= b)
}

/// −ln R, time and energy of the plans for one order that no other matches or beats.
fn brute_front(problem: &Problem<'_>, order: &[GoalId]) -> Vec<Costs> {
    let mut front: Vec<Costs> = Vec::new();
    all_plans(problem, &mut |plan| {
        let new = [plan.neg_ln_r, plan.time_s, plan.energy_j];
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
    let found = checked(problem, plan);
    let told = [plan.reliability, plan.time_s, plan.energy_j, plan.data_mb];
    assert_eq!(told, [found.reliability, found.time_s, found.energy_j, found.data_mb]);
    [found.neg_ln_r, found.time_s, found.energy_j]
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

    /// The paper's sentence, word by word: of all plans within all limits (and with the fewest mandatory goals missed)
    /// the largest sum of prizes, whatever the set; of those, in whatever order, by whatever poses and legs, the most
    /// reliable; of those, the quickest.
    #[test]
    fn the_plan_taken_is_the_most_reliable_of_the_most_interesting_sets(drawn in any_instance()) {
        let instance = drawn.instance();
        let problem = instance.problem(Policy::MostInteresting);
        let mut best = (f64::NEG_INFINITY, 0.0, 0.0, 0.0);
        all_plans(&problem, &mut |plan| {
            let new = (-(plan.missed as f64), plan.prize, plan.reliability, -plan.time_s);
            if new > best {
                best = new;
            }
        });
        let found = sequences(&problem, Effort { expansions: 10_000_000, keep: 3, first: &[], clock: None });
        let plan = &found.best[0];
        prop_assert_eq!(found.proof, Proof::Proven);
        walked(&problem, plan);
        if is_stranded(&problem, plan) {
            prop_assert_eq!(best.0, f64::NEG_INFINITY);
            return Ok(());
        }
        prop_assert_eq!((-(plan.missed as f64), plan.prize, plan.reliability, -plan.time_s), best);
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
    let (mut several, mut held_back, mut rivals, mut homeward) = (0, 0, 0, 0);
    for seed in 0..300 {
        let instance = Drawn { goals: 3, poses: 2, alternatives: 3, seed }.instance();
        let problem = instance.problem(Policy::MostInteresting);
        let plan = sequences(
            &problem,
            Effort { expansions: 10_000_000, keep: 1, first: &[], clock: None },
        );
        let best = &plan.best[0];
        if is_stranded(&problem, best) {
            continue;
        }
        let order: Vec<GoalId> = best.goals().collect();
        several += usize::from(plan_front(&problem, &order, ENOUGH).plans.len() > 1);
        let free = Problem { limits: NO_LIMITS, ..problem };
        let freely = plan_front(&free, &order, ENOUGH).plans.swap_remove(0);
        held_back += usize::from(freely.reliability > best.reliability);
        homeward += usize::from(best.end.is_some() && order.len() > 1);
        let mut orders = std::collections::BTreeSet::new();
        all_plans(&problem, &mut |tried| {
            if tried.prize == best.prize {
                orders.insert(tried.goals.clone());
            }
        });
        rivals += usize::from(orders.len() > 1);
    }
    // Fronts of several plans, limits that rule out the most reliable way, orders or sets of equal prizes, and ways home.
    let counts = [several, held_back, rivals, homeward];
    assert!(several > 50 && held_back > 20 && rivals > 50 && homeward > 40, "{counts:?}");
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
    let candidate = |id: u32, pose: usize| Candidate::new(GoalId(id), 1, 0.5, vec![pose]);
    let instance = Instance::new(vec![candidate(1, 1), candidate(2, 2)], travel);
    // Two images and two drives take 130 s besides the legs.
    Instance { limits: Limits { time_s: 730.0, ..NO_LIMITS }, ..instance }
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
    let effort = Effort { expansions: 1000, keep: 1, first: &[], clock: None };
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

/// Alternatives of legs never lead to a worse plan than the most reliable ones alone; and however soon the search is cut
/// short, weighing the order chosen finds a way that is as good.
#[test]
fn more_ways_are_never_worse_and_weighing_an_order_finds_the_best_of_them() {
    let (mut cut, mut gained) = (0, 0);
    for seed in 0..40_u64 {
        let instance = oracle::drawn(7, 2, 3, 4, seed);
        for policy in Policy::ALL {
            let problem = instance.problem(policy);
            let narrow = problem.travel.most_reliable();
            let search = |problem: &Problem<'_>, expansions: u64| {
                sequences(problem, Effort { expansions, keep: 3, first: &[], clock: None })
            };
            let with = search(&problem, 1_000_000);
            let without = search(&Problem { travel: &narrow, ..problem }, 1_000_000);
            let (a, b) = (&with.best[0], &without.best[0]);
            assert_eq!((with.proof, without.proof), (Proof::Proven, Proof::Proven));
            let possible = !is_stranded(&problem, b);
            let as_good = a.rank(b).is_le() || same_value(policy, a.value, b.value);
            assert!(as_good || !possible, "seed {seed}: {a:?}\n{b:?}");
            gained += u32::from(possible && a.value > b.value);
            for expansions in [3, 20, 200] {
                let found = search(&problem, expansions);
                cut += u32::from(found.proof != Proof::Proven);
                let best = &found.best[0];
                let order: Vec<GoalId> = best.goals().collect();
                let as_good = weigh(&problem, &order).is_some_and(|weighed| {
                    weighed.rank(best).is_le() || same_value(policy, weighed.value, best.value)
                });
                assert!(
                    as_good || is_stranded(&problem, best),
                    "seed {seed}, {expansions}: {best:?}"
                );
            }
        }
    }
    assert!(cut > 50 && gained > 10, "{cut} searches were cut short, {gained} gained by more ways");
}
