//! `validate` passes what the search makes and catches every way a plan can be wrong, each by its own name.

use wisdom_grid::{Cell, GridSpec, Raster};
use wisdom_planner::{
    Budget, CostVector, Leg, Limits, Plan, PlanFamily, Service, TravelMatrix, Traversability,
    Vehicle, Violation, travel_matrix, validate,
};
use wisdom_terrain::Layer;

/// Seen ground with slopes, a wall with a gap, and a strip of shadow.
fn heights() -> Layer {
    let spec = GridSpec::new(30, 30, 0.5).expect("a small grid");
    let height = |cell: Cell| {
        let (x, y) = (cell.col as f64, cell.row as f64);
        let rolling = 0.6 * libm::sin(x / 6.0) + 0.4 * libm::cos(y / 5.0);
        (rolling + if cell.row == 15 && cell.col < 22 { 2.0 } else { 0.0 }) as f32
    };
    let layer = Layer::new(
        Raster::from_fn(spec, height),
        Raster::from_fn(spec, |cell| if cell.col == 26 { 1.0 } else { 0.1 }),
    );
    layer.expect("heights are finite, u is a share")
}

fn ground() -> Traversability {
    Traversability::new(&Vehicle::default(), &heights()).expect("vehicle and ground are sound")
}

const NODES: [Cell; 4] = [Cell::new(4, 4), Cell::new(10, 20), Cell::new(27, 6), Cell::new(22, 28)];

const SERVICE: Service = Service { time_s: 600.0, energy_j: 50_000.0 };

const ROOMY: Budget = Budget { time_s: 1e5, energy_j: 1e8, min_reliability: 0.5 };

fn tour(travel: &TravelMatrix, order: &[usize]) -> Plan {
    let mut from = 0;
    let legs = order.iter().map(|&stop| {
        let route = travel.route(from, stop, 0).expect("every node can be reached");
        from = stop;
        Leg { stop, pose: NODES[stop], route, service: SERVICE }
    });
    Plan::new(NODES[0], legs.collect())
}

/// A good plan, its ground, and what `validate` says of it once changed.
fn violation(change: impl FnOnce(&mut Plan)) -> Violation {
    let ground = ground();
    let mut plan = tour(&travel_matrix(&ground, &NODES, Limits::NONE), &[1, 2, 3]);
    change(&mut plan);
    validate(&plan, &ground, &Vehicle::default(), &ROOMY).expect_err("the plan was corrupted")
}

#[test]
fn what_the_search_makes_is_valid() {
    let ground = ground();
    let travel = travel_matrix(&ground, &NODES, Limits::NONE);
    for order in [&[][..], &[1], &[3, 1], &[1, 2, 3], &[3, 2, 1], &[2, 3, 1]] {
        let plan = tour(&travel, order);
        assert_eq!(validate(&plan, &ground, &Vehicle::default(), &ROOMY), Ok(()), "{order:?}");
    }
    let staying = tour(&travel, &[]);
    assert_eq!(staying.total, CostVector::ZERO);
}

#[test]
fn a_plan_that_fills_its_budget_exactly_is_valid() {
    let ground = ground();
    let plan = tour(&travel_matrix(&ground, &NODES, Limits::NONE), &[1, 2, 3]);
    let (time_s, energy_j) = (plan.total.time_s, plan.total.energy_j);
    let exact = Budget { time_s, energy_j, min_reliability: plan.total.reliability() };
    let check = |budget| validate(&plan, &ground, &Vehicle::default(), &budget);
    assert_eq!(check(exact), Ok(()));
    let short = check(Budget { time_s: time_s - 1.0, ..exact });
    assert!(matches!(short, Err(Violation::OverTime { .. })), "{short:?}");
    let weak = check(Budget { energy_j: energy_j - 1.0, ..exact });
    assert!(matches!(weak, Err(Violation::OverEnergy { .. })), "{weak:?}");
    let bold = check(Budget { min_reliability: exact.min_reliability + 1e-6, ..exact });
    assert!(matches!(bold, Err(Violation::Unreliable { .. })), "{bold:?}");
    let unsaid = check(Budget { time_s: f64::NAN, ..exact });
    assert!(matches!(unsaid, Err(Violation::OverTime { .. })), "{unsaid:?}");
}

#[test]
fn a_route_without_cells_is_caught() {
    let found = violation(|plan| plan.legs[1].route.cells.clear());
    assert_eq!(found, Violation::EmptyRoute { leg: 1 });
}

#[test]
fn a_leg_that_begins_elsewhere_is_caught() {
    let found = violation(|plan| plan.start = Cell::new(5, 4));
    let (expected, begins) = (Cell::new(5, 4), NODES[0]);
    assert_eq!(found, Violation::WrongStart { leg: 0, expected, found: begins });
    let found = violation(|plan| plan.legs.swap(1, 2));
    assert_eq!(found, Violation::WrongStart { leg: 1, expected: NODES[1], found: NODES[2] });
}

#[test]
fn a_leg_that_ends_elsewhere_is_caught() {
    let found = violation(|plan| plan.legs[2].pose = Cell::new(0, 0));
    assert_eq!(found, Violation::WrongEnd { leg: 2, expected: Cell::new(0, 0), found: NODES[3] });
}

#[test]
fn a_route_off_the_map_is_caught() {
    let found = violation(|plan| plan.legs[0].route.cells[1] = Cell::new(3, 30));
    assert_eq!(found, Violation::OffGrid { leg: 0, cell: Cell::new(3, 30) });
}

#[test]
fn a_jump_is_caught() {
    let found = violation(|plan| drop(plan.legs[0].route.cells.drain(3..6)));
    assert!(matches!(found, Violation::Jump { leg: 0, .. }), "{found:?}");
    // Standing still is no step either.
    let found = violation(|plan| {
        let again = plan.legs[0].route.cells[2];
        plan.legs[0].route.cells.insert(2, again);
    });
    assert!(matches!(found, Violation::Jump { leg: 0, from, to } if from == to), "{found:?}");
}

#[test]
fn a_way_through_the_wall_is_caught() {
    let found = violation(|plan| {
        // Straight down column 4, from row 4 to row 27 and on to the pose.
        let down = (4..27).map(|row| Cell::new(row, 4));
        plan.legs = vec![plan.legs[1].clone()];
        plan.legs[0].route.cells = down.chain([Cell::new(26, 5), NODES[2]]).collect();
    });
    // The wall stands in row 15; the slope of its foot is blocked too.
    assert_eq!(found, Violation::Blocked { leg: 0, cell: Cell::new(13, 4) });
}

/// Two by two cells, `blocked` as listed, heights as given, one leg of given cells.
fn small(blocked: &[Cell], height: impl FnMut(Cell) -> f32, cells: Vec<Cell>) -> Violation {
    let spec = GridSpec::new(2, 2, 1.0).expect("a small grid");
    let ground = wisdom_planner::Ground {
        elevation: Layer::certain(Raster::from_fn(spec, height)).expect("heights are finite"),
        blocked: Raster::from_fn(spec, |cell| blocked.contains(&cell)),
        severity: Raster::filled(spec, 0.0),
        hazard_per_m: Raster::filled(spec, 1e-4),
    };
    let ground = Traversability::from_ground(&Vehicle::default(), ground)
        .expect("vehicle and ground are sound");
    let pose = cells[cells.len() - 1];
    let route = wisdom_planner::Route { cells, cost: CostVector::ZERO };
    let start = route.cells[0];
    let plan = Plan::new(start, vec![Leg { stop: 0, pose, route, service: SERVICE }]);
    validate(&plan, &ground, &Vehicle::default(), &ROOMY).expect_err("the plan is wrong")
}

#[test]
fn a_cut_corner_is_caught() {
    let (from, to) = (Cell::new(0, 0), Cell::new(1, 1));
    for corner in [Cell::new(0, 1), Cell::new(1, 0)] {
        let found = small(&[corner], |_| 0.0, vec![from, to]);
        assert_eq!(found, Violation::CutCorner { leg: 0, from, to, corner });
    }
}

#[test]
fn a_bank_too_slippery_is_caught() {
    let climb = vec![Cell::new(0, 0), Cell::new(0, 1)];
    let found = small(&[], |cell| 2.0 * cell.col as f32, climb);
    assert!(matches!(found, Violation::Slip { leg: 0, slip, .. } if slip > 0.9), "{found:?}");
}

#[test]
fn a_wrong_cost_is_caught_in_each_quantity() {
    type Change = fn(&mut CostVector);
    let changes: [(&str, Change); 5] = [
        ("length_m", |cost| cost.length_m += 0.001),
        ("time_s", |cost| cost.time_s -= 0.001),
        ("energy_j", |cost| cost.energy_j *= 0.999_999),
        ("neg_ln_r", |cost| cost.neg_ln_r -= 1e-6),
        ("time_s", |cost| cost.time_s = f64::NAN),
    ];
    for (name, change) in changes {
        let found = violation(|plan| change(&mut plan.legs[1].route.cost));
        let in_leg =
            matches!(found, Violation::LegCost { leg: 1, quantity, .. } if quantity == name);
        assert!(in_leg, "{found:?}");
        let found = violation(|plan| change(&mut plan.total));
        let in_plan = matches!(found, Violation::TotalCost { quantity, .. } if quantity == name);
        assert!(in_plan, "{found:?}");
    }
}

#[test]
fn a_service_that_gives_time_back_is_caught() {
    let found = violation(|plan| plan.legs[0].service.time_s = -1.0);
    assert_eq!(found, Violation::ServiceCost { leg: 0, quantity: "time_s", stated: -1.0 });
    let found = violation(|plan| plan.legs[2].service.energy_j = f64::INFINITY);
    assert!(
        matches!(found, Violation::ServiceCost { leg: 2, quantity: "energy_j", .. }),
        "{found:?}"
    );
}

/// A plan made before new data closed a cell is caught on the new ground.
#[test]
fn a_plan_for_yesterdays_ground_is_caught() {
    let old = ground();
    let plan = tour(&travel_matrix(&old, &NODES, Limits::NONE), &[1, 2, 3]);
    let closed = plan.legs[1].route.cells[10];
    let spec = old.spec();
    let mut blocked = old.blocked().clone();
    blocked[closed] = true;
    let new = wisdom_planner::Ground {
        elevation: heights(),
        blocked,
        severity: Raster::filled(spec, 0.0),
        hazard_per_m: old.hazard().clone(),
    };
    let new = Traversability::from_ground(&Vehicle::default(), new)
        .expect("vehicle and ground are sound");
    let found = validate(&plan, &new, &Vehicle::default(), &ROOMY);
    assert_eq!(found, Err(Violation::Blocked { leg: 1, cell: closed }));
}

#[test]
fn the_chosen_plan_of_a_family_is_the_one_indexed() {
    let travel = travel_matrix(&ground(), &NODES, Limits::NONE);
    let plans = vec![tour(&travel, &[1]), tour(&travel, &[2])];
    let family = PlanFamily { plans, chosen: 1 };
    assert_eq!(family.chosen().map(|plan| plan.legs[0].stop), Some(2));
    assert_eq!(PlanFamily { plans: vec![], chosen: 0 }.chosen(), None);
}

/// The same plan, wrong by what it does and not by what it says: all its sums are right, the budget is not kept.
#[test]
fn a_plan_edited_beyond_its_budget_is_caught_though_its_sums_are_right() {
    let over = |change: fn(&mut Plan)| {
        violation(|plan| {
            change(plan);
            *plan = Plan::new(plan.start, plan.legs.clone());
        })
    };
    let found = over(|plan| plan.legs[1].service.time_s = 2e5);
    assert!(
        matches!(found, Violation::OverTime { found_s, limit_s: 1e5 } if found_s > 2e5),
        "{found:?}"
    );
    let found = over(|plan| plan.legs[1].service.energy_j = 2e8);
    assert!(
        matches!(found, Violation::OverEnergy { found_j, limit_j: 1e8 } if found_j > 2e8),
        "{found:?}"
    );
}

/// Back and forth between two cells until the chance of it all is below the floor, the sums right throughout.
#[test]
fn a_plan_edited_into_danger_is_caught_though_its_sums_are_right() {
    let ground = ground();
    let (a, b) = (NODES[0], Cell::new(4, 5));
    let restless = |times: usize| {
        let cells: Vec<Cell> = std::iter::repeat_n([a, b], times).flatten().chain([a]).collect();
        let cost = cells.windows(2).map(|pair| ground.edge(pair[0], pair[1]).expect("open")).sum();
        let route = wisdom_planner::Route { cells, cost };
        let plan = Plan::new(a, vec![Leg { stop: 0, pose: a, route, service: SERVICE }]);
        let budget = Budget { min_reliability: 0.99, ..ROOMY };
        validate(&plan, &ground, &Vehicle::default(), &budget)
    };
    assert_eq!(restless(1), Ok(()));
    let found = restless(1000);
    assert!(
        matches!(found, Err(Violation::Unreliable { found, limit: 0.99 }) if found < 0.99),
        "{found:?}"
    );
}

/// Loose sand is class 1, bedrock class 3 (curves through Heverly et al. 2013).
fn on_soils() -> Vehicle {
    let soil = |class, base, growth_per_deg| wisdom_planner::SlipClass {
        class,
        name: String::new(),
        base,
        growth_per_deg,
    };
    let slip_class = vec![soil(1, 0.035, 0.17), soil(3, 0.01, 0.10)];
    Vehicle { slip_base: 0.02, slip_growth_per_deg: 0.12, slip_class, ..Vehicle::default() }
}

/// The ground of [`heights`], sand in the east, the classes known as well as `u` says.
fn soils(u: f32) -> Traversability {
    let elevation = heights();
    let spec = elevation.spec();
    let classes = Layer::new(
        Raster::from_fn(spec, |cell| [3.0, 2.0, 1.0][cell.col / 10]),
        Raster::filled(spec, u),
    );
    let classes = classes.expect("sound readings");
    Traversability::on_classes(&on_soils(), &elevation, Some(&classes))
        .expect("vehicle and ground are sound")
}

#[test]
fn what_the_search_makes_on_classes_is_valid() {
    for u in [0.0, 0.3, 1.0] {
        let ground = soils(u);
        let travel = travel_matrix(&ground, &NODES, Limits::NONE);
        for order in [&[1][..], &[1, 2, 3], &[3, 2, 1]] {
            let plan = tour(&travel, order);
            assert_eq!(validate(&plan, &ground, &on_soils(), &ROOMY), Ok(()), "{u} {order:?}");
        }
    }
}

/// What a plan says it costs is wrong once its classes are known less well, or not asked for at all.
#[test]
fn a_plan_that_takes_its_classes_for_granted_is_caught() {
    let plan = tour(&travel_matrix(&soils(0.0), &NODES, Limits::NONE), &[1, 2, 3]);
    let found = validate(&plan, &soils(0.3), &on_soils(), &ROOMY);
    assert!(
        matches!(found, Err(Violation::LegCost { quantity: "time_s", stated, found, .. }) if stated < found),
        "{found:?}"
    );
    let elevation = heights();
    let classless = Traversability::new(&on_soils(), &elevation).expect("a sound vehicle");
    let found = validate(&plan, &classless, &on_soils(), &ROOMY);
    assert!(matches!(found, Err(Violation::LegCost { quantity: "time_s", .. })), "{found:?}");
    // Nor may the vehicle forget what it slips on.
    let forgetful = Vehicle { slip_class: Vec::new(), ..on_soils() };
    let found = validate(&plan, &soils(0.0), &forgetful, &ROOMY);
    assert!(matches!(found, Err(Violation::LegCost { quantity: "time_s", .. })), "{found:?}");
}

/// A step of 21 degrees, good on bedrock, too much on what may be sand: of either of its cells.
#[test]
fn a_bank_that_turns_out_to_be_sand_is_caught() {
    let spec = GridSpec::new(1, 2, 1.0).expect("a small grid");
    let heights = Raster::from_fn(spec, |cell| 0.384 * cell.col as f32);
    let (low, high) = (Cell::new(0, 0), Cell::new(0, 1));
    let on = |classes: [f32; 2], u: f32| {
        let ground = wisdom_planner::Ground {
            elevation: Layer::certain(heights.clone()).expect("heights are finite"),
            blocked: Raster::filled(spec, false),
            severity: Raster::filled(spec, 0.0),
            hazard_per_m: Raster::filled(spec, 1e-4),
        };
        let classes = Raster::from_fn(spec, |cell| classes[cell.col]);
        let classes = Layer::new(classes, Raster::filled(spec, u)).expect("sound readings");
        Traversability::from_ground_on_classes(&on_soils(), ground, Some(&classes))
            .expect("vehicle and ground are sound")
    };
    let bedrock = on([3.0, 3.0], 0.0);
    let drive = |ground: &Traversability, from: Cell, to: Cell| {
        let cost = ground.edge(from, to).expect("an open step");
        let route = wisdom_planner::Route { cells: vec![from, to], cost };
        Plan::new(from, vec![Leg { stop: 0, pose: to, route, service: SERVICE }])
    };
    let check = |plan: &Plan, ground: &Traversability| validate(plan, ground, &on_soils(), &ROOMY);
    let up = drive(&bedrock, low, high);
    assert_eq!(check(&up, &bedrock), Ok(()));
    for sand in
        [on([1.0, 3.0], 0.0), on([3.0, 1.0], 0.0), on([3.0, 3.0], 0.95), on([3.0, 3.0], 1.0)]
    {
        let found = check(&up, &sand);
        assert!(
            matches!(found, Err(Violation::Slip { leg: 0, from, to, slip, limit: 0.9 })
                if (from, to) == (low, high) && slip > 0.9 && slip <= 1.0),
            "{found:?}"
        );
        // The way down is open.
        assert_eq!(check(&drive(&sand, high, low), &sand), Ok(()));
    }
}
