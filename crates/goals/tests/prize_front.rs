//! The front of (sum of prizes, reliability) is what trying everything finds.

mod oracle;
#[expect(dead_code, reason = "legs are drawn here, not driven over ground")]
mod rover;

use proptest::prelude::*;
use wisdom_goals::{Effort, GoalSequence, Policy, PrizeFront, Problem, prize_front};

use oracle::{Instance, all_plans, checked};

fn effort(expansions: u64) -> Effort<'static> {
    Effort { expansions, keep: 1, first: &[], clock: None }
}

/// Sum of prizes and reliability.
type Point = (f64, f64);

fn beats(a: Point, b: Point) -> bool {
    a.0 >= b.0 && a.1 >= b.1 && a != b
}

/// The problem that a front is about: mandatory goals are not forced, and no objective has its own floor.
fn asked<'a>(problem: &Problem<'a>) -> Problem<'a> {
    Problem { policy: Policy::MostInteresting, ..*problem }
}

/// The points that no plan beats, largest sum of prizes first.
fn brute_front(problem: &Problem<'_>) -> Vec<Point> {
    let mut front: Vec<Point> = Vec::new();
    all_plans(&asked(problem), &mut |plan| {
        let new = (plan.prize, plan.reliability);
        if !front.iter().any(|&known| beats(known, new) || known == new) {
            front.retain(|&known| !beats(new, known));
            front.push(new);
        }
    });
    front.sort_by(|a, b| b.partial_cmp(a).expect("these are numbers"));
    front
}

fn point(plan: &GoalSequence) -> Point {
    (plan.prize, plan.reliability)
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
        let Self { goals, poses, seed } = self;
        oracle::drawn(goals, poses, 2, goals.min(4), seed)
    }
}

fn any_instance() -> impl Strategy<Value = Drawn> {
    let size = prop_oneof![(0usize..=5, 1usize..=2), (6usize..=7, 1usize..=1)];
    (size, any::<u64>()).prop_map(|((goals, poses), seed)| Drawn { goals, poses, seed })
}

fn any_policy() -> impl Strategy<Value = Policy> {
    prop::sample::select(&Policy::ALL[..])
}

/// What a plan of a front tells of itself is so. Mandatory goals are not counted there.
fn check(problem: &Problem<'_>, plan: &GoalSequence) {
    let candidates: Vec<_> = problem
        .candidates
        .iter()
        .map(|c| wisdom_goals::Candidate { mandatory: false, ..c.clone() })
        .collect();
    checked(&Problem { candidates: &candidates, ..asked(problem) }, plan);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    /// To the last bit, one plan a point, whatever the policy.
    #[test]
    fn the_front_is_what_trying_everything_finds(drawn in any_instance(), policy in any_policy()) {
        let instance = drawn.instance();
        let problem = instance.problem(policy);
        let PrizeFront { plans, complete, .. } = prize_front(&problem, effort(10_000_000));
        prop_assert!(complete);
        let found: Vec<Point> = plans.iter().map(point).collect();
        prop_assert_eq!(found, brute_front(&problem));
        for plan in &plans {
            check(&problem, plan);
        }
    }

    /// However early it is stopped: plans that are possible, none of them beaten by another, nor equal to it; and it is
    /// said that there may be more.
    #[test]
    fn a_front_cut_short_holds_plans_that_are_possible(
        drawn in any_instance(), policy in any_policy(), expansions in 0u64..200,
    ) {
        let instance = drawn.instance();
        let problem = instance.problem(policy);
        let whole = prize_front(&problem, effort(10_000_000));
        let part = prize_front(&problem, effort(expansions));
        prop_assert!(part.expansions <= expansions);
        prop_assert_eq!(part.complete, whole.expansions <= expansions);
        prop_assert!(!part.complete || part == whole);
        for (index, plan) in part.plans.iter().enumerate() {
            check(&problem, plan);
            let reached = |other: &GoalSequence| point(other) == point(plan) || beats(point(other), point(plan));
            prop_assert!(whole.plans.iter().any(reached), "a plan that the whole front does not reach: {:?}", plan);
            let falls = |other: &GoalSequence| other.prize < plan.prize && other.reliability > plan.reliability;
            prop_assert!(part.plans[index + 1..].iter().all(falls));
        }
    }

    /// The front of the plans that begin with some goal.
    #[test]
    fn a_front_holds_only_plans_that_begin_as_asked(
        drawn in any_instance(), which in any::<prop::sample::Index>(),
    ) {
        let instance = drawn.instance();
        prop_assume!(!instance.candidates.is_empty());
        let problem = instance.problem(Policy::ExpectedInterest);
        let first = [instance.candidates[which.index(instance.candidates.len())].goal];
        let mut best: Option<Point> = None;
        all_plans(&asked(&problem), &mut |plan| {
            let new = (plan.prize, plan.reliability);
            if plan.goals.starts_with(&first) && best.is_none_or(|known| new > known) {
                best = Some(new);
            }
        });
        let front = prize_front(&problem, Effort { first: &first, ..effort(10_000_000) });
        prop_assert_eq!(front.plans.first().map(point), best);
        for plan in &front.plans {
            check(&problem, plan);
            prop_assert_eq!(plan.goals().next(), Some(first[0]));
        }
    }
}

/// The instances are not so poor that anything would pass.
#[test]
fn the_fronts_hold_several_plans() {
    let sizes = (0..100).map(|seed| {
        let instance = Drawn { goals: 4, poses: 2, seed }.instance();
        prize_front(&instance.problem(Policy::Utility), effort(10_000_000)).plans.len()
    });
    let several = sizes.filter(|&size| size > 2).count();
    assert!(several > 20, "{several} of 100 fronts hold more than two plans");
}

/// There is no plan to begin with a goal that is no candidate.
#[test]
fn a_front_that_is_to_begin_with_an_unknown_goal_is_empty() {
    let instance = Drawn { goals: 3, poses: 1, seed: 1 }.instance();
    let first = [wisdom_goals::GoalId(7)];
    let front = prize_front(
        &instance.problem(Policy::ExpectedInterest),
        Effort { first: &first, ..effort(100) },
    );
    assert_eq!(front.plans, []);
}
