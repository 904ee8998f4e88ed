//! Fields of weighed costs are exact, and the alternatives of a matrix are what its sweep promises.

mod drawn;

use drawn::{Total, any_ground, open_steps, pick, with_ground};
use pathfinding::prelude::dijkstra_all;
use proptest::prelude::*;
use wisdom_grid::{Cell, GridSpec, Raster};
use wisdom_planner::{
    CostVector, FieldOptions, Limits, TravelOptions, Traversability, Vehicle, WeighedGround,
    Weights, field, travel_alternatives, travel_matrix,
};
use wisdom_terrain::Layer;

fn all() -> FieldOptions<'static> {
    FieldOptions::default()
}

/// Weights of any kind: mixed, or of one cost alone.
fn any_weights() -> impl Strategy<Value = Weights> {
    (0..5usize, 0.1..1.0f64, 0.1..1.0f64, 0.1..1.0f64).prop_map(|(kind, r, s, j)| {
        let weights = match kind {
            0 => Weights::new(1e4 * r, 0.0, 0.0),
            1 => Weights::new(0.0, s, 0.0),
            2 => Weights::new(0.0, 0.0, 1e-4 * j),
            _ => Weights::new(1e4 * r, s, 1e-4 * j),
        };
        weights.expect("one of them is positive")
    })
}

fn no_worse(a: CostVector, b: CostVector) -> bool {
    a.neg_ln_r <= b.neg_ln_r && a.time_s <= b.time_s && a.energy_j <= b.energy_j
}

proptest! {
    /// To the last bit, in the direction of travel: both take the least of the sums from source to cell.
    #[test]
    fn a_weighed_field_is_what_dijkstra_finds(
        ground in any_ground(), draw in 0.0..1.0f64, weights in any_weights(),
    ) {
        let ground = with_ground(ground);
        let source = pick(&ground, draw);
        let reference = dijkstra_all(&source, |&cell| {
            open_steps(&ground, cell).into_iter().map(|(to, edge)| (to, Total(weights.of(edge))))
        });
        let weighed = WeighedGround::new(&ground, weights);
        let field = weighed.field(source, &all());
        for cell in ground.spec().cells() {
            let expected = reference.get(&cell).map(|&(_, Total(label))| label);
            let expected = if cell == source { Some(0.0) } else { expected };
            prop_assert_eq!(field.weighed(cell), expected, "{}", cell);
        }
    }

    /// A route of a weighed field is open, costs what its edges cost, and weighs what the field says.
    #[test]
    fn a_weighed_route_has_the_cost_of_its_edges(
        ground in any_ground(), draw in 0.0..1.0f64, weights in any_weights(),
    ) {
        let ground = with_ground(ground);
        let source = pick(&ground, draw);
        let weighed = WeighedGround::new(&ground, weights);
        let field = weighed.field(source, &all());
        for cell in ground.spec().cells() {
            let Some(route) = field.route(cell) else { continue };
            prop_assert_eq!((route.cells[0], *route.cells.last().unwrap()), (source, cell));
            let edges: Vec<CostVector> = route
                .cells
                .windows(2)
                .map(|pair| ground.edge(pair[0], pair[1]).expect("a route takes open steps"))
                .collect();
            prop_assert_eq!(route.cost, edges.iter().copied().sum::<CostVector>());
            let sum = edges.iter().fold(0.0, |sum, &edge| sum + weights.of(edge));
            prop_assert_eq!(field.weighed(cell), Some(sum));
        }
    }

    /// Weighing only −ln R is the field of −ln R but for the scale of its labels.
    #[test]
    fn weighing_reliability_alone_gives_the_most_reliable_routes(
        ground in any_ground(), draw in 0.0..1.0f64,
    ) {
        let ground = with_ground(ground);
        let source = pick(&ground, draw);
        let weighed = WeighedGround::new(&ground, Weights::new(1.0, 0.0, 0.0).unwrap());
        let (plain, other) = (field(&ground, source, &all()), weighed.field(source, &all()));
        for cell in ground.spec().cells() {
            prop_assert_eq!(plain.route(cell), other.route(cell));
        }
    }

    /// The promise of limits holds for weighed costs too.
    #[test]
    fn limits_cut_no_weighed_route_that_keeps_them(
        ground in any_ground(), draw in 0.0..1.0f64, weights in any_weights(),
        max_time_s in 0.0..200.0f64, max_energy_j in 0.0..40_000.0f64,
    ) {
        let ground = with_ground(ground);
        let source = pick(&ground, draw);
        let limits = Limits { max_time_s, max_energy_j };
        let weighed = WeighedGround::new(&ground, weights);
        let free = weighed.field(source, &all());
        let bound = weighed.field(source, &FieldOptions { limits, ..all() });
        for cell in ground.spec().cells() {
            let keeps = |cost: CostVector| cost.time_s <= max_time_s && cost.energy_j <= max_energy_j;
            if let Some(best) = free.route(cell) && keeps(best.cost) {
                prop_assert_eq!(bound.route(cell), Some(best));
            } else if let Some(route) = bound.route(cell) {
                prop_assert!(keeps(route.cost));
                prop_assert!(bound.weighed(cell).unwrap() >= free.weighed(cell).unwrap());
            }
        }
    }

    /// Sorted, none beaten by another, at most one more than the weights, the first the most reliable, and each route
    /// of the sweep either there or beaten by one that is.
    #[test]
    fn alternatives_are_the_front_of_the_sweep(
        ground in any_ground(), draws in prop::collection::vec(0.0..1.0f64, 1..5),
        weights in prop::collection::vec(any_weights(), 0..5), max_time_s in 50.0..2000.0f64,
    ) {
        let ground = with_ground(ground);
        let nodes: Vec<Cell> = draws.iter().map(|&draw| pick(&ground, draw)).collect();
        let limits = Limits { max_time_s, ..Limits::NONE };
        let options = TravelOptions { limits, weights: &weights };
        let matrix = travel_alternatives(&ground, &nodes, &options);
        let plain = travel_matrix(&ground, &nodes, limits);
        let bound = FieldOptions { limits, ..all() };
        let weighed = WeighedGround::all(&ground, &weights);
        for (from, &source) in nodes.iter().enumerate() {
            let sweep: Vec<_> = weighed.iter().map(|ground| ground.field(source, &bound)).collect();
            for (to, &target) in nodes.iter().enumerate() {
                let ways = matrix.alternatives(from, to);
                prop_assert!(ways.len() <= weights.len() + 1);
                let least = plain.alternatives(from, to).first().map(|cost| cost.neg_ln_r);
                if least.is_some() {
                    prop_assert_eq!(ways.first().map(|cost| cost.neg_ln_r), least);
                }
                for (k, &way) in ways.iter().enumerate() {
                    let route = matrix.route(from, to, k).expect("an alternative has a route");
                    let edges = route.cells.windows(2).map(|pair| ground.edge(pair[0], pair[1]).unwrap());
                    prop_assert_eq!(edges.sum::<CostVector>(), way);
                    prop_assert!(way.time_s <= max_time_s);
                    for (other, &cost) in ways.iter().enumerate() {
                        prop_assert!(other == k || !no_worse(cost, way));
                        prop_assert!(other < k || cost.neg_ln_r >= way.neg_ln_r);
                    }
                }
                for cost in sweep.iter().filter_map(|field| field.cost(target)) {
                    prop_assert!(ways.iter().any(|&way| no_worse(way, cost)));
                }
            }
        }
    }

    /// Without weights an alternative is what the simple matrix holds, routes and bits.
    #[test]
    fn no_weights_is_the_simple_matrix(
        ground in any_ground(), draws in prop::collection::vec(0.0..1.0f64, 1..5),
    ) {
        let ground = with_ground(ground);
        let nodes: Vec<Cell> = draws.iter().map(|&draw| pick(&ground, draw)).collect();
        let matrix = travel_alternatives(&ground, &nodes, &TravelOptions::default());
        prop_assert_eq!(matrix, travel_matrix(&ground, &nodes, Limits::NONE));
    }
}

/// A ridge of hazard across the map with a safe pass far off: quick and safe routes differ.
fn ridge() -> Traversability {
    let spec = GridSpec::new(40, 40, 1.0).expect("a small grid");
    let height = |cell: Cell| {
        let (across, along) = (cell.row as f64 - 20.0, cell.col as f64);
        (2.5 * libm::exp(-across * across / 18.0) * (1.0 - libm::exp(-along / 12.0))) as f32
    };
    let layer = Layer::certain(Raster::from_fn(spec, height)).expect("heights are finite");
    Traversability::new(&Vehicle::default(), &layer).expect("vehicle and ground are sound")
}

#[test]
fn a_sweep_finds_quicker_ways_over_a_ridge_than_the_most_reliable_one() {
    let ground = ridge();
    let nodes = [Cell::new(4, 30), Cell::new(36, 30)];
    let weights = Weights::sweep(&ground, 6);
    let options = TravelOptions { weights: &weights, ..TravelOptions::default() };
    let matrix = travel_alternatives(&ground, &nodes, &options);
    let ways = matrix.alternatives(0, 1);
    assert!(ways.len() >= 3, "{ways:?}");
    let quickest = ways.iter().map(|way| way.time_s).fold(f64::INFINITY, f64::min);
    assert!(quickest < 0.8 * ways[0].time_s, "{ways:?}");
    assert!(ways[0].neg_ln_r < ways[ways.len() - 1].neg_ln_r);
}

#[test]
fn alternatives_have_the_same_bits_on_any_number_of_threads() {
    let work = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("threads can be started");
        pool.install(|| {
            let ground = ridge();
            let nodes: Vec<Cell> = (0..9).map(|i| Cell::new(i * 4 + 1, (i * 17) % 40)).collect();
            let weights = Weights::sweep(&ground, 4);
            let options = TravelOptions { weights: &weights, ..TravelOptions::default() };
            travel_alternatives(&ground, &nodes, &options)
        })
    };
    let one = work(1);
    assert_eq!(one, work(2));
    assert_eq!(one, work(5));
}

#[test]
fn a_longer_sweep_contains_the_shorter_ones_and_weighs_everything() {
    let ground = ridge();
    let long = Weights::sweep(&ground, 12);
    assert_eq!(Weights::sweep(&ground, 5), long[..5]);
    let unit = |cost: CostVector| CostVector { length_m: 0.0, ..cost };
    for (k, weights) in long.iter().enumerate() {
        for alone in [
            CostVector { time_s: 1.0, ..CostVector::ZERO },
            CostVector { energy_j: 1.0, ..CostVector::ZERO },
            CostVector { neg_ln_r: 1.0, ..CostVector::ZERO },
        ] {
            assert!(weights.of(unit(alone)) > 0.0, "{weights:?}");
        }
        assert!(!long[..k].contains(weights), "no weights come twice");
    }
}

#[test]
fn weights_that_weigh_nothing_or_no_number_are_refused() {
    assert_eq!(Weights::new(0.0, 0.0, 0.0), None);
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(Weights::new(bad, 1.0, 1.0), None);
        assert_eq!(Weights::new(1.0, bad, 1.0), None);
        assert_eq!(Weights::new(1.0, 1.0, bad), None);
    }
}
