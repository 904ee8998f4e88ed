//! The maps that follow from readings, and the stages in which a decision follows from the maps.

use proptest::prelude::*;
use wisdom_autonomy::{
    ApproachSpec, Autonomy, Budget, Derivation, Fallback, LayerSpec, LayerWindow, MapUpdate, Maps,
    Observation, Pose, Promise, RouteSpec, Source, Spec, Spent, Stage, Triggers,
};
use wisdom_belief::Opinion;
use wisdom_fusion::{Band, Expert, Fusion, LookupTable, Rows};
use wisdom_goals::{
    Directive, Domain, Kind, ManagerSpec, OperatorText, Policy, Preferences, PrizeScale,
    ServiceCost,
};
use wisdom_grid::{Cell, GridSpec, Window};
use wisdom_planner::{SlipClass, Vehicle};
use wisdom_terrain::unit_noise;

const ROWS: usize = 70;
const COLS: usize = 90;
const START: Cell = Cell { row: 35, col: 45 };

/// An expert that believes in large readings of a layer.
fn expert(layer: &str, unit: &str, largest: f64) -> Expert {
    let bands = (0..8).map(|i| {
        let (lo, hi) = (f64::from(i) * largest / 8.0, f64::from(i + 1) * largest / 8.0);
        let interesting = f64::from(i) / 10.0;
        let opinion = Opinion { paradox: 0.1, not_interesting: 0.9 - interesting, interesting };
        Band { lo, hi, opinion }
    });
    let outside = Opinion { paradox: 0.0, not_interesting: 1.0, interesting: 0.0 };
    let rows = Rows::Bands(bands.collect());
    let table = LookupTable::new(layer, layer, unit, rows, outside).expect("sound bands");
    Expert { name: layer.into(), layer: layer.into(), table }
}

/// Three measured layers, all that can be derived from elevation, an expert on most of them, and wheels that slip by
/// class: whatever a reading can make itself felt in.
fn spec(footprint_radius_m: f64, update: MapUpdate, working_cells: Option<usize>) -> Spec {
    let image = OperatorText {
        name: "image".into(),
        adds: vec!["imaged".into()],
        cost: ServiceCost { time_s: 60.0, ..ServiceCost::default() },
        ..OperatorText::default()
    };
    let drive = OperatorText { name: "drive".into(), ..OperatorText::default() };
    let domain = Domain::new(&[drive, image], &[]).expect("two operators");
    let imaged = domain.set(&["imaged".to_owned()]).expect("a fact of the domain");
    let directive = Directive {
        min_interest: 0.2,
        standoff_m: 3.0,
        exclusion_radius_m: 4.0,
        ..Directive::new("image", imaged)
    };
    let look_again = Directive { kind: Kind::LookAgain, ..directive.clone() };
    let adjudicate = Directive { kind: Kind::Adjudicate, ..directive.clone() };
    let layer =
        |name: &str, unit: &str, source| LayerSpec { name: name.into(), unit: unit.into(), source };
    let derived = |name: &str, unit: &str, from| layer(name, unit, Source::Derived(from));
    Spec {
        grid: GridSpec::new(ROWS, COLS, 1.0).expect("a small grid"),
        working_cells,
        layers: vec![
            layer("elevation", "m", Source::Measured(update)),
            layer("glow", "", Source::Measured(update)),
            layer("soil", "", Source::Measured(update)),
            derived("gradient", "", Derivation::Gradient),
            derived("slope", "deg", Derivation::Slope),
            derived("step", "m", Derivation::Step),
            derived("roughness", "m", Derivation::Roughness),
        ],
        experts: vec![
            expert("glow", "", 10.0),
            expert("slope", "deg", 60.0),
            expert("roughness", "m", 1.0),
        ],
        fusion: Fusion::default(),
        prize: PrizeScale::Contrast,
        policy: Policy::ExpectedInterest,
        preferences: Preferences::default(),
        domain,
        directives: vec![directive, look_again, adjudicate],
        manager: ManagerSpec::default(),
        vehicle: Vehicle {
            slope_max_deg: 40.0,
            step_max_m: 1.0,
            roughness_max_m: 0.8,
            footprint_radius_m,
            risk_level: 0.3,
            slip_class: vec![SlipClass {
                class: 1,
                name: "sand".into(),
                base: 0.035,
                growth_per_deg: 0.12,
            }],
            ..Vehicle::default()
        },
        class_layer: Some("soil".into()),
        close_look: [("glow".to_owned(), 0.1)].into_iter().collect(),
        slip_layer: Some("soil".into()),
        routes: RouteSpec::default(),
        budget: Budget {
            time_s: 1e5,
            energy_j: 1e8,
            reserve_j: 0.0,
            data_mb: f64::INFINITY,
            min_reliability: 0.1,
        },
        triggers: Triggers::default(),
        fallback: Fallback {
            max_looks: 0,
            look_range_m: 5.0,
            min_ignorance: 0.5,
            home: START,
            return_home: false,
        },
        approach: ApproachSpec { eye_height_m: 2.0, poses: 2 },
    }
}

/// Readings of all layers in a window, drawn by the seed; a cell in eight is not seen.
fn look(window: Window, seed: u64) -> Vec<LayerWindow> {
    let draw = |what: u64, cell: Cell| unit_noise(&[seed, what, cell.row as u64, cell.col as u64]);
    let u = |cell: Cell| if draw(0, cell) < 0.125 { 1.0 } else { draw(1, cell) as f32 };
    let read = |layer: &str, value: &dyn Fn(Cell) -> f64| LayerWindow {
        layer: layer.into(),
        window,
        values: window.cells().map(|cell| value(cell) as f32).collect(),
        uncertainty: window.cells().map(u).collect(),
    };
    let hills = |cell: Cell| libm::sin(cell.row as f64 / 9.0) + libm::cos(cell.col as f64 / 7.0);
    vec![
        read("elevation", &|cell| 2.0 * hills(cell) + 0.4 * draw(2, cell)),
        read("glow", &|cell| 10.0 * draw(3, cell)),
        read("soil", &|cell| (2.0 * draw(4, cell)).floor()),
    ]
}

fn observation(number: u32, windows: Vec<LayerWindow>) -> Observation {
    let pose = Pose { cell: START, heading_rad: 0.0 };
    Observation { number, pose, spent: Spent::default(), windows }
}

fn told(spec: &Spec, observations: impl IntoIterator<Item = Vec<LayerWindow>>) -> Autonomy {
    let mut rover = Autonomy::new(spec.clone()).expect("a sound spec");
    for (number, windows) in (0..).zip(observations) {
        rover.observe(&observation(number, windows)).expect("sound readings");
    }
    rover
}

fn maps(rover: &Autonomy) -> &Maps {
    rover.maps().expect("maps since the first observation")
}

/// A window of at most 12 cells a side, anywhere on the grid.
fn window() -> impl Strategy<Value = Window> {
    (1..=12_usize, 1..=12_usize).prop_flat_map(|(rows, cols)| {
        (0..=ROWS - rows, 0..=COLS - cols).prop_map(move |(row, col)| Window {
            row,
            col,
            rows,
            cols,
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Looks one after another leave the same maps, bit for bit, as all of them taken in at once.
    #[test]
    fn a_look_at_a_part_leaves_the_maps_that_all_readings_at_once_would_make(
        windows in prop::collection::vec(window(), 1..4),
        footprint_radius_m in 0.4..3.6_f64,
        update in prop::sample::select(vec![MapUpdate::Best, MapUpdate::Latest, MapUpdate::Weighted]),
        working_cells in prop::option::of(Just(64)),
        prize in prop::sample::select(PrizeScale::ALL.to_vec()),
        seed in any::<u64>(),
    ) {
        let spec = Spec { prize, ..spec(footprint_radius_m, update, working_cells) };
        let mut looks = vec![look(spec.grid.window(), seed)];
        looks.extend((1..).zip(windows).map(|(n, window)| look(window, seed.wrapping_add(n))));
        let at_once = told(&spec, [looks.concat()]);
        let in_turn = told(&spec, looks);
        let (whole, parts) = (maps(&at_once), maps(&in_turn));
        prop_assert_eq!(&whole.layers, &parts.layers);
        prop_assert_eq!(&whole.evidence, &parts.evidence);
        prop_assert_eq!(&whole.interest, &parts.interest);
        prop_assert_eq!(&whole.prize, &parts.prize);
        prop_assert_eq!(&whole.sites, &parts.sites);
        let promise = |maps: &Maps| {
            let Promise { interest, gain, sites } = maps.promise.clone().expect("a directive asks");
            (interest, gain, sites)
        };
        prop_assert_eq!(promise(whole), promise(parts));
        prop_assert_eq!(&whole.disputes, &parts.disputes);
        prop_assert_eq!(whole.seen.to_bits(), parts.seen.to_bits());
        prop_assert_eq!(whole.ground.blocked(), parts.ground.blocked());
        prop_assert_eq!(whole.ground.severities(), parts.ground.severities());
        prop_assert_eq!(whole.ground.hazard(), parts.ground.hazard());
        prop_assert_eq!(whole.ground.classes(), parts.ground.classes());
        let map = whole.ground.spec();
        for cell in map.cells() {
            for beside in map.neighbours(cell) {
                prop_assert_eq!(
                    whole.ground.edge(cell, beside),
                    parts.ground.edge(cell, beside),
                    "from {} to {}", cell, beside
                );
            }
        }
    }
}

/// The stages that an observation and a decision go through.
fn stages(rover: &mut Autonomy, seen: &Observation) -> Vec<Stage> {
    let mut stages = Vec::new();
    let mut watch = |stage| stages.push(stage);
    rover.observe_watched(seen, &mut watch).expect("sound readings");
    rover.decide_watched(&mut watch).expect("a decision");
    stages
}

#[test]
fn a_watch_hears_of_every_stage_in_order_and_changes_no_decision() {
    let spec = spec(1.5, MapUpdate::Best, None);
    let whole = observation(0, look(spec.grid.window(), 1));
    let part = observation(1, look(Window { row: 30, col: 40, rows: 8, cols: 8 }, 2));
    let nothing = observation(2, vec![]);
    let mut watched = told(&spec, []);
    assert_eq!(stages(&mut watched, &whole), Stage::ALL);
    assert_eq!(stages(&mut watched, &part), Stage::ALL);
    let without_maps: Vec<Stage> = Stage::ALL
        .into_iter()
        .filter(|stage| !(Stage::Layers..=Stage::Traversability).contains(stage))
        .collect();
    assert_eq!(stages(&mut watched, &nothing), without_maps);

    let mut alone = told(&spec, []);
    let mut watched = told(&spec, []);
    for seen in [whole, part, nothing] {
        alone.observe(&seen).expect("sound readings");
        watched.observe_watched(&seen, &mut |_| {}).expect("sound readings");
        let (a, b) = (alone.decide(), watched.decide_watched(&mut |_| {}));
        assert_eq!(a.expect("a decision"), b.expect("a decision"));
    }
}
