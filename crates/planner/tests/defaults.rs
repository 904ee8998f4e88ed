//! Missions decided before there were risk levels and slip classes are decided alike today: with the defaults the
//! ground has, bit for bit, the numbers it had in version 0.1.0, when these digests were taken.

use wisdom_grid::{Cell, GridSpec, Raster};
use wisdom_planner::{Traversability, Vehicle};
use wisdom_terrain::Layer;

/// Rolling ground with stones, a cliff and banks too steep to climb; u rises to the east, a corner is unseen.
fn rolling(rows: usize, cols: usize, spacing_m: f64) -> Layer {
    let spec = GridSpec::new(rows, cols, spacing_m).expect("a small grid");
    let height = |cell: Cell| {
        let (x, y) = (cell.col as f64 * spacing_m, cell.row as f64 * spacing_m);
        let waves = 3.0 * libm::sin(x / 9.0) + 2.0 * libm::cos(y / 7.0);
        let stones = 0.4 * libm::pow(libm::sin(x * 1.7 + 0.3) * libm::sin(y * 1.3 + 0.1), 9.0);
        let cliff = if cell.row > rows / 2 && cell.col * 3 < cols { 4.0 } else { 0.0 };
        (waves + stones + cliff - 4500.0) as f32
    };
    let u = |cell: Cell| {
        if cell.row * 4 < rows && cell.col * 4 > cols * 3 {
            1.0
        } else {
            (cell.col as f32 / cols as f32) * 0.8
        }
    };
    Layer::new(Raster::from_fn(spec, height), Raster::from_fn(spec, u)).expect("sound readings")
}

/// FNV-1a (Fowler, Noll and Vo, 1991), 64 bits, a word at a time.
fn digest(words: impl Iterator<Item = u64>) -> u64 {
    words.fold(0xCBF2_9CE4_8422_2325, |hash, word| (hash ^ word).wrapping_mul(0x0100_0000_01B3))
}

/// Digests of severity, hazard and blocked cells, and of the four costs of every step.
fn digests(ground: &Traversability) -> [u64; 2] {
    let spec = ground.spec();
    let judged = spec.cells().flat_map(|cell| {
        let bits = [ground.severity(cell).to_bits(), ground.hazard_per_m(cell).to_bits()];
        [u64::from(bits[0]), u64::from(bits[1]), u64::from(ground.is_blocked(cell))]
    });
    let steps = spec.cells().flat_map(|from| {
        spec.neighbours(from).flat_map(move |to| match ground.edge(from, to) {
            Some(cost) => {
                [cost.length_m, cost.time_s, cost.energy_j, cost.neg_ln_r].map(f64::to_bits)
            }
            None => [0; 4],
        })
    });
    [digest(judged), digest(steps)]
}

fn judged(vehicle: &Vehicle, rows: usize, cols: usize, spacing_m: f64) -> [u64; 2] {
    let ground = Traversability::new(vehicle, &rolling(rows, cols, spacing_m));
    digests(&ground.expect("vehicle and ground are sound"))
}

#[test]
fn the_default_vehicle_judges_as_it_did() {
    let vehicle = Vehicle::default();
    let found = [(96, 80, 1.0), (61, 75, 0.5), (40, 40, 8.0)]
        .map(|(rows, cols, spacing_m)| judged(&vehicle, rows, cols, spacing_m));
    assert_eq!(
        found,
        [
            [0xA051_9670_E664_B920, 0xAD66_CA86_651A_B215],
            [0x4CB0_548A_DC71_5CF0, 0x878C_0952_1B30_0864],
            [0x1DF6_BE4D_2595_0A3B, 0x22F5_8957_AD7E_1620]
        ]
    );
}

#[test]
fn a_wide_vehicle_judges_as_it_did() {
    let vehicle = Vehicle { footprint_radius_m: 3.0, ..Vehicle::default() };
    assert_eq!(judged(&vehicle, 96, 80, 1.0), [0x137F_15D6_1D8B_B4BE, 0x1367_A6B1_BDE6_9680]);
}

/// Slip, not tilt, limits this one: blocked cells and closed steps hang on the curve.
#[test]
fn a_vehicle_on_sand_judges_as_it_did() {
    let vehicle = Vehicle { slip_base: 0.035, slip_growth_per_deg: 0.17, ..Vehicle::default() };
    let tilted = Vehicle { slope_max_deg: 40.0, ..vehicle.clone() };
    let found = [&vehicle, &tilted].map(|vehicle| judged(vehicle, 96, 80, 1.0));
    assert_eq!(
        found,
        [
            [0x41BC_10A0_8F33_106D, 0x3279_03E9_4FE5_17CA],
            [0x8A2B_F5BE_F382_43B1, 0x5705_804C_74AD_8B2B]
        ]
    );
}
