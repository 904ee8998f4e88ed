//! A route between two cells is the one that the field has.

use proptest::prelude::*;
use wisdom_grid::{Cell, GridSpec, Raster, Window};
use wisdom_planner::{FieldOptions, Ground, Router, Traversability, Vehicle, field, route};
use wisdom_terrain::Layer;

/// Ground with hazards of one of five kinds: all equal, a few values (many ties), many, a span for the heap, and
/// one far below all others that only a blocked cell has.
fn any_ground() -> impl Strategy<Value = Ground> {
    (1..15usize, 1..15usize, 0..5usize).prop_flat_map(|(rows, cols, kind)| {
        let cells = rows * cols;
        (
            prop::collection::vec(0.0..1.0f32, cells),
            prop::collection::vec(prop::bool::weighted(0.2), cells),
            prop::collection::vec(0.0..0.2f32, cells),
        )
            .prop_map(move |(draws, blocked, heights)| {
                let spec = GridSpec::new(rows, cols, 0.5).expect("a small grid");
                let hazard = |(draw, &blocked): (f32, &bool)| match kind {
                    0 => 1e-4,
                    1 => 1e-4 * (1.0 + (3.0 * draw).floor()),
                    2 => 1e-4 * (1.0 + 99.0 * draw),
                    3 => 1e-6 * 10f32.powf(6.0 * draw),
                    _ if blocked => 1e-7,
                    _ => 1e-4 * (1.0 + 9.0 * draw),
                };
                let hazards = draws.into_iter().zip(&blocked).map(hazard).collect();
                Ground {
                    elevation: Layer::certain(Raster::from_vec(spec, heights).expect("heights"))
                        .expect("heights are finite"),
                    hazard_per_m: Raster::from_vec(spec, hazards).expect("a hazard a cell"),
                    blocked: Raster::from_vec(spec, blocked).expect("a value a cell"),
                    severity: Raster::filled(spec, 0.0),
                }
            })
    })
}

fn with_ground(ground: Ground) -> Traversability {
    Traversability::from_ground(&Vehicle::default(), ground).expect("hazards are positive")
}

/// Flat ground, a digit a cell: its hazard in ten-thousandths; `#` blocked; one metre a cell.
fn drawn(rows: &[&str]) -> Traversability {
    let spec = GridSpec::new(rows.len(), rows[0].len(), 1.0).expect("a small grid");
    let sign = |c: Cell| rows[c.row].as_bytes()[c.col];
    with_ground(Ground {
        elevation: Layer::certain(Raster::filled(spec, 0.0)).expect("heights are finite"),
        blocked: Raster::from_fn(spec, |c| sign(c) == b'#'),
        severity: Raster::filled(spec, 0.0),
        hazard_per_m: Raster::from_fn(spec, |c| {
            1e-4 * if sign(c) == b'#' { 1.0 } else { f32::from(sign(c) - b'0') }
        }),
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(192))]

    /// Cells and costs, to the last bit, for every pair, by one router asked again and again.
    #[test]
    fn a_route_is_that_of_the_field(ground in any_ground(), draw in 0.0..1.0f64) {
        let ground = with_ground(ground);
        let spec = ground.spec();
        let from = spec.cell((draw * spec.len() as f64) as usize);
        let field = field(&ground, from, &FieldOptions::default());
        let mut router = Router::new(&ground);
        for to in spec.cells() {
            let found = router.route(from, to);
            let label = found.as_ref().map(|found| found.route.cost.neg_ln_r);
            prop_assert_eq!(label, field.neg_ln_r(to), "{}", to);
            prop_assert_eq!(found.map(|found| found.route), field.route(to), "{}", to);
        }
    }

    /// What a router was asked before changes nothing, neither route nor work.
    #[test]
    fn a_router_forgets(ground in any_ground(), draws in prop::collection::vec(0.0..1.0f64, 2..12)) {
        let ground = with_ground(ground);
        let spec = ground.spec();
        let cell = |draw: f64| spec.cell((draw * spec.len() as f64) as usize);
        let mut router = Router::new(&ground);
        for pair in draws.windows(2) {
            let (from, to) = (cell(pair[0]), cell(pair[1]));
            prop_assert_eq!(router.route(from, to), route(&ground, from, to));
        }
    }
}

#[test]
fn a_router_forgets_even_after_it_ran_out_of_marks() {
    let ground = drawn(&["1111", "1##1", "1911"]);
    let (a, b, c) = (Cell::new(0, 0), Cell::new(2, 3), Cell::new(2, 0));
    let mut router = Router::new(&ground);
    let expected = [route(&ground, a, b), route(&ground, b, c)];
    assert!(expected.iter().all(Option::is_some));
    // Labels are marked by the number of the question, of which there are 2¹⁶.
    for _ in 0..40_000 {
        assert_eq!([router.route(a, b), router.route(b, c)], expected);
    }
}

#[test]
fn the_safer_way_round_is_taken_and_little_else_is_looked_at() {
    let ground = drawn(&["1111111111", "1999999991", "1111111111", "1111111111", "1111111111"]);
    let found = route(&ground, Cell::new(0, 0), Cell::new(0, 9)).expect("an open row");
    assert_eq!(found.route.cells, (0..10).map(|col| Cell::new(0, col)).collect::<Vec<_>>());
    assert!((found.route.cost.neg_ln_r - 9e-4).abs() < 1e-9);
    assert!(found.expansions <= 10, "{}", found.expansions);
}

#[test]
fn a_walled_off_or_blocked_target_has_no_route() {
    let ground = drawn(&["11#1", "11#1", "11##"]);
    assert_eq!(route(&ground, Cell::new(0, 0), Cell::new(0, 3)), None);
    assert_eq!(route(&ground, Cell::new(0, 0), Cell::new(2, 3)), None);
    let stay = route(&ground, Cell::new(2, 2), Cell::new(2, 2)).expect("it is there");
    assert_eq!((stay.route.cells, stay.expansions), (vec![Cell::new(2, 2)], 0));
    // What is blocked can be left.
    assert!(route(&ground, Cell::new(2, 2), Cell::new(0, 0)).is_some());
}

/// Cells keep the numbers of the larger ground that theirs is a part of.
#[test]
fn a_part_of_a_larger_ground_is_searched_by_its_own_numbers() {
    let whole = GridSpec::new(40, 50, 2.0).expect("a grid");
    let spec = whole.part(Window { row: 20, col: 30, rows: 8, cols: 9 }).expect("inside");
    let ground = with_ground(Ground {
        elevation: Layer::certain(Raster::filled(spec, 0.0)).expect("heights are finite"),
        blocked: Raster::filled(spec, false),
        severity: Raster::filled(spec, 0.0),
        hazard_per_m: Raster::from_fn(spec, |c| 1e-4 * (1 + (c.row * 7 + c.col * 3) % 5) as f32),
    });
    let (from, to) = (Cell::new(21, 30), Cell::new(27, 38));
    let of_field = field(&ground, from, &FieldOptions::default()).route(to);
    assert_eq!(route(&ground, from, to).map(|f| f.route), of_field);
}

#[test]
#[should_panic(expected = "target")]
fn a_target_off_the_grid_is_a_bug_of_the_caller() {
    let _ = route(&drawn(&["11", "11"]), Cell::new(0, 0), Cell::new(2, 0));
}
