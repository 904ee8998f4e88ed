//! What the core is told once, built by hand: the ground, two experts, a directive, operators, a vehicle, a budget.
//! The tables are made up for the drawn ground of `frames.jsonl`; a rover's own are made from what its scientists say.

use std::collections::BTreeMap;
use std::error::Error;

use wisdom_autonomy::{
    ApproachSpec, Budget, Derivation, ELEVATION, Fallback, LayerSpec, MapUpdate, RouteSpec, Source,
    Spec, Triggers,
};
use wisdom_belief::Opinion;
use wisdom_fusion::{Band, Expert, Fusion, LookupTable, Rows};
use wisdom_goals::{
    Directive, Domain, Extraction, ManagerSpec, OperatorText, Policy, Preferences, PrizeScale,
    ServiceCost,
};
use wisdom_grid::{Cell, GridSpec};
use wisdom_planner::Vehicle;

/// Cells along each side of the ground, each a metre long.
pub(crate) const SIDE: usize = 24;
/// Where the rover begins, and comes back to.
pub(crate) const HOME: Cell = Cell { row: 20, col: 4 };

/// Everything the core is told once.
///
/// # Errors
/// Whatever part does not hold together says what is wrong with it.
pub(crate) fn spec() -> Result<Spec, Box<dyn Error>> {
    let domain = domain()?;
    let imaged = domain.set(&["rock-imaged".to_owned()])?;
    let image = Directive {
        min_interest: 0.5,
        standoff_m: 3.0,
        exclusion_radius_m: 3.0,
        ..Directive::new("image-rock", imaged)
    };
    Ok(Spec {
        grid: GridSpec::new(SIDE, SIDE, 1.0)?,
        working_cells: None,
        layers: vec![
            layer(ELEVATION, "m", Source::Measured(MapUpdate::Best)),
            layer("warmth", "K", Source::Measured(MapUpdate::Best)),
            layer("gradient", "", Source::Derived(Derivation::Gradient)),
        ],
        experts: vec![edges()?, warmth()?],
        fusion: Fusion::default(),
        prize: PrizeScale::Contrast,
        policy: Policy::ExpectedInterest,
        preferences: Preferences::default(),
        domain,
        directives: vec![image],
        manager: ManagerSpec {
            identity_radius_m: 3.0,
            extraction: Extraction { min_separation_m: 3.0, ..Extraction::default() },
            ..ManagerSpec::default()
        },
        vehicle: Vehicle { speed_m_s: 0.05, ..Vehicle::default() },
        class_layer: None,
        close_look: BTreeMap::new(),
        slip_layer: None,
        routes: RouteSpec::default(),
        budget: Budget {
            time_s: 8.0 * 3600.0,
            energy_j: 2e6,
            reserve_j: 1e5,
            data_mb: 500.0,
            min_reliability: 0.5,
        },
        triggers: Triggers::default(),
        fallback: Fallback {
            max_looks: 0,
            look_range_m: 8.0,
            min_ignorance: 0.5,
            home: HOME,
            return_home: true,
        },
        approach: ApproachSpec { eye_height_m: 2.0, poses: 3 },
    })
}

fn layer(name: &str, unit: &str, source: Source) -> LayerSpec {
    LayerSpec { name: name.to_owned(), unit: unit.to_owned(), source }
}

fn opinion(interesting: f64, not_interesting: f64) -> Opinion {
    Opinion { interesting, not_interesting, paradox: 0.0 }
}

/// Steep edges speak of rock, level ground of dust.
fn edges() -> Result<Expert, Box<dyn Error>> {
    let rows = vec![
        Band { lo: 0.0, hi: 0.05, opinion: opinion(0.0, 0.6) },
        Band { lo: 0.05, hi: 0.15, opinion: opinion(0.3, 0.3) },
        Band { lo: 0.15, hi: f64::INFINITY, opinion: opinion(0.8, 0.0) },
    ];
    expert("edges", "gradient", "", rows)
}

/// Rock keeps the warmth of the day.
fn warmth() -> Result<Expert, Box<dyn Error>> {
    let rows = vec![
        Band { lo: 0.0, hi: 230.0, opinion: opinion(0.0, 0.7) },
        Band { lo: 230.0, hi: 240.0, opinion: opinion(0.4, 0.2) },
        Band { lo: 240.0, hi: 400.0, opinion: opinion(0.9, 0.0) },
    ];
    expert("warmth", "warmth", "K", rows)
}

fn expert(name: &str, layer: &str, unit: &str, rows: Vec<Band>) -> Result<Expert, Box<dyn Error>> {
    let outside = opinion(0.0, 0.0);
    let table = LookupTable::new(name, layer, unit, Rows::Bands(rows), outside)?;
    Ok(Expert { name: name.to_owned(), layer: layer.to_owned(), table })
}

/// The mast is down while wheels turn, and up for an image.
fn domain() -> Result<Domain, Box<dyn Error>> {
    let names = |list: &[&str]| list.iter().map(ToString::to_string).collect::<Vec<_>>();
    let operators = [
        OperatorText {
            name: "drive".to_owned(),
            preconditions: names(&["mast-down"]),
            ..OperatorText::default()
        },
        OperatorText {
            name: "raise-mast".to_owned(),
            preconditions: names(&["mast-down"]),
            adds: names(&["mast-up"]),
            deletes: names(&["mast-down"]),
            cost: ServiceCost { time_s: 30.0, energy_j: 600.0, data_mb: 0.0 },
        },
        OperatorText {
            name: "lower-mast".to_owned(),
            preconditions: names(&["mast-up"]),
            adds: names(&["mast-down"]),
            deletes: names(&["mast-up"]),
            cost: ServiceCost { time_s: 30.0, energy_j: 300.0, data_mb: 0.0 },
        },
        OperatorText {
            name: "image".to_owned(),
            preconditions: names(&["mast-up"]),
            adds: names(&["rock-imaged"]),
            cost: ServiceCost { time_s: 120.0, energy_j: 2400.0, data_mb: 20.0 },
            ..OperatorText::default()
        },
    ];
    Ok(Domain::new(&operators, &names(&["mast-down"]))?)
}
