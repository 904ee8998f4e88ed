//! The search finds what an independent one finds, whatever its queue, its limits and the number of threads.

mod drawn;

use drawn::{Total, any_ground, mirrored, pick, turned, with_ground};
use pathfinding::prelude::dijkstra_all;
use proptest::prelude::*;
use wisdom_grid::{Cell, GridSpec, Raster};
use wisdom_planner::{
    CostVector, FieldOptions, Ground, Limits, Route, Traversability, Vehicle, field, travel_matrix,
};
use wisdom_terrain::Layer;

/// The neighbours that may be entered, and −ln R of the step; written from the rules, not from the crate.
fn successors(ground: &Traversability, from: Cell) -> Vec<(Cell, Total)> {
    let spec = ground.spec();
    let free = |cell| !ground.is_blocked(cell);
    let straight = |to: Cell| from.row == to.row || from.col == to.col;
    let corners = |to: Cell| [Cell::new(from.row, to.col), Cell::new(to.row, from.col)];
    spec.neighbours(from)
        .filter(|&to| free(to) && (straight(to) || corners(to).into_iter().all(free)))
        .map(|to| {
            let diagonal = !straight(to);
            let half =
                0.5 * spec.spacing_m() * if diagonal { std::f64::consts::SQRT_2 } else { 1.0 };
            let sum = f64::from(ground.hazard_per_m(from)) + f64::from(ground.hazard_per_m(to));
            (to, Total(half * sum))
        })
        .collect()
}

fn all() -> FieldOptions<'static> {
    FieldOptions::default()
}

proptest! {
    /// To the last bit: both take the least of the sums from source to cell.
    #[test]
    fn the_field_is_what_dijkstra_finds(ground in any_ground(), draw in 0.0..1.0f64) {
        let ground = with_ground(ground);
        let source = pick(&ground, draw);
        let reference = dijkstra_all(&source, |&cell| successors(&ground, cell));
        let field = field(&ground, source, &all());
        for cell in ground.spec().cells() {
            let expected = reference.get(&cell).map(|&(_, Total(label))| label);
            let expected = if cell == source { Some(0.0) } else { expected };
            prop_assert_eq!(field.neg_ln_r(cell), expected, "{}", cell);
        }
    }

    /// The cost of a route is the sum of its edges, its reliability their product, and both lie where they should.
    #[test]
    fn a_route_is_the_sum_of_its_edges(ground in any_ground(), draw in 0.0..1.0f64) {
        let ground = with_ground(ground);
        let source = pick(&ground, draw);
        let field = field(&ground, source, &all());
        for cell in ground.spec().cells() {
            let Some(Route { cells, cost }) = field.route(cell) else { continue };
            prop_assert_eq!((cells[0], cells[cells.len() - 1]), (source, cell));
            let edges: Vec<CostVector> = cells
                .windows(2)
                .map(|pair| ground.edge(pair[0], pair[1]).expect("a route takes open steps"))
                .collect();
            prop_assert_eq!(cost, edges.iter().copied().sum::<CostVector>());
            prop_assert_eq!(field.neg_ln_r(cell), Some(cost.neg_ln_r));
            prop_assert_eq!(field.cost(cell), Some(cost));
            let product: f64 = edges.iter().map(|edge| edge.reliability()).product();
            prop_assert!((cost.reliability() - product).abs() < 1e-12);
            prop_assert!(cost.reliability() > 0.0 && cost.reliability() <= 1.0);
        }
    }

    /// A turned or mirrored map has the turned or mirrored field.
    #[test]
    fn the_field_does_not_depend_on_where_north_is(ground in any_ground(), draw in 0.0..1.0f64) {
        let plain = with_ground(ground.clone());
        let source = pick(&plain, draw);
        let (rows, cols) = (plain.spec().rows(), plain.spec().cols());
        let other = |blocked, hazard_per_m: Raster<f32>| {
            let spec = hazard_per_m.spec();
            with_ground(Ground {
                elevation: Layer::certain(Raster::filled(spec, 0.0)).expect("heights are finite"),
                blocked,
                severity: Raster::filled(spec, 0.0),
                hazard_per_m,
            })
        };
        let quarter = other(turned(&ground.blocked), turned(&ground.hazard_per_m));
        let mirror = other(mirrored(&ground.blocked), mirrored(&ground.hazard_per_m));
        let to_quarter = |cell: Cell| Cell::new(cell.col, rows - 1 - cell.row);
        let to_mirror = |cell: Cell| Cell::new(cell.row, cols - 1 - cell.col);
        let first = field(&plain, source, &all());
        let second = field(&quarter, to_quarter(source), &all());
        let third = field(&mirror, to_mirror(source), &all());
        for cell in plain.spec().cells() {
            prop_assert_eq!(first.neg_ln_r(cell), second.neg_ln_r(to_quarter(cell)));
            prop_assert_eq!(first.neg_ln_r(cell), third.neg_ln_r(to_mirror(cell)));
        }
    }

    /// Asking for some cells only changes nothing about them.
    #[test]
    fn targets_have_the_routes_of_the_whole_field(
        ground in any_ground(), draws in prop::collection::vec(0.0..1.0f64, 1..5),
    ) {
        let ground = with_ground(ground);
        let targets: Vec<Cell> = draws.iter().map(|&draw| pick(&ground, draw)).collect();
        let source = pick(&ground, 0.5);
        let whole = field(&ground, source, &all());
        let part = field(&ground, source, &FieldOptions { targets: Some(&targets), ..all() });
        for &target in &targets {
            prop_assert_eq!(whole.route(target), part.route(target));
        }
    }

    /// What `field` promises of limits: routes keep them, and a most reliable route that keeps them is found.
    #[test]
    fn limits_cut_no_route_that_keeps_them(
        ground in any_ground(), draw in 0.0..1.0f64, max_time_s in 0.0..200.0f64, max_energy_j in 0.0..40_000.0f64,
    ) {
        let ground = with_ground(ground);
        let source = pick(&ground, draw);
        let limits = Limits { max_time_s, max_energy_j };
        let free = field(&ground, source, &all());
        let bound = field(&ground, source, &FieldOptions { limits, ..all() });
        for cell in ground.spec().cells() {
            let keeps = |cost: CostVector| cost.time_s <= max_time_s && cost.energy_j <= max_energy_j;
            if let Some(best) = free.route(cell) && keeps(best.cost) {
                prop_assert_eq!(bound.route(cell), Some(best));
            } else if let Some(route) = bound.route(cell) {
                prop_assert!(keeps(route.cost));
                prop_assert!(route.cost.neg_ln_r >= free.neg_ln_r(cell).unwrap());
            }
        }
    }

    /// Ties are broken by cell, not by queue: one far-off cell of another hazard changes the queue and no route.
    #[test]
    fn ring_and_heap_give_the_same_routes(ground in any_ground(), draw in 0.0..1.0f64) {
        let (rows, cols) = (ground.blocked.spec().rows(), ground.blocked.spec().cols());
        // A walled-off cell beyond the eastern edge; its hazard decides which queue is used.
        let widened = |hazard: f32| {
            let spec = GridSpec::new(rows, cols + 2, 0.5).expect("a small grid");
            let inside = |cell: Cell| cell.col < cols;
            with_ground(Ground {
                elevation: Layer::certain(Raster::filled(spec, 0.0)).expect("heights are finite"),
                blocked: Raster::from_fn(spec, |c| {
                    if inside(c) { ground.blocked[c] } else { c.col == cols }
                }),
                severity: Raster::filled(spec, 0.0),
                hazard_per_m: Raster::from_fn(spec, |c| {
                    if inside(c) { ground.hazard_per_m[c] } else { hazard }
                }),
            })
        };
        let (near, far) = (widened(1e-3), widened(1e9));
        let source = ground.blocked.spec().cell((draw * (rows * cols) as f64) as usize);
        let (first, second) = (field(&near, source, &all()), field(&far, source, &all()));
        for cell in ground.blocked.spec().cells() {
            prop_assert_eq!(first.route(cell), second.route(cell));
        }
    }
}

/// Rolling ground with hazards from its slopes: routes and sums that would show a changed order of work.
fn rolling(side: usize) -> Traversability {
    let spec = GridSpec::new(side, side, 1.0).expect("a small grid");
    let height = |cell: Cell| {
        let (x, y) = (cell.col as f64, cell.row as f64);
        (3.0 * libm::sin(x / 17.0) + 2.0 * libm::cos(y / 11.0) + 0.1 * libm::sin(x + 2.0 * y))
            as f32
    };
    let layer = Layer::certain(Raster::from_fn(spec, height)).expect("heights are finite");
    Traversability::new(&Vehicle::default(), &layer).expect("vehicle and ground are sound")
}

fn poses(side: usize) -> Vec<Cell> {
    (0..12).map(|i| Cell::new((i * 37) % side, (i * 53 + 5) % side)).collect()
}

#[test]
fn a_matrix_has_the_same_bits_on_any_number_of_threads() {
    let work = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("threads can be started");
        pool.install(|| {
            let ground = rolling(90);
            (ground.hazard().clone(), travel_matrix(&ground, &poses(90), Limits::NONE))
        })
    };
    let one = work(1);
    assert_eq!(one, work(2));
    assert_eq!(one, work(7));
    let reached = (0..12).filter(|&to| !one.1.alternatives(0, to).is_empty()).count();
    assert!(reached > 6, "the ground is open enough to prove something: {reached} of 12 reached");
}

#[test]
fn a_matrix_holds_the_routes_of_the_fields() {
    let (ground, nodes) = (rolling(60), poses(60));
    let matrix = travel_matrix(&ground, &nodes, Limits::NONE);
    for (from, &source) in nodes.iter().enumerate() {
        let field = field(&ground, source, &all());
        for (to, &target) in nodes.iter().enumerate() {
            assert_eq!(matrix.route(from, to, 0), field.route(target));
            assert_eq!(matrix.alternatives(from, to).first().copied(), field.cost(target));
            assert_eq!(matrix.route(from, to, 1), None);
        }
        assert_eq!(matrix.alternatives(from, from), [CostVector::ZERO]);
    }
}

/// Flat ground, `#` blocked, one metre a cell.
fn drawn(rows: &[&str]) -> Traversability {
    let spec = GridSpec::new(rows.len(), rows[0].len(), 1.0).expect("a small grid");
    with_ground(Ground {
        elevation: Layer::certain(Raster::filled(spec, 0.0)).expect("heights are finite"),
        blocked: Raster::from_fn(spec, |c| rows[c.row].as_bytes()[c.col] == b'#'),
        severity: Raster::filled(spec, 0.0),
        hazard_per_m: Raster::filled(spec, 1e-4),
    })
}

#[test]
fn what_a_wall_encloses_is_unreachable_and_not_an_error() {
    let ground = drawn(&["...#.", "...#.", "...#."]);
    let nodes = [Cell::new(0, 0), Cell::new(2, 4), Cell::new(2, 2)];
    let matrix = travel_matrix(&ground, &nodes, Limits::NONE);
    assert!(matrix.alternatives(0, 1).is_empty());
    assert_eq!(matrix.route(0, 1, 0), None);
    assert_eq!(matrix.alternatives(0, 2).len(), 1);
}

#[test]
fn a_rover_on_a_cell_that_became_blocked_can_leave_it() {
    let ground = drawn(&["....", ".#..", "...."]);
    let field = field(&ground, Cell::new(1, 1), &all());
    assert_eq!(field.route(Cell::new(1, 3)).expect("a way out").cells.len(), 3);
    let from_outside = wisdom_planner::field(&ground, Cell::new(0, 0), &all());
    assert_eq!(from_outside.route(Cell::new(1, 1)), None);
}

/// The documented limit of limits: a less reliable, shorter way is not tried in place of one that is cut.
#[test]
fn a_cell_whose_most_reliable_route_is_over_the_limit_counts_as_unreached() {
    // The straight row is hazardous, the way around it long but safe.
    let spec = GridSpec::new(3, 7, 1.0).expect("a small grid");
    let ground = with_ground(Ground {
        elevation: Layer::certain(Raster::filled(spec, 0.0)).expect("heights are finite"),
        blocked: Raster::from_fn(spec, |c| c.row == 1 && c.col > 0 && c.col < 6),
        severity: Raster::filled(spec, 0.0),
        hazard_per_m: Raster::from_fn(spec, |c| if c.row == 2 { 1e-2 } else { 1e-4 }),
    });
    let (source, target) = (Cell::new(2, 0), Cell::new(2, 6));
    let free = field(&ground, source, &all()).cost(target).expect("open both ways");
    assert_eq!(free.length_m, 10.0);
    let limits = Limits { max_time_s: free.time_s - 1.0, ..Limits::NONE };
    let bound = field(&ground, source, &FieldOptions { limits, ..all() });
    assert_eq!(bound.cost(target), None);
}

/// Labels that rounding makes equal must not lead in a circle.
#[test]
fn steps_too_small_to_add_to_a_label_still_make_routes() {
    let spec = GridSpec::new(5, 6, 1.0).expect("a small grid");
    let source = Cell::new(2, 3);
    let ground = with_ground(Ground {
        elevation: Layer::certain(Raster::filled(spec, 0.0)).expect("heights are finite"),
        blocked: Raster::filled(spec, false),
        severity: Raster::filled(spec, 0.0),
        hazard_per_m: Raster::from_fn(spec, |cell| if cell == source { 1e12 } else { 1e-8 }),
    });
    let whole = field(&ground, source, &all());
    let targets = [Cell::new(0, 0), Cell::new(4, 5)];
    let part = field(&ground, source, &FieldOptions { targets: Some(&targets), ..all() });
    for cell in spec.cells() {
        let route = whole.route(cell).expect("nothing is in the way");
        assert_eq!(whole.neg_ln_r(cell), Some(route.cost.neg_ln_r));
    }
    assert_eq!(whole.neg_ln_r(targets[0]), whole.neg_ln_r(Cell::new(1, 3)), "rounded away");
    for target in targets {
        assert_eq!(part.route(target), whole.route(target));
    }
}
