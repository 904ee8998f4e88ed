//! Gradient, slope, step and roughness against their definitions, cell by cell in double precision, and against
//! surfaces whose shape is known in closed form.

use proptest::prelude::*;
use wisdom_grid::{Cell, GridSpec, Raster};
use wisdom_terrain::{
    Hazards, Kernel, Layer, Measure, gradient, gradient_by, hazards, measure, roughness, slope,
    step, unit_noise,
};

fn spec(rows: usize, cols: usize, spacing_m: f64) -> GridSpec {
    GridSpec::new(rows, cols, spacing_m).expect("a small grid")
}

fn known(spec: GridSpec, height: impl FnMut(Cell) -> f32) -> Layer {
    Layer::certain(Raster::from_fn(spec, height)).expect("finite heights")
}

fn kernels() -> [Measure; 2] {
    Kernel::ALL.map(Measure::Gradient)
}

/// A reading and its u; none where unknown.
type Reading = Option<(f64, f32)>;

/// The definitions, word for word.
struct Reference<'a>(&'a Layer);

impl Reference<'_> {
    fn at(&self, row: isize, col: isize) -> Reading {
        let spec = self.0.spec();
        let cell = Cell::new(usize::try_from(row).ok()?, usize::try_from(col).ok()?);
        (spec.contains(cell) && self.0.is_known(cell))
            .then(|| (f64::from(self.0.value(cell)), self.0.u(cell)))
    }

    /// Rise over run between two cells so many cells apart.
    fn rise(&self, from: Reading, to: Reading, cells: f64) -> Reading {
        let ((from, u_from), (to, u_to)) = (from?, to?);
        Some(((to - from) / (cells * self.0.spec().spacing_m()), u_from.max(u_to)))
    }

    fn central(&self, row: isize, col: isize, (dr, dc): (isize, isize)) -> Reading {
        self.rise(self.at(row - dr, col - dc), self.at(row + dr, col + dc), 2.0)
    }

    fn one_sided(&self, row: isize, col: isize, (dr, dc): (isize, isize)) -> Reading {
        let (here, before, after) =
            (self.at(row, col), self.at(row - dr, col - dc), self.at(row + dr, col + dc));
        match (before, after) {
            (Some(_), Some(_)) => None,
            (Some(_), None) => self.rise(before, here, 1.0),
            _ => self.rise(here, after, 1.0),
        }
    }

    fn along(&self, kernel: Kernel, cell: Cell, along: (isize, isize)) -> Reading {
        let (row, col) = (cell.row as isize, cell.col as isize);
        match kernel {
            Kernel::Central => {
                self.central(row, col, along).or_else(|| self.one_sided(row, col, along))
            }
            Kernel::Horn => {
                let lines = [-1, 0, 1].map(|k| (row + k * along.1, col + k * along.0));
                let mean = |readings: [Reading; 3]| {
                    let (mut sum, mut weights, mut worst) = (0.0, 0.0, 0.0_f32);
                    for (reading, weight) in readings.into_iter().zip([1.0, 2.0, 1.0]) {
                        if let Some((rise, u)) = reading {
                            sum += weight * rise;
                            weights += weight;
                            worst = worst.max(u);
                        }
                    }
                    (weights > 0.0).then(|| (sum / weights, worst))
                };
                mean(lines.map(|(row, col)| self.central(row, col, along)))
                    .or_else(|| mean(lines.map(|(row, col)| self.one_sided(row, col, along))))
            }
        }
    }

    fn gradient(&self, kernel: Kernel, cell: Cell) -> Reading {
        let ((x, u_x), (y, u_y)) =
            (self.along(kernel, cell, (0, 1))?, self.along(kernel, cell, (1, 0))?);
        Some(((x * x + y * y).sqrt(), u_x.max(u_y)))
    }

    /// Known cells within a radius: column and row step, height, u.
    fn within(&self, cell: Cell, radius: isize) -> Vec<(f64, f64, f64, f32)> {
        let mut cells = Vec::new();
        for dr in -radius..=radius {
            for dc in -radius..=radius {
                let reading = self.at(cell.row as isize + dr, cell.col as isize + dc);
                if let (true, Some((z, u))) = (dr * dr + dc * dc <= radius * radius, reading) {
                    cells.push((dc as f64, dr as f64, z, u));
                }
            }
        }
        cells
    }

    fn step(&self, cell: Cell) -> Reading {
        let (here, u_here) = self.at(cell.row as isize, cell.col as isize)?;
        let around = self.within(cell, 2);
        let beside = around.iter().filter(|(x, y, ..)| x.abs().max(y.abs()) == 1.0);
        beside
            .map(|&(_, _, z, u)| ((z - here).abs(), u.max(u_here)))
            .reduce(|a, b| (a.0.max(b.0), a.1.max(b.1)))
    }

    /// By orthogonal projection: what is left of the heights after 1, x and y.
    fn roughness(&self, cell: Cell, radius: usize) -> Reading {
        let (base, _) = self.at(cell.row as isize, cell.col as isize)?;
        let cells = self.within(cell, radius as isize);
        if cells.len() < 4 {
            return None;
        }
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let mut basis: Vec<Vec<f64>> = Vec::new();
        let clear = |mut vector: Vec<f64>, basis: &[Vec<f64>]| {
            // Twice, so that rounding of the first time is cleared, too.
            for direction in basis.iter().chain(basis) {
                let part = dot(&vector, direction) / dot(direction, direction);
                vector.iter_mut().zip(direction).for_each(|(v, d)| *v -= part * d);
            }
            vector
        };
        let columns: [Vec<f64>; 3] = [
            vec![1.0; cells.len()],
            cells.iter().map(|cell| cell.0).collect(),
            cells.iter().map(|cell| cell.1).collect(),
        ];
        for column in columns {
            let direction = clear(column, &basis);
            if dot(&direction, &direction) < 1e-9 {
                return None;
            }
            basis.push(direction);
        }
        let left = clear(cells.iter().map(|cell| cell.2 - base).collect(), &basis);
        let worst = cells.iter().map(|cell| cell.3).fold(0.0, f32::max);
        Some(((dot(&left, &left) / cells.len() as f64).sqrt(), worst))
    }

    fn measure(&self, what: Measure, cell: Cell) -> Reading {
        match what {
            Measure::Gradient(kernel) => self.gradient(kernel, cell),
            Measure::SlopeDeg(kernel) => {
                self.gradient(kernel, cell).map(|(rise, u)| (rise.atan().to_degrees(), u))
            }
            Measure::Step => self.step(cell),
            Measure::Roughness { radius_cells } => self.roughness(cell, radius_cells),
        }
    }
}

const MEASURES: [Measure; 8] = [
    Measure::Gradient(Kernel::Central),
    Measure::Gradient(Kernel::Horn),
    Measure::SlopeDeg(Kernel::Horn),
    Measure::SlopeDeg(Kernel::Central),
    Measure::Step,
    Measure::Roughness { radius_cells: 1 },
    Measure::Roughness { radius_cells: 2 },
    Measure::Roughness { radius_cells: 3 },
];

/// Noise on a tilt at a height, with holes; u from a few values, so that some neighbours share theirs.
fn ground(seed: u64, (rows, cols): (usize, usize), spacing_m: f64, base: f64, holes: f64) -> Layer {
    let mut layer = Layer::unknown(spec(rows, cols, spacing_m));
    for cell in layer.spec().cells() {
        let noise = |purpose| unit_noise(&[seed, cell.row as u64, cell.col as u64, purpose]);
        let z = base + 0.4 * cell.row as f64 - 0.2 * cell.col as f64 + 3.0 * noise(0).powi(4);
        let u = if noise(1) < holes { 1.0 } else { (noise(2) * 3.0).floor() / 4.0 };
        layer.set(cell, z as f32, u as f32);
    }
    layer
}

/// The largest height difference on a map, metres.
fn relief_m(layer: &Layer) -> f64 {
    let known = || layer.values().iter().filter(|(cell, _)| layer.is_known(*cell));
    let highest = known().map(|(_, &z)| f64::from(z)).fold(f64::MIN, f64::max);
    let lowest = known().map(|(_, &z)| f64::from(z)).fold(f64::MAX, f64::min);
    (highest - lowest).max(0.0)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// Any map, any holes, any u: values within rounding of single precision, u and unknown cells exactly.
    #[test]
    fn every_measure_follows_its_definition(
        seed in any::<u64>(),
        rows in 1..14_usize,
        cols in 1..40_usize,
        spacing_m in prop::sample::select(vec![1.0, 0.3, 5.0]),
        base in prop::sample::select(vec![0.0, -4500.0]),
        holes in prop::sample::select(vec![0.0, 0.02, 0.2, 0.6]),
    ) {
        let ground = ground(seed, (rows, cols), spacing_m, base, holes);
        let (reference, relief) = (Reference(&ground), relief_m(&ground));
        for (layer, what) in measure(&ground, MEASURES).iter().zip(MEASURES) {
            let tolerance = match what {
                // A difference, a square root and a factor, each rounded once or twice.
                Measure::Gradient(_) => 1e-6 * relief / spacing_m,
                // 5e-5 degrees are 9e-7 rad: the polynomial's 2e-7 and the gradient's own.
                Measure::SlopeDeg(_) => 5e-5,
                Measure::Step => 1e-7 * relief,
                Measure::Roughness { .. } => 1e-6 * relief,
            };
            for cell in ground.spec().cells() {
                if let Some((expected, u)) = reference.measure(what, cell) {
                    let off = f64::from(layer.value(cell)) - expected;
                    prop_assert!(off.abs() <= tolerance, "{:?} is off by {} at {}", what, off, cell);
                    prop_assert_eq!(layer.u(cell), u, "{:?} at {}", what, cell);
                } else {
                    prop_assert_eq!((layer.value(cell), layer.u(cell)), (0.0, 1.0));
                }
            }
        }
    }

    /// Turned or mirrored ground has turned or mirrored gradients and steps, bit for bit, and its roughness up to the
    /// order of the sums.
    #[test]
    fn the_eight_symmetries_of_the_grid_change_nothing(
        seed in any::<u64>(),
        holes in prop::sample::select(vec![0.0, 0.1, 0.5]),
        which in 0..8_u8,
    ) {
        let side = 24;
        let upright = ground(seed, (side, side), 0.7, -4500.0, holes);
        let moved = |cell: Cell| {
            let flip = |at: usize, yes: bool| if yes { side - 1 - at } else { at };
            let (row, col) = (flip(cell.row, which & 1 != 0), flip(cell.col, which & 2 != 0));
            if which & 4 != 0 { Cell::new(col, row) } else { Cell::new(row, col) }
        };
        let mut turned = Layer::unknown(upright.spec());
        for cell in turned.spec().cells() {
            turned.set(cell, upright.value(moved(cell)), upright.u(moved(cell)));
        }
        let relief = relief_m(&upright) as f32;
        let both = measure(&upright, MEASURES).into_iter().zip(measure(&turned, MEASURES));
        for ((before, after), what) in both.zip(MEASURES) {
            let tolerance = match what {
                Measure::Roughness { .. } => 1e-6 * relief,
                _ => 0.0,
            };
            for cell in turned.spec().cells() {
                let off = after.value(cell) - before.value(moved(cell));
                prop_assert!(off.abs() <= tolerance, "{:?} is off by {} at {}", what, off, cell);
                prop_assert_eq!(after.u(cell), before.u(moved(cell)));
            }
        }
    }

    /// Tilts that the heights hold exactly come back exactly, borders included, and leave no residual.
    #[test]
    fn a_plane_of_any_tilt_has_its_gradient_and_no_roughness(
        east in -512..512_i32,
        south in -512..512_i32,
        base in prop::sample::select(vec![0.0_f32, -4500.0, 1000.0]),
    ) {
        let tilt = |share: i32| share as f32 / 64.0;
        let plane = known(spec(12, 40, 1.0), |cell| {
            base + tilt(east) * cell.col as f32 + tilt(south) * cell.row as f32
        });
        let steepness = f64::from(tilt(east)).hypot(f64::from(tilt(south)));
        for layer in measure(&plane, kernels()) {
            prop_assert!(layer.values().values().iter().all(|&g| g == steepness as f32));
        }
        for radius in 1..5 {
            for (cell, &rms_m) in roughness(&plane, radius).values().iter() {
                // Whole discs have none at all; at the edge the general fit rounds, in double precision.
                let inside = cell.row.min(11 - cell.row).min(cell.col).min(39 - cell.col) >= radius;
                prop_assert!(rms_m <= if inside { 0.0 } else { 1e-10 }, "{} at {}", rms_m, cell);
            }
        }
    }
}

#[test]
fn a_cone_is_equally_steep_all_around() {
    let cone =
        known(spec(81, 81, 1.0), |c| -0.75 * (c.row as f32 - 40.0).hypot(c.col as f32 - 40.0));
    for layer in measure(&cone, kernels()) {
        for (cell, &g) in layer.values().iter() {
            let r = (cell.row as f64 - 40.0).hypot(cell.col as f64 - 40.0);
            let inner = cell.row.min(80 - cell.row).min(cell.col).min(80 - cell.col) > 0;
            // Differences of the second order: what they miss falls with the square of the distance.
            if inner && r >= 5.0 {
                assert!((f64::from(g) - 0.75).abs() < 0.75 / (r * r), "{g} at {cell}");
            }
        }
    }
}

/// Second order differences are exact on z = a r²; over five cells its fit leaves 2/5 of a w².
#[test]
fn a_paraboloid_has_the_gradient_2ar_and_a_residual_of_its_curvature() {
    let a = 0.125_f32;
    let bowl = known(spec(41, 61, 1.0), |c| {
        let (x, y) = (c.col as f32 - 30.0, c.row as f32 - 20.0);
        a * (x * x + y * y)
    });
    let rough = roughness(&bowl, 1);
    let layers = measure(&bowl, kernels());
    for cell in bowl.spec().cells() {
        if cell.row.min(40 - cell.row).min(cell.col).min(60 - cell.col) == 0 {
            continue;
        }
        let r = (cell.col as f64 - 30.0).hypot(cell.row as f64 - 20.0);
        for layer in &layers {
            assert!((f64::from(layer.value(cell)) - 0.25 * r).abs() < 1e-6, "at {cell}");
        }
        assert!((rough.value(cell) - 0.4 * a).abs() < 1e-7, "at {cell}");
    }
}

/// d/dx of A sin(kx) by central differences is A cos(kx) sin(kw)/w, which Horn's weights leave alone.
#[test]
fn waves_have_the_gradient_of_their_difference_quotient() {
    let (height, k, w) = (3.0, 0.11, 2.0);
    let waves = known(spec(9, 120, w), |c| (height * (k * w * c.col as f64).sin()) as f32);
    for layer in measure(&waves, kernels()) {
        for (cell, &g) in layer.values().iter() {
            if cell.col.min(119 - cell.col) > 0 {
                let expected = (height * (k * w * cell.col as f64).cos()).abs() * (k * w).sin() / w;
                // The heights themselves are rounded to 1.2e-7 of theirs.
                assert!((f64::from(g) - expected).abs() < 4e-7, "{g} {expected} at {cell}");
            }
        }
    }
}

#[test]
fn a_ledge_is_half_as_steep_as_high_and_steps_its_height_on_both_sides() {
    let ledge = known(spec(9, 40, 0.5), |c| if c.col < 20 { -4500.0 } else { -4499.25 });
    let [central, horn] = measure(&ledge, kernels());
    let steps = step(&ledge);
    for cell in ledge.spec().cells() {
        let beside = (19..=20).contains(&cell.col);
        let (rise, height) = if beside { (0.75, 0.75) } else { (0.0, 0.0) };
        assert_eq!((central.value(cell), horn.value(cell)), (rise, rise), "at {cell}");
        assert_eq!(steps.value(cell), height, "at {cell}");
    }
}

#[test]
fn horns_weights_blur_a_stone_that_central_differences_keep() {
    let stone = known(spec(5, 5, 1.0), |c| if c == Cell::new(2, 2) { 8.0 } else { 0.0 });
    let [central, horn] = measure(&stone, kernels());
    assert_eq!((central.value(Cell::new(2, 1)), horn.value(Cell::new(2, 1))), (4.0, 2.0));
    // (1 along the row, 1 along the column) where central differences see nothing of it.
    let diagonal = 2.0_f32.sqrt();
    assert_eq!((central.value(Cell::new(1, 1)), horn.value(Cell::new(1, 1))), (0.0, diagonal));
}

/// Of three lines only those with both ends count; with none, one-sided differences take their place.
#[test]
fn horn_goes_around_holes() {
    let ramp = |holes: &[(usize, usize)]| {
        let mut layer = known(spec(3, 3, 1.0), |c| (c.col * c.col) as f32);
        for &(row, col) in holes {
            layer.set(Cell::new(row, col), 0.0, 1.0);
        }
        gradient_by(&layer, Kernel::Horn)
    };
    let middle = Cell::new(1, 1);
    assert_eq!(ramp(&[]).value(middle), 2.0);
    assert_eq!(ramp(&[(0, 0), (1, 0)]).value(middle), 2.0); // the southern line is whole
    assert_eq!(ramp(&[(0, 0), (1, 0), (2, 0)]).value(middle), 3.0); // 4 − 1, to the east
    assert_eq!(ramp(&[(1, 1)]).value(middle), 2.0);
    assert!(!ramp(&[(0, 1), (1, 1), (2, 1), (0, 0), (1, 0), (2, 0)]).is_known(middle));
}

/// The worst u is that of the cells in use, and of no others.
#[test]
fn u_comes_from_the_cells_in_use() {
    let doubted = |at: Cell| {
        let mut layer = known(spec(7, 7, 1.0), |_| 0.0);
        layer.set(at, 0.0, 0.5);
        let [horn] = measure(&layer, [Measure::Gradient(Kernel::Horn)]);
        let Hazards { gradient, slope_deg, step_m, roughness_m } = hazards(&layer, 2);
        [gradient, horn, slope_deg, step_m, roughness_m].map(|l| l.u(Cell::new(3, 3)) == 0.5)
    };
    let (yes, no) = (true, false);
    assert_eq!(doubted(Cell::new(3, 3)), [no, no, no, yes, yes]);
    assert_eq!(doubted(Cell::new(3, 4)), [yes; 5]);
    assert_eq!(doubted(Cell::new(2, 2)), [no, yes, no, yes, yes]);
    assert_eq!(doubted(Cell::new(1, 3)), [no, no, no, no, yes]);
    assert_eq!(doubted(Cell::new(1, 1)), [no; 5]); // 2√2 away
}

#[test]
fn hazards_are_the_layers_made_one_by_one() {
    let ground = ground(7, (30, 50), 0.5, -4500.0, 0.05);
    let all = hazards(&ground, 2);
    assert_eq!(all.gradient, gradient(&ground));
    assert_eq!(all.slope_deg, slope(&ground));
    assert_eq!(all.step_m, step(&ground));
    assert_eq!(all.roughness_m, roughness(&ground, 2));
}

#[test]
fn a_map_of_one_row_or_column_has_steps_only() {
    for (rows, cols) in [(1, 30), (30, 1), (1, 1)] {
        let strip = known(spec(rows, cols, 1.0), |c| (c.row + c.col) as f32);
        let Hazards { gradient, slope_deg, step_m, roughness_m } = hazards(&strip, 2);
        for cell in strip.spec().cells() {
            for layer in [&gradient, &slope_deg, &roughness_m] {
                assert_eq!((layer.value(cell), layer.u(cell)), (0.0, 1.0));
            }
            assert_eq!((step_m.value(cell), step_m.is_known(cell)), {
                if strip.spec().len() > 1 { (1.0, true) } else { (0.0, false) }
            });
        }
    }
}

#[test]
fn a_radius_of_nothing_has_no_residual_and_one_beyond_the_map_takes_all_of_it() {
    let ground = ground(3, (9, 11), 1.0, 0.0, 0.1);
    assert_eq!(roughness(&ground, 0), Layer::unknown(ground.spec()));
    assert_eq!(roughness(&ground, usize::MAX), roughness(&ground, 20));
}

/// Differences of such heights overflow; a layer holds the largest number instead, and the layer's own rules hold.
#[test]
fn heights_near_the_largest_number_give_no_infinities() {
    for (scale, spacing_m) in [(f32::MAX, 1.0), (f32::MAX, 1e-300), (f32::MAX, 1e300), (1e30, 1.0)]
    {
        let wild = known(spec(20, 40, spacing_m), |c| {
            scale * (2.0 * unit_noise(&[c.row as u64, c.col as u64]) - 1.0) as f32
        });
        for (layer, what) in measure(&wild, MEASURES).into_iter().zip(MEASURES) {
            let checked = Layer::new(layer.values().clone(), layer.uncertainty().clone());
            assert_eq!(checked.expect("finite values"), layer, "{what:?}");
            assert!(layer.values().values().iter().all(|&value| value >= 0.0), "{what:?}");
        }
    }
    let level = known(spec(9, 40, 1e-300), |_| f32::MAX);
    let Hazards { gradient, slope_deg, step_m, roughness_m } = hazards(&level, 2);
    for layer in [gradient, slope_deg, step_m, roughness_m] {
        assert!(layer.values().values().iter().all(|&value| value == 0.0));
    }
}

#[test]
fn kernels_are_known_by_their_names() {
    for kernel in Kernel::ALL {
        assert_eq!(kernel.to_string().parse(), Ok(kernel));
    }
    let unknown = "sobel".parse::<Kernel>().expect_err("not ours");
    assert_eq!(
        unknown.to_string(),
        "the gradient kernel is \"sobel\"; it is \"central\" or \"horn\""
    );
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    // More cells than one thread takes at a time.
    let ground = ground(11, (300, 700), 1.0, -4500.0, 0.001);
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| measure(&ground, MEASURES))
    };
    let one = with(1);
    assert_eq!(one, with(2));
    assert_eq!(one, with(5));
}
