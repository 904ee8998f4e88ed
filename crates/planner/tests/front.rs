//! The front of a pair is what trying every way finds.

use proptest::prelude::*;
use wisdom_grid::{Cell, GridSpec, Raster};
use wisdom_planner::{
    CostVector, FieldOptions, Front, FrontOptions, Ground, Limits, Traversability, Vehicle, field,
    front,
};
use wisdom_terrain::Layer;

/// To the last bit, no limits.
const EXACT: FrontOptions =
    FrontOptions { limits: Limits::NONE, max_labels: 1_000_000, precision: 0.0 };

fn with(
    spec: GridSpec,
    heights: Vec<f32>,
    hazards: Vec<f32>,
    blocked: Vec<bool>,
) -> Traversability {
    let ground = Ground {
        elevation: Layer::certain(Raster::from_vec(spec, heights).expect("a height a cell"))
            .expect("heights are finite"),
        blocked: Raster::from_vec(spec, blocked).expect("a value a cell"),
        severity: Raster::filled(spec, 0.0),
        hazard_per_m: Raster::from_vec(spec, hazards).expect("a hazard a cell"),
    };
    Traversability::from_ground(&Vehicle::default(), ground).expect("hazards are positive")
}

/// Ground of at most `side` cells a side; flat, terraced or hilly, its hazards alike, of few values or of many.
fn any_ground(side: usize) -> impl Strategy<Value = Traversability> {
    (1..=side, 1..=side, 0..3usize, 0..3usize).prop_flat_map(|(rows, cols, relief, kind)| {
        let cells = rows * cols;
        (
            prop::collection::vec(0.0..1.0f32, cells),
            prop::collection::vec(0.0..1.0f32, cells),
            prop::collection::vec(prop::bool::weighted(0.1), cells),
        )
            .prop_map(move |(heights, hazards, blocked)| {
                let spec = GridSpec::new(rows, cols, 1.0).expect("a small grid");
                let height = |draw: f32| match relief {
                    0 => 0.0,
                    1 => 0.2 * (3.0 * draw).floor(),
                    _ => 0.6 * draw,
                };
                let hazard = |draw: f32| match kind {
                    0 => 1e-3,
                    1 => 1e-3 * (1.0 + (3.0 * draw).floor()),
                    _ => 1e-4 * (1.0 + 99.0 * draw),
                };
                let heights = heights.into_iter().map(height).collect();
                with(spec, heights, hazards.into_iter().map(hazard).collect(), blocked)
            })
    })
}

type Costs = [f64; 3];

fn costs(cost: CostVector) -> Costs {
    [cost.neg_ln_r, cost.time_s, cost.energy_j]
}

fn matches_or_beats(a: &Costs, b: &Costs) -> bool {
    a.iter().zip(b).all(|(a, b)| a <= b)
}

/// Costs of all ways that meet no cell twice, none matched or beaten by another.
fn brute(ground: &Traversability, from: Cell, to: Cell, limits: Limits) -> Vec<Costs> {
    let mut found: Vec<Costs> = Vec::new();
    try_all(ground, to, &mut vec![from], CostVector::ZERO, &mut |cost| {
        let new = costs(cost);
        let allowed = cost.time_s <= limits.max_time_s && cost.energy_j <= limits.max_energy_j;
        if allowed && !found.iter().any(|known| matches_or_beats(known, &new)) {
            found.retain(|known| !matches_or_beats(&new, known));
            found.push(new);
        }
    });
    found.sort_by(|a, b| a.partial_cmp(b).expect("costs are numbers"));
    found
}

fn try_all(
    ground: &Traversability,
    to: Cell,
    way: &mut Vec<Cell>,
    cost: CostVector,
    visit: &mut impl FnMut(CostVector),
) {
    let at = way[way.len() - 1];
    if at == to {
        visit(cost);
        return;
    }
    let spec = ground.spec();
    for next in spec.neighbours(at) {
        if !way.contains(&next)
            && let Some(edge) = ground.edge(at, next)
        {
            way.push(next);
            try_all(ground, to, way, cost + edge, visit);
            way.pop();
        }
    }
}

fn of(front: &Front) -> Vec<Costs> {
    front.routes.iter().map(|route| costs(route.cost)).collect()
}

/// Its routes go from neighbour to neighbour and cost what they say, most reliable first.
fn check(ground: &Traversability, front: &Front, from: Cell, to: Cell) {
    for route in &front.routes {
        assert_eq!((route.cells[0], route.cells[route.cells.len() - 1]), (from, to));
        let edge = |pair: &[Cell]| ground.edge(pair[0], pair[1]).expect("steps are open");
        assert_eq!(route.cost, route.cells.windows(2).map(edge).sum::<CostVector>());
    }
    let costs = of(front);
    assert!(costs.windows(2).all(|pair| pair[0] < pair[1]), "in order: {costs:?}");
    for (i, a) in costs.iter().enumerate() {
        assert!(costs[i + 1..].iter().all(|b| !matches_or_beats(a, b)), "{costs:?}");
    }
}

fn corners(ground: &Traversability) -> (Cell, Cell) {
    (Cell::new(0, 0), Cell::new(ground.spec().rows() - 1, ground.spec().cols() - 1))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    /// To the last bit, with and without limits.
    #[test]
    fn the_front_is_what_trying_every_way_finds(
        ground in any_ground(4), share in 0.5..2.5f64, other in 0.5..2.5f64,
    ) {
        let (from, to) = corners(&ground);
        let whole = brute(&ground, from, to, Limits::NONE);
        let found = front(&ground, from, to, &EXACT);
        prop_assert!(found.complete);
        check(&ground, &found, from, to);
        prop_assert_eq!(of(&found), whole.clone());
        if let Some(&[_, time_s, energy_j]) = whole.last() {
            let limits = Limits { max_time_s: share * time_s, max_energy_j: other * energy_j };
            let limited = front(&ground, from, to, &FrontOptions { limits, ..EXACT });
            prop_assert_eq!(of(&limited), brute(&ground, from, to, limits));
        }
    }

    #[test]
    fn its_most_reliable_route_is_as_reliable_as_the_field_says(ground in any_ground(9)) {
        let (from, to) = corners(&ground);
        let label = field(&ground, from, &FieldOptions::default()).neg_ln_r(to);
        for precision in [0.0, 1e-6, 0.1] {
            let options = FrontOptions { precision, max_labels: 100_000, ..EXACT };
            let found = front(&ground, from, to, &options);
            check(&ground, &found, from, to);
            prop_assert_eq!(found.routes.first().map(|route| route.cost.neg_ln_r), label);
        }
    }

    /// Whatever is left out has a stand-in as close as promised.
    #[test]
    fn precision_is_kept(ground in any_ground(8), precision in 0.0..1.0f64) {
        let (from, to) = corners(&ground);
        let all = front(&ground, from, to, &EXACT);
        prop_assume!(all.complete);
        let few = front(&ground, from, to, &FrontOptions { precision, ..EXACT });
        prop_assert!(few.complete && few.labels <= all.labels);
        check(&ground, &few, from, to);
        // Rounding of the product itself.
        let factor = (1.0 + precision) * (1.0 + 1e-12);
        for [neg_ln_r, time_s, energy_j] in of(&all) {
            let loose = [neg_ln_r, factor * time_s, factor * energy_j];
            prop_assert!(of(&few).iter().any(|costs| matches_or_beats(costs, &loose)));
        }
    }

    /// What is found before the labels run out is the beginning of the whole front.
    #[test]
    fn too_few_labels_are_said_to_be_too_few(ground in any_ground(7), max_labels in 0..60u64) {
        let (from, to) = corners(&ground);
        let all = front(&ground, from, to, &EXACT);
        let part = front(&ground, from, to, &FrontOptions { max_labels, ..EXACT });
        prop_assert!(part.labels <= max_labels);
        prop_assert_eq!(part.complete, all.labels <= max_labels);
        prop_assert_eq!(&part.routes[..], &all.routes[..part.routes.len()]);
        prop_assert!(!part.complete || part == all);
    }
}

/// Hills with a hazard of their own: time, energy and reliability ask for different ways.
fn hills(side: usize) -> Traversability {
    let spec = GridSpec::new(side, side, 1.0).expect("a small grid");
    let draw = |i: usize, salt: u64| {
        let hash = (i as u64 + salt).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 40;
        (hash % 1000) as f32 / 1000.0
    };
    let heights = (0..spec.len()).map(|i| 0.4 * draw(i, 1)).collect();
    let hazards = (0..spec.len()).map(|i| 1e-4 * (1.0 + 30.0 * draw(i, 7777))).collect();
    with(spec, heights, hazards, vec![false; spec.len()])
}

#[test]
fn a_front_of_many_routes_is_found_whole_and_the_same_each_time() {
    let ground = hills(16);
    let (from, to) = corners(&ground);
    let all = front(&ground, from, to, &EXACT);
    check(&ground, &all, from, to);
    assert!(all.complete && all.routes.len() > 20, "{} routes", all.routes.len());
    assert_eq!(all, front(&ground, from, to, &EXACT));
    let few = front(&ground, from, to, &FrontOptions { precision: 0.01, ..EXACT });
    assert!(few.complete && few.routes.len() < all.routes.len() && few.labels < all.labels);
}

/// On ground too large for trying every way: labels spread to neighbours until nothing changes, without bounds.
#[test]
fn spreading_labels_without_bounds_finds_the_same_front() {
    let ground = hills(12);
    let (from, to) = corners(&ground);
    let mut known: std::collections::BTreeMap<Cell, Vec<Costs>> =
        std::collections::BTreeMap::from([(from, vec![[0.0; 3]])]);
    let mut open = std::collections::VecDeque::from([(from, CostVector::ZERO)]);
    while let Some((at, cost)) = open.pop_front() {
        if !known[&at].contains(&costs(cost)) {
            continue;
        }
        for next in ground.spec().neighbours(at) {
            let Some(edge) = ground.edge(at, next) else { continue };
            let (cost, here) = (cost + edge, known.entry(next).or_default());
            let new = costs(cost);
            if !here.iter().any(|known| matches_or_beats(known, &new)) {
                here.retain(|known| !matches_or_beats(&new, known));
                here.push(new);
                open.push_back((next, cost));
            }
        }
    }
    let mut spread = known.remove(&to).expect("open ground");
    spread.sort_by(|a, b| a.partial_cmp(b).expect("costs are numbers"));
    assert!(spread.len() > 20, "{} routes", spread.len());
    assert_eq!(of(&front(&ground, from, to, &EXACT)), spread);
}

/// Where all is equal, sums in another order of addition are no other ways.
#[test]
fn routes_that_differ_by_rounding_are_one() {
    let spec = GridSpec::new(24, 40, 0.3).expect("a small grid");
    let ground = with(spec, vec![0.0; 960], vec![1e-4; 960], vec![false; 960]);
    let (from, to) = corners(&ground);
    let found = front(&ground, from, to, &FrontOptions::default());
    assert!(found.complete);
    assert_eq!(found.routes.len(), 1);
    let label = field(&ground, from, &FieldOptions::default()).neg_ln_r(to);
    assert_eq!(Some(found.routes[0].cost.neg_ln_r), label);
}

#[test]
fn no_way_is_an_empty_front_and_staying_a_free_one() {
    let spec = GridSpec::new(1, 3, 1.0).expect("a small grid");
    let ground = with(spec, vec![0.0; 3], vec![1e-4; 3], vec![false, true, false]);
    let (west, middle, east) = (Cell::new(0, 0), Cell::new(0, 1), Cell::new(0, 2));
    assert_eq!(
        front(&ground, west, east, &EXACT),
        Front { routes: vec![], complete: true, labels: 0 }
    );
    assert!(front(&ground, west, middle, &EXACT).routes.is_empty(), "a blocked target");
    let stay = front(&ground, middle, middle, &EXACT);
    assert_eq!(stay.routes.len(), 1);
    assert_eq!(
        (stay.routes[0].cells.as_slice(), stay.routes[0].cost),
        (&[middle][..], CostVector::ZERO)
    );
    assert_eq!(front(&ground, middle, east, &EXACT).routes.len(), 1, "what is blocked can be left");
}

#[test]
#[should_panic(expected = "precision")]
fn a_negative_precision_is_a_bug_of_the_caller() {
    let spec = GridSpec::new(1, 1, 1.0).expect("a small grid");
    let ground = with(spec, vec![0.0], vec![1e-4], vec![false]);
    let _ = front(
        &ground,
        Cell::new(0, 0),
        Cell::new(0, 0),
        &FrontOptions { precision: -0.1, ..EXACT },
    );
}
