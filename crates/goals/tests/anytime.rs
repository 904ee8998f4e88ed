//! Any number of goals and any effort: what is answered is possible, and what is said of it is true.

mod oracle;
#[expect(dead_code, reason = "legs are drawn here, not driven over ground")]
mod rover;

use proptest::prelude::*;
use wisdom_goals::{
    Candidate, Directive, Domain, Effort, FactSet, Fade, GoalId, GoalSequence, Limits,
    OperatorText, Policy, Preferences, Prices, Problem, Proof, Sequences, ServiceCost, Window,
    quantised, sequences, weigh,
};
use wisdom_planner::{CostVector, TravelMatrix};

use oracle::{Draws, Instance, NO_LIMITS, best_plan, checked, close, is_stranded, nodes, stranded};

fn effort(expansions: u64) -> Effort<'static> {
    Effort { expansions, keep: 3, first: &[], clock: None }
}

/// Expansions that may be made beyond those allowed: rounds of the large-neighbourhood search are finished, a first one
/// and one more, and each puts in some of the goals; so are steps of the bound.
fn a_round(problem: &Problem<'_>) -> u64 {
    let goals = problem.candidates.len() as u64;
    2 * (goals + 2) + goals * goals / 2048
}

/// What is said of a search holds, as far as can be told without knowing the optimum. Gives the gap between bound and
/// value.
fn assert_honest(problem: &Problem<'_>, found: &Sequences, expansions: u64) -> f64 {
    assert!(!found.best.is_empty());
    for (index, sequence) in found.best.iter().enumerate() {
        checked(problem, sequence);
        assert!(found.best[index + 1..].iter().all(|worse| sequence.rank(worse).is_lt()));
    }
    // The most reliable ways alone are searched too, where there are others.
    let times = if problem.travel.has_alternatives() { 2 } else { 1 };
    let most = expansions.saturating_add(a_round(problem)).saturating_mul(times);
    assert!(found.expansions <= most, "{} of {expansions} expansions", found.expansions);
    let best = &found.best[0];
    match found.proof {
        Proof::Proven => 0.0,
        Proof::Bound(bound) => {
            assert!(!bound.is_nan());
            // Doing nothing, where that cannot end where plans must, costs nothing; any plan may.
            let above = bound >= best.value || is_stranded(problem, best);
            assert!(above, "a bound of {bound} for {best:?}");
            bound - best.value
        }
    }
}

/// A rover that can do no more than drive.
fn driver(candidates: Vec<Candidate>, travel: TravelMatrix) -> Instance {
    let drive = OperatorText { name: "drive".into(), ..OperatorText::default() };
    let mut instance = Instance::new(candidates, travel);
    let visit = Directive {
        requires: FactSet::EMPTY,
        achieves: FactSet::EMPTY,
        ..instance.directives[1].clone()
    };
    instance.domain = Domain::new(&[drive], &[]).expect("one operator fits itself");
    instance.facts = instance.domain.initial();
    instance.directives = vec![visit];
    instance
}

type Point = (f64, f64);

fn distance(a: Point, b: Point) -> f64 {
    libm::hypot(a.0 - b.0, a.1 - b.1)
}

/// Goals strewn over a square kilometre, prizes from 1 to 10, and time for a part of them at a metre a second; half of
/// the plans come home.
fn planar(goals: usize, seed: u64) -> Instance {
    let mut draws = Draws(seed);
    let mut place = || (draws.between(0.0, 1000.0), draws.between(0.0, 1000.0));
    let places: Vec<Point> = (0..=goals).map(|_| place()).collect();
    let travel = TravelMatrix::from_costs(&nodes(goals + 1), |from, to| {
        let length_m = distance(places[from], places[to]);
        vec![CostVector { length_m, time_s: length_m, energy_j: 0.0, neg_ln_r: 0.0 }]
    });
    let candidates = (0..goals)
        .map(|g| Candidate::new(GoalId(g as u32), 0, (1 + draws.below(10)) as f64, vec![g + 1]));
    let mut instance = driver(candidates.collect(), travel);
    // A shortest tour of many goals is about this long (Beardwood, Halton and Hammersley 1959).
    let tour_m = 0.7124 * 1000.0 * libm::sqrt(goals as f64);
    instance.limits = Limits { time_s: draws.between(0.2, 0.6) * tour_m, ..NO_LIMITS };
    instance.ends = if draws.happens(0.5) { vec![0] } else { Vec::new() };
    instance
}

/// What a rover meets: three poses a goal, a quick and a safe way to some, hazards, two budgets, a floor; windows on
/// some, prizes that fade, goals that exclude others or come after them.
fn roving(goals: usize, seed: u64) -> Instance {
    const POSES: usize = 3;
    let mut draws = Draws(seed);
    let side_m = 100.0 * libm::sqrt(goals as f64);
    let mut places: Vec<Point> = vec![(0.5 * side_m, 0.5 * side_m)];
    for _ in 0..goals {
        let (x, y) = (draws.between(0.0, side_m), draws.between(0.0, side_m));
        for _ in 0..POSES {
            places.push((x + draws.between(-5.0, 5.0), y + draws.between(-5.0, 5.0)));
        }
    }
    let several = draws.happens(0.5);
    let travel = TravelMatrix::from_costs(&nodes(places.len()), |from, to| {
        let length_m = distance(places[from], places[to]);
        let winding = draws.between(1.0, 1.5);
        let leg = |speed: f64, hazard: f64| CostVector {
            length_m,
            time_s: winding * length_m / (0.04 * speed),
            energy_j: winding * length_m * 300.0,
            neg_ln_r: winding * length_m * hazard,
        };
        let mut ways = vec![leg(1.0, 1e-4)];
        if several && draws.happens(0.3) {
            ways.push(leg(2.0, 3e-4));
        }
        ways
    });
    let span_s = 60_000.0;
    let candidates = (0..goals).map(|g| {
        let poses = (1 + g * POSES..=(g + 1) * POSES).collect();
        let prize = quantised(draws.between(0.05, 1.0));
        let mut goal = Candidate::new(GoalId(1000 - g as u32), draws.of(&[0, 1, 1]), prize, poses);
        if draws.happens(0.2) {
            let open_s = draws.between(0.0, 0.7) * span_s;
            goal.window =
                Some(Window { open_s, close_s: open_s + draws.between(0.05, 0.5) * span_s });
        }
        if draws.happens(0.3) {
            let full_until_s = draws.between(0.0, 0.7) * span_s;
            goal.fade = Some(Fade { full_until_s, nothing_from_s: full_until_s + 0.3 * span_s });
        }
        if draws.happens(0.15) {
            goal.excludes.push(GoalId(1000 - draws.below(goals) as u32));
        }
        if g > 0 && draws.happens(0.1) {
            goal.after.push(GoalId(1000 - draws.below(g) as u32));
        }
        goal
    });
    let mut instance = Instance::new(candidates.collect(), travel);
    instance.limits = Limits {
        time_s: draws.between(0.5, 1.0) * span_s,
        energy_j: draws.between(0.5, 1.0) * 1e6,
        data_mb: f64::INFINITY,
        min_reliability: draws.of(&[0.0, 0.5, 0.8]),
    };
    instance.waiting_w = draws.of(&[0.0, 5.0]);
    instance.ends = if draws.happens(0.5) { vec![0] } else { Vec::new() };
    instance.preferences = Preferences {
        confidence: 0.7,
        prices: Prices { risk: 1.0, energy_per_j: 5e-7, time_per_s: 1e-6, data_per_mb: 1e-4 },
    };
    instance
}

/// The same with some goals open for a while only, some that exclude or wait for others, and a second budget.
fn timed(goals: usize, seed: u64) -> Instance {
    let mut instance = planar(goals, seed);
    let mut draws = Draws(seed + 1);
    let span_s = instance.limits.time_s;
    for index in 0..goals {
        let goal = &mut instance.candidates[index];
        goal.service = ServiceCost { time_s: 5.0, energy_j: draws.between(0.0, 2.0), data_mb: 0.0 };
        if draws.happens(0.5) {
            let open_s = draws.between(-0.3, 0.8) * span_s;
            goal.window =
                Some(Window { open_s, close_s: open_s + draws.between(0.0, 0.5) * span_s });
        }
        if draws.happens(0.1) {
            goal.excludes.push(GoalId(draws.below(goals) as u32));
        }
        if index > 0 && draws.happens(0.1) {
            goal.after.push(GoalId(draws.below(index) as u32));
        }
    }
    instance.limits.energy_j = draws.between(0.2, 1.2) * goals as f64;
    instance
}

/// Of 30 to 500 goals in the plane, and of up to 100 with three poses each.
fn instances() -> Vec<Instance> {
    let sizes = [30, 80, 200, 500];
    let shape = |seed| if seed % 3 == 2 { timed } else { planar };
    let planar = (0..12).map(|seed| shape(seed)(sizes[seed as usize % 4], seed));
    let roving = (0..6).map(|seed| roving([30, 60, 100][seed as usize % 3], 100 + seed));
    planar.chain(roving).collect()
}

#[test]
fn whatever_the_effort_the_answer_is_possible_and_the_bound_not_below_it() {
    for (index, instance) in instances().iter().enumerate() {
        let problem = instance.problem(Policy::ALL[index % Policy::ALL.len()]);
        for expansions in [0, 1, 10, 100, 1000] {
            let found = sequences(&problem, effort(expansions));
            assert_honest(&problem, &found, expansions);
            assert_eq!(found, sequences(&problem, effort(expansions)), "two searches differ");
        }
    }
}

/// On some instance more effort may do worse; on the whole it may not.
#[test]
fn the_gap_shrinks_as_effort_is_given() {
    for shape in [planar as fn(usize, u64) -> Instance, roving] {
        let mut mean = [0.0; 3];
        for (seed, goals) in [30, 40, 70, 80].into_iter().enumerate() {
            let instance = shape(goals, 200 + seed as u64);
            let problem = instance.problem(Policy::ExpectedInterest);
            for (times, mean) in [1, 4, 16].into_iter().zip(&mut mean) {
                let expansions = 5 * goals as u64 * times;
                let found = sequences(&problem, effort(expansions));
                let gap = assert_honest(&problem, &found, expansions);
                *mean += gap / (gap + found.best[0].value) / 4.0;
            }
        }
        assert!(mean[0] > mean[1] && mean[1] > mean[2], "mean gaps {mean:?}");
    }
}

/// With little effort too: a goal without a prize, at some distance, that time allows.
#[test]
fn mandatory_goals_are_served_where_that_is_possible() {
    for seed in 0..12 {
        let goals = [12, 30, 80, 200][seed as usize % 4];
        let mut instance = planar(goals, 300 + seed);
        let time_s = |from: usize, to: usize| instance.travel.alternatives(from, to)[0].time_s;
        let mut draws = Draws(seed);
        let forced = [draws.below(goals), draws.below(goals)];
        let back = if instance.ends.is_empty() { 0.0 } else { time_s(forced[1] + 1, 0) };
        let both_s = time_s(0, forced[0] + 1) + time_s(forced[0] + 1, forced[1] + 1) + back;
        for goal in forced {
            instance.candidates[goal].mandatory = true;
            instance.candidates[goal].prize = 0.0;
        }
        // Room for both, and for not much else in some.
        instance.limits.time_s = both_s * draws.between(1.001, 3.0);
        for policy in Policy::ALL {
            let problem = instance.problem(policy);
            let expansions = 30 * goals as u64;
            let found = sequences(&problem, effort(expansions));
            assert_honest(&problem, &found, expansions);
            assert_eq!(found.best[0].missed, 0, "{policy}, {goals} goals, seed {seed}");
        }
    }
}

#[test]
fn goals_pinned_stay_first_whatever_the_effort() {
    for seed in 0..10 {
        let goals = [5, 12, 30, 80, 200][seed as usize % 5];
        let shape = if goals == 200 { planar } else { [planar, roving][seed as usize / 5] };
        let instance = shape(goals, 400 + seed);
        let problem = instance.problem(Policy::ALL[seed as usize % 6]);
        let mut draws = Draws(seed);
        for count in 1..=3 {
            let pinned: Vec<GoalId> =
                (0..count).map(|_| problem.candidates[draws.below(goals)].goal).collect();
            let possible = weigh(&problem, &pinned);
            for expansions in [0, 1, 30, 600] {
                let effort = Effort { first: &pinned, ..effort(expansions) };
                let found = sequences(&problem, effort);
                assert_honest(&problem, &found, expansions);
                for sequence in &found.best {
                    let begins = sequence.goals().take(count).eq(pinned.iter().copied());
                    assert!(
                        begins || possible.is_none(),
                        "{pinned:?} do not come first: {sequence:?}"
                    );
                    assert!(begins || sequence.stops.is_empty(), "{sequence:?}");
                }
                if let Some(possible) = &possible {
                    assert!(
                        !found.best[0].rank(possible).is_gt(),
                        "less than the pinned goals alone"
                    );
                }
            }
        }
    }
}

fn leg(time_s: f64) -> Vec<CostVector> {
    vec![CostVector { length_m: 1.0, time_s, energy_j: time_s, neg_ln_r: 0.01 * time_s }]
}

/// Some goals in a row, a second apart; the rover begins at the left end.
fn row(goals: usize) -> Instance {
    let travel =
        TravelMatrix::from_costs(&nodes(goals + 1), |from, to| leg(from.abs_diff(to) as f64));
    let candidates = (0..goals).map(|g| Candidate::new(GoalId(g as u32), 0, 1.0, vec![g + 1]));
    driver(candidates.collect(), travel)
}

fn order(instance: &Instance, policy: Policy, effort: Effort<'_>) -> Vec<u32> {
    let problem = instance.problem(policy);
    let found = sequences(&problem, effort);
    assert_honest(&problem, &found, effort.expansions);
    found.best[0].goals().map(|g| g.0).collect()
}

/// Under every policy, by labels alone and by all parts of the search.
fn each_way(
    goals: usize,
    mut change: impl FnMut(&mut Instance),
    mut check: impl FnMut(&Instance, Policy, &[u32]),
) {
    for more in [0, 70] {
        let mut instance = row(goals + more);
        // The others are out of reach.
        for candidate in &mut instance.candidates[goals..] {
            candidate.poses.clear();
        }
        instance.preferences.prices = Prices::NONE;
        instance.preferences.confidence = 0.0;
        change(&mut instance);
        for policy in Policy::ALL {
            let found = order(&instance, policy, effort(3000));
            check(&instance, policy, &found);
        }
    }
}

#[test]
fn without_goals_nothing_is_done_and_that_is_proven() {
    let mut instance = row(1);
    instance.candidates.clear();
    for ends in [vec![], vec![1]] {
        instance.ends = ends;
        for policy in Policy::ALL {
            for expansions in [0, 10] {
                let problem = instance.problem(policy);
                let found = sequences(&problem, effort(expansions));
                assert_honest(&problem, &found, expansions);
                assert!(found.best[0].stops.is_empty());
                assert!(expansions == 0 || found.proof == Proof::Proven);
            }
        }
    }
}

#[test]
fn goals_without_poses_or_ways_are_left_out() {
    each_way(3, |row| row.candidates[1].poses.clear(), |_, _, found| assert_eq!(found, [0, 2]));
    let cut_off = |row: &mut Instance| {
        row.travel = TravelMatrix::from_costs(row.travel.nodes(), |from, to| {
            if to == 2 { Vec::new() } else { leg(from.abs_diff(to) as f64) }
        });
    };
    each_way(3, cut_off, |_, _, found| assert_eq!(found, [0, 2]));
}

#[test]
fn nothing_can_be_done_with_nothing() {
    let limits = [
        Limits { time_s: 0.0, ..NO_LIMITS },
        Limits { energy_j: 0.0, ..NO_LIMITS },
        Limits { min_reliability: 1.0, ..NO_LIMITS },
    ];
    for limits in limits {
        each_way(3, |row| row.limits = limits, |_, _, found| assert_eq!(found, [0; 0]));
    }
    // These cost no data.
    let limits = Limits { data_mb: 0.0, ..NO_LIMITS };
    each_way(3, |row| row.limits = limits, |_, _, found| assert_eq!(found, [0, 1, 2]));
}

#[test]
fn everything_is_done_where_nothing_is_short() {
    each_way(3, |_| (), |_, _, found| assert_eq!(found, [0, 1, 2]));
    for goals in [30, 200] {
        let free = Instance { limits: NO_LIMITS, ..planar(goals, 9) };
        let problem = free.problem(Policy::MostInteresting);
        let found = sequences(&problem, effort(2000));
        assert_honest(&problem, &found, 2000);
        let all: f64 = problem.candidates.iter().map(|c| c.prize).sum();
        assert_eq!(found.best[0].value, all);
        assert!(matches!(found.proof, Proof::Proven) || found.proof == Proof::Bound(all));
    }
}

/// The clock of these goes on whenever it is looked at; there is no other end to the effort.
#[test]
fn the_search_ends_when_its_time_is_over() {
    for instance in [planar(12, 1), planar(40, 2), planar(120, 3), timed(80, 4), roving(30, 5)] {
        for (from, step) in [(0.0, 0.002), (0.0, 0.3), (1.0, 0.001), (2.0, 0.001)] {
            let looks = std::cell::Cell::new(0.0);
            let clock = || {
                looks.set(looks.get() + 1.0);
                from + step * looks.get()
            };
            let problem = instance.problem(Policy::ExpectedInterest);
            let found = sequences(&problem, Effort { clock: Some(&clock), ..effort(u64::MAX) });
            assert_honest(&problem, &found, u64::MAX);
        }
    }
}

#[test]
fn where_no_end_can_be_reached_nothing_is_done() {
    let apart = |row: &mut Instance| {
        row.travel = TravelMatrix::from_costs(row.travel.nodes(), |from, to| {
            if to == 3 { Vec::new() } else { leg(from.abs_diff(to) as f64) }
        });
        row.ends = vec![3];
        row.candidates[2].poses.clear();
        row.candidates[0].mandatory = true;
    };
    each_way(3, apart, |instance, policy, found| {
        assert_eq!(found, [0; 0]);
        let problem = instance.problem(policy);
        assert_eq!(sequences(&problem, effort(100)).best, [stranded(&problem)]);
    });
}

/// The only way home leads through a goal.
#[test]
fn an_end_out_of_reach_of_the_start_may_be_in_reach_of_a_goal() {
    let through = |row: &mut Instance| {
        row.travel = TravelMatrix::from_costs(row.travel.nodes(), |from, to| {
            if to == 3 && from != 2 { Vec::new() } else { leg(from.abs_diff(to) as f64) }
        });
        row.ends = vec![3];
        row.candidates[2].poses.clear();
    };
    each_way(3, through, |_, _, found| assert_eq!(found, [0, 1]));
    // The same when the first of the two is pinned.
    let mut instance = row(3);
    through(&mut instance);
    for policy in Policy::ALL {
        let first = [GoalId(0)];
        assert_eq!(order(&instance, policy, Effort { first: &first, ..effort(1000) }), [0, 1]);
    }
}

#[test]
fn a_window_that_has_closed_shuts_its_goal_out() {
    let closed = |open_s: f64, close_s: f64| {
        move |row: &mut Instance| row.candidates[1].window = Some(Window { open_s, close_s })
    };
    let shut_out = |_: &Instance, _: Policy, found: &[u32]| assert_eq!(found, [0, 2]);
    each_way(3, closed(-10.0, -5.0), shut_out);
    each_way(3, closed(0.0, 1.0), shut_out);
    each_way(3, closed(0.0, 2.0), |_, _, found| assert_eq!(found, [0, 1, 2]));
    each_way(3, closed(f64::NEG_INFINITY, f64::INFINITY), |_, _, found| {
        assert_eq!(found, [0, 1, 2]);
    });
}

/// Who comes before it opens waits, and may then not begin: it has closed by then.
#[test]
fn a_window_that_closes_before_it_opens_shuts_its_goal_out() {
    let window = Window { open_s: 20.0, close_s: 10.0 };
    each_way(
        3,
        |row| row.candidates[1].window = Some(window),
        |_, _, found| assert_eq!(found, [0, 2]),
    );
}

/// Waiting draws power: setting out by the slower and dearer way is the cheaper in the end, and alone within the budget.
#[test]
fn who_comes_early_and_waits_does_not_hide_who_comes_later() {
    let way = |time_s, energy_j| CostVector { length_m: 1.0, time_s, energy_j, neg_ln_r: 0.0 };
    let travel = TravelMatrix::from_costs(&nodes(3), |from, to| match (from, to) {
        (0, 1) => vec![way(10.0, 10.0), way(20.0, 11.0)],
        (1, 2) => vec![way(0.0, 0.0)],
        _ => Vec::new(),
    });
    let mut instance = Instance { travel, waiting_w: 1.0, ..row(2) };
    instance.candidates[1].window = Some(Window { open_s: 40.0, close_s: 100.0 });
    // Waiting from 10 s to 40 s draws 30 J, from 20 s on 20 J.
    instance.limits.energy_j = 35.0;
    for policy in Policy::ALL {
        let problem = instance.problem(policy);
        let found = sequences(&problem, effort(100)).best.swap_remove(0);
        assert_eq!(found.energy_j, 31.0, "{policy}: {found:?}");
        assert_eq!((found.stops[0].alternative, found.stops[1].wait_s), (1, 20.0));
        assert_eq!(weigh(&problem, &[GoalId(0), GoalId(1)]), Some(found));
    }
}

#[test]
fn a_goal_after_one_that_nobody_knows_is_never_done() {
    let orphan = |row: &mut Instance| row.candidates[1].after = vec![GoalId(7777)];
    each_way(3, orphan, |_, _, found| assert_eq!(found, [0, 2]));
    let itself = |row: &mut Instance| row.candidates[1].after = vec![GoalId(1)];
    each_way(3, itself, |_, _, found| assert_eq!(found, [0, 2]));
    // Nor are two that wait for each other, nor one that waits for what cannot be done.
    let ring = |row: &mut Instance| {
        row.candidates[1].after = vec![GoalId(2)];
        row.candidates[2].after = vec![GoalId(1)];
    };
    each_way(3, ring, |_, _, found| assert_eq!(found, [0]));
    let last = |row: &mut Instance| row.candidates[0].after = vec![GoalId(2), GoalId(2)];
    each_way(3, last, |_, _, found| assert_eq!(found, [1, 2, 0]));
}

#[test]
fn a_goal_does_not_exclude_itself_and_naming_one_twice_says_no_more() {
    let itself = |row: &mut Instance| row.candidates[1].excludes = vec![GoalId(1), GoalId(7777)];
    each_way(3, itself, |_, _, found| assert_eq!(found, [0, 1, 2]));
    let twice = |row: &mut Instance| {
        row.candidates[0].excludes = vec![GoalId(1); 3];
        row.candidates[1].excludes = vec![GoalId(0), GoalId(0)];
    };
    each_way(3, twice, |_, _, found| assert!(found == [0, 2] || found == [1, 2], "{found:?}"));
}

/// Where nothing has a price, they may be done or not; nothing is lost by either.
#[test]
fn goals_without_prizes_are_worth_nothing() {
    for more in [0, 70] {
        let mut instance = row(3 + more);
        for candidate in &mut instance.candidates {
            candidate.prize = 0.0;
        }
        for policy in Policy::ALL {
            let problem = instance.problem(policy);
            let found = sequences(&problem, effort(2000));
            assert_honest(&problem, &found, 2000);
            assert_eq!(found.best[0].value, 0.0);
            assert!(matches!(found.proof, Proof::Proven | Proof::Bound(0.0)), "{:?}", found.proof);
        }
    }
}

/// A number that is drawn, or one of those at the edge of what is allowed.
fn wild(most: f64) -> impl Strategy<Value = f64> {
    prop_oneof![3 => 0.0..most, 1 => Just(0.0), 1 => Just(most)]
}

fn wild_or_infinite(most: f64) -> impl Strategy<Value = f64> {
    prop_oneof![3 => wild(most), 1 => Just(f64::INFINITY)]
}

prop_compose! {
    fn any_leg()(time_s in wild(10.0), energy_j in wild(10.0), neg_ln_r in wild(0.5)) -> CostVector {
        CostVector { length_m: 1.0, time_s, energy_j, neg_ln_r }
    }
}

prop_compose! {
    fn any_candidate()(
        (prize, poses) in (wild(3.0), prop::collection::vec(0usize..6, 0..3)),
        (time_s, energy_j, data_mb) in (wild(5.0), wild(5.0), wild(5.0)),
        window in prop::option::weighted(0.3, (
            prop_oneof![-5.0..20.0, Just(f64::NEG_INFINITY), Just(0.0)], wild_or_infinite(10.0)
        )),
        fade in prop::option::weighted(0.3, (-5.0..30.0f64, wild(10.0))),
        mandatory in prop::bool::weighted(0.2),
        after in prop::collection::vec(0u32..14, 0..2),
        excludes in prop::collection::vec(0u32..14, 0..4),
    ) -> Candidate {
        let name = |ids: Vec<u32>| ids.into_iter().map(GoalId).collect();
        Candidate {
            service: ServiceCost { time_s, energy_j, data_mb },
            window: window.map(|(open_s, lasts_s)| {
                let from_s = if open_s == f64::NEG_INFINITY { 0.0 } else { open_s };
                Window { open_s, close_s: from_s + lasts_s }
            }),
            fade: fade.map(|(full_until_s, lasts_s)| {
                Fade { full_until_s, nothing_from_s: full_until_s + lasts_s }
            }),
            mandatory,
            after: if mandatory { Vec::new() } else { name(after) },
            excludes: name(excludes),
            ..Candidate::new(GoalId(0), 0, quantised(prize), poses)
        }
    }
}

prop_compose! {
    fn any_wild_instance()(
        mut candidates in prop_oneof![
            prop::collection::vec(any_candidate(), 0..5),
            prop::collection::vec(any_candidate(), 5..14),
            prop::collection::vec(any_candidate(), 60..75),
        ],
        legs in prop::collection::vec(prop::collection::vec(any_leg(), 0..3), 36),
        ends in prop::collection::vec(0usize..6, 0..3),
        (time_s, energy_j, data_mb) in (wild_or_infinite(40.0), wild_or_infinite(40.0), wild_or_infinite(20.0)),
        min_reliability in wild(1.0),
        waiting_w in wild(2.0),
        (confidence, risk) in (wild(1.0), wild(2.0)),
        (energy_per_j, time_per_s, data_per_mb) in (wild(0.1), wild(0.1), wild(0.1)),
    ) -> Instance {
        for (index, candidate) in candidates.iter_mut().enumerate() {
            candidate.goal = GoalId(index as u32);
        }
        let travel = TravelMatrix::from_costs(&nodes(6), |from, to| legs[from * 6 + to].clone());
        let mut instance = driver(candidates, travel);
        instance.ends = ends;
        instance.limits = Limits { time_s, energy_j, data_mb, min_reliability };
        instance.waiting_w = waiting_w;
        let prices = Prices { risk, energy_per_j, time_per_s, data_per_mb };
        instance.preferences = Preferences { confidence, prices };
        instance
    }
}

impl std::fmt::Debug for Instance {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let legs =
            |from| (0..self.travel.nodes().len()).map(move |to| self.travel.alternatives(from, to));
        f.debug_struct("Instance")
            .field("candidates", &self.candidates)
            .field(
                "legs",
                &(0..self.travel.nodes().len())
                    .map(|from| legs(from).collect())
                    .collect::<Vec<Vec<_>>>(),
            )
            .field("ends", &self.ends)
            .field("limits", &self.limits)
            .field("waiting_w", &self.waiting_w)
            .field("preferences", &self.preferences)
            .finish_non_exhaustive()
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    /// Costs, prizes and limits of nothing or without end, poses and ends shared, legs that lead nowhere.
    #[test]
    fn no_number_that_is_allowed_leads_astray(
        instance in any_wild_instance(),
        policy in prop::sample::select(&Policy::ALL[..]),
        expansions in prop_oneof![Just(0u64), 0u64..50, 0u64..3000],
        pinned in prop::collection::vec(0u32..5, 0..3),
    ) {
        let problem = instance.problem(policy);
        let pinned: Vec<GoalId> = pinned.into_iter().map(GoalId).collect();
        let found = sequences(&problem, effort(expansions));
        assert_honest(&problem, &found, expansions);
        let found = sequences(&problem, Effort { first: &pinned, ..effort(expansions) });
        assert_honest(&problem, &found, expansions);
        if problem.candidates.len() < 5 {
            let found = sequences(&problem, effort(10_000_000));
            prop_assert_eq!(found.proof, Proof::Proven);
            match best_plan(&problem, |_| true) {
                Some(brute) => {
                    prop_assert_eq!(found.best[0].missed, brute.missed, "{:?}", brute);
                    let same = close(found.best[0].value, brute.value);
                    prop_assert!(same, "{:?}\n{:?}", brute, found.best[0]);
                }
                None => prop_assert!(is_stranded(&problem, &found.best[0])),
            }
        }
    }
}

/// Nothing at all is left of a family of none.
#[test]
fn a_family_holds_one_sequence_at_least() {
    let instance = planar(30, 1);
    let problem = instance.problem(Policy::ExpectedInterest);
    let found = sequences(&problem, Effort { keep: 0, ..effort(500) });
    assert_eq!(found.best.len(), 1);
    assert_ne!(found.best[0], GoalSequence::empty());
}
