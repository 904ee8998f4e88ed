//! Travel kept between decisions is the travel of the new map, bit for bit.

mod drawn;

use drawn::{any_ground, pick, with_ground};
use proptest::prelude::*;
use wisdom_grid::{Cell, GridSpec, Raster};
use wisdom_planner::{
    Ground, Limits, SlipClass, TravelCache, TravelOptions, Traversability, Vehicle, Weights,
    travel_alternatives,
};
use wisdom_terrain::Layer;

/// A change of one cell: which, what of it, and to what.
type Change = (f64, u8, f32);

fn changed(ground: &Ground, changes: &[Change]) -> Ground {
    let mut ground = ground.clone();
    let spec = ground.elevation.spec();
    for &(place, what, value) in changes {
        let cell = spec.cell((place * spec.len() as f64) as usize);
        match what {
            0 => ground.blocked[cell] ^= true,
            1 => ground.hazard_per_m[cell] = 1e-4 * (1.0 + 50.0 * value),
            2 => ground.elevation.set(cell, 0.2 * value, 0.0),
            // Unknown heights change time and energy without being heights.
            3 => ground.elevation.set(cell, 0.0, 1.0),
            // Beyond what the ring can hold: the heap takes over everywhere.
            _ => ground.hazard_per_m[cell] = 1e4,
        }
    }
    ground
}

fn any_changes() -> impl Strategy<Value = Vec<Change>> {
    prop::collection::vec((0.0..1.0f64, 0..5u8, 0.0..1.0f32), 0..3)
}

proptest! {
    /// Over a chain of decisions: maps that change a little, poses that come and go, limits now and then.
    #[test]
    fn kept_travel_is_fresh_travel(
        ground in any_ground(),
        rounds in prop::collection::vec(
            (any_changes(), prop::collection::vec(0.0..1.0f64, 1..5), prop::bool::weighted(0.2)), 1..5,
        ),
        sweep in prop::bool::ANY,
    ) {
        let mut ground = ground;
        let mut cache = TravelCache::new();
        let weights = if sweep { vec![Weights::new(2e3, 1.0, 1e-4).unwrap()] } else { Vec::new() };
        for (changes, draws, limited) in rounds {
            ground = changed(&ground, &changes);
            let judged = with_ground(ground.clone());
            let nodes: Vec<Cell> = draws.iter().map(|&draw| pick(&judged, draw)).collect();
            let limits = if limited { Limits { max_time_s: 90.0, ..Limits::NONE } } else { Limits::NONE };
            let options = TravelOptions { limits, weights: &weights };
            let kept = cache.travel(&judged, &nodes, &options);
            prop_assert_eq!(kept, travel_alternatives(&judged, &nodes, &options));
        }
    }
}

/// Flat ground, of one hazard but for one cell.
fn plain(side: usize, odd: Cell, hazard: f32) -> Traversability {
    let spec = GridSpec::new(side, side, 1.0).expect("a small grid");
    with_ground(Ground {
        elevation: Layer::certain(Raster::filled(spec, 0.0)).expect("heights are finite"),
        blocked: Raster::filled(spec, false),
        severity: Raster::filled(spec, 0.0),
        hazard_per_m: Raster::from_fn(spec, |cell| if cell == odd { hazard } else { 2e-4 }),
    })
}

#[test]
fn a_change_far_from_all_searches_costs_no_search() {
    let nodes = [Cell::new(2, 2), Cell::new(6, 3), Cell::new(3, 8)];
    let options = TravelOptions::default();
    let mut cache = TravelCache::new();
    let (far, near) = (Cell::new(58, 58), Cell::new(4, 4));
    let _ = cache.travel(&plain(60, far, 2e-4), &nodes, &options);
    assert_eq!(cache.searches(), 3);
    let ground = plain(60, far, 9e-4);
    let kept = cache.travel(&ground, &nodes, &options);
    assert_eq!(cache.searches(), 3, "nobody had looked there");
    assert_eq!(kept, travel_alternatives(&ground, &nodes, &options));
    let ground = plain(60, near, 9e-4);
    let kept = cache.travel(&ground, &nodes, &options);
    assert_eq!(cache.searches(), 6, "everybody had looked there");
    assert_eq!(kept, travel_alternatives(&ground, &nodes, &options));
}

#[test]
fn only_the_poses_near_a_change_are_searched_from_again() {
    let (west, east) = ([Cell::new(5, 2), Cell::new(8, 5)], [Cell::new(5, 55), Cell::new(9, 57)]);
    let options = TravelOptions::default();
    let mut cache = TravelCache::new();
    let changed = Cell::new(6, 4);
    for nodes in [west, east] {
        let _ = cache.travel(&plain(60, changed, 2e-4), &nodes, &options);
    }
    assert_eq!(cache.searches(), 4);
    for nodes in [west, east] {
        let _ = cache.travel(&plain(60, changed, 5e-4), &nodes, &options);
    }
    assert_eq!(cache.searches(), 6, "the two in the west");
}

#[test]
fn other_questions_are_searched_for_anew() {
    let odd = Cell::new(0, 0);
    let ground = plain(20, odd, 3e-4);
    let nodes = [Cell::new(2, 2), Cell::new(6, 3), Cell::new(3, 8)];
    let options = TravelOptions::default();
    let mut cache = TravelCache::new();
    let _ = cache.travel(&ground, &nodes[..2], &options);
    let _ = cache.travel(&ground, &nodes[..2], &options);
    assert_eq!(cache.searches(), 2, "the same question");
    let _ = cache.travel(&ground, &nodes, &options);
    assert_eq!(cache.searches(), 5, "the third pose is a new target of the others");
    let _ = cache.travel(&ground, &nodes[1..], &options);
    assert_eq!(cache.searches(), 5, "fewer targets are among those kept");
    let limits = Limits { max_time_s: 1e6, ..Limits::NONE };
    let _ = cache.travel(&ground, &nodes, &TravelOptions { limits, ..options });
    assert_eq!(cache.searches(), 8, "limits");
    let weights = Weights::sweep(&ground, 1);
    let _ = cache.travel(&ground, &nodes, &TravelOptions { limits, weights: &weights });
    assert_eq!(cache.searches(), 11, "weights");
    let _ =
        cache.travel(&plain(21, odd, 3e-4), &nodes, &TravelOptions { limits, weights: &weights });
    assert_eq!(cache.searches(), 14, "another grid");
    let vehicle = Vehicle { speed_m_s: 0.08, ..Vehicle::default() };
    let heights = Layer::certain(Raster::filled(ground.spec(), 0.0)).expect("heights are finite");
    let quick = Traversability::new(&vehicle, &heights).expect("a sound vehicle");
    let _ = cache.travel(&quick, &nodes, &options);
    assert_eq!(cache.searches(), 17, "another vehicle");
}

#[test]
fn the_poses_kept_are_bounded_and_the_newest_stay() {
    let ground = plain(40, Cell::new(0, 0), 3e-4);
    let options = TravelOptions::default();
    let mut cache = TravelCache::new();
    let pose = |i: usize| [Cell::new(i / 40, i % 40)];
    for i in 0..TravelCache::MOST_POSES + 10 {
        let _ = cache.travel(&ground, &pose(i), &options);
    }
    assert_eq!(cache.poses(), TravelCache::MOST_POSES);
    let searches = cache.searches();
    let _ = cache.travel(&ground, &pose(TravelCache::MOST_POSES + 9), &options);
    assert_eq!(cache.searches(), searches, "the newest is kept");
    let _ = cache.travel(&ground, &pose(0), &options);
    assert_eq!(cache.searches(), searches + 1, "the oldest is gone");
}

#[test]
fn a_class_that_changes_alone_is_a_change() {
    let spec = GridSpec::new(12, 12, 1.0).expect("a small grid");
    let sand = SlipClass { class: 1, name: "sand".into(), base: 0.3, growth_per_deg: 0.1 };
    let vehicle = Vehicle { slip_class: vec![sand], ..Vehicle::default() };
    let flat = Layer::certain(Raster::filled(spec, 0.0)).expect("heights are finite");
    let on = |class: f32| {
        let mut classes = Layer::certain(Raster::filled(spec, 2.0)).expect("classes are finite");
        classes.set(Cell::new(5, 5), class, 0.0);
        Traversability::on_classes(&vehicle, &flat, Some(&classes)).expect("a sound vehicle")
    };
    let nodes = [Cell::new(5, 2), Cell::new(5, 8)];
    let options = TravelOptions::default();
    let mut cache = TravelCache::new();
    let rock = cache.travel(&on(2.0), &nodes, &options);
    let sand = cache.travel(&on(1.0), &nodes, &options);
    assert_eq!(sand, travel_alternatives(&on(1.0), &nodes, &options));
    assert!(sand.alternatives(0, 1)[0].time_s > rock.alternatives(0, 1)[0].time_s);
    assert_eq!(sand.alternatives(0, 1)[0].neg_ln_r, rock.alternatives(0, 1)[0].neg_ln_r);
}
