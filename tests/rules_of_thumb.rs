//! What rules of thumb cost, on few and small instances: the yardstick is right, and the shares are shares.

#[allow(dead_code, reason = "shared with the example, which needs more of it")]
#[path = "../examples/rules_of_thumb/study/mod.rs"]
mod study;

use study::instance::{Generator, Hazards, Instance, Leg, Posed};
use study::rule::Rule;
use study::summary::{ranking, summaries};
use study::{OPTIMAL, Study, judge};
use wisdom_goals::{GoalId, Policy, weigh};

/// Sums in another order differ by some units in the last place.
const ROUNDING: f64 = 1e-12;

const GOALS: usize = 6;

fn small_instances() -> impl Iterator<Item = Instance> {
    Generator::all()
        .into_iter()
        .flat_map(|generator| (0..15).map(move |n| Instance::draw(&generator, GOALS, 7, n)))
}

/// Every order of every set of goals within the budget, the empty one too.
fn all_orders(instance: &Instance) -> Vec<Vec<usize>> {
    let (mut orders, mut next) = (vec![Vec::new()], 0);
    while next < orders.len() {
        for goal in 0..instance.prizes.len() {
            let mut longer = orders[next].clone();
            if !longer.contains(&goal) {
                longer.push(goal);
                orders.push(longer);
            }
        }
        next += 1;
    }
    orders.retain(|order| instance.fits(order));
    orders
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(f64::NEG_INFINITY, f64::max)
}

/// Sites on a line, the start at 0, with hazard rates by pair of places.
fn on_a_line(
    sites: &[(f64, f64)],
    budget_m: f64,
    hazard: impl Fn(usize, usize) -> f64,
) -> Instance {
    let places: Vec<f64> = std::iter::once(0.0).chain(sites.iter().map(|site| site.0)).collect();
    let leg = |a: usize, b: usize| {
        let length_m = (places[a] - places[b]).abs();
        Leg { length_m, neg_ln_r: hazard(a.min(b), a.max(b)) * length_m }
    };
    let row = |a| (0..places.len()).map(|b| leg(a, b)).collect();
    let prizes: Vec<f64> = sites.iter().map(|site| site.1).collect();
    Instance::new(&prizes, (0..places.len()).map(row).collect(), budget_m)
}

#[test]
fn the_yardstick_is_what_trying_every_order_finds() {
    for instance in small_instances() {
        let found = judge(&instance);
        let most = largest(all_orders(&instance).iter().map(|o| instance.drive(o).expected));
        assert!(most > 0.0 && found[0].proven, "{instance:?}");
        assert!((found[0].drive.expected - most).abs() <= ROUNDING, "{instance:?}");
    }
}

#[test]
fn no_rule_beats_the_optimum_of_expected_interest() {
    let mut lost = 0;
    for instance in small_instances() {
        for (rule, found) in Rule::ALL.into_iter().zip(judge(&instance)) {
            assert!(
                (-ROUNDING..=1.0).contains(&found.loss),
                "{rule:?}: {} of {instance:?}",
                found.loss
            );
            lost += usize::from(found.loss > OPTIMAL);
        }
    }
    assert!(lost > 100, "rules other than the optimum lose something, but only {lost} did");
}

#[test]
fn every_plan_keeps_the_budget_and_visits_no_goal_twice() {
    for instance in small_instances() {
        for rule in Rule::ALL {
            let order = rule.choose(&instance).order;
            assert!(instance.fits(&order), "{rule:?} of {instance:?}");
            assert!(order.iter().enumerate().all(|(i, goal)| !order[..i].contains(goal)));
            assert!(order.iter().all(|goal| *goal < GOALS));
        }
    }
}

#[test]
fn policies_find_the_best_plan_in_their_own_terms() {
    for instance in small_instances() {
        let drives: Vec<_> = all_orders(&instance).iter().map(|o| instance.drive(o)).collect();
        let found = |rule: Rule| instance.drive(&rule.choose(&instance).order);

        let j2 = found(Rule::Best(Policy::AllOrNothing));
        let most = largest(drives.iter().map(|d| d.prize * d.reliability));
        assert!((j2.prize * j2.reliability - most).abs() <= ROUNDING);

        let net = found(Rule::Best(Policy::NetBenefit));
        let most = largest(drives.iter().map(|d| d.prize + libm::log(d.reliability)));
        assert!((net.prize + libm::log(net.reliability) - most).abs() <= ROUNDING);

        let cc = found(Rule::Best(Policy::ChanceConstrained));
        let most = largest(drives.iter().filter(|d| d.reliability >= 0.8).map(|d| d.prize));
        assert!(cc.reliability >= 0.8 && cc.prize == most);

        // The same greatest sum of prizes: one by its most reliable plan, one by its shortest.
        let most = largest(drives.iter().map(|d| d.prize));
        let richest = || drives.iter().filter(|d| d.prize == most);
        let lex = found(Rule::Best(Policy::MostInteresting));
        assert!(lex.prize == most);
        assert!((lex.reliability - largest(richest().map(|d| d.reliability))).abs() <= ROUNDING);
        let j0 = found(Rule::MostPrize);
        let shortest = richest().map(|d| d.length_m).fold(f64::INFINITY, f64::min);
        assert!(j0.prize == most && (j0.length_m - shortest).abs() <= 1e-9);
    }
}

#[test]
fn plans_are_weighed_as_the_sequencer_weighs_them() {
    for instance in small_instances() {
        let posed = Posed::of(&instance, Hazards::Told);
        let problem = posed.problem(Policy::ExpectedInterest);
        for rule in Rule::ALL {
            let order = rule.choose(&instance).order;
            let ids: Vec<GoalId> = order.iter().map(|goal| GoalId(*goal as u32)).collect();
            let weighed = weigh(&problem, &ids).expect("the order is within the budget");
            let drive = instance.drive(&order);
            assert!((weighed.expected - drive.expected).abs() <= ROUNDING, "{rule:?}");
            assert!((weighed.reliability - drive.reliability).abs() <= ROUNDING, "{rule:?}");
        }
    }
}

#[test]
fn where_all_legs_are_safe_every_policy_is_as_good_as_the_optimum() {
    for number in 0..10 {
        let [base, ..] = Generator::all();
        let safe = Generator { hazard_per_m: [1e-15, 1e-15], ..base };
        let instance = Instance::draw(&safe, GOALS, 7, number);
        for (rule, found) in Rule::ALL.into_iter().zip(judge(&instance)).take(6) {
            assert!(found.loss <= OPTIMAL, "{rule:?} loses {}", found.loss);
        }
    }
}

#[test]
fn the_budget_is_a_share_of_the_shortest_way_through_all_goals() {
    for generator in Generator::all() {
        for number in 0..5 {
            let mut instance = Instance::draw(&generator, GOALS, 7, number);
            let budget_m = instance.budget_m;
            instance.budget_m = f64::INFINITY;
            let shortest = all_orders(&instance)
                .iter()
                .filter(|order| order.len() == GOALS)
                .map(|order| instance.drive(order).length_m)
                .fold(f64::INFINITY, f64::min);
            assert!((budget_m - generator.budget_share * shortest).abs() < 1e-9);
        }
    }
}

/// Prizes 0.9 at 6 m, 0.8 at −1 m, 0.5 at 3 m, 0.3 at −2 m; 14 m may be driven.
#[test]
fn greedy_rules_do_what_their_names_say() {
    let sites = [(6.0, 0.9), (-1.0, 0.8), (3.0, 0.5), (-2.0, 0.3)];
    // The leg from the start to −1 m is hazardous.
    let hazard = |a, b| if (a, b) == (0, 2) { 2.0 } else { 0.01 };
    let instance = on_a_line(&sites, 14.0, hazard);
    // 6 m out, 7 m back to −1 m; 3 m is no longer within reach, −2 m is.
    assert_eq!(Rule::NextByPrize.choose(&instance).order, [0, 1, 3]);
    // −1 m before 6 m makes 8 m; 3 m lies between them; −2 m adds 2 m before −1 m or after it: the first is taken.
    assert_eq!(Rule::PlacedByPrize.choose(&instance).order, [3, 1, 2, 0]);
    // 0.8 a metre to −1 m, then 0.3 to −2 m; from there 6 m has 0.9 for 8 m, which is more than 0.5 for 5 m.
    assert_eq!(Rule::NextByRate.choose(&instance).order, [1, 3, 0, 2]);
    // Two in fifteen arrive at −1 m: 0.11 a metre. To 3 m it is 0.16, and 0.29 on to 6 m; of −1 m and −2 m, then
    // 7 m and 8 m off, the first has the higher prize too.
    assert_eq!(Rule::NextByExpectedRate.choose(&instance).order, [2, 0, 1, 3]);
}

#[test]
fn shares_add_up_and_the_summary_is_of_its_losses() {
    let study = Study { instances: 40, goals: GOALS, seed: 3 };
    for generator in Generator::all() {
        let found = study.run(&generator, || ());
        let summaries = summaries(&found, study.seed);
        let shares: f64 = summaries.iter().filter_map(|s| s.best_of_rest).sum();
        assert!((shares - 1.0).abs() < 1e-9, "{shares}");
        for (index, summary) in summaries.iter().enumerate() {
            let losses: Vec<f64> = found.iter().map(|instance| instance[index].loss).collect();
            let mean = losses.iter().sum::<f64>() / losses.len() as f64;
            assert!((summary.mean.mean - mean).abs() < ROUNDING);
            assert!(summary.mean.low <= mean && mean <= summary.mean.high);
            let above = |limit: f64| losses.iter().filter(|loss| **loss > limit).count();
            assert_eq!(summary.optimal + above(OPTIMAL), 40);
            assert!(above(summary.median) <= 20 && above(summary.percentile_95) <= 2);
            assert!(above(summary.worst) == 0 && losses.contains(&summary.worst));
        }
        assert!(summaries[0].optimal == 40 && summaries[0].proven == 40);
    }
}

#[test]
fn the_ranking_goes_by_mean_loss_from_the_optimum_down() {
    let study = Study { instances: 40, goals: GOALS, seed: 3 };
    let found = study.run(&Generator::all()[0], || ());
    let summaries = summaries(&found, study.seed);
    let mean = |rule: Rule| {
        summaries.iter().find(|s| s.rule == rule).expect("every rule has a summary").mean.mean
    };
    let steps = ranking(&found, study.seed);
    assert_eq!(steps.len(), Rule::ALL.len() - 1);
    assert_eq!(steps[0].better, Rule::Best(Policy::ExpectedInterest));
    for step in &steps {
        let difference = mean(step.worse) - mean(step.better);
        assert!((step.difference.mean - difference).abs() < ROUNDING && difference >= 0.0);
    }
    assert!(steps.windows(2).all(|pair| pair[0].worse == pair[1].better));
}

#[test]
fn one_thread_and_three_find_the_same_bits() {
    let study = Study { instances: 12, goals: GOALS, seed: 5 };
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| {
            let found = study.run(&Generator::all()[1], || ());
            let summaries = summaries(&found, study.seed);
            (found, summaries)
        })
    };
    assert!(run(1) == run(3));
}

#[test]
fn another_seed_gives_other_instances_and_generators_share_their_sites() {
    let [base, tight, hazardous, _] = Generator::all();
    let draw = |generator, seed| Instance::draw(&generator, GOALS, seed, 0);
    assert_ne!(draw(base, 1), draw(base, 2));
    assert_eq!(draw(base, 1), draw(base, 1));
    for other in [draw(tight, 1), draw(hazardous, 1)] {
        assert_eq!(other.prizes, draw(base, 1).prizes);
        assert_eq!(other.leg(0, 3).length_m, draw(base, 1).leg(0, 3).length_m);
    }
    let [mild, wild] = [base, hazardous].map(|g| draw(g, 1).leg(1, 2).neg_ln_r);
    assert!((wild / mild - 3.0).abs() < 1e-9);
}
