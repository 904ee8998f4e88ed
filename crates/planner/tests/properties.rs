//! Laws of the judged ground, for any heights, vehicle and classes: worse is never better.

mod drawn;

use drawn::{mirrored, turned};
use proptest::prelude::*;
use wisdom_grid::{Cell, GridSpec, Raster};
use wisdom_planner::{CostVector, FieldOptions, SlipClass, Traversability, Vehicle, field};
use wisdom_terrain::Layer;

/// Heights with their uncertainty, and classes with theirs.
#[derive(Debug, Clone)]
struct Site {
    elevation: Layer,
    classes: Layer,
}

impl Site {
    fn judged(&self, vehicle: &Vehicle) -> Traversability {
        Traversability::on_classes(vehicle, &self.elevation, Some(&self.classes))
            .expect("vehicle and ground are sound")
    }
}

/// Up to 9 x 9 cells of half a metre. Heights are whole 64ths of a metre, so that their differences are exact; some
/// cells are unknown. Classes 0 to 3, of which the vehicles know 1 to 3; some unknown.
fn any_site() -> impl Strategy<Value = Site> {
    (3..10usize, 3..10usize, 1..33i32).prop_flat_map(|(rows, cols, most)| {
        let cells = rows * cols;
        let u = || prop_oneof![6 => 0.0..0.95f32, 2 => Just(0.0f32), 1 => Just(1.0f32)];
        (
            prop::collection::vec(0..=most, cells),
            prop::collection::vec(u(), cells),
            prop::collection::vec(0..4i32, cells),
            prop::collection::vec(u(), cells),
        )
            .prop_map(move |(heights, u, classes, class_u)| {
                let spec = GridSpec::new(rows, cols, 0.5).expect("a small grid");
                let layer = |values: Vec<f32>, u: Vec<f32>| {
                    let values = Raster::from_vec(spec, values).expect("a value a cell");
                    let u = Raster::from_vec(spec, u).expect("a u a cell");
                    Layer::new(values, u).expect("sound readings")
                };
                let height = |z: i32| z as f32 / 64.0 - 4500.0;
                Site {
                    elevation: layer(heights.into_iter().map(height).collect(), u),
                    classes: layer(classes.into_iter().map(|c| c as f32).collect(), class_u),
                }
            })
    })
}

/// With and without risk, with a footprint of one to three cells' radius, limited by tilt or by slip.
fn any_vehicle() -> impl Strategy<Value = Vehicle> {
    let level = prop_oneof![Just(0.0), 0.0..0.99f64];
    let footprint = prop_oneof![Just(0.5), Just(1.0), Just(1.5)];
    let curves = prop::collection::vec((0.005..0.3f64, 0.0..0.2f64), 3);
    (level, 0.0..0.1f64, footprint, 15.0..40.0f64, curves).prop_map(
        |(risk_level, height_sigma_m, footprint_radius_m, slope_max_deg, curves)| Vehicle {
            risk_level,
            height_sigma_m,
            footprint_radius_m,
            slope_max_deg,
            slip_class: (1..)
                .zip(curves)
                .map(|(class, (base, growth_per_deg))| SlipClass {
                    class,
                    name: String::new(),
                    base,
                    growth_per_deg,
                })
                .collect(),
            ..Vehicle::default()
        },
    )
}

/// A cell of a layer, from a draw in [0, 1).
fn pick(spec: GridSpec, draw: f64) -> Cell {
    spec.cell((draw * spec.len() as f64) as usize)
}

/// The same reading, less certain; unknown cells stay what they are.
fn blurred(layer: &Layer, cell: Cell, u: f32) -> Layer {
    let mut blurred = layer.clone();
    if layer.is_known(cell) {
        blurred.set(cell, layer.value(cell), layer.u(cell).max(u));
    }
    blurred
}

/// Asserts that no cell, step or route is better on the second ground than on the first.
fn check_no_better(
    first: &Traversability,
    second: &Traversability,
    source: Cell,
) -> Result<(), TestCaseError> {
    let spec = first.spec();
    let (routes, others) = (
        field(first, source, &FieldOptions::default()),
        field(second, source, &FieldOptions::default()),
    );
    for cell in spec.cells() {
        prop_assert!(first.severity(cell) <= second.severity(cell), "severity of {}", cell);
        prop_assert!(first.hazard_per_m(cell) <= second.hazard_per_m(cell), "hazard of {}", cell);
        prop_assert!(first.is_blocked(cell) <= second.is_blocked(cell), "{}", cell);
        for to in spec.neighbours(cell) {
            if let Some(other) = second.edge(cell, to) {
                let Some(edge) = first.edge(cell, to) else {
                    return Err(TestCaseError::fail(format!("{cell} to {to} was closed")));
                };
                prop_assert!(edge.neg_ln_r <= other.neg_ln_r);
                prop_assert!(edge.time_s <= other.time_s && edge.energy_j <= other.energy_j);
            }
        }
        if let Some(label) = others.neg_ln_r(cell) {
            prop_assert!(routes.neg_ln_r(cell).is_some_and(|best| best <= label), "{}", cell);
        }
    }
    Ok(())
}

proptest! {
    /// Whatever is known of a cell, knowing it less well helps no cell, step or route. (Knowing nothing, u = 1, is
    /// another matter: the height is forgotten, and ground never seen is open.)
    #[test]
    fn nothing_is_better_through_a_less_certain_height(
        site in any_site(), vehicle in any_vehicle(), at in 0.0..1.0f64, u in 0.0..0.99f32, from in 0.0..1.0f64,
    ) {
        let spec = site.elevation.spec();
        let hazy = Site { elevation: blurred(&site.elevation, pick(spec, at), u), ..site.clone() };
        check_no_better(&site.judged(&vehicle), &hazy.judged(&vehicle), pick(spec, from))?;
    }

    /// The same of classes, up to knowing nothing.
    #[test]
    fn nothing_is_better_through_a_less_certain_class(
        site in any_site(), vehicle in any_vehicle(), at in 0.0..1.0f64,
        u in prop_oneof![3 => 0.0..1.0f32, 1 => Just(1.0f32)], from in 0.0..1.0f64,
    ) {
        let spec = site.elevation.spec();
        let hazy = Site { classes: blurred(&site.classes, pick(spec, at), u), ..site.clone() };
        check_no_better(&site.judged(&vehicle), &hazy.judged(&vehicle), pick(spec, from))?;
    }

    /// A class that nobody knows is nowhere better than any class it could be.
    #[test]
    fn an_unknown_class_is_the_worst(site in any_site(), vehicle in any_vehicle(), from in 0.0..1.0f64) {
        let spec = site.elevation.spec();
        let unknown = Site { classes: Layer::unknown(spec), ..site.clone() };
        check_no_better(&site.judged(&vehicle), &unknown.judged(&vehicle), pick(spec, from))?;
    }

    /// Nor does more caution unblock anything, nor larger errors of the same heights.
    #[test]
    fn nothing_is_better_at_a_higher_risk_level(
        site in any_site(), vehicle in any_vehicle(), level in 0.0..0.99f64, sigma in 0.0..0.2f64, from in 0.0..1.0f64,
    ) {
        let careful = Vehicle {
            risk_level: vehicle.risk_level.max(level),
            height_sigma_m: vehicle.height_sigma_m.max(sigma),
            ..vehicle.clone()
        };
        let source = pick(site.elevation.spec(), from);
        check_no_better(&site.judged(&vehicle), &site.judged(&careful), source)?;
    }

    /// Twice the heights are twice the gradient, step and roughness, exactly: no cell is better for it.
    #[test]
    fn no_cell_is_better_where_the_ground_is_twice_as_rough(site in any_site(), vehicle in any_vehicle()) {
        let heights = site.elevation.values().map(|z| 2.0 * z);
        let twice = Layer::new(heights, site.elevation.uncertainty().clone()).expect("sound readings");
        let (gentle, rough) = (site.judged(&vehicle), Site { elevation: twice, ..site.clone() }.judged(&vehicle));
        for cell in gentle.spec().cells() {
            prop_assert!(gentle.severity(cell) <= rough.severity(cell));
            prop_assert!(gentle.hazard_per_m(cell) <= rough.hazard_per_m(cell));
            prop_assert!(gentle.is_blocked(cell) <= rough.is_blocked(cell));
        }
    }

    /// Each of slope, step and roughness alone, up to the last digits that heights in f32 leave the slope of a plane.
    #[test]
    fn severity_grows_with_slope_step_and_roughness(
        vehicle in any_vehicle(), kind in 0..3usize, low in 0.0..1.0f32, more in 0.0..1.0f32, u in 0.0..0.99f32,
    ) {
        let spec = GridSpec::new(9, 9, 0.5).expect("a small grid");
        let shape = |size: f32| {
            let heights = Raster::from_fn(spec, |cell| match kind {
                0 => size * 0.2 * cell.col as f32,
                1 => if cell.col < 4 { 0.0 } else { size },
                _ => if (cell.row + cell.col) % 2 == 0 { 0.0 } else { 0.3 * size },
            });
            let elevation = Layer::new(heights, Raster::filled(spec, u)).expect("sound readings");
            Traversability::new(&vehicle, &elevation).expect("vehicle and ground are sound")
        };
        let (gentle, rough) = (shape(low), shape(low + more));
        let middle = Cell::new(4, 4);
        prop_assert!(gentle.severity(middle) <= rough.severity(middle) * (1.0 + 1e-5) + 1e-5);
        prop_assert!(gentle.hazard_per_m(middle) <= rough.hazard_per_m(middle) * (1.0 + 1e-4));
    }

    #[test]
    fn slip_grows_with_the_slope_and_with_what_is_not_known_of_the_class(
        vehicle in any_vehicle(), class in 0..5i32,
        a in -40.0..40.0f64, b in -40.0..40.0f64, u in 0.0..=1.0f32, v in 0.0..=1.0f32,
    ) {
        let class = class as f32;
        let least = vehicle.slip_on(class, u.min(v), a.min(b));
        let most = vehicle.slip_on(class, u.max(v), a.max(b));
        prop_assert!(least > 0.0 && most <= 1.0);
        // Both curves of the mixture grow; their sum is rounded.
        prop_assert!(least <= vehicle.slip_on(class, u.max(v), a.min(b)));
        prop_assert!(vehicle.slip_on(class, u.max(v), a.min(b)) <= most * (1.0 + 1e-12));
        prop_assert!(vehicle.slip_on(class, 0.0, a) <= vehicle.slip_on(class, 1.0, a));
    }

    /// R lies in (0, 1] for every step and route, and that of a route is the product of its steps'.
    #[test]
    fn reliability_is_a_probability_and_multiplies(
        site in any_site(), vehicle in any_vehicle(), from in 0.0..1.0f64,
    ) {
        let ground = site.judged(&vehicle);
        let spec = ground.spec();
        let found = field(&ground, pick(spec, from), &FieldOptions::default());
        for cell in spec.cells() {
            for to in spec.neighbours(cell) {
                let step = ground.edge(cell, to).map_or(1.0, CostVector::reliability);
                prop_assert!(step > 0.0 && step <= 1.0);
            }
            let Some(route) = found.route(cell) else { continue };
            let steps = route.cells.windows(2).map(|pair| ground.edge(pair[0], pair[1]).expect("an open step"));
            let (product, sum) = steps.fold((1.0, 0.0), |(product, sum), edge| {
                (product * edge.reliability(), sum + edge.neg_ln_r)
            });
            prop_assert!(product > 0.0 && product <= 1.0);
            prop_assert!((product - (-sum).exp()).abs() < 1e-12);
            prop_assert!((route.cost.reliability() - product).abs() < 1e-12);
        }
    }

    /// The same step upwards takes no less time and energy, and where it is open so is the way down.
    #[test]
    fn uphill_is_never_cheaper_than_downhill(site in any_site(), vehicle in any_vehicle()) {
        let ground = site.judged(&vehicle);
        let spec = ground.spec();
        for low in spec.cells() {
            for high in spec.neighbours(low) {
                let (Some(z), Some(top)) = (ground.height_m(low), ground.height_m(high)) else { continue };
                if z > top || ground.is_blocked(low) {
                    continue;
                }
                let Some(up) = ground.edge(low, high) else { continue };
                let Some(down) = ground.edge(high, low) else {
                    return Err(TestCaseError::fail(format!("{low} to {high} opens upwards only")));
                };
                prop_assert!(up.time_s >= down.time_s && up.energy_j >= down.energy_j);
                prop_assert_eq!(up.neg_ln_r, down.neg_ln_r);
            }
        }
    }

    /// Classes say nothing to a vehicle that lists none, nor does a class that is certain and not listed.
    #[test]
    fn classes_not_listed_change_nothing(site in any_site(), vehicle in any_vehicle()) {
        let bare = Vehicle { slip_class: Vec::new(), ..vehicle.clone() };
        let expected = Traversability::new(&vehicle, &site.elevation).expect("a sound vehicle");
        let unlisted = Layer::certain(Raster::filled(site.elevation.spec(), 9.0)).expect("a class");
        let unlisted = Site { classes: unlisted, ..site.clone() };
        for ground in [site.judged(&bare), unlisted.judged(&vehicle)] {
            check_same(&expected, &ground, |cell| cell, 0.0)?;
        }
    }

    /// Ground known to be of one class is the ground of a vehicle that has the class's curve for its own.
    #[test]
    fn ground_of_one_class_slips_by_its_curve(site in any_site(), vehicle in any_vehicle(), class in 1..4usize) {
        let sure = Layer::certain(Raster::filled(site.elevation.spec(), class as f32)).expect("a class");
        let sure = Site { classes: sure, ..site.clone() };
        let curve = &vehicle.slip_class[class - 1];
        let own = Vehicle { slip_base: curve.base, slip_growth_per_deg: curve.growth_per_deg, ..vehicle.clone() };
        let expected = Traversability::new(&own, &site.elevation).expect("a sound vehicle");
        check_same(&expected, &sure.judged(&vehicle), |cell| cell, 0.0)?;
    }

    /// North is a name: the map in all eight positions has the same blocked cells, steps and fields. To the last bit,
    /// where roughness has no say: slope, step, risk and slip are worked out alike in every direction.
    #[test]
    fn a_turned_or_mirrored_map_is_the_same_ground(
        site in any_site(), vehicle in any_vehicle(), from in 0.0..1.0f64,
    ) {
        let smooth = Vehicle { roughness_max_m: 1e9, ..vehicle };
        check_positions(&site, &smooth, from, 0.0)?;
    }

    /// Roughness sums its cells in the order of the map and is good to 1e-6 of the heights' differences; so is what
    /// comes of it, where no cell is so close to the limit that rounding decides.
    #[test]
    fn a_turned_or_mirrored_map_is_as_rough(
        site in any_site(), vehicle in any_vehicle(), from in 0.0..1.0f64,
    ) {
        // Exactly 1 is what slip says, in any position.
        let clear = |severity: &f32| *severity == 1.0 || (severity - 1.0).abs() > ROUGHLY;
        prop_assume!(site.judged(&vehicle).severities().values().iter().all(clear));
        check_positions(&site, &vehicle, from, f64::from(ROUGHLY))?;
    }
}

/// How far severities of one map in two positions may be apart, and hazards as a share: roughness is off by at most
/// some 1e-6 m here, a limit of 0.1 m makes that 1e-5, and the hazard's exponent 4.25 times as much.
const ROUGHLY: f32 = 1e-4;

/// What is left of roughness in a severity where its limit is 1e9 m; hazards do not show it.
const NO_SAY: f64 = 1e-9;

/// Asserts that two grounds are one, cell by cell; hazards and severities up to a tolerance.
fn check_same(
    first: &Traversability,
    second: &Traversability,
    place: impl Fn(Cell) -> Cell,
    tolerance: f64,
) -> Result<(), TestCaseError> {
    for cell in first.spec().cells() {
        let there = place(cell);
        prop_assert_eq!(first.is_blocked(cell), second.is_blocked(there), "{}", cell);
        let (a, b) = (f64::from(first.severity(cell)), f64::from(second.severity(there)));
        prop_assert!(
            (a - b).abs() <= tolerance.max(NO_SAY),
            "severity of {}: {} and {}",
            cell,
            a,
            b
        );
        let (a, b) = (f64::from(first.hazard_per_m(cell)), f64::from(second.hazard_per_m(there)));
        prop_assert!((a - b).abs() <= tolerance * a, "hazard of {}: {} and {}", cell, a, b);
        for to in first.spec().neighbours(cell) {
            let (here, there) = (first.edge(cell, to), second.edge(there, place(to)));
            prop_assert_eq!(here.is_some(), there.is_some(), "{} to {}", cell, to);
            let (Some(here), Some(there)) = (here, there) else { continue };
            prop_assert_eq!(
                (here.length_m, here.time_s, here.energy_j),
                (there.length_m, there.time_s, there.energy_j)
            );
            let (a, b) = (here.neg_ln_r, there.neg_ln_r);
            prop_assert!((a - b).abs() <= tolerance * a, "{} to {}: {} and {}", cell, to, a, b);
        }
    }
    Ok(())
}

fn moved(layer: &Layer, raster: impl Fn(&Raster<f32>) -> Raster<f32>) -> Layer {
    Layer::new(raster(layer.values()), raster(layer.uncertainty())).expect("sound readings")
}

/// Asserts that a site in its eight positions is the same ground with the same field.
fn check_positions(
    site: &Site,
    vehicle: &Vehicle,
    from: f64,
    tolerance: f64,
) -> Result<(), TestCaseError> {
    let ground = site.judged(vehicle);
    let spec = ground.spec();
    let source = pick(spec, from);
    let routes = field(&ground, source, &FieldOptions::default());
    let mut other = site.clone();
    // Where each cell of the site lies in the other one.
    let mut places: Raster<Cell> = Raster::from_fn(spec, |cell| cell);
    for position in 0..8 {
        let (rows, cols) = (other.elevation.spec().rows(), other.elevation.spec().cols());
        if position == 4 {
            other = Site {
                elevation: moved(&other.elevation, mirrored),
                classes: moved(&other.classes, mirrored),
            };
            places = places.map(|place| Cell::new(place.row, cols - 1 - place.col));
        } else {
            other = Site {
                elevation: moved(&other.elevation, turned),
                classes: moved(&other.classes, turned),
            };
            places = places.map(|place| Cell::new(place.col, rows - 1 - place.row));
        }
        let there = other.judged(vehicle);
        check_same(&ground, &there, |cell| places[cell], tolerance)?;
        let same = field(&there, places[source], &FieldOptions::default());
        for cell in spec.cells() {
            let (a, b) = (routes.neg_ln_r(cell), same.neg_ln_r(places[cell]));
            prop_assert_eq!(a.is_some(), b.is_some(), "{}", cell);
            let (Some(a), Some(b)) = (a, b) else { continue };
            prop_assert!((a - b).abs() <= tolerance * a, "{}: {} and {}", cell, a, b);
        }
    }
    Ok(())
}
