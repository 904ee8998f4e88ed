//! What the ground is to a vehicle: severity, blocked cells, hazard, and the price of a step.

use proptest::prelude::*;
use wisdom_grid::{Cell, GridSpec, Raster};
use wisdom_planner::{
    CostVector, FieldOptions, Ground, PlannerError, SlipClass, Traversability, Vehicle, field,
};
use wisdom_terrain::Layer;

fn spec(rows: usize, cols: usize) -> GridSpec {
    GridSpec::new(rows, cols, 1.0).expect("a small grid")
}

fn certain(spec: GridSpec, height: impl FnMut(Cell) -> f32) -> Layer {
    Layer::certain(Raster::from_fn(spec, height)).expect("heights are finite")
}

fn judged(elevation: &Layer) -> Traversability {
    Traversability::new(&Vehicle::default(), elevation).expect("the default vehicle is sound")
}

/// A plane that rises to the east by `slope_deg`.
fn ramp(slope_deg: f64) -> Layer {
    certain(spec(9, 9), |cell| (cell.col as f64 * slope_deg.to_radians().tan()) as f32)
}

const MIDDLE: Cell = Cell::new(4, 4);

/// DESIGN section 6 by hand: 25° is the limit, ground there 70 times as hazardous as flat ground.
#[test]
fn a_ramp_has_the_hazard_of_its_slope_and_is_blocked_at_the_limit() {
    for slope_deg in [0.0, 5.0, 12.5, 20.0, 24.9] {
        let ground = judged(&ramp(slope_deg));
        let expected = 1e-4 * (4.25 * slope_deg / 25.0).exp();
        assert!(!ground.is_blocked(MIDDLE), "{slope_deg}");
        assert!((f64::from(ground.severity(MIDDLE)) - slope_deg / 25.0).abs() < 1e-5);
        assert!((f64::from(ground.hazard_per_m(MIDDLE)) / expected - 1.0).abs() < 1e-4);
    }
    assert!(judged(&ramp(25.1)).is_blocked(MIDDLE));
}

/// Sand of which the slip reaches 0.9 at 19.1° (Heverly et al. 2013) stops a rover that could tilt 25°.
#[test]
fn ground_that_slips_too_much_is_blocked_below_the_slope_limit() {
    let sand = Vehicle { slip_base: 0.035, slip_growth_per_deg: 0.17, ..Vehicle::default() };
    let on = |slope_deg| {
        Traversability::new(&sand, &ramp(slope_deg))
            .expect("vehicle and ground are sound")
            .is_blocked(MIDDLE)
    };
    assert!(!on(19.0));
    assert!(on(19.2));
}

/// A lone stone of a metre's width shows as roughness (0.4 of its height) before it shows as a step.
#[test]
fn a_stone_blocks_and_a_pebble_does_not() {
    let stone = |height| {
        let layer = certain(spec(9, 9), |cell| if cell == MIDDLE { height } else { 0.0 });
        judged(&layer)
    };
    assert!((stone(0.1).severity(MIDDLE) - 0.4).abs() < 1e-6);
    assert!(!stone(0.24).is_blocked(MIDDLE));
    assert!(stone(0.26).is_blocked(MIDDLE));
}

/// On metre cells the limit is 0.25 m + √2 m · tan 25° = 0.9095 m, on centimetre cells nearly the step alone.
#[test]
fn a_step_is_what_a_slope_at_the_limit_does_not_explain() {
    let only_steps = Vehicle { roughness_max_m: 1e6, ..Vehicle::default() };
    assert!((only_steps.step_limit_m(1.0) - 0.909_458).abs() < 1e-6);
    assert!((only_steps.step_limit_m(0.01) - 0.256_595).abs() < 1e-6);
    // On top of a spike the central differences see no slope.
    let spike = |height| {
        let layer = certain(spec(9, 9), |cell| if cell == MIDDLE { height } else { 0.0 });
        Traversability::new(&only_steps, &layer)
            .expect("vehicle and ground are sound")
            .is_blocked(MIDDLE)
    };
    assert!(!spike(0.909));
    assert!(spike(0.910));
}

/// A rover three cells wide does not fit where a rover one cell wide does.
#[test]
fn a_wider_footprint_keeps_further_from_a_wall() {
    let wall = certain(spec(15, 15), |cell| if cell.col == 7 { 5.0 } else { 0.0 });
    let blocked_cols = |footprint_radius_m| {
        let vehicle = Vehicle { footprint_radius_m, ..Vehicle::default() };
        let ground = Traversability::new(&vehicle, &wall).expect("vehicle and ground are sound");
        (0..15).filter(|&col| ground.is_blocked(Cell::new(7, col))).collect::<Vec<_>>()
    };
    assert_eq!(blocked_cols(1.0), [6, 7, 8]);
    assert_eq!(blocked_cols(3.0), [4, 5, 6, 7, 8, 9, 10]);
}

/// What was never seen may be driven, at the hazard assumed of it, and no wall stands at its edge.
#[test]
fn unknown_ground_is_open_and_has_the_unknown_hazard() {
    let mut layer = certain(spec(9, 9), |_| -4500.0);
    for col in 5..9 {
        for row in 0..9 {
            layer.set(Cell::new(row, col), 0.0, 1.0);
        }
    }
    let ground = judged(&layer);
    let unknown = Cell::new(4, 7);
    let assumed = 1e-4 * (4.25_f64 * 0.6).exp();
    assert!(!ground.is_blocked(unknown));
    assert_eq!(ground.severity(unknown), 0.0);
    assert_eq!(ground.height_m(unknown), None);
    assert!((f64::from(ground.hazard_per_m(unknown)) / assumed - 1.0).abs() < 1e-6);
    let into_shadow = ground.edge(Cell::new(4, 4), Cell::new(4, 5)).expect("shadow can be entered");
    let flat = ground.edge(Cell::new(4, 1), Cell::new(4, 2)).expect("flat ground can be driven");
    assert_eq!(into_shadow.energy_j, flat.energy_j);
    assert!(into_shadow.neg_ln_r > flat.neg_ln_r);
}

/// The worst tenth of a normal lies on average 1.754983 of its standard deviations above its mean.
const WORST_TENTH: f64 = 1.754_983_319_324_868;

/// Judges heights of one u at their worst tenth, a height with u = 1 erring by 0.2 m.
fn at_risk(vehicle: &Vehicle, u: f32, height: impl FnMut(Cell) -> f32) -> Traversability {
    let careful = Vehicle { risk_level: 0.9, height_sigma_m: 0.2, ..vehicle.clone() };
    let heights = Raster::from_fn(spec(9, 9), height);
    let elevation = Layer::new(heights, Raster::filled(spec(9, 9), u)).expect("sound readings");
    Traversability::new(&careful, &elevation).expect("vehicle and ground are sound")
}

/// By hand: a plane of 10 %, u = 0.5, so that heights err by 0.1 m, their central difference over 2 m by 0.1/√2 m.
#[test]
fn a_slope_is_judged_at_the_mean_of_its_worst_tenth() {
    let only_slope = Vehicle { roughness_max_m: 1e6, step_max_m: 1e6, ..Vehicle::default() };
    let ground = at_risk(&only_slope, 0.5, |cell| 0.1 * cell.col as f32);
    let severity = |gradient: f64| gradient.atan().to_degrees() / 25.0;
    let sigma = 0.1 / 2f64.sqrt();
    let found = f64::from(ground.severity(MIDDLE));
    assert!((found - severity(0.1 + WORST_TENTH * sigma)).abs() < 1e-6, "{found}");
    // At the map's edge two heights a metre apart make the difference, which errs by √2 of each.
    let found = f64::from(ground.severity(Cell::new(4, 0)));
    assert!((found - severity(0.1 + WORST_TENTH * 0.1 * 2f64.sqrt())).abs() < 1e-6, "{found}");
    // Certain heights have no worst tenth.
    let sure = at_risk(&only_slope, 0.0, |cell| 0.1 * cell.col as f32);
    assert!((f64::from(sure.severity(MIDDLE)) - severity(0.1)).abs() < 1e-6);
}

/// A spike of 0.5 m errs by √2·0.2·u against its neighbours: at u = 0.5 its worst tenth is 0.748 m, at u = 0.9 0.947.
#[test]
fn a_step_is_judged_at_the_mean_of_its_worst_tenth() {
    let only_steps = Vehicle { roughness_max_m: 1e6, slope_max_deg: 25.0, ..Vehicle::default() };
    let spike = |u: f32| at_risk(&only_steps, u, |cell| if cell == MIDDLE { 0.5 } else { 0.0 });
    let worst = 0.5 + WORST_TENTH * 2f64.sqrt() * 0.1;
    let found = f64::from(spike(0.5).severity(MIDDLE));
    assert!((found - worst / only_steps.step_limit_m(1.0)).abs() < 1e-6, "{found}");
    assert!(!spike(0.5).is_blocked(MIDDLE));
    assert!(spike(0.9).is_blocked(MIDDLE), "0.947 m is above 0.909 m");
}

#[test]
fn roughness_is_judged_at_the_mean_of_its_worst_tenth() {
    let only_rough = Vehicle {
        roughness_max_m: 0.5,
        slope_max_deg: 89.0,
        step_max_m: 1e6,
        ..Vehicle::default()
    };
    let ground = at_risk(&only_rough, 0.5, |_| -4500.0);
    let found = f64::from(ground.severity(MIDDLE));
    assert!((found - WORST_TENTH * 0.1 / 0.5).abs() < 1e-6, "{found}");
}

/// What was never seen has its own hazard already.
#[test]
fn unknown_ground_is_the_same_at_any_risk_level() {
    let ground = at_risk(&Vehicle::default(), 1.0, |_| 0.0);
    let plain = judged(&Layer::unknown(spec(9, 9)));
    assert_eq!(ground.severities(), plain.severities());
    assert_eq!(ground.hazard(), plain.hazard());
    assert_eq!(ground.blocked(), plain.blocked());
}

/// Loose sand and bedrock, curves through Heverly et al. (2013); the default, of class 2, lies between them.
fn on_soils() -> Vehicle {
    toml::from_str(
        r#"
        slip-base = 0.02
        slip-growth-per-deg = 0.12
        slip-class = [
            { class = 1, name = "loose sand", base = 0.035, growth-per-deg = 0.17 },
            { class = 3, name = "bedrock", base = 0.01, growth-per-deg = 0.10 },
        ]
        "#,
    )
    .expect("known keys")
}

fn classes(spec: GridSpec, class: impl FnMut(Cell) -> f32, u: f32) -> Layer {
    Layer::new(Raster::from_fn(spec, class), Raster::filled(spec, u)).expect("sound readings")
}

/// 20 degrees: sand slips by 1.05, so all its way; bedrock by 0.074; half of each is 0.537, short of the limit 0.9.
#[test]
fn ground_is_blocked_by_the_slip_of_its_class_as_far_as_that_is_known() {
    let judged = |class: f32, u: f32| {
        let classes = classes(spec(9, 9), |_| class, u);
        Traversability::on_classes(&on_soils(), &ramp(20.0), Some(&classes))
            .expect("vehicle and ground are sound")
    };
    assert!(judged(1.0, 0.0).is_blocked(MIDDLE));
    assert!(!judged(2.0, 0.0).is_blocked(MIDDLE));
    assert!(!judged(3.0, 0.0).is_blocked(MIDDLE));
    assert!(!judged(3.0, 0.5).is_blocked(MIDDLE));
    assert!(judged(3.0, 0.95).is_blocked(MIDDLE));
    assert!(judged(3.0, 1.0).is_blocked(MIDDLE));
    let bedrock = 0.01 * 2f64.exp();
    assert!((judged(3.0, 0.0).slip(MIDDLE, 20.0) - bedrock).abs() < 1e-12);
    assert!((judged(3.0, 0.5).slip(MIDDLE, 20.0) - 0.5 * (bedrock + 1.0)).abs() < 1e-12);
    assert_eq!(judged(3.0, 1.0).slip(MIDDLE, 20.0), 1.0);
    // Without a layer of classes the vehicle's own curve holds.
    let plain = Traversability::new(&on_soils(), &ramp(20.0)).expect("a sound vehicle");
    assert_eq!(plain.slip(MIDDLE, 20.0), on_soils().slip(20.0));
    assert!(!plain.is_blocked(MIDDLE));
}

/// Ten degrees, from bedrock onto sand: the step slips as sand does, uphill 0.035 e^1.7, downhill 0.035 e^-1.7.
#[test]
fn a_step_slips_as_the_worse_of_its_two_cells() {
    let soils = classes(spec(9, 9), |cell| if cell.col < 4 { 3.0 } else { 1.0 }, 0.0);
    let ground = Traversability::on_classes(&on_soils(), &ramp(10.0), Some(&soils))
        .expect("vehicle and ground are sound");
    let way = 1.0 / 10f64.to_radians().cos();
    let time = |from: usize, to: usize| {
        let step = ground.edge(Cell::new(4, from), Cell::new(4, to));
        step.expect("10 degrees can be driven").time_s
    };
    let expected = |slip: f64| way / (0.04 * (1.0 - slip));
    for (from, to, slip) in [
        (2, 3, 0.01 * 1f64.exp()),
        (3, 4, 0.035 * 1.7f64.exp()),
        (4, 5, 0.035 * 1.7f64.exp()),
        (5, 4, 0.035 * (-1.7f64).exp()),
        (4, 3, 0.035 * (-1.7f64).exp()),
        (3, 2, 0.01 * (-1f64).exp()),
    ] {
        let found = time(from, to);
        assert!((found / expected(slip) - 1.0).abs() < 1e-6, "{from} to {to}: {found}");
    }
}

/// A bank of 21 degrees that the map's slopes do not show is closed upwards where it may be sand.
#[test]
fn a_bank_of_sand_is_closed_upwards_only() {
    let bank = |u: f32| {
        let mut bank = drawn(&[".."]);
        bank.elevation = certain(spec(1, 2), |cell| 0.384 * cell.col as f32);
        let soil = classes(spec(1, 2), |_| 3.0, u);
        Traversability::from_ground_on_classes(&on_soils(), bank, Some(&soil))
            .expect("vehicle and ground are sound")
    };
    let (low, high) = (Cell::new(0, 0), Cell::new(0, 1));
    assert!(bank(0.5).edge(low, high).is_some());
    assert_eq!(bank(0.95).edge(low, high), None);
    assert!(bank(0.95).edge(high, low).is_some());
}

#[test]
fn classes_of_another_grid_are_refused() {
    let other = classes(spec(9, 8), |_| 1.0, 0.0);
    let refused = Traversability::on_classes(&on_soils(), &ramp(5.0), Some(&other));
    assert_eq!(
        refused.map(|_| ()).unwrap_err(),
        PlannerError::GridMismatch { layer: "classes", found: spec(9, 8), expected: spec(9, 9) }
    );
    let refused = Traversability::from_ground_on_classes(&on_soils(), drawn(&[".."]), Some(&other));
    assert!(matches!(refused, Err(PlannerError::GridMismatch { layer: "classes", .. })));
}

/// A corridor of shadow beside a corridor of seen ground at 0.4 of the limits, u = 0.2, equally long.
#[test]
fn shadow_is_not_preferred_to_seen_ground_of_moderate_slope() {
    let layer = Layer::new(
        Raster::from_fn(spec(12, 12), |cell| {
            // Rows 0 to 3 seen, sloped 10 degrees to the north; the rest in shadow.
            if cell.row < 4 { cell.row as f32 * -0.176_327 } else { 0.0 }
        }),
        Raster::from_fn(spec(12, 12), |cell| if cell.row < 4 { 0.2 } else { 1.0 }),
    )
    .unwrap();
    let ground = judged(&layer);
    for row in 0..3 {
        assert!((ground.severity(Cell::new(row, 6)) - 0.4).abs() < 1e-3);
    }
    assert!(ground.hazard_per_m(Cell::new(2, 6)) < ground.hazard_per_m(Cell::new(8, 6)));
    let field = field(&ground, Cell::new(2, 0), &FieldOptions::default());
    let route = field.route(Cell::new(2, 11)).expect("nothing is blocked");
    assert!(route.cells.iter().all(|cell| cell.row < 4), "{:?}", route.cells);
}

proptest! {
    /// λ grows with severity and with u: nothing is better for being steeper or less certain.
    #[test]
    fn hazard_grows_with_severity_and_uncertainty(
        a in 0.0..1.2f64, b in 0.0..1.2f64, u in 0.0..=1.0f64, v in 0.0..=1.0f64,
    ) {
        let vehicle = Vehicle::default();
        let worse = vehicle.hazard_per_m(a.max(b), u.max(v));
        prop_assert!(vehicle.hazard_per_m(a.min(b), u.max(v)) <= worse);
        prop_assert!(vehicle.hazard_per_m(a.max(b), u.min(v)) <= worse);
        prop_assert!(vehicle.hazard_per_m(a.min(b), u.min(v)) >= vehicle.hazard_floor_per_m);
    }

    /// Steeper planes, higher steps, rougher ground: each alone raises severity and hazard on the map.
    #[test]
    fn hazard_on_the_map_grows_with_slope_step_and_roughness(
        low in 0.0..1.0f32, more in 0.0..1.0f32, kind in 0..3usize,
    ) {
        let shape = |size: f32| certain(spec(9, 9), |cell| match kind {
            0 => size * 0.4 * cell.col as f32,
            1 => if cell.col < 4 { 0.0 } else { size },
            _ => if (cell.row + cell.col) % 2 == 0 { 0.0 } else { 0.3 * size },
        });
        let (gentle, rough) = (judged(&shape(low)), judged(&shape(low + more)));
        // Heights in f32 leave the slope of a plane its last digits.
        prop_assert!(gentle.severity(MIDDLE) <= rough.severity(MIDDLE) + 1e-5);
        prop_assert!(gentle.hazard_per_m(MIDDLE) <= rough.hazard_per_m(MIDDLE) * (1.0 + 1e-5));
        prop_assert!(gentle.is_blocked(MIDDLE) <= rough.is_blocked(MIDDLE));
    }

    /// The same heights seen less well anywhere make no route more reliable.
    #[test]
    fn a_less_certain_cell_never_makes_a_route_more_reliable(
        heights in prop::collection::vec(0.0..0.3f32, 49),
        u in prop::collection::vec(0.0..0.9f32, 49),
        (at, raised) in (0..49usize, 0.0..0.99f32),
    ) {
        let heights = Raster::from_vec(spec(7, 7), heights).expect("a value a cell");
        let clear = Layer::new(heights.clone(), Raster::from_vec(spec(7, 7), u.clone()).expect("a value a cell")).expect("a value a cell");
        let mut hazy = clear.clone();
        hazy.set(spec(7, 7).cell(at), heights.values()[at], u[at].max(raised));
        let (clear, hazy) = (judged(&clear), judged(&hazy));
        let best = field(&clear, Cell::new(0, 0), &FieldOptions::default());
        let other = field(&hazy, Cell::new(0, 0), &FieldOptions::default());
        for cell in spec(7, 7).cells() {
            prop_assert_eq!(best.neg_ln_r(cell).is_some(), other.neg_ln_r(cell).is_some());
            prop_assert!(best.neg_ln_r(cell) <= other.neg_ln_r(cell));
        }
    }
}

/// Reference formulas by hand: `E = m g (c_rr cos t + sin t) / (η (1 − s))` a metre of ground, and the avionics.
#[test]
fn climbing_costs_more_than_coming_down() {
    let ground = judged(&ramp(10.0));
    let (low, high) = (Cell::new(4, 3), Cell::new(4, 4));
    let up = ground.edge(low, high).expect("10 degrees can be climbed");
    let down = ground.edge(high, low).expect("10 degrees can be descended");
    let t = 10f64.to_radians();
    let (slip_up, slip_down) = (0.01 * 1f64.exp(), 0.01 * (-1f64).exp());
    let way = 1.0 / t.cos();
    let time_up = way / (0.04 * (1.0 - slip_up));
    let energy_up = way * 900.0 * 3.71 * (0.15 * t.cos() + t.sin()) / (0.6 * (1.0 - slip_up));
    let time_down = way / (0.04 * (1.0 - slip_down));
    let energy_down = way * 900.0 * 3.71 * 0.15 * t.cos() / (0.6 * (1.0 - slip_down));
    assert!((up.time_s / time_up - 1.0).abs() < 1e-6);
    assert!((up.energy_j / (energy_up + 100.0 * time_up) - 1.0).abs() < 1e-6);
    assert!((down.time_s / time_down - 1.0).abs() < 1e-6);
    assert!((down.energy_j / (energy_down + 100.0 * time_down) - 1.0).abs() < 1e-6);
    assert_eq!(up.neg_ln_r, down.neg_ln_r);
    assert_eq!(up.length_m, 1.0);
}

/// Ground given cell by cell: `#` is blocked.
fn drawn(rows: &[&str]) -> Ground {
    let spec = spec(rows.len(), rows[0].len());
    Ground {
        elevation: certain(spec, |_| 0.0),
        blocked: Raster::from_fn(spec, |c| rows[c.row].as_bytes()[c.col] == b'#'),
        severity: Raster::filled(spec, 0.0),
        hazard_per_m: Raster::filled(spec, 1e-4),
    }
}

#[test]
fn a_diagonal_step_needs_both_cells_beside_it_free() {
    let ground = Traversability::from_ground(&Vehicle::default(), drawn(&["..", "#."]))
        .expect("vehicle and ground are sound");
    let at = Cell::new;
    assert_eq!(ground.edge(at(0, 0), at(1, 1)), None);
    assert!(ground.edge(at(0, 0), at(0, 1)).is_some());
    assert_eq!(ground.edge(at(0, 0), at(1, 0)), None, "a blocked cell is not entered");
    assert!(ground.edge(at(1, 0), at(0, 0)).is_some(), "a blocked cell can be left");
    assert!(ground.edge(at(1, 0), at(0, 1)).is_some());
    assert_eq!(ground.edge(at(0, 0), at(0, 0)), None);
    assert_eq!(ground.edge(at(0, 0), at(5, 5)), None);
}

/// An edge too slippery to climb is closed upwards only.
#[test]
fn a_bank_too_slippery_to_climb_can_be_descended() {
    let mut bank = drawn(&[".."]);
    bank.elevation = certain(spec(1, 2), |cell| cell.col as f32);
    let ground = Traversability::from_ground(&Vehicle::default(), bank)
        .expect("vehicle and ground are sound");
    // 45 degrees: 0.01 e^4.5 = 0.9002.
    assert_eq!(ground.edge(Cell::new(0, 0), Cell::new(0, 1)), None);
    assert!(ground.edge(Cell::new(0, 1), Cell::new(0, 0)).is_some());
}

#[test]
fn unsound_ground_is_refused_with_the_cell_named() {
    let refused = |change: fn(&mut Ground)| {
        let mut ground = drawn(&["..", ".."]);
        change(&mut ground);
        Traversability::from_ground(&Vehicle::default(), ground).map(|_| ()).unwrap_err()
    };
    let cell = Cell::new(1, 0);
    assert_eq!(
        refused(|ground| ground.hazard_per_m[Cell::new(1, 0)] = 0.0),
        PlannerError::Hazard { cell, value: 0.0 }
    );
    assert!(matches!(
        refused(|ground| ground.hazard_per_m[Cell::new(1, 0)] = f32::NAN),
        PlannerError::Hazard { cell: found, .. } if found == cell
    ));
    assert_eq!(
        refused(|ground| ground.severity[Cell::new(1, 0)] = -1.0),
        PlannerError::Severity { cell, value: -1.0 }
    );
    assert!(matches!(
        refused(|ground| ground.blocked = Raster::filled(spec(3, 2), false)),
        PlannerError::GridMismatch { layer: "blocked", .. }
    ));
}

#[test]
fn a_vehicle_out_of_range_is_refused_by_name() {
    let refused = |toml: &str| {
        toml::from_str::<Vehicle>(toml).expect("known keys").validate().unwrap_err().to_string()
    };
    assert_eq!(refused("speed-m-s = 0.0"), "vehicle speed-m-s is 0; it must be in (0, 1e9]");
    assert_eq!(
        refused("slope-max-deg = 90.0"),
        "vehicle slope-max-deg is 90; it must be in (0, 90)"
    );
    assert_eq!(refused("slip-base = 0.95"), "vehicle slip-base is 0.95; it must be below slip-max");
    assert_eq!(
        refused("hazard-floor-per-m = nan"),
        "vehicle hazard-floor-per-m is NaN; it must be in [1e-12, 1e3]"
    );
    assert_eq!(refused("risk-level = 1.0"), "vehicle risk-level is 1; it must be in [0, 1)");
    assert_eq!(
        refused("height-sigma-m = -0.1"),
        "vehicle height-sigma-m is -0.1; it must be in [0, 1e9]"
    );
    assert!(toml::from_str::<Vehicle>("speed = 1.0").is_err(), "unknown keys are errors");
    assert_eq!(toml::from_str::<Vehicle>("").expect("all keys have defaults"), Vehicle::default());
}

#[test]
fn a_slip_class_out_of_range_is_refused_by_name() {
    let refused = |change: fn(&mut Vec<SlipClass>)| {
        let mut vehicle = on_soils();
        change(&mut vehicle.slip_class);
        vehicle.validate().unwrap_err()
    };
    let found = refused(|listed| listed[1].base = 0.0);
    assert_eq!(
        found,
        PlannerError::SlipClass { class: 3, field: "base", value: 0.0, limit: "in (0, 1)" }
    );
    assert_eq!(found.to_string(), "vehicle slip-class of class 3: base is 0; it must be in (0, 1)");
    assert!(matches!(
        refused(|listed| listed[0].base = 0.95),
        PlannerError::SlipClass { class: 1, field: "base", limit: "below slip-max", .. }
    ));
    assert!(matches!(
        refused(|listed| listed[0].growth_per_deg = f64::NAN),
        PlannerError::SlipClass { class: 1, field: "growth-per-deg", .. }
    ));
    assert_eq!(refused(|listed| listed[1].class = 1), PlannerError::RepeatedClass { class: 1 });
    assert_eq!(
        refused(|listed| listed[1].class = 1 << 25),
        PlannerError::ClassRange { class: 1 << 25 }
    );
    assert!(toml::from_str::<Vehicle>("slip-class = [{ class = 1 }]").is_err(), "half a curve");
    assert!(Traversability::new(&on_soils(), &ramp(5.0)).is_ok());
}

#[test]
fn costs_add_and_reliabilities_multiply() {
    let leg = |neg_ln_r| CostVector { length_m: 1.0, time_s: 2.0, energy_j: 3.0, neg_ln_r };
    let both = leg(0.1) + leg(0.2);
    assert!((both.reliability() - leg(0.1).reliability() * leg(0.2).reliability()).abs() < 1e-15);
    assert_eq!((both.length_m, both.time_s, both.energy_j), (2.0, 4.0, 6.0));
    assert_eq!(CostVector::ZERO.reliability(), 1.0);
}
