//! A small rover for the tests: its operators, its pool, and ground to drive on.

use wisdom_goals::{Directive, Domain, FactSet, OperatorText, ServiceCost};
use wisdom_grid::{Cell, Raster};
use wisdom_planner::{Ground, Limits, TravelMatrix, Traversability, Vehicle, travel_matrix};
use wisdom_terrain::Layer;

pub(crate) fn names(list: &[&str]) -> Vec<String> {
    list.iter().map(ToString::to_string).collect()
}

fn operator(
    name: &str,
    [preconditions, adds, deletes]: [&[&str]; 3],
    [time_s, energy_j, data_mb]: [f64; 3],
) -> OperatorText {
    OperatorText {
        name: name.into(),
        preconditions: names(preconditions),
        adds: names(adds),
        deletes: names(deletes),
        cost: ServiceCost { time_s, energy_j, data_mb },
    }
}

/// An arm that must be stowed to drive, a calibration that lasts until something is drilled, and a lamp, lit
/// for drilling and off after an analysis, with which an image is quicker and smaller but draws more.
pub(crate) fn domain() -> Domain {
    let operators = [
        operator("drive", [&["stowed"], &["at-site"], &[]], [5.0, 0.0, 0.0]),
        operator("stow", [&["out"], &["stowed"], &["out"]], [30.0, 500.0, 0.0]),
        operator("unstow", [&["stowed"], &["out"], &["stowed"]], [40.0, 700.0, 0.0]),
        operator("calibrate", [&["out"], &["calibrated"], &[]], [100.0, 3000.0, 1.0]),
        operator(
            "analyse",
            [&["at-site", "out", "calibrated"], &["analysed"], &["lit"]],
            [600.0, 9000.0, 10.0],
        ),
        operator("image", [&["at-site", "stowed"], &["imaged"], &[]], [60.0, 2000.0, 40.0]),
        operator(
            "drill",
            [&["at-site", "out"], &["drilled", "lit"], &["calibrated"]],
            [300.0, 50_000.0, 0.0],
        ),
        operator(
            "image-lit",
            [&["at-site", "stowed", "lit"], &["imaged"], &[]],
            [20.0, 30_000.0, 5.0],
        ),
    ];
    Domain::new(&operators, &names(&["stowed"])).expect("the operators fit each other")
}

/// Analyse (0), image (1), and drill (2), for which something must have been imaged before.
pub(crate) fn directives(domain: &Domain) -> Vec<Directive> {
    let set = |list: &[&str]| domain.set(&names(list)).expect("the domain has these facts");
    let directive = |name: &str, requires: FactSet, achieves: FactSet| Directive {
        min_interest: 0.1,
        requires,
        exclusion_radius_m: 3.0,
        ..Directive::new(name, achieves)
    };
    vec![
        directive("analyse", FactSet::EMPTY, set(&["analysed"])),
        directive("image", FactSet::EMPTY, set(&["imaged"])),
        directive("drill", set(&["imaged"]), set(&["drilled"])),
    ]
}

/// Ground of given heights (metres), hazard rates (per metre) and blocked cells.
pub(crate) fn ground(
    heights: Raster<f32>,
    hazard_per_m: Raster<f32>,
    blocked: Raster<bool>,
) -> Traversability {
    let severity = Raster::filled(heights.spec(), 0.0);
    let elevation = Layer::certain(heights).expect("heights are finite");
    let ground = Ground { elevation, blocked, severity, hazard_per_m };
    Traversability::from_ground(&Vehicle::default(), ground).expect("hazards are positive")
}

pub(crate) fn travel(ground: &Traversability, nodes: &[Cell]) -> TravelMatrix {
    travel_matrix(ground, nodes, Limits::NONE)
}
