//! The label search finds what trying everything finds, under every policy.

mod oracle;
mod rover;

use std::collections::BTreeMap;

use proptest::prelude::*;
use wisdom_goals::{
    Candidate, Effort, GoalId, GoalSequence, Limits, Policy, Preferences, Prices, Problem, Proof,
    Sequences, quantised, sequences, weigh,
};
use wisdom_grid::{Cell, GridSpec, Raster};
use wisdom_planner::CostVector;

use oracle::{
    Draws, Instance, NO_LIMITS, Tried, all_plans, best_plan, checked, is_stranded, same_value,
    stranded,
};
use rover::{ground, names, travel};

/// Enough for every instance here.
fn thorough() -> Effort<'static> {
    Effort { expansions: 10_000_000, keep: 5, first: &[], clock: None }
}

/// Hilly, hazardous ground with some rocks; goals of all directives; each limit anywhere from hopeless to ample.
fn hills(goals: usize, poses: usize, seed: u64) -> Instance {
    let mut draws = Draws(seed);
    let spec = GridSpec::new(9, 9, 1.0).expect("a small grid");
    let tallest = draws.of(&[0.05, 0.15, 0.3]);
    let heights = Raster::from_fn(spec, |_| draws.between(0.0, tallest) as f32);
    let worst = draws.of(&[0.003, 0.03, 0.1]);
    let hazard = Raster::from_fn(spec, |_| draws.between(0.0005, worst) as f32);
    let blocked = Raster::from_fn(spec, |_| draws.happens(0.12));
    let ground = ground(heights, hazard, blocked);
    let cells: Vec<Cell> =
        (0..=goals * poses).map(|_| spec.cell(draws.below(spec.len()))).collect();
    let candidates = (0..goals).map(|g| {
        let poses = (0..poses).map(|p| 1 + g * poses + p).collect();
        let prize = quantised(draws.between(0.05, 1.0));
        Candidate::new(GoalId(100 - g as u32), draws.below(3), prize, poses)
    });
    let mut instance = Instance::new(candidates.collect(), travel(&ground, &cells));
    let facts = [names(&["stowed"]), names(&["out"]), names(&["stowed", "lit", "imaged"])];
    instance.facts =
        instance.domain.set(&facts[draws.below(3)]).expect("the domain has these facts");
    let each = goals as f64;
    let mut share = |all: f64| if draws.happens(0.2) { f64::INFINITY } else { draws.unit() * all };
    instance.limits = Limits {
        time_s: share(700.0 * each),
        energy_j: share(60_000.0 * each),
        data_mb: share(50.0 * each),
        min_reliability: 0.0,
    };
    instance.limits.min_reliability = draws.of(&[0.0, 0.5, 0.8]);
    instance
}

/// How an instance was drawn, for the report of a failure.
#[derive(Debug, Clone, Copy)]
struct Drawn {
    /// Whether its legs are those of ground, and its goals without conditions of their own.
    hills: bool,
    goals: usize,
    poses: usize,
    seed: u64,
}

impl Drawn {
    fn instance(self) -> Instance {
        let Self { hills: on_hills, goals, poses, seed } = self;
        match goals {
            _ if on_hills => hills(goals, poses, seed),
            0..=4 => oracle::drawn(goals, poses, 2, goals, seed),
            _ => oracle::drawn(goals, poses, 2, 3, seed),
        }
    }
}

fn any_instance() -> impl Strategy<Value = Drawn> {
    let size =
        prop_oneof![(1usize..=4, 1usize..=2), (5usize..=5, 1usize..=2), (6usize..=7, 1usize..=1)];
    let hills = prop_oneof![1 => Just(true), 3 => Just(false)];
    (hills, size, any::<u64>()).prop_map(|(hills, (goals, poses), seed)| Drawn {
        hills,
        goals,
        poses,
        seed,
    })
}

fn any_policy() -> impl Strategy<Value = Policy> {
    prop::sample::select(&Policy::ALL[..])
}

/// The best plan by trying everything, as the search should tell it: doing nothing, where no plan is possible.
fn brute_force(problem: &Problem<'_>) -> Tried {
    let best = best_plan(problem, |_| true);
    best.unwrap_or_else(|| checked(problem, &stranded(problem)))
}

/// A sequence ranks as a plan does.
fn assert_ranks_as(problem: &Problem<'_>, told: &GoalSequence, brute: &Tried) {
    assert_eq!(told.missed, brute.missed, "{brute:?}\n{told:?}");
    assert!(
        same_value(problem.policy, told.value, brute.value),
        "{} is told, {} is possible: {brute:?}\n{told:?}",
        told.value,
        brute.value
    );
    if matches!(problem.policy, Policy::MostInteresting | Policy::ChanceConstrained) {
        assert_eq!(told.reliability, brute.reliability, "{brute:?}\n{told:?}");
        assert_eq!(told.time_s, brute.time_s, "{brute:?}\n{told:?}");
    }
}

/// Whether the first ranks at least as high, but for rounding.
fn at_least(policy: Policy, a: &GoalSequence, b: &GoalSequence) -> bool {
    a.missed < b.missed
        || a.missed == b.missed && (a.value >= b.value || same_value(policy, a.value, b.value))
}

/// Eight and nine goals with room for some five, by six policies each.
#[test]
fn the_search_equals_brute_force_to_nine_goals() {
    let mut most = 0;
    for seed in 0..24 {
        let goals = 8 + seed as usize % 2;
        let instance = oracle::drawn(goals, 1, 3 - seed as usize % 3, 4, seed);
        for policy in Policy::ALL {
            let problem = instance.problem(policy);
            let Sequences { best, proof, .. } = sequences(&problem, thorough());
            assert_eq!(proof, Proof::Proven);
            checked(&problem, &best[0]);
            assert_ranks_as(&problem, &best[0], &brute_force(&problem));
            most = most.max(best[0].stops.len());
        }
    }
    assert!(most >= 4, "room for {most} goals is too little");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(384))]

    /// Value to the last bit where it is a sum of prizes; then the reliability and the time too.
    #[test]
    fn the_search_equals_brute_force(drawn in any_instance(), policy in any_policy()) {
        let instance = drawn.instance();
        let problem = instance.problem(policy);
        let Sequences { best, proof, .. } = sequences(&problem, thorough());
        prop_assert_eq!(proof, Proof::Proven);
        assert_ranks_as(&problem, &best[0], &brute_force(&problem));
        for sequence in &best {
            checked(&problem, sequence);
        }
        prop_assert!(best.windows(2).all(|w| w[0].rank(&w[1]).is_lt()), "the family is in order");
    }

    /// Each of the family is feasible and no better than the best of its own set.
    #[test]
    fn the_family_holds_one_sequence_a_set(drawn in any_instance(), policy in any_policy()) {
        let instance = drawn.instance();
        let problem = instance.problem(policy);
        let sorted = |mut goals: Vec<GoalId>| {
            goals.sort();
            goals
        };
        let mut best_of: BTreeMap<Vec<GoalId>, Tried> = BTreeMap::new();
        all_plans(&problem, &mut |plan| {
            let best = best_of.entry(sorted(plan.goals.clone())).or_insert_with(|| plan.clone());
            if plan.better_than(best) {
                *best = plan.clone();
            }
        });
        let family = sequences(&problem, thorough()).best;
        prop_assert!(family.len() <= thorough().keep);
        for sequence in family {
            if is_stranded(&problem, &sequence) {
                prop_assert!(best_of.is_empty());
                continue;
            }
            let brute = best_of.remove(&sorted(sequence.goals().collect()));
            let brute = brute.expect("the set is feasible and was not named before");
            let same = same_value(policy, sequence.value, brute.value);
            prop_assert!(sequence.value <= brute.value || same);
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
        order.truncate(draws.below(1 + order.len().min(4)));
        let brute = best_plan(&problem, |plan| plan.goals == order);
        let weighed = weigh(&problem, &order);
        prop_assert_eq!(weighed.is_some(), brute.is_some(), "{:?}", brute);
        if let (Some(weighed), Some(brute)) = (weighed, brute) {
            prop_assert_eq!(weighed.goals().collect::<Vec<_>>(), order);
            assert_ranks_as(&problem, &weighed, &brute);
            checked(&problem, &weighed);
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
    fn without_risk_three_objectives_are_one(drawn in any_instance()) {
        let instance = drawn.instance().with_legs(|leg| CostVector { neg_ln_r: 0.0, ..*leg });
        let best = |policy| sequences(&instance.problem(policy), thorough()).best.swap_remove(0);
        let lex = best(Policy::MostInteresting);
        for policy in [Policy::ExpectedInterest, Policy::AllOrNothing, Policy::ChanceConstrained] {
            let found = best(policy);
            prop_assert_eq!((found.missed, found.value), (lex.missed, lex.value), "{}", policy);
        }
    }

    #[test]
    fn where_all_is_free_net_benefit_is_the_sum_of_prizes(drawn in any_instance()) {
        let mut instance = drawn.instance();
        // What NET does not heed may have its price.
        let prices = Prices { time_per_s: 1.0, data_per_mb: 1.0, ..Prices::NONE };
        instance.preferences = Preferences { prices, ..instance.preferences };
        let best = |policy| sequences(&instance.problem(policy), thorough()).best.swap_remove(0);
        let (net, lex) = (best(Policy::NetBenefit), best(Policy::MostInteresting));
        prop_assert_eq!((net.missed, net.value), (lex.missed, lex.value));
    }

    /// Mandatory goals aside: who has to take one may have to leave others.
    #[test]
    fn no_objective_takes_more_prizes_than_the_most_interesting(drawn in any_instance(), policy in any_policy()) {
        let instance = drawn.instance();
        let most = sequences(&instance.problem(Policy::MostInteresting), thorough()).best.swap_remove(0);
        let other = sequences(&instance.problem(policy), thorough()).best.swap_remove(0);
        prop_assert!(other.missed >= most.missed);
        prop_assert!(other.missed > most.missed || other.prize <= most.prize);
    }

    /// Also where goals are mandatory, exclude each other or have windows: what was possible still is.
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
        // Doing nothing where no plan is possible costs nothing, which no plan can do.
        let possible = !is_stranded(&problem, before);
        prop_assert!(!possible || at_least(policy, after, before), "{:?}\n{:?}", before, after);
    }

    /// Also one that excludes others, or that others need before them; not one that is mandatory.
    #[test]
    fn one_more_optional_goal_never_lowers_the_optimum(
        drawn in any_instance(),
        policy in any_policy(),
    ) {
        let mut instance = drawn.instance();
        instance.candidates[0].mandatory = false;
        let all = instance.problem(policy);
        let fewer = Problem { candidates: &all.candidates[1..], ..all };
        let before = &sequences(&fewer, thorough()).best[0];
        let after = &sequences(&all, thorough()).best[0];
        let possible = !is_stranded(&fewer, before);
        prop_assert!(!possible || at_least(policy, after, before), "{:?}\n{:?}", before, after);
    }

    /// However early the search is stopped, what it could not rule out is said.
    #[test]
    fn a_bound_is_never_below_the_optimum(
        drawn in any_instance(),
        policy in any_policy(),
        expansions in prop_oneof![0u64..40, 0u64..2000],
    ) {
        let instance = drawn.instance();
        let problem = instance.problem(policy);
        let optimum = brute_force(&problem);
        let found = sequences(&problem, Effort { expansions, ..thorough() });
        assert_honest(&problem, &found, expansions, optimum.missed, optimum.value);
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
        prop_assert!(same_value(policy, again.value, best.value), "{:?}\n{:?}", again, best);
        prop_assert_eq!(again.missed, best.missed);
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
        // Without limits all orders of seven goals by two ways a leg are too many to try.
        let free = Problem { candidates: &free.candidates[..free.candidates.len().min(5)], ..free };
        let spent = |p: &Tried| [p.time_s, p.energy_j, p.data_mb, -p.reliability][budget];
        let mut thriftiest: Option<Tried> = None;
        all_plans(&free, &mut |plan| {
            let better = thriftiest.as_ref().is_none_or(|t| {
                let (more, as_many) = (plan.goals.len() > t.goals.len(), plan.goals.len() == t.goals.len());
                more || as_many && spent(plan) < spent(t)
            });
            if better {
                thriftiest = Some(plan.clone());
            }
        });
        if let Some(thriftiest) = thriftiest {
            let mut limits = NO_LIMITS;
            match budget {
                0 => limits.time_s = thriftiest.time_s,
                1 => limits.energy_j = thriftiest.energy_j,
                2 => limits.data_mb = thriftiest.data_mb,
                _ => limits.min_reliability = thriftiest.reliability,
            }
            let short = Problem { limits, ..free };
            let best = &sequences(&short, thorough()).best[0];
            assert_ranks_as(&short, best, &brute_force(&short));
        }
    }

    #[test]
    fn goals_pinned_come_first_or_nothing_is_found(
        drawn in any_instance(),
        policy in any_policy(),
        which in any::<[prop::sample::Index; 2]>(),
        count in 1usize..=2,
    ) {
        let instance = drawn.instance();
        let problem = instance.problem(policy);
        let pinned = which.map(|w| instance.candidates[w.index(instance.candidates.len())].goal);
        let pinned = &pinned[..count];
        let found = sequences(&problem, Effort { first: pinned, ..thorough() });
        if let Some(brute) = best_plan(&problem, |plan| plan.goals.starts_with(pinned)) {
            prop_assert_eq!(found.proof, Proof::Proven);
            assert_ranks_as(&problem, &found.best[0], &brute);
            for sequence in &found.best {
                prop_assert!(sequence.goals().take(count).eq(pinned.iter().copied()));
            }
        } else {
            prop_assert_eq!(found.best.len(), 1);
            prop_assert!(found.best[0].stops.is_empty());
            checked(&problem, &found.best[0]);
        }
    }

    /// Alone, again, and beside others at the same time.
    #[test]
    fn every_search_gives_the_same_result(
        drawn in any_instance(),
        policy in any_policy(),
        expansions in prop_oneof![0u64..300, Just(10_000_000)],
    ) {
        let instance = drawn.instance();
        let problem = instance.problem(policy);
        let search = || sequences(&problem, Effort { expansions, ..thorough() });
        let alone = search();
        prop_assert_eq!(&search(), &alone);
        let together: Vec<Sequences> = std::thread::scope(|scope| {
            let threads = [scope.spawn(search), scope.spawn(search)];
            threads.map(|thread| thread.join().expect("a search does not panic")).into()
        });
        for other in together {
            prop_assert_eq!(&other, &alone);
        }
    }
}

/// What is said of a search that may have been cut short is true of the optimum.
fn assert_honest(
    problem: &Problem<'_>,
    found: &Sequences,
    expansions: u64,
    missed: usize,
    optimum: f64,
) {
    let best = &found.best[0];
    checked(problem, best);
    assert!(best.missed >= missed);
    let same = |a: f64, b: f64| same_value(problem.policy, a, b);
    let as_good = best.missed == missed && same(best.value, optimum);
    match found.proof {
        Proof::Proven => assert!(as_good, "{optimum} is possible: {best:?}"),
        Proof::Bound(bound) => {
            assert!(
                bound >= optimum || same(bound, optimum),
                "a bound of {bound}, but {optimum} is possible"
            );
            // Doing nothing, where that cannot end where plans must, costs nothing; any plan may.
            if !is_stranded(problem, best) {
                assert!(bound >= best.value, "a bound of {bound} for {best:?}");
                let as_much = best.value <= optimum || same(best.value, optimum);
                assert!(best.missed > missed || as_much, "{optimum} is the optimum: {best:?}");
            }
        }
    }
    // Rounds of the large-neighbourhood search are finished: a first one, and one more.
    let most = expansions + 2 * (problem.candidates.len() as u64 + 2);
    // The most reliable ways alone are searched too, where there are others.
    let most = if problem.travel.has_alternatives() { 2 * most } else { most };
    assert!(found.expansions <= most, "{} of {expansions} expansions", found.expansions);
}

/// With more goals than can all be tried the proven optimum is what bounds are held against.
#[test]
fn a_bound_is_never_below_the_proven_optimum_of_more_goals() {
    /// Nearly all of these instances are proven with so many.
    const AMPLE: u64 = 30_000;
    let (mut proven, mut all) = (0, 0);
    for seed in 0..21 {
        let goals = 10 + seed as usize % 7;
        let instance = oracle::drawn(goals, 1 + seed as usize % 2, 2, 4, 1000 + seed);
        for policy in Policy::ALL {
            all += 1;
            let problem = instance.problem(policy);
            let optimum = sequences(&problem, Effort { expansions: AMPLE, ..thorough() });
            checked(&problem, &optimum.best[0]);
            if optimum.proof != Proof::Proven {
                continue;
            }
            proven += 1;
            let GoalSequence { missed, value, .. } = optimum.best[0];
            for expansions in [0, 1, 7, 50, 300, 2000] {
                let found = sequences(&problem, Effort { expansions, ..thorough() });
                assert_honest(&problem, &found, expansions, missed, value);
            }
        }
    }
    assert!(proven > all * 3 / 4, "{proven} of {all} were proven");
}

/// Goals to be imaged on ground of one hazard, each at one cell, with nothing else to tell them apart.
fn level(goals: &[(u32, Cell)], heights: Raster<f32>) -> Instance {
    let spec = heights.spec();
    let ground = ground(heights, Raster::filled(spec, 0.001), Raster::filled(spec, false));
    let start = Cell::new(spec.rows() / 2, spec.cols() / 2);
    let cells: Vec<Cell> = std::iter::once(start).chain(goals.iter().map(|g| g.1)).collect();
    let candidate = |(node, &(id, _)): (usize, &(u32, Cell))| {
        Candidate::new(GoalId(id), 1, 0.5, vec![node + 1])
    };
    let candidates = goals.iter().enumerate().map(candidate).collect();
    Instance::new(candidates, travel(&ground, &cells))
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
    let near = |col: usize| Cell::new(1, col);
    // G1, worth least, can be done from the far or the near side of the hazard.
    let candidates = vec![
        Candidate::new(GoalId(1), 1, 0.25, vec![1, 2]),
        Candidate::new(GoalId(2), 1, 0.5, vec![3]),
        Candidate::new(GoalId(3), 1, 0.625, vec![4]),
    ];
    let travel = travel(&ground, &[near(4), near(8), near(6), near(2), near(1)]);
    let mut instance = Instance::new(candidates, travel);
    // Two images fit into the data volume.
    instance.limits = Limits { data_mb: 80.0, ..NO_LIMITS };
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
    let instance = hills(3, 1, 7);
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
        assert_eq!((weighed.prize, weighed.expected), (0.0, 0.0));
        assert!(weighed.time_s > 0.0);
        checked(&instance.problem(policy), &weighed);
    }
}
