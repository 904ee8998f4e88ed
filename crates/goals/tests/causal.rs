//! Every order that a causal graph allows is a valid STRIPS plan.

#[expect(dead_code, reason = "legs are made here, not driven over ground")]
mod rover;

use proptest::prelude::*;
use wisdom_goals::{
    Candidate, CausalGraph, Directive, Domain, Effort, FactSet, GoalId, GoalSequence, Limits, Link,
    Policy, Preferences, Problem, quantised, sequences,
};
use wisdom_grid::Cell;
use wisdom_planner::{CostVector, TravelMatrix};

use rover::{directives, domain, names};

/// The best sequence of goals of these directives along a road.
fn sequence(
    domain: &Domain,
    pool: &[Directive],
    of: &[usize],
    facts: FactSet,
) -> (GoalSequence, impl Fn(GoalId) -> Directive) {
    let candidates: Vec<_> = of
        .iter()
        .enumerate()
        .map(|(i, &d)| Candidate::new(GoalId(i as u32), d, quantised(0.5), vec![i + 1]))
        .collect();
    let nodes: Vec<Cell> = (0..=of.len()).map(|col| Cell::new(0, col)).collect();
    let travel = TravelMatrix::from_costs(&nodes, |from, to| {
        let length_m = from.abs_diff(to) as f64;
        vec![CostVector { length_m, time_s: length_m, energy_j: 0.0, neg_ln_r: 0.01 * length_m }]
    });
    let problem = Problem {
        candidates: &candidates,
        travel: &travel,
        ends: &[],
        domain,
        directives: pool,
        facts,
        limits: Limits {
            time_s: f64::INFINITY,
            energy_j: f64::INFINITY,
            data_mb: f64::INFINITY,
            min_reliability: 0.0,
        },
        waiting_w: 0.0,
        policy: Policy::ExpectedInterest,
        preferences: Preferences::default(),
    };
    let effort = Effort { expansions: 10_000, keep: 1, first: &[], clock: None };
    let best = sequences(&problem, effort).best.swap_remove(0);
    let (pool, of) = (pool.to_vec(), of.to_vec());
    (best, move |goal: GoalId| pool[of[goal.0 as usize]].clone())
}

/// Some order of the steps that respects all links: of those that may come next the one that draws the least.
fn some_order(graph: &CausalGraph, draws: &[u16]) -> Vec<usize> {
    let count = graph.steps().count();
    let mut order = Vec::new();
    while order.len() < count {
        let is_ready = |step: &usize| {
            !order.contains(step)
                && graph.links().all(|(from, to, _)| to != *step || order.contains(&from))
        };
        let next =
            (0..count).filter(is_ready).min_by_key(|s| draws[(s + order.len()) % draws.len()]);
        order.push(next.expect("there is no cycle"));
    }
    order
}

/// Carries the steps out one by one, from what the documentation of the types says.
fn carry_out(
    graph: &CausalGraph,
    order: &[usize],
    domain: &Domain,
    facts: FactSet,
    directive_of: &impl Fn(GoalId) -> Directive,
) -> Result<(), String> {
    let steps: Vec<_> = graph.steps().collect();
    let mut state = facts.bits();
    let mut place = None;
    for &step in order {
        let (label, Some(goal)) = (&steps[step].label, steps[step].goal) else { continue };
        let directive = directive_of(goal);
        let is_first = steps[..step].iter().all(|s| s.goal != Some(goal));
        let needs = |facts: FactSet, what: &str| {
            let missing = facts.bits() & !state;
            (missing == 0).then_some(()).ok_or(format!("{label}: {what} {missing:#b} is missing"))
        };
        if is_first {
            needs(directive.requires, "required")?;
        }
        let Some(index) = steps[step].operator else {
            needs(directive.achieves, "wanted")?;
            if place != Some(goal) {
                return Err(format!("{label}: the rover is at {place:?}"));
            }
            continue;
        };
        let operator = &domain.operators()[index];
        needs(operator.preconditions, "precondition")?;
        state = state & !operator.deletes.bits() | operator.adds.bits();
        if index == domain.drive() {
            place = Some(goal);
            state &= !directive.achieves.bits();
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn every_order_of_the_graph_is_a_valid_plan(
        of in prop::collection::vec(0usize..3, 1..5),
        start in 0usize..3,
        draws in prop::collection::vec(prop::collection::vec(any::<u16>(), 61), 8),
    ) {
        let domain = domain();
        let pool = directives(&domain);
        let facts = [names(&["stowed"]), names(&["out"]), names(&["stowed", "lit", "imaged"])];
        let facts = domain.set(&facts[start]).expect("facts of the domain");
        let (sequence, directive_of) = sequence(&domain, &pool, &of, facts);
        let graph = CausalGraph::new(&sequence, &domain, facts, &directive_of).expect("valid");
        let own: Vec<usize> = (0..graph.steps().count()).collect();
        prop_assert_eq!(carry_out(&graph, &own, &domain, facts, &directive_of), Ok(()));
        for draws in &draws {
            let order = some_order(&graph, draws);
            let told: Vec<&str> =
                order.iter().filter_map(|&i| graph.steps().nth(i)).map(|s| s.label.as_str()).collect();
            let done = carry_out(&graph, &order, &domain, facts, &directive_of);
            prop_assert!(done.is_ok(), "{done:?} in {told:?}\n{}", graph.dot());
        }
    }
}

/// Analysis and image: the arm's way in and out is what orders them.
#[test]
fn what_need_not_be_ordered_is_not() {
    let domain = domain();
    let pool = directives(&domain);
    let facts = domain.initial();
    let (sequence, directive_of) = sequence(&domain, &pool, &[1, 0], facts);
    assert_eq!(sequence.goals().collect::<Vec<_>>(), [GoalId(0), GoalId(1)]);
    let graph = CausalGraph::new(&sequence, &domain, facts, directive_of).expect("valid");
    let labels: Vec<&str> = graph.steps().map(|s| s.label.as_str()).collect();
    assert_eq!(
        labels,
        [
            "now",
            "G0 drive",
            "G0 image",
            "G0 done",
            "G1 drive",
            "G1 unstow",
            "G1 calibrate",
            "G1 analyse",
            "G1 done"
        ]
    );
    let number = |label: &str| labels.iter().position(|l| *l == label).expect("a step");
    let link = |from: &str, to: &str| {
        let (from, to) = (number(from), number(to));
        let found = graph.links().filter(|&(a, b, _)| (a, b) == (from, to));
        found.map(|(.., link)| link.clone()).collect::<Vec<_>>()
    };
    let causal = |fact: &str| Link::Causal(fact.into());
    let threat = |fact: &str| Link::Threat(fact.into());
    assert_eq!(link("G0 image", "G0 done"), [causal("imaged")]);
    assert_eq!(link("G0 done", "G1 drive"), [Link::Drive]);
    // Unstowing would take from the drive what it needs.
    assert_eq!(link("G1 drive", "G1 unstow"), [threat("stowed")]);
    assert_eq!(link("G1 unstow", "G1 calibrate"), [causal("out")]);
    // The calibration itself has nothing to do with the place: no link leads to it from the drive.
    assert_eq!(link("G1 drive", "G1 calibrate"), []);
    assert_eq!(link("now", "G0 drive"), [causal("stowed")]);
    // What follows from others is not said again.
    assert_eq!(link("G0 image", "G1 drive"), []);
}

#[test]
fn the_drawing_has_a_cluster_for_each_goal() {
    let domain = domain();
    let pool = directives(&domain);
    let facts = domain.initial();
    let (sequence, directive_of) = sequence(&domain, &pool, &[1, 0], facts);
    let dot = CausalGraph::new(&sequence, &domain, facts, directive_of).expect("valid").dot();
    for goal in ["G0", "G1"] {
        let cluster = dot.split(&format!("subgraph \"cluster {goal}\" {{")).nth(1).expect("one");
        let inside = cluster.split('}').next().expect("it ends");
        assert!(inside.contains(&format!("label=\"{goal} drive\"")), "{dot}");
        assert!(inside.contains(&format!("label=\"{goal} done\"")), "{dot}");
    }
    assert_eq!(dot.matches('{').count(), dot.matches('}').count());
}
