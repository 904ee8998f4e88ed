//! The core on a small made-up ground: what calls for a decision, and what the commit window holds.

use wisdom_autonomy::{
    Act, ApproachSpec, Autonomy, AutonomyError, Budget, Decision, Fallback, LayerSpec, LayerWindow,
    MapUpdate, Moment, Observation, Outcome, Pose, RouteSpec, Source, Spec, Spent, StepResult,
    Trigger, Triggers,
};
use wisdom_belief::Opinion;
use wisdom_fusion::{Band, Expert, Fusion, LookupTable, Rows};
use wisdom_goals::{
    Action, Directive, Domain, FactSet, GoalId, ManagerSpec, OperatorText, Policy, Preferences,
    PrizeScale, Reason, ServiceCost,
};
use wisdom_grid::{Cell, GridSpec, Window};
use wisdom_planner::Vehicle;

const SIDE: usize = 40;
const START: Cell = Cell { row: 20, col: 2 };

/// One expert that believes a tenth of what it reads, from 0 to 10, and doubts the rest.
fn expert() -> Expert {
    let bands = (0..10)
        .map(|i| {
            let interesting = f64::from(i) / 10.0;
            Band {
                lo: f64::from(i),
                hi: f64::from(i + 1),
                opinion: Opinion { paradox: 0.0, not_interesting: 1.0 - interesting, interesting },
            }
        })
        .collect();
    let outside = Opinion { paradox: 0.0, not_interesting: 1.0, interesting: 0.0 };
    let table = LookupTable::new("glow", "glow", "", Rows::Bands(bands), outside)
        .expect("the bench is sound");
    Expert { name: "glow".into(), layer: "glow".into(), table }
}

fn spec() -> Spec {
    let operator = |name: &str, adds: &[&str], time_s: f64| OperatorText {
        name: name.into(),
        adds: adds.iter().map(ToString::to_string).collect(),
        cost: ServiceCost { time_s, ..ServiceCost::default() },
        ..OperatorText::default()
    };
    let domain =
        Domain::new(&[operator("drive", &[], 0.0), operator("image", &["imaged"], 60.0)], &[])
            .expect("the bench is sound");
    let imaged = domain.set(&["imaged".to_owned()]).expect("the bench is sound");
    let directive = Directive {
        min_interest: 0.2,
        standoff_m: 1.0,
        exclusion_radius_m: 4.0,
        ..Directive::new("image", imaged)
    };
    let layer = |name: &str, unit: &str| LayerSpec {
        name: name.into(),
        unit: unit.into(),
        source: Source::Measured(MapUpdate::Best),
    };
    Spec {
        working_cells: None,
        grid: GridSpec::new(SIDE, SIDE, 1.0).expect("the bench is sound"),
        layers: vec![layer("elevation", "m"), layer("glow", "")],
        experts: vec![expert()],
        fusion: Fusion::default(),
        prize: PrizeScale::Belief,
        policy: Policy::ExpectedInterest,
        preferences: Preferences::default(),
        domain,
        directives: vec![directive],
        manager: ManagerSpec { identity_radius_m: 4.0, ..ManagerSpec::default() },
        vehicle: Vehicle::default(),
        budget: Budget {
            time_s: 1e5,
            energy_j: 1e8,
            reserve_j: 0.0,
            data_mb: f64::INFINITY,
            min_reliability: 0.5,
        },
        triggers: Triggers::default(),
        fallback: Fallback {
            max_looks: 0,
            look_range_m: 5.0,
            min_ignorance: 0.5,
            home: START,
            return_home: false,
        },
        class_layer: None,
        close_look: std::collections::BTreeMap::new(),
        slip_layer: None,
        routes: RouteSpec::default(),
        approach: ApproachSpec { eye_height_m: 2.0, poses: 1 },
    }
}

/// The rover, and the world as it is told to it.
struct Bench {
    rover: Autonomy,
    observations: u32,
    at: Cell,
}

impl Bench {
    fn new(spec: Spec) -> Self {
        Self { rover: Autonomy::new(spec).expect("the bench is sound"), observations: 0, at: START }
    }

    /// Tells the whole ground: its height and its glow, both with the same uncertainty.
    fn see(&mut self, u: f32, height: impl Fn(Cell) -> f32, glow: impl Fn(Cell) -> f32) {
        let window = Window { row: 0, col: 0, rows: SIDE, cols: SIDE };
        let layer = |name: &str, values: Vec<f32>| LayerWindow {
            layer: name.into(),
            window,
            uncertainty: vec![u; values.len()],
            values,
        };
        let windows = vec![
            layer("elevation", window.cells().map(height).collect()),
            layer("glow", window.cells().map(glow).collect()),
        ];
        let observation = Observation {
            number: self.observations,
            pose: Pose { cell: self.at, heading_rad: 0.0 },
            spent: Spent::default(),
            windows,
        };
        self.rover.observe(&observation).expect("the bench is sound");
        self.observations += 1;
    }

    fn decide(&mut self) -> Decision {
        self.rover.decide().expect("the bench is sound")
    }

    fn report(&mut self, decision: &Decision, result: StepResult, operators: &[&str]) {
        self.rover.report(&self.outcome(decision, result, operators)).expect("the bench is sound");
    }

    fn outcome(&self, decision: &Decision, result: StepResult, operators: &[&str]) -> Outcome {
        Outcome {
            decision: decision.number,
            result,
            operators: operators.iter().map(ToString::to_string).collect(),
            pose: Pose { cell: self.at, heading_rad: 0.0 },
            spent: Spent::default(),
            predicted_reliability: 1.0,
            track: vec![self.at],
        }
    }
}

/// Glow of a single bright cell over dull ground.
fn lamp(at: (usize, usize), glow: f32) -> impl Fn(Cell) -> f32 {
    move |cell| if (cell.row, cell.col) == at { glow } else { 0.5 }
}

fn flat(_: Cell) -> f32 {
    0.0
}

fn pursued(decision: &Decision) -> GoalId {
    match decision.act {
        Act::Pursue(goal) => goal,
        ref other => panic!("pursues nothing: {other:?}"),
    }
}

#[test]
fn a_goal_is_found_reached_and_explained() {
    let mut bench = Bench::new(spec());
    assert!(matches!(bench.rover.decide(), Err(AutonomyError::NothingObserved)));
    bench.see(0.1, flat, lamp((20, 30), 9.5));
    let first = bench.decide();
    assert_eq!(first.triggers, [Trigger::Start]);
    let goal = pursued(&first);
    assert_eq!(first.verdicts[0].goal.target, Cell::new(20, 30));
    bench.at = Cell::new(20, 29);
    bench.report(&first, StepResult::Achieved(goal), &["drive", "image"]);
    let second = bench.decide();
    assert_eq!(second.triggers, [Trigger::GoalEnded(goal)]);
    assert_eq!(second.verdicts[0].action, Action::Achieve);
    assert!(!second.map_changed);
    assert!(
        matches!(second.act, Act::Wait { .. }),
        "nothing is left, and waiting is an act: {:?}",
        second.act
    );
}

#[test]
fn inputs_that_cannot_be_true_are_refused() {
    let mut bench = Bench::new(spec());
    bench.see(0.1, flat, lamp((20, 30), 9.5));
    let late = Observation {
        number: 7,
        pose: Pose { cell: START, heading_rad: 0.0 },
        spent: Spent::default(),
        windows: vec![],
    };
    let error = bench.rover.observe(&late).unwrap_err();
    assert!(matches!(error, AutonomyError::ObservationOrder { expected: 1, found: 7 }), "{error}");
    let off =
        Observation { number: 1, pose: Pose { cell: Cell::new(99, 0), heading_rad: 0.0 }, ..late };
    assert!(matches!(bench.rover.observe(&off), Err(AutonomyError::OffGrid { .. })));

    let decision = bench.decide();
    let goal = pursued(&decision);
    let mut outcome = bench.outcome(&decision, StepResult::Achieved(goal), &["fly"]);
    assert!(matches!(bench.rover.report(&outcome), Err(AutonomyError::Operator { .. })));
    outcome.decision = 4;
    let error = bench.rover.report(&outcome).unwrap_err();
    assert!(matches!(error, AutonomyError::OutcomeOrder { expected: 0, found: 4 }), "{error}");
}

#[test]
fn a_better_goal_waits_until_the_leg_under_way_is_done() {
    let mut bench = Bench::new(spec());
    bench.see(0.4, flat, lamp((20, 30), 7.5));
    let first = bench.decide();
    let goal = pursued(&first);
    assert!(bench.rover.triggers().is_empty());
    // A brighter lamp, nearer: without the commit window it would come first.
    let both = |cell: Cell| lamp((20, 30), 7.5)(cell).max(lamp((26, 4), 9.5)(cell));
    bench.see(0.3, flat, both);
    assert!(
        bench.rover.triggers().iter().any(|t| t.name() == "new-candidate"),
        "{:?}",
        bench.rover.triggers()
    );
    bench.report(&first, StepResult::Interrupted(goal), &[]);
    let second = bench.decide();
    assert_eq!(pursued(&second), goal, "the leg under way goes on");
    assert_eq!(second.plan().sequence.stops.len(), 2, "the new goal comes after it");
    let fresh = second.verdicts.iter().find(|v| v.goal.id != goal).expect("the bench is sound");
    assert_eq!((fresh.action, fresh.reason), (Action::Add, Reason::NewMaximum));

    // The same ground without a leg under way: the near, bright lamp is first.
    let mut free = Bench::new(spec());
    free.see(0.3, flat, both);
    let decision = free.decide();
    let target = decision
        .verdicts
        .iter()
        .find(|v| v.turn == Some(0))
        .expect("the bench is sound")
        .goal
        .target;
    assert_eq!(target, Cell::new(26, 4));
}

#[test]
fn a_goal_that_lost_its_interest_is_not_driven_to() {
    let mut bench = Bench::new(spec());
    let both = |cell: Cell| lamp((20, 30), 9.5)(cell).max(lamp((30, 20), 8.5)(cell));
    bench.see(0.4, flat, both);
    let first = bench.decide();
    let goal = pursued(&first);
    let target =
        first.verdicts.iter().find(|v| v.goal.id == goal).expect("the bench is sound").goal.target;
    // A closer look: nothing glows where the rover is going.
    bench.see(0.1, flat, |cell| if cell == target { 0.5 } else { both(cell) });
    assert!(bench.rover.triggers().iter().any(|t| t.name() == "interest-changed"));
    bench.report(&first, StepResult::Interrupted(goal), &[]);
    let second = bench.decide();
    let verdict = second.verdicts.iter().find(|v| v.goal.id == goal).expect("the bench is sound");
    assert_eq!((verdict.action, verdict.reason), (Action::Drop, Reason::LostInterest));
    assert_ne!(pursued(&second), goal);
}

#[test]
fn a_wall_seen_across_the_route_calls_for_another_way() {
    let mut bench = Bench::new(spec());
    bench.see(0.4, flat, lamp((20, 30), 9.5));
    let first = bench.decide();
    let goal = pursued(&first);
    // A wall, open only in the south.
    let wall = |cell: Cell| if cell.col == 15 && cell.row < 34 { 5.0 } else { 0.0 };
    bench.see(0.1, wall, lamp((20, 30), 9.5));
    let blocked = bench.rover.triggers().iter().find(|t| matches!(t, Trigger::RouteBlocked(_)));
    assert!(blocked.is_some(), "{:?}", bench.rover.triggers());
    bench.report(&first, StepResult::Interrupted(goal), &[]);
    let second = bench.decide();
    assert_eq!(pursued(&second), goal, "the goal is still worth it");
    let route = &second.plan().plan.legs[0].route.cells;
    assert!(route.iter().all(|c| c.col != 15 || c.row >= 34), "round the wall");
    assert!(second.act_cost.length_m > first.act_cost.length_m + 10.0);
}

#[test]
fn the_manager_s_memory_in_the_record_is_enough_to_take_a_decision_again() {
    let mut bench = Bench::new(spec());
    let both = |cell: Cell| lamp((20, 30), 9.5)(cell).max(lamp((30, 20), 8.5)(cell));
    bench.see(0.3, flat, both);
    let first = bench.decide();
    let goal = pursued(&first);
    bench.report(&first, StepResult::Aborted(goal), &["drive"]);
    let second = bench.decide();
    assert_eq!(
        second.state.manager.events.len(),
        1,
        "the failed try is part of what is remembered"
    );
    assert_eq!(first.manager_after.goals, second.state.manager.goals);
    assert_eq!(second.manager_after.goals[&goal].attempts, 1);
    assert_eq!(second.manager_after.decision, 2);

    // Another core, which was told the same of the ground and nothing of what happened on it.
    let mut other = Bench::new(spec());
    other.see(0.3, flat, both);
    let retaken =
        |bench: &mut Bench, of: &Decision| bench.rover.decide_at(moment(of)).expect("it fits");
    assert_eq!(retaken(&mut other, &second), second);
    assert_eq!(retaken(&mut other, &first), first, "and back");
}

/// The moment at which a decision was taken.
fn moment(decision: &Decision) -> Moment {
    Moment {
        number: decision.number,
        triggers: decision.triggers.clone(),
        state: decision.state.clone(),
        map_changed: decision.map_changed,
    }
}

#[test]
fn a_moment_that_the_spec_cannot_know_is_refused_and_changes_nothing() {
    let mut bench = Bench::new(spec());
    bench.see(0.3, flat, lamp((20, 30), 9.5));
    let first = bench.decide();
    bench.report(&first, StepResult::Aborted(pursued(&first)), &["drive"]);
    let sound = moment(&first);
    let strange = |change: &dyn Fn(&mut Moment)| {
        let mut moment = moment(&first);
        moment.state.manager = first.manager_after.clone();
        change(&mut moment);
        moment
    };
    let goal = pursued(&first);
    let off = Cell::new(SIDE, 0);
    let refused = [
        strange(&|m| m.state.pose.cell = off),
        strange(&|m| m.state.facts = FactSet::from_bits(1 << 60)),
        strange(&|m| m.state.manager.agenda.push(GoalId(77))),
        strange(&|m| m.state.underway = Some(GoalId(78))),
        strange(&|m| m.state.manager.goals.get_mut(&goal).expect("it is open").directive = 9),
        strange(&|m| m.state.manager.goals.get_mut(&goal).expect("it is open").target = off),
    ];
    let before = bench.rover.clone();
    for moment in refused {
        let error = bench.rover.decide_at(moment.clone()).expect_err("it cannot be");
        let named = matches!(error, AutonomyError::Moment { .. } | AutonomyError::OffGrid { .. });
        assert!(named, "{error}");
    }
    let decide = |rover: &Autonomy| rover.clone().decide().expect("it goes on");
    assert_eq!(decide(&bench.rover), decide(&before));
    assert!(bench.rover.decide_at(sound).is_ok());
}
