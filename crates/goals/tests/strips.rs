//! Facts, operators and the causal links of a sequence.

mod rover;

use wisdom_goals::{
    Candidate, CausalGraph, Directive, Domain, Effort, FactSet, GoalId, GoalSequence, Limits,
    PlanError, Policy, Preferences, Problem, quantised, sequences,
};
use wisdom_grid::{Cell, GridSpec, Raster};

use rover::{directives, domain, ground, names, travel};

/// Image, then drill, then analyse: the goals of a row of three, in the only order that the pool and the
/// prizes leave.
struct Row {
    domain: Domain,
    directives: Vec<Directive>,
    sequence: GoalSequence,
}

const IMAGE: GoalId = GoalId(4);
const DRILL: GoalId = GoalId(2);
const ANALYSE: GoalId = GoalId(7);

impl Row {
    fn new() -> Self {
        let spec = GridSpec::new(1, 7, 1.0).expect("a small grid");
        let hazard = Raster::filled(spec, 0.01);
        let ground = ground(Raster::filled(spec, 0.0), hazard, Raster::filled(spec, false));
        let cells = [0, 2, 4, 6].map(|col| Cell::new(0, col));
        let domain = domain();
        let directives = directives(&domain);
        let candidate = |(node, (goal, directive)): (usize, (GoalId, usize))| {
            Candidate::new(goal, directive, quantised(0.5), vec![node + 1])
        };
        let goals = [(IMAGE, 1), (DRILL, 2), (ANALYSE, 0)];
        let candidates: Vec<_> = goals.into_iter().enumerate().map(candidate).collect();
        let travel = travel(&ground, &cells);
        let problem = Problem {
            candidates: &candidates,
            travel: &travel,
            ends: &[],
            domain: &domain,
            directives: &directives,
            facts: domain.initial(),
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
        let effort = Effort { expansions: 1000, keep: 1, first: &[], clock: None };
        let sequence = sequences(&problem, effort).best.swap_remove(0);
        assert_eq!(sequence.goals().collect::<Vec<_>>(), [IMAGE, DRILL, ANALYSE]);
        Self { domain, directives, sequence }
    }

    fn directive_of(&self, goal: GoalId) -> Directive {
        let index = [(IMAGE, 1), (DRILL, 2), (ANALYSE, 0)].iter().find(|(id, _)| *id == goal);
        self.directives[index.expect("one of the three").1].clone()
    }

    fn graph(&self) -> Result<CausalGraph, PlanError> {
        self.graph_from(self.domain.initial())
    }

    fn graph_from(&self, facts: FactSet) -> Result<CausalGraph, PlanError> {
        CausalGraph::new(&self.sequence, &self.domain, facts, |goal| self.directive_of(goal))
    }

    fn operator(&self, name: &str) -> usize {
        let found = self.domain.operators().iter().position(|o| o.name == name);
        found.expect("the domain has this operator")
    }
}

/// Number of a node in the DOT text, by its label.
fn node(dot: &str, label: &str) -> String {
    let line = dot
        .lines()
        .find(|line| line.contains(&format!("label=\"{label}\"")))
        .unwrap_or_else(|| panic!("no node {label} in\n{dot}"));
    line.split_whitespace().next().expect("a node has a number").to_owned()
}

fn has_link(dot: &str, from: &str, to: &str, fact: &str) -> bool {
    let edge = format!("{} -> {} ", node(dot, from), node(dot, to));
    dot.lines().any(|l| l.trim().starts_with(&edge) && l.contains(&format!("label=\"{fact}\"")))
}

#[test]
fn the_causal_graph_links_every_need_to_what_last_made_it_true() {
    let row = Row::new();
    let graph = row.graph().expect("the sequence is valid");
    let dot = graph.dot();
    assert!(dot.starts_with("digraph"));
    for (from, to, fact) in [
        ("now", "G4 drive", "stowed"),
        ("G4 drive", "G4 image", "at-site"),
        // The directive, not an operator, asks for the image; the first thing done for the goal needs it.
        ("G4 image", "G2 drive", "imaged"),
        ("G2 unstow", "G2 drill", "out"),
        // The arm must be stowed again before the next drive.
        ("G2 unstow", "G7 stow", "out"),
        ("G7 stow", "G7 drive", "stowed"),
        ("G7 calibrate", "G7 analyse", "calibrated"),
        ("G7 drive", "G7 analyse", "at-site"),
    ] {
        assert!(has_link(&dot, from, to, fact), "{from} -> {to} by {fact} is missing in\n{dot}");
    }
    assert!(!has_link(&dot, "G4 drive", "G2 drill", "at-site"), "the later drive made it true");
}

#[test]
fn the_order_of_the_graph_is_that_of_the_plan() {
    let row = Row::new();
    let graph = row.graph().expect("the sequence is valid");
    let order = graph.order();
    assert_eq!(order[0], "now");
    let place = |label: &str| order.iter().position(|l| *l == label).expect("every operator");
    let drives =
        ["G4 drive", "G4 image", "G2 drive", "G2 drill", "G7 stow", "G7 drive", "G7 analyse"];
    assert!(drives.windows(2).all(|w| place(w[0]) < place(w[1])), "{order:?}");
}

#[test]
fn an_operator_whose_precondition_was_never_made_true_is_refused_by_name() {
    let mut row = Row::new();
    let unstow = row.operator("unstow");
    row.sequence.stops[1].expansion.after.retain(|&index| index != unstow);
    let error = row.graph().expect_err("the arm is stowed");
    assert_eq!(
        error,
        PlanError::Precondition { goal: DRILL, operator: "drill".into(), fact: "out".into() }
    );
    assert_eq!(
        error.to_string(),
        "G2: operator `drill` needs `out`, which does not hold at its turn"
    );
}

#[test]
fn driving_with_the_arm_out_is_refused() {
    let mut row = Row::new();
    row.sequence.stops[2].expansion.before.clear();
    assert_eq!(
        row.graph().expect_err("nobody stowed the arm"),
        PlanError::Precondition { goal: ANALYSE, operator: "drive".into(), fact: "stowed".into() }
    );
}

#[test]
fn a_goal_whose_operators_do_not_achieve_it_is_refused() {
    let mut row = Row::new();
    row.sequence.stops[0].expansion.after.clear();
    assert_eq!(
        row.graph().expect_err("no image was taken"),
        PlanError::NotAchieved { goal: IMAGE, fact: "imaged".into() }
    );
}

/// What was true of another site does not count: the drive clears it.
#[test]
fn an_image_of_another_site_is_not_an_image_of_this_one() {
    let mut row = Row::new();
    row.sequence.stops[0].expansion.after.clear();
    let facts = row.domain.set(&names(&["stowed", "imaged"])).expect("facts of the domain");
    assert_eq!(
        row.graph_from(facts).expect_err("only another site was imaged"),
        PlanError::NotAchieved { goal: IMAGE, fact: "imaged".into() }
    );
}

#[test]
fn a_goal_whose_directive_is_not_ready_is_refused() {
    let mut row = Row::new();
    row.sequence.stops.remove(0);
    let error = row.graph().expect_err("drilling requires an image");
    assert_eq!(error, PlanError::NotReady { goal: DRILL, fact: "imaged".into() });
    assert_eq!(
        error.to_string(),
        "G2: its directive requires `imaged`, which does not hold at its turn"
    );
}

/// Names come from mission files and may hold anything.
#[test]
fn quotes_in_names_do_not_break_the_dot_text() {
    let quoted = |name: &str, adds: &[&str]| wisdom_goals::OperatorText {
        name: name.into(),
        adds: names(adds),
        ..wisdom_goals::OperatorText::default()
    };
    let domain = Domain::new(&[quoted("drive", &[]), quoted("say \"hi\"", &["said"])], &[])
        .expect("any name is a name");
    let said = domain.set(&names(&["said"])).expect("it is a fact");
    let expansion = domain.expand(FactSet::EMPTY, said).expect("it can be said");
    let mut row = Row::new();
    row.sequence.stops.truncate(1);
    row.sequence.stops[0].expansion = expansion;
    let directive = Directive { achieves: said, ..row.directive_of(IMAGE) };
    let graph = CausalGraph::new(&row.sequence, &domain, FactSet::EMPTY, |_| directive.clone());
    assert!(graph.expect("valid").dot().contains(r#"label="G4 say \"hi\"""#));
}
