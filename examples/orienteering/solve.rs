//! The production sequencer on an orienteering problem: goals without preconditions, legs that never fail.

use wisdom_goals::{
    Candidate, DRIVE, Directive, Domain, Effort, GoalId, Limits, OperatorText, Policy, Preferences,
    Problem, Proof, ServiceCost, Window, sequences,
};
use wisdom_grid::Cell;
use wisdom_planner::{CostVector, TravelMatrix};

use crate::instance::Instance;

/// What the sequencer found.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Answer {
    /// Nodes in their order, start and end included; none if no route was found, not even one straight to the end.
    pub(crate) route: Option<Vec<usize>>,
    /// No route has a higher score.
    pub(crate) bound: f64,
}

/// A bound is a sum of fractions of scores: if it misses a whole number by less than this, that number is not excluded.
const ROUNDING: f64 = 1e-6;

/// Searches until the expansions are spent or the clock, the share of the time that has passed, says 1.
///
/// Sites without a score are no goals. Lengths are times, so that the rover's time limit is the budget; energy, data
/// and reliability are free.
pub(crate) fn solve(
    instance: &Instance,
    expansions: u64,
    clock: Option<&dyn Fn() -> f64>,
) -> Answer {
    let (start, end) = (instance.start, instance.end);
    let worthwhile =
        |&node: &usize| node != start && node != end && instance.nodes[node].score > 0.0;
    let goals: Vec<usize> = (0..instance.nodes.len()).filter(worthwhile).collect();
    // The matrix: where the rover stands, the goals, and the end if that is another place.
    let mut places = vec![start];
    places.extend(&goals);
    if end != start {
        places.push(end);
    }
    let last = if end == start { 0 } else { places.len() - 1 };

    let cells: Vec<Cell> = (0..places.len()).map(|place| Cell::new(0, place)).collect();
    let travel = TravelMatrix::from_costs(&cells, |from, to| {
        let length = instance.length(places[from], places[to]);
        vec![CostVector { length_m: length, time_s: length, energy_j: 0.0, neg_ln_r: 0.0 }]
    });
    let candidates: Vec<Candidate> = (1..).zip(&goals).map(|at| candidate(instance, at)).collect();
    let (domain, directive) = visiting();
    let problem = Problem {
        candidates: &candidates,
        travel: &travel,
        domain: &domain,
        directives: &[directive],
        facts: domain.initial(),
        limits: Limits {
            time_s: instance.budget(),
            energy_j: f64::INFINITY,
            data_mb: f64::INFINITY,
            min_reliability: 0.0,
        },
        policy: Policy::MostInteresting,
        ends: &[last],
        waiting_w: 0.0,
        preferences: Preferences::default(),
    };
    let found = sequences(&problem, Effort { expansions, keep: 1, first: &[], clock });

    let best = &found.best[0];
    let mut route = vec![start];
    route.extend(best.goals().map(|GoalId(node)| node as usize));
    route.push(end);
    // Doing nothing is the sequencer's last resort, also where the end is out of reach.
    let reached = route.len() > 2 || instance.check(&route).is_ok();
    let bound = instance.score_of_ends()
        + match found.proof {
            Proof::Proven => best.prize,
            Proof::Bound(bound) => bound,
        };
    Answer {
        route: reached.then_some(route),
        bound: if instance.has_whole_scores() { (bound + ROUNDING).floor() } else { bound },
    }
}

/// A node as a goal; its pose is its place in the matrix.
fn candidate(instance: &Instance, (pose, &node): (usize, &usize)) -> Candidate {
    let visit = &instance.nodes[node];
    Candidate {
        service: ServiceCost { time_s: visit.service, ..ServiceCost::default() },
        window: visit.window.map(|window| Window { open_s: window.open, close_s: window.close }),
        ..Candidate::new(GoalId(node as u32), 0, visit.score, vec![pose])
    }
}

/// To visit is to be there: one directive that a single operator without costs achieves.
fn visiting() -> (Domain, Directive) {
    const VISITED: &str = "visited";
    let operator =
        |name: &str, adds| OperatorText { name: name.to_owned(), adds, ..OperatorText::default() };
    let operators = [operator(DRIVE, Vec::new()), operator("visit", vec![VISITED.to_owned()])];
    let domain = Domain::new(&operators, &[]).expect("no operator needs a fact");
    let achieves = domain.set(&[VISITED.to_owned()]).expect("an operator adds it");
    let directive = Directive { max_attempts: 1, ..Directive::new("visit", achieves) };
    (domain, directive)
}
