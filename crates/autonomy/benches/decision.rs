//! One whole decision on 512² cells, stage by stage: the first one, after all the ground was seen, and a later one,
//! after the rover drove on and looked around. `cargo bench -p wisdom-autonomy --bench decision -- [RUNS [POSES
//! [EXPANSIONS]]]`: nine runs, one pose a goal and 10 000 expansions by default (missions have 50 000, for 14 goals).
//! `RAYON_NUM_THREADS` sets the threads.
#![expect(clippy::print_stdout, reason = "a program that reports measurements")]
#![expect(clippy::disallowed_methods, reason = "a program that takes time")]

use std::collections::BTreeMap;
use std::time::Instant;

use wisdom_autonomy::{
    Act, ApproachSpec, Autonomy, Budget, Decision, Derivation, ELEVATION, Fallback, LayerSpec,
    LayerWindow, MapUpdate, Observation, Outcome, Pose, RouteSpec, Source, Spec, Spent, Stage,
    StepResult, Triggers,
};
use wisdom_belief::Opinion;
use wisdom_fusion::{Band, Class, Expert, Fusion, LookupTable, Rows};
use wisdom_goals::{
    Directive, Domain, Extraction, ManagerSpec, OperatorText, Policy, Preferences, PrizeScale,
    ServiceCost,
};
use wisdom_grid::{Cell, GridSpec, Raster, Window};
use wisdom_planner::Vehicle;
use wisdom_terrain::{
    Base, Crater, HotSpot, Landscape, Patch, Ridge, Roughness, Scatter, Shape, normal_noise,
    unit_noise,
};

/// Cells a side, of one metre.
const SIDE: usize = 512;
/// Goals to be sequenced; the goals' crate takes as many of them as its search can.
const SEQUENCED: usize = 50;
const START: Cell = Cell { row: SIDE / 2, col: SIDE / 2 };
const SEED: u64 = 1;
/// Range of the rover's own look, cells.
const LOOK: usize = 40;
/// Cells driven between the two decisions.
const DRIVEN: usize = 6;
const MEASURED: [&str; 3] = [ELEVATION, "texture", "temperature"];

/// A number in [0, 1) for a purpose and a place.
fn draw(purpose: u64, place: usize) -> f64 {
    unit_noise(&[SEED, purpose, place as u64])
}

/// Rolling ground with craters, ridges and loose rocks; on it a loose lattice of outcrops, each a patch of a rare texture
/// under a warm spot.
fn landscape() -> Landscape {
    const LATTICE: usize = 9;
    let pitch = SIDE as f64 / LATTICE as f64;
    let centre = |purpose: u64, place: usize| {
        let along = |index: usize, axis: u64| {
            (index as f64 + 0.25 + 0.5 * draw(purpose + axis, place)) * pitch
        };
        [along(place % LATTICE, 0), along(place / LATTICE, 1)]
    };
    let outcrops = 0..LATTICE * LATTICE;
    let anywhere =
        |purpose: u64, place: usize| [0, 1].map(|axis| SIDE as f64 * draw(purpose + axis, place));
    Landscape {
        base: Base { elevation_m: 1.0, rise_east: 0.012, temperature: 3.0, ..Base::default() },
        roughness: Some(Roughness {
            amplitude_m: 2.5,
            wavelength_cells: 96.0,
            octaves: 5,
            gain: 0.4,
        }),
        scatter: vec![Scatter {
            per_1000_cells: 2.0,
            radius_cells: [0.6, 3.0],
            exponent: 2.0,
            height_m_per_cell: 0.6,
            class: Some(1),
        }],
        crater: (0..12)
            .map(|place| Crater {
                centre: anywhere(10, place),
                radius_cells: 8.0 + 20.0 * draw(12, place),
                depth_m: 2.5,
                rim_m: 0.8,
            })
            .collect(),
        ridge: (0..5)
            .map(|place| Ridge {
                from: anywhere(20, place),
                to: anywhere(22, place),
                half_width_cells: 14.0,
                height_m: 4.0,
            })
            .collect(),
        patch: outcrops
            .clone()
            .map(|place| Patch {
                class: 1 + (4.0 * draw(32, place)) as u16,
                shape: Shape::Disc {
                    centre: centre(30, place),
                    radius_cells: 3.0 + 5.0 * draw(33, place),
                },
            })
            .collect(),
        hot_spot: outcrops
            .map(|place| HotSpot {
                centre: centre(30, place),
                radius_cells: 6.0 + 8.0 * draw(34, place),
                edge_cells: 4.0,
                peak: 15.0 + 80.0 * draw(35, place),
            })
            .collect(),
        ..Landscape::default()
    }
}

fn opinion(paradox: f64, not_interesting: f64, interesting: f64) -> Opinion {
    Opinion { paradox, not_interesting, interesting }
}

/// The masses of the paper's Tables 1 to 3; the first over slopes that a rover meets (3, 9, 15, 21 and 27 degrees).
fn experts() -> Vec<Expert> {
    let dull = opinion(0.2, 0.8, 0.0);
    let bands = |bounds: &[f64], opinions: &[Opinion]| {
        let between = bounds.windows(2).zip(opinions);
        Rows::Bands(between.map(|(b, &opinion)| Band { lo: b[0], hi: b[1], opinion }).collect())
    };
    let slopes = bands(
        &[0.0, 0.052, 0.158, 0.268, 0.384, 0.51, f64::INFINITY],
        &[
            dull,
            opinion(0.3, 0.6, 0.1),
            opinion(0.1, 0.1, 0.8),
            opinion(0.15, 0.05, 0.8),
            opinion(0.05, 0.05, 0.9),
            opinion(0.05, 0.0, 0.95),
        ],
    );
    let temperatures = bands(
        &[0.0, 20.0, 40.0, 60.0, 80.0, 100.0],
        &[
            dull,
            opinion(0.4, 0.5, 0.1),
            opinion(0.05, 0.0, 0.95),
            opinion(0.15, 0.05, 0.8),
            opinion(0.05, 0.05, 0.9),
        ],
    );
    let textures = [
        opinion(0.3, 0.6, 0.1),
        opinion(0.1, 0.1, 0.8),
        opinion(0.15, 0.05, 0.8),
        opinion(0.05, 0.0, 0.95),
    ];
    let textures = Rows::Classes(
        (1..).zip(textures).map(|(class, opinion)| Class { class, opinion }).collect(),
    );
    let expert = |layer: &str, rows: Rows| Expert {
        name: layer.into(),
        layer: layer.into(),
        table: LookupTable::new(layer, layer, "", rows, dull).expect("the paper's masses"),
    };
    vec![
        expert("gradient", slopes),
        expert("temperature", temperatures),
        expert("texture", textures),
    ]
}

/// Operators and what they cost, limits, poses, stand-offs and radii as in the mission on Marias Pass; the budgets are
/// larger, for about a dozen goals.
fn spec() -> Spec {
    let names = |list: &[&str]| list.iter().map(ToString::to_string).collect::<Vec<_>>();
    let operator = |name: &str, [needs, adds, deletes]: [&[&str]; 3], cost: ServiceCost| {
        let (preconditions, adds, deletes) = (names(needs), names(adds), names(deletes));
        OperatorText { name: name.into(), preconditions, adds, deletes, cost }
    };
    let cost = |time_s, energy_j, data_mb| ServiceCost { time_s, energy_j, data_mb };
    let (stowed, deployed): (&[&str], &[&str]) = (&["arm-stowed"], &["arm-deployed"]);
    let domain = Domain::new(
        &[
            operator("drive", [stowed, &[], &[]], cost(0.0, 0.0, 0.0)),
            operator("unstow-arm", [stowed, deployed, stowed], cost(120.0, 3.0e3, 0.0)),
            operator("stow-arm", [deployed, stowed, deployed], cost(120.0, 3.0e3, 0.0)),
            operator("calibrate", [deployed, &["calibrated"], &[]], cost(600.0, 2.0e4, 0.0)),
            operator(
                "analyse",
                [&["arm-deployed", "calibrated"], &["analysed"], &[]],
                cost(1800.0, 6.0e4, 60.0),
            ),
            operator("image", [stowed, &["imaged"], &[]], cost(300.0, 1.0e4, 40.0)),
        ],
        &names(stowed),
    )
    .expect("the operators fit");
    let set = |facts: &[&str]| domain.set(&names(facts)).expect("facts of the domain");
    let directive = |name: &str, experts: &[usize], weight: f64, achieves: &str| Directive {
        experts: experts.to_vec(),
        min_credit: 0.4,
        min_interest: 0.6,
        weight,
        standoff_m: 6.0,
        exclusion_radius_m: 15.0,
        ..Directive::new(name, set(&[achieves]))
    };
    let directives = vec![
        directive("analyse-outcrop", &[0, 2], 1.0, "analysed"),
        directive("analyse-warm-rock", &[1], 1.0, "analysed"),
        directive("image-site", &[], 0.5, "imaged"),
    ];
    let layer =
        |name: &str, unit: &str, source| LayerSpec { name: name.into(), unit: unit.into(), source };
    let measured = Source::Measured(MapUpdate::Best);
    Spec {
        grid: GridSpec::new(SIDE, SIDE, 1.0).expect("a bench size"),
        working_cells: None,
        layers: vec![
            layer(ELEVATION, "m", measured),
            layer("texture", "", measured),
            layer("temperature", "", measured),
            layer("gradient", "", Source::Derived(Derivation::Gradient)),
        ],
        experts: experts(),
        fusion: Fusion::default(),
        prize: PrizeScale::Contrast,
        policy: Policy::ExpectedInterest,
        preferences: Preferences::default(),
        domain,
        directives,
        manager: ManagerSpec {
            extraction: Extraction { min_separation_m: 12.0, ..Extraction::default() },
            identity_radius_m: 10.0,
            max_sequenced: SEQUENCED,
            ..ManagerSpec::default()
        },
        vehicle: Vehicle {
            slope_max_deg: 28.0,
            step_max_m: 0.5,
            roughness_max_m: 0.25,
            footprint_radius_m: 1.5,
            ..Vehicle::default()
        },
        class_layer: None,
        close_look: BTreeMap::new(),
        slip_layer: None,
        routes: RouteSpec::default(),
        budget: Budget {
            time_s: 90_000.0,
            energy_j: 3.6e6,
            reserve_j: 2.0e5,
            data_mb: 1200.0,
            min_reliability: 0.5,
        },
        triggers: Triggers::default(),
        fallback: Fallback {
            max_looks: 3,
            look_range_m: 30.0,
            min_ignorance: 0.2,
            home: START,
            return_home: false,
        },
        approach: ApproachSpec { eye_height_m: 2.0, poses: 2 },
    }
}

type World = BTreeMap<String, Raster<f32>>;

/// A window of all measured layers, read with the uncertainty `u` of each cell; the readings are off to match.
fn readings(world: &World, window: Window, look: u64, u: impl Fn(Cell) -> f32) -> Vec<LayerWindow> {
    let error_at_full_u = [0.05, 0.0, 1.0];
    let layers = (0..).zip(MEASURED).zip(error_at_full_u);
    layers
        .map(|((number, layer), error): ((u64, &str), f32)| {
            let truth = &world[layer];
            let read = |cell: Cell| {
                let key = [SEED, look, number, truth.spec().index(cell) as u64];
                truth[cell] + error * u(cell) * normal_noise(&key) as f32
            };
            let seen = |cell: Cell| if u(cell) < 1.0 { read(cell) } else { 0.0 };
            LayerWindow {
                layer: layer.into(),
                window,
                values: window.cells().map(seen).collect(),
                uncertainty: window.cells().map(&u).collect(),
            }
        })
        .collect()
}

/// All the ground as it is known beforehand: blocks of 8 × 8 cells, each with its own uncertainty.
fn first_sight(world: &World, grid: GridSpec) -> Observation {
    let u = |cell: Cell| 0.15 + 0.3 * draw(40, cell.row / 8 * SIDE + cell.col / 8) as f32;
    Observation {
        number: 0,
        pose: Pose { cell: START, heading_rad: 0.0 },
        spent: Spent::default(),
        windows: readings(world, grid.window(), 0, u),
    }
}

/// The first leg's beginning driven, and what the cameras see from there; with it the report that asks for a decision.
fn second_sight(world: &World, spec: &Spec, decision: &Decision) -> (Observation, Outcome) {
    let Act::Pursue(goal) = decision.act else { panic!("the landscape holds goals") };
    let leg = &decision.plan().plan.legs[0].route;
    let track = leg.cells[..=DRIVEN.min(leg.cells.len() - 1)].to_vec();
    let cell = track[track.len() - 1];
    let pose = Pose { cell, heading_rad: 0.0 };
    let share = track.len() as f64 / leg.cells.len() as f64;
    let cost = leg.cost;
    let spent = Spent {
        time_s: share * cost.time_s,
        energy_j: share * cost.energy_j,
        data_mb: 0.0,
        length_m: share * cost.length_m,
    };
    let u =
        |seen: Cell| (0.02 + 0.98 * (cell.distance(seen) / LOOK as f64).powi(2)).min(1.0) as f32;
    let windows = readings(world, spec.grid.around(cell, LOOK), 1, u);
    let outcome = Outcome {
        decision: decision.number,
        result: StepResult::Interrupted(goal),
        operators: vec!["drive".into()],
        pose,
        spent,
        predicted_reliability: cost.reliability(),
        track,
    };
    (Observation { number: 1, pose, spent, windows }, outcome)
}

/// Milliseconds that the stages of one decision took, and all of it.
#[derive(Default)]
struct Times {
    stages: BTreeMap<Stage, f64>,
    whole: f64,
}

/// An observation, the report of the step before if there is one, and the decision.
fn timed(rover: &mut Autonomy, seen: &Observation, ended: Option<&Outcome>) -> (Decision, Times) {
    let mut times = Times::default();
    let began = Instant::now();
    let mut last = began;
    let mut watch = |stage| {
        let now = Instant::now();
        *times.stages.entry(stage).or_default() += (now - last).as_secs_f64() * 1e3;
        last = now;
    };
    rover.observe_watched(seen, &mut watch).expect("sound readings");
    if let Some(outcome) = ended {
        rover.report(outcome).expect("the step that was asked for");
    }
    let decision = rover.decide_watched(&mut watch).expect("a decision");
    times.whole = began.elapsed().as_secs_f64() * 1e3;
    (decision, times)
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// What the decision was about, and a digest of all it says: the same before and after a change that only saves time.
fn tell(name: &str, decision: &Decision) {
    let (sites, prominence) = (&decision.sites, Extraction::default().min_prominence);
    let prominent = sites.iter().filter(|site| site.prominence >= prominence).count();
    println!(
        "{name}: value {:.4}; {} sites, {prominent} of them of prominence {prominence} or more; {} goals to be sequenced, {} left \
         out; {} in the plan, one of {}; {:?} after {} labels",
        decision.plan().sequence.value,
        sites.len(),
        decision.shortlist.kept.len(),
        decision.shortlist.left_out.len(),
        decision.plan().sequence.stops.len(),
        decision.family.len(),
        decision.proof,
        decision.expansions,
    );
    println!("{name}: says {}", blake3::hash(format!("{decision:?}").as_bytes()).to_hex());
}

fn main() {
    let mut asked = std::env::args().skip(1).filter_map(|arg| arg.parse::<usize>().ok());
    let runs = asked.next().unwrap_or(9).max(1);
    let mut spec = spec();
    spec.approach.poses = asked.next().unwrap_or(1).max(1);
    spec.manager.expansions = asked.next().unwrap_or(10_000) as u64;
    let world = landscape().render(spec.grid, SEED);
    let seen = first_sight(&world, spec.grid);
    let fresh = Autonomy::new(spec.clone()).expect("a sound spec");

    let mut rover = fresh.clone();
    let (first, _) = timed(&mut rover, &seen, None);
    let (seen_later, outcome) = second_sight(&world, &spec, &first);
    let (later, _) = timed(&mut rover.clone(), &seen_later, Some(&outcome));
    tell("first", &first);
    tell("later", &later);

    let (mut firsts, mut laters) = (Vec::new(), Vec::new());
    for _ in 0..runs {
        let mut rover = fresh.clone();
        let (again, times) = timed(&mut rover, &seen, None);
        assert_eq!(again, first, "a decision is settled by what was seen");
        firsts.push(times);
        let (again, times) = timed(&mut rover, &seen_later, Some(&outcome));
        assert_eq!(again, later, "a decision is settled by what was seen");
        laters.push(times);
    }
    let threads = rayon::current_num_threads();
    println!(
        "{SIDE}², {} poses a goal, {} expansions, {threads} threads, median of {runs} runs, ms",
        spec.approach.poses, spec.manager.expansions
    );
    println!("{:16}{:>9}{:>9}", "", "first", "later");
    let row = |name: &str, of: &dyn Fn(&Times) -> f64| {
        println!(
            "{name:16}{:9.1}{:9.1}",
            median(firsts.iter().map(of)),
            median(laters.iter().map(of))
        );
    };
    for stage in Stage::ALL {
        row(&stage.to_string(), &|times| times.stages.get(&stage).copied().unwrap_or_default());
    }
    row("the whole", &|times| times.whole);
}
